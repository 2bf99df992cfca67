//! A folder where the program runs, as a user has it.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// A folder of its own, which goes with it.
pub(crate) struct Folder(TempDir);

impl Folder {
    /// Without a file.
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// With these files.
    pub(crate) fn with(files: &[(&str, &[u8])]) -> Self {
        let folder = Self::new();
        for (name, contents) in files {
            folder.write(name, contents);
        }
        folder
    }

    /// With a scene in `scene.txt`.
    pub(crate) fn with_scene(scene: &str) -> Self {
        Self::with(&[("scene.txt", scene.as_bytes())])
    }

    /// The folder itself.
    pub(crate) fn folder(&self) -> &Path {
        self.0.path()
    }

    /// Of a file in it.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        fs::write(self.path(name), contents).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// The names of its files, sorted.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder()).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The program with these arguments, which no space is part of.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        self.command_of(arguments.split_whitespace())
    }

    /// Likewise with any arguments.
    pub(crate) fn command_of<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
        command.args(arguments).current_dir(self.folder()).stdin(Stdio::null());
        for variable in ["WGPU_ADAPTER_NAME", "WGPU_BACKEND", "WGPU_POWER_PREF"] {
            command.env_remove(variable);
        }
        command
    }

    /// Runs to the end.
    pub(crate) fn run(&self, arguments: &str) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Runs, and compares code and message.
    #[track_caller]
    pub(crate) fn exits(&self, arguments: &str, code: i32, message: &str) -> Output {
        let output = self.run(arguments);
        assert_exit(&output, code, message);
        output
    }

    /// Likewise where the message may also be on standard output.
    #[track_caller]
    pub(crate) fn says(&self, arguments: &str, code: i32, message: &str) {
        let output = self.run(arguments);
        let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert_exit(&output, code, "");
        assert!(said.contains(message), "{arguments}: expected '{message}' in:\n{said}");
    }
}

/// Compares the exit code and what is said.
#[track_caller]
pub(crate) fn assert_exit(output: &Output, code: i32, message: &str) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    assert!(stderr.contains(message), "expected '{message}' in:\n{stderr}");
    assert!(!stderr.contains("panicked"), "{stderr}");
}
