//! The expected picture of every scene of `scenes/`: `NAME.golden.png` beside `NAME.txt`, in the classic convention; for the
//! hard scenes and those for looking at also `NAME.exact.golden.png`, in the other one.
//!
//! The reference has to equal it byte for byte, and so has the device at `double` where it has `f64`. What the device renders at each
//! tier is recorded in `scenes/hashes.txt`, so that a driver whose bytes differ is seen: on the driver that was recorded other
//! bytes are a failure, on any other they are said aloud and have to be explained pixel by pixel.
//!
//! `TRUERAY_BLESS=all sh tests/run.sh --test suite golden` accepts all pictures and hashes as they are now, a scene's name
//! in place of `all` those of that scene. A failure leaves the expected and the actual picture with their difference, side by side, in
//! `target/tmp/golden/`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use trueray::compare::{Difference, Explanation, three_wide};
use trueray::cpu::Reference;
use trueray::effects::Effects;
use trueray::engine::Backend;
use trueray::film::{Format, Leniency, Picture, Target, read_picture};
use trueray::gpu::Gpu;
use trueray::precision::Tier;
use trueray::scene::Scene;
use trueray::settings::Settings;

use crate::support::{cpu_picture, gpu, gpu_picture, root, say, scene};

/// One test a scene, by the name of its file, and the list of them all.
macro_rules! scenes {
    ($($folder:ident: $($name:ident)*;)*) => {
        $(mod $folder {
            $(#[test]
            fn $name() {
                super::check(concat!(stringify!($folder), "/", stringify!($name)));
            })*
        })*
        const LISTED: &[&str] = &[$($(concat!(stringify!($folder), "/", stringify!($name)),)*)*];
    };
}

scenes! {
    basic:
        behind_the_eye ellipsoid loose_format mirrored_window no_lights no_spheres odd_size off_centre_window
        one_column one_pixel one_row one_sphere overlap seventeen_lights seventeen_spheres ten_thousand_spheres
        upside_down_window window_corner;
    effects:
        ambient ambient_off_colour ambient_off_dark blocker_beyond_light bright_lights coloured_shadows diffuse
        diffuse_off_black diffuse_off_colour ellipsoids everything exponent_half exponent_zero highlights_grazing
        light_behind_eye light_below_horizon light_in_sphere lights_off_dark mirror_misses mirrors_over_one
        negative_scale reflections reflections_depth_1 reflections_off_alone reflections_off_matte
        reflections_touching refraction same_place shadows shadows_off_alone shadows_off_clear
        shadows_off_nothing_lit shadows_one_of_two_lights shell_cut_part_blocks shell_eye_inside shell_lit_inside
        shell_own_shadow shells specular specular_off_matte three_mirrors two_mirrors;
    hard:
        concentric_shells contact discs earth_at_one_metre exponents light_at_surface mirror_corridor
        near_plane_tangent needles pin_head sharp_highlights tangent_rays tiny_blockers translated world_1e20
        world_1e_30;
    refraction:
        bubbles deep ellipsoids eye_inside glass_ball glass_in_glass grazing image_plane invisible over_one
        total_reflection touching;
    show:
        glass showcase;
}

/// Pixels of an expected picture, roughly: 64 × 48.
const PIXELS: f64 = 3072.0;

/// Scenes whose subject is their size.
const AS_THEY_ARE: [&str; 4] = ["basic/odd-size", "basic/one-column", "basic/one-pixel", "basic/one-row"];

/// A scene in a convention, with an expected picture.
struct Subject {
    /// Folder and file name without extension, as they are in `scenes/hashes.txt`.
    name: String,
    scene: Scene,
    settings: Settings,
}

/// All expected pictures: their names, scenes and conventions.
pub(crate) fn all_subjects() -> impl Iterator<Item = (String, Scene, Settings)> {
    LISTED.iter().flat_map(|test| subjects(test)).map(|(name, settings)| {
        let Subject { name, scene, settings } = Subject::new(name, settings);
        (name, scene, settings)
    })
}

/// The names of a scene's expected pictures and their conventions; of the test of this name, which has no hyphens.
fn subjects(test: &str) -> Vec<(String, Settings)> {
    let name = test.replace('_', "-");
    let is_exact_too = name.starts_with("hard/") || name.starts_with("show/");
    let exact = is_exact_too.then(|| (format!("{name}.exact"), Settings::exact()));
    std::iter::once((name, Settings::classic())).chain(exact).collect()
}

