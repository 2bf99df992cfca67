//! What the compiler does not hold of the source: which floor knows which, and that comments name files that are there.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The floors of `src/gpu`, lowest first: a file knows those of its own folder and of floors below.
const FLOORS: [&[&str]; 7] =
    [&["shared.rs"], &["device/"], &["kernel/"], &["table/"], &["tuned.rs"], &["facade.rs"], &["render", "run/"]];

/// How the names of source files end.
const ENDS: [&str; 2] = [".rs", ".wgsl"];

/// Name and text of every source file in a folder of the project and the folders in it.
fn files(folder: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).unwrap() {
        let name = format!("{folder}/{}", entry.as_ref().unwrap().file_name().to_str().unwrap());
        if entry.as_ref().unwrap().path().is_dir() {
            found.extend(files(&name));
        } else if ENDS.iter().any(|end| name.ends_with(end)) {
            found.insert(name, fs::read_to_string(entry.unwrap().path()).unwrap());
        }
    }
    assert!(!found.is_empty(), "{folder}");
    found
}

/// The code of a file without what is in quotes, and its comments.
fn split(text: &str) -> [String; 2] {
    let (mut code, mut comments, mut rest) = (String::new(), String::new(), text);
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            let length = rest.find('\n').unwrap_or(rest.len());
            comments += &rest[..=length.min(rest.len() - 1)];
            length
        } else if rest.starts_with("'\"'") {
            3
        } else if first == '"' {
            let mut is_escaped = false;
            let end = rest[1..].find(|c| {
                let ends = c == '"' && !is_escaped;
                is_escaped = c == '\\' && !is_escaped;
                ends
            });
            end.unwrap() + 2
        } else {
            code.push(first);
            first.len_utf8()
        };
        rest = &rest[length..];
    }
    [code, comments]
}

