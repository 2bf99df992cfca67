//! `trueray render --aov`: intermediate values add up to the picture and are written as documented.

use std::fs;
use std::path::Path;

use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, read};
use trueray::aov::{Aov, DeviceLayers, Layer, MAX_BOUNCES, TooMany, layers};
use trueray::cpu::{Inspector, PixelRecord, picked};
use trueray::effects::{EffectSet, Effects, Request};
use trueray::film::Picture;
use trueray::gpu::Gpu;
use trueray::pattern::Pattern;
use trueray::scene::Scene;
use trueray::settings::Settings;
use trueray::tuning::Tuning;
use trueray::{DVec3, Tier, View};

use crate::pixel::{inspector, places, same, scenes};
use crate::support::{Folder, assert_exit, gpu, pairs, root, scaled, scene, scene_of};

/// The terms of a pixel with one sample, added in the documented order: ambient; of each light diffuse, specular; background; each
/// bounce.
fn sum(record: &PixelRecord) -> [f64; 3] {
    let [sample] = &record.samples[..] else { panic!("several samples") };
    let (first, bounces) = sample.rays.split_first().unwrap();
    let mut terms = vec![first.hit.as_ref().map_or([0.0; 3], |hit| hit.ambient)];
    for light in first.hit.iter().flat_map(|hit| &hit.lights) {
        terms.extend([light.diffuse, light.specular]);
    }
    terms.push(first.background.unwrap_or_default());
    terms.extend(bounces.iter().map(|ray| ray.contribution));
    terms.into_iter().reduce(|sum, term| std::array::from_fn(|c| sum[c] + term[c])).unwrap()
}

#[test]
fn terms_add_up_to_the_very_colour_on_all_scenes() {
    let mut bounces = 0;
    for (name, scene) in scenes(200) {
        for settings in [Settings::classic(), Settings::exact()] {
            let (inspector, reference) = inspector(&scene, &settings);
            for [x, y] in places(&scene).step_by(if settings == Settings::classic() { 1 } else { 7 }) {
                let record = inspector.pixel(x, y).unwrap();
                let (sum, color) = (sum(&record), reference.color(x, y).unwrap().to_array());
                assert!(same(sum, color), "{name}, x {x}, y {y}: {sum:?} for {color:?}");
                bounces += record.samples[0].rays.len() - 1;
            }
        }
    }
    assert!(bounces > 1000, "{bounces}");
}

/// The layers of these kinds.
fn layers_of(scene: &Scene, settings: &Settings, wanted: &[Aov]) -> Result<Vec<Layer>, TooMany> {
    layers(&inspector(scene, settings).0, scene.lights.len(), settings.quantize, wanted, None)
}

fn small(name: &str) -> Scene {
    let mut scene = scene(&root().join("scenes").join(name));
    (scene.width, scene.height) = (24, 18);
    scene
}