impl Subject {
    fn new(name: String, settings: Settings) -> Self {
        let file = name.trim_end_matches(".exact");
        let mut scene = scene(&root().join(format!("scenes/{file}.txt")));
        let factor = (PIXELS / (f64::from(scene.width) * f64::from(scene.height))).sqrt();
        if factor < 1.0 && !AS_THEY_ARE.contains(&file) {
            let [width, height] = [scene.width, scene.height].map(|side| (f64::from(side) * factor).round() as u32);
            (scene.width, scene.height) = (width, height);
        }
        Self { name, scene, settings }
    }

    fn file(&self) -> PathBuf {
        root().join(format!("scenes/{}.golden.png", self.name))
    }

    /// Fails, with the pictures side by side in a file, where they differ.
    fn compare(&self, who: &str, expected: &Picture, actual: &Picture) {
        let name = &self.name;
        let Ok(difference) = Difference::between(expected, actual) else {
            panic!("{name}: {who} gives {actual:?}, expected is {expected:?}");
        };
        if difference.differing.over_0 == 0 {
            return;
        }
        let file = beside_each_other(&format!("{name}-{who}"), expected, actual);
        panic!(
            "{name}: {who} differs from scenes/{name}.golden.png in {} pixels\n{}expected, {who} and difference: {}\n\
             to accept: TRUERAY_BLESS={name} sh tests/run.sh --test suite golden",
            difference.differing.over_0,
            difference.report("expected", who),
            file.display()
        );
    }
}

/// Where the two and their difference are now.
fn beside_each_other(name: &str, expected: &Picture, actual: &Picture) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden");
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join(format!("{}.png", name.replace(['/', ' '], "-")));
    three_wide(expected, actual).unwrap().save(&Target::File(file.clone()), Format::Png).unwrap();
    file
}

fn check(test: &str) {
    for (name, settings) in subjects(test) {
        check_subject(&format!("golden::{}", test.replace('/', "::")), &Subject::new(name, settings));
    }
}

fn check_subject(test: &str, subject: &Subject) {
    let Subject { name, scene, settings } = subject;
    let effects = Effects::of(&scene.viewed(settings));
    let (reference, not_finite) = cpu_picture::<f64>(scene, settings, &effects);
    assert_eq!(not_finite, 0, "{name}");
    let is_blessed = is_blessed(name);
    if is_blessed {
        reference.save(&Target::File(subject.file()), Format::Png).unwrap();
    }
    let expected = match read_picture(&subject.file(), Leniency::Strict) {
        Ok(reading) => reading.picture,
        Err(error) => panic!("{error}\nto accept one: TRUERAY_BLESS={name} sh tests/run.sh --test suite golden"),
    };
    subject.compare("reference", &expected, &reference);

    let Some(gpu) = gpu(test) else { return };
    let mut hashes = Vec::new();
    for tier in Tier::ALL.into_iter().filter(|&tier| gpu.kernel(tier).is_ok()) {
        let (picture, not_finite) = gpu_picture(&gpu, tier, scene, settings, &effects);
        assert_eq!(not_finite, 0, "{name} at {tier}");
        hashes.push((tier, hash(&picture), picture));
    }
    if is_blessed {
        let hashes = hashes.iter().map(|(tier, hash, _)| (tier.to_string(), hash.clone()));
        Hashes::change(&driver(&gpu), name, hashes.collect());
    }
    let recorded = Hashes::load();
    for (tier, hash, picture) in &hashes {
        if *tier == Tier::Double && gpu.device.info.f64 {
            subject.compare("device at double", &expected, picture);
        }
        let known = recorded.of(name, &tier.to_string());
        if known == Some(hash) {
            continue;
        }
        let explanation = {
            let reference = Reference::new(&scene.viewed(settings), &effects);
            Explanation::of(picture, &expected, &reference, &Backend::Device(&gpu, *tier).judge())
        };
        let file = beside_each_other(&format!("{name}-{tier}"), &expected, picture);
        let says = format!(
            "{name} at {tier}: {} {} renders other bytes than those recorded with {} in scenes/hashes.txt ({hash}, not {}): {} \
             pixels differ from the reference, {} of them unexplained, see {}",
            gpu.device.info.name,
            gpu.device.info.driver,
            recorded.driver,
            known.map_or("any", String::as_str),
            explanation.differing,
            explanation.unexplained,
            file.display()
        );
        assert!(recorded.driver != driver(&gpu), "{says}");
        assert_eq!(explanation.unexplained, 0, "{says}\n{}", explanation.report());
        say(test, &says);
    }
}

/// Whether `TRUERAY_BLESS` says that what is rendered is right.
fn is_blessed(name: &str) -> bool {
    let Ok(blessed) = std::env::var("TRUERAY_BLESS") else { return false };
    blessed == "all" || blessed == name || name.ends_with(&format!("/{blessed}"))
}

