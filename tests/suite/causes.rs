//! `compare --explain`: pictures with planted mistakes, and what is named.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use tempfile::tempdir;
use trueray::DVec3;
use trueray::compare::Explanation;
use trueray::cpu::{Judge, Reference};
use trueray::effects::Effects;
use trueray::film::Picture;
use trueray::mistakes::{CAUSES, Diagnosis, Role, diagnose, diagnose_size, planted, plants};
use trueray::pattern::Pattern;
use trueray::precision::Tier;
use trueray::scene::Scene;
use trueray::settings::{Quantize, SampleOffset, Settings, Specular};

use super::support::{is_set, root, say, scene, scene_files};

/// A scene whose picture is to be explained.
struct Case {
    scene: Scene,
    settings: Settings,
}

impl Case {
    /// A scene of the project, with a small picture.
    fn of(name: &str, settings: Settings) -> Self {
        let mut scene = scene(&root().join("scenes").join(name));
        let factor = 72.0 / f64::from(scene.width.max(scene.height));
        (scene.width, scene.height) =
            ((f64::from(scene.width) * factor).ceil() as u32, (f64::from(scene.height) * factor).ceil() as u32);
        Self { scene, settings }
    }

    fn classic(name: &str) -> Self {
        Self::of(name, Settings::classic())
    }

    /// The reference's picture of a scene, which may be another one.
    fn rendered(scene: &Scene, settings: &Settings) -> Picture {
        let viewed = scene.viewed(settings);
        picture(&Reference::<f64>::new(&viewed, &Effects::of(&viewed)))
    }

    fn right(&self) -> Picture {
        Self::rendered(&self.scene, &self.settings)
    }

    fn diagnosis(&self, theirs: &Picture) -> Diagnosis {
        self.diagnosis_within(theirs, None)
    }

    fn diagnosis_within(&self, theirs: &Picture, time: Option<Duration>) -> Diagnosis {
        let viewed = self.scene.viewed(&self.settings);
        let effects = Effects::of(&viewed);
        let reference = Reference::new(&viewed, &effects);
        let expected = picture(&reference);
        let explanation = Explanation::of(theirs, &expected, &reference, &Judge::of(Tier::Fast));
        diagnose(theirs, &expected, &viewed, &effects, &explanation.places, time)
    }

    /// The picture with the ways of these numbers.
    fn planted(&self, ways: &[usize]) -> Picture {
        let viewed = self.scene.viewed(&self.settings);
        planted(&viewed, &Effects::of(&viewed), ways)
    }

    fn plants(&self) -> Vec<(&'static str, String)> {
        let viewed = self.scene.viewed(&self.settings);
        plants(&viewed, &Effects::of(&viewed))
    }
}

fn picture<T: trueray::cpu::Real>(reference: &Reference<T>) -> Picture {
    let (width, height) = reference.size();
    let mut rgb = vec![0; (width * height * 3) as usize];
    reference.rows(0, &mut rgb).unwrap();
    Picture::new(width, height, rgb).unwrap()
}

fn differing(a: &Picture, b: &Picture) -> usize {
    a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a != b).count()
}

fn names(diagnosis: &Diagnosis) -> Vec<&'static str> {
    diagnosis.causes.iter().map(|cause| cause.name).collect()
}

/// Whether a cause is the first that is named, or would explain just as much.
fn is_named(diagnosis: &Diagnosis, name: &str) -> bool {
    let is_it = |(place, cause): (usize, &trueray::mistakes::Cause)| {
        cause.name == name && (place == 0 || cause.role == Role::Equal)
    };
    diagnosis.causes.iter().enumerate().any(is_it)
}

/// Scenes that show many of the rules.
const SCENES: [&str; 7] = [
    "effects/everything.txt",
    "effects/shell-lit-inside.txt",
    "effects/coloured-shadows.txt",
    "effects/two-mirrors.txt",
    "effects/shell-own-shadow.txt",
    "effects/blocker-beyond-light.txt",
    "basic/overlap.txt",
];

#[test]
fn the_textbook_is_the_reference() {
    let is_small = |file: &PathBuf| !file.ends_with("ten-thousand-spheres.txt");
    for file in scene_files(&["basic", "effects", "refraction", "show"]).into_iter().filter(is_small) {
        for settings in [
            Settings::classic(),
            Settings::exact(),
            Settings { pattern: Pattern::Grid { side: 2 }, ..Settings::exact() },
        ] {
            let case = Case::of(file.to_str().unwrap(), settings);
            let viewed = case.scene.viewed(&settings);
            let reference = Reference::new(&viewed, &Effects::of(&viewed));
            let (ours, right) = (case.planted(&[]), picture(&reference));
            let explanation = Explanation::of(&ours, &right, &reference, &Judge::of(Tier::Double));
            assert!(explanation.unexplained == 0 && explanation.differing < 3, "{}", file.display());
        }
    }
}

