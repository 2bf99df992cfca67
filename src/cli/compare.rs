//! `trueray compare`.

mod two_devices;

use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::Serialize;

use super::failure::{DIFFERENT, Failure, OK, USAGE};
use super::files::{command, duration, json, report_json, save as save_text};
use super::guard::Guard;
use super::input::{Input, Loaded};
use super::named::format_by_ending;
use super::options::{DeviceOptions, PictureOptions, SeveralDevices, open_device};
use super::output::{errln, out, outln};
use super::particles::Reading;
use crate::compare::{
    Band, BySphere, Comparison, Difference, Explanation, Limits, Metrics, SCALE, SizeMismatch, Verdict, heatmap,
    three_wide, verdict,
};
use crate::cpu::{Judge, Reference};
use crate::effects::Effects;
use crate::engine::{Backend, Engine, device_name, render_picture};
use crate::film::{Encoded, Leniency, Picture, ReadError, Target};
use crate::gpu::{Choice, Gpu};
use crate::mistakes::{CAUSES, Diagnosis, Known, diagnose, diagnose_size};
use crate::precision::Request;
use crate::scene::Names;
use crate::viewed::ViewedScene;
use crate::words::{count, visible};

/// Arguments of `trueray compare`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Two pictures (PPM or PNG), one of which may be `-` for standard input; with --scene at most one
    #[arg(value_name = "PICTURE", num_args = 0..=2, help_heading = "Pictures")]
    pictures: Vec<PathBuf>,
    /// Compare with the CPU reference of this scene: the picture given, or the one that the device renders
    #[arg(long, value_name = "SCENE", help_heading = "Scene")]
    scene: Option<PathBuf>,
    /// Say which known mistake or other convention makes the picture what it is
    #[arg(long, requires = "scene", help_heading = "Output")]
    explain: bool,
    /// Time for --explain to look for them, in seconds; what was found until it is over is shown. Without it, as long as it takes
    #[arg(long, value_name = "S", value_parser = duration, requires = "explain", help_heading = "Output")]
    explain_seconds: Option<Duration>,
    /// List the mistakes and conventions that --explain knows
    #[arg(long, exclusive = true, help_heading = "Output")]
    causes: bool,
    /// Repair malformed pictures instead of refusing them
    #[arg(long, help_heading = "Pictures")]
    lenient: bool,
    #[command(flatten)]
    limits: LimitArgs,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    device: SeveralDevices,
    /// Write a picture of where and how much they differ
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    heatmap: Option<PathBuf>,
    /// Write both pictures and the heat map side by side
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    three_wide: Option<PathBuf>,
    /// Write a page with both pictures, where they differ and why, one HTML file that needs nothing else
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    report: Option<PathBuf>,
    /// Print JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

/// How much may differ; without any of these, nothing may, and with --scene no pixel may be unexplained.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Limits")]
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
    metrics: Metrics,
    explanation: Option<Explanation>,
    #[serde(flatten)]
    diagnosis: Option<Diagnosis>,
    not_finite_pixels: Option<u64>,
    /// What had to be got over in reading the pictures.
    warnings: Vec<String>,
    /// What the files say besides their samples.
    notes: Vec<String>,
    /// The heat map's scale, where one was written.
    heat_map: Option<Vec<HeatBand>>,
}

/// What `--json` prints where nothing could be compared.
#[derive(Debug, Serialize)]
struct Trouble<'a> {
    verdict: &'static str,
    error: &'a str,
    /// Why the picture has another size than the scene.
    #[serde(flatten)]
    diagnosis: Option<&'a Diagnosis>,
}

/// A colour of the heat map.
#[derive(Debug, Serialize)]
struct HeatBand {
    from_level: u8,
    color: [u8; 3],
    legend: &'static str,
    pixels: u64,
}

/// Two pictures to compare, with what the scene says of them.
struct Pair {
    names: [String; 2],
    pictures: [Picture; 2],
    remarks: Remarks,
    explanation: Option<Explanation>,
    diagnosis: Option<Diagnosis>,
    not_finite: Option<u64>,
    /// What the differing pixels show, with the labels of spheres, where a page is wanted.
    spheres: Option<(BySphere, Names)>,
}

pub(super) fn run(args: &Args) -> u8 {
    compare(args).unwrap_or_else(|failure| trouble(args, failure, None))
}

