//! `trueray grade`.

use std::ffi::OsStr;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use serde::Serialize;

use super::compare::{device_of_unknown, judge_of_unknown};
use super::failure::{DIFFERENT, Failure, OK, OUTPUT, USAGE};
use super::files::{command, save, save_report, seconds};
use super::guard::Guard;
use super::input::Loaded;
use super::options::{DeviceOptions, PictureOptions};
use super::output::{errln, out};
use super::particles::Reading;
use super::progress::{Progress, Style};
use super::signals::{say_last, say_nothing};
use crate::cpu::Judge;
use crate::effects::Effects;
use crate::film::Leniency;
use crate::gpu::Gpu;
use crate::grade::{
    Assignment, Extra, FULL, Folder, Graded, Manner, Pages, Row, Sought, Student, Verdict, csv, overview, students,
    table,
};
use crate::scene::Scene;
use crate::settings::Settings;
use crate::threads::lock;
use crate::words::{visible, visible_path};

/// Arguments of `trueray grade`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Folder of scene files, `*.txt`
    #[arg(long, value_name = "FOLDER", help_heading = "Scene")]
    scenes: PathBuf,
    /// Folder of pictures (PPM or PNG), each with the name of its scene or of that scene's OUTPUT; where no picture lies in it, its
    /// subfolders are students
    #[arg(long, value_name = "FOLDER", help_heading = "Pictures")]
    theirs: PathBuf,
    /// Repair malformed pictures instead of refusing them
    #[arg(long, help_heading = "Pictures")]
    lenient: bool,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    device: DeviceOptions,
    /// Do not look for the mistakes that make pictures what they are, which takes most of the time
    #[arg(long, help_heading = "Output")]
    no_explain: bool,
    /// Time for looking for mistakes, of all pictures together, in seconds; those that are left when it is over are graded without
    #[arg(long, value_name = "S", default_value_t = 45.0, value_parser = seconds, help_heading = "Output")]
    explain_seconds: f64,
    /// Write an overview, and a page for each picture into the folder `NAME_files` beside it
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    html: Option<PathBuf>,
    /// Write a record a picture as CSV; `-` is standard output
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    csv: Option<PathBuf>,
    /// Write everything as JSON; `-` is standard output
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    json: Option<PathBuf>,
    /// How progress is shown on standard error
    #[arg(long, value_enum, default_value_t = Style::Auto, help_heading = "Output")]
    progress: Style,
}

/// What `--json` writes.
#[derive(Serialize)]
struct Report<'a> {
    command: &'a str,
    /// Whether a signal ended the run before all pictures were graded.
    interrupted: bool,
    full: usize,
    rows: &'a [Row],
    students: &'a [Student],
    not_graded: &'a [Extra],
}

/// A scene whose pictures are to be graded.
struct Task {
    /// The file's name without its ending.
    stem: String,
    scene: Scene,
    effects: Effects,
    judge: Judge,
}

impl Task {
    fn read(args: &Args, file: &Path, settings: &Settings, gpu: Option<&Gpu>) -> Result<Self, Failure> {
        let Loaded { name, mut scene, .. } = Loaded::read(file, &Reading::usual(&args.picture)?, true)?;
        args.picture.frame(&mut scene)?;
        let viewed = scene.viewed(settings);
        let effects = args.picture.renderable_effects(&viewed).map_err(|failure| failure.of(&name))?;
        let judge = judge_of_unknown(&args.device, gpu, &viewed, &effects);
        drop(viewed);
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { stem, scene, effects, judge })
    }

    fn sought(&self) -> Sought {
        Sought { stem: self.stem.clone(), output: self.scene.output.clone() }
    }
}

