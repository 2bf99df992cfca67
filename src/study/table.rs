//! The measurements as tables for the terminal and as CSV.

use std::fmt::Write as _;

use super::distance::Distance;
use super::measure::{Point, Series, Study};
use super::sampling::PartialPoint;
use crate::report::Timings;
use crate::report::csv::record;
use crate::report::number::{short, time};
use crate::settings::Settings;
use crate::words::{count, visible};

impl Study {
    /// Tables for people.
    pub fn report(&self) -> String {
        let mut text = String::new();
        let device = self.device.as_ref().map_or_else(|| "the CPU alone".to_owned(), ToString::to_string);
        let Self { scene, width, height, spheres, lights, .. } = self;
        let (scene, spheres) = (visible(scene), count(*spheres as u64, "sphere"));
        let lights = count(*lights as u64, "light");
        let _ = writeln!(text, "{scene}: {width} × {height}, {spheres}, {lights}, on {device}");
        for skipped in &self.skipped {
            let _ = writeln!(text, "not measured: {}: {}", skipped.name, skipped.reason);
        }
        for (title, series) in self.titled() {
            let _ = write!(text, "\n{title}, {}\n{}", count(series.runs as u64, "run"), series.report());
        }
        if !self.partial.points.is_empty() {
            let title = "Samples of a part of the pixels; error in levels against the full picture";
            let _ = write!(text, "\n{title}, {}\n{}", count(self.partial.runs as u64, "run"), self.partial.report());
        }
        let _ = write!(text, "\nWhat each effect costs ({})\n{}", self.effects_on(), self.effect_cost.report());
        text
    }

    /// The three series with their titles.
    pub(super) fn titled(&self) -> [(String, &Series); 3] {
        let against = |series: &Series| match series.truth {
            Some(truth) => format!("error against depth {}, {} spp", truth.depth, truth.samples),
            None => "error against the CPU reference".into(),
        };
        let title = |what: &str, series: &Series| format!("{what}; {}", against(series));
        [
            (title("Precision", &self.precision), &self.precision),
            (title("Reflection depth", &self.depth), &self.depth),
            (title("Samples per pixel", &self.samples), &self.samples),
        ]
    }

    /// What measured the effects.
    pub(super) fn effects_on(&self) -> String {
        if self.device.is_some() { format!("tier {}", self.selection.tier) } else { "CPU f64".into() }
    }
}

impl Series {
    fn report(&self) -> String {
        let mut text = format!(
            "{:<8} {:>5} {:>4} {:>10} {:>19} {:>10} {:>9} {:>5} {:>9} {:>9} {:>11}\n",
            "",
            "depth",
            "spp",
            "median",
            "min … max",
            "on device",
            "differ",
            "max",
            "RMS level",
            "linear",
            "unexplained"
        );
        for point in &self.points {
            let Point { contestant, depth, samples, wall, unexplained, .. } = point;
            let distance = point.from_truth.unwrap_or(point.error);
            let on_device = point.on_device.as_ref().map_or_else(|| "–".into(), |sample| time(sample.median()));
            let range = format!("{} … {} ms", short(wall.min()), short(wall.max()));
            let linear = distance.rms_linear.map_or_else(|| "–".into(), short);
            let median = time(wall.median());
            let _ = writeln!(
                text,
                "{:<8} {depth:>5} {samples:>4} {median:>10} {range:>19} {on_device:>10} {:>9} {:>5} {:>9} {linear:>9} {unexplained:>11}  {}",
                contestant.name(),
                distance.differing,
                distance.max_level,
                short(distance.rms_level),
                wall.caution()
            );
        }
        text
    }
}