fn words(code: &str) -> impl Iterator<Item = &str> {
    code.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// The files of `src/gpu` by name, each with those that its paths lead to.
fn arrows() -> BTreeMap<String, BTreeSet<String>> {
    let files = files("src/gpu");
    // A module's own file, and the folder of those in it.
    let file_of = |module: &str| {
        let names = [format!("{module}.rs"), format!("{module}/mod.rs")];
        names.into_iter().find(|name| files.contains_key(name))
    };
    let mut arrows = BTreeMap::new();
    for (name, text) in &files {
        let module = name.trim_end_matches(".rs").trim_end_matches("/mod");
        let mut to = BTreeSet::new();
        for statement in split(text)[0].split_inclusive(';') {
            for start in ["crate::gpu::", "super::", "self::"] {
                for (at, _) in statement.match_indices(start) {
                    let line = &statement[statement[..at].rfind('\n').map_or(0, |end| end + 1)..at];
                    // In a module within the file, `super` is the file.
                    let is_inner = line.starts_with(' ') && line.trim() == "use";
                    if start == "super::" && (is_inner || line.ends_with("::")) {
                        continue;
                    }
                    let base = match start {
                        "crate::gpu::" => "src/gpu",
                        "self::" => module,
                        _ => module.rsplit_once('/').unwrap().0,
                    };
                    to.extend(leads_to(base, &statement[at + start.len()..], &file_of));
                }
            }
            // A path may begin with the name of a module in this one.
            let used = statement.trim().trim_start_matches("pub ").strip_prefix("use ");
            if let Some(path) =
                used.filter(|path| file_of(&format!("{module}/{}", words(path).next().unwrap())).is_some())
            {
                to.extend(leads_to(module, path, &file_of));
            }
        }
        to.remove(name);
        arrows.insert(name.clone(), to);
    }
    arrows
}

/// The files of what `path` has from the module `base` on.
fn leads_to(base: &str, path: &str, file_of: &impl Fn(&str) -> Option<String>) -> BTreeSet<String> {
    if let Some(list) = path.strip_prefix('{') {
        let (mut depth, mut parts, mut part) = (0, Vec::new(), String::new());
        for c in list.chars() {
            match c {
                '}' if depth == 0 => break,
                ',' if depth == 0 => parts.push(std::mem::take(&mut part)),
                _ => {
                    depth += i32::from(c == '{') - i32::from(c == '}');
                    part.push(c);
                }
            }
        }
        parts.push(part);
        return parts.iter().flat_map(|part| leads_to(base, part.trim(), file_of)).collect();
    }
    if let Some(rest) = path.strip_prefix("super::") {
        return leads_to(base.rsplit_once('/').unwrap().0, rest, file_of);
    }
    let next = words(path).next().filter(|word| path.starts_with(word)).unwrap_or_default();
    let inner = format!("{base}/{next}");
    match (file_of(&inner), path[next.len()..].strip_prefix("::")) {
        (Some(_), Some(rest)) if !next.is_empty() => leads_to(&inner, rest, file_of),
        (Some(file), _) if !next.is_empty() => BTreeSet::from([file]),
        _ => file_of(base).into_iter().collect(),
    }
}

#[test]
fn wgpu_is_known_in_one_place() {
    for (name, text) in files("src").into_iter().filter(|(name, _)| !name.starts_with("src/gpu/")) {
        assert!(words(&split(&text)[0]).all(|word| word != "wgpu"), "{name} names wgpu");
    }
}

#[test]
fn the_two_renderers_do_not_know_each_other() {
    for (folder, other) in [("src/cpu", "gpu"), ("src/gpu", "cpu")] {
        for (name, text) in files(folder) {
            assert!(words(&split(&text)[0]).all(|word| word != other), "{name} names {other}");
        }
    }
}

#[test]
fn files_of_the_gpu_path_know_lower_floors_alone() {
    let arrows = arrows();
    let floor = |name: &str| {
        let name = name.strip_prefix("src/gpu/").unwrap();
        let rooms = FLOORS.iter().enumerate().flat_map(|(floor, rooms)| rooms.iter().map(move |room| (floor, *room)));
        rooms.clone().find(|(_, room)| name.starts_with(room)).unwrap_or((FLOORS.len(), "mod.rs"))
    };
    assert!(arrows.values().map(BTreeSet::len).sum::<usize>() > 100, "arrows are found");
    for (from, to) in arrows.iter().flat_map(|(from, all)| all.iter().map(move |to| (from, to))) {
        assert!(floor(from) == floor(to) || floor(from).0 > floor(to).0, "{from} knows {to}, which is no floor below");
    }
    // What knows nothing that is left goes; what stays is in a circle, or above one.
    let mut left = arrows;
    while let Some(free) = left.iter().find(|(_, to)| to.iter().all(|to| !left.contains_key(to))) {
        let free = free.0.clone();
        left.remove(&free);
    }
    assert!(left.is_empty(), "a circle: {left:#?}");
}

#[test]
fn files_that_comments_name_are_there() {
    let all: BTreeMap<_, _> = ["src", "shaders", "tests/suite"].into_iter().flat_map(files).collect();
    let is_there = |named: &str| {
        let is_it = |name: &String| match named.split_once('*') {
            Some((begin, end)) => name.strip_suffix(end).is_some_and(|name| name.contains(begin)),
            None => name.strip_suffix(named).is_some_and(|folder| folder.is_empty() || folder.ends_with('/')),
        };
        all.keys().any(is_it)
    };
    for (name, text) in &all {
        let [_, comments] = split(text);
        let names = comments.split(|c: char| !c.is_alphanumeric() && !"_-./*".contains(c));
        for named in names.filter(|word| ENDS.iter().any(|end| word.len() > end.len() && word.ends_with(end))) {
            assert!(is_there(named), "{name} names {named}");
        }
    }
}

#[test]
fn every_shader_is_in_some_module() {
    let composition: String = files("src/gpu/kernel").into_values().collect();
    for path in files("shaders").keys() {
        let name = path.trim_start_matches("shaders/");
        let is_named = |name: &str| composition.contains(&format!("\"{name}\""));
        assert!(is_named(name) || is_named(name.trim_end_matches(".wgsl")), "{path} is in no module");
    }
}
