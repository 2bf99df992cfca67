//! From a frame to a renderer that has all it needs.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use glam::DVec3;

use super::{Args, Job, frame_name};
use crate::cli::failure::{Failure, SCENE};
use crate::cli::input::{Loaded, print_doubts};
use crate::cli::linear::Coding;
use crate::cli::render::explain;
use crate::cli::stats::Stats;
use crate::color_bar::ColorBar;
use crate::doubts::doubts;
use crate::effects::Effects;
use crate::engine::{Backend, Engine, Times, device_name, ms};
use crate::film::Target;
use crate::gpu::Gpu;
use crate::import::{ColorScale, Lamps};
use crate::kept::Kept;
use crate::scene::{Scene, Window};
use crate::settings::{Quantize, Settings};
use crate::verify::Verify;
use crate::views::Frame;

/// What renders, and how long it took to open.
pub(super) struct Opened {
    pub(super) gpu: Option<Gpu>,
    pub(super) time: Duration,
}

/// A frame that is ready to be rendered.
pub(super) struct Prepared<'a> {
    pub(super) target: Target,
    pub(super) coding: Coding,
    /// What the file says of itself.
    pub(super) note: Option<String>,
    /// How colours become levels, and the background.
    pub(super) levels: (Quantize, DVec3),
    /// What is drawn over the picture.
    pub(super) bar: Option<ColorBar>,
    pub(super) engine: Engine<'a>,
    /// What is known of it so far.
    pub(super) stats: Box<Stats>,
    /// When its preparation began.
    pub(super) start: Instant,
}

/// A scene that frames show, with what it has where a frame says nothing else.
pub(super) struct Source {
    name: String,
    scene: Scene,
    window: Window,
    size: [u32; 2],
    /// The scene file's own size.
    file_size: [u32; 2],
    /// Lights that turn with the eye, where it has such.
    lamps: Option<Lamps>,
    color_scale: Option<ColorScale>,
    /// What its frames share.
    kept: Kept,
    /// Reading and parsing; of the first frame that shows it.
    parse_time: Duration,
}

impl Source {
    /// With a size in place of its own, where there is one.
    pub(super) fn new(loaded: Loaded, size: Option<(u32, u32)>) -> Self {
        let Loaded { name, scene, lamps, color_scale, parse_time, .. } = loaded;
        let file_size = [scene.width, scene.height];
        let size = size.map_or(file_size, <[u32; 2]>::from);
        let (window, kept) = (scene.window, Kept::default());
        Self { name, scene, window, size, file_size, lamps, color_scale, kept, parse_time }
    }
}

/// Prepares frame after frame.
pub(super) struct Preparer<'a> {
    args: &'a Args,
    settings: &'a Settings,
    gpu: Option<&'a Gpu>,
    /// Of the first frame.
    open_time: Duration,
    own: Source,
    /// The last of the other scenes, and its file.
    other: Option<(PathBuf, Source)>,
    jobs: std::vec::IntoIter<Job>,
    /// What was said of the last frame.
    doubts: Vec<String>,
    explained: Option<Effects>,
}

impl<'a> Preparer<'a> {
    pub(super) fn new(args: &'a Args, settings: &'a Settings, opened: &'a Opened, own: Source, jobs: Vec<Job>) -> Self {
        let (gpu, open_time, jobs) = (opened.gpu.as_ref(), opened.time, jobs.into_iter());
        Self { args, settings, gpu, open_time, own, other: None, jobs, doubts: Vec::new(), explained: None }
    }

