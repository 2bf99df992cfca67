//! Certified levels of 16 bits: the reference's in every pixel, on any device and in any file that has them; how they are verified.

use std::io::Cursor;

use trueray::cpu::Reference;
use trueray::effects::Effects;
use trueray::engine::{Backend, Engine, Options, Rows, Stages, render_bands};
use trueray::gpu::{Gpu, GpuRenderer};
use trueray::linear::Linear;
use trueray::pattern::Pattern;
use trueray::precision::Tier;
use trueray::scene::{Scene, Window};
use trueray::settings::{Quantize, Settings};
use trueray::verify::Verify;

use crate::support::{Folder, gpu, pairs, root, scene, scene_files, scene_of};
use crate::tuning::{cases, tunings};

/// Levels of 8 and of 16 bits, and what is covered.
type Shown = (Vec<[u8; 3]>, Vec<[u16; 3]>, Vec<f64>);

fn shown(rgb: &[u8], linear: &[Linear], quantize: Quantize) -> Shown {
    let deep = linear.iter().map(|pixel| quantize.levels16(pixel.color)).collect();
    (rgb.as_chunks::<3>().0.to_vec(), deep, linear.iter().map(|pixel| pixel.coverage).collect())
}

fn reference(scene: &Scene, settings: &Settings) -> Shown {
    let viewed = scene.viewed(settings);
    let count = scene.width as usize * scene.height as usize;
    let (mut rgb, mut linear) = (vec![0; 3 * count], vec![Linear::default(); count]);
    Reference::<f64>::new(&viewed, &Effects::of(&viewed)).linear_rows(0, &mut rgb, &mut linear).unwrap();
    shown(&rgb, &linear, settings.quantize)
}

fn certified(gpu: &Gpu, scene: &Scene, settings: &Settings, verify: Verify) -> (Shown, Stages) {
    let viewed = scene.viewed(settings);
    let effects = Effects::of(&viewed);
    let options = Options { linear: true, ..Options::default() };
    let mut engine = Engine::verified(Backend::Certified(gpu, Tier::Fast), viewed, &effects, &options, verify).unwrap();
    let (mut rgb, mut linear) = (Vec::new(), Vec::new());
    render_bands(&mut engine, |band| {
        rgb.extend_from_slice(band.rgb);
        linear.extend_from_slice(band.linear);
        Ok::<_, trueray::gpu::Error>(())
    })
    .unwrap();
    (shown(&rgb, &linear, settings.quantize), engine.stages().unwrap())
}

/// Which pixels differ in anything.
fn wrong(found: &Shown, expected: &Shown) -> usize {
    let pairs = found.0.iter().zip(&found.1).zip(&found.2).zip(expected.0.iter().zip(&expected.1).zip(&expected.2));
    assert_eq!(found.1.len(), expected.1.len());
    pairs.filter(|(found, expected)| found != expected).count()
}

fn small(file: &std::path::Path) -> Scene {
    Scene { width: 96, height: 72, ..scene(file) }
}

#[test]
fn every_scene_has_the_levels_of_the_reference() {
    let Some(gpu) = gpu("deep::every_scene_has_the_levels_of_the_reference") else { return };
    let overscale = Settings { quantize: Quantize::Overscale, ..Settings::classic() };
    let mut sum = Stages::default();
    for (at, file) in scene_files(&["basic", "effects", "refraction", "hard"]).iter().enumerate() {
        let scene = small(file);
        let settings = [Settings::classic(), Settings::exact(), overscale][at % 3];
        let (found, stages) = certified(&gpu, &scene, &settings, Verify::Nothing);
        assert_eq!(wrong(&found, &reference(&scene, &settings)), 0, "{}: {stages:?}", file.display());
        assert_eq!(stages.kernel + stages.reference, 96 * 72, "{}: {stages:?}", file.display());
        sum.kernel += stages.kernel;
        sum.reference += stages.reference;
    }
    // `double` knows nearly all of them.
    assert!(!gpu.device.info.f64 || sum.reference > 0 && sum.kernel > 4 * sum.reference, "{sum:?}");
}

