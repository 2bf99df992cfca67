//! `trueray study`.

use std::path::{Path, PathBuf};

use super::failure::{Failure, OK};
use super::files::{check_folder, command, save, save_json, seconds};
use super::input::Loaded;
use super::options::{DeviceOptions, PictureOptions, samples_side};
use super::output::out;
use crate::settings::Settings;
use crate::study::{Error, HardCases, Plan, Study, Subject, csv, html};

/// Arguments of `trueray study`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Scene files; `-` is standard input
    #[arg(required = true, value_name = "SCENE")]
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
    /// Samples per pixel to compare: square numbers
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "1,4,16", value_parser = samples_side)]
    spp_list: Vec<u32>,
    /// Rays of each hard case, on which the intersection kernels are compared once, if a Vulkan device is used; 0 leaves
    /// them out
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = rays)]
    hard_cases: usize,
    /// Seed of the hard cases' random numbers
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Write a report with plots, one HTML file that needs nothing else
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Write every point and run as CSV; `-` is standard output
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write everything as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    device: DeviceOptions,
}

pub(super) fn run(args: &Args) -> u8 {
    match study(args) {
        Ok(()) => OK,
        Err(failure) => failure.report(),
    }
}

fn study(args: &Args) -> Result<(), Failure> {
    for path in [&args.report, &args.csv, &args.json].into_iter().flatten() {
        check_folder(path)?;
    }
    let settings = args.picture.settings()?;
    let gpu = args.device.open()?;
    let distinct = |list: &[u32]| {
        let mut list = list.to_vec();
        list.sort_unstable();
        list.dedup();
        list
    };
    let plan = Plan {
        runs: args.runs as usize,
        seconds: args.seconds,
        depths: distinct(&args.depths),
        sides: distinct(&args.spp_list),
    };
    let table_on_stdout = ![&args.csv, &args.json].into_iter().flatten().any(|path| path == Path::new("-"));
    let mut studies = Vec::new();
    for path in &args.scenes {
        let mut loaded = Loaded::read(path, false)?;
        args.picture.resize(&mut loaded.scene);
        let scene = &loaded.scene;
        let deepest = plan.depths.iter().copied().fold(settings.max_depth, u32::max);
        args.picture.renderable_effects(scene, &Settings { max_depth: deepest, ..settings })?;
        let effects = |settings: &Settings| args.picture.effects(scene, settings);
        let selection = args.device.selection(gpu.as_ref(), scene, &settings, &effects(&settings));
        let subject = Subject {
            name: &loaded.name,
            scene,
            settings: &settings,
            effects: &effects,
            gpu: gpu.as_ref(),
            selection: &selection,
        };
        let study = crate::study::study(&subject, &plan)?;
        if table_on_stdout {
            out!("{}{}", if studies.is_empty() { "" } else { "\n" }, study.report());
        }
        studies.push(study);
    }
    let hard_cases = match &gpu {
        Some(gpu) if args.hard_cases > 0 => {
            Some(crate::study::hard_cases(gpu, args.hard_cases, args.seed, args.runs as usize)?)
        }
        _ => None,
    };
    if let Some(cases) = hard_cases.as_ref().filter(|_| table_on_stdout) {
        out!("\n{}", cases.report());
    }
    write(args, &studies, hard_cases.as_ref())
}

fn write(args: &Args, studies: &[Study], hard_cases: Option<&HardCases>) -> Result<(), Failure> {
    if let Some(path) = &args.report {
        save(path, &html(studies, hard_cases, &command()))?;
    }
    if let Some(path) = &args.csv {
        save(path, &csv(studies))?;
    }
    if let Some(path) = &args.json {
        let mut document = serde_json::json!({ "command": command(), "studies": studies });
        if let Some(cases) = hard_cases {
            document["hard_cases"] = serde_json::json!(cases);
        }
        save_json(path, &document)?;
    }
    Ok(())
}

/// Rays of each case, as many as `trueray stress` asks for, or none.
fn rays(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(rays @ (0 | 64..=2_000_000)) => Ok(rays),
        _ => Err("expected 0 or a number from 64 to 2000000".into()),
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::Device(error) => error.into(),
            Error::Picture(error) => Self::new(super::failure::SCENE, error.to_string()),
        }
    }
}