/// Says why nothing can be compared.
fn trouble(args: &Args, failure: Failure, diagnosis: Option<&Diagnosis>) -> u8 {
    match json(&Trouble { verdict: "trouble", error: &failure.message, diagnosis }) {
        Ok(json) if args.json => out!("{json}"),
        _ => {
            if let Some(diagnosis) = diagnosis {
                out!("{}", diagnosis.report());
            }
            _ = failure.without_cpu().report();
        }
    }
    // compare has one code for every trouble, as cmp does.
    USAGE
}

fn compare(args: &Args) -> Result<u8, Failure> {
    if args.causes {
        list_causes();
        return Ok(OK);
    }
    let written = [("--heatmap", &args.heatmap), ("--three-wide", &args.three_wide)];
    Guard::new(args.pictures.iter().chain(&args.scene))
        .options(written.into_iter().chain([("--report", &args.report)]))?;
    written.iter().filter_map(|(_, path)| path.as_deref()).try_for_each(|path| format_by_ending(path).map(|_| ()))?;
    if let Some(devices) = args.device.pair()? {
        if args.explain {
            return Err(Failure::new(
                USAGE,
                "--explain is for somebody's picture, --device twice for two of this program's",
            ));
        }
        return two_devices::compare(args, &devices);
    }
    let Pair { names: [a, b], pictures: [picture_a, picture_b], remarks, explanation, diagnosis, not_finite, spheres } =
        match (&args.scene, args.pictures.as_slice()) {
            (None, [a, b]) => two_pictures(args, a, b)?,
            (Some(scene), pictures @ ([] | [_])) => {
                match with_scene(args, scene, pictures.first().map(PathBuf::as_path))? {
                    Compared::Pair(pair) => *pair,
                    Compared::OtherSize(failure, diagnosis) => return Ok(trouble(args, failure, Some(&diagnosis))),
                }
            }
            _ => return Err(Failure::new(USAGE, "compare takes two pictures, or --scene SCENE and at most one")),
        };
    let difference = Difference::between(&picture_a, &picture_b)?;
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
            save(path, &picture(&picture_a, &picture_b)?)?;
        }
    }
    if let Some(path) = &args.report {
        let comparison = Comparison {
            title: "Two pictures",
            names: [&a, &b],
            pictures: [&picture_a, &picture_b],
            difference: &difference,
            verdict: &verdict.to_string(),
            explanation: explanation.as_ref(),
            diagnosis: diagnosis.as_ref(),
            spheres: spheres.as_ref().map(|(counts, names)| (counts, names)),
            remarks: &[&remarks.warnings[..], &remarks.notes[..]].concat(),
        };
        save_text(path, &comparison.html(&command())?)?;
    }
    let draws = args.heatmap.is_some() || args.three_wide.is_some();
    let heat_map = if draws { Some(heat_bands(&picture_a, &picture_b)?) } else { None };
    let Remarks { warnings, notes } = remarks;
    if args.json {
        let report = Report {
            a,
            b,
            verdict,
            exceeded,
            difference,
            metrics: Metrics::between(&picture_a, &picture_b)?,
            explanation,
            diagnosis,
            not_finite_pixels: not_finite,
            warnings,
            notes,
            heat_map,
        };
        out!("{}", report_json(&report)?);
    } else {
        out!("{}", difference.report(&visible(&a), &visible(&b)));
        for note in &notes {
            outln!("note              {note}");
        }
        if let Some(explanation) = &explanation {
            out!("{}", explanation.report());
        }
        if let Some(diagnosis) = &diagnosis {
            out!("{}", diagnosis.report());
        }
        for (index, HeatBand { legend, pixels, .. }) in heat_map.iter().flatten().enumerate() {
            let label = if index == 0 { "heat map" } else { "" };
            outln!("{label:<17} {legend} ({})", count(*pixels, "pixel"));
        }
        for limit in &exceeded {
            outln!("over the limit    {limit}");
        }
        outln!("verdict           {verdict}");
    }
    Ok(if verdict == Verdict::Different { DIFFERENT } else { OK })
}

/// Prints what `--explain` knows.
fn list_causes() {
    let width = CAUSES.iter().map(|known| known.name.len()).max().unwrap_or(0);
    for Known { name, line, .. } in CAUSES {
        outln!("{name:<width$}  {line}");
    }
}