/// What the kernel is sure of is right without anything beside it.
#[test]
fn what_the_kernel_is_sure_of_is_right() {
    let Some(gpu) = gpu("deep::what_the_kernel_is_sure_of_is_right") else { return };
    if !gpu.device.info.f64 {
        return;
    }
    let options = Options { certified: true, linear: true, ..Options::default() };
    let (mut unsure, mut all) = (0, 0);
    for file in scene_files(&["hard", "basic"]) {
        let scene = small(&file);
        let settings = Settings::exact();
        let viewed = scene.viewed(&settings);
        let effects = Effects::of(&viewed);
        let mut renderer = GpuRenderer::<Rows>::with(&gpu, &viewed, &effects, Tier::Double, &options).unwrap();
        let (mut rgb, mut linear) = (vec![0; 3 * 96 * 72], vec![Linear::default(); 96 * 72]);
        let rendered = renderer.linear_rows(0, &mut rgb, &mut linear).unwrap();
        let (mut found, expected) = (shown(&rgb, &linear, settings.quantize), reference(&scene, &settings));
        unsure += rendered.unsure.len();
        all += linear.len();
        for [x, y] in rendered.unsure.into_iter().chain(rendered.cut) {
            let at = y as usize * 96 + x as usize;
            (found.0[at], found.1[at], found.2[at]) = (expected.0[at], expected.1[at], expected.2[at]);
        }
        assert_eq!(wrong(&found, &expected), 0, "{}", file.display());
    }
    assert!(unsure > 0 && unsure * 4 < all, "{unsure} of {all}");
}

/// A colour that lies on a step of 16 bits and on none of 8, wherever light falls: only the bound of the former sees it.
#[test]
fn pixels_on_a_step_of_16_bits_are_unsure() {
    let Some(gpu) = gpu("deep::pixels_on_a_step_of_16_bits_are_unsure") else { return };
    if !gpu.device.info.f64 {
        return;
    }
    // The light shines along the view onto a ball so large that N.L is 1 to within 1e-13: 0.5 + 0.25, on a step of `Round` but for that.
    let level = (49_151.0 + 0.5) / 65535.0;
    let kd = level - 0.5;
    let ball = format!("SPHERE a 0 0 -12 10 10 10 1 1 1 0.5 {kd} 0 0 1\nLIGHT l 0 0 0 1 1 1\nAMBIENT 1 1 1\n");
    let window = Window { near: 1.0, left: -1e-7, right: 1e-7, bottom: -1e-7, top: 1e-7 };
    let scene = Scene { window, width: 8, height: 8, ..scene_of(&ball) };
    let settings = Settings::exact();
    let viewed = scene.viewed(&settings);
    let effects = Effects::of(&viewed);
    let unsure = |linear| {
        let options = Options { certified: true, linear, ..Options::default() };
        let mut renderer = GpuRenderer::<Rows>::with(&gpu, &viewed, &effects, Tier::Double, &options).unwrap();
        let (mut rgb, mut colors) = (vec![0; 3 * 64], vec![Linear::default(); 64]);
        let rendered =
            if linear { renderer.linear_rows(0, &mut rgb, &mut colors) } else { renderer.rows(0, &mut rgb) }.unwrap();
        rendered.unsure.len()
    };
    assert_eq!([unsure(false), unsure(true)], [0, 64]);
}

/// Kept paths, paths in place, trees, several samples, both kinds of tables; every pixel verified.
#[test]
fn no_way_of_working_changes_a_level() {
    let Some(mut gpu) = gpu("deep::no_way_of_working_changes_a_level") else { return };
    let own = gpu.tuned().tuning;
    for (name, scene, settings) in cases() {
        let expected = reference(&scene, &settings);
        for mut tuning in tunings() {
            tuning.workgroup = tuning.workgroup.min(gpu.device.info.max_invocations);
            gpu.set_tuning(tuning).unwrap();
            let (found, stages) = certified(&gpu, &scene, &settings, Verify::All);
            gpu.set_tuning(own).unwrap();
            assert_eq!(wrong(&found, &expected), 0, "{name} with {tuning:?}: {stages:?}");
            let is_by_kernel = settings.pattern == Pattern::ONE && gpu.device.info.f64;
            assert_eq!(stages.kernel > 0, is_by_kernel, "{name}: {stages:?}");
        }
    }
}

/// Without `f64` no kernel knows levels of 16 bits: the reference calculates them all.
#[test]
fn a_device_without_f64_leaves_all_to_the_reference() {
    let Some(gpu) = pairs() else { return };
    let scene = small(&root().join("scenes/effects/everything.txt"));
    let (found, stages) = certified(&gpu, &scene, &Settings::exact(), Verify::Nothing);
    assert_eq!((wrong(&found, &reference(&scene, &Settings::exact())), stages.reference), (0, 96 * 72));
}

// --- files -----------------------------------------------------------------------------------------------------------------

const SCENE: &str = "NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -0.75\nTOP 0.75\nSPHERE a 0 0 -6 2 2 2 0.9 0.2 0.1 0.3 0.7 0.3 0.4 20\nSPHERE b 2 1 -5 0.5 1 0.5 0.1 0.8 0.3 0.3 0.6 0.2 0 10\n\
                     LIGHT l 5 6 0 2.9 2.9 2.8\nAMBIENT 0.3 0.3 0.3\nBACK 0.1 0.1 0.2\nRES 64 48\n";

