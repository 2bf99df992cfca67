//! Pictures of very many columns or rows: their places fit into whatever they are kept in.

use trueray::compare::Explanation;
use trueray::cpu::Reference;
use trueray::effects::Effects;
use trueray::engine::{Backend, Engine, Options};
use trueray::gpu::{Error, Gpu};
use trueray::precision::Tier;
use trueray::scene::Scene;
use trueray::settings::Settings;

use crate::support::{cpu_picture, gpu, gpu_picture, scene_of};

/// What is seen beside it.
const BACKGROUND: [u8; 3] = [128, 153, 191];

/// A sphere beside the middle of the picture's far end, where columns and rows are greatest.
fn at_the_end(width: u32, height: u32) -> Scene {
    let (x, y) = if width > height { (3.8, 0.0) } else { (0.0, -3.8) };
    let scene = scene_of(&format!(
        "SPHERE s {x} {y} -4 0.3 0.3 0.3 0.2 0.7 0.3 0.3 0.7 0 0.2 1\nBACK 0.5 0.6 0.75\nAMBIENT 1 1 1\nLIGHT l 0 0 0 1 1 1"
    ));
    Scene { width, height, ..scene }
}

#[test]
fn pictures_of_very_many_columns_or_rows_are_those_of_the_reference() {
    let Some(gpu) = gpu("pictures_of_very_many_columns_or_rows_are_those_of_the_reference") else { return };
    let settings = Settings::exact();
    for (width, height) in [(600_000, 1), (1, 600_000), (2_000_000, 1), (524_296, 1)] {
        let scene = at_the_end(width, height);
        let effects = Effects::of(&scene.viewed(&settings));
        let (expected, _) = cpu_picture::<f64>(&scene, &settings, &effects);
        let reference = Reference::new(&scene.viewed(&settings), &effects);
        let seen = expected.pixels().iter().filter(|pixel| **pixel != BACKGROUND).count();
        assert!(seen > 10_000, "{width}x{height}: {seen}");
        for tier in Tier::ALL.into_iter().filter(|&tier| gpu.kernel(tier).is_ok()) {
            let (picture, _) = gpu_picture(&gpu, tier, &scene, &settings, &effects);
            let judge = Backend::Device(&gpu, tier).judge();
            let explanation = Explanation::of(&picture, &expected, &reference, &judge);
            assert_eq!(explanation.unexplained, 0, "{width}x{height}, {tier}:\n{}", explanation.report());
            // Not because everything is explained.
            assert!(explanation.differing < seen as u64 / 20, "{width}x{height}, {tier}: {}", explanation.report());
        }
    }
}

/// The most columns and rows that a scene file may ask for.
const MOST: u32 = 1 << 24;

/// A level more or less, which is what `fast` makes of a quantisation step.
fn is_near(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 1)
}

/// Pictures that nobody keeps as a whole: single pixels, and the last rows.
#[test]
fn the_last_places_of_the_greatest_pictures_are_rendered() {
    let Some(gpu) = gpu("the_last_places_of_the_greatest_pictures_are_rendered") else { return };
    for size in [(MOST, 1), (1, MOST), (3000, MOST)] {
        for tier in [Tier::Fast, Tier::Double].into_iter().filter(|&tier| gpu.kernel(tier).is_ok()) {
            if let Err(refusal) = assert_last_places(&gpu, tier, size) {
                let held = greatest_held(&refusal, size);
                assert_last_places(&gpu, tier, held).unwrap();
                // A tile more is too much.
                let more = held_by(held, |long| long + TILE);
                assert!(
                    matches!(assert_last_places(&gpu, tier, more), Err(Error::TooLarge { .. })),
                    "{more:?}, {tier}"
                );
            }
        }
    }
}

/// Fails where the last places differ from the reference's; an error is one of the device.
fn assert_last_places(gpu: &Gpu, tier: Tier, (width, height): (u32, u32)) -> Result<(), Error> {
    let settings = Settings::exact();
    let scene = at_the_end(width, height);
    let effects = Effects::of(&scene.viewed(&settings));
    let reference = Reference::<f64>::new(&scene.viewed(&settings), &effects);
    let (case, backend) = (format!("{width}x{height}, {tier}"), Backend::Device(gpu, tier));
    let at = |size: u32, part: f64| (f64::from(size - 1) * part) as u32;
    let pixel = |i: u32| {
        let part = (f64::from(i) / 99.0).powf(0.1);
        let [x, y] = if width > height { [part, 0.5] } else { [0.5, part] };
        [at(width, x), at(height, y)]
    };
    let pixels: Vec<_> = (0..100).map(pixel).collect();
    let mut list = Engine::with(backend, scene.viewed(&settings), &effects, &Options::default())?;
    let [mut colors, mut expected] = [0, 0].map(|_| vec![[0; 3]; pixels.len()]);
    list.pixels(&pixels, &mut colors)?;
    reference.pixels(&pixels, &mut expected).unwrap();
    assert!(is_near(colors.as_flattened(), expected.as_flattened()), "{case}");
    assert!(expected.iter().filter(|color| **color != BACKGROUND).count() > 3, "{case}");

    let count = 13;
    if width < height {
        let [mut rgb, mut expected] = [0, 0].map(|_| vec![0; 3 * width as usize * count as usize]);
        let mut rows = Engine::new(backend, scene.viewed(&settings), &effects)?;
        rows.rows(height - count, &mut rgb)?;
        reference.rows(height - count, &mut expected).unwrap();
        assert!(is_near(&rgb, &expected), "{case}");
        assert!(expected.chunks(3).any(|color| *color != BACKGROUND), "{case}");
    }
    Ok(())
}

/// The tables of a picture end with whole tiles.
const TILE: u32 = 8;

/// A size with another long side.
fn held_by((width, height): (u32, u32), long: impl Fn(u32) -> u32) -> (u32, u32) {
    if width > height { (long(width), height) } else { (width, long(height)) }
}

/// The greatest size that a device holds which refuses `size`: its refusal says what that takes, and what there is.
fn greatest_held(refusal: &Error, size: (u32, u32)) -> (u32, u32) {
    let Error::TooLarge { limit, .. } = refusal else { panic!("{refusal}") };
    let numbers: Vec<u64> = limit.split(' ').filter_map(|word| word.parse().ok()).collect();
    let ([bytes, most], true) = (&numbers[..], limit.contains("columns and rows")) else { panic!("{refusal}") };
    let a_place = bytes / u64::from(size.0 + size.1);
    let excess = (bytes - most).div_ceil(a_place) as u32;
    held_by(size, |long| long - excess.next_multiple_of(TILE))
}
