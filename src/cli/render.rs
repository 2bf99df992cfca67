//! `trueray render` and `trueray SCENE.txt`.

mod views;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::aov::AovOptions;
use super::beside::Beside;
use super::certificate::CertificateFile;
use super::color_bar::ColorBarOptions;
use super::failure::{DEVICE_LOST, Failure, OK, STOPPED, USAGE};
use super::files::{check_place, json, save};
use super::guard::Guard;
use super::input::{Loaded, check_stdin, print_doubts};
use super::linear::{Coding, FileFormat, Film, LinearOptions};
use super::named::check_named;
use super::options::{DeviceOptions, PictureOptions};
use super::output::{err, errln};
use super::part::PartOptions;
use super::particles::ParticleOptions;
use super::progress::{Progress, Style};
use super::sampling::{Choice, SamplingOptions};
use super::show::Show;
use super::stats::{Sampled, Stats, Verified, peak_memory_mib};
use super::timeline::Timeline;
use crate::effects::Effects;
use crate::engine::{
    Backend, Engine, Options, Output, Pixels, Rays, Stages, Times, device_name, ms, render_bands, render_partial,
};
use crate::film::{Format, Target};
use crate::gpu::{Ahead, DeviceKind, Gpu};
use crate::precision::{Request, Selection};
use crate::sampling::Samples;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::threads::at_once;
use crate::verify::Verify;
use crate::viewed::ViewedScene;
use crate::words::{count, visible};

/// Arguments of `trueray render`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Scene files; `-` is standard input
    #[arg(required = true, value_name = "SCENE", help_heading = "Scene")]
    scenes: Vec<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    particles: ParticleOptions,
    #[command(flatten)]
    color_bar: ColorBarOptions,
    #[command(flatten)]
    views: views::Options,
    #[command(flatten)]
    sampling: SamplingOptions,
    #[command(flatten)]
    device: DeviceOptions,
    /// How many pixels of a device's picture the CPU reference calculates, too: a number, all, or none; without it 64, or none
    /// with more than 20,000 spheres. Where rounding does not explain a difference, there is no picture
    #[arg(long, value_name = "N", help_heading = "Device")]
    verify: Option<Verify>,
    #[command(flatten)]
    part: PartOptions,
    /// Picture file, a folder for it, or `-` for standard output; without it the file that OUTPUT names
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    /// File format: p6, p3, png, pfm or exr; without it the file name's ending decides
    #[arg(long, value_name = "FORMAT", help_heading = "Output")]
    format: Option<FileFormat>,
    #[command(flatten)]
    linear: LinearOptions,
    #[command(flatten)]
    aov: AovOptions,
    /// Print the picture to the terminal as well; no terminal says by itself that it shows sixels, so they are asked for
    #[arg(long, value_name = "HOW", value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "auto", help_heading = "Output")]
    show: Option<Show>,
    /// Write whatever file OUTPUT names: also a hidden one, one without a picture's ending, or over a file that is no picture
    #[arg(long, help_heading = "Output")]
    allow_any_output: bool,
    /// Print which effects are simulated, and why
    #[arg(long, help_heading = "Output")]
    explain: bool,
    /// Print device, effects, what decisions took, rays, times and memory
    #[arg(long, help_heading = "Output")]
    stats: bool,
    /// Write the same as JSON; `-` is standard error
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    stats_json: Option<PathBuf>,
    /// Write what certifies the picture: hashes of the scene and of the picture, settings, device, and how many pixels are right by
    /// which stage; with --precision certified, or of the CPU reference. `trueray verify` reads it
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    certificate: Option<PathBuf>,
    /// Write when each step of the run began and ended, on which thread: a trace for ui.perfetto.dev or `chrome://tracing`
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    timeline: Option<PathBuf>,
    /// Leave the rays out of the statistics: counting them takes time of its own
    #[arg(long, help_heading = "Output")]
    no_ray_counts: bool,
    /// How progress is shown on standard error
    #[arg(long, value_enum, default_value_t = Style::Auto, help_heading = "Output")]
    progress: Style,
    /// Print errors only
    #[arg(short, long, help_heading = "Output")]
    quiet: bool,
    /// Print more: the effects and the times
    #[arg(short, long, conflicts_with = "quiet", help_heading = "Output")]
    verbose: bool,
}

/// A scene and where its picture goes.
struct Job {
    loaded: Loaded,
    target: Target,
    coding: Coding,
}

/// Renders every scene; a scene with errors does not keep the others from being rendered, files that are in each other's way do.
pub(super) fn run(args: &Args) -> Result<u8, Failure> {
    render_all(args).inspect_err(|failure| args.progress.say_failed(failure))
}