#[test]
fn planted_mistakes_are_named() {
    let all = is_set("TRUERAY_CAUSES");
    let (mut planted, mut named, mut shown) = (0, 0, std::collections::BTreeMap::<_, u32>::new());
    for name in SCENES {
        let case = Case::classic(name);
        let right = case.right();
        for (way, (name, detail)) in case.plants().into_iter().enumerate() {
            let times = shown.entry(name).or_default();
            let is_turn = all || way % 11 == 0;
            if *times >= if all { 3 } else { 1 } || !is_turn {
                continue;
            }
            let theirs = case.planted(&[way]);
            if differing(&theirs, &right) < 12 {
                continue;
            }
            *times += 1;
            planted += 1;
            let found = case.diagnosis(&theirs);
            if is_named(&found, name) {
                named += 1;
            } else {
                say("causes", &format!("{name} ({detail}): {:?}", names(&found)));
            }
        }
    }
    say("causes", &format!("{named} of {planted} mistakes are named"));
    assert!(planted > 10 && named * 100 >= planted * 95, "{named} of {planted}");
}

#[test]
fn pairs_of_mistakes_are_named() {
    let pairs = [
        ("flipped-vertically", "levels-rounded"),
        ("gamma-2-2", "specular-blinn"),
        ("channels-swapped", "normal-from-center"),
    ];
    let case = Case::classic("effects/everything.txt");
    let ways = case.plants();
    let way = |name: &str| ways.iter().position(|(other, _)| *other == name).unwrap();
    let mut named = 0;
    for (a, b) in pairs {
        let found = names(&case.diagnosis(&case.planted(&[way(a), way(b)])));
        let first = &found[..found.len().min(3)];
        if first.contains(&a) && first.contains(&b) {
            named += 1;
        } else {
            say("causes", &format!("{a} and {b}: {found:?}"));
        }
    }
    assert!(named == pairs.len(), "{named} of {}", pairs.len());
}

#[test]
fn right_pictures_have_no_cause() {
    for name in SCENES {
        for settings in [Settings::classic(), Settings::exact()] {
            let case = Case::of(name, settings);
            assert_eq!(case.diagnosis(&case.right()).causes, [], "{name}");
            // In single precision, too.
            let viewed = case.scene.viewed(&case.settings);
            let single = picture(&Reference::<f32>::new(&viewed, &Effects::of(&viewed)));
            assert_eq!(case.diagnosis(&single).causes, [], "{name}");
        }
    }
}

#[test]
fn pictures_of_something_else_have_no_cause() {
    let case = Case::classic("effects/everything.txt");
    let mut other = Case::classic("effects/coloured-shadows.txt");
    (other.scene.width, other.scene.height) = (case.scene.width, case.scene.height);
    assert_eq!(case.diagnosis(&other.right()).causes, []);
    // A few wrong pixels are not blamed on what would change many.
    let mut rgb = case.right().into_rgb();
    rgb[3000..3012].iter_mut().for_each(|sample| *sample ^= 0x55);
    let spoiled = Picture::new(case.scene.width, case.scene.height, rgb).unwrap();
    let found = case.diagnosis(&spoiled);
    assert_eq!((found.causes, found.to_explain), (vec![], 4));
    for level in [0, 255] {
        let rgb = vec![level; spoiled.rgb().len()];
        let plain = Picture::new(case.scene.width, case.scene.height, rgb).unwrap();
        assert_eq!(case.diagnosis(&plain).causes, []);
    }
}

