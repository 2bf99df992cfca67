//! What each effect costs: the same picture with effects compiled in or left out, in turn.

use serde::Serialize;

use crate::effects::{Effect, EffectSet, Effects, Request};
use crate::engine::{Backend, Engine, render_bands};
use crate::gpu;
use crate::hash::{EMPTY, fnv1a};
use crate::report::Timings;
use crate::scene::Scene;
use crate::settings::Settings;

/// One way to compile the picture.
#[derive(Debug, Clone, Serialize)]
pub struct Variant {
    /// Its name: `auto`, `all`, or `auto` with one effect forced on or off.
    pub name: String,
    /// The effects compiled in.
    pub effects: EffectSet,
    /// From shader text to a kernel that has run once, in ms; the driver may have had it in its cache. 0 on the CPU.
    pub compile_ms: f64,
    /// Render times of all runs.
    pub render: Timings,
    /// Median render time over that of `auto`.
    pub ratio: f64,
    /// Whether the picture is that of `auto`, byte for byte.
    pub same_picture: bool,
}

/// What the effects of one scene cost on one device.
#[derive(Debug, Clone, Serialize)]
pub struct EffectCost {
    /// What the scene calls for.
    pub effects: Effects,
    /// All variants, `auto` first.
    pub variants: Vec<Variant>,
}

/// Renders `scene` `runs` times in each variant, the variants in turn, after one warm-up of each.
pub fn effect_cost(
    backend: Backend,
    scene: &Scene,
    settings: &Settings,
    runs: usize,
) -> Result<EffectCost, gpu::Error> {
    let auto = Effects::of(&scene.viewed(settings));
    let mut requests = vec![("auto".to_owned(), Request::Auto), ("all".to_owned(), Request::Exactly(EffectSet::ALL))];
    requests.extend(Effect::ALL.map(|effect| {
        let on = auto.set.has(effect);
        (format!("auto, {effect} {}", if on { "off" } else { "on" }), Request::Changed(vec![(effect, !on)]))
    }));

    let mut engines = Vec::new();
    let mut pictures = Vec::new();
    for (name, request) in requests {
        let viewed = scene.viewed(settings);
        let effects = Effects::requested(&viewed, &request);
        let mut engine = Engine::new(backend, viewed, &effects)?;
        pictures.push(picture_hash(&mut engine)?);
        let compile_ms = engine.times().compile_ms;
        let same_picture = pictures.last() == pictures.first();
        let variant =
            Variant { name, effects: effects.set, compile_ms, render: Timings::default(), ratio: 1.0, same_picture };
        engines.push((engine, variant));
    }
    for _ in 0..runs {
        for (engine, variant) in &mut engines {
            let before = engine.times().render_ms;
            render_bands(engine, |_| Ok::<_, gpu::Error>(()))?;
            variant.render.push(engine.times().render_ms - before);
        }
    }
    let mut variants: Vec<_> = engines.into_iter().map(|(_, variant)| variant).collect();
    let base = variants[0].render.median();
    for variant in &mut variants {
        variant.ratio = variant.render.median() / base;
    }
    Ok(EffectCost { effects: auto, variants })
}

/// A fingerprint of the picture, so that large ones need not be kept.
fn picture_hash(engine: &mut Engine) -> Result<u64, gpu::Error> {
    let mut hash = EMPTY;
    render_bands(engine, |band| {
        hash = fnv1a(hash, band.rgb.iter().copied());
        Ok::<_, gpu::Error>(())
    })?;
    Ok(hash)
}

impl EffectCost {
    /// A table for people.
    pub fn report(&self) -> String {
        use std::fmt::Write as _;
        let mut text = String::new();
        let heads = ["compiled in", "compile", "render median", "min … max", "ratio"];
        let [a, b, c, d, e] = heads;
        let _ = writeln!(text, "{a:<24} {b:>10} {c:>14} {d:>18} {e:>7}  picture");
        for variant in &self.variants {
            let Variant { name, compile_ms, render, ratio, same_picture, .. } = variant;
            let range = format!("{:.2} … {:.2}", render.min(), render.max());
            let picture = if *same_picture { "same" } else { "changed" };
            let caution = Some(render.caution()).filter(|it| !it.is_empty());
            let caution = caution.map_or_else(String::new, |it| format!("  ({it})"));
            let _ = writeln!(
                text,
                "{name:<24} {compile_ms:>7.1} ms {:>11.2} ms {range:>18} {ratio:>7.2}  {picture}{caution}",
                render.median()
            );
        }
        text
    }
}