fn render_all(args: &Args) -> Result<u8, Failure> {
    let apart = [
        (args.certificate.is_some(), "--certificate, which is of the picture that it is drawn over"),
        (args.part.is_given(), "--crop, --tile or --resume, whose files are to be the pixels of the whole picture"),
    ];
    args.color_bar.check(args.particles.coloring(), &apart)?;
    check_stdin(&args.scenes)?;
    if args.views.are_given() {
        return views::run(args);
    }
    if args.scenes.len() > 1 && args.output.as_deref().is_some_and(|output| !output.is_dir()) {
        return Err(Failure::new(USAGE, "several scenes need a folder for -o, or none"));
    }
    check_certificate(args)?;
    args.part.check(args.scenes.len(), args.output.as_deref())?;
    let settings = args.picture.settings()?;
    let reading = args.particles.one_frame(&args.picture)?;
    let mut guard = Guard::new(&args.scenes);
    guard.options([("--certificate", &args.certificate), ("--timeline", &args.timeline)])?;
    let timeline = args.timeline.as_deref().map(Timeline::begin);
    args.aov.check_file(args.scenes.len(), &mut guard)?;
    if let Some(path) = args.stats_json.as_deref().filter(|path| *path != Path::new("-")) {
        check_place(path)?;
        guard.output("--stats-json", path)?;
    }
    // Opening a device takes longer than reading most scenes: both at once, and what else can be done without one. The device is
    // opened here, since a driver's many allocations are cheaper on the thread whose heap grows in large steps.
    let start = Instant::now();
    let read = || {
        // What OUTPUT names has to be known of all before any is rendered.
        let scenes: Vec<_> = args.scenes.iter().map(|path| Loaded::read(path, &reading, args.quiet)).collect();
        let ahead = scenes[0].as_ref().ok().and_then(|loaded| args.ahead(&loaded.scene, &settings));
        (scenes, ahead)
    };
    let ((scenes, ahead), (gpu, open_time)) = at_once(read, || {
        let _span = tracing::info_span!("open device").entered();
        (args.device.open_with(args.quiet), start.elapsed())
    });
    let ready_time = start.elapsed();

    // Files in each other's way are the worse trouble: nothing is rendered.
    let scenes: Vec<_> =
        scenes.into_iter().map(|loaded| loaded.map(|loaded| (target(args, &loaded), loaded))).collect();
    for (target, loaded) in scenes.iter().flatten() {
        guard.output(&format!("the picture of {}", loaded.name), target.argument())?;
    }
    for (target, loaded) in scenes.iter().flatten() {
        args.aov.check_names(target.argument(), loaded.scene.lights.len(), &guard)?;
    }
    let jobs: Vec<_> =
        scenes.into_iter().map(|scene| scene.and_then(|(target, loaded)| job(args, loaded, target))).collect();
    let mut all_stats = Vec::new();
    let mut code = OK;
    // A scene that cannot be rendered is the better message where there is no device either.
    let gpu = match (gpu, jobs.as_slice()) {
        (Err(_), [Err(_)]) => None,
        (gpu, _) => gpu?.map(|gpu| gpu.having(ahead)),
    };
    for job in jobs {
        let rendered = job.and_then(|job| {
            let path = job.target.argument().to_owned();
            guard.check_unwritten(&format!("the picture of {}", job.loaded.name), &path)?;
            let stats = render_one(args, &settings, job, gpu.as_ref(), &mut guard, [open_time, ready_time])?;
            guard.written(&path);
            Ok(stats)
        });
        match rendered {
            Ok(stats) => all_stats.extend(stats),
            Err(failure) => {
                args.progress.say_failed(&failure);
                let failed = failure.report();
                // What was stopped is to be repeated, whatever else there was.
                code = if code == OK || failed == STOPPED { failed } else { code };
                if [DEVICE_LOST, STOPPED].contains(&failed) {
                    break;
                }
            }
        }
    }
    if let Some(path) = &args.stats_json {
        write_stats(path, &all_stats)?;
    }
    timeline.map_or(Ok(()), Timeline::write)?;
    // The files are complete, and the process ends: closing a device takes some milliseconds and gains nothing. But drivers
    // may still be writing compiled kernels to their cache; where any can have been compiled, they are waited for.
    let is_software = gpu.as_ref().is_some_and(|gpu| gpu.device.info.kind == DeviceKind::Software);
    if is_software && all_stats.iter().all(|stats| stats.times.compile_ms < MAYBE_COMPILED_MS) {
        std::mem::forget(gpu);
    }
    Ok(code)
}

