//! Foveated and sparse sampling: where a picture has samples, and how the pixels between them are filled.
//!
//! A [`Density`] says how many pixels are sampled at each place; a fixed order of the pixels decides which, so that a greater
//! density only adds samples. A sampled pixel has the very value of the full picture. The others take that of their nearest
//! sample, or a mean of samples around them: `src/cpu/fill.rs` and `shaders/jump.wgsl`, `shaders/filled_*.wgsl` do the same.

mod density;
mod order;
mod samples;

use std::fmt;

use clap::ValueEnum;
use serde::Serialize;

pub use density::{Density, Fovea};
pub use order::{is_sampled, rank};
pub use samples::{MAX_PIXELS, MAX_SIDE, Samples};

/// How pixels without a sample are filled.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Fill {
    /// By the nearest sample, found by jump flooding; of equally near ones the upper one, then the left one.
    #[default]
    Nearest,
    /// By the mean of samples around, the nearer the heavier.
    Smooth,
}

impl Fill {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Nearest, Self::Smooth];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nearest => "nearest",
            Self::Smooth => "smooth",
        }
    }
}

impl fmt::Display for Fill {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The nearest sample of a pixel before any is known.
pub(crate) const NO_SAMPLE: u32 = u32::MAX;

/// Weight of a sample at distance 1 in a mean, so that nine weighted levels fit into 32 bits.
pub(crate) const UNIT_WEIGHT: u32 = 1 << 16;

/// The place of a pixel in 32 bits: the row in the upper half, so that a smaller number is farther up, or farther left.
pub fn packed([x, y]: [u32; 2]) -> u32 {
    (y << 16) | x
}

/// The steps of a flood that begins with `reach`: 1 first, which repairs most of what jumps miss ("1+JFA"; G. Rong, T.-S. Tan,
/// "Jump Flooding in GPU with Applications to Voronoi Diagram and Distance Transform", 2006), then `reach` halved down to 1.
pub(crate) fn flood_steps(reach: u32) -> Vec<u32> {
    let halved = std::iter::successors(Some(reach), |step| (*step > 1).then_some(step / 2));
    std::iter::once(1).chain(halved).collect()
}
