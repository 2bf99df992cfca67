//! What subcommands that measure write: reports, tables and data.

use std::path::Path;

use serde::Serialize;

use super::failure::{Failure, OUTPUT};
use crate::atomic::folder_of;
use crate::film::Target;

/// The command line as it was given, with the program's plain name; arguments with blanks or quotes are quoted.
pub(super) fn command() -> String {
    let quoted = |argument: String| {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,+:@%".contains(c);
        if !argument.is_empty() && argument.chars().all(plain) {
            argument
        } else {
            format!("'{}'", argument.replace('\'', "'\\''"))
        }
    };
    let arguments = std::env::args_os().skip(1).map(|argument| quoted(argument.to_string_lossy().into_owned()));
    std::iter::once("trueray".to_owned()).chain(arguments).collect::<Vec<_>>().join(" ")
}

/// Whether a file can be there at all: what cannot be written should be known before minutes of measuring.
pub(super) fn check_folder(path: &Path) -> Result<(), Failure> {
    let folder = folder_of(path);
    if path.is_dir() || !folder.is_dir() {
        let what =
            if path.is_dir() { "that is a folder".into() } else { format!("there is no folder {}", folder.display()) };
        return Err(Failure::new(OUTPUT, format!("cannot write {}: {what}", path.display())));
    }
    Ok(())
}

/// Writes a text to a file, complete or not at all, or to standard output.
pub(super) fn save(path: &Path, text: &str) -> Result<(), Failure> {
    Ok(crate::film::save_text(&Target::from_argument(path.as_os_str()), text)?)
}

/// Writes JSON for people and programs.
pub(super) fn save_json(path: &Path, document: &impl Serialize) -> Result<(), Failure> {
    save(path, &json(document)?)
}

/// JSON for people and programs.
pub(super) fn json(document: &impl Serialize) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(document).map_err(|error| Failure::new(OUTPUT, error.to_string()))?;
    Ok(text + "\n")
}

/// A time in seconds on the command line.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds.is_finite() && seconds >= 0.0 => Ok(seconds),
        _ => Err("expected a number of seconds, 0 or more".into()),
    }
}
