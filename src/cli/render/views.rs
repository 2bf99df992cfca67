//! `trueray render --views` and `--turntable`: many views in one process.
//!
//! While one frame is rendered, the next is prepared and the last one written, each on a thread of its own.

mod frame_list;
mod pattern;
mod prepare;
mod write;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::Instant;

use self::frame_list::FrameList;
use self::pattern::Pattern;
use self::prepare::{Opened, Prepared, Preparer, Source};
use self::write::{File, Step, Writer};
use super::{Args, Noted, coding_of, folder, write_stats};
use crate::cli::color;
use crate::cli::failure::{Failure, SCENE, USAGE};
use crate::cli::files::check_place;
use crate::cli::guard::Guard;
use crate::cli::input::Loaded;
use crate::cli::linear::{Coding, Film};
use crate::cli::named::check_named;
use crate::cli::output::err;
use crate::cli::timeline::Timeline;
use crate::engine::render_bands;
use crate::film::Target;
use crate::gpu::USUAL_KERNELS;
use crate::threads::{at_once, in_stages};
use crate::view::ViewError;
use crate::views::{Frame, table, turntable};
use crate::words::count;

/// Which views are rendered, where these are many.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Camera")]
pub(super) struct Options {
    /// Render a frame for each row of a CSV file, whose header has some of the names
    /// `eye_x,eye_y,eye_z,at_x,at_y,at_z,up_x,up_y,up_z,width,height,near,left,right,bottom,top,fov,scene`; an empty cell is as in the
    /// options or the scene
    #[arg(long, value_name = "FILE", group = "many")]
    views: Option<PathBuf>,
    /// Render N frames once around the middle of the spheres, or --look-at
    #[arg(long, value_name = "N", group = "many", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    turntable: Option<u32>,
    /// Which of these frames to render, such as 1-50,73
    #[arg(long, value_name = "LIST", requires = "many")]
    frames: Option<FrameList>,
}

/// A frame that is to be rendered, and where it goes.
struct Job {
    /// From 1.
    number: u32,
    frame: Frame,
    path: PathBuf,
    coding: Coding,
}

impl Options {
    /// Whether there may be many.
    pub(super) fn are_given(&self) -> bool {
        self.views.is_some() || self.turntable.is_some()
    }

    /// All frames of `scene`.
    fn all(&self, args: &Args, loaded: &Loaded) -> Result<Vec<Frame>, Failure> {
        let placement = args.picture.placement();
        if let Some(path) = &self.views {
            let name = path.display().to_string();
            let read = std::fs::read(path);
            let text = read.map_err(|error| Failure::new(SCENE, format!("cannot read the views {name}: {error}")))?;
            let folder = path.parent().unwrap_or(Path::new(""));
            return table(&name, folder, &text, &placement, color::is_on(&std::io::stderr())).map_err(|report| {
                err!("{report}");
                Failure::new(SCENE, "")
            });
        }
        let refused = |why: String| Failure::new(USAGE, why);
        let placements = turntable(self.turntable.unwrap_or(1), &loaded.scene, &placement);
        let placements = placements.map_err(|error| refused(error.to_string()))?;
        let views =
            placements.iter().map(|placement| Ok(Frame { fov: placement.fov, ..Frame::seen_by(placement.view()?) }));
        views.collect::<Result<_, ViewError>>().map_err(|error| refused(error.to_string()))
    }

    /// Those that are chosen, with their numbers.
    fn chosen(&self, frames: Vec<Frame>) -> Result<Vec<(u32, Frame)>, Failure> {
        let numbered = (1..).zip(frames);
        let Some(list) = &self.frames else { return Ok(numbered.collect()) };
        let all: Vec<_> = numbered.collect();
        let wanted = list.of(all.len() as u32).map_err(|number| {
            Failure::new(
                USAGE,
                format!("--frames: there is no frame {number}, but {}", count(all.len() as u64, "frame")),
            )
        })?;
        Ok(all.into_iter().filter(|(number, _)| wanted.binary_search(number).is_ok()).collect())
    }
}

/// Renders all frames; one that cannot be rendered does not keep the others from being rendered.
pub(super) fn run(args: &Args) -> Result<u8, Failure> {
    check(args)?;
    let settings = args.picture.settings()?;
    let reading = match args.views.turntable {
        Some(_) => args.particles.all_sides(&args.picture)?,
        None => args.particles.one_frame(&args.picture)?,
    };
    let timeline = args.timeline.as_deref().map(Timeline::begin);
    let start = Instant::now();
    let read = || {
        let loaded = Loaded::read(&args.scenes[0], &reading, args.quiet)?;
        let all = args.views.all(args, &loaded)?;
        // Those of frames that are not chosen are no outputs either.
        let scenes: BTreeSet<_> = all.iter().filter_map(|frame| frame.scene.clone()).collect();
        let frames = args.views.chosen(all)?;
        let ahead = args.ahead(&loaded.scene, &settings);
        Ok::<_, Failure>((loaded, frames, scenes, ahead))
    };
    let (read, (gpu, open_time)) = at_once(read, || (args.device.open_with(args.quiet), start.elapsed()));
    let (loaded, frames, scenes, ahead) = read?;
    let opened = Opened { gpu: gpu?.map(|gpu| gpu.having(ahead).keeping_kernels(USUAL_KERNELS)), time: open_time };

    let mut guard = Guard::new(args.scenes.iter().chain(&args.views.views).chain(&scenes));
    if let Some(path) = args.stats_json.as_deref().filter(|path| *path != Path::new("-")) {
        check_place(path)?;
        guard.output("--stats-json", path)?;
    }
    guard.options([("--timeline", &args.timeline)])?;
    let jobs = jobs(args, &loaded, frames, &mut guard)?;
    let (name, total) = (loaded.name.clone(), jobs.len() as u32);
    let (stop, lost) = (AtomicBool::new(false), AtomicU32::new(0));
    let mut preparer = Preparer::new(args, &settings, &opened, Source::new(loaded, args.picture.resolution()), jobs);
    let mut writer = Writer::new(args, guard, &name, total, (&stop, &lost));
    let render = |prepared, hand_on: &mut dyn FnMut(Step)| render(args, prepared, &lost, hand_on);
    in_stages(|| preparer.next(&stop), render, |step| writer.take(step));
    let (stats, code) = writer.finish(start.elapsed());
    if let Some(path) = &args.stats_json {
        write_stats(path, &stats)?;
    }
    timeline.map_or(Ok(()), Timeline::write)?;
    Ok(code)
}

