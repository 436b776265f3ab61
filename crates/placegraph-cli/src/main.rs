//! The program `placegraph`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(placegraph_cli::run(std::env::args_os()))
}
