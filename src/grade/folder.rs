//! Which file is whose picture of which scene.

use std::ffi::OsStr;
use std::fs::{self, FileType};
use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::words::visible_path;

/// Endings of pictures, those included that are refused: whoever has handed one in is told so.
const ENDINGS: [&str; 16] =
    ["ppm", "pnm", "png", "pgm", "pbm", "pam", "pfm", "bmp", "jpg", "jpeg", "gif", "tif", "tiff", "webp", "tga", "exr"];
/// Folders within a student's folder that are looked into, at the most.
const MOST_FOLDERS: usize = 1000;

/// What a scene's picture is called.
#[derive(Debug, Clone)]
pub struct Sought {
    /// The scene's file name without its ending.
    pub stem: String,
    /// The name that its OUTPUT gives.
    pub output: Option<String>,
}

impl Sought {
    /// How well a file's name fits, 0 best: the OUTPUT name, the scene's name, the OUTPUT name with another ending; of two endings
    /// the one further ahead in [`ENDINGS`].
    fn rank(&self, file: &Path) -> Option<(usize, usize)> {
        let ending = ending(file)?;
        let stem = file.file_stem()?.to_str()?;
        let output = self.output.as_deref().map(Path::new);
        let kind = if output.is_some_and(|output| output.file_name() == file.file_name()) {
            0
        } else if stem == self.stem {
            1
        } else if output.and_then(Path::file_stem).and_then(OsStr::to_str) == Some(stem) {
            2
        } else {
            return None;
        };
        Some((kind, ending))
    }
}

/// The place of a file's ending in [`ENDINGS`].
fn ending(file: &Path) -> Option<usize> {
    let ending = file.extension()?;
    ENDINGS.iter().position(|known| ending.eq_ignore_ascii_case(known))
}

/// What one student has handed in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Submission {
    /// The student: the folder's name, where each student has one; of names that look alike all but the first have a number.
    pub student: Option<String>,
    /// The picture of each scene, in the order of the scenes.
    pub pictures: Vec<Option<PathBuf>>,
}

/// A picture that is not graded.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Extra {
    /// The file.
    pub picture: String,
    /// Why.
    pub reason: String,
}

/// A folder of pictures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folder {
    /// Whose pictures there are, by name.
    pub submissions: Vec<Submission>,
    /// Pictures that are not graded.
    pub extras: Vec<Extra>,
}

impl Folder {
    /// Finds the pictures of `scenes` in `folder`: in itself or, if no picture lies there, in its subfolders, one a student, however deep.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn read(folder: &Path, scenes: &[Sought]) -> io::Result<Self> {
        let (pictures, folders) = entries(folder, true)?;
        let mut found = Self { submissions: Vec::new(), extras: Vec::new() };
        if pictures.is_empty() && !folders.is_empty() {
            for folder in folders {
                let student = found.new_name(&visible_path(Path::new(folder.file_name().unwrap_or_default())));
                let files = all_pictures(&folder, &mut found.extras);
                // Where a former run has put its pages.
                if files.is_empty() && student.ends_with("_files") {
                    found.extras.push(Extra { picture: visible_path(&folder), reason: "pages, no pictures".into() });
                    continue;
                }
                found.add(Some(student), &files, scenes);
            }
        } else {
            found.add(None, &pictures, scenes);
            found.extras.extend(
                folders
                    .iter()
                    .map(|folder| Extra { picture: visible_path(folder), reason: "a folder beside pictures".into() }),
            );
        }
        Ok(found)
    }

    /// A student's name that no other has: names that are not UTF-8 or have hidden characters can look alike.
    fn new_name(&self, name: &str) -> String {
        let is_new = |name: &String| self.submissions.iter().all(|known| known.student.as_ref() != Some(name));
        let numbered = (2..).map(|number| format!("{name} ({number})"));
        std::iter::once(name.to_owned()).chain(numbered).find(is_new).unwrap_or_default()
    }

    fn add(&mut self, student: Option<String>, files: &[PathBuf], scenes: &[Sought]) {
        let mut is_used = vec![false; files.len()];
        let mut pictures = Vec::new();
        for scene in scenes {
            // What is no file is graded only where there is nothing else.
            let fitting = files
                .iter()
                .enumerate()
                .filter_map(|(at, file)| Some((what_instead(file).is_some(), scene.rank(file)?, at)));
            let best = fitting.min().map(|(.., at)| at);
            if let Some(at) = best {
                is_used[at] = true;
            }
            pictures.push(best.map(|at| files[at].clone()));
        }
        for (file, _) in files.iter().zip(is_used).filter(|(_, is_used)| !is_used) {
            let of = scenes.iter().find(|scene| scene.rank(file).is_some());
            let reason = match of {
                Some(scene) => format!("another picture of {} is graded", scene.stem),
                None => "no scene has this name".into(),
            };
            self.extras.push(Extra { picture: visible_path(file), reason });
        }
        self.submissions.push(Submission { student, pictures });
    }
}

/// What bears a picture's name and is no file, in words: of pipes and devices one could read for ever.
pub(super) fn what_instead(path: &Path) -> Option<String> {
    let kind = match fs::metadata(path) {
        Ok(found) if found.is_file() => return None,
        Ok(found) => found.file_type(),
        Err(_) if path.is_symlink() => return Some("a link to a file that is not there".into()),
        Err(error) => return Some(error.to_string()),
    };
    let what = if kind.is_dir() { "a link to a folder" } else { special(kind).unwrap_or("no regular file") };
    Some(format!("{what}, no picture"))
}

#[cfg(unix)]
fn special(kind: FileType) -> Option<&'static str> {
    use std::os::unix::fs::FileTypeExt;
    let kinds = [
        (kind.is_fifo(), "a pipe"),
        (kind.is_socket(), "a socket"),
        (kind.is_block_device() || kind.is_char_device(), "a device"),
    ];
    kinds.into_iter().find(|(is_it, _)| *is_it).map(|(_, what)| what)
}

#[cfg(not(unix))]
fn special(_kind: FileType) -> Option<&'static str> {
    None
}

/// Pictures and folders in a folder, by name, but for hidden ones; links to folders where they are to be followed.
fn entries(folder: &Path, follows: bool) -> io::Result<(Vec<PathBuf>, Vec<PathBuf>)> {
    let (mut pictures, mut folders) = (Vec::new(), Vec::new());
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let path = entry.path();
        if entry.file_name().as_encoded_bytes().starts_with(b".") {
            continue;
        }
        let is_folder = if follows { path.is_dir() } else { entry.file_type()?.is_dir() };
        if is_folder {
            folders.push(path);
        } else if ending(&path).is_some() {
            pictures.push(path);
        }
    }
    pictures.sort();
    folders.sort();
    Ok((pictures, folders))
}

/// All pictures below a folder, those less deep first.
fn all_pictures(folder: &Path, extras: &mut Vec<Extra>) -> Vec<PathBuf> {
    let mut pictures = Vec::new();
    let mut folders = vec![folder.to_owned()];
    let mut at = 0;
    while at < folders.len().min(MOST_FOLDERS) {
        // A link below a student's folder could lead back to it.
        match entries(&folders[at], false) {
            Ok((found, inner)) => {
                pictures.extend(found);
                folders.extend(inner);
            }
            Err(error) => extras.push(Extra { picture: visible_path(&folders[at]), reason: error.to_string() }),
        }
        at += 1;
    }
    let more = folders.iter().skip(MOST_FOLDERS);
    extras.extend(more.map(|folder| Extra { picture: visible_path(folder), reason: "too many folders".into() }));
    pictures
}
