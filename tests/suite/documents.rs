//! What the documents say: their links lead somewhere, the program understands the commands that they show, and tables of speed are of
//! runs that are kept.

use std::collections::BTreeMap;
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

/// What a table calls a scene: a number of spheres with or without commas, or a name.
fn scene_name(name: &str) -> String {
    name.replace(['`', ','], "").trim_start_matches("spheres-").to_owned()
}

/// Each row is a scene, with the medians of preparing and tracing, and behind them of the whole process.
#[test]
fn tables_of_speed_are_of_runs_that_are_kept() {
    let tables: [(_, _, &[_]); 2] = [
        ("README.md", "spheres.csv", &["trueray", "embree", "tachyon", "povray"]),
        ("tests/bench/README.md", "domes.csv", &["trueray", "embree"]),
    ];
    for (document, runs, programs) in tables {
        let read = |name: &str| std::fs::read_to_string(root().join(name)).unwrap();
        let (text, runs) = (read(document), read(&format!("tests/bench/runs/{runs}")));
        let mut times = BTreeMap::<_, Vec<f64>>::new();
        for line in runs.lines().filter(|line| !line.starts_with('#')).skip(1) {
            let [scene, program, what, _, ms] = line.split(',').collect::<Vec<_>>().try_into().unwrap();
            times.entry((scene_name(scene), program, what)).or_default().push(ms.parse().unwrap());
        }
        let median = |scene: &str, program, what| {
            let mut runs = times[&(scene.to_owned(), program, what)].clone();
            assert_eq!(runs.len(), 5, "{scene}, {program}, {what}");
            runs.sort_by(f64::total_cmp);
            runs[2]
        };
        let rows: Vec<Vec<_>> = text.lines().map(|line| line.trim_matches(['|', ' ']).split(" | ").collect()).collect();
        let mut scenes: Vec<_> = times.keys().map(|(scene, ..)| scene).collect();
        scenes.dedup();
        for scene in scenes {
            let time =
                |program| format!("{:.0} ({:.0})", median(scene, program, "both"), median(scene, program, "process"));
            let expected: Vec<_> = programs.iter().copied().map(time).collect();
            let is_there = rows.iter().any(|row| scene_name(row[0]) == *scene && row[1..] == expected);
            assert!(is_there, "{document}: {scene} took {expected:?}");
        }
    }
}
