//! `trueray bench --tune`.

use super::failure::{Failure, OUTPUT, USAGE};
use super::files::command;
use super::options::{DeviceOptions, PictureOptions, open_device};
use super::reports::Reports;
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
    reports: &Reports,
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
    let measured = count(runs as u64, "run");
    reports.show(&format!("{}: medians of {measured} a scene, compilation not counted\n", gpu.device.info));
    let result = tune(&mut gpu, &plan, |knob| reports.show(&knob.report()))?;
    let file = save(&gpu.device.info.name, &gpu.device.info.driver, result.after)?;
    let difference = result.after.difference(&result.before);
    let found = if difference.is_empty() { "nothing is better than what the class has".into() } else { difference };
    match &file {
        Some(file) => reports.show(&format!("{found}; kept in {}\n", file.display())),
        None => reports.show(&format!("{found}\n")),
    }
    let json = || serde_json::json!({ "command": command(), "tune": result, "file": file });
    reports.write(String::new, String::new, json)?;
    match file {
        Some(_) => Ok(()),
        None => Err(Failure::new(
            OUTPUT,
            "there is no cache folder to keep it in: neither XDG_CACHE_HOME nor HOME names one",
        )),
    }
}