#[test]
fn layers_are_what_the_tracer_has_calculated() {
    use Aov::{Bounce, Color, Diffuse, Inside, NDotL, Normal, Position, Rays, Shadow, Sphere, Step, T, Tests};
    let (scene, settings) = (small("effects/everything.txt"), Settings::classic());
    let wanted =
        [Color, T, Sphere, Inside, Position, Normal, NDotL, Shadow, Diffuse, Bounce, Rays, Tests, Step, Aov::Margin];
    let all = layers_of(&scene, &settings, &wanted).unwrap();
    let layer = |name: &str| all.iter().find(|layer| layer.name == name).unwrap_or_else(|| panic!("{name}"));
    let one = |name: &str, [x, y]: [u32; 2]| layer(name).values[(y * scene.width + x) as usize];
    let three = |name: &str, [x, y]: [u32; 2]| layer(name).values.as_chunks::<3>().0[(y * scene.width + x) as usize];
    let (inspector, reference) = inspector(&scene, &settings);
    let viewed = scene.viewed(&settings);
    let mut hits = 0;
    for place in places(&scene) {
        let [x, y] = place;
        let record = inspector.pixel(x, y).unwrap();
        assert_eq!(three("color", place), reference.color(x, y).unwrap().to_array().map(|c| c as f32));
        match picked(&viewed, x, y) {
            None => assert_eq!((one("sphere", place), one("t", place)), (-1.0, f32::INFINITY)),
            Some(hit) => {
                hits += 1;
                assert_eq!(one("sphere", place), hit.sphere as f32);
                assert!((f64::from(one("t", place)) / hit.t - 1.0).abs() < 1e-6);
                assert_eq!(one("inside", place) == 1.0, hit.inside);
                let off = three("position", place).into_iter().zip(hit.position.to_array());
                assert!(off.map(|(a, b)| (f64::from(a) - b).abs()).fold(0.0, f64::max) < 1e-5, "{place:?}");
                let normal = three("normal", place);
                assert!((normal.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-6);
                let light = &record.samples[0].rays[0].hit.as_ref().unwrap().lights[0];
                assert_eq!(one("n-dot-l-0", place), light.n_dot_l as f32);
                let blocked = light.shadow.as_ref().is_some_and(|shadow| shadow.blocked);
                assert_eq!(one("shadow-0", place) == 1.0, blocked);
                assert_eq!(three("diffuse-0", place), light.diffuse.map(|c| c as f32));
            }
        }
        for (index, ray) in record.samples[0].rays.iter().enumerate().skip(1) {
            assert_eq!(three(&format!("bounce-{index}"), place), ray.contribution.map(|c| c as f32));
        }
        let nearest =
            record.decisions.iter().find(|margin| margin.decision != trueray::cpu::Decision::QuantisationStep);
        assert_eq!(one("margin", place), nearest.map_or(f32::INFINITY, |margin| margin.margin as f32));
        let tests: u64 = record.samples[0]
            .rays
            .iter()
            .map(|ray| {
                let shadows = ray.hit.iter().flat_map(|hit| &hit.lights).flat_map(|light| &light.shadow);
                ray.test_count + shadows.map(|shadow| shadow.test_count).sum::<u64>()
            })
            .sum();
        assert_eq!(one("tests", place), tests as f32);
    }
    assert!(hits > 50, "{hits}");
    // As many rays as the reference counts.
    let tally = reference.rows(0, &mut vec![0; (scene.width * scene.height * 3) as usize]).unwrap();
    let rays: f32 = layer("rays").values.iter().sum();
    assert_eq!(rays as u64, tally.primary + tally.shadow + tally.reflection);
}

#[test]
fn too_many_bounces_are_refused() {
    let corridor = "SPHERE a 0 0 0 20 20 20 1 1 1 0.1 0 0 1 1\nAMBIENT 1 1 1\n";
    let mut scene = scene_of(corridor);
    (scene.width, scene.height) = (2, 2);
    let settings = Settings { max_depth: 80, ..Settings::classic() };
    assert_eq!(layers_of(&scene, &settings, &[Aov::Bounce]), Err(TooMany::Bounces(80)));
    assert!(layers_of(&scene, &settings, &[Aov::T]).is_ok());
    let settings = Settings { max_depth: MAX_BOUNCES as u32, ..settings };
    assert_eq!(layers_of(&scene, &settings, &[Aov::Bounce]).unwrap().len(), MAX_BOUNCES);
}

const SCENE: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 5 4\nSPHERE s 0 0.5 -2 1 1 1 1 0.5 0 0.5 0.5 0.5 0.5 4\n\
                     LIGHT a 2 2 0 1 1 1\nLIGHT b -2 2 0 0.5 0.5 0.5\nAMBIENT 1 1 1\nBACK 0 0 1\n";

/// A PFM file: kind, columns, rows, and numbers in reading order.
fn read_pfm(path: &Path) -> (String, [usize; 2], Vec<f32>) {
    let file = fs::read(path).unwrap();
    let mut lines = file.splitn(4, |&byte| byte == b'\n');
    let mut line = || String::from_utf8(lines.next().unwrap().to_vec()).unwrap();
    let (kind, size, scale) = (line(), line(), line());
    assert_eq!(scale, "-1.0", "little-endian");
    let size: Vec<usize> = size.split(' ').map(|side| side.parse().unwrap()).collect();
    let numbers: Vec<f32> =
        lines.next().unwrap().as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let row = numbers.len() / size[1];
    (kind, [size[0], size[1]], numbers.chunks(row).rev().flatten().copied().collect())
}

#[test]
fn files_are_written_beside_the_picture() {
    use Aov::{Bounce, Color, Diffuse, Normal, T};
    let place = Folder::with_scene(SCENE);
    let list = "t,normal,diffuse,bounce,color";
    let output = place.run(&format!("render --device cpu scene.txt -o out.ppm --aov {list} --aov-format png,pfm,exr"));
    assert_exit(&output, 0, "13 files of values from the CPU reference: out.color.png");
    let scene = trueray::scene::parse("scene.txt", SCENE.as_bytes()).scene.unwrap();
    let expected = layers_of(&scene, &Settings::classic(), &[T, Normal, Diffuse, Bounce, Color]).unwrap();
    let names: Vec<_> = expected.iter().map(|layer| layer.name.as_str()).collect();
    assert_eq!(names, ["color", "t", "normal", "diffuse-0", "diffuse-1", "bounce-1"]);
    for layer in &expected {
        let (kind, size, values) = read_pfm(&place.path(&format!("out.{}.pfm", layer.name)));
        assert_eq!((kind.as_str(), size), (if layer.channels() == 3 { "PF" } else { "Pf" }, [5, 4]));
        assert_eq!(values, layer.values, "{}", layer.name);
    }
    // The colour is the picture's, and scales are as documented.
    let picture = |name: &str| Picture::read(place.path(name)).unwrap();
    assert_eq!(picture("out.color.png").rgb(), picture("out.ppm").rgb());
    let (normals, normal) = (&expected[2].values, picture("out.normal.png"));
    for (values, pixel) in normals.as_chunks::<3>().0.iter().zip(normal.pixels()) {
        let level = |x: f32| (255.0 * (0.5 * f64::from(x) + 0.5) + 0.5) as u8;
        assert_eq!(*pixel, if *values == [0.0; 3] { [0; 3] } else { values.map(level) });
    }
    let times = picture("out.t.png");
    let least = expected[1].values.iter().copied().fold(f32::INFINITY, f32::min);
    for (&t, pixel) in expected[1].values.iter().zip(times.pixels()) {
        assert_eq!(*pixel, [(255.0 * f64::from(least) / f64::from(t) + 0.5) as u8; 3]);
    }

    let file = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let file = file.from_file(place.path("out.aov.exr")).unwrap();
    let channels = &file.layer_data[0].channel_data.list;
    let channel = |name: &str| {
        let channel =
            channels.iter().find(|channel| channel.name.to_string() == name).unwrap_or_else(|| panic!("{name}"));
        let FlatSamples::F32(values) = &channel.sample_data else { panic!("{name} is not of 32 bits") };
        values.clone()
    };
    assert_eq!(channels.len(), 16);
    assert_eq!(channel("t"), expected[1].values);
    for (index, name) in ["R", "G", "B"].into_iter().enumerate() {
        assert_eq!(channel(name), expected[0].values.iter().skip(index).step_by(3).copied().collect::<Vec<_>>());
    }
    assert_eq!(channel("normal.Y"), normals.iter().skip(1).step_by(3).copied().collect::<Vec<_>>());
    assert_eq!(channel("diffuse-1.B"), expected[4].values.iter().skip(2).step_by(3).copied().collect::<Vec<_>>());
}

#[test]
fn one_file_can_have_any_name_and_the_rest_is_refused() {
    let place = Folder::with_scene(SCENE);
    assert_exit(
        &place.run("render --device cpu scene.txt -o - --aov all --aov-file values.exr"),
        0,
        "1 file of values",
    );
    let first = fs::read(place.path("values.exr")).unwrap();
    assert_exit(&place.run("render --device cpu scene.txt -o - --aov all --aov-file values.exr"), 0, "");
    assert!(first == fs::read(place.path("values.exr")).unwrap(), "other bytes");
    for (arguments, code, message) in [
        ("scene.txt -o out.png --aov depth", 2, "possible values"),
        ("scene.txt -o - --aov t", 2, "--aov writes beside the picture"),
        ("scene.txt -o out.png --aov error", 2, "--aov error is of a device's picture"),
        ("scene.txt scene.txt -o . --aov t --aov-file values.exr", 2, "--aov-file takes one scene"),
        ("scene.txt -o out.png --aov t --aov-file -", 2, "--aov-file takes a file"),
        ("scene.txt -o out.png --aov t --aov-file scene.txt", 6, "an input of this run"),
        ("scene.txt -o out.png --aov t --aov-file out.png", 6, "which --aov-file writes"),
        ("scene.txt -o out.png --aov-format exr", 2, "--aov"),
    ] {
        assert_exit(&place.run(&format!("render --device cpu {arguments}")), code, message);
    }
}

#[test]
fn beside_a_picture_that_the_scene_names_only_pictures_are_replaced() {
    let place = Folder::with_scene(&format!("{SCENE}OUTPUT out.ppm\n"));
    for (name, arguments) in
        [("out.t.png", "--aov t"), ("out.t.pfm", "--aov t"), ("out.aov.exr", "--aov t --aov-format exr")]
    {
        let run = |options: &str| place.run(&format!("render --device cpu scene.txt {arguments} {options}"));
        fs::write(place.path(name), "mine").unwrap();
        for options in ["", "-o ."] {
            assert_exit(&run(options), 6, &format!("--aov would write `{name}`, over a file that does not begin like"));
            assert_eq!(fs::read(place.path(name)).unwrap(), b"mine");
        }
        assert_exit(&run("-o out.ppm"), 0, "");
        // Those of a former run are replaced, empty files are as well, and whatever the option allows.
        assert_exit(&run(""), 0, "");
        fs::write(place.path(name), "").unwrap();
        assert_exit(&run(""), 0, "");
        fs::write(place.path(name), "mine").unwrap();
        assert_exit(&run("--allow-any-output"), 0, "");
    }
}

/// Whatever else the run writes is known before anything is rendered.
#[test]
fn files_beside_the_picture_are_no_other_files_of_the_run() {
    let place = Folder::with_scene(&format!("{SCENE}OUTPUT a.ppm\n"));
    fs::write(place.path("b.txt"), format!("{SCENE}OUTPUT a.bounce-2.png\n")).unwrap();
    for (arguments, writes) in [
        ("--aov normal --stats-json a.normal.png scene.txt -o a.png", "which --stats-json writes"),
        ("--aov bounce scene.txt b.txt", "which the picture of b.txt writes"),
    ] {
        fs::write(place.path("a.normal.png"), "mine").unwrap();
        assert_exit(&place.run(&format!("render --device cpu {arguments}")), 6, writes);
        assert_eq!(fs::read(place.path("a.normal.png")).unwrap(), b"mine");
        assert!(!place.path("a.png").exists() && !place.path("a.ppm").exists());
    }
}

/// Of a device: its levels less the reference's.
#[test]
fn errors_are_those_of_the_devices_picture() {
    let Some(_gpu) = gpu("aov::errors_are_those_of_the_devices_picture") else { return };
    // Fast rounds light that hardly changes over some levels.
    let scene = SCENE.replace("RES 5 4", "RES 60 40");
    let place = Folder::with_scene(&scene);
    let output = place
        .run("render --device gpu --precision fast --verify 0 scene.txt -o out.png --aov error --aov-format pfm,png");
    assert_exit(&output, 0, "2 files of values from the CPU reference");
    let scene = trueray::scene::parse("scene.txt", scene.as_bytes()).scene.unwrap();
    let viewed = scene.viewed(&Settings::classic());
    let reference = trueray::cpu::Reference::<f64>::new(&viewed, &Effects::of(&viewed));
    let mut expected = vec![0; 60 * 40 * 3];
    reference.rows(0, &mut expected).unwrap();
    let picture = Picture::read(place.path("out.png")).unwrap();
    let (_, _, errors) = read_pfm(&place.path("out.error.pfm"));
    for ((&level, &expected), error) in picture.rgb().iter().zip(&expected).zip(errors) {
        assert_eq!(f32::from(level) - f32::from(expected), error);
    }
    assert_eq!(Picture::read(place.path("out.error.png")).unwrap().pixel_count(), 60 * 40);
}

/// All numbers that a device tells.
const TOLD: [Aov; 13] = [
    Aov::Color,
    Aov::T,
    Aov::Sphere,
    Aov::Inside,
    Aov::Position,
    Aov::Normal,
    Aov::NDotL,
    Aov::Shadow,
    Aov::Background,
    Aov::Ambient,
    Aov::Diffuse,
    Aov::Specular,
    Aov::Bounce,
];

/// Compares what a device tells with what the reference has.
fn assert_told(what: &str, gpu: &Gpu, tier: Tier, scene: &Scene, settings: &Settings) {
    let viewed = scene.viewed(settings);
    // Beside those, nothing but counts.
    let all = [&TOLD[..], &[Aov::Margin, Aov::Step, Aov::Error]].concat();
    let mut device = DeviceLayers::new(gpu, tier, &viewed, &Effects::of(&viewed), &all).unwrap();
    let found = device.layers(&inspector(scene, settings).0).unwrap().unwrap();
    let told: Vec<Aov> = TOLD.into_iter().filter(|&aov| device.tells(aov)).collect();
    assert_eq!(told.len(), if settings.pattern.count() > 1 { 5 } else { TOLD.len() }, "{what}");
    let expected = layers_of(scene, settings, &told).unwrap();
    let names = |layers: &[Layer]| layers.iter().map(|layer| layer.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&found), names(&expected), "{what}");
    let is_double = tier == Tier::Double && gpu.device.info.f64;
    // They are the device's own.
    assert!(tier != Tier::Fast || found != expected, "{what}");
    for (layer, expected) in found.iter().zip(&expected) {
        assert_eq!((layer.width, layer.height, layer.values.len()), (scene.width, scene.height, expected.values.len()));
        let greatest = expected.values.iter().filter(|x| x.is_finite()).fold(0.0, |most: f32, x| most.max(x.abs()));
        // Mirrors between them magnify what rounding has moved.
        let within = greatest
            * match tier {
                Tier::Fast => 1e-4,
                Tier::Double if is_double => 1e-6,
                Tier::Robust | Tier::Double => 1e-5,
            };
        let pairs = layer.values.iter().zip(&expected.values);
        let off = pairs.filter(|(a, b)| a != b && !((**a - **b).abs() <= within)).count();
        let most = if is_double { 0 } else { layer.values.len() / 50 };
        assert!(off <= most, "{what}: {} has {off} of {} numbers off", layer.name, layer.values.len());
    }
}

