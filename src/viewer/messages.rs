//! What a page is told in JSON; `page.html` reads these fields.

use serde::Serialize;

use super::effect_cost::EffectTimes;
use super::preview::PreviewOptions;
use super::scene_file::SceneError;
use crate::cpu::Margin;
use crate::effects;
use crate::engine::Times;
use crate::pixel::Beside;
use crate::precision::Tier;
use crate::sampling::Density;
use crate::settings::Convention;

/// A message to a page; `is` says which.
#[derive(Debug, Serialize)]
#[serde(tag = "is", rename_all = "kebab-case")]
pub enum PageMessage<'a> {
    /// The picture and its view.
    State(Box<PageState<'a>>),
    /// The pixel that was asked for.
    Pixel(PickedPixel<'a>),
    /// The table of the last pixel that was asked for, where its tiers were still to come.
    Tiers(PixelTable<'a>),
    /// What the effects cost, as was asked for.
    Costs {
        /// One for each effect.
        effects: &'a [EffectTimes],
    },
    /// There is no device, and it is tried again.
    Lost {
        /// Why.
        why: &'a str,
    },
    /// This view cannot be rendered, by a fault of the program.
    Failed {
        /// What it says.
        why: &'a str,
    },
}

/// A message with its number.
#[derive(Debug, Serialize)]
pub(super) struct Numbered<'a> {
    pub(super) number: u32,
    #[serde(flatten)]
    pub(super) message: &'a PageMessage<'a>,
}

/// All that a page shows beside its picture.
#[derive(Debug, Serialize)]
pub struct PageState<'a> {
    /// Grows with every change of the view.
    pub version: u64,
    /// How many requests for a view this answers.
    pub heard: u64,
    /// Whether the picture is the one that `trueray render` gives.
    pub finished: bool,
    /// Columns and rows of the picture.
    pub size: (u32, u32),
    /// Whether that is less than was asked for.
    pub shrunk: bool,
    /// Only every so-many-th column and row is rendered.
    pub step: u32,
    /// Samples of a pixel.
    pub samples: u32,
    /// Where not all pixels are sampled, those that are.
    pub sampled: Option<SampledPart>,
    /// How moving pictures are sampled.
    pub preview: PreviewOptions,
    /// From the view to the picture, in ms.
    pub frame_ms: f64,
    /// Where that went.
    pub times: Times,
    /// Pixels that are NaN or infinite.
    pub not_finite: u64,
    /// What renders.
    pub device: String,
    /// Each effect, whether it is on, and why.
    pub effects: &'a [effects::Row],
    /// The tier of the kernel.
    pub tier: Tier,
    /// Why it was taken.
    pub tier_reason: &'a str,
    /// What the page's controls are set to.
    pub controls: Controls,
    /// The eye in the world.
    pub eye: [f64; 3],
    /// Eye, look-at and up as [`PageRequest::Look`](super::requests::PageRequest::Look) takes them; none for the file's camera.
    pub camera: Option<[[f64; 3]; 3]>,
    /// The options of `trueray render` that give this picture.
    pub options: String,
    /// The scene.
    pub scene: SceneSummary<'a>,
    /// Why the file is no scene as it is.
    pub error: Option<&'a SceneError>,
    /// Why there is no picture of the newest view, or what was refused.
    pub problem: Option<&'a str>,
}

/// Pixels of which a picture is sampled.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct SampledPart {
    /// Their number.
    pub pixels: usize,
    /// Where they are.
    pub density: Density,
}

/// What the page's controls are set to, in the words of its requests.
#[derive(Debug, Serialize)]
pub struct Controls {
    /// The convention, where the settings are those of one.
    pub convention: Option<Convention>,
    /// The tier that is asked for.
    pub precision: String,
    /// Greatest number of bounces.
    pub max_depth: u32,
    /// Samples of a pixel of the finished picture.
    pub spp: u32,
    /// `WxH`, or empty for the scene's own.
    pub res: String,
}

/// The scene in numbers.
#[derive(Debug, Serialize)]
pub struct SceneSummary<'a> {
    /// Its file.
    pub file: &'a str,
    /// Number of spheres.
    pub spheres: usize,
    /// Number of lights.
    pub lights: usize,
}

/// What one pixel shows.
#[derive(Debug, Serialize)]
pub struct PickedPixel<'a> {
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// Its levels, once they are rendered.
    pub rgb: Option<[u8; 3]>,
    /// What its ray meets first; none is the background.
    pub hit: Option<PickedHit<'a>>,
    /// All its rays, and what stands beside them.
    pub table: Option<PixelTable<'a>>,
    /// Why there is no such table.
    pub no_table: Option<String>,
}

/// What `trueray pixel` tells of a pixel.
#[derive(Debug, Serialize)]
pub struct PixelTable<'a> {
    /// As it prints it.
    pub text: String,
    /// The reference's colour, unclamped.
    pub color: [f64; 3],
    /// Its levels.
    pub levels: [u8; 3],
    /// The nearest of each kind of decision, the very nearest first.
    pub decisions: &'a [Margin],
    /// What stands beside the reference, as in the command's JSON.
    #[serde(flatten)]
    pub beside: &'a Beside,
    /// Whether tiers are still to come.
    pub waits: bool,
}

/// A sphere that a pixel shows.
#[derive(Debug, Serialize)]
pub struct PickedHit<'a> {
    /// Its index.
    pub sphere: usize,
    /// Its name.
    pub name: &'a str,
    /// Parameter of the ray; 1 is the image plane.
    pub t: f64,
    /// Where, in the world.
    pub position: [f64; 3],
    /// Whether it is the inner wall.
    pub inside: bool,
}
