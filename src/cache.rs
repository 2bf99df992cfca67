//! The user's cache folder: what is kept there can be lost, and is then found again.

use std::path::PathBuf;

/// The program's own folder in the user's cache folder; `None` where there is no such place. It need not exist yet.
pub(crate) fn folder() -> Option<PathBuf> {
    let cache = std::env::var_os("XDG_CACHE_HOME")
        .map(PathBuf::from)
        .filter(|path| path.is_absolute())
        .or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".cache")))?;
    Some(cache.join("trueray"))
}

/// A name for what belongs to these texts together: FNV-1a. A collision would need two of them on one machine.
pub(crate) fn key(parts: &[&str]) -> String {
    let bytes = parts.iter().flat_map(|part| part.bytes().chain([0]));
    let hash =
        bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    format!("{hash:016x}")
}
