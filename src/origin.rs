//! Which program makes a report, and on which machine: the one place of what every report says of that.

use std::env::consts::{ARCH, OS};
use std::fmt;
use std::sync::LazyLock;

use serde::Serialize;

/// Name and version.
pub(crate) const PROGRAM: &str = concat!("trueray ", env!("CARGO_PKG_VERSION"));

/// The commit, where it was known when the program was built.
pub(crate) const COMMIT: Option<&str> = option_env!("TRUERAY_COMMIT");

/// What is said where it was not.
pub(crate) const NO_COMMIT: &str = "not named when it was built (TRUERAY_COMMIT)";

/// How it was built.
pub(crate) const BUILD: &str = if cfg!(debug_assertions) { "debug" } else { "release" };

/// What a report says of who made it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct Origin {
    program: &'static str,
    commit: Option<&'static str>,
    build: &'static str,
    /// The operating system with its versions, and the architecture.
    system: String,
    /// The processor's name and how many threads it runs.
    cpu: String,
}

/// That of this process.
pub(crate) fn origin() -> &'static Origin {
    static ORIGIN: LazyLock<Origin> = LazyLock::new(|| {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        Origin {
            program: PROGRAM,
            commit: COMMIT,
            build: BUILD,
            system: system(),
            cpu: format!("{}, {}", processor(), crate::words::count(threads as u64, "thread")),
        }
    });
    &ORIGIN
}

impl Origin {
    /// Names and values, as its JSON has them.
    pub(crate) fn properties(&self) -> Vec<(String, String)> {
        let Self { program, commit, build, system, cpu } = self;
        let commit = commit.unwrap_or(NO_COMMIT);
        let all = [("program", *program), ("commit", commit), ("build", build), ("system", system), ("cpu", cpu)];
        all.map(|(name, value)| (name.to_owned(), value.to_owned())).to_vec()
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { program, commit, build, system, cpu } = self;
        write!(f, "{program} (commit {}, {build}) on {cpu}; {system}", commit.unwrap_or("not named"))
    }
}

fn system() -> String {
    let first_line = |path: &str| Some(std::fs::read_to_string(path).ok()?.lines().next()?.trim().to_owned());
    let release = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
    let name = release.lines().find_map(|line| line.strip_prefix("PRETTY_NAME=")).map(|name| name.trim_matches('"'));
    let kernel = first_line("/proc/sys/kernel/osrelease");
    let parts = [name.map(str::to_owned), Some(OS.to_owned()), kernel, Some(ARCH.to_owned())];
    parts.into_iter().flatten().collect::<Vec<_>>().join(" ")
}

/// The processor as the system calls it; its architecture where that says nothing.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let named = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    let name = named.map(|(_, name)| name.trim().to_owned()).or_else(|| std::env::var("PROCESSOR_IDENTIFIER").ok());
    name.filter(|name| !name.is_empty()).unwrap_or_else(|| ARCH.to_owned())
}