pub(super) fn run(args: &Args) -> Result<u8, Failure> {
    let files = scene_files(&args.scenes)?;
    if args.html.as_deref() == Some(Path::new("-")) {
        return Err(Failure::new(USAGE, "--html needs a file: the pages of the pictures go beside it"));
    }
    let settings = args.picture.settings()?;
    let gpu = device_of_unknown(&args.device)?;
    let tasks =
        files.iter().map(|file| Task::read(args, file, &settings, gpu.as_ref())).collect::<Result<Vec<_>, _>>()?;
    let sought: Vec<_> = tasks.iter().map(Task::sought).collect();
    let unreadable = |error: std::io::Error| Failure::new(USAGE, format!("{}: {error}", visible_path(&args.theirs)));
    let Folder { submissions, extras } = Folder::read(&args.theirs, &sought).map_err(unreadable)?;
    let pictures = submissions.iter().flat_map(|submission| submission.pictures.iter().flatten());
    Guard::new(files.iter().chain(pictures)).options([
        ("--html", &args.html),
        ("--csv", &args.csv),
        ("--json", &args.json),
    ])?;

    let manner = Manner {
        leniency: if args.lenient { Leniency::Lenient(settings.quantize) } else { Leniency::Strict },
        explain: None,
        pages: args.html.is_some(),
    };
    let pages = args.html.as_deref().map(Pages::of);
    if let Some(pages) = &pages {
        let failed = |error| Failure::new(OUTPUT, format!("cannot make {}: {error}", visible_path(pages.folder())));
        fs::create_dir_all(pages.folder()).map_err(failed)?;
    }
    let command = command();
    let mut progress = Progress::new(args.progress, "grade");
    let (scenes, number) = (tasks.len(), submissions.len());
    let grades = Arc::new(Mutex::new(Grades {
        command: command.clone(),
        html: args.html.clone(),
        csv: args.csv.clone(),
        json: args.json.clone(),
        rows: Vec::new(),
        extras,
    }));
    let last = Arc::clone(&grades);
    say_last(move || {
        errln!("trueray: interrupted; what was graded is written");
        if let Err(failure) = lock(&last).write(true) {
            failure.report();
        }
    });
    let mut done = 0;
    let time = Duration::try_from_secs_f64(args.explain_seconds).unwrap_or(Duration::MAX);
    let mut explaining = Duration::ZERO;
    // A reference is there once, for all students.
    for (of_scene, Task { stem, scene, effects, judge }) in tasks.into_iter().enumerate() {
        let assignment = Assignment::new(stem, scene, settings, effects, judge)?;
        for (of_student, submission) in submissions.iter().enumerate() {
            progress.set(f64::from(done) / (scenes * number) as f64);
            let picture = submission.pictures[of_scene].as_deref();
            let left = time.saturating_sub(explaining);
            let explain = (!args.no_explain && !left.is_zero()).then_some(left);
            let start = Instant::now();
            let Graded { mut row, shown } =
                assignment.grade(submission.student.as_deref(), picture, Manner { explain, ..manner });
            if explain.is_some() {
                explaining += start.elapsed();
            } else if !args.no_explain && row.verdict == Verdict::Different {
                row.detail = Some(format!("no cause was sought: the {} s for that are over", args.explain_seconds));
            }
            let place = of_student * scenes + of_scene;
            if let (Some(pages), Some(shown)) = (&pages, shown) {
                let name = Pages::file_name(place + 1, &row);
                save(&pages.folder().join(&name), &shown.html(&row, &assignment, &command)?)?;
                row.page = Some(pages.link(&name));
            }
            lock(&grades).rows.push((place, row));
            done += 1;
        }
    }
    progress.finish();
    say_nothing();
    let full = lock(&grades).write(false)?;
    Ok(if full == scenes * number { OK } else { DIFFERENT })
}

/// Grades so far, and where they are written.
struct Grades {
    command: String,
    html: Option<PathBuf>,
    csv: Option<PathBuf>,
    json: Option<PathBuf>,
    /// Rows with their places.
    rows: Vec<(usize, Row)>,
    extras: Vec<Extra>,
}

impl Grades {
    /// Writes what there is, and returns how many rows have the full score.
    fn write(&mut self, interrupted: bool) -> Result<usize, Failure> {
        let Self { command, html, csv: csv_file, json, rows, extras } = self;
        rows.sort_by_key(|(place, _)| *place);
        let rows: Vec<Row> = rows.iter().map(|(_, row)| row.clone()).collect();
        let students = students(&rows);
        let full = rows.iter().filter(|row| row.score == FULL).count();
        if ![&*csv_file, &*json].into_iter().flatten().any(|path| path == Path::new("-")) {
            out!("{}", report(&rows, &students, extras, full));
        }
        if let Some(path) = html {
            save(path, &overview(&rows, &students, extras, interrupted, command))?;
        }
        if let Some(path) = csv_file {
            save(path, &csv(&rows))?;
        }
        if let Some(path) = json {
            let report = Report { command, interrupted, full, rows: &rows, students: &students, not_graded: extras };
            save_report(path, &report)?;
        }
        Ok(full)
    }
}

/// The scene files of a folder, by name.
fn scene_files(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let refused = |why: String| Failure::new(USAGE, format!("{}: {why}", visible_path(folder)));
    let entries = fs::read_dir(folder).map_err(|error| refused(error.to_string()))?;
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| refused(error.to_string()))?.path();
        if path.extension() == Some(OsStr::new("txt")) && path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    if files.is_empty() { Err(refused("no scene file, *.txt, lies there".into())) } else { Ok(files) }
}

/// The table, means and what is not graded.
fn report(rows: &[Row], students: &[Student], extras: &[Extra], full: usize) -> String {
    let mut text = table(rows);
    // Of one picture each the mean says nothing new.
    if students.len() > 1 && rows.len() > students.len() {
        text += "\nmean\n";
        for Student { student, score } in students {
            let _ = writeln!(text, "{score:>6.1}  {}", visible(student));
        }
    }
    if !extras.is_empty() {
        text += "\nnot graded\n";
        for Extra { picture, reason } in extras {
            let _ = writeln!(text, "  {}: {}", visible(picture), visible(reason));
        }
    }
    text + &format!("\nfull score  {full} of {}\n", rows.len())
}