/// Mistakes that other code than the one under test plants: the reference with other settings or another scene, and bytes.
#[test]
fn mistakes_by_other_means_are_named() {
    let case = Case::classic("effects/everything.txt");
    let classic = Settings::classic();
    let with = |settings: Settings| Case::rendered(&case.scene, &settings);
    let of = |change: &dyn Fn(&mut Scene)| {
        let mut scene = case.scene.clone();
        change(&mut scene);
        Case::rendered(&scene, &classic)
    };
    let right = case.right();
    let (width, height) = (right.width(), right.height());
    let by_pixel = |of: &dyn Fn(u32, u32) -> [u8; 3]| {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| of(x, y));
        Picture::new(width, height, pixels.collect()).unwrap()
    };
    let gamma = |level: u8| (255.0 * (f64::from(level) / 255.0).powf(1.0 / 2.2)) as u8;
    let planted: [(&str, Picture); 21] = [
        ("other-convention", with(Settings::exact())),
        ("sample-at-center", with(Settings { sampling: SampleOffset::Center, ..classic })),
        ("sample-at-bottom-left", with(Settings { sampling: SampleOffset::BottomLeft, ..classic })),
        ("levels-rounded", with(Settings { quantize: Quantize::Round, ..classic })),
        ("levels-times-255-9", with(Settings { quantize: Quantize::Overscale, ..classic })),
        ("specular-blinn", with(Settings { specular: Specular::Blinn, ..classic })),
        ("no-reflections", with(Settings { max_depth: 0, ..classic })),
        ("reflection-depth", with(Settings { max_depth: 1, ..classic })),
        ("ambient-missing", of(&|scene| scene.ambient = DVec3::ZERO)),
        ("light-missing", of(&|scene| _ = scene.lights.remove(0))),
        ("light-intensity", of(&|scene| scene.lights[0].intensity *= 0.6)),
        ("background-color", of(&|scene| scene.background = DVec3::new(0.3, 0.6, 0.1))),
        ("sphere-missing", of(&|scene| _ = scene.spheres.remove(1))),
        ("sphere-color", of(&|scene| scene.spheres[1].color = DVec3::new(0.15, 0.85, 0.35))),
        ("sphere-moved", of(&|scene| scene.spheres[1].center.x += 0.4)),
        ("sphere-scaled", of(&|scene| scene.spheres[1].scale *= 1.3)),
        ("specular-missing", of(&|scene| scene.spheres.iter_mut().for_each(|sphere| sphere.ks = 0.0))),
        ("exponent-wrong", of(&|scene| scene.spheres.iter_mut().for_each(|sphere| sphere.n *= 2.0))),
        ("flipped-horizontally", by_pixel(&|x, y| right.pixel(width - 1 - x, y))),
        ("channels-swapped", by_pixel(&|x, y| [2, 1, 0].map(|c| right.pixel(x, y)[c]))),
        ("gamma-2-2", by_pixel(&|x, y| right.pixel(x, y).map(gamma))),
    ];
    let mut missed = Vec::new();
    for (name, theirs) in &planted {
        assert!(differing(theirs, &right) > 0, "{name}");
        let found = case.diagnosis(theirs);
        if !is_named(&found, name) {
            missed.push(format!("{name}: {:?}", names(&found)));
        }
    }
    assert!(missed.len() <= 1, "{missed:#?}");
}

#[test]
fn other_sizes_are_explained() {
    let case = Case::classic("effects/everything.txt");
    let viewed = case.scene.viewed(&case.settings);
    let effects = Effects::of(&viewed);
    let right = case.right();
    let without_a_row =
        Picture::new(right.width(), right.height() - 1, right.rgb()[right.width() as usize * 3..].to_vec());
    let found = diagnose_size(&without_a_row.unwrap(), &viewed, &effects, None);
    assert_eq!((names(&found)[0], found.left), ("size-off-by-one", 0));
    let transposed = (0..right.width()).flat_map(|y| (0..right.height()).map(move |x| (x, y)));
    let rgb = transposed.flat_map(|(x, y)| right.pixel(y, x)).collect();
    let found = diagnose_size(&Picture::new(right.height(), right.width(), rgb).unwrap(), &viewed, &effects, None);
    assert_eq!((names(&found)[0], found.left), ("transposed", 0));
    // Much of the background is there, however a picture is turned.
    let mut lonely = case.scene.clone();
    lonely.spheres.truncate(1);
    (lonely.spheres[0].center, lonely.spheres[0].scale) = (DVec3::new(0.5, 0.2, -4.0), DVec3::splat(0.4));
    (lonely.width, lonely.height) = (72, 48);
    let mut swapped = lonely.clone();
    (swapped.width, swapped.height) = (48, 72);
    let viewed = lonely.viewed(&case.settings);
    let theirs = Case::rendered(&swapped, &case.settings);
    let found = diagnose_size(&theirs, &viewed, &Effects::of(&viewed), None);
    assert_eq!((names(&found)[0], found.left), ("size-swapped", 0));
}

#[test]
fn effects_that_are_left_out_are_not_blamed_on_the_picture() {
    let case = Case::classic("effects/everything.txt");
    let viewed = case.scene.viewed(&case.settings);
    for (request, left_out) in
        [("-shadows", "shadows"), ("-reflections", "reflections"), ("-specular,-shadows", "specular,shadows")]
    {
        let effects = Effects::requested(&viewed, &request.parse().unwrap());
        let reference = Reference::new(&viewed, &effects);
        let (theirs, expected) = (case.right(), picture(&reference));
        let explanation = Explanation::of(&theirs, &expected, &reference, &Judge::of(Tier::Fast));
        let found = diagnose(&theirs, &expected, &viewed, &effects, &explanation.places, None);
        assert_eq!((names(&found)[0], found.left), ("effects-left-out", 0), "{request}: {found:?}");
        assert!(found.causes[0].detail.ends_with(&format!("({left_out})")), "{request}: {found:?}");
        // A picture without them has no cause.
        let found = diagnose(&expected, &expected, &viewed, &effects, &[], None);
        assert_eq!(found.causes, [], "{request}");
    }
}