/// Refuses a certificate of what is not certified.
fn check_certificate(args: &Args) -> Result<(), Failure> {
    let why = if args.certificate.is_none() {
        return Ok(());
    } else if args.scenes.len() > 1 {
        "--certificate takes one scene"
    } else if args.sampling.is_given() {
        "--certificate is of whole pictures: pixels that are filled are not certified"
    } else if args.device.uses_vulkan() && args.device.precision != Request::Certified {
        "--certificate needs a certified picture\n  help: --precision certified"
    } else {
        return Ok(());
    };
    Err(Failure::new(USAGE, why))
}

impl Args {
    /// The first of the scene files.
    pub(super) fn first_scene(&self) -> Option<&Path> {
        self.scenes.first().map(PathBuf::as_path)
    }

    /// How progress is shown.
    fn progress_style(&self) -> Style {
        // A scheduler reads it, no user.
        if self.quiet && self.progress != Style::Openjd { Style::None } else { self.progress }
    }

    /// What is wanted beside 8-bit levels of a picture that is written like this.
    fn options(&self, coding: Coding) -> Options {
        let wants_stats = self.stats || self.stats_json.is_some();
        Options { linear: coding.is_linear(), count_rays: wants_stats && !self.no_ray_counts, ..Options::default() }
    }

    /// What of this scene can be done before the device is open.
    fn ahead(&self, scene: &Scene, settings: &Settings) -> Option<Ahead> {
        if !self.device.uses_vulkan() {
            return None;
        }
        let viewed = scene.viewed(settings);
        let effects = self.picture.renderable_effects(&viewed).ok()?;
        Ahead::of(&viewed, &effects, self.device.precision)
    }
}

/// A software driver that takes less than this has found its kernels in its cache.
const MAYBE_COMPILED_MS: f64 = 40.0;

