//! The measurements: every contestant at the chosen settings, over depths and over samples per pixel.

use glam::DVec3;
use serde::Serialize;

use super::contestant::{Contestant, Runner};
use super::distance::{Distance, linear_colors};
use super::effect_cost::{EffectCost, effect_cost};
use super::sampling::{PartialSeries, partial_series};
use crate::compare::Explanation;
use crate::cpu::Reference;
use crate::effects::{Effect, EffectSet, Effects};
use crate::engine::Backend;
use crate::film::Picture;
use crate::gpu::{DeviceInfo, Error, Gpu};
use crate::pattern::Pattern;
use crate::precision::Selection;
use crate::report::{Skipped, Timings};
use crate::scene::Scene;
use crate::settings::Settings;
use crate::viewed::ViewedScene;

/// However little time there is, so many runs are counted, if so many were asked for.
const LEAST_RUNS: usize = 3;

/// What to measure.
#[derive(Debug, Clone)]
pub struct StudyPlan {
    /// Counted runs of each point, after one warm-up.
    pub runs: usize,
    /// Time to spend on the counted runs of one series, in s; longer pictures get fewer runs.
    pub seconds: f64,
    /// Reflection depths to compare; empty: from 0 to the greatest that can matter.
    pub depths: Vec<u32>,
    /// Numbers of samples to compare, in ascending order.
    pub patterns: Vec<Pattern>,
}

impl StudyPlan {
    /// How many rounds of so many ms there is time for.
    pub(super) fn affordable(&self, round_ms: f64) -> usize {
        let affordable = (self.seconds * 1e3 / round_ms) as usize;
        affordable.max(LEAST_RUNS).min(self.runs)
    }
}

/// A scene and how to render it.
#[derive(Clone, Copy)]
pub struct StudyInput<'a> {
    /// Its name.
    pub name: &'a str,
    /// The scene.
    pub scene: &'a Scene,
    /// Conventions, depth and samples.
    pub settings: &'a Settings,
    /// What is simulated of it under other settings.
    pub effects: &'a dyn Fn(&ViewedScene) -> Effects,
    /// The device; `None` leaves the CPU.
    pub gpu: Option<&'a Gpu>,
    /// The tier that measures what effects cost.
    pub selection: &'a Selection,
}

/// All measurements of one scene.
#[derive(Debug, Clone, Serialize)]
pub struct Study {
    /// The scene's name.
    pub scene: String,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Number of spheres.
    pub spheres: usize,
    /// Number of lights.
    pub lights: usize,
    /// The device; `None` where only the CPU was measured.
    pub device: Option<DeviceInfo>,
    /// Threads of the CPU reference.
    pub cpu_threads: usize,
    /// Conventions, depth and samples.
    pub settings: Settings,
    /// What the scene calls for.
    pub effects: EffectSet,
    /// The tier that covers the scene, and why.
    pub selection: Selection,
    /// What was not measured.
    pub skipped: Vec<Skipped>,
    /// Every contestant at the settings.
    pub precision: Series,
    /// Over reflection depths.
    pub depth: Series,
    /// Over samples per pixel.
    pub samples: Series,
    /// With samples of a part of the pixels.
    pub partial: PartialSeries,
    /// What each effect costs.
    pub effect_cost: EffectCost,
}

/// Points that were measured in turn: each once, then each once more, and so on.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Series {
    /// Counted runs of each point.
    pub runs: usize,
    /// Depth and samples per pixel of the picture that stands for the truth, where it is another than the reference of the
    /// same depth and samples.
    pub truth: Option<Truth>,
    /// The points.
    pub points: Vec<Point>,
}

/// The picture that stands for the truth: the CPU reference in `f64` with more of what a series varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Truth {
    /// Its reflection depth.
    pub depth: u32,
    /// Its samples per pixel.
    pub samples: u32,
}

/// One contestant at one depth and number of samples.
#[derive(Debug, Clone, Serialize)]
pub struct Point {
    /// What rendered.
    pub contestant: Contestant,
    /// Greatest number of reflection bounces.
    pub depth: u32,
    /// Samples per pixel.
    pub samples: u32,
    /// Times by the wall clock, from the prepared scene to rows in memory.
    pub wall: Timings,
    /// Times of the dispatches by the device's own clock; `None` where there is none.
    pub on_device: Option<Timings>,
    /// Pixels that are not finite.
    pub not_finite: u64,
    /// Distance from the reference of the same depth and samples.
    pub error: Distance,
    /// Pixels that differ from it without a decision that explains it.
    pub unexplained: u64,
    /// Distance from the series' truth.
    pub from_truth: Option<Distance>,
}