/// Refuses what is of one picture.
fn check(args: &Args) -> Result<(), Failure> {
    let refused = [
        (args.scenes.len() > 1, "several scenes: the views file has a column `scene`"),
        (args.certificate.is_some(), "--certificate"),
        (args.aov.is_given(), "--aov"),
        (args.show.is_some(), "--show"),
        (args.sampling.is_given(), "--foveate or --sparse"),
        (args.part.is_part(), "--crop or --tile"),
    ];
    match refused.into_iter().find(|(is_given, _)| *is_given) {
        Some((_, what)) => Err(Failure::new(USAGE, format!("--views and --turntable do not go with {what}"))),
        None => Ok(()),
    }
}

/// The frames with their files, none of which is in another's way.
fn jobs(args: &Args, loaded: &Loaded, frames: Vec<(u32, Frame)>, guard: &mut Guard) -> Result<Vec<Job>, Failure> {
    let help = "help: -o frame_%04d.png gives frame_0001.png and so on";
    let refused = |why: String| Failure::new(USAGE, format!("{why}\n  {help}"));
    let folder = folder(args);
    let pattern = match (&args.output, folder) {
        (Some(path), None) if path == Path::new("-") => Err(refused("frames do not go to standard output".into())),
        (Some(path), None) => {
            Pattern::of(path).map_err(|why| refused(format!("-o {} names no frames: {why}", path.display())))
        }
        (_, folder) => Pattern::numbered(&folder.unwrap_or(Path::new("")).join(loaded.output_name()))
            .ok_or_else(|| refused("the name that OUTPUT gives is not UTF-8".into())),
    }?;
    let job = |(number, frame): (u32, Frame)| {
        let path = pattern.path(number);
        if folder.is_some() && !args.allow_any_output {
            check_named(&path)?;
        }
        check_place(&path)?;
        guard.output(&format!("frame {number}"), &path)?;
        let coding = coding_of(args, &Target::File(path.clone()))?;
        Ok(Job { number, frame, path, coding })
    };
    frames.into_iter().map(job).collect()
}

/// Renders a frame and hands on what becomes of it; one whose file has failed, which `lost` tells, is not rendered on.
fn render(args: &Args, prepared: Result<Option<Prepared>, Failure>, lost: &AtomicU32, hand_on: &mut dyn FnMut(Step)) {
    let Prepared { target, coding, note, levels, bar, mut engine, mut stats, start } = match prepared {
        Ok(Some(prepared)) => prepared,
        Ok(None) => return hand_on(Step::There),
        Err(failure) => return hand_on(Step::Failed(failure)),
    };
    let number = stats.frame.unwrap_or_default();
    let failed = |failure: Failure| Step::Failed(failure.of(&frame_name(number)));
    let (opening, path) = (Instant::now(), target.argument().to_owned());
    // A band can take minutes: whether there is a file for it is to be known before.
    match Film::new(coding, &target, engine.size(), note.as_deref(), levels, bar) {
        Ok(writer) => hand_on(Step::Begin(Box::new(File { number, path, writer, took: opening.elapsed() }))),
        Err(error) => return hand_on(failed(error.into())),
    }
    let rendered = render_bands(&mut engine, |band| {
        hand_on(Step::Rows { rgb: band.rgb.to_vec(), linear: band.linear.to_vec() });
        if lost.load(Ordering::Relaxed) == number { Err(None) } else { Ok(()) }
    });
    let not_finite = match rendered {
        Ok(not_finite) => not_finite,
        Err(None) => return,
        Err(Some(error)) => return hand_on(failed(error.into())),
    };
    let Noted { rays, times, verified, cut, stages } = Noted::by(&engine);
    stats.rays = rays.filter(|_| !args.no_ray_counts);
    stats.certified = stages.filter(|_| stats.precision.as_ref().is_none_or(|selection| selection.certified));
    (stats.times, stats.verified, stats.not_finite_pixels) = (times, verified, not_finite);
    hand_on(Step::End { stats, cut, start });
}

/// What a frame is called in messages.
fn frame_name(number: u32) -> String {
    format!("frame {number}")
}
