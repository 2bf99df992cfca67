//! Lists for rays from the eye: which spheres each tile of the picture may see.

use rayon::prelude::*;

use super::bounds::{Enclosure, Solid};
use super::lists::{Binning, Lists};
use crate::camera::Camera;
use crate::tiles::{Bounds, TILE};

/// Entries that all lists together may have, beside some per sphere: more make the tiles larger.
const MAX_ENTRIES: u64 = 1 << 22;

/// Lists of spheres in ascending order of index, one for each tile of pixels.
#[derive(Debug, Clone, Default)]
pub struct ScreenLists {
    /// Tiles in reading order.
    pub lists: Lists,
    /// A tile's edge is [`TILE`] pixels times this power of two.
    pub shift: u32,
    /// Tiles in a row.
    pub across: u32,
    width: u32,
    height: u32,
}

struct Tiles<'a> {
    /// Where each sphere can be on the picture.
    bounds: &'a [Option<Bounds>],
    camera: &'a Camera,
    shift: u32,
    across: u32,
    down: u32,
}

impl ScreenLists {
    /// Projects everything that `enclosure` has.
    pub(super) fn new(enclosure: &Enclosure, camera: &Camera) -> Self {
        let limit = MAX_ENTRIES.max(8 * enclosure.len() as u64);
        let bounds = |sphere: usize| {
            let Solid { center, semi_axes } = enclosure.solid(sphere);
            Bounds::new(center, semi_axes, camera)
        };
        let bounds: Vec<_> = (0..enclosure.len()).into_par_iter().map(bounds).collect();
        let mut shift = 0;
        loop {
            let edge = TILE << shift;
            let (across, down) = (camera.width().div_ceil(edge), camera.height().div_ceil(edge));
            let tiles = Tiles { bounds: &bounds, camera, shift, across, down };
            if across * down == 1 || u64::from(across) * u64::from(down) + tiles.rectangles() <= limit {
                let (width, height) = (camera.width(), camera.height());
                return Self { lists: Lists::build(&tiles), shift, across, width, height };
            }
            shift += 1;
        }
    }

    /// The index of the tile that pixel (column `i`, row `j`) lies in.
    pub fn tile(&self, i: u32, j: u32) -> usize {
        let edge = TILE << self.shift;
        (j / edge) as usize * self.across as usize + (i / edge) as usize
    }

    /// Which tiles have spheres.
    pub fn cover(&self) -> Cover {
        let has_spheres = self.lists.offsets.windows(2).map(|ends| ends[0] < ends[1]).collect();
        let Self { shift, across, width, height, .. } = *self;
        Cover { has_spheres, shift, across, width, height }
    }

    /// The spheres that the pixel in column `i` and row `j` may see.
    pub fn at(&self, i: u32, j: u32) -> &[u32] {
        self.lists.of(self.tile(i, j))
    }
}

/// Where the picture may have anything but background.
#[derive(Debug, Clone)]
pub struct Cover {
    /// Of tiles in reading order.
    has_spheres: Vec<bool>,
    shift: u32,
    across: u32,
    width: u32,
    height: u32,
}

impl Cover {
    /// How many tiles of [`TILE`] pixels any sphere may cover, or a few more.
    pub fn most(&self) -> u64 {
        let listed = self.has_spheres.iter().filter(|has| **has).count() as u64;
        listed << (2 * self.shift)
    }

    /// Top-left pixels of the tiles of [`TILE`] pixels that any sphere may cover, in rows `first` to `first + count`, in
    /// reading order; `first` is a multiple of [`TILE`].
    pub fn covered(&self, first: u32, count: u32) -> Vec<[u32; 2]> {
        let edge = TILE << self.shift;
        let tile = |x: u32, y: u32| (y / edge) as usize * self.across as usize + (x / edge) as usize;
        let rows = (first..(first + count).min(self.height)).step_by(TILE as usize);
        let places = rows.flat_map(|y| (0..self.width).step_by(TILE as usize).map(move |x| [x, y]));
        places.filter(|&[x, y]| self.has_spheres[tile(x, y)]).collect()
    }
}

impl Cover {
    /// Whether any sphere may cover the pixel in this column and row.
    pub fn has(&self, [x, y]: [u32; 2]) -> bool {
        let edge = TILE << self.shift;
        self.has_spheres[(y / edge) as usize * self.across as usize + (x / edge) as usize]
    }
}

impl Tiles<'_> {
    /// How many tiles the rectangles around the spheres have.
    fn rectangles(&self) -> u64 {
        let edge = TILE << self.shift;
        let span = |[first, last]: [u32; 2]| u64::from(last / edge - first / edge + 1);
        self.bounds.par_iter().flatten().map(|bounds| span(bounds.rows) * span(bounds.columns)).sum()
    }
}

impl Binning for Tiles<'_> {
    fn len(&self) -> usize {
        self.bounds.len()
    }

    fn cells(&self) -> usize {
        self.across as usize * self.down as usize
    }

    fn visit(&self, rank: usize, emit: &mut impl FnMut(usize, usize)) {
        let Some(bounds) = &self.bounds[rank] else { return };
        let edge = TILE << self.shift;
        for row in bounds.rows[0] / edge..=bounds.rows[1] / edge {
            let [left, right] = bounds.columns_in([row * edge, (row + 1) * edge], self.camera);
            let start = row as usize * self.across as usize;
            emit(start + (left / edge) as usize, start + (right / edge) as usize);
        }
    }
}