/// FNV-1a of the pixels and the width, in 64 bits.
fn hash(picture: &Picture) -> String {
    let bytes = picture.width().to_le_bytes().into_iter().chain(picture.rgb().iter().copied());
    let hash =
        bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    format!("{hash:016x}")
}

/// What renders, without the versions that change no byte.
fn driver(gpu: &Gpu) -> String {
    gpu.device.info.name.split(' ').next().unwrap_or_default().to_owned()
}

/// The names of all expected pictures, sorted.
fn names() -> Vec<String> {
    let mut names: Vec<_> = LISTED.iter().flat_map(|test| subjects(test)).map(|(name, _)| name).collect();
    names.sort();
    names
}

/// What a device renders at each tier.
struct Hashes {
    driver: String,
    /// By scene and then by tier.
    scenes: BTreeMap<String, BTreeMap<String, String>>,
}

impl Hashes {
    fn file() -> PathBuf {
        root().join("scenes/hashes.txt")
    }

    fn load() -> Self {
        let text = std::fs::read_to_string(Self::file()).unwrap_or_default();
        let mut hashes = Self { driver: String::new(), scenes: BTreeMap::new() };
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            let mut words = line.split_whitespace();
            match (words.next(), words.next()) {
                (Some("driver"), Some(driver)) => driver.clone_into(&mut hashes.driver),
                (Some(name), first) => {
                    let tiers = first.into_iter().chain(words).map(|word| {
                        let (tier, hash) = word.split_once('=').unwrap_or_else(|| panic!("scenes/hashes.txt: {line}"));
                        (tier.to_owned(), hash.to_owned())
                    });
                    hashes.scenes.insert(name.to_owned(), tiers.collect());
                }
                (None, _) => {}
            }
        }
        hashes
    }

    fn of(&self, name: &str, tier: &str) -> Option<&String> {
        self.scenes.get(name)?.get(tier)
    }

    /// Records a scene's hashes; tests run side by side.
    fn change(driver: &str, name: &str, tiers: BTreeMap<String, String>) {
        static FILE: Mutex<()> = Mutex::new(());
        let _guard = FILE.lock().unwrap_or_else(PoisonError::into_inner);
        let mut hashes = Self::load();
        if hashes.driver != driver {
            hashes.scenes.clear();
        }
        hashes.scenes.insert(name.to_owned(), tiers);
        let names = names();
        hashes.scenes.retain(|name, _| names.contains(name));
        let line = |(name, tiers): (&String, &BTreeMap<String, String>)| {
            let tiers: String = tiers.iter().map(|(tier, hash)| format!(" {tier}={hash}")).collect();
            format!("{name}{tiers}\n")
        };
        let lines: String = hashes.scenes.iter().map(line).collect();
        let head = "# FNV-1a of each scene's expected picture as this driver renders it at each tier: see tests/suite/golden.rs.";
        std::fs::write(Self::file(), format!("{head}\ndriver {driver}\n{lines}")).unwrap();
    }
}

/// Each scene has its test, its picture and its hashes, and there are no others.
#[test]
fn every_scene_is_listed_and_has_an_expected_picture() {
    let folder = root().join("scenes");
    let named = |extension: &'static str| {
        move |entry: std::io::Result<std::fs::DirEntry>| {
            let name = entry.unwrap().file_name().into_string().unwrap();
            name.strip_suffix(extension).map(str::to_owned)
        }
    };
    let in_folders = |extension: &'static str| {
        let folders = ["basic", "effects", "hard", "refraction", "show"];
        let names = folders.map(|name| {
            let entries = std::fs::read_dir(folder.join(name)).unwrap().filter_map(named(extension));
            entries.map(|file| format!("{name}/{file}")).collect::<Vec<_>>()
        });
        let mut names = names.concat();
        names.sort();
        names
    };
    let folders = std::fs::read_dir(&folder).unwrap().filter(|entry| entry.as_ref().unwrap().path().is_dir()).count();
    assert_eq!(folders, 5, "a new folder of scenes belongs into the lists of this test");
    let mut listed: Vec<_> = LISTED.iter().map(|name| name.replace('_', "-")).collect();
    listed.sort();
    let scenes = in_folders(".txt");
    assert_eq!(listed, scenes, "the list in tests/suite/golden.rs and the scenes");
    if std::env::var_os("TRUERAY_BLESS").is_none() {
        assert_eq!(in_folders(".golden.png"), names(), "expected pictures and scenes");
        let recorded = Hashes::load();
        assert_eq!(recorded.scenes.into_keys().collect::<Vec<_>>(), names(), "scenes/hashes.txt and the scenes");
    }
}
