//! Samples that are no regular grid: their places, how evenly they lie, and that every way of rendering has the same.

use trueray::area::Area;
use trueray::cpu::Reference;
use trueray::effects::Effects;
use trueray::engine::{Backend, Engine, render_picture};
use trueray::pattern::{Filter, Pattern};
use trueray::precision::Tier;
use trueray::scene::Scene;
use trueray::settings::{SampleOffset, Settings};

use crate::support::{Case, Folder, gpu, gpu_picture, scene_of};

const FILTERS: [Filter; 3] = [Filter::Box, Filter::Tent, Filter::Gaussian];

fn fibonacci(count: u32, filter: Filter) -> Pattern {
    Pattern::Fibonacci { count, filter }
}

/// The places of the samples in their pixel.
fn places(pattern: Pattern, sampling: SampleOffset) -> Vec<[f64; 2]> {
    let [across, down] = pattern.ticks(sampling.offset());
    let place = |sample| {
        let [column, row] = pattern.sample_place(sample);
        [across.place(column), down.place(row)]
    };
    (0..pattern.count()).map(place).collect()
}

/// A mirror, an ellipsoid, shadows, a ball that the left edge cuts, and a small one beyond it, which only wide filters see.
fn small() -> Scene {
    let text = "SPHERE a 0 0 -6 2 2 2 0.9 0.2 0.1 0.3 0.7 0.3 0.4 20\nSPHERE b 2 1 -5 0.5 1 0.5 0.1 0.8 0.3 0.3 0.6 0.2 0 10\n\
                SPHERE c -3 -1 -3 0.5 0.5 0.5 0.2 0.3 0.9 0.4 0.6 0.2 0 10\nSPHERE d -4.14 2 -4 0.1 0.1 0.1 1 1 1 1 0 0 0 1\n\
                LIGHT l 5 6 0 0.9 0.9 0.8\nAMBIENT 0.3 0.3 0.3\nBACK 0.1 0.1 0.2\n";
    Scene { width: 45, height: 37, ..scene_of(text) }
}

fn picture(backend: Backend, scene: &Scene, settings: &Settings) -> Vec<u8> {
    let viewed = scene.viewed(settings);
    let effects = Effects::of(&viewed);
    render_picture(&mut Engine::new(backend, viewed, &effects).unwrap()).unwrap().0
}

// --- places ----------------------------------------------------------------------------------------------------------------

#[test]
fn one_sample_lies_where_that_of_a_grid_does() {
    for sampling in [SampleOffset::Corner, SampleOffset::BottomLeft, SampleOffset::Center] {
        let (x, y) = sampling.offset();
        for filter in FILTERS {
            assert_eq!(places(fibonacci(1, filter), sampling), [[x, y]], "{sampling:?}, {filter:?}");
        }
        let settings = Settings { sampling, ..Settings::classic() };
        let own = Settings { pattern: fibonacci(1, Filter::Box), ..settings };
        assert_eq!(picture(Backend::Reference, &small(), &own), picture(Backend::Reference, &small(), &settings));
    }
}

/// Each column and each row of cells has one sample; their mean is the middle, and what conventions move are all alike.
#[test]
fn samples_are_even_across_and_down() {
    for filter in FILTERS {
        for count in 1..=Pattern::MAX_COUNT {
            let pattern = fibonacci(count, filter);
            let middle = places(pattern, SampleOffset::Center);
            for axis in [0, 1] {
                let mut line: Vec<f64> = middle.iter().map(|place| place[axis]).collect();
                line.sort_by(f64::total_cmp);
                assert!(line.windows(2).all(|pair| pair[0] < pair[1]), "{pattern:?}");
                for (low, high) in line.iter().zip(line.iter().rev()) {
                    assert_eq!(low + high, 1.0, "{pattern:?}: both halves mirror each other");
                }
                if filter == Filter::Box {
                    let expected = |i: usize| (i as f64 + 0.5) / f64::from(count);
                    assert!(line.iter().enumerate().all(|(i, place)| *place == expected(i)), "{count}");
                }
            }
            let step = 0.5 / f64::from(count);
            for (place, corner) in middle.iter().zip(places(pattern, SampleOffset::BottomLeft)) {
                let moved = [place[0] - corner[0] - step, corner[1] - place[1] - step];
                assert!(moved.iter().all(|off| off.abs() < 1.0 / 65536.0), "{pattern:?}");
            }
        }
    }
}