/// At every tier, with mirrors, glass, shadows, ellipsoids and inner walls, in other units and from another eye.
#[test]
fn what_a_device_tells_is_the_references_to_within_rounding() {
    let test = "aov::what_a_device_tells_is_the_references_to_within_rounding";
    let Some(device) = gpu(test) else { return };
    let eye = View::new(DVec3::new(0.5, 0.25, 1.0), None, DVec3::Y).unwrap();
    for name in ["effects/everything.txt", "effects/refraction.txt", "show/showcase.txt", "basic/ellipsoid.txt"] {
        let scene = small(name);
        for &tier in device.ladder() {
            for settings in [Settings::classic(), Settings { pattern: Pattern::Grid { side: 2 }, ..Settings::exact() }]
            {
                let what = format!("{name} at {tier}, {} samples", settings.pattern.count());
                assert_told(&what, &device, tier, &scene, &settings);
            }
            let moved = Settings { view: eye, ..Settings::exact() };
            assert_told(&format!("{name} from elsewhere at {tier}"), &device, tier, &scene, &moved);
        }
    }
    // The reference looks at no light without a term that needs it.
    let dark = small("effects/ambient.txt");
    let dark = dark.viewed(&Settings::classic());
    let of_dark = DeviceLayers::new(&device, Tier::Fast, &dark, &Effects::of(&dark), &TOLD).unwrap();
    let untold: Vec<_> = TOLD.into_iter().filter(|&aov| !of_dark.tells(aov)).collect();
    assert_eq!(untold, [Aov::NDotL, Aov::Shadow]);
    drop(of_dark);
    let scene = small("effects/everything.txt");
    for factor in [2_f64.powi(60), 2_f64.powi(-60)] {
        assert_told("in other units", &device, Tier::Fast, &scaled(&scene, factor), &Settings::exact());
    }
    drop(device);
    let pairs = pairs().unwrap();
    assert_told("double without f64", &pairs, Tier::Double, &scene, &Settings::exact());
}

