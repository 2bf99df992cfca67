//! Which pixels of a picture are sampled, in the order in which they are rendered.

use rayon::prelude::*;

use super::density::Density;
use crate::misuse::Misuse;
use crate::tiles::TILE;

/// A picture that is reconstructed is kept as a whole: so many pixels at the most, and on each side.
pub const MAX_PIXELS: u64 = 1 << 25;
/// Places fit into 16 bits, and squares of distances into 32.
pub const MAX_SIDE: u32 = 1 << 15;

/// The sampled pixels of a picture, tile by tile, so that neighbours are rendered together.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    size: (u32, u32),
    pixels: Vec<[u32; 2]>,
    reach: u32,
}

impl Samples {
    /// The pixels that `density` takes.
    ///
    /// # Errors
    ///
    /// [`Misuse::Picture`] where the picture has an [`obstacle`](Self::obstacle).
    pub fn new(size: (u32, u32), density: &Density) -> Result<Self, Misuse> {
        if let Some(obstacle) = Self::obstacle(size) {
            return Err(Misuse::Picture(obstacle));
        }
        let pixels = in_rows(size, (0, size.1), |x, y| density.takes(x, y));
        let reach = reach(size, density.far, &pixels);
        Ok(Self { size, pixels, reach })
    }

    /// Width and height of the picture.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Column and row of each, tiles in reading order, pixels of a tile likewise.
    pub fn pixels(&self) -> &[[u32; 2]] {
        &self.pixels
    }

    /// Each pixel has a sample within less than twice this in columns and in rows: a power of two.
    pub fn reach(&self) -> u32 {
        self.reach
    }

    /// The pixels of rows `first` to `first + count` that `density` does not take.
    pub fn missing((width, height): (u32, u32), first: u32, count: u32, density: &Density) -> Vec<[u32; 2]> {
        in_rows((width, height), (first, first.saturating_add(count).min(height)), |x, y| !density.takes(x, y))
    }

    /// Why a picture of this size cannot be reconstructed.
    pub fn obstacle((width, height): (u32, u32)) -> Option<String> {
        if width == 0 || height == 0 {
            return Some(format!("a picture of {width}x{height} pixels has none to sample"));
        }
        let fits = width.max(height) <= MAX_SIDE && u64::from(width) * u64::from(height) <= MAX_PIXELS;
        (!fits).then(|| {
            format!(
                "a picture of {width}x{height} pixels is too large to be sampled in part: that takes at most {MAX_PIXELS} pixels, \
                 and {MAX_SIDE} on each side"
            )
        })
    }
}

/// The pixels of some rows that have the property.
fn in_rows((width, _): (u32, u32), (first, end): (u32, u32), takes: impl Fn(u32, u32) -> bool + Sync) -> Vec<[u32; 2]> {
    let tile_rows: Vec<u32> = (first..end).step_by(TILE as usize).collect();
    let of_tile_row = |&top: &u32| {
        let mut pixels = Vec::new();
        for left in (0..width).step_by(TILE as usize) {
            for y in top..(top + TILE).min(end) {
                pixels.extend((left..(left + TILE).min(width)).filter(|&x| takes(x, y)).map(|x| [x, y]));
            }
        }
        pixels
    };
    tile_rows.par_iter().map(of_tile_row).collect::<Vec<_>>().concat()
}

/// The least power of two, about the distance of neighbours or more, such that each square of this side has a sample. At the
/// edges what is left of a square belongs to the one beside it, so that a pixel lies within less than twice the side of a sample.
fn reach((width, height): (u32, u32), far: f64, pixels: &[[u32; 2]]) -> u32 {
    let whole = width.max(height).next_power_of_two();
    let mut side = (1.0 / far.sqrt()).min(f64::from(whole)) as u32;
    loop {
        side = side.next_power_of_two();
        let (across, down) = ((width / side).max(1), (height / side).max(1));
        let mut has_sample = vec![false; across as usize * down as usize];
        for [x, y] in pixels {
            has_sample[(y / side).min(down - 1) as usize * across as usize + (x / side).min(across - 1) as usize] =
                true;
        }
        if side >= whole || has_sample.iter().all(|has| *has) {
            return side;
        }
        side *= 2;
    }
}
