//! Colours that are no 8-bit levels: what the files have of the reference and of the device, at every tier; alpha; what is refused.

use glam::DVec3;
use trueray::area::Area;
use trueray::cpu::Reference;
use trueray::effects::Effects;
use trueray::engine::{Backend, Engine, Options, render_bands, render_picture};
use trueray::film::Picture;
use trueray::linear::Linear;
use trueray::pattern::Pattern;
use trueray::precision::Tier;
use trueray::scene::Scene;
use trueray::settings::{Quantize, Settings};
use trueray::verify::Verify;

use crate::support::{Folder, gpu, root, scene, scene_of};

/// Bright enough for colours above 1, a mirror, an ellipsoid and a background.
const SCENE: &str = "SPHERE a 0 0 -6 2 2 2 0.9 0.2 0.1 0.3 0.7 0.3 0.4 20\nSPHERE b 2 1 -5 0.5 1 0.5 0.1 0.8 0.3 0.3 0.6 0.2 0 10\n\
                     LIGHT l 5 6 0 2.9 2.9 2.8\nAMBIENT 0.3 0.3 0.3\nBACK 0.1 0.1 0.2\n";
const SIZE: (u32, u32) = (28, 20);

fn small() -> Scene {
    Scene { width: SIZE.0, height: SIZE.1, ..scene_of(SCENE) }
}

/// With the scene in `scene.txt`.
fn folder() -> Folder {
    Folder::with_scene(&small().to_string())
}

#[track_caller]
fn render(place: &Folder, arguments: &str, code: i32, message: &str) {
    place.exits(&format!("render {arguments}"), code, message);
}

/// The numbers of a PFM file, the first row first.
fn pfm(place: &Folder, name: &str) -> Vec<[f32; 3]> {
    let file = std::fs::read(place.path(name)).unwrap();
    let head = format!("PF\n{} {}\n-1.0\n", SIZE.0, SIZE.1);
    let numbers = file.strip_prefix(head.as_bytes()).unwrap().as_chunks::<4>().0;
    let pixels: Vec<_> = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let rows = pixels.as_chunks::<3>().0.chunks(SIZE.0 as usize).rev();
    rows.flatten().copied().collect()
}

/// The channels of an EXR file by name.
fn exr(place: &Folder, name: &str) -> Vec<(String, Vec<f32>)> {
    use exr::prelude::*;
    let file = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let image = file.from_file(place.path(name)).unwrap();
    let layer = &image.layer_data[0];
    assert_eq!((layer.size.0 as u32, layer.size.1 as u32), SIZE);
    let channels = layer.channel_data.list.iter();
    channels.map(|it| (it.name.to_string(), it.sample_data.values_as_f32().collect())).collect()
}

