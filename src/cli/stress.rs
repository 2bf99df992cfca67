//! `trueray stress`.

use std::str::FromStr;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use serde::Serialize;

use super::failure::{BROKEN, Failure, NO_DEVICE, OK, USAGE};
use super::files::{json, report_json};
use super::options::open_device;
use super::output::{errln, out, outln};
use super::progress::{Progress, Style};
use super::signals::{say_last, say_nothing};
use crate::gpu::{Choice, Gpu, Kernel};
use crate::origin::origin;
use crate::precision::Tier;
use crate::stress::{Class, Row, Verdict, classes, cost, run as run_classes, table};
use crate::threads::lock;

/// Arguments of `trueray stress`.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Measurement")]
pub(super) struct Args {
    /// Vulkan device: auto, gpu, an index of `trueray devices`, part of a name or driver, or a PCI id
    #[arg(long, value_name = "DEVICE", default_value = "auto", help_heading = "Device")]
    device: Choice,
    /// Kernels: fast, robust, double, all (these three), schoolbook, no-barrier
    #[arg(long, value_name = "KERNEL", value_delimiter = ',', default_value = "all", help_heading = "Device")]
    precision: Vec<Selected>,
    /// Classes by name or number; all without it
    #[arg(long, value_name = "NAME|ID", value_delimiter = ',')]
    class: Vec<String>,
    /// Rays of each case
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(64..=10_000_000))]
    count: u32,
    /// Seed of the random numbers
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Measure instead what a ray-ellipsoid test costs on each kernel, in turn, this many times
    #[arg(long, value_name = "RUNS", value_parser = clap::value_parser!(u32).range(1..=1000))]
    time: Option<u32>,
    /// List the classes
    #[arg(long, help_heading = "Output")]
    list: bool,
    /// Print JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// How progress is shown on standard error
    #[arg(long, value_enum, default_value_t = Style::Auto, help_heading = "Output")]
    progress: Style,
}

/// Kernels by one name.
#[derive(Debug, Clone)]
struct Selected(Vec<Kernel>);

impl FromStr for Selected {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "all" {
            return Ok(Self(Tier::ALL.map(Kernel::Tier).to_vec()));
        }
        let all = Tier::ALL.map(Kernel::Tier).into_iter().chain([Kernel::Pairs, Kernel::Schoolbook, Kernel::NoBarrier]);
        let kernel = all.into_iter().find(|kernel| kernel.name() == text);
        kernel.map(|kernel| Self(vec![kernel])).ok_or_else(|| {
            "expected fast, robust, double, all, pairs, schoolbook or no-barrier, or several with commas between".into()
        })
    }
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Report {
    device: String,
    count: u32,
    seed: u64,
    seconds: f64,
    broken: usize,
    /// The rest is missing.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    interrupted: bool,
    rows: Vec<Row>,
}

impl Report {
    fn print(&self) -> Result<(), Failure> {
        out!("{}", report_json(self)?);
        Ok(())
    }
}

fn selected_classes(names: &[String]) -> Result<Vec<Class>, Failure> {
    let mut all = classes();
    for name in names {
        if !all.iter().any(|class| class.name == name || class.id.to_string() == *name) {
            let message = format!("there is no class '{name}'; `trueray stress --list` names them all");
            return Err(Failure::new(USAGE, message));
        }
    }
    all.retain(|class| names.is_empty() || names.iter().any(|n| class.name == n || class.id.to_string() == *n));
    Ok(all)
}

