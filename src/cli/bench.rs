//! `trueray bench`.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use super::failure::{Failure, OUTPUT};
use super::files::{command, save, seconds};
use super::guard::Guard;
use super::options::{DeviceOptions, PictureOptions};
use super::output::{errln, out};
use super::progress::{Progress, Style};
use super::reports::Reports;
use super::signals::{say_last, say_nothing};
use super::tune::run_tune;
use crate::bench::{Bench, BenchPlan, FAMILIES, Family, RenderSetup, bench, csv, heads, html};
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

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    args.picture.check_window()?;
    let families = if args.families.is_empty() { FAMILIES.iter().collect() } else { args.families.clone() };
    if args.tune {
        args.reports.check(&mut Guard::default())?;
        return run_tune(&args.picture, &args.device, args.max_spheres, args.runs as usize, &args.reports)
            .map_err(Failure::without_cpu);
    }
    if args.list {
        list(&families);
        return Ok(());
    }
    if let Some(folder) = &args.write {
        return write_scenes(args, &families, folder);
    }
    args.reports.check(&mut Guard::default())?;
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
    write(&args.reports, &bench)
}

fn write(reports: &Reports, bench: &Bench) -> Result<(), Failure> {
    reports.write(
        || html(bench, &command()),
        || csv(bench),
        || serde_json::json!({ "command": command(), "bench": bench }),
    )
}

/// Writes the scenes that are measured.
fn interrupted(measured: Option<&Bench>, reports: &Reports) {
    let Some(bench) = measured else {
        errln!("trueray: interrupted before anything was measured");
        return;
    };
    errln!("trueray: interrupted; the scenes that were measured are written");
    if let Err(failure) = write(reports, bench) {
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
