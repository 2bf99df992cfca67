//! What is tuned to a class of devices: the one place for the numbers that decide how soon a picture is there, and never
//! what it shows.

mod knobs;
mod stored;

use serde::{Deserialize, Serialize};

use crate::accel::Density;
pub use knobs::{KNOBS, Knob};
pub use stored::{IGNORE, Source, StoredTuning, load, save};

/// The numbers. Every combination within the limits of [`KNOBS`] gives the same picture, byte for byte.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tuning {
    /// Invocations of a workgroup of the kernel that is over paths, not over tiles.
    pub workgroup: u32,
    /// Paths that an invocation walks, one after another, through the lists of many spheres.
    pub paths: u32,
    /// Entries of the grid's lists below which there are so few that whoever casts a primary ray follows the mirrored ones, too.
    pub in_place_below: f64,
    /// Entries of the grid's lists from which on there are many.
    pub in_turn_from: f64,
    /// Whether kernels read a scene from textures instead of storage buffers.
    pub texture_tables: bool,
    /// How fine the lists of spheres are.
    pub density: Density,
    /// Memory for the paths of a dispatch at the most, in MiB.
    pub path_mib: u32,
    /// How long a dispatch should take, in ms: long enough to hide its overhead, far below what loses a device.
    pub dispatch_ms: f64,
    /// Intersection tests of the first dispatch, before any is measured: some milliseconds on the slowest device of the
    /// class.
    pub first_dispatch_tests: f64,
}

/// A dispatch of which nobody notices that it cannot be interrupted.
const INTERACTIVE_MS: f64 = 25.0;

/// More entries than any device holds.
const NEVER: f64 = 1e9;

/// Devices that want the same numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Class {
    /// A driver that calculates on the CPU, such as lavapipe.
    Software,
    /// A GPU that shares the CPU's memory.
    Integrated,
    /// A GPU with memory of its own, or one that is passed through to a virtual machine.
    Discrete,
}

impl Class {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Software => "software",
            Self::Integrated => "integrated",
            Self::Discrete => "discrete",
        }
    }
}

impl Tuning {
    /// What a class of devices begins with. The numbers for software are measured, with lavapipe, and those for discrete
    /// devices with an NVIDIA H200, where `trueray bench --tune` found nothing better; of integrated ones none was at hand.
    pub const fn of(class: Class) -> Self {
        let software = Self {
            workgroup: 16,
            paths: 32,
            in_place_below: 1e4,
            in_turn_from: 1e4,
            // lavapipe takes 1.45 to 1.75 times as long with storage buffers: 10 to 100,000 spheres, 1920×1080.
            texture_tables: true,
            density: Density::DEFAULT,
            // All of it is set to 0 before the first dispatch, which takes lavapipe some 20 ms for as much more.
            path_mib: 32,
            // No watchdog guards them, and their threads wait for each other at the end of each.
            dispatch_ms: 200.0,
            first_dispatch_tests: 4e6,
        };
        // Its invocations do not wait for each other in the same way, and it wants more of them: measured on a discrete one, where
        // 32 paths an invocation take five to eight times as long. Following them in place was not measured on one.
        let hardware = Self {
            workgroup: 64,
            path_mib: 64,
            dispatch_ms: INTERACTIVE_MS,
            in_place_below: 0.0,
            in_turn_from: NEVER,
            texture_tables: false,
            ..software
        };
        match class {
            Class::Software => software,
            Class::Integrated => Self { first_dispatch_tests: 16e6, ..hardware },
            Class::Discrete => Self { first_dispatch_tests: 64e6, ..hardware },
        }
    }

    /// With dispatches short enough for someone who may change their mind.
    pub(crate) fn interactive(self) -> Self {
        Self { dispatch_ms: self.dispatch_ms.min(INTERACTIVE_MS), ..self }
    }

    /// The first number that is out of its limits, in words.
    pub fn problem(&self) -> Option<String> {
        KNOBS.iter().find_map(|knob| {
            let value = (knob.get)(self);
            let [least, greatest] = knob.limits;
            let fits = value >= least && value <= greatest;
            (!fits).then(|| format!("{} is {value}, not from {least} to {greatest}", knob.name))
        })
    }

    /// How this differs from `other`, a number after the other; empty where it does not.
    pub fn difference(&self, other: &Self) -> String {
        let differing = KNOBS.iter().filter(|knob| (knob.get)(self) != (knob.get)(other));
        let words: Vec<_> = differing.map(|knob| format!("{} {}", knob.name, (knob.get)(self))).collect();
        words.join(", ")
    }
}