#[test]
fn a_search_ends_when_its_time_is_over() {
    let case = Case::classic("effects/everything.txt");
    // Of noise no cause is good enough, so that all are tried.
    let noise = |x: u32, y: u32| [0, 1, 2].map(|c| (x * 83 + y * 57 + c * 31 + x * y * 7).wrapping_mul(97) as u8);
    let right = case.right();
    let (width, height) = (right.width(), right.height());
    let rgb = (0..width * height).flat_map(|at| noise(at % width, at / width)).collect();
    let theirs = Picture::new(width, height, rgb).unwrap();
    let start = Instant::now();
    assert!(!case.diagnosis(&theirs).cut_short);
    let whole = start.elapsed();
    let start = Instant::now();
    assert!(case.diagnosis_within(&theirs, Some(whole / 10)).cut_short);
    assert!(start.elapsed() < whole / 2, "{:?} of {whole:?}", start.elapsed());
    let none = case.diagnosis_within(&theirs, Some(Duration::ZERO));
    assert!(none.cut_short && none.causes.is_empty() && none.report().contains("the time for the search was over"));
    // A time that is long enough changes nothing.
    let blinn = Case {
        settings: Settings { specular: Specular::Blinn, ..case.settings },
        ..Case::classic("effects/everything.txt")
    };
    let theirs = blinn.right();
    assert_eq!(case.diagnosis_within(&theirs, Some(Duration::MAX)), case.diagnosis(&theirs));
}

#[test]
fn what_was_found_in_time_is_named() {
    let mut case = Case::classic("effects/everything.txt");
    (case.scene.width, case.scene.height) = (36, 36);
    let settings = Settings { specular: Specular::Blinn, quantize: Quantize::Round, ..case.settings };
    let mut scene = case.scene.clone();
    scene.lights[0].intensity *= 0.8;
    let theirs = Case::rendered(&scene, &settings);
    // Twice as long until something is found, and as soon as something is, that is named.
    let mut time = Duration::from_millis(1);
    let found = loop {
        let found = case.diagnosis_within(&theirs, Some(time));
        if !found.causes.is_empty() || !found.cut_short {
            break found;
        }
        time *= 2;
    };
    assert!(!found.causes.is_empty() && found.left < found.to_explain, "{found:?}");
}

#[test]
fn names_are_unique_and_in_kebab_case() {
    for (index, known) in CAUSES.iter().enumerate() {
        assert!(known.name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'), "{}", known.name);
        assert!(CAUSES[..index].iter().all(|other| other.name != known.name), "{}", known.name);
        assert!(!known.line.is_empty() && !known.line.contains('\n'));
    }
}

fn trueray(arguments: &[&str], folder: &Path) -> (i32, String) {
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_trueray")).args(arguments).current_dir(folder).output();
    let output = output.unwrap();
    (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
}

#[test]
fn the_command_names_the_mistake() {
    let folder = tempdir().unwrap();
    let case = Case::of("effects/everything.txt", Settings { specular: Specular::Blinn, ..Settings::classic() });
    case.right().write(folder.path().join("mine.ppm")).unwrap();
    let scene = root().join("scenes/effects/everything.txt");
    let res = format!("{}x{}", case.scene.width, case.scene.height);
    let compare = ["compare", "--device", "cpu", "--scene", scene.to_str().unwrap(), "mine.ppm", "--explain", "--res"];
    let (code, text) = trueray(&[&compare[..], &[&res]].concat(), folder.path());
    assert_eq!(code, 1);
    assert!(text.contains("\ncause             specular-blinn, 100.0 %: "), "{text}");
    let (_, text) = trueray(&[&compare[..], &[&res, "--json"]].concat(), folder.path());
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&json["causes"][0]["name"], &json["causes"][0]["share"]), (&"specular-blinn".into(), &1.0.into()));
    assert_eq!(json["left"], 0);
    assert_eq!(json["cut_short"], false);
    let (_, text) = trueray(&[&compare[..], &[&res, "--explain-seconds", "0", "--json"]].concat(), folder.path());
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&json["causes"], &json["cut_short"]), (&serde_json::json!([]), &true.into()));
    // Another size is trouble, and said to be what it is.
    let (code, text) = trueray(&[&compare[..], &["10x10", "--json"]].concat(), folder.path());
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!((code, &json["causes"]), (2, &serde_json::json!([])));
    let (code, list) = trueray(&["compare", "--causes"], folder.path());
    assert_eq!((code, list.lines().count()), (0, CAUSES.len()));
}
