//! The program `placegraph`: arguments, library calls, files. A library, so that the Python package has the same program.

mod args;
mod classes;
mod commands;
mod document;
mod guard;
mod hints;
mod model;
mod output;
pub mod package;
mod progress;
mod read;

use std::ffi::OsString;

use anyhow::{Context, Result, bail};
use clap::Parser;
use placegraph::scan::Instructions;

use crate::args::{Cli, Command};
use crate::commands::{
    Outcome, align, edit, evaluate, export, features, generate, info, labels, list, locate, map, page,
    replay, route, scan, shell, site, train, verify,
};

/// Runs the program with `args`, the first of which is its own name, and returns its exit status.
///
/// Threads are started for the whole process: call it once.
pub fn run(args: impl IntoIterator<Item: Into<OsString> + Clone>) -> u8 {
    let args = args.into_iter().map(|arg| args::no_option(arg.into()));
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version come this way too, on standard output. Nobody listening is no error.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(2);
        }
    };
    guard::install();
    match guard::guarded(|| execute(&cli)) {
        Ok(Outcome::Done) => 0,
        Ok(Outcome::CheckFailed) => 1,
        Err(error) if is_broken_pipe(&error) => 0,
        Err(error) => {
            output::complain(&format!("error: {error:#}"));
            2
        }
    }
}

fn execute(cli: &Cli) -> Result<Outcome> {
    check_instructions()?;
    document::check_fixed_time()?;
    // 0: as many as there are cores.
    rayon::ThreadPoolBuilder::new()
        .num_threads(cli.threads.unwrap_or(0).into())
        .build_global()
        .context("could not start the threads")?;
    match &cli.command {
        Command::Map(args) => map::run(args, cli.verbose),
        Command::Info(args) => info::run(args),
        Command::Train(args) => train::run(args, cli.verbose),
        Command::Labels(args) => labels::run(args),
        Command::Evaluate(args) => evaluate::run(args),
        Command::Scan(args) => scan::run(args),
        Command::Features(args) => features::run(args),
        Command::Generate(args) => generate::run(args),
        Command::Export(args) => export::run(args),
        Command::Page(args) => page::run(args),
        Command::Align(args) => align::run(args),
        Command::List(args) => list::run(args),
        Command::Edit(args) => edit::run(args),
        Command::Replay(args) => replay::run(args),
        Command::Verify(args) => verify::run(args),
        Command::Where(args) => locate::run(args),
        Command::Route(args) => route::run(args),
        Command::Site(args) => site::run(args, cli.verbose),
        Command::Completions(args) => shell::completions(args),
        Command::Man(args) => shell::man(args),
    }
}

/// What the library would not understand, it would not follow.
fn check_instructions() -> Result<()> {
    let Some(found) = std::env::var_os(Instructions::VARIABLE) else { return Ok(()) };
    if found.to_str().and_then(Instructions::from_name).is_none() {
        let names = Instructions::ALL.map(Instructions::name).join(", ");
        bail!("expected {} to be one of {names}, found {}", Instructions::VARIABLE, found.display());
    }
    Ok(())
}

/// Whoever reads our output may stop reading: `placegraph features | head -1`.
fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error
        .chain()
        .filter_map(|cause| cause.downcast_ref::<std::io::Error>())
        .any(|cause| cause.kind() == std::io::ErrorKind::BrokenPipe)
}
