//! No input of a run is an output of it, and no two outputs are one file, whatever they are called.

use std::collections::{HashMap, HashSet};
use std::ffi::OsString;
use std::fs::{self, Metadata};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::failure::{Failure, OUTPUT};
use super::files::check_place;
use crate::atomic::folder_of;

/// The files that a run reads and writes.
#[derive(Debug, Default)]
pub(super) struct Guard {
    inputs: Vec<(Identity, PathBuf)>,
    outputs: HashMap<Identity, String>,
    written: HashSet<Identity>,
}

/// What makes two names one file.
#[derive(Debug, PartialEq, Eq, Hash)]
enum Identity {
    File(Id),
    /// A name in a folder that has no such file yet.
    New(Id, OsString),
    /// Standard output that goes to no file.
    Stdout,
}

impl Guard {
    /// For a run that reads these files; `-` is standard input.
    pub(super) fn new<'a>(inputs: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        let of = |path: &PathBuf| if path == Path::new("-") { of_stdin() } else { identity(path) };
        let inputs = inputs.into_iter().filter_map(|path| Some((of(path)?, path.clone()))).collect();
        Self { inputs, ..Self::default() }
    }

    /// Refuses a file that the run reads, or that it also writes for another reason. `what` says what is
    /// to be written; `-` is standard output.
    pub(super) fn output(&mut self, what: &str, path: &Path) -> Result<(), Failure> {
        if let Some(identity) = self.free(what, path)? {
            self.outputs.insert(identity, what.to_owned());
        }
        Ok(())
    }

    /// The same of what may be written later.
    pub(super) fn check_free(&self, what: &str, path: &Path) -> Result<(), Failure> {
        self.free(what, path).map(drop)
    }

    /// What makes this the file that it is, where it is one and the run has no other use for it.
    fn free(&self, what: &str, path: &Path) -> Result<Option<Identity>, Failure> {
        let identity = if path == Path::new("-") { of_stdout() } else { identity(path) };
        // What is no regular file, such as a device or a pipe, loses nothing.
        let Some(identity) = identity else { return Ok(None) };
        let name = if path == Path::new("-") { "standard output".into() } else { path.display().to_string() };
        let refused = |why: String| Err(Failure::new(OUTPUT, format!("{what} would overwrite {name}, {why}")));
        if let Some((_, input)) = self.inputs.iter().find(|(input, _)| *input == identity) {
            let alias = match input {
                input if input == path => String::new(),
                input if input == Path::new("-") => ": it is standard input".into(),
                input => format!(": it is {}", input.display()),
            };
            return refused(format!("an input of this run{alias}"));
        }
        if let Some(other) = self.outputs.get(&identity) {
            return refused(format!("which {other} writes"));
        }
        Ok(Some(identity))
    }

    /// The same of what options name; it must also be possible to write it.
    pub(super) fn options<'a>(
        &mut self,
        outputs: impl IntoIterator<Item = (&'a str, &'a Option<PathBuf>)>,
    ) -> Result<(), Failure> {
        let named = outputs.into_iter().filter_map(|(what, path)| Some((what, path.as_deref()?)));
        named.into_iter().try_for_each(|(what, path)| {
            check_place(path)?;
            self.output(what, path)
        })
    }

    /// Refuses a file that the run has written already: some file systems take names for the same that look different.
    pub(super) fn check_unwritten(&self, what: &str, path: &Path) -> Result<(), Failure> {
        if identity(path).is_some_and(|identity| self.written.contains(&identity)) {
            let message = format!("{what} would overwrite {}, which this run has written", path.display());
            return Err(Failure::new(OUTPUT, message));
        }
        Ok(())
    }

    /// The run has written this file.
    pub(super) fn written(&mut self, path: &Path) {
        self.written.extend(identity(path));
    }
}

/// What stands for the regular file at `path`, be it there or not; `None` for what is no regular file.
fn identity(path: &Path) -> Option<Identity> {
    match fs::metadata(path) {
        Ok(found) => found.is_file().then(|| id(&found, path)).flatten().map(Identity::File),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let folder = folder_of(path);
            if let Ok(to) = fs::read_link(path) {
                return identity(&folder.join(to));
            }
            Some(Identity::New(id(&fs::metadata(folder).ok()?, folder)?, path.file_name()?.to_owned()))
        }
        Err(_) => None,
    }
}

#[cfg(unix)]
type Id = (u64, u64);

#[cfg(unix)]
#[allow(clippy::unnecessary_wraps, reason = "elsewhere there may be none")]
fn id(found: &Metadata, _path: &Path) -> Option<Id> {
    use std::os::unix::fs::MetadataExt;
    Some((found.dev(), found.ino()))
}

#[cfg(unix)]
fn of_stdin() -> Option<Identity> {
    of_stream(std::io::stdin())
}

#[cfg(unix)]
fn of_stdout() -> Option<Identity> {
    of_stream(std::io::stdout()).or(Some(Identity::Stdout))
}

/// The regular file that a stream is redirected to.
#[cfg(unix)]
fn of_stream(stream: impl std::os::fd::AsFd) -> Option<Identity> {
    let file = fs::File::from(stream.as_fd().try_clone_to_owned().ok()?);
    let found = file.metadata().ok().filter(Metadata::is_file)?;
    id(&found, Path::new("-")).map(Identity::File)
}

#[cfg(not(unix))]
type Id = PathBuf;

#[cfg(not(unix))]
fn id(_found: &Metadata, path: &Path) -> Option<Id> {
    path.canonicalize().ok()
}

#[cfg(not(unix))]
fn of_stdin() -> Option<Identity> {
    None
}

#[cfg(not(unix))]
fn of_stdout() -> Option<Identity> {
    Some(Identity::Stdout)
}
