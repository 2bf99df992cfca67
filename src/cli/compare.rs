//! `trueray compare`.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::failure::{DIFFERENT, Failure, OK, USAGE};
use super::input::Loaded;
use super::options::{DeviceOptions, PictureOptions, device_name, open_device};
use super::output::{errln, out, outln};
use crate::compare::{Difference, Explanation, Limits, Verdict, heatmap, three_wide, verdict};
use crate::cpu::{Judge, Reference};
use crate::engine::{Backend, Engine, render_picture};
use crate::film::{Format, Leniency, Picture, Target, read_picture};
use crate::gpu::Choice;
use crate::precision::Tier;

/// Arguments of `trueray compare`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Two pictures (PPM or PNG); with --scene at most one
    #[arg(value_name = "PICTURE", num_args = 0..=2)]
    pictures: Vec<PathBuf>,
    /// Compare with the CPU reference of this scene: the picture given, or the one that the device renders
    #[arg(long, value_name = "SCENE")]
    scene: Option<PathBuf>,
    /// Write a picture of where and how much they differ
    #[arg(long, value_name = "FILE")]
    heatmap: Option<PathBuf>,
    /// Write both pictures and the heat map side by side
    #[arg(long, value_name = "FILE")]
    three_wide: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Repair malformed PPM files instead of refusing them
    #[arg(long)]
    lenient: bool,
    #[command(flatten)]
    limits: LimitArgs,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    device: DeviceOptions,
}

/// How much may differ; without any of these, nothing may, and with --scene no pixel may be unexplained.
#[derive(Debug, clap::Args)]
struct LimitArgs {
    /// Pixels that may differ at all
    #[arg(long, value_name = "PIXELS")]
    max_differing: Option<u64>,
    /// Pixels that may differ by more than 1 level
    #[arg(long, value_name = "PIXELS")]
    max_over_1: Option<u64>,
    /// Pixels that may differ by more than 2 levels
    #[arg(long, value_name = "PIXELS")]
    max_over_2: Option<u64>,
    /// Pixels that may differ by more than 10 levels
    #[arg(long, value_name = "PIXELS")]
    max_over_10: Option<u64>,
    /// Greatest level difference of any pixel
    #[arg(long, value_name = "LEVELS")]
    max_level: Option<u8>,
    /// Greatest mean difference, in levels a sample
    #[arg(long, value_name = "LEVELS")]
    max_mean: Option<f64>,
    /// With --scene: pixels that no decision of the reference explains
    #[arg(long, value_name = "PIXELS", default_value_t = 0, requires = "scene")]
    max_unexplained: u64,
}

