//! Pixels that the bound of certified pictures misses: a kernel is sure of them, and they are not the reference's. There are none.
//!
//! `TRUERAY_MISSED=N` looks through all kinds of scenes at 640 × 480 with N seeds, and prints a table.

use trueray::cpu::Reference;
use trueray::effects::Effects;
use trueray::engine::Options;
use trueray::gpu::{Gpu, GpuRenderer, Rows};
use trueray::precision::{Request, Selection, Tier};
use trueray::scene::Scene;
use trueray::settings::Settings;
use trueray::stress::scene_kinds;

use crate::support::gpu;

/// What pictures of one tier came to, in pixels.
#[derive(Debug, Default, Clone, Copy)]
struct Count {
    all: usize,
    unsure: usize,
    /// Those of them that have another value than the reference.
    different: usize,
    missed: usize,
}

impl Count {
    fn add(&mut self, other: Self) {
        self.all += other.all;
        self.unsure += other.unsure;
        self.different += other.different;
        self.missed += other.missed;
    }
}

/// What the certified kernel of `tier` makes of the scene beside `expected`.
fn count(gpu: &Gpu, tier: Tier, scene: &Scene, settings: &Settings, effects: &Effects, expected: &[[u8; 3]]) -> Count {
    let options = Options { certified: true, ..Options::default() };
    let mut renderer = GpuRenderer::<Rows>::with(gpu, &scene.viewed(settings), effects, tier, &options).unwrap();
    let mut rgb = vec![0; 3 * expected.len()];
    let rendered = renderer.rows(0, &mut rgb).unwrap();
    let is_wrong: Vec<bool> = rgb.as_chunks::<3>().0.iter().zip(expected).map(|(own, right)| own != right).collect();
    let wrong = is_wrong.iter().filter(|&&wrong| wrong).count();
    let unsure: Vec<_> = rendered.unsure.into_iter().chain(rendered.cut).collect();
    let different = unsure.iter().filter(|[x, y]| is_wrong[(y * scene.width + x) as usize]).count();
    Count { all: expected.len(), unsure: unsure.len(), different, missed: wrong - different }
}

#[test]
fn no_pixel_of_random_scenes_is_missed() {
    let Some(gpu) = gpu("missed::no_pixel_of_random_scenes_is_missed") else { return };
    let seeds: Option<u64> = std::env::var("TRUERAY_MISSED").ok().map(|seeds| seeds.parse().unwrap());
    let conventions = [("classic", Settings::classic()), ("exact", Settings::exact())];
    let mut sums = [Count::default(); Tier::ALL.len()];
    let mut missed = Vec::new();
    for seed in 1..=seeds.unwrap_or(1) {
        for (index, kind) in scene_kinds().iter().enumerate() {
            let mut scene = kind.scene(seed);
            (scene.width, scene.height) = if seeds.is_some() { (640, 480) } else { (64, 48) };
            for (convention, (name, settings)) in conventions.iter().enumerate() {
                if seeds.is_none() && index % 4 != convention {
                    continue;
                }
                let viewed = scene.viewed(settings);
                let effects = Effects::of(&viewed);
                let first = Selection::of(&viewed, &effects, Request::Certified, gpu.ladder()).tier;
                let mut expected = vec![[0; 3]; (scene.width * scene.height) as usize];
                Reference::<f64>::new(&viewed, &effects).rows(0, expected.as_flattened_mut()).unwrap();
                for tier in [Tier::Fast, Tier::Double] {
                    if tier < first || tier == Tier::Double && !gpu.device.info.f64 {
                        continue;
                    }
                    let own = count(&gpu, tier, &scene, settings, &effects, &expected);
                    sums[tier as usize].add(own);
                    if own.missed > 0 {
                        missed.push(format!("{}, {name}, {tier}, seed {seed}: {own:?}", kind.name));
                    }
                }
            }
        }
        if seeds.is_some() {
            println!("after seed {seed}: {sums:?}\n{}", missed.join("\n"));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
    let [fast, ..] = sums;
    assert!(fast.different > 10, "{fast:?}: nothing is shown");
}