/// The device's rays and tests of each pixel, and the reference's.
fn counted(gpu: &Gpu, tier: Tier, scene: &Scene, settings: &Settings, request: &Request) -> [[Layer; 2]; 2] {
    let viewed = scene.viewed(settings);
    let effects = Effects::requested(&viewed, request);
    let wanted = [Aov::Rays, Aov::Tests];
    let mut device = DeviceLayers::new(gpu, tier, &viewed, &effects, &wanted).unwrap();
    let inspector = Inspector::new(&viewed, &effects);
    let found = device.layers(&inspector).unwrap().unwrap();
    let expected = layers(&inspector, scene.lights.len(), settings.quantize, &wanted, None).unwrap();
    [found, expected].map(|layers| layers.try_into().unwrap())
}

/// A hundred mirrors, for which there is a grid.
fn mirrors() -> Scene {
    let mirror = |i: u32| {
        let [x, y, z] = [i % 10, i / 10 % 5, i / 50].map(f64::from);
        format!(
            "SPHERE s{i} {} {} {} 0.3 0.3 0.3 1 1 1 0 0.5 0 0.5 1\n",
            x - 4.5 + 0.1 * y,
            y - 2.0,
            -5.0 - 2.0 * z + 0.03 * x
        )
    };
    let mut scene = scene_of(&(0..100).map(mirror).chain(["LIGHT l 3 4 1 1 1 1\n".to_owned()]).collect::<String>());
    (scene.width, scene.height) = (32, 24);
    scene
}