/// A picture against its scene.
enum Compared {
    Pair(Box<Pair>),
    /// The sizes differ; why they do.
    OtherSize(Failure, Diagnosis),
}

/// The scene in the size that is asked for.
fn load(args: &Args, scene: &Path) -> Result<Loaded, Failure> {
    let input = Input::read(scene, &Reading::usual(&args.picture)?)?;
    if args.json && input.parsed.scene.is_none() {
        return Err(Failure::new(USAGE, input.parsed.report(false).trim_end()));
    }
    let mut loaded = input.into_renderable(args.json)?;
    args.picture.frame(&mut loaded.scene)?;
    Ok(loaded)
}

/// The picture given, or the device's, against the scene's reference.
fn with_scene(args: &Args, scene: &Path, picture: Option<&Path>) -> Result<Compared, Failure> {
    let loaded = load(args, scene)?;
    let scene = &loaded.scene;
    let rendered = |rgb| Picture::assemble(scene.width, scene.height, rgb);
    let mut remarks = Remarks::default();
    let encoded = picture.map(open).transpose()?;
    let settings = args.picture.settings()?;
    let viewed = scene.viewed(&settings);
    let effects = args.picture.renderable_effects(&viewed)?;
    let time = args.explain_seconds;
    let device = args.device.first();
    let sized = encoded.map(|(name, encoded)| encoded.size().map(|size| (name, encoded, size))).transpose()?;
    let encoded = if let Some((name, encoded, (width, height))) = sized {
        if (width, height) != (scene.width, scene.height) {
            let shown = visible(&name);
            let message =
                format!("{shown} has {width} × {height} pixels, the scene {} × {}", scene.width, scene.height);
            let failure = Failure::new(USAGE, message);
            if !args.explain {
                return Err(failure);
            }
            let picture = decode(args, &name, encoded, "the picture", &mut remarks)?;
            return Ok(Compared::OtherSize(failure, diagnose_size(&picture, &viewed, &effects, time)));
        }
        Some((name, encoded))
    } else {
        None
    };
    let (name, picture, not_finite, judge) = if let Some((name, encoded)) = encoded {
        let picture = decode(args, &name, encoded, "the picture", &mut remarks)?;
        let judge = judge_of_unknown(&device, device_of_unknown(&device)?.as_ref(), &viewed, &effects);
        drop(viewed);
        (name, picture, None, judge)
    } else {
        // Comparing the reference with itself would say nothing: auto means a device here.
        let choice = if device.device == Choice::Auto { &Choice::Gpu } else { &device.device };
        if *choice == Choice::Cpu {
            return Err(Failure::new(USAGE, "--device cpu would compare the reference with itself"));
        }
        let gpu = open_device(choice)?;
        let selection = device.selection(Some(&gpu), &viewed, &effects);
        let backend = Backend::of(Some(&gpu), &selection);
        let mut engine = Engine::new(backend, viewed, &effects)?;
        let (rgb, not_finite) = render_picture(&mut engine)?;
        let name = format!("{}, {selection}", device_name(Some(&gpu)));
        (name, rendered(rgb), Some(not_finite), backend.judge())
    };
    let (rgb, _) = render_picture(&mut Engine::new(Backend::Reference, scene.viewed(&settings), &effects)?)?;
    let expected = rendered(rgb);
    let reference = Reference::new(&scene.viewed(&settings), &effects);
    let explanation = Explanation::of(&picture, &expected, &reference, &judge);
    let by_sphere = || BySphere::of(&picture, &expected, &scene.viewed(&settings), &explanation.places);
    let spheres = if args.report.is_some() { Some((by_sphere()?, scene.sphere_names.clone())) } else { None };
    let names = [name, format!("reference of {}", loaded.name)];
    let places = &explanation.places;
    let diagnosis =
        args.explain.then(|| diagnose(&picture, &expected, &scene.viewed(&settings), &effects, places, time));
    let pictures = [picture, expected];
    Ok(Compared::Pair(Box::new(Pair {
        names,
        pictures,
        remarks,
        explanation: Some(explanation),
        diagnosis,
        not_finite,
        spheres,
    })))
}

