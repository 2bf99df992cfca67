//! `trueray study`.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use super::failure::Failure;
use super::files::{command, seconds};
use super::guard::Guard;
use super::input::{Loaded, check_stdin};
use super::options::{DeviceOptions, PictureOptions, samples};
use super::output::errln;
use super::particles::Reading;
use super::progress::{Progress, Style};
use super::reports::Reports;
use super::signals::{say_last, say_nothing};
use crate::settings::Settings;
use crate::study::{Event, HardCases, Skipped, Study, StudyInput, StudyPlan, csv, html};
use crate::threads::lock;
use crate::viewed::ViewedScene;

/// Arguments of `trueray study`.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Measurement")]
pub(super) struct Args {
    /// Scene files; `-` is standard input
    #[arg(required = true, value_name = "SCENE", help_heading = "Scene")]
    scenes: Vec<PathBuf>,
    /// Counted runs of each point, after one warm-up
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..=1000))]
    runs: u32,
    /// Time for the counted runs of one series, in seconds; pictures that take longer get fewer runs, but at least 3
    #[arg(long, value_name = "S", default_value_t = 15.0, value_parser = seconds)]
    seconds: f64,
    /// Reflection depths to compare; without this all from 0 to the greatest that can matter
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(0..=i64::from(Settings::MAX_DEPTH)))]
    depths: Vec<u32>,
    /// Samples per pixel to compare: of a grid square numbers
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "1,4,16", value_parser = samples)]
    spp_list: Vec<u32>,
    /// Rays of each hard case, on which the intersection kernels are compared once, if a Vulkan device is used; 0 leaves
    /// them out
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = rays)]
    hard_cases: usize,
    /// Seed of the hard cases' random numbers
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    device: DeviceOptions,
    #[command(flatten)]
    reports: Reports,
    /// How progress is shown on standard error
    #[arg(long, value_enum, default_value_t = Style::Auto, help_heading = "Output")]
    progress: Style,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    args.device.check_tier()?;
    check_stdin(&args.scenes)?;
    args.reports.check(&mut Guard::new(&args.scenes))?;
    let settings = args.picture.settings()?;
    let gpu = args.device.open()?;
    let distinct = |list: &[u32]| {
        let mut list = list.to_vec();
        list.sort_unstable();
        list.dedup();
        list
    };
    let counts = distinct(&args.spp_list);
    let patterns = counts.iter().map(|&count| args.picture.pattern("--spp-list", count));
    let plan = StudyPlan {
        runs: args.runs as usize,
        seconds: args.seconds,
        depths: distinct(&args.depths),
        patterns: patterns.collect::<Result<_, _>>()?,
    };
    let results = Arc::new(Mutex::new(Results::new(args)));
    let last = Arc::clone(&results);
    say_last(move || lock(&last).interrupted());
    let parts = args.scenes.len() as f64;
    for (number, path) in args.scenes.iter().enumerate() {
        let mut loaded = Loaded::read(path, &Reading::usual(&args.picture)?, false)?;
        args.picture.frame(&mut loaded.scene)?;
        let scene = &loaded.scene;
        let deepest = plan.depths.iter().copied().fold(settings.max_depth, u32::max);
        args.picture.renderable_effects(&scene.viewed(&Settings { max_depth: deepest, ..settings }))?;
        let effects = |viewed: &ViewedScene| args.picture.effects(viewed);
        let viewed = scene.viewed(&settings);
        let selection = args.device.selection(gpu.as_ref(), &viewed, &effects(&viewed));
        drop(viewed);
        let input = StudyInput {
            name: &loaded.name,
            scene,
            settings: &settings,
            effects: &effects,
            gpu: gpu.as_ref(),
            selection: &selection,
        };
        let mut progress = Progress::new(args.progress, &format!("study {} of {parts}", number + 1));
        let study = crate::study::study(&input, &plan, |event| match event {
            Event::Done(part) => progress.set(part),
            Event::Measured(study) => lock(&results).unfinished = Some(study.clone()),
        })?;
        progress.finish();
        lock(&results).add(study);
    }
    if let Some(gpu) = gpu.as_ref().filter(|_| args.hard_cases > 0) {
        let mut progress = Progress::new(args.progress, "hard cases");
        progress.set(0.0);
        let cases = crate::study::hard_cases(gpu, args.hard_cases, args.seed, args.runs as usize)?;
        progress.finish();
        lock(&results).add_cases(cases);
    }
    say_nothing();
    lock(&results).write()
}

/// What has been measured, and where it goes.
struct Results {
    reports: Reports,
    studies: Vec<Study>,
    /// The scene that is being measured.
    unfinished: Option<Study>,
    hard_cases: Option<HardCases>,
}

impl Results {
    fn new(args: &Args) -> Self {
        Self { reports: args.reports.clone(), studies: Vec::new(), unfinished: None, hard_cases: None }
    }

    fn add(&mut self, study: Study) {
        self.reports.show(&format!("{}{}", if self.studies.is_empty() { "" } else { "\n" }, study.report()));
        self.unfinished = None;
        self.studies.push(study);
    }

    fn add_cases(&mut self, cases: HardCases) {
        self.reports.show(&format!("\n{}", cases.report()));
        self.hard_cases = Some(cases);
    }

    /// Writes what there is, and says that it is not everything.
    fn interrupted(&mut self) {
        if let Some(mut study) = self.unfinished.take() {
            study.skipped.push(Skipped { name: "the rest".into(), reason: "the run was interrupted".into() });
            self.add(study);
        }
        if self.studies.is_empty() {
            errln!("trueray: interrupted before anything was measured");
            return;
        }
        errln!("trueray: interrupted; what was measured is written");
        if let Err(failure) = self.write() {
            failure.report();
        }
    }

    fn write(&self) -> Result<(), Failure> {
        let json = || {
            let mut document = serde_json::json!({ "command": command(), "studies": self.studies });
            if let Some(cases) = &self.hard_cases {
                document["hard_cases"] = serde_json::json!(cases);
            }
            document
        };
        self.reports.write(|| html(&self.studies, self.hard_cases.as_ref(), &command()), || csv(&self.studies), json)
    }
}

/// Rays of each case, as many as `trueray stress` asks for, or none.
fn rays(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(rays @ (0 | 64..=2_000_000)) => Ok(rays),
        _ => Err("expected 0 or a number from 64 to 2000000".into()),
    }
}
