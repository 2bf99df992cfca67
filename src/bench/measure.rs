//! The measurements: every scene of the chosen families, rendered by the device and by the CPU reference in turn.

use std::time::Instant;

use serde::Serialize;

use super::families::{Axis, Family};
use super::fit::growth_exponent;
use super::phases::{PHASES, Phase};
use crate::effects::Effects;
use crate::engine::{Backend, Engine, Options, Rays};
use crate::gpu::{self, DeviceInfo, Gpu};
use crate::precision::Selection;
use crate::report::number::time;
use crate::report::{Skipped, Timings};
use crate::scene::Scene;
use crate::settings::Settings;
use crate::viewed::ViewedScene;
use crate::words::count;

/// By how much a forecast has to exceed the budget before a scene is not even tried.
const DOUBT: f64 = 2.0;

/// What to measure.
#[derive(Debug, Clone)]
pub struct BenchPlan {
    /// The families.
    pub families: Vec<&'static Family>,
    /// Scenes with more spheres are left out.
    pub max_spheres: usize,
    /// Counted runs of each scene and renderer, after a warm-up.
    pub runs: usize,
    /// Time for all counted runs of one scene on one renderer, in s; what would take longer is skipped, and said to be.
    pub seconds: f64,
    /// Whether the CPU reference takes part.
    pub cpu: bool,
}

impl BenchPlan {
    /// Sizes of a family's scenes.
    pub(crate) fn sizes(&self, family: &Family) -> impl Iterator<Item = usize> {
        family.sizes.iter().copied().filter(|&size| family.spheres(size) <= self.max_spheres)
    }
}

/// What renders, and how.
#[derive(Clone, Copy)]
pub struct RenderSetup<'a> {
    /// The device; `None` leaves the CPU reference.
    pub gpu: Option<&'a Gpu>,
    /// Conventions, depth and samples.
    pub settings: &'a Settings,
    /// Width and height in place of each scene's own.
    pub resolution: Option<(u32, u32)>,
    /// What is simulated.
    pub effects: &'a dyn Fn(&ViewedScene) -> Effects,
    /// The tier for a scene.
    pub selection: &'a dyn Fn(&ViewedScene, &Effects) -> Selection,
}

/// Who renders a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Renderer {
    /// The Vulkan device.
    #[serde(rename = "device")]
    Device,
    /// The CPU reference.
    #[serde(rename = "CPU")]
    Cpu,
}

impl Renderer {
    /// The name in tables and plots.
    pub fn name(self) -> &'static str {
        match self {
            Self::Device => "device",
            Self::Cpu => "CPU",
        }
    }
}

/// All measurements.
#[derive(Debug, Clone, Serialize)]
pub struct Bench {
    /// The device; `None` where only the CPU was measured.
    pub device: Option<DeviceInfo>,
    /// Threads of the CPU reference.
    pub cpu_threads: usize,
    /// Conventions, depth and samples.
    pub settings: Settings,
    /// Counted runs of each scene and renderer.
    pub runs: usize,
    /// Time budget of one scene on one renderer, in s.
    pub seconds: f64,
    /// One result for each family.
    pub families: Vec<FamilyResult>,
}

/// The measurements of one family.
#[derive(Debug, Clone, Serialize)]
pub struct FamilyResult {
    /// Its name.
    pub name: &'static str,
    /// What is in its scenes.
    pub summary: &'static str,
    /// What the sizes count.
    pub axis: Axis,
    /// Its scenes by size.
    pub scenes: Vec<SceneResult>,
    /// How the time of a picture grows with the size.
    pub growth: Vec<Growth>,
}

/// How the time of a picture grows with the size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Growth {
    /// Whose time.
    pub renderer: Renderer,
    /// The exponent e of time ∝ sizeᵉ over all measured sizes.
    pub exponent: f64,
    /// Least and greatest measured size.
    pub sizes: (usize, usize),
}

/// The measurements of one scene.
#[derive(Debug, Clone, Serialize)]
pub struct SceneResult {
    /// Its size within the family.
    pub size: usize,
    /// Number of spheres.
    pub spheres: usize,
    /// Number of lights.
    pub lights: usize,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The device's tier, or that its picture is certified; `None` without a device.
    pub tier: Option<String>,
    /// Who was measured.
    pub measured: Vec<Measured>,
    /// Who was not, and why.
    pub skipped: Vec<Skipped>,
    /// Pixels in which the pictures differ, where both were rendered.
    pub differing: Option<u64>,
}