/// The device as whose pictures those of unknown origin are judged: the one that is asked for or, for auto, the one that would render
/// here, if there is one.
pub(super) fn device_of_unknown(device: &DeviceOptions) -> Result<Option<Gpu>, Failure> {
    match &device.device {
        Choice::Cpu => Ok(None),
        // The picture is there without a device, too.
        Choice::Auto => Ok(open_device(&Choice::Auto)
            .inspect_err(|error| {
                errln!("trueray: judged as a picture of hardware, since no device can be used here: {error}");
            })
            .ok()),
        choice => Ok(Some(open_device(choice)?)),
    }
}

/// The judge of a picture of unknown origin: as if it came from that device, at the tier that is asked for or that covers the scene there.
pub(super) fn judge_of_unknown(
    device: &DeviceOptions,
    gpu: Option<&Gpu>,
    viewed: &ViewedScene,
    effects: &Effects,
) -> Judge {
    if device.device == Choice::Cpu {
        return match device.precision {
            Request::Tier(tier) => Judge::of(tier),
            Request::Auto | Request::Certified => Backend::Reference.judge(),
        };
    }
    let selection = device.selection(gpu, viewed, effects);
    match gpu {
        None if !selection.certified => Judge::of(selection.tier),
        gpu => Backend::of(gpu, &selection).judge(),
    }
}

/// What is worth telling of the picture files.
#[derive(Default)]
struct Remarks {
    /// What had to be got over.
    warnings: Vec<String>,
    /// What does not matter here, but does to other programs.
    notes: Vec<String>,
}

impl From<SizeMismatch> for Failure {
    fn from(mismatch: SizeMismatch) -> Self {
        Self::new(USAGE, mismatch.to_string())
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        let hint = if error.problem().lenient_helps() { "\n  help: --lenient repairs this" } else { "" };
        Self::new(USAGE, format!("{error}{hint}"))
    }
}

/// Both pictures; nothing is decoded before their sizes are known to agree.
fn two_pictures(args: &Args, a: &Path, b: &Path) -> Result<Pair, Failure> {
    if [a, b] == [Path::new("-"); 2] {
        return Err(Failure::new(USAGE, "only one of the pictures can be standard input"));
    }
    let [(name_a, a), (name_b, b)] = [open(a)?, open(b)?];
    SizeMismatch::of(a.size()?, b.size()?)?;
    let mut remarks = Remarks::default();
    let a = decode(args, &name_a, a, "A", &mut remarks)?;
    let b = decode(args, &name_b, b, "B", &mut remarks)?;
    Ok(Pair {
        names: [name_a, name_b],
        pictures: [a, b],
        remarks,
        explanation: None,
        diagnosis: None,
        not_finite: None,
        spheres: None,
    })
}

/// A picture file, or standard input for `-`, and its name.
pub(super) fn open(path: &Path) -> Result<(String, Encoded), Failure> {
    if path == Path::new("-") {
        let name = "standard input";
        return Ok((name.into(), Encoded::from_stream(name, std::io::stdin().lock())?));
    }
    Ok((path.display().to_string(), Encoded::open(path)?))
}

/// Decodes a picture, which reports call `role`.
fn decode(args: &Args, name: &str, encoded: Encoded, role: &str, remarks: &mut Remarks) -> Result<Picture, Failure> {
    let leniency = if args.lenient { Leniency::Lenient(args.picture.settings()?.quantize) } else { Leniency::Strict };
    let reading = encoded.decode(leniency)?;
    for warning in &reading.warnings {
        if !args.json {
            errln!("trueray: {}: warning: {warning}", visible(name));
        }
        remarks.warnings.push(format!("{role}: {warning}"));
    }
    if !reading.color_spaces.is_empty() {
        let chunks = reading.color_spaces.join(", ");
        remarks
            .notes
            .push(format!("{role} says how its samples are to be shown ({chunks}); they are compared as stored"));
    }
    Ok(reading.picture)
}

/// The heat map's scale with the pixels of each colour.
fn heat_bands(a: &Picture, b: &Picture) -> Result<Vec<HeatBand>, Failure> {
    let counts = Band::counts(a, b)?;
    let bands = SCALE.iter().zip(counts);
    Ok(bands
        .map(|(&Band { from, color, legend }, pixels)| HeatBand { from_level: from, color, legend, pixels })
        .collect())
}

fn save(path: &Path, picture: &Picture) -> Result<(), Failure> {
    let format = format_by_ending(path)?;
    Ok(picture.save(&Target::from_argument(path.as_os_str()), format)?)
}
