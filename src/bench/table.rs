//! The measurements as tables for the terminal and as CSV.

use std::fmt::Write as _;

use super::families::Family;
use super::measure::{Bench, Growth, Measured, SceneResult};
use super::phases::PHASES;
use crate::engine::Rays;
use crate::report::Timings;
use crate::report::csv::record;
use crate::report::number::{short, time};
use crate::words::count;

impl SceneResult {
    /// The scene's rows of the terminal's table.
    pub fn report(&self, family: &Family) -> String {
        let mut text = String::new();
        let name = family.file_stem(self.size);
        for measured in &self.measured {
            let Measured { renderer, picture, phases, rays_per_second, .. } = measured;
            let range = format!("{} … {}", short(picture.min()), short(picture.max()));
            let phases: String = phases.iter().map(|phase| format!(" {:>9}", short(phase.times.median()))).collect();
            let _ = writeln!(
                text,
                "{name:<20} {:<7} {:>9} {range:>17}{phases} {:>9}  {}",
                renderer.name(),
                short(picture.median()),
                short(rays_per_second / 1e6),
                picture.caution()
            );
        }
        for skipped in &self.skipped {
            let _ = writeln!(text, "{name:<20} {:<7} skipped: {}", skipped.name, skipped.reason);
        }
        if let Some(differing) = self.differing.filter(|count| *count > 0) {
            let _ = writeln!(text, "{:<28} {differing} pixels differ between the two", "");
        }
        text
    }
}

/// The first lines of the terminal's table.
pub fn heads() -> String {
    let phases: String = PHASES.map(|(name, _)| format!(" {name:>9}")).concat();
    format!("times in ms       {:>19} {:>17}{phases} {:>9}\n", "picture", "min … max", "Mrays/s")
}

impl Growth {
    /// In words.
    pub fn report(&self) -> String {
        let Self { renderer, exponent, sizes } = self;
        format!("{}: time grows as size^{exponent:.2} from {} to {}", renderer.name(), sizes.0, sizes.1)
    }
}

impl Bench {
    /// How the families' times grow, one line each.
    pub fn growth_report(&self) -> String {
        let mut text = String::new();
        for family in &self.families {
            for growth in &family.growth {
                let _ = writeln!(text, "{:<12} {}", family.name, growth.report());
            }
        }
        text
    }

    /// The device in words.
    pub(super) fn device_name(&self) -> String {
        self.device.as_ref().map_or_else(|| "the CPU alone".to_owned(), ToString::to_string)
    }

    /// How it was measured, in a line.
    pub fn head(&self) -> String {
        let Self { cpu_threads, runs, seconds, .. } = self;
        format!(
            "on {}, CPU with {cpu_threads} threads; medians of {}, at most {} for the runs of a scene",
            self.device_name(),
            count(*runs as u64, "run"),
            time(seconds * 1e3)
        )
    }
}

/// Names of the columns of [`csv`].
pub fn csv_columns() -> Vec<String> {
    let mut columns: Vec<_> =
        ["family", "size", "axis", "spheres", "lights", "width", "height", "device", "driver", "tier", "renderer"]
            .into();
    columns.extend(["runs", "picture_median_ms", "picture_min_ms", "picture_max_ms", "picture_outliers"]);
    let mut columns: Vec<_> = columns.into_iter().map(str::to_owned).collect();
    for (name, _) in PHASES {
        let name = name.replace(' ', "_");
        columns.extend(["median", "min", "max"].map(|what| format!("{name}_{what}_ms")));
    }
    let rest =
        ["primary_rays", "shadow_rays", "reflection_rays", "rays_per_second", "differing", "exponent", "skipped"];
    columns.extend(rest.map(str::to_owned));
    columns.push("picture_runs_ms".to_owned());
    columns
}

/// All scenes and renderers as CSV with a line of column names; times in ms, the single runs separated by blanks.
pub fn csv(bench: &Bench) -> String {
    let mut text = record(&csv_columns());
    let (device, driver) =
        bench.device.as_ref().map_or_else(Default::default, |info| (info.name.clone(), info.driver.clone()));
    for family in &bench.families {
        for scene in &family.scenes {
            let SceneResult { size, spheres, lights, width, height, tier, differing, .. } = scene;
            let head = [
                family.name.to_owned(),
                size.to_string(),
                family.axis.name().to_owned(),
                spheres.to_string(),
                lights.to_string(),
                width.to_string(),
                height.to_string(),
                device.clone(),
                driver.clone(),
                tier.clone().unwrap_or_default(),
            ];
            let differing = differing.map_or_else(String::new, |count| count.to_string());
            for measured in &scene.measured {
                let growth = family.growth.iter().find(|growth| growth.renderer == measured.renderer);
                let exponent = growth.map_or_else(String::new, |growth| growth.exponent.to_string());
                let fields = measured_fields(measured, [differing.clone(), exponent, String::new()]);
                text += &record(&[&head[..], &fields].concat());
            }
            for skipped in &scene.skipped {
                let mut fields = vec![String::new(); csv_columns().len() - head.len()];
                fields[0].clone_from(&skipped.name);
                let place = fields.len() - 2;
                fields[place].clone_from(&skipped.reason);
                text += &record(&[&head[..], &fields].concat());
            }
        }
    }
    text
}

fn measured_fields(measured: &Measured, last: [String; 3]) -> Vec<String> {
    let Measured { renderer, picture, phases, rays, rays_per_second } = measured;
    let three = |sample: &Timings| [sample.median(), sample.min(), sample.max()].map(|ms| ms.to_string());
    let mut fields = vec![renderer.name().to_owned(), picture.runs().len().to_string()];
    fields.extend(three(picture));
    fields.push(picture.outliers().to_string());
    fields.extend(phases.iter().flat_map(|phase| three(&phase.times)));
    let Rays { primary, shadow, reflection } = rays;
    fields.extend([primary, shadow, reflection].map(u64::to_string));
    fields.push(rays_per_second.to_string());
    fields.extend(last);
    fields.push(picture.listed());
    fields
}
