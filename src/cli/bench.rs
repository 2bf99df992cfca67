//! `trueray bench`.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use super::failure::{DIFFERENT, Failure, OK, OUTPUT, USAGE};
use super::files::{command, save, seconds};
use super::guard::Guard;
use super::options::{DeviceOptions, PictureOptions};
use super::output::{errln, out};
use super::progress::{Progress, Style};
use super::reports::Reports;
use super::signals::{say_last, say_nothing};
use super::tune::run_tune;
use crate::bench::{Bench, BenchPlan, Comparison, FAMILIES, Family, Former, RenderSetup, bench, csv, heads, html};
use crate::threads::lock;

/// Arguments of `trueray bench`.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Measurement")]
pub(super) struct Args {
    /// Families of scenes, separated by commas; `--list` says which there are
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = family, help_heading = "Scene")]
    families: Vec<&'static Family>,
    /// Leave out scenes with more spheres
    #[arg(long, value_name = "N", default_value_t = 1_000_000, help_heading = "Scene")]
    max_spheres: usize,
    /// Counted runs of each scene and renderer
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    runs: u32,
    /// Time for the counted runs of one scene on one renderer, in seconds; what would take longer is skipped
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = seconds)]
    seconds: f64,
    /// Measure instead what suits this device best, and keep it for later runs on it; without a report or CSV
    #[arg(long, conflicts_with_all = ["families", "list", "write", "report", "csv", "no_cpu", "seconds"])]
    tune: bool,
    /// Leave out the CPU reference
    #[arg(long)]
    no_cpu: bool,
    /// Hold every scene against an earlier run, which --json has written: ratios of the medians with their 95 % intervals
    #[arg(long, value_name = "FILE", conflicts_with_all = ["list", "write", "tune"])]
    baseline: Option<PathBuf>,
    /// End with code 1 where a scene is slower than in the baseline by more than this, for sure, or too slow to be measured now
    #[arg(long, value_name = "PERCENT", requires = "baseline", value_parser = percent)]
    fail_slower: Option<f64>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    device: DeviceOptions,
    /// List the families and their sizes, and end
    #[arg(long, help_heading = "Output")]
    list: bool,
    /// Write the scenes as scene files into a folder, for other renderers, and end
    #[arg(long, value_name = "FOLDER", help_heading = "Output")]
    write: Option<PathBuf>,
    #[command(flatten)]
    reports: Reports,
    /// How progress is shown on standard error
    #[arg(long, value_enum, default_value_t = Style::Auto, help_heading = "Output")]
    progress: Style,
}

/// Measures, and returns the exit code.
pub(super) fn run(args: &Args) -> Result<u8, Failure> {
    args.picture.check_window()?;
    let families = if args.families.is_empty() { FAMILIES.iter().collect() } else { args.families.clone() };
    if args.tune {
        args.reports.check(&mut Guard::default())?;
        return run_tune(&args.picture, &args.device, args.max_spheres, args.runs as usize, &args.reports)
            .map(|()| OK)
            .map_err(Failure::without_cpu);
    }
    if args.list {
        list(&families);
        return Ok(OK);
    }
    if let Some(folder) = &args.write {
        return write_scenes(args, &families, folder).map(|()| OK);
    }
    args.reports.check(&mut Guard::new(&args.baseline))?;
    let former = args.baseline.as_deref().map(read_former).transpose()?;
    let gpu = args.device.open()?;
    let settings = args.picture.settings()?;
    let setup = RenderSetup {
        gpu: gpu.as_ref(),
        settings: &settings,
        resolution: args.picture.resolution(),
        effects: &|viewed| args.picture.effects(viewed),
        selection: &|viewed, effects| args.device.selection(gpu.as_ref(), viewed, effects),
    };
    let plan = BenchPlan {
        families,
        max_spheres: args.max_spheres,
        runs: args.runs as usize,
        seconds: args.seconds,
        cpu: !args.no_cpu,
    };
    args.reports.show(&heads());
    let measured: Arc<Mutex<Option<Bench>>> = Arc::default();
    let (last, reports) = (Arc::clone(&measured), args.reports.clone());
    say_last(move || interrupted(lock(&last).as_ref(), &reports));
    let scenes = plan.families.iter().map(|family| plan.sizes(family).count()).sum::<usize>();
    let mut done = 0;
    let mut progress = Progress::new(args.progress, "bench");
    let bench = bench(&setup, &plan, |bench, family, scene| {
        *lock(&measured) = Some(bench.clone());
        done += 1;
        progress.pause(|| args.reports.show(&scene.report(family)));
        progress.set(done as f64 / scenes as f64);
    })?;
    progress.finish();
    say_nothing();
    args.reports.show(&format!("\n{}\n{}\n", bench.growth_report(), bench.head()));
    let compared = former.map(|former| Comparison::new(&former, &bench)).transpose();
    write(&args.reports, &bench, compared.as_ref().ok().and_then(Option::as_ref))?;
    let Some(comparison) = compared.map_err(|why| unusable(args.baseline.as_deref(), &why))? else { return Ok(OK) };
    let part = args.fail_slower.unwrap_or(NOTICED);
    args.reports.show(&format!("\n{}", comparison.report(part)));
    let fails = args.fail_slower.is_some() && comparison.is_slower(part);
    Ok(if fails { DIFFERENT } else { OK })
}

