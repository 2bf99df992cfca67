//! `trueray render` and `trueray SCENE.txt`.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::failure::{Failure, OK, OUTPUT, USAGE};
use super::input::{Loaded, print_doubts};
use super::options::{DeviceOptions, PictureOptions, device_name};
use super::output::{err, errln};
use super::progress::{Progress, Style};
use super::sampling::{Choice, SamplingOptions};
use super::stats::{Sampled, Stats, Verified, peak_memory_mib};
use crate::effects::Effects;
use crate::engine::{Backend, Engine, Options, Pixels, render_bands, render_partial};
use crate::film::{Format, PictureWriter, Target};
use crate::gpu::{Ahead, Gpu};
use crate::precision::Selection;
use crate::sampling::Samples;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::threads::at_once;
use crate::verify::Verify;
use crate::words::{count, visible};

/// Arguments of `trueray render`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Scene files; `-` is standard input
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// Picture file, a folder for it, or `-` for standard output; without it the file that OUTPUT names
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// File format: p6, p3 or png; without it the file name's ending decides
    #[arg(long, value_name = "FORMAT")]
    format: Option<Format>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    sampling: SamplingOptions,
    #[command(flatten)]
    device: DeviceOptions,
    /// How many pixels of a device's picture the CPU reference calculates, too: a number, all, or none; without it 64, or none
    /// with more than 200,000 spheres. Where rounding does not explain a difference, there is no picture
    #[arg(long, value_name = "N")]
    verify: Option<Verify>,
    /// Print which effects are simulated, and why
    #[arg(long)]
    explain: bool,
    /// Print device, effects, rays, times and memory
    #[arg(long)]
    stats: bool,
    /// Write the same as JSON; `-` is standard error
    #[arg(long, value_name = "FILE")]
    stats_json: Option<PathBuf>,
    /// Leave the rays out of the statistics: counting them takes time of its own
    #[arg(long)]
    no_ray_counts: bool,
    /// How progress is shown on standard error
    #[arg(long, value_enum, default_value_t = Style::Auto)]
    progress: Style,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
    /// Print more: the effects and the times
    #[arg(short, long, conflicts_with = "quiet")]
    verbose: bool,
}

pub(super) fn run(args: &Args) -> u8 {
    match render_all(args) {
        Ok(code) => code,
        Err(failure) => failure.report(),
    }
}

/// Renders every scene; a scene with errors does not keep the others from being rendered.
fn render_all(args: &Args) -> Result<u8, Failure> {
    if args.scenes.len() > 1 && args.output.as_deref().is_some_and(|output| !output.is_dir()) {
        return Err(Failure::new(USAGE, "several scenes need a folder for -o, or none"));
    }
    let settings = args.picture.settings()?;
    // Opening a device takes longer than reading most scenes: both at once, and what else can be done without one. The device is
    // opened here, since a driver's many allocations are cheaper on the thread whose heap grows in large steps.
    let start = Instant::now();
    let read = || {
        let loaded = Loaded::read(&args.scenes[0], args.quiet);
        let ahead = loaded.as_ref().ok().and_then(|loaded| args.ahead(&loaded.scene, &settings));
        (loaded, ahead)
    };
    let ((first, ahead), (gpu, open_time)) = at_once(read, || (args.device.open_with(args.quiet), start.elapsed()));
    let ready_time = start.elapsed();

    let mut all_stats = Vec::new();
    let mut code = OK;
    let mut first = Some(first);
    // A scene that cannot be read is the better message where there is no device either.
    let gpu = match (gpu, &first) {
        (Err(_), Some(Err(_))) if args.scenes.len() == 1 => None,
        (gpu, _) => gpu?.map(|gpu| gpu.having(ahead)),
    };
    for path in &args.scenes {
        let loaded = first.take().unwrap_or_else(|| Loaded::read(path, args.quiet));
        match loaded.and_then(|loaded| render_one(args, &settings, loaded, gpu.as_ref(), [open_time, ready_time])) {
            Ok(stats) => all_stats.push(stats),
            Err(failure) => {
                let failed = failure.report();
                code = if code == OK { failed } else { code };
                if failed == super::failure::DEVICE_LOST {
                    break;
                }
            }
        }
    }
    if let Some(path) = &args.stats_json {
        write_stats(path, &all_stats)?;
    }
    // The files are complete, and the process ends: closing a device takes some milliseconds and gains nothing. But drivers
    // may still be writing compiled kernels to their cache; where any can have been compiled, they are waited for.
    let is_software = gpu.as_ref().is_some_and(|gpu| gpu.info.kind == "software");
    if is_software && all_stats.iter().all(|stats| stats.times.compile_ms < MAYBE_COMPILED_MS) {
        std::mem::forget(gpu);
    }
    Ok(code)
}

