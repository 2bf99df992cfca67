//! `trueray conform`.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use serde::Serialize;

use super::failure::{BROKEN, DEVICE_LOST, DIFFERENT, Failure, NO_DEVICE, OK, OUTPUT, USAGE};
use super::files::{save, save_report};
use super::guard::Guard;
use super::options::open_device;
use super::output::{errln, out, outln};
use super::progress::{Progress, Style};
use super::signals::{say_last, say_nothing};
use crate::conform::{
    Baseline, BuiltIn, Check, Former, Key, Pair, Plan, Report, Run, SCENES, Verdict, diff, diff_table, head, junit,
    line, run as run_plan, summary,
};
use crate::gpu::{Choice, DeviceInfo, Gpu, USUAL_KERNELS};
use crate::origin::origin;
use crate::stress::classes;
use crate::threads::lock;
use crate::words::{visible, visible_path};

/// Arguments of `trueray conform`.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Checks")]
pub(super) struct Args {
    /// Vulkan devices, one after another: gpu for the best one, an index of `trueray devices`, part of a name or driver, or a PCI id
    #[arg(
        long,
        value_name = "DEVICE",
        num_args = 1..,
        value_delimiter = ',',
        default_value = "gpu",
        help_heading = "Device"
    )]
    device: Vec<Choice>,
    /// Scenes, folders of them and classes of hard cases; all without it
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    only: Vec<String>,
    /// Rays of each case of a class
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(64..=10_000_000))]
    count: u32,
    /// Seed of the random numbers
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Known flaws: a file that --json has written. They must still be flaws, and no others may be
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// Compare two runs that --json has written, or the two devices of one, and end
    #[arg(long, value_name = "FILE", num_args = 1..=2, conflicts_with_all = ["device", "only", "count", "seed", "baseline", "junit", "list", "write"])]
    diff: Vec<PathBuf>,
    /// List the scenes and classes, and end
    #[arg(long, help_heading = "Output")]
    list: bool,
    /// Write the built-in scenes into a folder, and end
    #[arg(long, value_name = "FOLDER", help_heading = "Output")]
    write: Option<PathBuf>,
    /// Write everything as JSON; `-` is standard output
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    json: Option<PathBuf>,
    /// Write `JUnit` XML; `-` is standard output
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    junit: Option<PathBuf>,
    /// How progress is shown on standard error
    #[arg(long, value_enum, default_value_t = Style::Auto, help_heading = "Output")]
    progress: Style,
}

impl Args {
    /// Whether a scene, or a class, is asked for.
    fn means(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|only| is_of(name, only))
    }

    fn plan(&self) -> Result<Plan, Failure> {
        let all = || SCENES.iter().map(|scene| scene.name).chain(classes().into_iter().map(|class| class.name));
        if let Some(only) = self.only.iter().find(|only| !all().any(|name| is_of(name, only))) {
            let message = format!("there is no scene or class '{only}'; `trueray conform --list` names them all");
            return Err(Failure::new(USAGE, message));
        }
        Ok(Plan {
            scenes: SCENES.iter().filter(|scene| self.means(scene.name)).collect(),
            classes: classes().into_iter().filter(|class| self.means(class.name)).collect(),
            count: self.count as usize,
            seed: self.seed,
        })
    }

    /// Prints on standard output, unless data goes there.
    fn show(&self, text: &str) {
        if ![&self.json, &self.junit].into_iter().flatten().any(|path| path == Path::new("-")) {
            out!("{text}");
        }
    }
}

/// Whether `name` is `only`, or in the folder of that name.
fn is_of(name: &str, only: &str) -> bool {
    name == only || name.strip_prefix(only).is_some_and(|rest| rest.starts_with('/'))
}