/// What counts as a change where the user names nothing.
const NOTICED: f64 = 0.05;

/// Percent, with or without the sign, as a part.
fn percent(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches('%').trim_end();
    let percent: f64 = number.parse().map_err(|_| "not a number of percent, such as 5 or 5%".to_owned())?;
    if percent.is_finite() && percent >= 0.0 { Ok(percent / 100.0) } else { Err("at least 0".into()) }
}

fn read_former(path: &Path) -> Result<Former, Failure> {
    let text = std::fs::read(path).map_err(|error| unusable(Some(path), &error.to_string()))?;
    serde_json::from_slice(&text)
        .map_err(|error| unusable(Some(path), &format!("it is not what `trueray bench --json` writes: {error}")))
}

fn unusable(path: Option<&Path>, why: &str) -> Failure {
    let name = path.map(crate::words::visible_path).unwrap_or_default();
    Failure::new(USAGE, format!("cannot use the baseline {name}: {why}"))
}

fn write(reports: &Reports, bench: &Bench, comparison: Option<&Comparison>) -> Result<(), Failure> {
    reports.write(
        || html(bench, &command()),
        || csv(bench),
        || serde_json::json!({ "command": command(), "bench": bench, "comparison": comparison }),
    )
}

/// Writes the scenes that are measured.
fn interrupted(measured: Option<&Bench>, reports: &Reports) {
    let Some(bench) = measured else {
        errln!("trueray: interrupted before anything was measured");
        return;
    };
    errln!("trueray: interrupted; the scenes that were measured are written");
    if let Err(failure) = write(reports, bench, None) {
        failure.report();
    }
}

fn list(families: &[&Family]) {
    for family in families {
        let sizes: Vec<_> = family.sizes.iter().map(ToString::to_string).collect();
        out!("{:<12} {}\n{:<12} {}: {}\n", family.name, family.summary, "", family.axis.name(), sizes.join(", "));
    }
}

/// Writes the scenes that would be measured.
fn write_scenes(args: &Args, families: &[&Family], folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder)
        .map_err(|error| Failure::new(OUTPUT, format!("cannot make the folder {}: {error}", folder.display())))?;
    for family in families {
        for &size in family.sizes.iter().filter(|&&size| family.spheres(size) <= args.max_spheres) {
            let mut scene = family.scene(size);
            args.picture.frame(&mut scene)?;
            let path = folder.join(family.file_stem(size)).with_extension("txt");
            save(&path, &scene.to_string())?;
            errln!("{}", crate::words::visible_path(&path));
        }
    }
    Ok(())
}

fn family(name: &str) -> Result<&'static Family, String> {
    Family::named(name).ok_or_else(|| {
        let names: Vec<_> = FAMILIES.iter().map(|family| family.name).collect();
        format!("there are {}", names.join(", "))
    })
}
