//! The user's cache folder: what is kept there can be lost, and is then found again.

use std::ffi::OsString;
use std::path::PathBuf;

use crate::hash::{EMPTY, fnv1a};

/// The program's own folder in the user's cache folder; `None` where there is no such place. It need not exist yet.
pub(crate) fn folder() -> Option<PathBuf> {
    folder_in(std::env::var_os("XDG_CACHE_HOME"), usual())
}

/// Where the system has such folders.
#[cfg(windows)]
fn usual() -> Option<PathBuf> {
    use etcetera::BaseStrategy as _;
    Some(etcetera::base_strategy::Windows::new().ok()?.cache_dir())
}

/// Where the system has such folders.
#[cfg(not(windows))]
fn usual() -> Option<PathBuf> {
    Some(PathBuf::from(std::env::var_os("HOME")?).join(".cache"))
}

/// With this value of the variable, or else this place. A relative path, as an empty one is, would be another place in each folder
/// where the program runs: it is none.
fn folder_in(variable: Option<OsString>, usual: Option<PathBuf>) -> Option<PathBuf> {
    let cache = variable.map(PathBuf::from).or(usual)?;
    cache.is_absolute().then(|| cache.join("trueray"))
}

/// A name for what belongs to these texts together. A collision would need two of them on one machine.
pub(crate) fn key(parts: &[&str]) -> String {
    let bytes = parts.iter().flat_map(|part| part.bytes().chain([0]));
    format!("{:016x}", fnv1a(EMPTY, bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_absolute_folders_are_used() {
        let folder =
            |variable: Option<&str>, usual: Option<&str>| folder_in(variable.map(Into::into), usual.map(Into::into));
        let root = if cfg!(windows) { "C:\\a" } else { "/a" };
        assert_eq!(folder(Some(root), Some("/b")), Some(PathBuf::from(root).join("trueray")));
        assert_eq!(folder(None, Some(root)), Some(PathBuf::from(root).join("trueray")));
        for none in [(None, None), (None, Some("")), (None, Some("b")), (Some(""), Some(root)), (Some("c"), Some(root))]
        {
            assert_eq!(folder(none.0, none.1), None, "{none:?}");
        }
    }
}
