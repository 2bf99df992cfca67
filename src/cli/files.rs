//! What subcommands that measure write: reports, tables and data.

use std::ffi::OsStr;
use std::path::Path;
use std::time::Duration;

use serde::Serialize;

use super::failure::{Failure, OUTPUT};
use crate::atomic::folder_of;
use crate::film::Target;
use crate::origin::{Origin, origin};

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

/// Bytes of a file's name at the most, on the file systems in use.
const LONGEST_NAME: usize = 255;

/// Whether a file can be there at all: what cannot be written should be known before minutes of measuring.
pub(super) fn check_place(path: &Path) -> Result<(), Failure> {
    let folder = folder_of(path);
    let length = path.file_name().map_or(0, OsStr::len);
    let what = if path.is_dir() {
        "that is a folder".into()
    } else if length > LONGEST_NAME {
        format!("its name has {length} bytes, and file systems take {LONGEST_NAME}")
    } else if !folder.is_dir() {
        format!("there is no folder {}", folder.display())
    } else {
        return Ok(());
    };
    Err(Failure::new(OUTPUT, format!("cannot write {}: {what}", path.display())))
}

/// Writes a text to a file, complete or not at all, or to standard output.
pub(super) fn save(path: &Path, text: &str) -> Result<(), Failure> {
    Ok(crate::film::save_text(&Target::from_argument(path.as_os_str()), text)?)
}

/// A report with who made it.
#[derive(Serialize)]
struct Signed<'a, T> {
    #[serde(flatten)]
    origin: &'static Origin,
    #[serde(flatten)]
    document: &'a T,
}

/// Writes a report as JSON.
pub(super) fn save_report(path: &Path, document: &impl Serialize) -> Result<(), Failure> {
    save(path, &report_json(document)?)
}

/// A report, an object, as JSON for people and programs, with who made it.
pub(super) fn report_json(document: &impl Serialize) -> Result<String, Failure> {
    json(&Signed { origin: origin(), document })
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

/// Likewise; what is longer than clocks can tell is as long as that.
pub(super) fn duration(text: &str) -> Result<Duration, String> {
    Ok(Duration::try_from_secs_f64(seconds(text)?).unwrap_or(Duration::MAX))
}