    /// The next frame, unless there is none or it is time to stop; none of it where its file is there already.
    pub(super) fn next(&mut self, stop: &AtomicBool) -> Option<Result<Option<Prepared<'a>>, Failure>> {
        let job = self.jobs.next().filter(|_| !stop.load(Ordering::Relaxed))?;
        let name = frame_name(job.number);
        let prepared = self.prepared(job).map_err(|failure| match failure.message.as_str() {
            // What is wrong is said already.
            "" => Failure::new(failure.code, format!("{name}: its scene cannot be rendered")),
            _ => failure.of(&name),
        });
        Some(prepared)
    }

    fn prepared(&mut self, Job { number, frame, path, coding }: Job) -> Result<Option<Prepared<'a>>, Failure> {
        let _span = tracing::info_span!("prepare frame", frame = number).entered();
        let start = Instant::now();
        let (args, gpu) = (self.args, self.gpu);
        let source = match &frame.scene {
            None => &mut self.own,
            Some(path) => other(&mut self.other, path, args)?,
        };
        let Source { name, scene, lamps, color_scale, .. } = source;
        let settings = Settings { view: frame.view, ..*self.settings };
        frame.apply(scene, source.window, source.size);
        if let Some(lamps) = lamps {
            scene.lights = lamps.seen_by(&frame.view);
        }
        if scene.window != source.window {
            scene.check().map_err(|error| Failure::new(SCENE, error.to_string()))?;
        }
        if !args.quiet {
            // Said once for all frames of which there is the same to say.
            let found = doubts_of(scene, &frame, source.file_size, &settings);
            if found != self.doubts {
                print_doubts(&format!("{name}: {}", frame_name(number)), &found);
                self.doubts = found;
            }
        }
        let viewed = scene.viewed_again(&settings, &source.kept);
        let effects = args.picture.renderable_effects(&viewed)?;
        let selection = args.device.selection(gpu, &viewed, &effects).with_colors(coding.is_linear());
        if (args.explain || args.verbose) && self.explained.as_ref() != Some(&effects) {
            explain(&format!("{name}: {}", frame_name(number)), &effects, &selection, None, gpu);
            self.explained = Some(effects.clone());
        }
        let target = Target::File(path);
        let area = args.part.area((scene.width, scene.height))?;
        coding.check_size(area.size())?;
        let note = |format| args.part.note(scene, area, (&settings, &effects), (gpu, &selection), format);
        let note = coding.levels().map_or(Ok(None), note)?;
        let levels = (settings.quantize, scene.background);
        let bar = args.color_bar.bar(name, color_scale.as_ref(), area.size(), levels)?;
        if note.as_ref().map_or(Ok(false), |note| note.is_done(&target, true))? {
            return Ok(None);
        }
        let options = args.options(coding);
        let verify = args.verify.unwrap_or_else(|| Verify::usual(scene));
        let engine = Engine::verified(Backend::of(gpu, &selection), viewed, &effects, &options, verify)?;
        let stats = Box::new(Stats {
            frame: Some(number),
            scene: name.clone(),
            output: target.to_string(),
            width: scene.width,
            height: scene.height,
            spheres: scene.spheres.len(),
            lights: scene.lights.len(),
            device: device_name(gpu),
            tuning: gpu.map(|gpu| gpu.tuned().summary()),
            settings,
            effects,
            certified: None,
            precision: gpu.map(|_| selection),
            sampled: None,
            color_bar: bar.as_ref().map(|bar| bar.scale().clone()),
            rays: None,
            not_finite_pixels: 0,
            verified: None,
            parse_ms: ms(std::mem::take(&mut source.parse_time)),
            open_ms: ms(std::mem::take(&mut self.open_time)),
            times: Times::default(),
            write_ms: 0.0,
            total_ms: 0.0,
            peak_memory_mib: None,
        });
        Ok(Some(Prepared { target, coding, note: note.map(|note| note.line), levels, bar, engine, stats, start }))
    }
}

/// What can hardly be meant, where the scene's file says another size.
fn doubts_of(scene: &mut Scene, frame: &Frame, file_size: [u32; 2], settings: &Settings) -> Vec<String> {
    let size = [scene.width, scene.height];
    [scene.width, scene.height] = file_size;
    let found = doubts(scene, settings, (size != file_size && frame.fov.is_none()).then_some(size.into()));
    [scene.width, scene.height] = size;
    found
}

/// The scene in this file, which is read unless it was that of the last frame with another.
fn other<'s>(kept: &'s mut Option<(PathBuf, Source)>, path: &Path, args: &Args) -> Result<&'s mut Source, Failure> {
    if kept.as_ref().is_none_or(|(known, _)| known != path) {
        // The last one goes before the next takes memory.
        *kept = None;
        let reading = args.particles.one_frame(&args.picture)?;
        let loaded = Loaded::read(path, &reading, args.quiet)?;
        *kept = Some((path.to_owned(), Source::new(loaded, args.picture.resolution())));
    }
    kept.as_mut().map(|(_, source)| source).ok_or_else(|| Failure::new(SCENE, ""))
}
