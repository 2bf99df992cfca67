//! The `trueray` program: parse the arguments, run one subcommand, exit with its code.

use std::process::ExitCode;

fn main() -> ExitCode {
    trueray::cli::run()
}