/// However paths are walked: in `f64` each pixel takes the rays of the reference. Where there is no grid it takes no fewer tests, and few
/// more: two spheres are tested in each turn, and a loop ends a test or two after the one that ends it. Through a grid it walks in `f32`, by
/// a cell more or less.
#[test]
fn a_device_counts_its_rays_and_tests_of_each_pixel() {
    let Some(mut gpu) = gpu("aov::a_device_counts_its_rays_and_tests_of_each_pixel") else { return };
    let (own, is_double) = (gpu.tuned().tuning, gpu.device.info.f64);
    let four = Settings { pattern: Pattern::Grid { side: 2 }, ..Settings::exact() };
    let cases = [
        (small("effects/everything.txt"), false, four, 1e9, 1e9),
        (small("effects/refraction.txt"), false, Settings::classic(), 1e9, 1e9),
        (mirrors(), true, Settings::exact(), 1e9, 1e9),
        (mirrors(), true, Settings::exact(), 0.0, 1e9),
        (mirrors(), true, four, 0.0, 0.0),
    ];
    for (index, (scene, has_grid, settings, in_place_below, in_turn_from)) in cases.into_iter().enumerate() {
        gpu.set_tuning(Tuning { in_place_below, in_turn_from, ..own }).unwrap();
        let tier = if is_double { Tier::Double } else { Tier::Robust };
        let [[rays, tests], [expected_rays, expected]] = counted(&gpu, tier, &scene, &settings, &Request::Auto);
        assert!(!is_double || rays == expected_rays, "case {index}");
        assert!(rays.values.iter().sum::<f32>() > 1.2 * settings.pattern.count() as f32 * rays.values.len() as f32);
        let pairs = tests.values.iter().zip(&expected.values).zip(&rays.values);
        let off =
            pairs.filter(|((tests, expected), rays)| tests < expected || **tests > **expected + 2.0 * **rays).count();
        assert!(
            off <= if has_grid { tests.values.len() / 20 } else { 0 },
            "case {index}: {off} of {}",
            tests.values.len()
        );
    }
    gpu.set_tuning(own).unwrap();
}

