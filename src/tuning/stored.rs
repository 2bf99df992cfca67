//! The tuning that `trueray bench --tune` found best on a device, kept for later runs on it.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::Tuning;
use crate::cache;
use crate::film::{OutputError, Target, save_text};

/// Set to anything but 0, this variable keeps devices at their class's tuning.
pub const IGNORE: &str = "TRUERAY_NO_TUNING";

/// Where a device's tuning comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// From its class.
    Class,
    /// From this file.
    File(PathBuf),
}

/// What the file has.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    device: String,
    driver: String,
    tuning: Tuning,
}

/// What is kept for a device.
#[derive(Debug, Clone, PartialEq)]
pub enum StoredTuning {
    /// Nothing, or it is not wanted.
    Nothing,
    /// A tuning in a file.
    Tuning(Tuning, PathBuf),
    /// A file that cannot be used, but can be made anew; why, in words that name it.
    Unusable(String),
    /// A place that cannot be read; why, in words that name it. As a rule nothing can be kept there, which is no news at each run.
    Closed(String),
}

/// The file for the device of this name with this driver.
fn path(device: &str, driver: &str) -> Option<PathBuf> {
    Some(cache::folder()?.join(format!("tuning-{}.json", cache::key(&[device, driver]))))
}

/// What is kept for the device of this name with this driver.
pub fn load(device: &str, driver: &str) -> StoredTuning {
    if std::env::var_os(IGNORE).is_some_and(|value| !value.is_empty() && value != "0") {
        return StoredTuning::Nothing;
    }
    path(device, driver).map_or(StoredTuning::Nothing, |path| read(&path, device, driver))
}

fn read(path: &Path, device: &str, driver: &str) -> StoredTuning {
    let unusable = |why: String| {
        StoredTuning::Unusable(format!(
            "the tuning in {} is ignored: {why}; `trueray bench --tune` makes it anew",
            path.display()
        ))
    };
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == ErrorKind::NotFound => return StoredTuning::Nothing,
        // What is no text is a file that was damaged.
        Err(error) if error.kind() == ErrorKind::InvalidData => return unusable(error.to_string()),
        Err(error) => return StoredTuning::Closed(format!("{} cannot be read: {error}", path.display())),
    };
    let file: File = match serde_json::from_str(&text) {
        Ok(file) => file,
        Err(error) => return unusable(error.to_string()),
    };
    if file.device != device || file.driver != driver {
        return unusable(format!("it is for {} with {}", file.device, file.driver));
    }
    match file.tuning.problem() {
        Some(problem) => unusable(problem),
        None => StoredTuning::Tuning(file.tuning, path.to_owned()),
    }
}

/// Keeps `tuning` for the device of this name with this driver; returns the file, or `None` where there is no cache folder.
pub fn save(device: &str, driver: &str, tuning: Tuning) -> Result<Option<PathBuf>, OutputError> {
    let Some(path) = path(device, driver) else { return Ok(None) };
    let file = File { device: device.into(), driver: driver.into(), tuning };
    let text = serde_json::to_string_pretty(&file).unwrap_or_default() + "\n";
    if let Some(folder) = path.parent() {
        // Where it cannot be made, the file cannot either, and that error names it.
        let _ = std::fs::create_dir_all(folder);
    }
    save_text(&Target::File(path.clone()), &text)?;
    Ok(Some(path))
}
