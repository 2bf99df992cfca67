//! What goes over the WebSocket: JSON from the page; to the page JSON for words and binary messages for pixels.
//!
//! Every message to the page has a number, one more than the last; `{"do": "ack", "through": n}` acknowledges all up to n.
//!
//! A patch is, in little-endian `u32`s: [`PATCH`], its number, the picture's width and height, the step k, the number of
//! rectangles; then for each rectangle its left, top, width and height in pixels of the picture, followed by its pixels, 3
//! bytes each, row by row. With step k > 1 each pixel that is sent stands for k × k of the picture, whose corner it has.
//! Pictures of which a part is sampled go in messages of their own: `places.rs` has them.

use serde::Deserialize;

/// First word of a message with pixels.
pub const PATCH: u32 = 1;
/// First word of a message whose rest, from the third word on, is a PNG file.
pub const PICTURE_FILE: u32 = 2;

/// What a page asks for.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum FromPage {
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
    /// Back to the view of the start.
    Reset,
    /// Options of the command line, each as its text; what is absent stays.
    Choose {
        /// `--convention`.
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
    Attend {
        /// What they have fewer of: `foveated`, `sparse`, `coarse`.
        economy: Option<String>,
        /// The least part of the pixels that is sampled.
        least: Option<f64>,
        /// Radius of the fovea, in parts of the picture's shorter side.
        radius: Option<f64>,
        /// Its falloff, likewise.
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

/// A rectangle of the picture, in its pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rectangle {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// A message with pixels that is being written, or has been read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Patch {
    /// Size of the picture in pixels.
    pub size: (u32, u32),
    /// Pixels of the picture that one sent pixel stands for, on each side.
    pub step: u32,
    /// The rectangles with their pixels, 3 bytes each.
    pub parts: Vec<(Rectangle, Vec<u8>)>,
}

impl Patch {
    /// Columns and rows that are sent of a rectangle.
    pub fn sent(&self, part: &Rectangle) -> (usize, usize) {
        (part.width.div_ceil(self.step) as usize, part.height.div_ceil(self.step) as usize)
    }

    /// The message; its number is written by whoever sends it.
    pub fn encode(&self) -> Vec<u8> {
        let bytes = 24 + self.parts.iter().map(|(_, rgb)| 16 + rgb.len()).sum::<usize>();
        let mut message = Vec::with_capacity(bytes);
        let head = [PATCH, 0, self.size.0, self.size.1, self.step, self.parts.len() as u32];
        message.extend(head.iter().flat_map(|word| word.to_le_bytes()));
        for (part, rgb) in &self.parts {
            message.extend([part.x, part.y, part.width, part.height].iter().flat_map(|side| side.to_le_bytes()));
            message.extend_from_slice(rgb);
        }
        message
    }

    /// Reads a message; `None` where it is none.
    pub fn decode(message: &[u8]) -> Option<Self> {
        let (head, mut rest) = words::<6>(message)?;
        let [PATCH, _, width, height, step, count] = head else { return None };
        if step == 0 {
            return None;
        }
        let mut patch = Self { size: (width, height), step, parts: Vec::new() };
        for _ in 0..count {
            let ([x, y, width, height], tail) = words(rest)?;
            let part = Rectangle { x, y, width, height };
            let (columns, rows) = patch.sent(&part);
            let (rgb, tail) = tail.split_at_checked(columns * rows * 3)?;
            patch.parts.push((part, rgb.to_vec()));
            rest = tail;
        }
        rest.is_empty().then_some(patch)
    }
}

/// The first words, and the rest.
fn words<const N: usize>(message: &[u8]) -> Option<([u32; N], &[u8])> {
    let (head, rest) = message.split_at_checked(4 * N)?;
    let words = head.as_chunks::<4>().0;
    Some((std::array::from_fn(|index| u32::from_le_bytes(words[index])), rest))
}