pub(super) fn run(args: &Args) -> Result<u8, Failure> {
    let classes = selected_classes(&args.class)?;
    if args.list {
        for class in &classes {
            outln!("{:>2} {:<15} {} ({})", class.id, class.name, class.about, class.counted);
        }
        return Ok(OK);
    }
    if args.device == Choice::Cpu {
        return Err(Failure::new(
            USAGE,
            "stress checks a Vulkan device; the CPU reference is what it is checked against",
        ));
    }
    let gpu = open_device(&args.device)?;
    let mut kernels: Vec<Kernel> = Vec::new();
    for kernel in args.precision.iter().flat_map(|selected| &selected.0) {
        if !kernels.contains(kernel) {
            kernels.push(*kernel);
        }
    }
    if let Some(runs) = args.time {
        return time(args, &gpu, &kernels, runs as usize);
    }
    let start = Instant::now();
    if !args.json {
        outln!("{}", origin());
        outln!("{}, {} rays a case, seed {}", gpu.device.info, args.count, args.seed);
        out!("{}", table(&[]));
    }
    let report = move |device: String, count: u32, seed: u64, rows: Vec<Row>, interrupted: bool| {
        let broken = rows.iter().filter(|row| row.is_broken()).count();
        Report { device, count, seed, seconds: start.elapsed().as_secs_f64(), broken, interrupted, rows }
    };
    let seen: Arc<Mutex<Vec<Row>>> = Arc::default();
    let (last, device, count, seed, as_json) =
        (Arc::clone(&seen), gpu.device.info.to_string(), args.count, args.seed, args.json);
    say_last(move || {
        let rows = lock(&last).clone();
        errln!("trueray: interrupted after {} rows", rows.len());
        if as_json && let Err(failure) = report(device, count, seed, rows, true).print() {
            failure.report();
        }
    });
    let mut progress = Progress::new(args.progress, "stress");
    let rows = run_classes(&gpu, &kernels, &classes, args.count as usize, args.seed, |row| {
        if !args.json {
            // Without the head.
            progress.pause(|| table(std::slice::from_ref(row)).lines().skip(1).for_each(|line| outln!("{line}")));
        }
        lock(&seen).push(row.clone());
        let before = classes.iter().position(|class| class.id == row.id).unwrap_or(0);
        progress.set(before as f64 / classes.len() as f64);
    })?;
    progress.finish();
    say_nothing();
    // Where every kernel is refused, nothing was checked.
    let refusals = rows.iter().map(|row| match &row.verdict {
        Verdict::Refused(why) => Some(why),
        _ => None,
    });
    if let Some(Some(&why)) = refusals.collect::<Option<Vec<_>>>().as_deref().map(<[_]>::first) {
        return Err(Failure::new(NO_DEVICE, why));
    }
    let report = report(gpu.device.info.to_string(), args.count, args.seed, rows, false);
    let broken = report.broken;
    if args.json {
        report.print()?;
    } else {
        let Report { rows, seconds, .. } = report;
        let too_few = match rows.iter().filter(|row| matches!(row.verdict, Verdict::TooFew(_))).count() {
            0 => String::new(),
            unseen => format!(", {unseen} not fully seen with so few rays"),
        };
        let broken = if broken == 0 { "no".to_owned() } else { broken.to_string() };
        outln!("{broken} promises broken{too_few}, {seconds:.1} s");
    }
    Ok(if broken == 0 { OK } else { BROKEN })
}

/// The cost of a test on each kernel.
fn time(args: &Args, gpu: &Gpu, kernels: &[Kernel], runs: usize) -> Result<u8, Failure> {
    let costs = cost(gpu, kernels, args.count as usize, args.seed, runs)?;
    if args.json {
        out!("{}", json(&costs)?);
        return Ok(OK);
    }
    outln!("{}, {} rays against 32 spheres, {runs} runs in turn", gpu.device.info, args.count);
    outln!("{:<10} {:>10} {:>16} {:>13}", "kernel", "ns a test", "min … max", "× schoolbook");
    for cost in &costs {
        let range = format!("{:.2} … {:.2}", cost.ns.min(), cost.ns.max());
        outln!("{:<10} {:>10.2} {range:>16} {:>13.2}", cost.kernel, cost.ns.median(), cost.ratio);
    }
    Ok(OK)
}
