//! What the documents say: their links lead somewhere, and the program understands the commands that they show.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::support::root;

/// Every document, wherever it lies.
fn documents() -> Vec<(PathBuf, String)> {
    fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap();
            if path.is_dir() && !["target", "node_modules", ".git"].iter().any(|other| name == *other) {
                collect(&path, files);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                files.push(path);
            }
        }
    }
    let mut files = Vec::new();
    collect(root(), &mut files);
    files.sort();
    files.into_iter().map(|file| (file.clone(), std::fs::read_to_string(&file).unwrap())).collect()
}

/// Where a link to a heading leads to, as GitHub names it.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

#[test]
fn links_lead_to_files_and_headings() {
    let mut links = 0;
    for (file, text) in documents() {
        let targets = text.split("](").skip(1).map(|after| after.split(')').next().unwrap());
        for target in targets.filter(|target| !target.contains("://")) {
            let (name, heading) = target.split_once('#').unwrap_or((target, ""));
            let there = if name.is_empty() { file.clone() } else { file.parent().unwrap().join(name) };
            assert!(there.exists(), "{}: {target}", file.display());
            if !heading.is_empty() {
                let text = std::fs::read_to_string(there).unwrap();
                let mut headings = text.lines().filter(|line| line.starts_with('#'));
                assert!(
                    headings.any(|line| anchor(line.trim_start_matches('#')) == heading),
                    "{}: {target}",
                    file.display()
                );
            }
            links += 1;
        }
    }
    assert!(links > 100, "{links}");
}

/// Whether every option is there and has a value of its kind: `--help` at its end is what is carried out.
#[test]
fn commands_are_understood() {
    let mut commands = 0;
    for (file, text) in documents() {
        // What is fenced is every second part.
        let fenced = text.split("```").skip(1).step_by(2).flat_map(str::lines);
        for line in fenced.filter(|line| line.starts_with("trueray ")) {
            let arguments = line.split(['#', '>', '&']).next().unwrap().split_whitespace().skip(1);
            let mut command = Command::new(env!("CARGO_BIN_EXE_trueray"));
            let output = command.args(arguments).arg("--help").stdin(Stdio::null()).output().unwrap();
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{}: {line}\n{stderr}", file.display());
            commands += 1;
        }
    }
    assert!(commands > 10, "{commands}");
}

/// Modules of the suite, but for what others share, are in the table of kinds.
#[test]
fn every_kind_of_test_is_explained() {
    let read = |name: &str| std::fs::read_to_string(root().join("tests").join(name)).unwrap();
    let (table, suite) = (read("README.md"), read("suite/main.rs"));
    let modules = suite.lines().filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';'));
    for module in modules.filter(|module| !["families", "support"].contains(module)) {
        assert!(table.contains(&format!("`{module}`")), "{module}");
    }
}

/// Who opens the project for the first time reads it to its end.
#[test]
fn the_readme_is_short() {
    let lines = std::fs::read_to_string(root().join("README.md")).unwrap().lines().count();
    assert!(lines <= 150, "{lines}");
}
