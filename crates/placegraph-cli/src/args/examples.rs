//! What the help of every command ends with: lines to type.

pub(super) const PROGRAM: &str = "\
Examples:
  placegraph info map.yaml
  placegraph map map.yaml --out out
  placegraph map sites --out results --resume

`placegraph help COMMAND` has the options and an example of every command.";

pub(super) const MAP: &str = "\
Examples:
  placegraph map map.yaml --out out
  placegraph map scan.png --resolution 0.05 --out out
  placegraph map map.yaml --out out --export nav2,report --robot-radius 0.22
  placegraph map sites --out results --resume --previous results --edits edits.toml";

pub(super) const INFO: &str = "\
Example:
  placegraph info map.yaml";

pub(super) const TRAIN: &str = "\
Examples:
  placegraph train --map map.yaml --labels labels.png -o my.model.json
  placegraph train --map map.yaml --labels map.json --classes classes.toml -o my.model.json
  placegraph train --map map.yaml --labels labels.png --base default -o my.model.json
  placegraph train training.toml -o my.model.json --report report.html";

pub(super) const LABELS: &str = "\
Examples:
  placegraph labels map.yaml --from out --to labelme -o map.json
  placegraph labels map.yaml --from map.json --to png -o labels.png";

pub(super) const EVALUATE: &str = "\
Examples:
  placegraph evaluate out/labels.png labels.png --resolution 0.05
  placegraph evaluate results maps --csv table.csv
  placegraph evaluate results maps --against earlier-results";

pub(super) const SCAN: &str = "\
Example:
  placegraph scan map.yaml --at -14,1 -o scan.png";

pub(super) const FEATURES: &str = "\
Example:
  placegraph features";

pub(super) const GENERATE: &str = "\
Example:
  placegraph generate --style office --count 5 --seed 7 --out buildings";

pub(super) const EXPORT: &str = "\
Example:
  placegraph export out/topology.json --to graphml -o office.graphml";

pub(super) const PAGE: &str = "\
Example:
  placegraph page -o office.html --map map.yaml";

pub(super) const ALIGN: &str = "\
Example:
  placegraph align monday tuesday";

pub(super) const LIST: &str = "\
Example:
  placegraph list out --class room";

pub(super) const EDIT: &str = "\
Examples:
  placegraph edit rename \"room 7\" kitchen --result out
  placegraph edit add-doorway 2.4,-2.0,4.6,-1.4
  placegraph map map.yaml --out out --edits edits.toml";

pub(super) const REPLAY: &str = "\
Example:
  placegraph replay recording.mcap -o steps";

pub(super) const SITE: &str = "\
Examples:
  placegraph site site.toml --out clinic
  placegraph route clinic/site.json \"L1 room 4\" \"L2 room 7\"";

pub(super) const VERIFY: &str = "\
Example:
  placegraph verify results";

pub(super) const WHERE: &str = "\
Example:
  placegraph where out/topology.json --at 5,3";

pub(super) const ROUTE: &str = "\
Example:
  placegraph route out/topology.json kitchen 12";

pub(super) const COMPLETIONS: &str = "\
Example:
  placegraph completions bash > ~/.local/share/bash-completion/completions/placegraph";

pub(super) const MAN: &str = "\
Example:
  placegraph man map > placegraph-map.1";

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};

    use crate::args::Cli;

    /// The words of a line as a shell splits them, up to where output goes.
    fn words(line: &str) -> Vec<String> {
        let line = line.split(" > ").next().unwrap();
        let quoted = line.split('"').enumerate().flat_map(|(i, part)| match i % 2 {
            0 => part.split_whitespace().map(str::to_owned).collect::<Vec<_>>(),
            _ => vec![part.to_owned()],
        });
        quoted.collect()
    }

    /// Of values that may begin with a hyphen, several at a time swallow all options after them.
    #[test]
    fn no_argument_of_several_values_takes_hyphens() {
        fn check(command: &clap::Command) {
            for arg in command.get_arguments() {
                let is_several = arg.get_num_args().is_some_and(|n| n.max_values() > 1);
                assert!(
                    !(is_several && arg.is_allow_hyphen_values_set()),
                    "{} {}",
                    command.get_name(),
                    arg.get_id()
                );
            }
            command.get_subcommands().for_each(check);
        }
        let mut program = Cli::command();
        program.build();
        check(&program);
    }

    #[test]
    fn the_help_begins_with_what_the_program_does() {
        let help = Cli::command().render_help().to_string();
        assert_eq!(help.lines().next(), Some(super::super::ABOUT));
    }

    #[test]
    fn every_command_has_an_example_that_can_be_typed() {
        let mut program = Cli::command();
        program.build();
        let commands = program.get_subcommands().filter(|command| command.get_name() != "help");
        for command in commands.chain([&program]) {
            let name = command.get_name();
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let examples: Vec<&str> = help.lines().filter(|line| line.starts_with("  placegraph ")).collect();
            assert!(examples.iter().any(|line| line.contains(&format!(" {name}"))), "{name}: {help}");
            for line in examples {
                match Cli::try_parse_from(words(line)) {
                    Ok(cli) => {
                        let is_value = format!("{cli:?}").contains("\"--");
                        assert!(!is_value, "{line}: an option is a value: {cli:?}");
                    }
                    Err(error) => panic!("{line}: {error}"),
                }
            }
        }
    }
}
