//! `trueray completions` and `trueray man`: both come from the command line's own definition.

use clap::Command;
use clap_complete::Shell;
use clap_mangen::Man;

use super::failure::{Failure, OUTPUT, USAGE};
use super::output::out;
use crate::words::visible;

/// Arguments of `trueray completions`.
#[derive(Debug, clap::Args)]
pub(super) struct CompletionsArgs {
    /// The shell that reads the script
    #[arg(value_enum)]
    shell: Shell,
}

/// Arguments of `trueray man`.
#[derive(Debug, clap::Args)]
pub(super) struct ManArgs {
    /// The command whose page it is; without one the program's own
    #[arg(value_name = "COMMAND")]
    command: Option<String>,
}

pub(super) fn completions(args: &CompletionsArgs, mut cli: Command) {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut cli, "trueray", &mut script);
    out!("{}", String::from_utf8_lossy(&script));
}

pub(super) fn man(args: &ManArgs, mut cli: Command) -> Result<(), Failure> {
    // Only then do commands know their full names and the options that all share.
    cli.build();
    let command = match &args.command {
        None => &cli,
        Some(name) => cli.find_subcommand(name).ok_or_else(|| {
            Failure::new(USAGE, format!("there is no command `{}`; `trueray --help` lists them", visible(name)))
        })?,
    };
    let mut page = Vec::new();
    Man::new(command.clone()).render(&mut page).map_err(|error| Failure::new(OUTPUT, error.to_string()))?;
    // The last section is of lines, as --version prints them.
    out!("{}", String::from_utf8_lossy(&page).replace(".SH VERSION\n", ".SH VERSION\n.nf\n"));
    Ok(())
}
