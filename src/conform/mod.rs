//! Is a driver right? Built-in scenes at every tier, each picture judged by the reference, and the promises of all classes of hard
//! cases; beside what is known of the driver, or beside another one.

mod baseline;
mod diff;
mod junit;
mod record;
mod scenes;
mod table;

pub use baseline::{Baseline, Standing};
pub use diff::{Pair, Relation, Side, diff, diff_table};
pub use junit::junit;
pub use record::{Check, Former, Key, Kind, PictureFacts, RayFacts, Report, Run, Verdict};
pub use scenes::{BuiltIn, SCENES};
pub use table::{head, line, summary};

use std::collections::BTreeMap;
use std::time::Instant;

use crate::certificate::{Bits, PictureHasher, SceneHash};
use crate::compare::{Explanation, UnexplainedPixel};
use crate::cpu::Reference;
use crate::effects::Effects;
use crate::engine::{Backend, Engine, render_picture};
use crate::film::Picture;
use crate::gpu::{Error, Gpu, Kernel};
use crate::misuse::Misuse;
use crate::precision::{Demand, Request, Selection, Tier};
use crate::scene::Scene;
use crate::settings::{Convention, Settings};
use crate::stress::{self, Class, Row};

/// The conventions in which each scene is rendered.
const CONVENTIONS: [(&str, Convention); 2] = [("classic", Convention::Classic), ("exact", Convention::Exact)];
/// Tiers in columns; the last is no tier but a property of a picture.
pub const COLUMNS: [&str; 4] = ["fast", "robust", "double", "certified"];
/// Unexplained pixels that are told one by one.
const TOLD: usize = 3;

/// What to check.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Scenes.
    pub scenes: Vec<&'static BuiltIn>,
    /// Classes of hard cases.
    pub classes: Vec<Class>,
    /// Rays of each case.
    pub count: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// Checks a device. `done` sees the checks of a scene in one convention, or of a class, as they come, and how much of all is done;
/// what it gets makes up the run that is returned. A device that is lost ends the run.
pub fn run(gpu: &Gpu, plan: &Plan, mut done: impl FnMut(&[Check], f64)) -> Run {
    let mut run = Run::new(&gpu.device.info);
    let parts = (plan.scenes.len() * CONVENTIONS.len() + plan.classes.len()).max(1) as f64;
    let mut part = 0.0;
    let mut add = |run: &mut Run, checks: Vec<Check>| {
        part += 1.0;
        done(&checks, part / parts);
        run.checks.extend(checks);
    };
    for scene in &plan.scenes {
        for (name, convention) in CONVENTIONS {
            let key =
                |tier: &str| Key { kind: Kind::Picture, name: scene.name.into(), case: name.into(), tier: tier.into() };
            let (checks, lost) = pictures(gpu, scene, &convention.settings(), key);
            add(&mut run, checks);
            if let Some(why) = lost {
                return Run { lost: Some(why), ..run };
            }
        }
    }
    let kernels = Tier::ALL.map(Kernel::Tier);
    let mut rows: Vec<Row> = Vec::new();
    let ended = stress::run(gpu, &kernels, &plan.classes, plan.count, plan.seed, |row| {
        if rows.last().is_some_and(|last| last.id != row.id) {
            add(&mut run, rows.drain(..).map(promise).collect());
        }
        rows.push(row.clone());
    });
    if !rows.is_empty() {
        add(&mut run, rows.into_iter().map(promise).collect());
    }
    if let Err(error) = ended {
        // Which class it was, the driver does not say.
        let key = Key { kind: Kind::Promise, name: "all classes".into(), case: String::new(), tier: "all".into() };
        let (check, lost) = failed(key, &error, 0.0);
        add(&mut run, vec![check]);
        run.lost = lost;
    }
    run
}

/// What a tier makes of a class.
fn promise(row: Row) -> Check {
    let (verdict, why) = match row.verdict {
        stress::Verdict::Pass => (Verdict::Pass, Vec::new()),
        stress::Verdict::Fail(why) => (Verdict::Fail, why),
        stress::Verdict::TooFew(why) => (Verdict::TooFew, vec![why]),
        stress::Verdict::NotCovered => (Verdict::NotCovered, Vec::new()),
        stress::Verdict::Reported => (Verdict::Reported, Vec::new()),
        stress::Verdict::Refused(why) => (Verdict::Refused, vec![why]),
    };
    let m = row.metrics;
    let rays = RayFacts { count: m.count, wrong: m.wrong(), p999: m.p999, worst_t: m.worst_t };
    Check {
        key: Key { kind: Kind::Promise, name: row.class.into(), case: row.case.into(), tier: row.kernel.into() },
        verdict,
        why,
        ms: row.ms,
        picture: None,
        rays: (verdict != Verdict::Refused).then_some(rays),
    }
}

/// A check that gave an error; how the device was lost, if it was.
fn failed(key: Key, error: &Error, ms: f64) -> (Check, Option<String>) {
    let verdict = if error.is_refusal() { Verdict::Refused } else { Verdict::Error };
    let why = error.to_string();
    let lost = matches!(error, Error::Lost(_)).then(|| why.clone());
    (Check { key, verdict, why: vec![why], ms, picture: None, rays: None }, lost)
}

