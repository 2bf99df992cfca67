//! `trueray bench --tune`.

use std::path::Path;

use super::failure::{Failure, OUTPUT, USAGE};
use super::files::{command, save_json};
use super::options::{DeviceOptions, PictureOptions, open_device};
use super::output::out;
use crate::bench::{TunePlan, tune};
use crate::gpu::{Choice, Gpu, USUAL_KERNELS};
use crate::tuning::save;
use crate::viewed::ViewedScene;
use crate::words::count;

/// Measures the candidates of every tuning number on the device, prints them, and keeps the best for later runs.
pub(super) fn run_tune(
    picture: &PictureOptions,
    device: &DeviceOptions,
    max_spheres: usize,
    runs: usize,
    json: Option<&Path>,
) -> Result<(), Failure> {
    device.check_tier()?;
    let choice = match &device.device {
        Choice::Cpu => {
            return Err(Failure::new(USAGE, "--tune is for Vulkan devices; the CPU reference has no tuning"));
        }
        Choice::Auto => &Choice::Gpu,
        choice => choice,
    };
    let mut gpu = open_device(choice)?.keeping_kernels(USUAL_KERNELS);
    let settings = picture.settings()?;
    let plan = TunePlan {
        max_spheres,
        runs,
        settings: &settings,
        resolution: picture.resolution(),
        choice: &|gpu: &Gpu, viewed: &ViewedScene| {
            let effects = picture.effects(viewed);
            let tier = device.selection(Some(gpu), viewed, &effects).tier;
            (effects, tier)
        },
    };
    let table_on_stdout = json != Some(Path::new("-"));
    let show = |text: &str| {
        if table_on_stdout {
            out!("{text}");
        }
    };
    let measured = count(runs as u64, "run");
    show(&format!("{}: medians of {measured} a scene, compilation not counted\n", gpu.device.info));
    let result = tune(&mut gpu, &plan, |knob| show(&knob.report()))?;
    let file = save(&gpu.device.info.name, &gpu.device.info.driver, result.after)?;
    let difference = result.after.difference(&result.before);
    let found = if difference.is_empty() { "nothing is better than what the class has".into() } else { difference };
    match &file {
        Some(file) => show(&format!("{found}; kept in {}\n", file.display())),
        None => show(&format!("{found}\n")),
    }
    if let Some(path) = json {
        save_json(path, &serde_json::json!({ "command": command(), "tune": result, "file": file }))?;
    }
    match file {
        Some(_) => Ok(()),
        None => Err(Failure::new(
            OUTPUT,
            "there is no cache folder to keep it in: neither XDG_CACHE_HOME nor HOME names one",
        )),
    }
}
