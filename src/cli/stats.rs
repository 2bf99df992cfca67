//! What `--stats` and `--stats-json` say of a picture.

use std::fmt::Write as _;

use serde::Serialize;

use super::color_bar::in_words;
use crate::effects::Effects;
use crate::engine::{Rays, Stages, Times};
use crate::import::ColorScale;
use crate::precision::Selection;
use crate::sampling::{Density, Fill};
use crate::settings::Settings;
use crate::words::{count, visible};

/// What was sampled of a picture, where that is not everything.
#[derive(Debug, Serialize)]
pub(super) struct Sampled {
    #[serde(flatten)]
    pub density: Density,
    pub fill: Fill,
    /// Sampled pixels.
    pub pixels: u64,
    /// Filling the others.
    pub fill_ms: f64,
}

/// What of a device's picture was calculated again.
#[derive(Debug, Serialize)]
pub(super) struct Verified {
    /// Pixels, all of which the reference has, too, but for rounding.
    pub pixels: u64,
    /// What that took.
    pub ms: f64,
}

/// Everything worth knowing of one rendered picture.
#[derive(Debug, Serialize)]
pub(super) struct Stats {
    /// The number of the frame, from 1, where the picture is one of many views.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<u32>,
    pub scene: String,
    pub output: String,
    pub width: u32,
    pub height: u32,
    pub spheres: usize,
    pub lights: usize,
    pub device: String,
    /// What is tuned to the device; the CPU reference has no tuning.
    pub tuning: Option<String>,
    pub settings: Settings,
    pub effects: Effects,
    /// The kernel's tier and why; the CPU reference knows no tiers.
    pub precision: Option<Selection>,
    /// Absent where every pixel is sampled.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampled: Option<Sampled>,
    /// What a colour bar over the picture shows; absent where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color_bar: Option<ColorScale>,
    /// How many pixels are right by which stage; absent where a device's picture is not certified.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certified: Option<Stages>,
    pub rays: Option<Rays>,
    pub not_finite_pixels: u64,
    /// Absent where nothing was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verified: Option<Verified>,
    /// Reading and parsing the scene.
    pub parse_ms: f64,
    /// Finding and opening the device.
    pub open_ms: f64,
    #[serde(flatten)]
    pub times: Times,
    /// Encoding and writing the file.
    pub write_ms: f64,
    /// All of the above, from the scene file to the picture file.
    pub total_ms: f64,
    /// The most memory that the process has had so far, in MiB, the driver's included; only Linux tells.
    pub peak_memory_mib: Option<f64>,
}

/// [`Stats::peak_memory_mib`].
pub(super) fn peak_memory_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let kib = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix("kB"))?;
    kib.trim().parse::<f64>().ok().map(|kib| kib / 1024.0)
}

impl Stats {
    /// A line for everybody.
    pub(super) fn summary(&self) -> String {
        let Self { width, height, output, device, total_ms, .. } = self;
        format!("{}: {width} × {height} on {device} in {total_ms:.0} ms", visible(output))
    }

    pub(super) fn table(&self) -> String {
        let mut text = String::new();
        let mut row = |name: &str, value: String| {
            let _ = writeln!(text, "  {name:<18} {value}");
        };
        row("picture", format!("{} × {}", self.width, self.height));
        row("scene", format!("{}, {}", count(self.spheres as u64, "sphere"), count(self.lights as u64, "light")));
        row("device", self.device.clone());
        if let Some(tuning) = &self.tuning {
            row("tuning", tuning.clone());
        }
        row("effects", format!("{} (depth {})", self.effects.set, self.effects.depth));
        if let Some(selection) = &self.precision {
            row("precision", format!("{selection}: {}", selection.reason));
        }
        match (&self.certified, &self.precision) {
            (Some(stages), Some(selection)) => row("certified", stages.in_words(selection.tier)),
            (Some(stages), None) => row("decisions", stages.decisions_in_words()),
            (None, _) => {}
        }
        if let Some(Sampled { fill, pixels, .. }) = &self.sampled {
            let all = u64::from(self.width) * u64::from(self.height);
            let part = *pixels as f64 * 100.0 / all as f64;
            row("sampled", format!("{pixels} of {all} pixels ({part:.1} %), the others filled: {fill}"));
        }
        if let Some(scale) = &self.color_bar {
            row("drawn over it", in_words(scale));
        }
        if let Some(Rays { primary, shadow, reflection }) = self.rays {
            row("rays", format!("{primary} primary, {shadow} shadow, {reflection} reflection"));
        }
        if let Some(Verified { pixels, ms }) = &self.verified {
            row("verified", format!("{pixels} pixels by the CPU reference in {ms:.3} ms"));
        }
        let times = [
            ("parse", self.parse_ms),
            ("open device", self.open_ms),
            ("prepare", self.times.prepare_ms),
            ("compile", self.times.compile_ms),
            ("render", self.times.render_ms),
            ("read back", self.times.read_back_ms),
            ("write", self.write_ms),
            ("total", self.total_ms),
        ];
        for (name, ms) in times {
            row(name, format!("{ms:>10.3} ms"));
        }
        if let Some(Sampled { fill_ms, .. }) = &self.sampled {
            row("fill", format!("{fill_ms:>10.3} ms"));
        }
        if self.times.dispatches > 0 {
            let Times { dispatches, longest_dispatch_ms, .. } = self.times;
            row("dispatches", format!("{dispatches}, longest {longest_dispatch_ms:.3} ms"));
        }
        if let Some(mib) = self.peak_memory_mib {
            row("peak memory", format!("{mib:.0} MiB"));
        }
        text
    }
}