/// The reference's picture before and after it is quantised.
struct Exact {
    reference: Reference<f64>,
    linear: Vec<DVec3>,
    picture: Picture,
}

impl Exact {
    fn new(input: &StudyInput, settings: &Settings) -> Self {
        let scene = input.scene;
        let viewed = scene.viewed(settings);
        let reference = Reference::new(&viewed, &(input.effects)(&viewed));
        let linear = linear_colors(&reference, (scene.width, scene.height));
        let rgb = linear.iter().flat_map(|color| settings.quantize.levels(*color)).collect();
        Self { reference, linear, picture: Picture::assemble(scene.width, scene.height, rgb) }
    }
}

/// What is heard of measurements while they are made.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// So much is done, 1 being all.
    Done(f64),
    /// What has been measured, and nothing yet where it has not.
    Measured(&'a Study),
}

/// Measures everything that `plan` asks for; `hear` hears of it.
pub fn study(input: &StudyInput, plan: &StudyPlan, mut hear: impl FnMut(Event)) -> Result<Study, Error> {
    /// The series, sampling in part, and what effects cost.
    const PARTS: f64 = 5.0;
    let StudyInput { scene, settings, gpu, selection, .. } = *input;
    let base = Settings { ..*settings };
    let viewed = scene.viewed(settings);
    let effects = (input.effects)(&viewed);
    let mut study = Study {
        scene: input.name.to_owned(),
        width: scene.width,
        height: scene.height,
        spheres: scene.spheres.len(),
        lights: scene.lights.len(),
        device: gpu.map(|gpu| gpu.device.info.clone()),
        cpu_threads: rayon::current_num_threads(),
        settings: *settings,
        effects: effects.set,
        selection: selection.clone(),
        skipped: Vec::new(),
        precision: Series::default(),
        depth: Series::default(),
        samples: Series::default(),
        partial: PartialSeries::none((scene.width, scene.height)),
        effect_cost: EffectCost { effects: Effects::of(&viewed), variants: Vec::new() },
    };
    drop(viewed);
    let mut contestants = Contestant::ALL.to_vec();
    contestants.retain(|contestant| match contestant.obstacle(gpu) {
        None => true,
        Some(reason) => {
            study.skipped.push(Skipped { name: contestant.name().into(), reason });
            false
        }
    });
    study.precision = series(input, plan, &mut contestants, &mut study.skipped, &[base], None, |within| {
        hear(Event::Done(within / PARTS));
    })?;
    hear(Event::Measured(&study));

    contestants.retain(|contestant| matches!(contestant, Contestant::Device(_) | Contestant::CpuDouble));
    let depths = if plan.depths.is_empty() { (0..=effects.depth).collect() } else { plan.depths.clone() };
    let at_depth = |max_depth| Settings { max_depth, ..base };
    let deeper = at_depth((depths.iter().max().copied().unwrap_or(0) * 2).clamp(8, Settings::MAX_DEPTH));
    let variants: Vec<_> = depths.iter().map(|&depth| at_depth(depth)).collect();
    study.depth = series(input, plan, &mut contestants, &mut study.skipped, &variants, Some(deeper), |within| {
        hear(Event::Done((1.0 + within) / PARTS));
    })?;
    hear(Event::Measured(&study));

    let with_pattern = |pattern| Settings { pattern, ..base };
    let finer = with_pattern(plan.patterns.last().copied().unwrap_or(Pattern::ONE).finer());
    let variants: Vec<_> = plan.patterns.iter().copied().map(with_pattern).collect();
    study.samples = series(input, plan, &mut contestants, &mut study.skipped, &variants, Some(finer), |within| {
        hear(Event::Done((2.0 + within) / PARTS));
    })?;
    hear(Event::Measured(&study));

    study.partial = partial_series(input, plan)?;
    hear(Event::Measured(&study));
    hear(Event::Done(4.0 / PARTS));

    // Its variants take about as long as what the same tier took.
    let main = gpu.map_or(Contestant::CpuDouble, |_| Contestant::Device(selection.tier));
    let one_ms =
        study.precision.points.iter().find(|point| point.contestant == main).map_or(0.0, |point| point.wall.median());
    let variants_ms = one_ms * (Effect::ALL.len() + 2) as f64;
    let backend = Backend::of(gpu, selection);
    study.effect_cost = effect_cost(backend, scene, settings, plan.affordable(variants_ms))?;
    hear(Event::Measured(&study));
    Ok(study)
}