impl LimitArgs {
    /// The limits on the difference; with a scene its explanation is the verdict unless limits are given.
    fn limits(&self, with_scene: bool) -> Limits {
        let given = Limits {
            over_0: self.max_differing,
            over_1: self.max_over_1,
            over_2: self.max_over_2,
            over_10: self.max_over_10,
            max_level: self.max_level,
            max_mean: self.max_mean,
        };
        if given == Limits::UNLIMITED && !with_scene { Limits::default() } else { given }
    }
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Report {
    a: String,
    b: String,
    verdict: Verdict,
    exceeded: Vec<String>,
    #[serde(flatten)]
    difference: Difference,
    explanation: Option<Explanation>,
    not_finite_pixels: Option<u64>,
}

/// Two pictures to compare, with what the scene says of them.
struct Subject {
    names: [String; 2],
    pictures: [Picture; 2],
    explanation: Option<Explanation>,
    not_finite: Option<u64>,
}

pub(super) fn run(args: &Args) -> u8 {
    match compare(args) {
        Ok(code) => code,
        // compare has one code for every trouble, as cmp does.
        Err(failure) => {
            failure.report();
            USAGE
        }
    }
}

fn compare(args: &Args) -> Result<u8, Failure> {
    let Subject { names: [a, b], pictures: [picture_a, picture_b], explanation, not_finite } =
        match (&args.scene, args.pictures.as_slice()) {
            (None, [a, b]) => {
                let pictures = [read(a, args.lenient)?, read(b, args.lenient)?];
                Subject {
                    names: [a, b].map(|p| p.display().to_string()),
                    pictures,
                    explanation: None,
                    not_finite: None,
                }
            }
            (Some(scene), pictures @ ([] | [_])) => with_scene(args, scene, pictures.first().map(PathBuf::as_path))?,
            _ => return Err(Failure::new(USAGE, "compare takes two pictures, or --scene SCENE and at most one")),
        };
    let mismatch = |error: crate::compare::SizeMismatch| Failure::new(USAGE, error.to_string());
    let difference = Difference::between(&picture_a, &picture_b).map_err(mismatch)?;
    let limits = args.limits.limits(args.scene.is_some());
    let mut exceeded = limits.exceeded(&difference);
    let mut verdict = verdict(&difference, &limits);
    let unexplained = explanation.as_ref().map_or(0, |explanation| explanation.unexplained);
    if unexplained > args.limits.max_unexplained {
        exceeded.push(format!("unexplained pixels: {unexplained}, limit {}", args.limits.max_unexplained));
        verdict = Verdict::Different;
    }
    if not_finite.is_some_and(|count| count > 0) {
        exceeded.push(format!("pixels that are not finite: {}", not_finite.unwrap_or_default()));
        verdict = Verdict::Different;
    }

    for (path, picture) in [(&args.heatmap, heatmap as fn(&_, &_) -> _), (&args.three_wide, three_wide)] {
        if let Some(path) = path {
            save(path, &picture(&picture_a, &picture_b).map_err(mismatch)?)?;
        }
    }
    if args.json {
        let report = Report { a, b, verdict, exceeded, difference, explanation, not_finite_pixels: not_finite };
        outln!("{}", serde_json::to_string_pretty(&report).map_err(|e| Failure::new(USAGE, e.to_string()))?);
    } else {
        out!("{}", difference.report(&a, &b));
        if let Some(explanation) = &explanation {
            out!("{}", explanation.report());
        }
        for limit in &exceeded {
            outln!("over the limit    {limit}");
        }
        outln!("verdict           {verdict}");
    }
    Ok(if verdict == Verdict::Different { DIFFERENT } else { OK })
}

/// The picture given, or the device's, against the scene's reference.
fn with_scene(args: &Args, scene: &Path, picture: Option<&Path>) -> Result<Subject, Failure> {
    let mut loaded = Loaded::read(scene, false)?;
    args.picture.resize(&mut loaded.scene);
    let scene = &loaded.scene;
    let settings = args.picture.settings()?;
    let effects = args.picture.renderable_effects(scene, &settings)?;
    let (name, picture, not_finite, judge) = if let Some(path) = picture {
        // A picture of unknown origin is judged as that of the tier asked for, or else of plain f32.
        let judge = Judge::of(args.device.precision.0.unwrap_or(Tier::Fast));
        (path.display().to_string(), read(path, args.lenient)?, None, judge)
    } else {
        // Comparing the reference with itself would say nothing: auto means a device here.
        let choice = if args.device.device == Choice::Auto { &Choice::Gpu } else { &args.device.device };
        if *choice == Choice::Cpu {
            return Err(Failure::new(USAGE, "--device cpu would compare the reference with itself"));
        }
        let gpu = open_device(choice)?;
        let tier = args.device.selection(Some(&gpu), scene, &settings, &effects).tier;
        let backend = Backend::Device(&gpu, tier);
        let mut engine = Engine::new(backend, scene, &settings, &effects)?;
        let (rgb, not_finite) = render_picture(&mut engine)?;
        let name = format!("{}, {tier}", device_name(Some(&gpu)));
        (name, self::picture(scene, rgb)?, Some(not_finite), backend.judge())
    };
    let (rgb, _) = render_picture(&mut Engine::new(Backend::Reference, scene, &settings, &effects)?)?;
    let expected = self::picture(scene, rgb)?;
    if (picture.width(), picture.height()) != (expected.width(), expected.height()) {
        let (width, height) = (picture.width(), picture.height());
        let message = format!("{name} has {width} × {height} pixels, the scene {} × {}", scene.width, scene.height);
        return Err(Failure::new(USAGE, message));
    }
    let reference = Reference::new(scene, &settings, &effects);
    let explanation = Explanation::of(&picture, &expected, &reference, &judge);
    let names = [name, format!("reference of {}", loaded.name)];
    Ok(Subject { names, pictures: [picture, expected], explanation: Some(explanation), not_finite })
}

fn picture(scene: &crate::scene::Scene, rgb: Vec<u8>) -> Result<Picture, Failure> {
    Picture::new(scene.width, scene.height, rgb).map_err(|error| Failure::new(USAGE, error.to_string()))
}

fn read(path: &Path, lenient: bool) -> Result<Picture, Failure> {
    let leniency = if lenient { Leniency::Lenient } else { Leniency::Strict };
    let reading = read_picture(path, leniency).map_err(|error| {
        let hint = if error.problem().lenient_helps() { "\n  help: --lenient repairs this" } else { "" };
        Failure::new(USAGE, format!("{error}{hint}"))
    })?;
    for warning in &reading.warnings {
        errln!("trueray: {}: warning: {warning}", path.display());
    }
    Ok(reading.picture)
}

fn save(path: &Path, picture: &Picture) -> Result<(), Failure> {
    let format = Format::from_extension(path).unwrap_or_default();
    Ok(picture.save(&Target::from_argument(path.as_os_str()), format)?)
}