impl Args {
    /// The first of the scene files.
    pub(super) fn first_scene(&self) -> Option<&Path> {
        self.scenes.first().map(PathBuf::as_path)
    }

    /// What of this scene can be done before the device is open.
    fn ahead(&self, scene: &Scene, settings: &Settings) -> Option<Ahead> {
        if !self.device.uses_vulkan() {
            return None;
        }
        let effects = self.picture.renderable_effects(scene, settings).ok()?;
        Ahead::of(scene, settings, &effects, self.device.precision)
    }
}

/// A software driver that takes less than this has found its kernels in its cache.
const MAYBE_COMPILED_MS: f64 = 40.0;

fn render_one(
    args: &Args,
    settings: &Settings,
    mut loaded: Loaded,
    gpu: Option<&Gpu>,
    [open_time, ready_time]: [Duration; 2],
) -> Result<Stats, Failure> {
    let start = Instant::now();
    if !args.quiet {
        print_doubts(&loaded.name, &args.picture.doubts(&loaded.scene, settings));
    }
    args.picture.resize(&mut loaded.scene);
    let scene = &loaded.scene;
    let (target, format) = target(args, &loaded)?;
    let choice = args.sampling.choice((scene.width, scene.height))?;
    let effects = args.picture.renderable_effects(scene, settings)?;
    let selection = args.device.selection(gpu, scene, settings, &effects);
    if args.explain || args.verbose {
        let sampling = choice.as_ref().map(Choice::explanation).unwrap_or_default();
        err!("{}{}{sampling}", explanation(&loaded.name, &effects), precision_explanation(&selection));
        if let Some(gpu) = gpu {
            errln!("  tuning       {}", gpu.tuned().summary());
            if let Some(note) = gpu.kernel_cache_note() {
                errln!("  note         {note}");
            }
        }
    }
    let backend = gpu.map_or(Backend::Reference, |gpu| Backend::Device(gpu, selection.tier));

    let wants_stats = args.stats || args.stats_json.is_some();
    let options = Options { count_rays: wants_stats && !args.no_ray_counts, ..Options::default() };
    let verify = args.verify.unwrap_or_else(|| Verify::usual(scene));
    let mut renderer = match choice {
        None => Renderer::Whole(Engine::verified(backend, scene, settings, &effects, &options, verify)?),
        Some(choice) => {
            Renderer::InPart(Engine::verified(backend, scene, settings, &effects, &options, verify)?, choice)
        }
    };
    // The renderer has what it needs: the spheres go before paths and pixels take memory.
    let (width, height) = (scene.width, scene.height);
    let (spheres, lights) = (scene.spheres.len(), scene.lights.len());
    drop(loaded.scene);

    let mut writer = PictureWriter::create(&target, format, width, height)?;
    let mut write_time = Duration::ZERO;
    let mut progress = Progress::new(if args.quiet { Style::None } else { args.progress }, &loaded.name, height);
    let mut sampled = None;
    let not_finite = match &mut renderer {
        Renderer::InPart(engine, Choice { density, fill }) => {
            let (density, fill) = (*density, *fill);
            let samples = Samples::new((width, height), &density)?;
            let whole = f64::from(height);
            let picture = render_partial(engine, backend, &samples, fill, |part| progress.set((part * whole) as u32))?;
            let start = Instant::now();
            writer.write_rows(&picture.rgb)?;
            write_time += start.elapsed();
            let pixels = samples.pixels().len() as u64;
            sampled = Some(Sampled { density, fill, pixels, fill_ms: picture.fill_ms });
            picture.not_finite
        }
        Renderer::Whole(engine) => render_bands(engine, |band| {
            let start = Instant::now();
            writer.write_rows(band.rgb)?;
            write_time += start.elapsed();
            progress.set(band.first);
            Ok::<_, Failure>(())
        })?,
    };
    let (rays, times, verified) = match &renderer {
        Renderer::Whole(engine) => (engine.rays(), engine.times(), engine.verification()),
        Renderer::InPart(engine, _) => (engine.rays(), engine.times(), engine.verification()),
    };
    let cut = match &renderer {
        Renderer::Whole(engine) => engine.cut(),
        Renderer::InPart(engine, _) => engine.cut(),
    };
    drop(progress);
    let finishing = Instant::now();
    writer.finish()?;
    write_time += finishing.elapsed();

    if cut > 0 && !args.quiet {
        let device = device_name(gpu);
        errln!(
            "trueray: {}: more turns of a loop than {device} has, so calculated by the CPU reference: {}",
            visible(&loaded.name),
            count(cut, "pixel")
        );
    }
    if not_finite > 0 {
        let (name, pixels) = (visible(&loaded.name), count(not_finite, "pixel"));
        errln!("trueray: {name}: not finite (NaN or infinity): {pixels}");
    }
    let stats = Stats {
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
        precision: gpu.map(|_| selection),
        sampled,
        rays: rays.filter(|_| !args.no_ray_counts),
        not_finite_pixels: not_finite,
        verified: verified.map(|(pixels, ms)| Verified { pixels, ms }),
        parse_ms: ms(loaded.parse_time),
        open_ms: ms(open_time),
        times,
        write_ms: ms(write_time),
        // Parsing and opening overlap.
        total_ms: ms(loaded.parse_time.max(ready_time) + start.elapsed()),
        peak_memory_mib: peak_memory_mib(),
    };
    if !args.quiet {
        let Stats { width, height, output, device, total_ms, .. } = &stats;
        errln!("{}: {width} × {height} on {device} in {total_ms:.0} ms", visible(output));
    }
    if args.stats || args.verbose {
        err!("{}", stats.table());
    }
    Ok(stats)
}