/// The mean square of the distances from the middle is that of the filter: 1/12, 1/6, and of the Gaussian by quadrature.
#[test]
fn samples_are_spread_as_the_filter_says() {
    let gaussian = {
        let weight = |x: f64| (-2.0 * x * x).exp() - (-4.5_f64).exp();
        let x = |i: u32| (f64::from(i) + 0.5) * 1.5e-4;
        let sum = |of: fn(f64) -> f64| (0..10_000).map(x).map(|x| of(x) * weight(x)).sum::<f64>();
        sum(|x| x * x) / sum(|_| 1.0)
    };
    for (filter, expected, widest) in
        [(Filter::Box, 1.0 / 12.0, 0.5), (Filter::Tent, 1.0 / 6.0, 1.0), (Filter::Gaussian, gaussian, 1.5)]
    {
        let places = places(fibonacci(256, filter), SampleOffset::Center);
        for axis in [0, 1] {
            let spread: f64 = places.iter().map(|place| (place[axis] - 0.5).powi(2)).sum::<f64>() / 256.0;
            assert!((spread / expected - 1.0).abs() < 0.01, "{filter:?}: {spread} for {expected}");
            assert!(places.iter().all(|place| (place[axis] - 0.5).abs() < widest), "{filter:?}");
        }
    }
}

/// The root mean square of what the part of the samples in a box from a corner is off its area (Warnock's formula), over all corners.
fn discrepancy(places: &[[f64; 2]]) -> f64 {
    let n = places.len() as f64;
    let mut sum = 0.0;
    for flip in [[false, false], [true, false], [false, true], [true, true]] {
        let places: Vec<[f64; 2]> = places
            .iter()
            .map(|place| [0, 1].map(|axis| if flip[axis] { 1.0 - place[axis] } else { place[axis] }))
            .collect();
        let single: f64 = places.iter().map(|[x, y]| (1.0 - x * x) * (1.0 - y * y)).sum();
        let pair = |[a, b]: [f64; 2], [c, d]: [f64; 2]| (1.0 - a.max(c)) * (1.0 - b.max(d));
        let pairs: f64 = places.iter().map(|&a| places.iter().map(|&b| pair(a, b)).sum::<f64>()).sum();
        sum += 1.0 / 9.0 - single / (2.0 * n) + pairs / (n * n);
    }
    (sum / 4.0).sqrt()
}

#[test]
fn the_lattice_lies_more_evenly_than_a_grid() {
    for (side, at_least) in [(2, 1.3), (3, 1.6), (4, 1.9), (8, 3.0), (16, 5.0)] {
        let grid = discrepancy(&places(Pattern::Grid { side }, SampleOffset::Center));
        let own = discrepancy(&places(fibonacci(side * side, Filter::Box), SampleOffset::Center));
        println!("{:4} samples: {grid:.5} grid, {own:.5} Fibonacci", side * side);
        assert!(own * at_least < grid, "{side}: {own} {grid}");
    }
}

// --- pictures --------------------------------------------------------------------------------------------------------------

/// The brightness of each pixel of a white scene: the part that it covers.
fn coverage(scene: &Scene, pattern: Pattern) -> Vec<f64> {
    let settings = Settings { pattern, ..Settings::exact() };
    let viewed = scene.viewed(&settings);
    let reference = Reference::<f64>::new(&viewed, &Effects::of(&viewed));
    let pixels = (0..scene.height).flat_map(|y| (0..scene.width).map(move |x| (x, y)));
    pixels.map(|(x, y)| reference.color(x, y).unwrap().x).collect()
}