/// Bits a channel, channels and samples of a PNG file.
fn png(place: &Folder, name: &str) -> (u8, usize, Vec<u16>) {
    let file = std::io::BufReader::new(std::fs::File::open(place.path(name)).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!((info.width, info.height), SIZE);
    let samples = match info.bit_depth {
        png::BitDepth::Sixteen => bytes.as_chunks().0.iter().map(|&pair| u16::from_be_bytes(pair)).collect(),
        _ => bytes.iter().map(|&byte| byte.into()).collect(),
    };
    (info.bit_depth as u8, info.color_type.samples(), samples)
}

/// All pixels of a picture: levels and colours.
fn rendered(engine: &mut Engine) -> (Vec<u8>, Vec<Linear>) {
    let (mut rgb, mut linear) = (Vec::new(), Vec::new());
    render_bands(engine, |band| {
        rgb.extend_from_slice(band.rgb);
        linear.extend_from_slice(band.linear);
        Ok::<_, trueray::gpu::Error>(())
    })
    .unwrap();
    (rgb, linear)
}

fn settings(spp: u32) -> Settings {
    Settings { pattern: Pattern::Grid { side: spp }, ..Settings::default() }
}

fn reference(scene: &Scene, settings: &Settings) -> Vec<Linear> {
    let viewed = scene.viewed(settings);
    let count = scene.width as usize * scene.height as usize;
    let (mut rgb, mut linear) = (vec![0; 3 * count], vec![Linear::default(); count]);
    let reference = Reference::<f64>::new(&viewed, &Effects::of(&viewed));
    reference.linear_rows(0, &mut rgb, &mut linear).unwrap();
    // Levels and colours are of one pixel.
    for (levels, linear) in rgb.as_chunks::<3>().0.iter().zip(&linear) {
        assert_eq!(*levels, settings.quantize.levels(linear.color));
    }
    linear
}

// --- colours of the reference ----------------------------------------------------------------------------------------------

#[test]
fn files_have_the_colours_of_the_reference() {
    let place = folder();
    for (spp, option) in [(1, ""), (2, "--spp 4")] {
        let expected: Vec<_> =
            reference(&small(), &settings(spp)).iter().map(|pixel| pixel.color.as_vec3().to_array()).collect();
        assert!(expected.iter().flatten().any(|&c| c > 1.2), "nothing is clamped");
        render(&place, &format!("-q --device cpu {option} scene.txt -o a.pfm"), 0, "");
        assert_eq!(pfm(&place, "a.pfm"), expected);
        render(&place, &format!("-q --device cpu {option} scene.txt --format exr -o a.picture"), 0, "");
        let channels = exr(&place, "a.picture");
        assert_eq!(channels.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["B", "G", "R"]);
        for (channel, (_, values)) in channels.iter().rev().enumerate() {
            assert!(values.iter().zip(&expected).all(|(value, pixel)| *value == pixel[channel]), "channel {channel}");
        }
    }
}

#[test]
fn sixteen_bits_follow_the_rule_of_eight() {
    let levels = |quantize: Quantize, c| quantize.levels16(DVec3::splat(c))[0];
    let rules = [Quantize::Truncate, Quantize::Round, Quantize::Overscale];
    assert_eq!(rules.map(|rule| levels(rule, 0.5)), [32767, 32768, 32767]);
    assert_eq!(rules.map(|rule| levels(rule, 65534.5 / 65535.0)), [65534, 65535, 65535]);
    for (c, level) in [(0.0, 0), (-1.0, 0), (f64::NAN, 0), (1.0, 65535), (7.0, 65535)] {
        assert_eq!(rules.map(|rule| levels(rule, c)), [level; 3], "{c}");
    }
    let place = folder();
    for quantize in ["truncate", "round"] {
        let rule = if quantize == "round" { Quantize::Round } else { Quantize::Truncate };
        render(&place, &format!("-q --device cpu --quantize {quantize} --bits 16 scene.txt -o a.png"), 0, "");
        // Read as 8 bits, they are the picture of 8 bits.
        let compare = format!("compare --lenient --quantize {quantize} --device cpu --scene scene.txt a.png");
        place.exits(&compare, 0, "");
        let expected: Vec<_> =
            reference(&small(), &settings(1)).iter().flat_map(|pixel| rule.levels16(pixel.color)).collect();
        assert_eq!(png(&place, "a.png"), (16, 3, expected));
    }
    // 8 bits are the picture as ever.
    render(&place, "-q --device cpu --bits 8 scene.txt -o b.png", 0, "");
    render(&place, "-q --device cpu scene.txt -o c.png", 0, "");
    assert_eq!(std::fs::read(place.path("b.png")).unwrap(), std::fs::read(place.path("c.png")).unwrap());
}

#[test]
fn frames_are_the_files_of_single_runs() {
    let place = folder();
    std::fs::write(place.path("views.csv"), "eye_x,width\n,\n0.5,17\n").unwrap();
    for (options, ending) in [("--alpha --spp 4", "exr"), ("", "pfm"), ("--bits 16", "png")] {
        let options = format!("-q --device cpu {options} scene.txt -o");
        render(&place, &format!("--views views.csv {options} f%d.{ending}"), 0, "");
        render(&place, &format!("{options} one.{ending}"), 0, "");
        render(&place, &format!("--eye 0.5,0,0 --res 17x20 {options} two.{ending}"), 0, "");
        let file = |name: &str| std::fs::read(place.path(&format!("{name}.{ending}"))).unwrap();
        assert!(file("f1") == file("one") && file("f2") == file("two"), "{ending}");
    }
}

// --- alpha -----------------------------------------------------------------------------------------------------------------

/// Glass is as opaque as the rest, whatever is seen through it.
#[test]
fn coverage_is_the_part_of_the_samples_that_hit() {
    let seen = |line: &str, spp| {
        let mut scene = scene_of(&format!("{line}\nAMBIENT 1 1 1\nBACK 0.5 0.25 1\n"));
        (scene.width, scene.height) = (4, 4);
        reference(&scene, &Settings { pattern: Pattern::Grid { side: spp }, ..Settings::exact() })
    };
    let ball = "SPHERE ball 0 0 -3 1 1 1 1 1 1 1 0 0 0 1";
    let near = "SPHERE near 0 0 -3 1 1 1 1 1 1 0 0 0 0 1 1 1.5";
    let coverage = |pixels: &[Linear]| pixels.iter().map(|pixel| pixel.coverage).collect::<Vec<_>>();
    let all = seen(ball, 4);
    assert!(coverage(&all).iter().all(|part| (16.0 * part).fract() == 0.0), "{:?}", coverage(&all));
    assert!(all.iter().any(|pixel| pixel.coverage > 0.0 && pixel.coverage < 1.0));
    let background = DVec3::new(0.5, 0.25, 1.0);
    for pixel in &all {
        let premultiplied = pixel.premultiplied(background);
        assert!((premultiplied - DVec3::splat(pixel.coverage)).abs().max_element() < 1e-15, "{pixel:?}");
        let straight = if pixel.coverage > 0.0 { DVec3::ONE } else { DVec3::ZERO };
        assert!((pixel.straight(background) - straight).abs().max_element() < 1e-15, "{pixel:?}");
    }
    let glass = seen(near, 1);
    assert!(glass.iter().any(|pixel| pixel.coverage == 1.0) && glass.iter().any(|pixel| pixel.coverage == 0.0));
    assert!(glass.iter().all(|pixel| pixel.coverage == 0.0 || pixel.coverage == 1.0));
}

#[test]
fn alpha_is_straight_in_png_and_premultiplied_in_exr() {
    let place = folder();
    let (linear, background) = (reference(&small(), &settings(2)), DVec3::new(0.1, 0.1, 0.2));
    assert!(linear.iter().any(|pixel| pixel.coverage > 0.0 && pixel.coverage < 1.0));
    let (rule, round) = (Quantize::Truncate, |x: f64| x.round() as u16);
    render(&place, "-q --device cpu --spp 4 --alpha scene.txt -o a.png", 0, "");
    render(&place, "-q --device cpu --spp 4 --alpha --bits 16 scene.txt -o b.png", 0, "");
    render(&place, "-q --device cpu --spp 4 --alpha scene.txt -o a.exr", 0, "");
    render(&place, "-q --device cpu --spp 4 scene.txt -o plain.png", 0, "");
    let eight = linear.iter().flat_map(|pixel| {
        let [r, g, b] = rule.levels(pixel.straight(background)).map(u16::from);
        [r, g, b, round(255.0 * pixel.coverage)]
    });
    assert_eq!(png(&place, "a.png"), (8, 4, eight.collect()));
    let sixteen = linear.iter().flat_map(|pixel| {
        let [r, g, b] = rule.levels16(pixel.straight(background));
        [r, g, b, round(65535.0 * pixel.coverage)]
    });
    assert_eq!(png(&place, "b.png"), (16, 4, sixteen.collect()));
    // What is covered is as it is without alpha, and where nothing is there is nothing.
    let plain = Picture::read(place.path("plain.png")).unwrap();
    for (pixel, plain) in png(&place, "a.png").2.as_chunks::<4>().0.iter().zip(plain.pixels()) {
        match pixel {
            [r, g, b, 255] => assert_eq!([*r, *g, *b], plain.map(u16::from)),
            [_, _, _, 0] => assert_eq!(*pixel, [0; 4]),
            _ => {}
        }
    }
    let channels = exr(&place, "a.exr");
    assert_eq!(channels.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["A", "B", "G", "R"]);
    for (at, pixel) in linear.iter().enumerate() {
        let [alpha, blue, green, red] = [0, 1, 2, 3].map(|channel: usize| f64::from(channels[channel].1[at]));
        assert_eq!(alpha, pixel.coverage);
        // Over the background it is the picture again.
        let over = DVec3::new(red, green, blue) + background * (1.0 - alpha);
        assert!((over - pixel.color).abs().max_element() < 1e-6, "{at}: {over} {pixel:?}");
    }
}

// --- the device ------------------------------------------------------------------------------------------------------------

/// At every tier, with paths in place, kept and in trees: the levels are those of the plain kernels, rounding explains every colour, and
/// coverage is the reference's.
#[test]
fn the_device_has_explained_colours_at_every_tier() {
    let Some(gpu) = gpu("linear::the_device_has_explained_colours_at_every_tier") else { return };
    for name in ["effects/refraction.txt", "show/showcase.txt", "basic/ellipsoid.txt"] {
        let mut scene = scene(&root().join("scenes").join(name));
        (scene.width, scene.height) = (45, 37);
        for (spp, tier) in [
            (1, Tier::Fast),
            (2, Tier::Fast),
            (1, Tier::Robust),
            (2, Tier::Robust),
            (1, Tier::Double),
            (2, Tier::Double),
        ] {
            let settings = settings(spp);
            let (viewed, backend) = (scene.viewed(&settings), Backend::Device(&gpu, tier));
            let effects = Effects::of(&viewed);
            let options = Options { linear: true, ..Options::default() };
            let mut engine = Engine::verified(backend, viewed, &effects, &options, Verify::All).unwrap();
            let (rgb, linear) = rendered(&mut engine);
            let mut plain = Engine::new(backend, scene.viewed(&settings), &effects).unwrap();
            assert!(rgb == render_picture(&mut plain).unwrap().0, "{name} at {tier}, {spp}: other levels");
            let expected = reference(&scene, &settings);
            let covered = linear.iter().zip(&expected).filter(|(a, b)| a.coverage == b.coverage).count();
            assert!(covered + 2 >= linear.len(), "{name} at {tier}: {covered} of {}", linear.len());
            let close = linear.iter().zip(&expected).filter(|(a, b)| (a.color - b.color).length() < 1e-4).count();
            assert!(close * 50 >= linear.len() * 49, "{name} at {tier}: {close} of {}", linear.len());
            if tier == Tier::Double && gpu.device.info.f64 {
                let near = linear.iter().zip(&expected).filter(|(a, b)| (a.color - b.color).length() < 1e-12).count();
                assert!(near * 50 >= linear.len() * 49, "{name}: {near} of {} in f64", linear.len());
            }
            // A part has the pixels of the whole.
            let area = Area { left: 11, top: 5, width: 21, height: 19 };
            let part = scene.viewed(&settings).within(area).unwrap();
            let (_, part) = rendered(&mut Engine::with(backend, part, &effects, &options).unwrap());
            for (at, pixel) in part.iter().enumerate() {
                let (x, y) = (11 + at % 21, 5 + at / 21);
                assert_eq!(*pixel, linear[y * 45 + x], "{name} at {tier}, {spp}: x {x}, y {y}");
            }
        }
    }
}

#[test]
fn the_program_writes_the_devices_colours() {
    if gpu("linear::the_program_writes_the_devices_colours").is_none() {
        return;
    }
    let place = folder();
    render(&place, "--device gpu --precision fast --alpha --verify all scene.txt -o a.exr", 0, "");
    let (channels, expected) = (exr(&place, "a.exr"), reference(&small(), &settings(1)));
    let background = DVec3::new(0.1, 0.1, 0.2);
    let close = expected.iter().enumerate().filter(|&(at, pixel)| {
        let [alpha, b, g, r] = [0, 1, 2, 3].map(|channel: usize| f64::from(channels[channel].1[at]));
        alpha == pixel.coverage && (DVec3::new(r, g, b) - pixel.premultiplied(background)).length() < 1e-4
    });
    assert!(close.count() + 3 >= expected.len());
    render(&place, "-q --device gpu --precision double --bits 16 scene.txt -o a.png", 0, "");
    let levels = expected.iter().flat_map(|pixel| Quantize::Truncate.levels16(pixel.color));
    let same = png(&place, "a.png").2.into_iter().zip(levels).filter(|(a, b)| a == b).count();
    assert!(same + 3 >= 3 * expected.len(), "{same}");
}

// --- refusals --------------------------------------------------------------------------------------------------------------

#[test]
fn what_no_file_has_is_refused_before_anything_is_rendered() {
    let place = folder();
    for (arguments, message) in [
        ("--bits 12 scene.txt -o a.png", "expected 8 or 16"),
        ("--bits 16 scene.txt -o a.ppm", "--bits 16 is for PNG"),
        ("--bits 16 scene.txt -o a.exr", "--bits is for PNG"),
        ("--alpha scene.txt -o a.ppm", "PPM has no alpha channel"),
        ("--alpha scene.txt -o a.pfm", "PFM has no alpha channel"),
        ("--format tiff scene.txt -o a.png", "there are p6, p3, png, pfm and exr"),
        ("--precision certified scene.txt -o a.exr", "do not go with --precision certified"),
        ("--certificate c.json scene.txt -o a.exr", "do not go with --certificate"),
        ("--sparse 0.5 scene.txt -o a.pfm", "do not go with --foveate or --sparse"),
        ("--tile 0/2 --bits 16 scene.txt -o a.png", "do not go with --crop, --tile or --resume"),
        ("--resume --alpha scene.txt -o a.png", "do not go with --crop, --tile or --resume"),
        ("--turntable 2 --resume scene.txt -o a%d.exr", "do not go with --crop, --tile or --resume"),
        ("--res 8192x8192 scene.txt -o a.exr", "33554432 pixels at the most"),
        ("scene.txt -o a.tiff", "--format p6, p3, png, pfm or exr writes that"),
    ] {
        render(&place, &format!("--device cpu {arguments}"), 2, message);
        assert_eq!(std::fs::read_dir(place.folder()).unwrap().count(), 1, "{arguments}");
    }
}

/// OUTPUT may name such files, and replaces its own.
#[test]
fn output_may_name_files_of_colours() {
    let place = folder();
    for name in ["own.exr", "own.pfm"] {
        let scene = Scene { output: Some(name.into()), ..small() };
        std::fs::write(place.path("scene.txt"), scene.to_string()).unwrap();
        for _ in 0..2 {
            render(&place, "-q --device cpu scene.txt", 0, "");
        }
        assert!(place.path(name).exists());
        assert!(place.run("check scene.txt").status.success());
    }
    std::fs::write(place.path("own.pfm"), "notes").unwrap();
    render(&place, "-q --device cpu scene.txt", 6, "does not begin like a PPM, PNG, PFM or EXR picture");
}
