//! Names the commit of a release build in `TRUERAY_COMMIT`, where whoever builds has not: from the repository, or from what
//! `cargo package` has noted. Other builds would have to be linked again with every commit.

use std::path::Path;
use std::process::Command;

/// What `cargo package` leaves in a package.
const NOTED: &str = ".cargo_vcs_info.json";

fn main() {
    println!("cargo::rerun-if-env-changed=TRUERAY_COMMIT");
    println!("cargo::rerun-if-changed=build.rs");
    let is_release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    if std::env::var_os("TRUERAY_COMMIT").is_some() || !is_release {
        return;
    }
    if let Some(commit) = of_repository().or_else(noted) {
        println!("cargo::rustc-env=TRUERAY_COMMIT={commit}");
    }
}

/// The commit that is checked out here; `-dirty` where files differ from it.
fn of_repository() -> Option<String> {
    // A folder within a repository of something else has none of its own.
    if !Path::new(".git").exists() {
        return None;
    }
    for changes in ["logs/HEAD", "HEAD"] {
        let path = git(&["rev-parse", "--git-path", changes])?;
        if Path::new(&path).exists() {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    for folder in ["Cargo.toml", "src", "shaders", "scenes"] {
        println!("cargo::rerun-if-changed={folder}");
    }
    git(&["describe", "--always", "--dirty", "--exclude=*", "--abbrev=10"])
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    (output.status.success() && !text.trim().is_empty()).then(|| text.trim().to_owned())
}

/// The commit that a package was made of.
fn noted() -> Option<String> {
    println!("cargo::rerun-if-changed={NOTED}");
    let text = std::fs::read_to_string(NOTED).ok()?;
    let (_, after) = text.split_once("\"sha1\"")?;
    let commit = after.split('"').nth(1)?;
    let is_dirty =
        text.split_once("\"dirty\"").is_some_and(|(_, after)| after.trim_start_matches([':', ' ']).starts_with("true"));
    Some(format!("{}{}", commit.get(..10)?, if is_dirty { "-dirty" } else { "" }))
}