/// By hand: a ball that fills the picture, a light that it faces, and every effect.
#[test]
fn counts_are_those_by_hand() {
    let Some(gpu) = gpu("aov::counts_are_those_by_hand") else { return };
    let ball = "SPHERE s 0 0 -5 20 20 1 1 1 1 0 0.5 0 KR 1\nLIGHT l 0 0 9 1 1 1\n";
    for (kr, rays, tests) in [("0", 2.0, 2.0), ("0.5", 3.0, 4.0)] {
        let mut scene = scene_of(&ball.replace("KR", kr));
        (scene.width, scene.height) = (16, 16);
        let settings = Settings { max_depth: 1, ..Settings::exact() };
        for &tier in gpu.ladder() {
            // One test for the primary ray, one for the shadow; the only sphere twice for the mirrored ray.
            let [[found_rays, found], _] = counted(&gpu, tier, &scene, &settings, &Request::Exactly(EffectSet::ALL));
            let all_are = |layer: &Layer, expected| layer.values.iter().all(|&x| x == expected);
            assert!(all_are(&found_rays, rays), "{kr} at {tier}: {:?}", found_rays.values);
            assert!(all_are(&found, tests), "{kr} at {tier}: {:?}", found.values);
        }
    }
}

/// Pixels that the picture has from the reference have its numbers.
#[test]
fn what_the_reference_decides_is_told_by_it() {
    let Some(gpu) = gpu("aov::what_the_reference_decides_is_told_by_it") else { return };
    // The ray of the pixel in the middle touches the sphere.
    let mut scene = scene_of("SPHERE s 1 0 -5 1 1 1 1 0 0 1 0 0 0 1\nAMBIENT 1 1 1\n");
    (scene.width, scene.height) = (8, 8);
    let (settings, middle) = (Settings::classic(), 4 * 8 + 4);
    let expected = layers_of(&scene, &settings, &TOLD).unwrap();
    let viewed = scene.viewed(&settings);
    let mut device = DeviceLayers::new(&gpu, Tier::Robust, &viewed, &Effects::of(&viewed), &TOLD).unwrap();
    let found = device.layers(&inspector(&scene, &settings).0).unwrap().unwrap();
    for (layer, expected) in found.iter().zip(&expected) {
        let at = middle * layer.channels()..(middle + 1) * layer.channels();
        assert_eq!(layer.values[at.clone()], expected.values[at], "{}", layer.name);
    }
}