/// Edges that are all but level or upright, as of a horizon: against 4096 samples of each pixel the error falls faster than a grid's.
#[test]
fn errors_at_edges_fall_faster_than_those_of_a_grid() {
    const SIZE: u32 = 24;
    // Balls so large that their edges are straight, through the middle of the picture; with the part of each pixel that they cover.
    let scenes: Vec<(Scene, Vec<f64>)> = [0.02_f64, -0.05, 0.08, 1.55, 1.62, 1.66]
        .into_iter()
        .map(|angle| {
            let (sine, cosine) = angle.sin_cos();
            let ball =
                format!("SPHERE s {} {} -10 1e4 1e4 1e4 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1", 1e4 * cosine, 1e4 * sine);
            let scene = Scene { width: SIZE, height: SIZE, ..scene_of(&ball) };
            let fine = Scene { width: 4 * SIZE, height: 4 * SIZE, ..scene.clone() };
            let fine = coverage(&fine, Pattern::Grid { side: 16 });
            let mean = |x: u32, y: u32| {
                let part = |part: u32| fine[((4 * y + part / 4) * 4 * SIZE + 4 * x + part % 4) as usize];
                (0..16).map(part).sum::<f64>() / 16.0
            };
            let truth = (0..SIZE * SIZE).map(|at| mean(at % SIZE, at / SIZE)).collect();
            (scene, truth)
        })
        .collect();
    let error = |pattern: Pattern| {
        let squares = |(scene, truth): &(Scene, Vec<f64>)| {
            let colors = coverage(scene, pattern);
            colors.iter().zip(truth).map(|(color, truth)| (color - truth).powi(2)).sum::<f64>()
        };
        (scenes.iter().map(squares).sum::<f64>() / f64::from(6 * SIZE * SIZE)).sqrt()
    };
    let errors = [2, 4, 8, 16].map(|side| {
        let both = [Pattern::Grid { side }, fibonacci(side * side, Filter::Box)].map(error);
        println!("{:4} samples: {:.5} grid, {:.5} Fibonacci", side * side, both[0], both[1]);
        both
    });
    assert!(errors.iter().all(|[grid, own]| own * 1.3 < *grid), "{errors:?}");
    // From 4 samples to 64.
    let falls = [0, 1].map(|pattern| errors[0][pattern] / errors[2][pattern]);
    assert!(falls[1] > 1.25 * falls[0], "{falls:?}");
}

/// At every tier, certified pictures among them, with paths in place; parts, and lists of pixels, have the pixels of the whole.
#[test]
fn every_way_of_rendering_has_the_same_samples() {
    let gpu = gpu("pattern::every_way_of_rendering_has_the_same_samples");
    let scene = small();
    let patterns = [fibonacci(5, Filter::Box), fibonacci(2, Filter::Tent), fibonacci(7, Filter::Gaussian)];
    for (base, pattern) in [Settings::classic(), Settings::exact(), Settings::exact()].into_iter().zip(patterns) {
        let settings = Settings { pattern, ..base };
        let case = Case::new(&scene, &settings);
        let expected = case.expected.rgb();
        let area = Area { left: 3, top: 5, width: 21, height: 19 };
        let cut = |rgb: &[u8]| -> Vec<u8> {
            let rows = rgb.chunks(45 * 3).skip(5).take(19);
            rows.flat_map(|row| row[3 * 3..24 * 3].to_vec()).collect()
        };
        let part = |backend| {
            let viewed = scene.viewed(&settings).within(area).unwrap();
            render_picture(&mut Engine::new(backend, viewed, &case.effects).unwrap()).unwrap().0
        };
        assert!(part(Backend::Reference) == cut(expected), "{pattern:?}");
        let Some(gpu) = &gpu else { continue };
        assert!(picture(Backend::Certified(gpu, Tier::Fast), &scene, &settings) == expected, "{pattern:?}, certified");
        for tier in Tier::ALL {
            let (shown, not_finite) = gpu_picture(gpu, tier, &scene, &settings, &case.effects);
            assert_eq!(not_finite, 0);
            case.assert_explained(&format!("{pattern:?} at {tier}"), &shown, Backend::Device(gpu, tier).judge());
            let differing = shown.pixels().iter().zip(case.expected.pixels()).filter(|(a, b)| a != b).count();
            assert!(differing <= 20, "{pattern:?} at {tier}: {differing}");
            assert!(part(Backend::Device(gpu, tier)) == cut(shown.rgb()), "{pattern:?} at {tier}: a part");
        }
    }
}

