//! Which tuning suits a device: the candidates of each number, measured in turn on built-in scenes.

use std::fmt::Write as _;

use serde::Serialize;

use super::families::Family;
use crate::effects::Effects;
use crate::engine::{Backend, Engine, render_picture};
use crate::gpu::{DeviceInfo, Error, Gpu};
use crate::precision::Tier;
use crate::report::Timings;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::tuning::{KNOBS, Knob, Tuning};
use crate::viewed::ViewedScene;

/// A candidate has to be this much faster than what it replaces.
const WORTHWHILE: f64 = 0.97;

/// The scenes on which a number makes a difference, by family and size.
fn cases(knob: &Knob) -> &'static [(&'static str, usize)] {
    match knob.name {
        "light_entries" => &[("spheres", 100), ("spheres", 10_000)],
        "longest_tile" | "light_entries_of_many" => &[("spheres", 100_000)],
        "grid_cells" => &[("mirrors", 100), ("mirrors", 10_000)],
        "grid_cells_of_many" => &[("mirrors", 100_000)],
        "in_place_below" => &[("spheres", 10), ("mirrors", 100), ("mirrors", 1000), ("mirrors", 10_000)],
        "in_turn_from" => &[("mirrors", 1000), ("mirrors", 10_000), ("mirrors", 100_000)],
        "paths" | "path_mib" => &[("mirrors", 10_000), ("mirrors", 100_000)],
        "dispatch_ms" => &[("spheres", 1000), ("mirrors", 10_000)],
        _ => &[("classic", 5), ("spheres", 100), ("mirrors", 1000)],
    }
}

/// What to measure.
pub struct TunePlan<'a> {
    /// Scenes with more spheres are left out.
    pub max_spheres: usize,
    /// Counted runs of each scene with each candidate, after a warm-up.
    pub runs: usize,
    /// Conventions, depth and samples.
    pub settings: &'a Settings,
    /// Width and height in place of each scene's own.
    pub resolution: Option<(u32, u32)>,
    /// What is simulated, and the tier, for a scene.
    pub choice: &'a dyn Fn(&Gpu, &ViewedScene) -> (Effects, Tier),
}

/// One value of a number.
#[derive(Debug, Clone, Serialize)]
pub struct Trial {
    /// The value.
    pub value: f64,
    /// Times of a whole picture of each scene, in ms, compilation not counted.
    pub times: Vec<Timings>,
    /// Its medians over those of the value that was there before, the geometric mean of all scenes.
    pub ratio: f64,
}

/// All values of one number.
#[derive(Debug, Clone, Serialize)]
pub struct KnobResult {
    /// The number's name.
    pub name: &'static str,
    /// The scenes.
    pub scenes: Vec<String>,
    /// The value before.
    pub before: f64,
    /// The value that is kept.
    pub kept: f64,
    /// What was measured; empty where every scene was left out.
    pub trials: Vec<Trial>,
}

/// What was found.
#[derive(Debug, Clone, Serialize)]
pub struct TuneResult {
    /// The device.
    pub device: DeviceInfo,
    /// Number by number.
    pub knobs: Vec<KnobResult>,
    /// What the device's class begins with.
    pub before: Tuning,
    /// The best that was found.
    pub after: Tuning,
}

/// A scene ready to be rendered again and again, and its picture.
struct Workload {
    scene: Scene,
    effects: Effects,
    tier: Tier,
    picture: Option<Vec<u8>>,
}

/// Measures one number after the other, each with the best values found before; `on_knob` hears of each.
pub fn tune(gpu: &mut Gpu, plan: &TunePlan, mut on_knob: impl FnMut(&KnobResult)) -> Result<TuneResult, Error> {
    let before = Tuning::of(gpu.device.info.kind.class());
    let mut best = before;
    let mut knobs = Vec::new();
    for knob in &KNOBS {
        let result = tune_knob(gpu, plan, knob, &best)?;
        (knob.set)(&mut best, result.kept);
        on_knob(&result);
        knobs.push(result);
    }
    gpu.set_tuning(best)?;
    Ok(TuneResult { device: gpu.device.info.clone(), knobs, before, after: best })
}

