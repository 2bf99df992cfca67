//! The heads of the shaders: what they say that a file needs is what it uses, and no file is left over.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use trueray::gpu::{Kernel, Module, Schedule, Secondary, Slots, Storage, Tables, Variant};
use trueray::precision::Tier;
use trueray::sampling::Fill;

use crate::support::root;

/// What stands on its own in a text: the words, and whether they follow a dot or stand before a colon.
fn words(text: &str) -> impl Iterator<Item = (&str, bool, bool)> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut rest = text;
    std::iter::from_fn(move || {
        let start = rest.find(is_part)?;
        let end = rest[start..].find(|c| !is_part(c)).map_or(rest.len(), |length| start + length);
        let (word, is_member) = (&rest[start..end], rest[..start].ends_with('.'));
        rest = &rest[end..];
        Some((word, is_member, rest.trim_start().starts_with(':')))
    })
}

/// A function, struct, variable or constant of a file.
struct Declaration {
    name: String,
    text: String,
}

/// What comes before the name of a declaration.
const KEYWORDS: [&str; 6] = ["fn", "struct", "alias", "const", "override", "var"];

impl Declaration {
    /// What begins at the margin, one after another.
    fn all_of(text: &str) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        let mut attributes = String::new();
        for line in text.lines().map(|line| line.split("//").next().unwrap().trim_end()) {
            let begins = line.starts_with(|c: char| c == '@' || c.is_ascii_alphabetic());
            let keyword = line.split([' ', '<']).find(|word| KEYWORDS.contains(word));
            if let Some(keyword) = keyword.filter(|_| begins) {
                let after = line.split_once(keyword).unwrap().1;
                let after = if after.starts_with('<') { after.split_once('>').unwrap().1 } else { after };
                let name = words(after).next().unwrap().0.to_owned();
                all.push(Self { name, text: std::mem::take(&mut attributes) + line });
            } else {
                let text = all.last_mut().map(|it| &mut it.text).filter(|_| !begins).unwrap_or(&mut attributes);
                text.push_str(line);
                text.push('\n');
            }
        }
        all
    }

    /// The names that it uses and does not declare itself, as a parameter, a member or a local variable.
    fn uses(&self) -> BTreeSet<&str> {
        let mut own = BTreeSet::from([self.name.as_str()]);
        let mut before = "";
        for (word, is_member, is_declared) in words(&self.text) {
            if (is_declared && !is_member) || ["let", "var"].contains(&before) {
                own.insert(word);
            }
            before = word;
        }
        words(&self.text).filter(|(word, is_member, _)| !is_member && !own.contains(word)).map(|it| it.0).collect()
    }
}

/// The texts of the shaders by their names.
fn files() -> BTreeMap<String, String> {
    let entries = std::fs::read_dir(root().join("shaders")).unwrap().map(|entry| entry.unwrap().path());
    let shaders = entries.filter(|path| path.extension().is_some_and(|extension| extension == "wgsl"));
    let named = |path: PathBuf| {
        (path.file_stem().unwrap().to_str().unwrap().to_owned(), std::fs::read_to_string(&path).unwrap())
    };
    shaders.map(named).collect()
}

fn slot_of(name: &str) -> &str {
    name.split('_').next().unwrap()
}

/// The names in the line of a head that begins with this word.
fn head<'a>(text: &'a str, word: &str) -> BTreeSet<&'a str> {
    let head = text.lines().take_while(|line| line.starts_with("//"));
    let lines = head.filter_map(|line| line.strip_prefix(&format!("// {word}: ")));
    lines.flat_map(|names| names.split(", ")).collect()
}

#[test]
fn a_file_needs_what_it_uses_and_nothing_else() {
    let files = files();
    let declared: BTreeMap<_, _> = files.iter().map(|(name, text)| (name, Declaration::all_of(text))).collect();
    let mut slots: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (file, declarations) in &declared {
        for declaration in declarations {
            slots.entry(&declaration.name).or_default().insert(slot_of(file));
        }
    }
    let host: BTreeSet<_> = files.values().flat_map(|text| head(text, "host")).collect();
    for (file, text) in &files {
        let own: BTreeSet<_> = declared[file].iter().map(|it| it.name.as_str()).collect();
        let uses: BTreeSet<_> =
            declared[file].iter().flat_map(Declaration::uses).filter(|it| !own.contains(it)).collect();
        let needs: BTreeSet<_> = uses.iter().filter_map(|name| slots.get(name)).flatten().copied().collect();
        assert_eq!(needs, head(text, "needs"), "shaders/{file}.wgsl, of {uses:?}");
        assert_eq!(
            uses.intersection(&host).copied().collect::<BTreeSet<_>>(),
            head(text, "host"),
            "shaders/{file}.wgsl"
        );
    }
}

/// A picture of few spheres in which nothing refracts.
const PLAIN: Variant = Variant {
    kernel: Kernel::Tier(Tier::Fast),
    storage: Storage::Tables(Tables::Stored),
    secondary: Secondary::Large,
    samples: false,
    refraction: None,
    slots: Slots::Tiles,
    schedule: Schedule::InPlace,
    certified: false,
    dispatch_tiles: 8,
};

