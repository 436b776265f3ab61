//! What a user of the program can do about what the library finds: the library knows no options.

use placegraph::import::{Finding, MapError};
use placegraph::pipeline::Frames;

/// A finding in words, with the option that helps.
pub(crate) fn told(finding: &Finding) -> String {
    with_option(&finding.to_string(), about(finding))
}

/// The option that helps about a finding.
fn about(finding: &Finding) -> Option<&'static str> {
    match finding {
        Finding::Gray205Unknown { .. } => Some("to trust them, use --trust-thresholds"),
        Finding::Gray205Free { .. } => Some("leave out --trust-thresholds"),
        Finding::Resolution { .. } => Some("to try another one, use --resolution"),
        _ => None,
    }
}

/// `text`, and in brackets the option that helps.
fn with_option(text: &str, option: Option<&str>) -> String {
    option.map_or_else(|| text.to_owned(), |option| format!("{text} ({option})"))
}

/// The remarks of a result with the options that help: documents name none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Advice(Vec<(String, &'static str)>);

impl Advice {
    /// The advice about the findings of a map and the frame of its earlier result.
    pub(crate) fn new(findings: &[Finding], frames: Option<&Frames>) -> Self {
        let found = findings.iter().filter_map(|finding| Some((finding.to_string(), about(finding)?)));
        let not_aligned = frames.filter(|frames| frames.alignment.is_none()).and_then(Frames::disagreement);
        let align = not_aligned.map(|remark| (remark, "to turn and shift the earlier one, use --align"));
        Self(found.chain(align).collect())
    }

    /// `remark`, with the option that helps, if there is one.
    pub(crate) fn about(&self, remark: &str) -> String {
        let option = self.0.iter().find(|(known, _)| known == remark).map(|(_, option)| *option);
        with_option(remark, option)
    }
}

/// The option that helps against an error.
pub(crate) fn against(error: &MapError) -> Option<&'static str> {
    match error.cause() {
        MapError::NoResolution { .. } => Some("use --resolution METERS"),
        MapError::Outside { .. } => Some("to read images anywhere, use --allow-outside"),
        MapError::SeveralTopics { .. } | MapError::NoSuchTopic { .. } => Some("use --topic TOPIC"),
        MapError::TooManyCells { .. } => Some("to read larger maps, use --max-cells N"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::{Path, PathBuf};

    use clap::{Command, CommandFactory};

    use crate::args::Cli;

    /// Every option of the program and its commands.
    fn options() -> BTreeSet<String> {
        let mut program = Cli::command();
        program.build();
        options_of(&program)
    }

    fn options_of(command: &Command) -> BTreeSet<String> {
        let own = command.get_arguments().filter_map(|arg| arg.get_long().map(|long| format!("--{long}")));
        own.chain(command.get_subcommands().flat_map(options_of)).collect()
    }

    /// What in `text` looks like an option, if a letter stands behind the dashes.
    fn named(text: &str) -> Vec<String> {
        let is_part = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        let starts = text.match_indices("--").map(|(at, _)| at);
        let starts = starts.filter(|&at| !text[..at].ends_with(|c: char| is_part(c) || c == '!'));
        let word = |at: usize| {
            let rest = &text[at..];
            &rest[..rest.find(|c| !is_part(c)).unwrap_or(rest.len())]
        };
        starts
            .map(word)
            .filter(|word| word[2..].starts_with(|c: char| c.is_ascii_lowercase()))
            .map(str::to_owned)
            .collect()
    }

    fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
        let mut found = Vec::new();
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && !path.ends_with("target") && !path.ends_with(".git") {
                found.extend(files(&path, extension));
            } else if path.extension().is_some_and(|e| e == extension) {
                found.push(path);
            }
        }
        found
    }

    /// The code before the tests of a file, without comments.
    fn code(path: &Path) -> String {
        let text = fs::read_to_string(path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
        lines.map(|line| line.split(" // ").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
    }

    fn crates() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
    }

    #[test]
    fn options_are_found_in_texts() {
        let text = "use --gray-205 as-file (--resolution), `--to=svg`; not a--b, -- x, <!--c--> or --- d";
        assert_eq!(named(text), ["--gray-205", "--resolution", "--to"]);
    }

    #[test]
    fn no_text_of_the_library_names_an_option() {
        for path in files(&crates().join("placegraph/src"), "rs") {
            assert_eq!(named(&code(&path)), [""; 0], "{}", path.display());
        }
    }

    #[test]
    fn every_option_that_the_program_names_exists() {
        let options = options();
        let mut n_named = 0;
        for path in files(&crates().join("placegraph-cli/src"), "rs") {
            for option in named(&code(&path)) {
                assert!(options.contains(&option), "{option} in {}", path.display());
                n_named += 1;
            }
        }
        assert!(n_named > 20, "{n_named}");
    }

    /// Options of other programs that the pages run.
    const FOREIGN: [&str; 1] = ["--test"];

    #[test]
    fn every_option_that_a_page_names_exists() {
        let options = options();
        let mut n_named = 0;
        let root = crates().join("..");
        let pages = fs::read_dir(&root).unwrap().map(|entry| entry.unwrap().path());
        let pages = pages.filter(|path| path.extension().is_some_and(|e| e == "md"));
        for path in pages.chain(files(&root.join("docs"), "md")) {
            let text = fs::read_to_string(&path).unwrap();
            let others = [
                "cargo ",
                "pip ",
                "git ",
                "docker ",
                "apt",
                "python",
                "npm",
                "RUSTFLAGS",
                "ros2 ",
                "colcon ",
            ];
            let is_ours = |line: &&str| !others.iter().any(|other| line.contains(other));
            for line in text.lines().filter(is_ours) {
                for option in named(line).into_iter().filter(|option| !FOREIGN.contains(&option.as_str())) {
                    assert!(options.contains(&option), "{option} in {}: {line}", path.display());
                    n_named += 1;
                }
            }
        }
        assert!(n_named > 20, "{n_named}");
    }
}