fn tune_knob(gpu: &mut Gpu, plan: &TunePlan, knob: &Knob, best: &Tuning) -> Result<KnobResult, Error> {
    let before = (knob.get)(best);
    let chosen = cases(knob).iter().filter_map(|&(name, size)| {
        let family = Family::named(name).filter(|family| family.spheres(size) <= plan.max_spheres)?;
        Some((format!("{name} {size}"), family.scene(size)))
    });
    let (scenes, mut workloads): (Vec<_>, Vec<_>) = chosen
        .map(|(name, mut scene)| {
            if let Some((width, height)) = plan.resolution {
                (scene.width, scene.height) = (width, height);
            }
            let (effects, tier) = (plan.choice)(gpu, &scene.viewed(plan.settings));
            (name, Workload { scene, effects, tier, picture: None })
        })
        .unzip();
    let mut result = KnobResult { name: knob.name, scenes, before, kept: before, trials: Vec::new() };
    if workloads.is_empty() {
        return Ok(result);
    }
    let mut values: Vec<f64> = knob.candidates.iter().copied().filter(|value| fits(gpu, knob, *value)).collect();
    if !values.contains(&before) {
        values.push(before);
    }
    let mut trials: Vec<_> = values
        .into_iter()
        .map(|value| Trial { value, times: vec![Timings::default(); workloads.len()], ratio: f64::NAN })
        .collect();
    for (index, workload) in workloads.iter_mut().enumerate() {
        for run in 0..=plan.runs {
            for place in 0..trials.len() {
                // There and back, so that no candidate always follows the same one.
                let trial = if run % 2 == 0 { place } else { trials.len() - 1 - place };
                let trial = &mut trials[trial];
                let mut tuning = *best;
                (knob.set)(&mut tuning, trial.value);
                gpu.set_tuning(tuning)?;
                let ms = workload.render(gpu, plan.settings, &tuning)?;
                // The first is a warm-up.
                if run > 0 {
                    trial.times[index].push(ms);
                }
            }
        }
    }
    let medians = |trial: &Trial| trial.times.iter().map(|times| times.median().ln()).sum::<f64>();
    let reference = trials.iter().find(|trial| trial.value == before).map_or(f64::NAN, medians);
    for trial in &mut trials {
        trial.ratio = ((medians(trial) - reference) / workloads.len() as f64).exp();
    }
    let reference = trials.iter().find(|trial| trial.value == before);
    let faster = trials.iter().filter(|trial| reference.is_some_and(|reference| trial.is_faster(reference)));
    if let Some(fastest) = faster.min_by(|a, b| a.ratio.total_cmp(&b.ratio)) {
        result.kept = fastest.value;
    }
    result.trials = trials;
    Ok(result)
}

/// Whether the device can do with such a value.
fn fits(gpu: &Gpu, knob: &Knob, value: f64) -> bool {
    let mut tuning = gpu.tuned().tuning;
    (knob.set)(&mut tuning, value);
    gpu.device.info.problem_with(&tuning).is_none()
}

impl Workload {
    /// Renders once and returns the time, in ms. Another picture than before is an error: no tuning may change one.
    fn render(&mut self, gpu: &Gpu, settings: &Settings, tuning: &Tuning) -> Result<f64, Error> {
        let mut engine = Engine::new(Backend::Device(gpu, self.tier), self.scene.viewed(settings), &self.effects)?;
        let (rgb, _) = render_picture(&mut engine)?;
        let times = engine.times();
        match &self.picture {
            None => self.picture = Some(rgb),
            Some(picture) if *picture == rgb => {}
            Some(_) => {
                let device = &gpu.device.info;
                let tuning = tuning.difference(&Tuning::of(device.kind.class()));
                return Err(Error::OtherPicture { device: device.to_string(), tuning });
            }
        }
        Ok(times.prepare_ms + times.render_ms + times.read_back_ms)
    }
}

impl Trial {
    /// Whether this is faster in its medians, in its least times, and in four of five runs: on a busy machine any one of
    /// these says little.
    fn is_faster(&self, other: &Self) -> bool {
        let sum = |trial: &Self, time: &dyn Fn(&Timings) -> f64| trial.times.iter().map(|t| time(t).ln()).sum::<f64>();
        let runs = self.times.iter().map(|times| times.runs().len()).min().unwrap_or(0);
        let wins = |run: &usize| sum(self, &|times| times.runs()[*run]) < sum(other, &|times| times.runs()[*run]);
        let least = (sum(self, &Timings::min) - sum(other, &Timings::min)) / self.times.len() as f64;
        self.ratio < WORTHWHILE && least.exp() < WORTHWHILE && 5 * (0..runs).filter(wins).count() >= 4 * runs
    }
}

impl KnobResult {
    /// A line for each value.
    pub fn report(&self) -> String {
        let mut text = format!("{}, on {}\n", self.name, self.scenes.join(", "));
        if self.trials.is_empty() {
            return format!("{}: no scene is small enough, {} stays\n", self.name, self.before);
        }
        for trial in &self.trials {
            let medians: Vec<_> = trial.times.iter().map(|times| format!("{:>10.2} ms", times.median())).collect();
            let mark = match trial.value {
                value if value == self.kept => " <- kept",
                value if value == self.before => " (before)",
                _ => "",
            };
            let _ = writeln!(text, "  {:>12}{}{:>8.3} ×{mark}", trial.value, medians.concat(), trial.ratio);
        }
        text
    }
}
