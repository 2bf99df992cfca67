//! Text for people and programs: a reader that has seen enough is no error, and nothing here panics.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};

use super::failure::OUTPUT;

/// Prints to standard output.
pub(super) fn to_stdout(text: Arguments) {
    end_unless(io::stdout().lock().write_fmt(text));
}

/// Ends the program where standard output was not `written`, as on a full disk. A closed pipe is ignored, so that exit codes keep
/// their meaning.
pub(super) fn end_unless(written: io::Result<()>) {
    if let Err(error) = written.and_then(|()| io::stdout().flush())
        && error.kind() != ErrorKind::BrokenPipe
    {
        to_stderr(format_args!("trueray: cannot write standard output: {error}\n"));
        std::process::exit(i32::from(OUTPUT));
    }
}

/// Prints to standard error, as far as anybody listens.
pub(super) fn to_stderr(text: Arguments) {
    // There is nowhere left to report a failure to.
    let _ = io::stderr().lock().write_fmt(text);
}

/// `print!` that does not panic.
macro_rules! out {
    ($($text:tt)*) => { $crate::cli::output::to_stdout(format_args!($($text)*)) };
}

/// `println!` that does not panic.
macro_rules! outln {
    ($($text:tt)*) => { $crate::cli::output::to_stdout(format_args!("{}\n", format_args!($($text)*))) };
}

/// `eprint!` that does not panic.
macro_rules! err {
    ($($text:tt)*) => { $crate::cli::output::to_stderr(format_args!($($text)*)) };
}

/// `eprintln!` that does not panic.
macro_rules! errln {
    ($($text:tt)*) => { $crate::cli::output::to_stderr(format_args!("{}\n", format_args!($($text)*))) };
}

pub(super) use {err, errln, out, outln};