fn render_one(
    args: &Args,
    settings: &Settings,
    Job { mut loaded, target, coding }: Job,
    gpu: Option<&Gpu>,
    guard: &mut Guard,
    [open_time, ready_time]: [Duration; 2],
) -> Result<Option<Stats>, Failure> {
    let _span = tracing::info_span!("picture", scene = %loaded.name).entered();
    let start = Instant::now();
    let doubts = args.picture.frame_with_doubts(&mut loaded.scene, settings)?;
    if !args.quiet {
        print_doubts(&loaded.name, &doubts);
    }
    let scene = &loaded.scene;
    let choice = args.sampling.choice((scene.width, scene.height))?;
    let area = args.part.area((scene.width, scene.height))?;
    coding.check_size(area.size())?;
    let viewed = scene.viewed(settings).within(area)?;
    let effects = args.picture.renderable_effects(&viewed)?;
    let selection = args.device.selection(gpu, &viewed, &effects).with_colors(coding.is_linear());
    if args.explain || args.verbose {
        explain(&loaded.name, &effects, &selection, choice.as_ref(), gpu);
    }
    let backend = Backend::of(gpu, &selection);
    let levels = (settings.quantize, scene.background);
    let bar = args.color_bar.bar(&loaded.name, loaded.color_scale.as_ref(), area.size(), levels)?;
    let color_bar = bar.as_ref().map(|bar| bar.scale().clone());
    let note = |format| args.part.note(scene, area, (settings, &effects), (gpu, &selection), format);
    let note = coding.levels().map_or(Ok(None), note)?;
    if note.as_ref().map_or(Ok(false), |note| note.is_done(&target, args.quiet))? {
        return Ok(None);
    }

    let mut beside = Beside::new(&args.aov, args.show, &viewed, &effects, backend)?;
    let mut renderer = Renderer::new(args, choice, backend, viewed, &effects, coding)?;
    let mut certificate =
        CertificateFile::new(args.certificate.as_deref(), scene, coding.hash_bits(), settings.quantize);
    // The renderer has what it needs: the spheres go before paths and pixels take memory.
    let ((width, height), spheres, lights) = (area.size(), scene.spheres.len(), scene.lights.len());
    drop(loaded.scene);

    let note = note.as_ref().map(|note| note.line.as_str());
    let mut writer = Film::new(coding, &target, (width, height), note, levels, bar)?;
    let mut write_time = Duration::ZERO;
    let mut progress = Progress::of_rows(args.progress_style(), &loaded.name, height);
    let mut sampled = None;
    let not_finite = match &mut renderer {
        Renderer::InPart(engine, choice) => {
            let Choice { density, fill } = *choice;
            let samples = Samples::new((width, height), &density)?;
            let picture = render_partial(engine, backend, &samples, fill, |part| progress.set(part))?;
            let start = Instant::now();
            let written = writer.write(&picture.rgb, &[])?;
            beside.add(&picture.rgb, &written);
            write_time += start.elapsed();
            sampled = Some(Sampled { density, fill, pixels: samples.pixels().len() as u64, fill_ms: picture.fill_ms });
            picture.not_finite
        }
        Renderer::Whole(engine) => render_bands(engine, |band| {
            let start = Instant::now();
            let written = writer.write(band.rgb, band.linear)?;
            write_time += start.elapsed();
            certificate.add(band.rgb, band.linear);
            beside.add(band.rgb, &written);
            let rows = band.rgb.len() / (width as usize * 3);
            progress.set((f64::from(band.first) + rows as f64) / f64::from(height));
            Ok::<_, Failure>(())
        })?,
    };
    let Noted { rays, times, verified, cut, stages } = match &renderer {
        Renderer::Whole(engine) => Noted::by(engine),
        Renderer::InPart(engine, _) => Noted::by(engine),
    };
    let finishing = Instant::now();
    tracing::info_span!("finish file").in_scope(|| writer.finish())?;
    progress.finish();
    write_time += finishing.elapsed();

    beside.finish(&loaded.name, (&target, is_named_by_scene(args)), guard, args.quiet)?;
    certificate.write((settings, &effects), gpu, &selection, stages)?;
    say_cut(&loaded.name, if args.quiet { 0 } else { cut }, &device_name(gpu));
    say_not_finite(&loaded.name, not_finite);
    let stats = Stats {
        frame: None,
        scene: loaded.name.clone(),
        output: target.to_string(),
        width,
        height,
        spheres,
        lights,
        device: device_name(gpu),
        tuning: gpu.map(|gpu| gpu.tuned().summary()),
        settings: *settings,
        effects,
        certified: stages.filter(|_| selection.certified || gpu.is_none()),
        precision: gpu.map(|_| selection),
        sampled,
        color_bar,
        rays: rays.filter(|_| !args.no_ray_counts),
        not_finite_pixels: not_finite,
        verified,
        parse_ms: ms(loaded.parse_time),
        open_ms: ms(open_time),
        times,
        write_ms: ms(write_time),
        // Parsing and opening overlap.
        total_ms: ms(loaded.parse_time.max(ready_time) + start.elapsed()),
        peak_memory_mib: peak_memory_mib(),
    };
    tell(args, &stats);
    Ok(Some(stats))
}

/// Prints as much of what was rendered as is wanted.
fn tell(args: &Args, stats: &Stats) {
    if !args.quiet {
        errln!("{}", stats.summary());
    }
    if args.stats || args.verbose {
        err!("{}", stats.table());
    }
}

