//! Files that are complete or not there at all, whatever ends the run.
//!
//! A file is written beside its place, under a name that follows from its own, and takes its place in one step. The name goes when
//! the writer is dropped and when a signal ends the process; what a killed process has left, the next one that writes the same
//! file removes. A lock tells a process that still writes.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

use crate::threads::lock;

/// So many processes can have left something of one file before anything remains.
const SWEPT: u32 = 8;
/// Processes that write one file at the same time.
const MOST: u32 = 10_000;

/// The temporary names that this process has.
static PENDING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn pending() -> MutexGuard<'static, Vec<PathBuf>> {
    lock(&PENDING)
}

/// The folder that a file is in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Removes everything that is half-written, since the process ends now. From here on no file is begun and none takes its place.
pub(crate) fn abandon_all() {
    let pending = pending();
    for path in pending.iter() {
        let _ = fs::remove_file(path);
    }
    std::mem::forget(pending);
}

/// Writes a whole file of a cache, whose loss would not matter.
pub(crate) fn save(path: &Path, parts: &[&[u8]]) -> io::Result<()> {
    let (mut file, destination) = begin(path, None)?;
    parts.iter().try_for_each(|part| file.write_all(part))?;
    destination.commit()
}

/// Begins the file that is to be at `path`, with the permissions of the one that it replaces.
pub(crate) fn begin(path: &Path, replaced: Option<Permissions>) -> io::Result<(Part, Destination)> {
    let (file, temporary) = create(path)?;
    let destination = Destination { file, temporary, path: path.to_owned(), replaced };
    let part = Part { file: destination.file.try_clone()?, unsynced: destination.replaced.as_ref().map(|_| 0) };
    Ok((part, destination))
}

/// The bytes of a file that has not its destination yet.
#[derive(Debug)]
pub(crate) struct Part {
    file: File,
    /// How many the disk may not have; `None` where it need not have them.
    unsynced: Option<usize>,
}

/// Bytes that wait for the disk at the most. A process that waits for it ends only then, whatever the signal.
const UNSYNCED: usize = 16 << 20;

impl Write for Part {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.file.write(bytes)?;
        if let Some(unsynced) = &mut self.unsynced {
            *unsynced += count;
            if *unsynced >= UNSYNCED {
                self.file.sync_data()?;
                *unsynced = 0;
            }
        }
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// The place that a file takes when it is complete; dropped before, the file is gone.
#[derive(Debug)]
pub(crate) struct Destination {
    /// Both handles hold the lock: the file has it until it has its place.
    file: File,
    temporary: PathBuf,
    path: PathBuf,
    replaced: Option<Permissions>,
}

impl Destination {
    /// Puts the file, which is complete, in its place.
    pub(crate) fn commit(mut self) -> io::Result<()> {
        if let Some(permissions) = self.replaced.take() {
            // Without this a power failure can leave the new name with nothing behind it, where there was a file before.
            self.file.sync_data()?;
            fs::set_permissions(&self.temporary, permissions)?;
        }
        let mut pending = pending();
        fs::rename(&self.temporary, &self.path)?;
        pending.retain(|path| *path != self.temporary);
        Ok(())
    }
}

impl Drop for Destination {
    fn drop(&mut self) {
        let mut pending = pending();
        // What is no longer pending has its place, and its old name may be another process's by now.
        if let Some(index) = pending.iter().position(|path| *path == self.temporary) {
            pending.swap_remove(index);
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

/// Creates a locked file under the first temporary name that no other process has, and removes what others have left.
fn create(path: &Path) -> io::Result<(File, PathBuf)> {
    let mut pending = pending();
    for number in 0..MOST {
        let temporary = temporary(path, number);
        remove_left_behind(&temporary);
        let mut options = OpenOptions::new();
        match options.write(true).create_new(true).open(&temporary) {
            // Somebody may have found it before it was locked, and removes it.
            Ok(file) if is_elsewhere(&file, &temporary) => {}
            Ok(file) => {
                pending.push(temporary.clone());
                (number + 1..SWEPT).for_each(|number| remove_left_behind(&self::temporary(path, number)));
                return Ok((file, temporary));
            }
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::new(io::ErrorKind::ResourceBusy, "too many processes write it"))
}

/// The name of a file while it is written. It shows what it was to become, as far as names can be long.
fn temporary(path: &Path, number: u32) -> PathBuf {
    let name: String = path.file_name().unwrap_or_default().to_string_lossy().chars().take(50).collect();
    path.with_file_name(format!(".{name}.trueray-{number}.part"))
}

#[cfg(unix)]
mod system {
    use std::fs::{self, File, OpenOptions};
    use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
    use std::path::Path;

    use rustix::fs::{FlockOperation, OFlags, flock};
    use rustix::io::Errno;

    /// Whether a new file has another owner already, or no longer this name. Some network file systems have no locks: there nobody
    /// removes what others have left either.
    pub(super) fn is_elsewhere(file: &File, path: &Path) -> bool {
        flock(file, FlockOperation::NonBlockingLockExclusive) == Err(Errno::WOULDBLOCK) || !is_at(file, path)
    }

    /// Removes a file that no process writes.
    pub(super) fn remove_left_behind(path: &Path) {
        if !fs::symlink_metadata(path).is_ok_and(|found| found.is_file()) {
            return;
        }
        let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed();
        if let Ok(file) = OpenOptions::new().read(true).custom_flags(flags).open(path)
            && flock(&file, FlockOperation::NonBlockingLockExclusive).is_ok()
            && is_at(&file, path)
        {
            let _ = fs::remove_file(path);
        }
    }

    fn is_at(file: &File, path: &Path) -> bool {
        let id = |found: fs::Metadata| (found.dev(), found.ino());
        fs::symlink_metadata(path).is_ok_and(|named| file.metadata().is_ok_and(|file| id(file) == id(named)))
    }
}

#[cfg(not(unix))]
mod system {
    use std::fs::File;
    use std::path::Path;

    pub(super) fn is_elsewhere(_file: &File, _path: &Path) -> bool {
        false
    }

    pub(super) fn remove_left_behind(_path: &Path) {}
}

use system::{is_elsewhere, remove_left_behind};