/// Names of the columns of [`csv`].
pub const COLUMNS: [&str; 32] = [
    "scene",
    "width",
    "height",
    "device",
    "driver",
    "series",
    "name",
    "depth",
    "spp",
    "runs",
    "wall_median_ms",
    "wall_min_ms",
    "wall_max_ms",
    "wall_outliers",
    "device_median_ms",
    "differing",
    "max_level",
    "mean_level",
    "rms_level",
    "rms_linear",
    "unexplained",
    "not_finite",
    "truth_depth",
    "truth_spp",
    "truth_differing",
    "truth_rms_level",
    "truth_rms_linear",
    "same_picture",
    "sampled_pixels",
    "inside_rms_level",
    "outside_rms_level",
    "wall_runs_ms",
];

/// All points of all studies as CSV (RFC 4180) with a line of column names; times in ms, errors in levels or linear
/// intensity, the single runs separated by blanks.
pub fn csv(studies: &[Study]) -> String {
    let mut text = record(&COLUMNS.map(str::to_owned));
    for study in studies {
        let (device, driver) =
            study.device.as_ref().map_or_else(Default::default, |info| (info.name.clone(), info.driver.clone()));
        let head = [study.scene.clone(), study.width.to_string(), study.height.to_string(), device, driver];
        for (name, series) in [("precision", &study.precision), ("depth", &study.depth), ("samples", &study.samples)] {
            for point in &series.points {
                text += &record(&[&head[..], &fields(name, series, point)].concat());
            }
        }
        for variant in &study.effect_cost.variants {
            let mut fields = vec![
                "effects".to_owned(),
                variant.name.clone(),
                study.settings.max_depth.to_string(),
                study.settings.pattern.count().to_string(),
            ];
            fields.extend(times(&variant.render));
            fields.extend(std::iter::repeat_n(String::new(), 13));
            fields.push(variant.same_picture.to_string());
            fields.extend(std::iter::repeat_n(String::new(), 3));
            fields.push(variant.render.listed());
            text += &record(&[&head[..], &fields].concat());
        }
        for point in &study.partial.points {
            text += &record(&[&head[..], &partial_fields(study, point)].concat());
        }
    }
    text
}

fn times(sample: &Timings) -> [String; 5] {
    [
        sample.runs().len().to_string(),
        sample.median().to_string(),
        sample.min().to_string(),
        sample.max().to_string(),
        sample.outliers().to_string(),
    ]
}

fn fields(name: &str, series: &Series, point: &Point) -> Vec<String> {
    let optional = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    let truth = |value: Option<u64>| value.map_or_else(String::new, |value| value.to_string());
    let mut fields =
        vec![name.to_owned(), point.contestant.name().to_owned(), point.depth.to_string(), point.samples.to_string()];
    fields.extend(times(&point.wall));
    fields.extend([
        optional(point.on_device.as_ref().map(Timings::median)),
        point.error.differing.to_string(),
        point.error.max_level.to_string(),
        point.error.mean_level.to_string(),
        point.error.rms_level.to_string(),
        optional(point.error.rms_linear),
        point.unexplained.to_string(),
        point.not_finite.to_string(),
        truth(series.truth.map(|truth| truth.depth.into())),
        truth(series.truth.map(|truth| truth.samples.into())),
        truth(point.from_truth.map(|distance| distance.differing)),
        optional(point.from_truth.map(|distance| distance.rms_level)),
        optional(point.from_truth.and_then(|distance| distance.rms_linear)),
    ]);
    fields.extend(std::iter::repeat_n(String::new(), 4));
    fields.push(point.wall.listed());
    fields
}

fn partial_fields(study: &Study, point: &PartialPoint) -> Vec<String> {
    let Settings { max_depth, pattern, .. } = study.settings;
    let mut fields = vec!["partial".to_owned(), point.name(), max_depth.to_string(), pattern.count().to_string()];
    fields.extend(times(&point.wall));
    let Distance { differing, max_level, mean_level, rms_level, .. } = point.error;
    fields.extend([String::new(), differing.to_string(), max_level.to_string(), mean_level.to_string()]);
    fields.push(rms_level.to_string());
    fields.extend(std::iter::repeat_n(String::new(), 9));
    fields.push(point.pixels.to_string());
    fields.extend([point.inside.rms_level.to_string(), point.outside.rms_level.to_string(), point.wall.listed()]);
    fields
}