/// What renders all of the picture, or what renders the part of it that is sampled.
enum Renderer<'a> {
    Whole(Engine<'a>),
    InPart(Engine<'a, Pixels>, Choice),
}

impl<'a> Renderer<'a> {
    fn new(
        args: &Args,
        choice: Option<Choice>,
        backend: Backend<'a>,
        viewed: ViewedScene,
        effects: &Effects,
        coding: Coding,
    ) -> Result<Self, Failure> {
        let options = args.options(coding);
        let verify = args.verify.unwrap_or_else(|| Verify::usual(viewed.scene()));
        Ok(match choice {
            None => Self::Whole(Engine::verified(backend, viewed, effects, &options, verify)?),
            Some(choice) => Self::InPart(Engine::verified(backend, viewed, effects, &options, verify)?, choice),
        })
    }
}

/// What an engine has noted of a picture.
struct Noted {
    rays: Option<Rays>,
    times: Times,
    verified: Option<Verified>,
    cut: u64,
    stages: Option<Stages>,
}

impl Noted {
    fn by<O: Output>(engine: &Engine<O>) -> Self {
        let verified = engine.verification().map(|(pixels, ms)| Verified { pixels, ms });
        Self { rays: engine.rays(), times: engine.times(), verified, cut: engine.cut(), stages: engine.stages() }
    }
}

/// The folder of the file that OUTPUT names, where it does.
fn folder(args: &Args) -> Option<&Path> {
    match &args.output {
        None => Some(Path::new("")),
        Some(path) => path.is_dir().then_some(path),
    }
}

/// Whether the file is the one that OUTPUT names, and may not be any.
fn is_named_by_scene(args: &Args) -> bool {
    folder(args).is_some() && !args.allow_any_output
}

fn target(args: &Args, loaded: &Loaded) -> Target {
    match (&args.output, folder(args)) {
        (Some(path), None) => Target::from_argument(path.as_os_str()),
        (_, folder) => Target::File(folder.unwrap_or(Path::new("")).join(loaded.output_name())),
    }
}

/// The scene with its target, if that can take a picture.
fn job(args: &Args, loaded: Loaded, target: Target) -> Result<Job, Failure> {
    args.aov.check(&target)?;
    if args.show.is_some() && target == Target::Stdout {
        return Err(Failure::new(USAGE, "--show prints to standard output, which the picture is written to"));
    }
    if let Target::File(path) = &target {
        if is_named_by_scene(args) {
            check_named(path).map_err(|failure| failure.of(&loaded.name))?;
        }
        check_place(path)?;
    }
    let coding = coding_of(args, &target).map_err(|failure| failure.of(&loaded.name))?;
    Ok(Job { loaded, target, coding })
}

/// How the picture is written.
fn coding_of(args: &Args, target: &Target) -> Result<Coding, Failure> {
    let format = match (args.format, target) {
        (Some(format), _) => Ok(format),
        (None, Target::Stdout) => Ok(FileFormat::Levels(Format::default())),
        (None, Target::File(path)) => FileFormat::by_ending(path).map_err(|mut failure| {
            failure.message += "\n  help: --format p6, p3, png, pfm or exr writes that under any name";
            failure
        }),
    };
    let coding = args.linear.coding(format?)?;
    let is_certified = args.device.precision == Request::Certified;
    let all = "PFM, EXR, --bits 16 and --alpha";
    let refused = [
        (is_certified && !coding.has_levels(), "PFM and EXR", "--precision certified, which is of levels"),
        (args.certificate.is_some() && coding.hash_bits().is_none(), "PFM, EXR and --alpha", "--certificate"),
        (args.sampling.is_given() && coding.is_linear(), all, "--foveate or --sparse"),
        (args.part.is_given() && coding.is_linear(), all, "--crop, --tile or --resume"),
    ];
    match refused.into_iter().find(|(is_refused, ..)| *is_refused) {
        Some((_, what, other)) => Err(Failure::new(USAGE, format!("{what} do not go with {other}"))),
        None => Ok(coding),
    }
}

/// Says of how many pixels the device's loops were too short, if of any.
fn say_cut(name: &str, cut: u64, device: &str) {
    if cut > 0 {
        let (name, pixels) = (visible(name), count(cut, "pixel"));
        errln!("trueray: {name}: more turns of a loop than {device} has, so calculated by the CPU reference: {pixels}");
    }
}

/// Says of how many pixels the colour is no number, if of any.
fn say_not_finite(name: &str, pixels: u64) {
    if pixels > 0 {
        errln!("trueray: {}: not finite (NaN or infinity): {}", visible(name), count(pixels, "pixel"));
    }
}

/// Says what is simulated and sampled by which tier, and what the device brings of its own.
fn explain(name: &str, effects: &Effects, selection: &Selection, choice: Option<&Choice>, gpu: Option<&Gpu>) {
    let sampling = choice.map(Choice::explanation).unwrap_or_default();
    err!("{}{}{sampling}", explanation(name, effects), precision_explanation(selection));
    let Some(gpu) = gpu else { return };
    errln!("  tuning       {}", gpu.tuned().summary());
    if let Some(note) = gpu.kernel_cache_note() {
        errln!("  note         {note}");
    }
}

/// The table of effects with their reasons.
pub(super) fn explanation(name: &str, effects: &Effects) -> String {
    let row = |row: &crate::effects::Row| {
        format!("  {:<12} {:<4} {}\n", row.effect, if row.on { "on" } else { "off" }, row.reason)
    };
    let rows: String = effects.rows.iter().map(row).collect();
    format!("{}: effects (depth {})\n{rows}", visible(name), effects.depth)
}

/// What the scene demands and which tier that takes.
pub(super) fn precision_explanation(selection: &Selection) -> String {
    let Selection { reason, demand, .. } = selection;
    format!("  precision    {selection}: {reason}\n  demand       {}\n", demand.summary())
}

fn write_stats(path: &Path, stats: &[Stats]) -> Result<(), Failure> {
    let text = json(&std::collections::BTreeMap::from([("pictures", stats)]))?;
    if path == Path::new("-") {
        err!("{text}");
        return Ok(());
    }
    save(path, &text)
}
