//! The classes that need whole pictures: lights in odd places, mirrors.

use super::families::scene_kinds;
use super::metrics::Metrics;
use crate::compare::Explanation;
use crate::cpu::{Judge, Reference};
use crate::effects::Effects;
use crate::engine::{Backend, Engine, Options, render_picture};
use crate::film::Picture;
use crate::gpu::{Error, Gpu, GpuRenderer, Rows};
use crate::misuse::Misuse;
use crate::precision::{Request, Selection, Tier};
use crate::scene::{Scene, parse};
use crate::settings::Settings;

/// Width and height: odd, so that a ray goes through the very middle.
const SIZE: u32 = 97;

fn scene(statements: &str) -> Result<Scene, Error> {
    let head = format!("NEAR 1\nLEFT -0.5\nRIGHT 0.5\nBOTTOM -0.5\nTOP 0.5\nRES {SIZE} {SIZE}\n");
    let parsed = parse("stress", format!("{head}{statements}").as_bytes());
    let report = parsed.report(false);
    parsed.scene.ok_or_else(|| Misuse::Picture(format!("a scene of this program has errors: {report}")).into())
}

/// The device's picture and its number of pixels that are not finite.
fn render(gpu: &Gpu, tier: Tier, scene: &Scene, settings: &Settings) -> Result<(Vec<u8>, u64), Error> {
    let viewed = scene.viewed(settings);
    let effects = Effects::of(&viewed);
    render_picture(&mut Engine::new(Backend::Device(gpu, tier), viewed, &effects)?)
}

/// Adds one scene to the metrics: pixels that are not finite, and differences that the reference does not explain.
fn add(metrics: &mut Metrics, gpu: &Gpu, tier: Tier, scene: &Scene, settings: &Settings) -> Result<(), Error> {
    let (rgb, not_finite) = render(gpu, tier, scene, settings)?;
    let viewed = scene.viewed(settings);
    let effects = Effects::of(&viewed);
    let (expected, _) = render_picture(&mut Engine::new(Backend::Reference, scene.viewed(settings), &effects)?)?;
    metrics.count += u64::from(SIZE * SIZE);
    metrics.not_finite += not_finite;
    let [picture, expected] = [rgb, expected].map(|rgb| Picture::assemble(SIZE, SIZE, rgb));
    let reference = Reference::new(&viewed, &effects);
    let explanation = Explanation::of(&picture, &expected, &reference, &Judge::of(tier));
    *metrics.differing.get_or_insert(0) += explanation.unexplained;
    Ok(())
}

/// Class 16: a light on the surface, at the middle ray's hit point, inside, behind.
pub(super) fn odd_lights(gpu: &Gpu, tier: Tier) -> Result<Metrics, Error> {
    let mut metrics = Metrics::default();
    for place in ["0 0 -3", "0 1 -4", "0.6 0 -3.2", "0 0 -4", "0 0 -3.5", "0 0 -8", "0 0 0", "0 0 -3.0000001"] {
        let scene = scene(&format!(
            "SPHERE s 0 0 -4 1 1 1 0.8 0.5 0.3 0.1 0.6 0.5 0 50\nSPHERE back 0 0 -14 8 8 8 1 1 1 0.1 0.8 0.1 0 5\n\
             LIGHT l {place} 1 1 1\nBACK 0 0 0.2\nAMBIENT 0.2 0.2 0.2\n"
        ))?;
        add(&mut metrics, gpu, tier, &scene, &Settings::exact())?;
    }
    metrics.note = "differing: pixels that the reference does not explain".into();
    Ok(metrics)
}

