//! The user's cache folder: what is kept there can be lost, and is then found again.

use std::ffi::OsString;
use std::path::PathBuf;

use crate::hash::{EMPTY, fnv1a};

/// The program's own folder in the user's cache folder; `None` where there is no such place. It need not exist yet.
pub(crate) fn folder() -> Option<PathBuf> {
    folder_in(std::env::var_os("XDG_CACHE_HOME"), std::env::var_os("HOME"))
}

/// With these values of the variables. A relative path, as an empty one is, would be another place in each folder where the program
/// runs: it is none.
fn folder_in(cache: Option<OsString>, home: Option<OsString>) -> Option<PathBuf> {
    let cache = match cache {
        Some(cache) => PathBuf::from(cache),
        None => PathBuf::from(home?).join(".cache"),
    };
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
        let folder = |cache: Option<&str>, home: Option<&str>| folder_in(cache.map(Into::into), home.map(Into::into));
        let root = if cfg!(windows) { "C:\\a" } else { "/a" };
        assert_eq!(folder(Some(root), Some("/b")), Some(PathBuf::from(root).join("trueray")));
        assert_eq!(folder(None, Some(root)), Some(PathBuf::from(root).join(".cache").join("trueray")));
        for none in [(None, None), (None, Some("")), (None, Some("b")), (Some(""), Some(root)), (Some("c"), Some(root))]
        {
            assert_eq!(folder(none.0, none.1), None, "{none:?}");
        }
    }
}
