//! Where a tier says that it covers a scene, its picture is that of `double` but for one pixel in ten thousand: over more than a
//! hundred families of scenes, ordinary and hard.
//!
//! `TRUERAY_COVERAGE=1` renders them at 640 × 480 in both conventions, and prints a table.

use trueray::compare::{Difference, Explanation};
use trueray::cpu::Reference;
use trueray::effects::Effects;
use trueray::engine::Backend;
use trueray::precision::{Demand, Request, Selection, Tier};
use trueray::settings::Settings;
use trueray::stress::scene_kinds;

use crate::support::{gpu, gpu_picture, is_set, root, scene};

/// The seed of the scenes.
const SEED: u64 = 1;

/// How many of so many pixels may differ. One in 10,000; of a small picture that is less than one pixel, and which one it hits is
/// chance: there one more, and three standard deviations.
fn limit(pixels: u64, is_whole: bool) -> u64 {
    let expected = pixels as f64 / 10_000.0;
    if is_whole { expected as u64 } else { (expected.max(1.0) + 1.0 + 3.0 * expected.sqrt()) as u64 }
}

#[test]
fn covered_pictures_differ_from_double_in_one_pixel_of_ten_thousand() {
    let Some(gpu) = gpu("covered_pictures_differ_from_double_in_one_pixel_of_ten_thousand") else { return };
    let is_whole = is_set("TRUERAY_COVERAGE");
    let conventions = [("classic", Settings::classic()), ("exact", Settings::exact())];
    let kinds = scene_kinds();
    assert!(kinds.len() >= 100, "{}", kinds.len());
    let mut wrong = Vec::new();
    // Of each tier: pictures that it covers, their pixels, and how many of these differ.
    let mut sums = [(0, 0, 0); 2];
    for (index, kind) in kinds.iter().enumerate() {
        let mut scene = kind.scene(SEED);
        (scene.width, scene.height) = if is_whole { (640, 480) } else { (96, 72) };
        for (convention, (name, settings)) in conventions.iter().enumerate() {
            if !is_whole && index % 2 != convention {
                continue;
            }
            let effects = Effects::of(&scene.viewed(settings));
            let demand = Demand::of(&scene.viewed(settings), &effects);
            let mut expected = None;
            for tier in [Tier::Fast, Tier::Robust] {
                let why = demand.beyond(tier, &scene);
                if gpu.kernel(tier).is_err() || (why.is_some() && !is_whole) {
                    continue;
                }
                let expected =
                    expected.get_or_insert_with(|| gpu_picture(&gpu, Tier::Double, &scene, settings, &effects).0);
                let (picture, not_finite) = gpu_picture(&gpu, tier, &scene, settings, &effects);
                let differing = Difference::between(&picture, expected).unwrap().differing;
                let case = format!("{}, {name}, {tier}", kind.name);
                if is_whole {
                    let (share, says) = (demand.share[tier as usize].value, why.as_deref().unwrap_or("covers"));
                    println!(
                        "{case}: {} differ, {} by more than 1; {share:.1e}; {says}",
                        differing.over_0, differing.over_1
                    );
                }
                if why.is_some() {
                    continue;
                }
                let (covered, pixels, all) = &mut sums[tier as usize];
                (*covered, *pixels, *all) = (*covered + 1, *pixels + expected.pixel_count(), *all + differing.over_0);
                let reference = Reference::new(&scene.viewed(settings), &effects);
                let judge = Backend::Device(&gpu, tier).judge();
                let unexplained = Explanation::of(&picture, expected, &reference, &judge).unexplained;
                if differing.over_0 > limit(expected.pixel_count(), is_whole) || unexplained > 0 || not_finite > 0 {
                    wrong.push(format!("{case}: {} differ, {unexplained} unexplained", differing.over_0));
                }
            }
        }
    }
    println!("pictures covered, pixels, differing: {sums:?} at fast and robust");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let pictures = if is_whole { 2 * kinds.len() } else { kinds.len() };
    for (covered, pixels, differing) in sums {
        // All together are far from the limit, and a tier that covers nothing has promised nothing.
        assert!(differing * 20_000 <= pixels, "{sums:?}");
        assert!(covered == 0 && gpu.kernel(Tier::Robust).is_err() || 2 * covered >= pictures, "{sums:?}");
    }
}

/// What is ordinary stays with `fast`; what is not says why.
#[test]
fn auto_says_what_takes_it_to_another_tier() {
    let settings = Settings::exact();
    let select = |scene: &trueray::scene::Scene| {
        Selection::of(&scene.viewed(&settings), &Effects::of(&scene.viewed(&settings)), Request::Auto, &Tier::ALL)
    };
    let kinds = scene_kinds();
    let named = |name: &str| select(&kinds.iter().find(|kind| kind.name == name).unwrap().scene(SEED));
    for name in [
        "matte spheres",
        "exponent 100000",
        "six mirrors of 0.9",
        "ellipsoids up to 1:10",
        "sun 1e12 away",
        "needles 1:1e-3",
    ] {
        assert_eq!(named(name).tier, Tier::Fast, "{name}: {}", named(name).reason);
    }
    // A tiny sphere that is hardly seen decides nothing; nor does a disc for being flat.
    for name in ["tiny spheres of 1e-5", "tiny nested shells", "lying discs 1:1e-3"] {
        assert_eq!(named(name).tier, Tier::Fast, "{name}: {}", named(name).reason);
    }
    for name in ["mirror floor of radius 5000", "a group 1e4 away", "bench spheres 1000"] {
        let selection = named(name);
        assert_eq!(selection.tier, Tier::Robust, "{name}: {}", selection.reason);
        let says = &selection.reason;
        assert!(
            says.starts_with("not fast: rounding changes about one pixel in ") && says.contains("sphere 's"),
            "{says}"
        );
    }
    let earth = select(&scene(&root().join("scenes/hard/earth-at-one-metre.txt")));
    assert!(earth.reason.contains("nearness of the eye or a light"), "{}", earth.reason);
}
