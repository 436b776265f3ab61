//! `placegraph completions` and `placegraph man`: what shells and manuals want to know of the arguments.

use anyhow::{Context, Result};
use clap::CommandFactory;
use clap_mangen::Man;

use super::Outcome;
use crate::args::{Cli, CompletionsArgs, ManArgs};
use crate::output::print;

/// Prints the script that completes arguments.
pub(crate) fn completions(args: &CompletionsArgs) -> Result<Outcome> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "placegraph", &mut script);
    print(&String::from_utf8(script)?)?;
    Ok(Outcome::Done)
}

/// Prints the manual page in roff.
pub(crate) fn man(args: &ManArgs) -> Result<Outcome> {
    let mut program = Cli::command();
    program.build();
    let command = match &args.command {
        None => program,
        Some(name) => {
            let found = program.find_subcommand(name);
            let command =
                found.with_context(|| format!("expected a command of placegraph, found {name:?}"))?;
            // The head of the page names it.
            command.clone().version(env!("CARGO_PKG_VERSION"))
        }
    };
    let mut page = Vec::new();
    Man::new(command).render(&mut page)?;
    print(&String::from_utf8(page)?)?;
    Ok(Outcome::Done)
}