/// The times of one scene on one renderer.
#[derive(Debug, Clone, Serialize)]
pub struct Measured {
    /// Who rendered.
    pub renderer: Renderer,
    /// From the scene to rows of pixels in memory by the wall clock, in ms, without compiling: what each further picture of
    /// the kind takes.
    pub picture: Timings,
    /// Where the time went, in ms.
    pub phases: Vec<Phase>,
    /// The rays of one picture.
    pub rays: Rays,
    /// All rays over the median of the phase `render`.
    pub rays_per_second: f64,
}

/// Measures everything that `plan` asks for; `scene_done` hears of every scene, and of all that was measured so far.
pub fn bench(
    setup: &RenderSetup,
    plan: &BenchPlan,
    mut scene_done: impl FnMut(&Bench, &Family, &SceneResult),
) -> Result<Bench, gpu::Error> {
    let mut bench = Bench {
        device: setup.gpu.map(|gpu| gpu.device.info.clone()),
        cpu_threads: rayon::current_num_threads(),
        settings: *setup.settings,
        runs: plan.runs,
        seconds: plan.seconds,
        families: Vec::new(),
    };
    for family in &plan.families {
        let mut forecasts: Vec<_> = renderers(setup, plan).into_iter().map(Forecast::new).collect();
        let Family { name, summary, axis, .. } = **family;
        let mut result = FamilyResult { name, summary, axis, scenes: Vec::new(), growth: Vec::new() };
        for size in plan.sizes(family) {
            let scene = measure_scene(setup, plan, family, size, &mut forecasts)?;
            result.scenes.push(scene.clone());
            result.growth = forecasts.iter().filter_map(|forecast| growth(forecast.renderer, &result.scenes)).collect();
            bench.families.retain(|other| other.name != name);
            bench.families.push(result.clone());
            scene_done(&bench, family, &scene);
        }
        if result.scenes.is_empty() {
            bench.families.push(result);
        }
    }
    Ok(bench)
}

fn renderers(setup: &RenderSetup, plan: &BenchPlan) -> Vec<Renderer> {
    let mut renderers = Vec::new();
    renderers.extend(setup.gpu.map(|_| Renderer::Device));
    if plan.cpu || renderers.is_empty() {
        renderers.push(Renderer::Cpu);
    }
    renderers
}

fn growth(renderer: Renderer, scenes: &[SceneResult]) -> Option<Growth> {
    let times = |scene: &SceneResult| {
        let own = scene.measured.iter().find(|measured| measured.renderer == renderer)?;
        Some((scene.size, own.picture.median()))
    };
    let points: Vec<_> = scenes.iter().filter_map(times).collect();
    let exponent = growth_exponent(&points.iter().map(|&(size, ms)| (size as f64, ms)).collect::<Vec<_>>())?;
    Some(Growth { renderer, exponent, sizes: (points.first()?.0, points.last()?.0) })
}

/// What the next scene of a family will take, by those before it.
struct Forecast {
    renderer: Renderer,
    points: Vec<(f64, f64)>,
}

impl Forecast {
    fn new(renderer: Renderer) -> Self {
        Self { renderer, points: Vec::new() }
    }

    /// Time of one picture of this size, in ms: grows on as between the last two sizes, or with the size after only one.
    fn of(&self, size: usize) -> Option<f64> {
        let &(last, ms) = self.points.last()?;
        let exponent = growth_exponent(&self.points[self.points.len().saturating_sub(2)..]).unwrap_or(1.0);
        Some(ms * (size as f64 / last).powf(exponent.max(0.0)))
    }
}

/// One renderer with a scene.
struct Contestant<'a> {
    backend: Backend<'a>,
    measured: Measured,
    /// The last picture, 3 bytes a pixel.
    rgb: Vec<u8>,
}