pub(super) fn run(args: &Args) -> Result<u8, Failure> {
    let plan = args.plan()?;
    if args.list {
        plan.scenes.iter().for_each(|scene| outln!("{:<28} {}", scene.name, about(scene)));
        plan.classes.iter().for_each(|class| outln!("{:<28} {}", class.name, class.about));
        return Ok(OK);
    }
    if let Some(folder) = &args.write {
        return write_scenes(&plan, folder);
    }
    let files = [("--json", &args.json), ("--junit", &args.junit)];
    Guard::new(args.diff.iter().chain(&args.baseline)).options(files)?;
    if !args.diff.is_empty() {
        return compare(args);
    }
    check(args, &plan)
}

/// A scene's first line, which says what it shows.
fn about(scene: &BuiltIn) -> &'static str {
    scene.text.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
}

fn write_scenes(plan: &Plan, folder: &Path) -> Result<u8, Failure> {
    for scene in &plan.scenes {
        let path = folder.join(scene.name).with_extension("txt");
        let parent = path.parent().unwrap_or(folder);
        std::fs::create_dir_all(parent)
            .map_err(|error| Failure::new(OUTPUT, format!("cannot make the folder {}: {error}", parent.display())))?;
        save(&path, scene.text)?;
        errln!("{}", visible_path(&path));
    }
    Ok(OK)
}

/// What has been found, and where it goes.
struct Results {
    json: Option<PathBuf>,
    junit: Option<PathBuf>,
    report: Report,
    /// Of each run the known flaws, and those of them that it has not looked at.
    baselines: Vec<(Baseline, Vec<Key>)>,
}

impl Results {
    fn write(&self) -> Result<(), Failure> {
        if let Some(path) = &self.json {
            save_report(path, &self.report)?;
        }
        if let Some(path) = &self.junit {
            let runs = self.report.runs.iter().zip(&self.baselines);
            let runs: Vec<_> = runs.map(|(run, (baseline, unseen))| (run, baseline, unseen.as_slice())).collect();
            let text = junit(&runs, &origin().properties()).map_err(|error| Failure::new(OUTPUT, error))?;
            save(path, &text)?;
        }
        Ok(())
    }
}

/// Checks the devices.
fn check(args: &Args, plan: &Plan) -> Result<u8, Failure> {
    if args.device.contains(&Choice::Cpu) {
        let message = "conform checks Vulkan devices; the CPU reference is what they are checked against";
        return Err(Failure::new(USAGE, message));
    }
    let former = args.baseline.as_deref().map(read).transpose()?;
    // All of them before minutes are spent on the first.
    let mut devices = Vec::new();
    for choice in &args.device {
        let gpu = open_device(choice)?.keeping_kernels(USUAL_KERNELS);
        let baseline = match (&former, &args.baseline) {
            (Some(former), Some(path)) => {
                Baseline::of(former, &gpu.device.info.name).map_err(|why| unusable(path, &why))?
            }
            _ => Baseline::default(),
        };
        devices.push((gpu, baseline));
    }
    let (json, junit) = (args.json.clone(), args.junit.clone());
    let report = Report { count: args.count, seed: args.seed, interrupted: false, runs: Vec::new() };
    let results = Arc::new(Mutex::new(Results { json, junit, report, baselines: Vec::new() }));
    let last = Arc::clone(&results);
    say_last(move || {
        let mut results = lock(&last);
        results.report.interrupted = true;
        errln!("trueray: interrupted; what was checked is written");
        if let Err(failure) = results.write() {
            failure.report();
        }
    });
    args.show(&format!("{}\n", origin()));
    let (mut fails, mut is_lost, mut sees) = (false, false, false);
    for (gpu, baseline) in devices {
        let run = check_device(args, plan, &gpu, &baseline, &results);
        let is_meant = |key: &Key| args.means(&key.name);
        let unseen = if run.lost.is_some() { Vec::new() } else { baseline.unseen(&run, is_meant) };
        args.show(&format!("\n{}", summary(&run, &baseline, &unseen)));
        fails |= !unseen.is_empty() || run.checks.iter().any(|check| baseline.standing(check).fails());
        is_lost |= run.lost.is_some();
        sees |= run.checks.iter().any(|check| check.verdict != Verdict::Refused);
        let mut results = lock(&results);
        results.report.runs.pop();
        results.report.runs.push(run);
        results.baselines.pop();
        results.baselines.push((baseline, unseen));
    }
    say_nothing();
    lock(&results).write()?;
    Ok(match (is_lost, fails, sees) {
        (true, ..) => DEVICE_LOST,
        (_, true, _) => BROKEN,
        (_, _, false) => NO_DEVICE,
        _ => OK,
    })
}