/// Measures `contestants` under each of `variants`; one that the device refuses is skipped from then on.
fn series(
    input: &StudyInput,
    plan: &StudyPlan,
    contestants: &mut Vec<Contestant>,
    skipped: &mut Vec<Skipped>,
    variants: &[Settings],
    truth: Option<Settings>,
    mut done: impl FnMut(f64),
) -> Result<Series, Error> {
    let truth = truth.map(|settings| (settings, Exact::new(input, &settings)));
    let mut measured = Vec::new();
    let mut round_ms = 0.0;
    for (index, settings) in variants.iter().enumerate() {
        // The first half is to prepare, and to compare pictures.
        done(0.5 * index as f64 / variants.len() as f64);
        let exact = Exact::new(input, settings);
        for contestant in contestants.clone() {
            match warm_up(input, contestant, settings, &exact, truth.as_ref().map(|(_, truth)| truth)) {
                Ok((runner, point, ms)) => {
                    measured.push((runner, point));
                    round_ms += ms;
                }
                Err(refusal) if refusal.is_refusal() => {
                    contestants.retain(|other| *other != contestant);
                    skipped.push(Skipped { name: contestant.name().into(), reason: refusal.to_string() });
                }
                Err(error) => return Err(error),
            }
        }
    }
    let runs = plan.affordable(round_ms);
    for round in 0..runs {
        done(0.5 + 0.5 * round as f64 / runs as f64);
        for (runner, point) in &mut measured {
            let run = runner.run()?;
            point.wall.push(run.wall_ms);
            if let (Some(sample), Some(ms)) = (&mut point.on_device, run.device_ms) {
                sample.push(ms);
            }
        }
    }
    Ok(Series {
        runs,
        truth: truth.map(|(settings, _)| Truth { depth: settings.max_depth, samples: settings.pattern.count() }),
        points: measured.into_iter().map(|(_, point)| point).collect(),
    })
}

/// Renders once and compares; returns the renderer, the point without times, and the time of the next run, about, in ms.
fn warm_up<'a>(
    input: &StudyInput<'a>,
    contestant: Contestant,
    settings: &Settings,
    exact: &Exact,
    truth: Option<&Exact>,
) -> Result<(Runner<'a>, Point, f64), Error> {
    let StudyInput { scene, gpu, .. } = *input;
    let viewed = scene.viewed(settings);
    let effects = (input.effects)(&viewed);
    let mut runner = Runner::new(contestant, gpu, viewed, &effects)?;
    let run = runner.run()?;
    let linear = match contestant {
        Contestant::Device(_) | Contestant::Certified => None,
        Contestant::CpuSingle => {
            let reference = Reference::<f32>::new(&scene.viewed(settings), &effects);
            Some(linear_colors(&reference, (scene.width, scene.height)))
        }
        Contestant::CpuDouble => Some(exact.linear.clone()),
    };
    let distance = |from: &Exact| {
        let distance = Distance::between(&runner.rgb, from.picture.rgb());
        linear.as_ref().map_or(distance, |linear| distance.with_linear(linear, &from.linear))
    };
    let (error, from_truth) = (distance(exact), truth.map(distance));
    let picture = Picture::assemble(scene.width, scene.height, runner.rgb.clone());
    let explanation = Explanation::of(&picture, &exact.picture, &exact.reference, &contestant.judge(gpu));
    let point = Point {
        contestant,
        depth: settings.max_depth,
        samples: settings.pattern.count(),
        wall: Timings::default(),
        on_device: run.device_ms.map(|_| Timings::default()),
        not_finite: run.not_finite,
        error,
        unexplained: explanation.unexplained,
        from_truth,
    };
    Ok((runner, point, run.wall_ms))
}