#[test]
fn files_say_where_their_values_are_from() {
    if gpu("aov::files_say_where_their_values_are_from").is_none() {
        return;
    }
    let place = Folder::with_scene(SCENE);
    let told = "render --device gpu --precision fast scene.txt -o out.png --aov-from device";
    let output = place.run(&format!("{told} --aov t,margin,normal --aov-format png,exr"));
    assert_exit(&output, 0, "4 files of values from ");
    assert_exit(&output, 0, " at fast (t, normal) and the CPU reference (margin): ");
    for (name, from) in [("t", " at fast (t)"), ("margin", "from the CPU reference (margin)")] {
        let file = fs::File::open(place.path(&format!("out.{name}.png"))).unwrap();
        let reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
        let [text] = &reader.info().utf8_text[..] else { panic!("{name}") };
        let note = text.get_text().unwrap();
        assert!(text.keyword == "Source" && note.starts_with("values from ") && note.ends_with(from), "{note}");
    }
    let file = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let file = file.from_file(place.path("out.aov.exr")).unwrap();
    let comments = file.layer_data[0].attributes.comments.clone().unwrap().to_string();
    assert!(comments.ends_with(" at fast (t, normal) and the CPU reference (margin)"), "{comments}");
    for (arguments, message) in [
        ("--device cpu --aov t --aov-from device", "the CPU reference renders this picture"),
        ("--device gpu --precision certified --aov t --aov-from device", "does not go with --precision certified"),
        ("--device gpu --aov-from device", "--aov"),
    ] {
        assert_exit(&place.run(&format!("render scene.txt -o refused.png {arguments}")), 2, message);
    }
    assert!(!place.path("refused.png").exists());
}