/// Class 26: the pixels that a certified kernel is sure of, beside the reference's. Pictures of so many pixels together go through the
/// kinds of scenes, both conventions in turn; those that `auto` would not begin with this kernel are left out. `None` where all are.
pub(super) fn certified(gpu: &Gpu, tier: Tier, count: usize, seed: u64) -> Result<Option<Metrics>, Error> {
    /// Kinds are in the order of what they are about: so many further on there is another.
    const STRIDE: usize = 37;
    const WIDTH: u32 = 96;
    const HEIGHT: u32 = 72;
    let options = Options { certified: true, ..Options::default() };
    let kinds = scene_kinds();
    let (mut metrics, mut doubtful, mut wrong) = (Metrics::default(), 0, 0);
    for number in 0..count.div_ceil((WIDTH * HEIGHT) as usize) {
        let kind = &kinds[number * STRIDE % kinds.len()];
        let mut scene = kind.scene(seed.wrapping_add((number / kinds.len()) as u64));
        (scene.width, scene.height) = (WIDTH, HEIGHT);
        let settings = [Settings::classic(), Settings::exact()][number % 2];
        let viewed = scene.viewed(&settings);
        let effects = Effects::of(&viewed);
        if Selection::of(&viewed, &effects, Request::Certified, &Tier::ALL).tier > tier {
            continue;
        }
        let (expected, _) = render_picture(&mut Engine::new(Backend::Reference, scene.viewed(&settings), &effects)?)?;
        let mut rgb = vec![0; expected.len()];
        let rendered = GpuRenderer::<Rows>::with(gpu, &viewed, &effects, tier, &options)?.rows(0, &mut rgb)?;
        let (own, right) = (rgb.as_chunks_mut::<3>().0, expected.as_chunks::<3>().0);
        doubtful += rendered.unsure.len() + rendered.cut.len();
        for [x, y] in rendered.unsure.into_iter().chain(rendered.cut) {
            let index = (y * WIDTH + x) as usize;
            own[index] = right[index];
        }
        metrics.count += right.len() as u64;
        metrics.not_finite += rendered.not_finite;
        wrong += own.iter().zip(right).filter(|(own, right)| own != right).count() as u64;
    }
    metrics.differing = Some(wrong);
    let share = 100.0 * doubtful as f64 / metrics.count as f64;
    metrics.note = format!("differing: pixels that the kernel is sure of, and wrong; in doubt: {share:.1} %");
    Ok((metrics.count > 0).then_some(metrics))
}

/// Two mirrors beside the view, a third ahead.
fn corridor(kr: f64, ka: f64, ambient: f64, light: f64) -> Result<Scene, Error> {
    scene(&format!(
        "SPHERE l -101 0 -5 100 100 100 1 1 1 {ka} 0.5 0.5 {kr} 20\nSPHERE r 101 0 -5 100 100 100 1 1 1 {ka} 0.5 0.5 {kr} 20\n\
         SPHERE m 0 0 -6 0.7 0.7 0.7 1 1 1 {ka} 0.5 0.5 {kr} 20\nLIGHT l 0 0.5 -1 {light} {light} {light}\nBACK 0 0 0\n\
         AMBIENT {ambient} {ambient} {ambient}\n"
    ))
}

/// Class 20: mirrors that lose nothing or amplify, lights beyond 1; no mirror gives more than its Kr.
pub(super) fn mirrors(gpu: &Gpu, tier: Tier) -> Result<Metrics, Error> {
    let mut metrics = Metrics::default();
    for (kr, light, depth) in [(1.0, 1.0, 40), (1.5, 1.0, 60), (1e3, 1e6, 100), (1.0, 1e30, 20)] {
        let settings = Settings { max_depth: depth, ..Settings::exact() };
        let (_, not_finite) = render(gpu, tier, &corridor(kr, 0.1, 0.2, light)?, &settings)?;
        metrics.count += u64::from(SIZE * SIZE);
        metrics.not_finite += not_finite;
    }
    let mut brighter = 0;
    for (kr, depth) in [(0.5_f64, 8_u32), (0.9, 8), (1.0, 6)] {
        let settings = Settings { max_depth: depth, ..Settings::exact() };
        let (rgb, not_finite) = render(gpu, tier, &corridor(kr, 0.1, 1.0, 0.0)?, &settings)?;
        let bound: f64 = (0..=depth).map(|bounce| 0.1 * kr.powf(f64::from(bounce))).sum();
        let level = (255.0 * bound.min(1.0) + 0.5).floor();
        brighter += rgb.iter().filter(|&&value| f64::from(value) > level).count() as u64;
        metrics.count += u64::from(SIZE * SIZE);
        metrics.not_finite += not_finite;
    }
    metrics.differing = Some(brighter);
    metrics.note = "differing: levels above the sum of Kr^k".into();
    Ok(metrics)
}