/// Buffers have room for the samples of as many pixels as a dispatch has, and no more.
#[test]
fn many_samples_fit_the_buffers_of_a_device() {
    let Some(gpu) = gpu("pattern::many_samples_fit_the_buffers_of_a_device") else { return };
    let ball = scene_of("SPHERE s 0 0 -2 1.5 1.5 1.5 1 1 1 1 0 0 0 1\nAMBIENT 1 1 1");
    let scene = Scene { width: 400, height: 300, ..ball };
    for pattern in [Pattern::Grid { side: 8 }, fibonacci(64, Filter::Box)] {
        let settings = Settings { pattern, ..Settings::exact() };
        let rgb = picture(Backend::Device(&gpu, Tier::Fast), &scene, &settings);
        assert_eq!(rgb[(150 * 400 + 200) * 3..][..3], [255; 3], "{pattern:?}");
    }
}

// --- the program -----------------------------------------------------------------------------------------------------------

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = Folder::with_scene(&small().to_string());
    for (arguments, message) in [
        ("render scene.txt --spp 7", "--spp 7: expected a square number from 1 to 256"),
        ("render scene.txt --spp 7", "help: --pattern fibonacci takes any number"),
        ("render scene.txt --spp 257 --pattern fibonacci", "expected a number from 1 to 256"),
        ("render scene.txt --spp 0 --pattern fibonacci", "expected a number from 1 to 256"),
        ("render scene.txt --spp 4 --filter tent", "a regular grid has no --filter but the box"),
        ("render scene.txt --pattern sobol", "possible values: grid, fibonacci"),
        ("render scene.txt --pattern fibonacci --filter mitchell", "possible values: box, tent, gaussian"),
        ("export scene.txt --to povray --pattern fibonacci --spp 5", "one sample a pixel"),
    ] {
        folder.says(arguments, 2, message);
    }
}

/// What a file says of itself, a certificate, `verify` and `compare --scene` tell patterns and filters apart.
#[test]
fn files_and_certificates_say_how_samples_lie() {
    let folder = Folder::with_scene(&small().to_string());
    let (tent, gaussian) =
        ("--pattern fibonacci --spp 6 --filter tent", "--pattern fibonacci --spp 6 --filter gaussian");
    folder.says(&format!("render -q --device cpu {tent} --certificate c.json scene.txt -o whole.png"), 0, "");
    folder.says(
        &format!("verify --device cpu whole.png --scene scene.txt --certificate c.json {tent}"),
        0,
        "of this scene",
    );
    folder.says(
        &format!("verify --device cpu whole.png --scene scene.txt --certificate c.json {gaussian}"),
        1,
        "settings.filter is \"tent\" there and \"gaussian\" here",
    );
    folder.says(
        "verify --device cpu whole.png --scene scene.txt --certificate c.json --spp 4",
        1,
        "settings.samples_per_side",
    );
    folder.says(&format!("compare --device cpu --scene scene.txt whole.png {tent}"), 0, "");
    folder.says(&format!("compare --device cpu --scene scene.txt whole.png {gaussian}"), 1, "unexplained");
    for (part, options) in [(0, tent), (1, tent), (2, gaussian)] {
        let tile = part.min(1);
        folder.says(&format!("render -q --device cpu {options} --tile {tile}/2 scene.txt -o {part}.png"), 0, "");
    }
    folder.says("merge 0.png 1.png -o merged.png", 0, "");
    folder.says(&format!("render -q --device cpu {tent} scene.txt -o whole.ppm"), 0, "");
    folder.says("compare merged.png whole.ppm", 0, "");
    folder.says("merge 0.png 2.png -o mixed.png", 2, "filter");
    // One sample lies where a grid has it: the pictures are the same, and so is what is said of them.
    folder.says("render -q --device cpu --certificate one.json scene.txt -o one.png", 0, "");
    folder.says("render -q --device cpu --tile 0/2 scene.txt -o 0.png", 0, "");
    for filter in ["box", "tent", "gaussian"] {
        let one = format!("--pattern fibonacci --filter {filter}");
        folder.says(&format!("render -q --device cpu --tile 1/2 scene.txt -o 1.png {one}"), 0, "");
        folder.says("merge 0.png 1.png -o merged.png", 0, "");
        folder.says("compare merged.png one.png", 0, "");
        folder.says(
            &format!("verify --device cpu one.png --scene scene.txt --certificate one.json {one}"),
            0,
            "of this",
        );
    }
    assert!(!folder.read("merged.png").is_empty());
}
