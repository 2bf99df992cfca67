//! What a scene's OUTPUT may name: whoever wrote the scene chose it, not who renders.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use super::failure::{Failure, OUTPUT, USAGE};
use crate::atomic::folder_of;
use crate::film::Format;
use crate::words::is_hidden;

/// The format that the ending of a file's name says. Without an ending, and for devices and pipes, that is P6.
pub(super) fn format_by_ending(path: &Path) -> Result<Format, Failure> {
    format_or_refusal(path, ".ppm or .png")
}

/// Likewise; where the ending is none of those that are `known`, the refusal names them.
pub(super) fn format_or_refusal(path: &Path, known: &str) -> Result<Format, Failure> {
    let is_open = path.extension().is_none() || fs::metadata(path).is_ok_and(|found| !found.is_file());
    match Format::from_extension(path) {
        Some(format) => Ok(format),
        None if is_open => Ok(Format::default()),
        None => {
            let message = format!("{}: pictures are written as {known}, nothing else is known", path.display());
            Err(Failure::new(USAGE, message))
        }
    }
}

/// Endings that a picture may have where a format is asked for.
const OTHER_ENDINGS: [&str; 14] =
    ["avif", "bmp", "dib", "exr", "gif", "hdr", "jpeg", "jpg", "pfm", "pic", "tga", "tif", "tiff", "webp"];

/// Refuses a file that no picture of a stranger's scene should become, in the folder that it is written to.
pub(super) fn check_named(path: &Path) -> Result<(), Failure> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_picture_name = Format::from_extension(path).is_some() || OTHER_ENDINGS.contains(&ending.as_str());
    let refused = |why: &str| Err(refusal("OUTPUT", path, why));
    if name.contains(is_hidden) {
        return refused("a name with characters that cannot be seen");
    }
    if name.starts_with('.') {
        return refused("a hidden file");
    }
    if !is_picture_name {
        return refused("which is no picture's name: those end in .ppm, .png, .pfm or .exr");
    }
    check_replaced("OUTPUT", path)
}

/// Refuses to replace what is no picture by a file whose name comes from a stranger's scene; `what` writes it.
pub(super) fn check_replaced(what: &str, path: &Path) -> Result<(), Failure> {
    let refused = |why: &str| Err(refusal(what, path, why));
    match fs::symlink_metadata(path) {
        Err(_) => Ok(()),
        Ok(found) if found.is_symlink() && leaves_its_folder(path) => refused("a link out of the folder"),
        Ok(_) if fs::metadata(path).is_ok_and(|found| found.is_file()) => {
            if begins_like_a_picture(path) {
                Ok(())
            } else {
                refused("over a file that does not begin like a PPM, PNG, PFM or EXR picture")
            }
        }
        Ok(_) => refused("which is no regular file"),
    }
}

fn refusal(what: &str, path: &Path, why: &str) -> Failure {
    // The name may hold anything: it is shown with escapes.
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.escape_debug();
    let help = "help: -o FILE takes any name, --allow-any-output takes OUTPUT as it is";
    Failure::new(OUTPUT, format!("{what} would write `{name}`, {why}\n  {help}"))
}

fn leaves_its_folder(link: &Path) -> bool {
    let folder = folder_of(link).canonicalize().ok();
    link.canonicalize().ok().as_deref().and_then(Path::parent) != folder.as_deref()
}

/// Whether a file may be replaced by a picture: it is one, of a kind that is written here, or empty.
fn begins_like_a_picture(path: &Path) -> bool {
    let mut start = Vec::new();
    let read = File::open(path).and_then(|file| file.take(8).read_to_end(&mut start));
    match (read, start.as_slice()) {
        (Ok(0), _) | (Ok(_), b"\x89PNG\r\n\x1a\n" | [0x76, b'/', b'1', 1, ..]) => true,
        (Ok(_), [b'P', b'3' | b'6' | b'F' | b'f', next, ..]) => next.is_ascii_whitespace() || *next == b'#',
        _ => false,
    }
}