/// Checks one device; `results` has all that is found, as it is found.
fn check_device(args: &Args, plan: &Plan, gpu: &Gpu, baseline: &Baseline, results: &Mutex<Results>) -> Run {
    let info: &DeviceInfo = &gpu.device.info;
    args.show(&format!("{info}\nVulkan {}\n\n{}", info.vulkan, head()));
    {
        let mut results = lock(results);
        results.report.runs.push(Run::new(info));
        results.baselines.push((baseline.clone(), Vec::new()));
    }
    let mut progress = Progress::new(args.progress, "conform");
    let run = run_plan(gpu, plan, |checks: &[Check], part| {
        progress.pause(|| args.show(&line(checks, baseline)));
        progress.set(part);
        if let Some(run) = lock(results).report.runs.last_mut() {
            run.checks.extend_from_slice(checks);
        }
    });
    progress.finish();
    run
}

fn unusable(path: &Path, why: &str) -> Failure {
    Failure::new(USAGE, format!("{}: {why}", visible_path(path)))
}

fn read(path: &Path) -> Result<Former, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| unusable(path, &error.to_string()))?;
    Former::read(&text).map_err(|why| unusable(path, &why))
}

/// What `--diff --json` writes.
#[derive(Debug, Serialize)]
struct DiffReport<'a> {
    a: Subject<'a>,
    b: Subject<'a>,
    differs: bool,
    pairs: &'a [Pair],
}

/// What was checked, by what.
#[derive(Debug, Serialize)]
struct Subject<'a> {
    device: &'a str,
    driver: &'a str,
    program: &'a str,
    commit: Option<&'a str>,
}

impl<'a> Subject<'a> {
    fn new(former: &'a Former, run: &'a Run) -> Self {
        let commit = former.commit.as_deref();
        Self { device: &run.device, driver: &run.driver, program: &former.program, commit }
    }

    fn in_words(&self) -> String {
        let Self { device, driver, program, commit } = self;
        visible(&format!("{device} ({driver}), by {program} ({})", commit.unwrap_or("commit not named")))
    }
}

/// Compares two runs.
fn compare(args: &Args) -> Result<u8, Failure> {
    let former = args.diff.iter().map(|path| read(path)).collect::<Result<Vec<_>, _>>()?;
    let runs: Vec<_> =
        former.iter().flat_map(|former| former.report.runs.iter().map(move |run| (former, run))).collect();
    let &[(of_a, a), (of_b, b)] = &runs[..] else {
        let message =
            format!("--diff compares two runs, and there are {}: two files of one device, or one of two", runs.len());
        return Err(Failure::new(USAGE, message));
    };
    let pairs = diff(a, b);
    if pairs.iter().all(|pair| pair.a.is_none() || pair.b.is_none()) {
        return Err(Failure::new(USAGE, "the two runs have checked nothing that is the same"));
    }
    let differs = pairs.iter().any(|pair| pair.relation.is_difference());
    let (subject_a, subject_b) = (Subject::new(of_a, a), Subject::new(of_b, b));
    args.show(&format!("A  {}\nB  {}\n\n", subject_a.in_words(), subject_b.in_words()));
    args.show(&diff_table(&pairs));
    if let Some(path) = &args.json {
        save_report(path, &DiffReport { a: subject_a, b: subject_b, differs, pairs: &pairs })?;
    }
    Ok(if differs { DIFFERENT } else { OK })
}