#[test]
fn files_are_those_of_the_reference() {
    if gpu("deep::files_are_those_of_the_reference").is_none() {
        return;
    }
    let place = Folder::with_scene(SCENE);
    for options in ["--bits 16", "--bits 16 --alpha", "--alpha", "--bits 16 --spp 4", "--bits 16 --convention exact"] {
        place.exits(&format!("render -q --device cpu {options} scene.txt -o cpu.png"), 0, "");
        let certified = format!("render -q --device gpu --precision certified {options} scene.txt -o gpu.png");
        place.exits(&certified, 0, "");
        assert!(place.read("cpu.png") == place.read("gpu.png"), "{options}");
    }
    place.exits(
        "render --device gpu --precision certified --bits 16 --stats scene.txt -o a.png",
        0,
        "pixels by double, ",
    );
    place.exits("render -q --device gpu --precision certified --bits 16 --turntable 2 scene.txt -o f%d.png", 0, "");
    place.exits("render -q --device cpu --bits 16 --turntable 2 scene.txt -o g%d.png", 0, "");
    assert!(place.read("f2.png") == place.read("g2.png"));
}

/// The picture in a PNG file with one level changed.
fn with_wrong_level(place: &Folder, from: &str, to: &str) {
    let mut reader = png::Decoder::new(Cursor::new(place.read(from))).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    // The last bit of green at x 5, y 7.
    bytes[(7 * 64 + 5) * 6 + 3] ^= 1;
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, info.width, info.height);
    encoder.set_color(info.color_type);
    encoder.set_depth(info.bit_depth);
    encoder.write_header().unwrap().write_image_data(&bytes).unwrap();
    place.write(to, file);
}

#[test]
fn certificates_and_verify_know_16_bits() {
    let Some(gpu) = gpu("deep::certificates_and_verify_know_16_bits") else { return };
    let place = Folder::with_scene(SCENE);
    let render = "render -q --device gpu --precision certified --bits 16 --certificate a.json scene.txt -o a.png";
    place.exits(render, 0, "");
    place.exits("render -q --device cpu --bits 16 --certificate cpu.json scene.txt -o cpu.png", 0, "");
    place.exits("render -q --device cpu --certificate eight.json scene.txt -o eight.png", 0, "");
    let json = |name: &str| serde_json::from_slice::<serde_json::Value>(&place.read(name)).unwrap();
    assert_eq!(
        (&json("a.json")["picture"], json("a.json")["picture"]["bits"].as_u64()),
        (&json("cpu.json")["picture"], Some(16))
    );
    assert_eq!(json("eight.json")["picture"]["bits"], 8);
    // Without f64 the reference calculates all pixels.
    assert_eq!(json("a.json")["kernel"].as_str(), gpu.device.info.f64.then_some("double"));
    with_wrong_level(&place, "a.png", "wrong.png");
    for device in ["cpu", "gpu"] {
        let verify = |arguments: &str, code, message| {
            place.says(&format!("verify --device {device} --scene scene.txt {arguments}"), code, message);
        };
        verify(
            "a.png --certificate a.json",
            0,
            "certificate       of this scene, these settings and this picture; the rest of it is a claim",
        );
        verify("eight.png --certificate eight.json", 0, "verdict           right");
        verify("wrong.png", 1, "wrong             1 pixel of 3072\nfirst             x 5, y 7: ");
        verify("wrong.png --certificate a.json", 1, "of something else: picture.sha256");
        verify("eight.png --certificate a.json", 1, "of something else: picture.bits is 16 there and 8 here");
    }
    place.exits("render -q --device cpu --bits 16 --alpha scene.txt -o alpha.png", 0, "");
    place.exits("verify --device cpu alpha.png --scene scene.txt", 2, "16 bits of red, green and blue");
    let file = place.read("a.png");
    place.write("cut.png", &file[..file.len() / 2]);
    place.exits("verify --device cpu cut.png --scene scene.txt", 2, "cut.png");
    for (arguments, message) in [
        (
            "--precision certified scene.txt -o b.exr",
            "PFM and EXR do not go with --precision certified, which is of levels",
        ),
        ("--precision certified --alpha scene.txt -o b.exr", "PFM and EXR do not go with --precision certified"),
        (
            "--bits 16 --alpha --certificate b.json scene.txt -o b.png",
            "PFM, EXR and --alpha do not go with --certificate",
        ),
        ("--precision certified --certificate b.json scene.txt -o b.pfm", "do not go with"),
        ("--precision certified --bits 16 --tile 0/2 scene.txt -o b.png", "do not go with --crop, --tile or --resume"),
    ] {
        place.exits(&format!("render --device cpu {arguments}"), 2, message);
    }
    assert!(!place.files().iter().any(|name| name.starts_with('b')), "{:?}", place.files());
}