impl Contestant<'_> {
    /// Renders the picture from the scene on; returns its time in ms without compiling, and the engine with the phases.
    fn run(&mut self, scene: &Scene, setup: &RenderSetup, effects: &Effects, count: bool) -> Result<f64, gpu::Error> {
        let start = Instant::now();
        let options = Options { count_rays: count, ..Options::default() };
        let mut engine: Engine = Engine::with(self.backend, scene.viewed(setup.settings), effects, &options)?;
        engine.rows(0, &mut self.rgb)?;
        let wall_ms = start.elapsed().as_secs_f64() * 1e3;
        let times = engine.times();
        if let Some(rays) = engine.rays() {
            self.measured.rays = rays;
        }
        if !count {
            for (phase, (_, read)) in self.measured.phases.iter_mut().zip(PHASES) {
                phase.times.push(read(&times));
            }
            self.measured.picture.push(wall_ms - times.compile_ms);
        }
        Ok(wall_ms - times.compile_ms)
    }

    /// Forgets the warm-up.
    fn reset(&mut self) {
        self.measured.picture = Timings::default();
        self.measured.phases = Phase::all();
    }
}

fn measure_scene(
    setup: &RenderSetup,
    plan: &BenchPlan,
    family: &Family,
    size: usize,
    forecasts: &mut [Forecast],
) -> Result<SceneResult, gpu::Error> {
    let mut scene = family.scene(size);
    if let Some((width, height)) = setup.resolution {
        (scene.width, scene.height) = (width, height);
    }
    let viewed = scene.viewed(setup.settings);
    let effects = (setup.effects)(&viewed);
    let selection = (setup.selection)(&viewed, &effects);
    drop(viewed);
    let mut skipped = Vec::new();
    let mut contestants = Vec::new();
    for forecast in forecasts {
        let mut skip = |reason| skipped.push(Skipped { name: forecast.renderer.name().into(), reason });
        let (budget, runs) = (plan.seconds, plan.runs);
        let all_runs = |ms: f64| ms * runs as f64 / 1e3;
        if let Some(ms) = forecast.of(size).filter(|ms| all_runs(*ms) > DOUBT * budget) {
            skip(format!(
                "{} would take about {}, the budget is {budget} s",
                count(runs as u64, "run"),
                time(ms * runs as f64)
            ));
            continue;
        }
        let backend = match (forecast.renderer, setup.gpu) {
            (Renderer::Device, Some(gpu)) => Backend::of(Some(gpu), &selection),
            _ => Backend::Reference,
        };
        let measured = Measured {
            renderer: forecast.renderer,
            picture: Timings::default(),
            phases: Phase::all(),
            rays: Rays::default(),
            rays_per_second: 0.0,
        };
        let rgb = vec![0; scene.width as usize * scene.height as usize * 3];
        let mut contestant = Contestant { backend, measured, rgb };
        // Rays are counted in a run of its own where that takes another kernel; then the kernel that is timed is compiled.
        let counted = match forecast.renderer {
            Renderer::Device => contestant.run(&scene, setup, &effects, true).map(|_| ()),
            Renderer::Cpu => Ok(()),
        };
        let warm_up = counted.and_then(|()| contestant.run(&scene, setup, &effects, false));
        let ms = match warm_up {
            Ok(ms) => ms,
            Err(refusal) if refusal.is_refusal() => {
                skip(refusal.to_string());
                continue;
            }
            Err(error) => return Err(error),
        };
        forecast.points.push((size as f64, ms));
        if all_runs(ms) > budget {
            skip(format!(
                "one picture took {}, so {} would exceed the budget of {budget} s",
                time(ms),
                count(runs as u64, "run")
            ));
            continue;
        }
        contestant.reset();
        contestants.push(contestant);
    }
    for _ in 0..plan.runs {
        for contestant in &mut contestants {
            contestant.run(&scene, setup, &effects, false)?;
        }
    }
    let differing = match &contestants[..] {
        [a, b] => Some(a.rgb.chunks_exact(3).zip(b.rgb.chunks_exact(3)).filter(|(a, b)| a != b).count() as u64),
        _ => None,
    };
    let measured = contestants.into_iter().map(|contestant| finished(contestant.measured)).collect();
    Ok(SceneResult {
        size,
        spheres: scene.spheres.len(),
        lights: scene.lights.len(),
        width: scene.width,
        height: scene.height,
        tier: setup.gpu.map(|_| selection.to_string()),
        measured,
        skipped,
        differing,
    })
}

fn finished(mut measured: Measured) -> Measured {
    let Rays { primary, shadow, reflection } = measured.rays;
    let render_ms = measured.phases.iter().find(|phase| phase.name == "render").map_or(f64::NAN, |s| s.times.median());
    measured.rays_per_second = (primary + shadow + reflection) as f64 / (render_ms / 1e3);
    measured
}