/// The pictures of a scene at each tier and certified; how the device was lost, if it was.
fn pictures(
    gpu: &Gpu,
    scene: &BuiltIn,
    settings: &Settings,
    key: impl Fn(&str) -> Key,
) -> (Vec<Check>, Option<String>) {
    let mut checks = Vec::new();
    let subject = match Subject::new(scene, settings) {
        Ok(subject) => subject,
        Err(error) => return (vec![failed(key(COLUMNS[0]), &error, 0.0).0], None),
    };
    let requests = Tier::ALL.map(Request::Tier).into_iter().chain([Request::Certified]);
    for (request, tier) in requests.zip(COLUMNS) {
        let start = Instant::now();
        let ms = || start.elapsed().as_secs_f64() * 1e3;
        match subject.judged(gpu, request) {
            Ok((verdict, why, facts)) => {
                checks.push(Check { key: key(tier), verdict, why, ms: ms(), picture: Some(facts), rays: None });
            }
            Err(error) => {
                let (check, lost) = failed(key(tier), &error, ms());
                checks.push(check);
                if lost.is_some() {
                    return (checks, lost);
                }
            }
        }
    }
    (checks, None)
}

/// A scene with its reference and the reference's picture.
struct Subject {
    scene: Scene,
    settings: Settings,
    effects: Effects,
    demand: Demand,
    reference: Reference<f64>,
    expected: Picture,
}

impl Subject {
    fn new(built_in: &BuiltIn, settings: &Settings) -> Result<Self, Error> {
        let broken = || Misuse::Picture(format!("the built-in scene {} has errors", built_in.name));
        let scene = built_in.scene().ok_or_else(broken)?;
        let viewed = scene.viewed(settings);
        let effects = Effects::of(&viewed);
        let demand = Demand::of(&viewed, &effects);
        let reference = Reference::new(&viewed, &effects);
        drop(viewed);
        let mut rgb = vec![0; scene.width as usize * scene.height as usize * 3];
        reference.rows(0, &mut rgb)?;
        let expected = Picture::assemble(scene.width, scene.height, rgb);
        Ok(Self { scene, settings: *settings, effects, demand, reference, expected })
    }

    /// The device's picture, judged.
    fn judged(&self, gpu: &Gpu, request: Request) -> Result<(Verdict, Vec<String>, PictureFacts), Error> {
        let viewed = self.scene.viewed(&self.settings);
        let selection = Selection::of(&viewed, &self.effects, request, gpu.ladder());
        let backend = Backend::of(Some(gpu), &selection);
        if let Backend::Device(gpu, tier) = backend {
            gpu.kernel(tier)?;
        }
        let mut engine = Engine::new(backend, viewed, &self.effects)?;
        let (rgb, not_finite) = render_picture(&mut engine)?;
        let picture = Picture::assemble(self.scene.width, self.scene.height, rgb);
        let mut facts = self.facts(&picture);
        facts.not_finite = not_finite;
        let by_reference = engine.stages().is_some_and(|stages| stages.kernel + stages.double == 0);
        let mut why = Vec::new();
        if facts.differing > 0 {
            let first = if selection.certified {
                // Of a certified picture nothing explains anything.
                facts.unexplained = facts.differing;
                self.first_differing(&picture)
            } else {
                let explanation = Explanation::of(&picture, &self.expected, &self.reference, &backend.judge());
                let explained = explanation.explained.into_iter();
                facts.explained = explained.map(|(decision, count)| (decision.name().to_owned(), count)).collect();
                facts.unexplained = explanation.unexplained;
                explanation.listed
            };
            if facts.unexplained > 0 {
                why.push(format!("{} of {} differing pixels unexplained", facts.unexplained, facts.differing));
                why.extend(first.iter().take(TOLD).map(told));
            }
        }
        if not_finite > 0 {
            why.push(format!("{not_finite} pixels not finite"));
        }
        let beyond = || match backend {
            Backend::Device(_, tier) => self.demand.beyond(tier, self.scene.viewed(&self.settings).scene()),
            _ => None,
        };
        let verdict = match (facts.differing, facts.unexplained, not_finite) {
            _ if by_reference => {
                why = vec!["the CPU reference calculates all of its pixels".into()];
                Verdict::Refused
            }
            (0, _, 0) => Verdict::Same,
            (_, 0, 0) => Verdict::Explained,
            _ => match beyond() {
                Some(reason) => {
                    why.push(reason);
                    Verdict::NotCovered
                }
                None => Verdict::Unexplained,
            },
        };
        Ok((verdict, why, facts))
    }

    /// The first pixels of a picture that are not the reference's.
    fn first_differing(&self, picture: &Picture) -> Vec<UnexplainedPixel> {
        let width = picture.width() as usize;
        let pairs = picture.pixels().iter().zip(self.expected.pixels()).enumerate();
        let differing = pairs.filter(|(_, (value, reference))| value != reference).take(TOLD);
        let pixel = |(index, (&value, &reference)): (usize, (&[u8; 3], &[u8; 3]))| {
            let (x, y) = ((index % width) as u32, (index / width) as u32);
            UnexplainedPixel { x, y, value, reference }
        };
        differing.map(pixel).collect()
    }

    /// What is told of a picture, but for what explains it.
    fn facts(&self, picture: &Picture) -> PictureFacts {
        let mut hasher = PictureHasher::new(picture.width(), picture.height(), Bits::Eight);
        hasher.add(picture.rgb());
        let differing = picture.pixels().iter().zip(self.expected.pixels()).filter(|(a, b)| a != b).count() as u64;
        PictureFacts {
            scene_sha256: SceneHash::of(&self.scene).sha256().to_owned(),
            sha256: hasher.finish().sha256().to_owned(),
            width: picture.width(),
            height: picture.height(),
            differing,
            explained: BTreeMap::new(),
            unexplained: 0,
            not_finite: 0,
        }
    }
}

fn told(UnexplainedPixel { x, y, value, reference }: &UnexplainedPixel) -> String {
    format!("x {x}, y {y}: {value:?}, and the reference has {reference:?}")
}
