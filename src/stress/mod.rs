//! Hard cases: what each tier promises, checked on the user's device through the code that renders.

mod classes;
mod cost;
mod families;
mod metrics;
mod path;
mod pictures;
mod rays;
mod report;
mod special;
mod truth;

use std::time::Instant;

use serde::Serialize;

pub use crate::random::Random;
pub use classes::{Class, classes};
pub use cost::{Cost, cost};
pub use families::{SceneKind, scene_kinds};
pub use metrics::{Limit, Metrics, Quantity, Target, Verdict};
pub use path::passage;
pub use report::table;
pub use truth::carried;

use crate::gpu::{Error, Gpu, Kernel, Prober, Question};
use crate::precision::Tier;
use crate::settings::Specular;
use classes::{Case, Kind};
use metrics::U;
use path::{End, Turn};
use truth::{Given, blocked, expected, judge, lighting, worse};

/// One case on one kernel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The class's number.
    pub id: u32,
    /// The class's name.
    pub class: &'static str,
    /// The case within the class.
    pub case: &'static str,
    /// The kernel.
    pub kernel: &'static str,
    /// Counts and errors.
    #[serde(flatten)]
    pub metrics: Metrics,
    /// What is promised.
    pub target: Target,
    /// Whether it holds.
    pub verdict: Verdict,
    /// Wall-clock time of the case on this kernel, in ms, truth included where it is this kernel's alone.
    pub ms: f64,
}

impl Row {
    /// Whether a promise is broken.
    pub fn is_broken(&self) -> bool {
        matches!(self.verdict, Verdict::Fail(_))
    }
}

/// Which of the promises of [`Case::targets`] judges `kernel`: what goes wrong without a tier's care is judged as that tier.
fn judged_as(kernel: Kernel) -> usize {
    match kernel {
        Kernel::Tier(Tier::Fast) | Kernel::Schoolbook => 0,
        Kernel::Tier(Tier::Robust) | Kernel::NoBarrier => 1,
        Kernel::Tier(Tier::Double) => 2,
        Kernel::Pairs => 3,
    }
}

/// The |1 − l²| below which a kernel may take a miss for a hit and the reverse.
fn band(kernel: Kernel) -> f64 {
    [4e-7, 2.5e-7, 1e-9, 1e-9][judged_as(kernel)]
}

/// Runs `classes` with `count` rays each on every kernel; `row_done` sees each row as it comes.
pub fn run(
    gpu: &Gpu,
    kernels: &[Kernel],
    classes: &[Class],
    count: usize,
    seed: u64,
    mut row_done: impl FnMut(&Row),
) -> Result<Vec<Row>, Error> {
    let mut probers = Vec::new();
    for &kernel in kernels {
        let prober = match Prober::new(gpu, kernel) {
            Ok(prober) => Ok(prober),
            Err(refusal @ Error::ArithmeticRefused { .. }) => Err(refusal.to_string()),
            Err(error) => return Err(error),
        };
        probers.push((kernel, prober));
    }
    let mut rows = Vec::new();
    for class in classes {
        for (number, case) in class.cases.iter().enumerate() {
            let stream = u64::from(class.id) << 8 | number as u64;
            let mut shared = Shared::new(case, Random::new(seed, stream), count);
            for (kernel, prober) in &mut probers {
                let start = Instant::now();
                // Without f64 another kernel stands in for `double`.
                let judged = prober.as_ref().map_or(*kernel, Prober::kernel);
                let target = case.targets[judged_as(judged)].clone();
                if target == Target::NotApplicable {
                    continue;
                }
                let (metrics, verdict) = match prober {
                    Err(why) => (Metrics::default(), Verdict::Refused(why.clone())),
                    Ok(prober) => {
                        let Some(metrics) = shared.measure(case, prober)? else { continue };
                        let verdict = Verdict::of(&metrics, &target);
                        (metrics, verdict)
                    }
                };
                let row = Row {
                    id: class.id,
                    class: class.name,
                    case: case.label,
                    kernel: kernel.name(),
                    metrics,
                    target,
                    verdict,
                    ms: start.elapsed().as_secs_f64() * 1e3,
                };
                row_done(&row);
                rows.push(row);
            }
        }
    }
    Ok(rows)
}

/// What the kernels of one case share: the rays, and the truth of each kind of input.
struct Shared {
    random: Random,
    count: usize,
    batch: crate::gpu::Batch,
    lit: Vec<bool>,
    truths: [Option<Vec<End>>; 2],
}

impl Shared {
    fn new(case: &Case, mut random: Random, count: usize) -> Self {
        let (batch, lit) = match case.kind {
            Kind::Rays(generate) | Kind::Mirrored(generate) | Kind::Refracted(generate) | Kind::Blocked(generate) => {
                (generate(&mut random, count), Vec::new())
            }
            Kind::Lit(generate) | Kind::Highlight(generate, _) => generate(&mut random, count),
            _ => Default::default(),
        };
        Self { random, count, batch: batch.in_range(), lit, truths: [None, None] }
    }