/// Some modules that together have every file.
fn modules() -> Vec<Module> {
    let in_turn = Schedule::InTurn(std::num::NonZeroU32::MIN);
    let kernels = Tier::ALL.map(Kernel::Tier).into_iter().chain([Kernel::Pairs, Kernel::Schoolbook, Kernel::NoBarrier]);
    let kernels: Vec<_> = kernels.collect();
    let ways = [
        (Secondary::Grid, Tables::Stored, Slots::Tiles, Schedule::InPlace, None),
        (Secondary::Large, Tables::Sampled, Slots::List, Schedule::AtOnce, None),
        (Secondary::Both, Tables::Stored, Slots::Tiles, in_turn, None),
        (Secondary::Both, Tables::Buffers, Slots::Tiles, in_turn, None),
        (Secondary::Both, Tables::Stored, Slots::Tiles, Schedule::AtOnce, Some(std::num::NonZeroU32::MIN)),
        (Secondary::Grid, Tables::Stored, Slots::List, Schedule::First, None),
    ];
    let pictures = kernels.iter().flat_map(|&kernel| {
        ways.map(|(secondary, tables, slots, schedule, refraction)| {
            let (storage, samples, certified) =
                (Storage::Tables(tables), slots == Slots::List, schedule == Schedule::InPlace || refraction.is_some());
            Module::render(&Variant {
                kernel,
                storage,
                secondary,
                samples,
                refraction,
                slots,
                schedule,
                certified,
                ..PLAIN
            })
        })
    });
    let others = [Module::between_bounces(), Module::flood(), Module::selftest()];
    let others = others.into_iter().chain(Fill::ALL.map(Module::fill));
    let each = kernels.iter().flat_map(|&kernel| {
        let echo = Module::echo(kernel, Tables::Stored);
        [Module::probe(kernel), Module::resolve(kernel), Module::quotients(kernel), echo]
    });
    pictures.chain(others).chain(each).collect()
}

#[test]
fn every_file_is_in_some_module_and_none_has_two_of_a_slot() {
    let mut seen = BTreeSet::new();
    for module in modules() {
        let files: Vec<_> = module.files().filter(|file| file.starts_with("shaders/")).collect();
        let names = files.iter().map(|file| file["shaders/".len()..].trim_end_matches(".wgsl"));
        let slots: BTreeSet<_> = names.map(slot_of).collect();
        assert_eq!(slots.len(), files.len(), "{files:?}");
        seen.extend(files);
    }
    let there: BTreeSet<_> = files().into_keys().map(|name| format!("shaders/{name}.wgsl")).collect();
    assert_eq!(seen, there);
}

/// The page about the shaders has the files of the plain case, and every variant.
#[test]
fn the_page_about_the_shaders_is_right() {
    let page = std::fs::read_to_string(root().join("shaders/README.md")).unwrap();
    let example = page.split("```text\n").nth(1).unwrap().split("```").next().unwrap();
    let named: BTreeSet<_> = example.lines().flat_map(|line| line.split("  ").next().unwrap().split(", ")).collect();
    let module = Module::render(&PLAIN);
    let paths: Vec<_> = module.files().collect();
    let names = paths.iter().filter_map(|path| path.strip_prefix("shaders/")?.strip_suffix(".wgsl"));
    assert_eq!(named, names.collect());
    for name in files().keys() {
        let (slot, variant) = name.split_once('_').unwrap_or((name, name));
        let is_told = [slot, variant].map(|part| page.contains(&format!("`{part}`")));
        assert!(is_told == [true; 2] || page.contains(&format!("`{name}`")) || named.contains(name.as_str()), "{name}");
    }
}

/// The texts below this file or folder of the project, with their paths.
fn texts(path: &Path) -> Vec<(PathBuf, String)> {
    if path.is_dir() {
        let entries = std::fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path());
        return entries.flat_map(|entry| texts(&entry)).collect();
    }
    std::fs::read_to_string(path).map(|text| (path.to_owned(), text)).into_iter().collect()
}

#[test]
fn shaders_that_texts_mention_are_there() {
    let files = files();
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '*';
    let places = ["src", "shaders", "tests/mutations", "README.md", "PRECISION.md", "scenes/README.md"];
    let mut count = 0;
    for (path, text) in places.iter().flat_map(|place| texts(&root().join(place))) {
        for (at, _) in text.match_indices(".wgsl") {
            let name = text[..at].rsplit(|c| !is_part(c)).next().unwrap();
            let (begin, end) = name.split_once('*').unwrap_or((name, ""));
            let is_meant = |file: &String| file.starts_with(begin) && file.ends_with(end);
            let exists = if name.contains('*') { files.keys().any(is_meant) } else { files.contains_key(name) };
            assert!(exists || name.is_empty(), "{}: {name}.wgsl", path.display());
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
}

/// A file that has a slot of its own has no variants, and variants are more than one.
#[test]
fn names_are_those_of_slots_and_variants() {
    let files = files();
    for name in files.keys() {
        let of_slot = files.keys().filter(|other| slot_of(other) == slot_of(name)).count();
        assert_eq!(of_slot == 1, !name.contains('_'), "shaders/{name}.wgsl");
    }
}