/// What renders all of the picture, or what renders the part of it that is sampled.
enum Renderer<'a> {
    Whole(Engine<'a>),
    InPart(Engine<'a, Pixels>, Choice),
}

/// Where the picture goes and in which format.
fn target(args: &Args, loaded: &Loaded) -> Result<(Target, Format), Failure> {
    let target = match &args.output {
        None => Target::File(loaded.output_name()),
        Some(folder) if folder.is_dir() => Target::File(folder.join(loaded.output_name())),
        Some(path) => Target::from_argument(path.as_os_str()),
    };
    let format = match &target {
        Target::File(path) => {
            if loaded.is_scene_file(path) {
                let message = format!("{}: the picture would overwrite its own scene file {target}", loaded.name);
                return Err(Failure::new(OUTPUT, message));
            }
            args.format.or_else(|| Format::from_extension(path))
        }
        Target::Stdout => args.format,
    };
    Ok((target, format.unwrap_or_default()))
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
    let Selection { tier, reason, demand, .. } = selection;
    format!("  precision    {tier}: {reason}\n  demand       {}\n", demand.summary())
}

fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

fn write_stats(path: &Path, stats: &[Stats]) -> Result<(), Failure> {
    let document = std::collections::BTreeMap::from([("pictures", stats)]);
    let mut json = serde_json::to_string_pretty(&document).map_err(|error| Failure::new(OUTPUT, error.to_string()))?;
    json.push('\n');
    let written =
        if path == Path::new("-") { std::io::stderr().write_all(json.as_bytes()) } else { std::fs::write(path, json) };
    written.map_err(|error| Failure::new(OUTPUT, format!("cannot write {}: {error}", path.display())))
}
