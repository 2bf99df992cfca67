//! What comes from a page, in JSON.

use serde::Deserialize;

use super::preview::PreviewMode;

/// What a page asks for; `do` says which.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PageRequest {
    /// The messages up to this number have been drawn.
    Ack {
        /// The number.
        through: u32,
    },
    /// Move the eye around what it looks at, in radians.
    Orbit {
        /// To the right.
        right: f64,
        /// Upwards.
        up: f64,
    },
    /// Turn the view, in radians.
    Turn {
        /// To the right.
        right: f64,
        /// Upwards.
        up: f64,
    },
    /// Move eye and target along the picture's axes, in parts of the distance of the spheres.
    Fly {
        /// To the right.
        right: f64,
        /// Upwards.
        up: f64,
        /// Forwards.
        forward: f64,
    },
    /// Multiply the distance to what the eye looks at.
    Zoom {
        /// By this, > 0.
        by: f64,
    },
    /// Put the eye where the page's address says, in the words of the command line.
    Look {
        /// `--eye`.
        eye: [f64; 3],
        /// `--look-at`.
        look_at: [f64; 3],
        /// `--up`.
        up: [f64; 3],
    },
    /// Back to the view of the start.
    Reset,
    /// Options of the command line, each as its text; what is absent stays.
    Choose {
        /// `--convention`, or `start` for the settings of the command line.
        convention: Option<String>,
        /// `--effects`.
        effects: Option<String>,
        /// `--precision`.
        precision: Option<String>,
        /// `--max-depth`.
        max_depth: Option<u32>,
        /// `--spp`.
        spp: Option<u32>,
        /// `--res`, or empty for the scene's own.
        res: Option<String>,
    },
    /// One looks at this place of the picture, in parts of it from its top left.
    Gaze {
        /// From the left.
        x: f64,
        /// From the top.
        y: f64,
    },
    /// How moving pictures are sampled; what is absent stays.
    Preview {
        /// What they have fewer of.
        mode: Option<PreviewMode>,
        /// The least part of the pixels that is sampled.
        least: Option<f64>,
        /// Radius of the fovea, in parts of the picture's shorter side.
        radius: Option<f64>,
        /// Its falloff, in the same unit.
        falloff: Option<f64>,
    },
    /// Say what pixel (column `x`, row `y`) of the picture shows.
    Pick {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// Send the finished picture as a PNG file.
    Save,
    /// Measure what each effect costs.
    Measure,
}
