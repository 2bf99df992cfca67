//! `trueray study`.

use std::path::PathBuf;

use serde::Serialize;

use super::failure::{Failure, OK, OUTPUT};
use super::input::Loaded;
use super::options::{DeviceOptions, PictureOptions, device_name};
use crate::engine::Backend;
use crate::study::{EffectCost, effect_cost};

/// Arguments of `trueray study`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Scene files; `-` is standard input
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// Counted runs of each variant, after one warm-up
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..=1000))]
    runs: u32,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    device: DeviceOptions,
}

/// What `--json` prints of a scene.
#[derive(Debug, Serialize)]
struct Report {
    scene: String,
    width: u32,
    height: u32,
    device: String,
    effect_cost: EffectCost,
}

pub(super) fn run(args: &Args) -> u8 {
    match study(args) {
        Ok(()) => OK,
        Err(failure) => failure.report(),
    }
}

fn study(args: &Args) -> Result<(), Failure> {
    let gpu = args.device.open()?;
    let mut reports = Vec::new();
    for path in &args.scenes {
        let mut loaded = Loaded::read(path, false)?;
        args.picture.resize(&mut loaded.scene);
        let scene = &loaded.scene;
        let settings = args.picture.settings();
        let effects = args.picture.effects(scene, &settings);
        let selection = args.device.selection(gpu.as_ref(), scene, &effects);
        let backend = gpu.as_ref().map_or(Backend::Reference, |gpu| Backend::Device(gpu, selection.tier));
        let effect_cost = effect_cost(backend, scene, &settings, args.runs as usize)?;
        let report = Report {
            scene: loaded.name,
            width: scene.width,
            height: scene.height,
            device: device_name(gpu.as_ref()),
            effect_cost,
        };
        if !args.json {
            println!("{}: {} × {} on {}", report.scene, report.width, report.height, report.device);
            print!("{}", report.effect_cost.report());
        }
        reports.push(report);
    }
    if args.json {
        println!("{}", serde_json::to_string_pretty(&reports).map_err(|e| Failure::new(OUTPUT, e.to_string()))?);
    }
    Ok(())
}