    /// `None` where the case does not concern the kernel.
    fn measure(&mut self, case: &Case, prober: &mut Prober) -> Result<Option<Metrics>, Error> {
        let kernel = prober.kernel();
        let given = if kernel.carries_low() || kernel.is_double() { Given::Whole } else { Given::Rounded };
        // Every kernel sees the same numbers.
        let mut random = self.random.clone();
        // Pictures and scenes are for tiers only.
        let picture = |make: fn(&Gpu, Tier) -> Result<Metrics, Error>| match kernel {
            Kernel::Tier(tier) => make(prober.gpu(), tier).map(Some),
            // On a device without f64 this is what `double` renders with; elsewhere no picture is.
            Kernel::Pairs if !prober.gpu().device.info.f64 => make(prober.gpu(), Tier::Double).map(Some),
            Kernel::Pairs | Kernel::Schoolbook | Kernel::NoBarrier => Ok(None),
        };
        match case.kind {
            Kind::Rays(_) => self.measure_path(prober, given, Question::Point, None).map(Some),
            Kind::Mirrored(_) => self.measure_path(prober, given, Question::Bounce, Some(Turn::Mirrored)).map(Some),
            Kind::Refracted(_) => {
                let turn = Turn::Refracted(self.batch.eta);
                self.measure_path(prober, given, Question::Refract, Some(turn)).map(Some)
            }
            Kind::Blocked(_) => self.measure_blocked(prober, given).map(Some),
            Kind::Lit(_) => self.measure_light(prober, given).map(Some),
            Kind::Highlight(_, model) => self.measure_highlight(prober, given, model).map(Some),
            Kind::ZeroScale => picture(|_, _| Ok(special::zero_scale())),
            Kind::NegativeScale => special::negative_scale(prober, &mut random, self.count).map(Some),
            Kind::BitPatterns => special::bit_patterns(prober, &mut random, 2 * self.count).map(Some),
            Kind::Power => special::power(prober, &mut random, self.count).map(Some),
            Kind::OddLights => picture(pictures::odd_lights),
            Kind::Mirrors => picture(pictures::mirrors),
            Kind::Certified => match kernel {
                Kernel::Tier(tier) => pictures::certified(prober.gpu(), tier, self.count, random.bits()),
                Kernel::Pairs | Kernel::Schoolbook | Kernel::NoBarrier => Ok(None),
            },
            Kind::FacingMirrors => special::facing_mirrors(prober, &mut random, self.count).map(Some),
            Kind::Transforms if kernel.carries_low() => special::transforms(prober, &mut random).map(Some),
            Kind::Transforms => Ok(None),
        }
    }

    /// The hit at the end of a path, and its point.
    fn measure_path(
        &mut self,
        prober: &mut Prober,
        given: Given,
        question: Question,
        turn: Option<Turn>,
    ) -> Result<Metrics, Error> {
        let answers = prober.ask(question, &self.batch)?;
        let batch = &self.batch;
        let truth = self.truths[given as usize].get_or_insert_with(|| expected(batch, given, turn));
        Ok(judge(batch, &answers, truth, turn.is_some(), given, band(prober.kernel())))
    }

    /// Whether something stands between the origin and t = 1.
    fn measure_blocked(&self, prober: &mut Prober, given: Given) -> Result<Metrics, Error> {
        let answers = prober.ask(Question::Blocked, &self.batch)?;
        let mut metrics = Metrics { count: answers.len() as u64, ..Metrics::default() };
        for (answer, (is_blocked, margin)) in answers.iter().zip(blocked(&self.batch, given)) {
            if answer.blocked != is_blocked {
                metrics.false_hits += u64::from(answer.blocked);
                metrics.false_misses += u64::from(is_blocked);
                metrics.misclassified = metrics.misclassified.max(margin);
                metrics.wrong_beyond_band += u64::from(!(margin < band(prober.kernel())));
            }
        }
        Ok(metrics)
    }

    /// Whether the light reaches the hits that it ought to reach, and no others. Rays whose numbers, as the kernel got them,
    /// are nearer to the horizon than the class says do not count.
    fn measure_light(&self, prober: &mut Prober, given: Given) -> Result<Metrics, Error> {
        const HORIZON: f64 = 0.99e-5;
        let answers = prober.ask(Question::Lit, &self.batch)?;
        let truth = lighting(&self.batch, given, Specular::Phong);
        let mut metrics = Metrics { count: answers.len() as u64, ..Metrics::default() };
        let (mut acne, mut leaks, mut worst) = (0, 0, 0.0);
        for (((answer, ray), &lit), truth) in answers.iter().zip(&self.batch.rays).zip(&self.lit).zip(truth) {
            if truth.cosine.abs() < HORIZON || (lit && truth.cosine < 0.0) {
                continue;
            }
            if !answer.found || answer.surface != ray.first {
                metrics.wrong_roots += u64::from(answer.found);
                metrics.false_misses += u64::from(!answer.found);
                continue;
            }
            metrics.not_finite += u64::from(!answer.value.is_finite());
            worst = worse(worst, (answer.value - truth.cosine).abs() * truth.seen / U);
            let is_lit = answer.facing && !answer.blocked;
            acne += u64::from(lit && !is_lit);
            leaks += u64::from(!lit && is_lit);
        }
        (metrics.acne, metrics.leaks, metrics.light_error) = (Some(acne), Some(leaks), Some(worst));
        Ok(metrics)
    }

    /// The specular term.
    fn measure_highlight(&self, prober: &mut Prober, given: Given, model: Specular) -> Result<Metrics, Error> {
        let answers = prober.ask(Question::Highlight { blinn: model == Specular::Blinn }, &self.batch)?;
        let mut metrics = Metrics { count: answers.len() as u64, ..Metrics::default() };
        let mut worst = 0.0;
        for (answer, truth) in answers.iter().zip(lighting(&self.batch, given, model)) {
            metrics.false_misses += u64::from(!answer.found);
            metrics.not_finite += u64::from(!answer.value.is_finite());
            worst = worse(worst, (answer.value - truth.highlight).abs() * truth.seen);
        }
        metrics.power_error = Some(worst);
        Ok(metrics)
    }
}
