//! Lists for rays from the eye: which spheres each tile of the picture may see.

use rayon::prelude::*;

use super::bounds::{Enclosure, Solid};
use super::lists::{Binning, Lists};
use crate::area::Area;
use crate::camera::Camera;
use crate::census::CHUNK;
use crate::tiles::{Bounds, Projector, TILE};

/// Entries that all lists together may have, beside some per sphere: more make the tiles larger.
const MAX_ENTRIES: u64 = 1 << 22;

/// Edges of tiles, as powers of two, in pixels: the first that is tried, and the least.
const FIRST_SHIFT: u32 = TILE.trailing_zeros();
const LEAST_SHIFT: u32 = 1;
/// Those that are looked at together.
const SHIFTS: [u32; 3] = [LEAST_SHIFT, 2, FIRST_SHIFT];

/// Lists of spheres in ascending order of index, one for each tile of pixels.
#[derive(Debug, Clone, Default)]
pub struct ScreenLists {
    /// Tiles in reading order.
    pub lists: Lists,
    /// A tile's edge in pixels is two to this power.
    pub shift: u32,
    /// Tiles in a row.
    pub across: u32,
    width: u32,
    height: u32,
    /// The part of the picture that the lists are for; elsewhere they are empty.
    area: Area,
}

struct Tiles<'a> {
    /// Where each sphere can be on the picture.
    bounds: &'a [Option<Bounds>],
    projector: &'a Projector,
    shift: u32,
    across: u32,
    down: u32,
}

impl ScreenLists {
    /// Projects everything that `enclosure` has. Where tiles have more than `longest` spheres, on average, they become smaller, if
    /// that helps.
    pub(super) fn new(enclosure: &Enclosure, camera: &Camera, longest: f64) -> Self {
        let limit = MAX_ENTRIES.max(8 * enclosure.len() as u64);
        let projector = Projector::new(camera);
        let bounds = |sphere: usize| {
            let Solid { center, semi_axes } = enclosure.solid(sphere);
            projector.bounds(center, semi_axes)
        };
        let bounds: Vec<_> = (0..enclosure.len()).into_par_iter().map(bounds).collect();
        let (width, height) = projector.size();
        let tiles = |shift: u32| {
            // Whole tiles of the device, which renders what lies beyond the picture, too.
            let [across, down] = [width, height].map(|size| size.next_multiple_of(TILE).div_ceil(1 << shift));
            Tiles { bounds: &bounds, projector: &projector, shift, across, down }
        };
        let first_counts = tiles(FIRST_SHIFT).rectangles(SHIFTS);
        let count = |tiles: &Tiles| match SHIFTS.iter().position(|&shift| shift == tiles.shift) {
            Some(at) => first_counts[at],
            None => tiles.rectangles([tiles.shift])[0],
        };
        let mut chosen = tiles(FIRST_SHIFT);
        let mut entries = count(&chosen);
        while entries + chosen.cells() as u64 > limit && chosen.cells() > 1 {
            chosen = tiles(chosen.shift + 1);
            entries = count(&chosen);
        }
        while chosen.shift > LEAST_SHIFT && entries as f64 > longest * chosen.cells() as f64 {
            // Four times as many: among large spheres their lists would be as long as before.
            let smaller = tiles(chosen.shift - 1);
            let smaller_entries = count(&smaller);
            if smaller_entries > 3 * entries || smaller_entries + smaller.cells() as u64 > limit {
                break;
            }
            (chosen, entries) = (smaller, smaller_entries);
        }
        Self {
            lists: Lists::build(&chosen),
            shift: chosen.shift,
            across: chosen.across,
            width,
            height,
            area: camera.area(),
        }
    }

    /// The index of the tile that pixel (column `i`, row `j`) lies in.
    pub fn tile(&self, i: u32, j: u32) -> usize {
        (j >> self.shift) as usize * self.across as usize + (i >> self.shift) as usize
    }

    /// Which tiles have spheres.
    pub fn cover(&self) -> Cover {
        let has_spheres = self.lists.offsets.windows(2).map(|ends| ends[0] < ends[1]).collect();
        let Self { shift, across, width, height, area, .. } = *self;
        Cover { has_spheres, shift, across, width, height, area }
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
    area: Area,
}

impl Cover {
    /// How many tiles of [`TILE`] pixels any sphere may cover, or a few more.
    pub fn most(&self) -> u64 {
        if self.shift < FIRST_SHIFT {
            return self.covered(0, self.height).len() as u64;
        }
        // Not one by one: a picture may have far more of them than there are lists.
        let listed = self.has_spheres.iter().filter(|has| **has).count() as u64;
        listed << (2 * (self.shift - FIRST_SHIFT))
    }

    /// The part of the picture that it is of.
    pub fn area(&self) -> Area {
        self.area
    }

    /// Top-left pixels of the tiles of [`TILE`] pixels that any sphere may cover, in rows `first` to `first + count`, in
    /// reading order; `first` is a multiple of [`TILE`].
    pub fn covered(&self, first: u32, count: u32) -> Vec<[u32; 2]> {
        let rows = (first..(first + count).min(self.height)).step_by(TILE as usize);
        let columns = (self.area.left / TILE * TILE..self.area.right()).step_by(TILE as usize);
        let places = rows.flat_map(|y| columns.clone().map(move |x| [x, y]));
        // Those that have lists of their own, in each.
        let parts = |first: u32, size: u32| (first..(first + TILE).min(size)).step_by(1 << self.shift);
        let has = |&[x, y]: &[u32; 2]| parts(y, self.height).any(|y| parts(x, self.width).any(|x| self.has([x, y])));
        places.filter(has).collect()
    }

    /// Whether any sphere may cover the pixel in this column and row.
    pub fn has(&self, [x, y]: [u32; 2]) -> bool {
        self.has_spheres[(y >> self.shift) as usize * self.across as usize + (x >> self.shift) as usize]
    }
}

impl Tiles<'_> {
    /// How many tiles the rectangles around the spheres have, for tiles of each of these sizes.
    fn rectangles<const N: usize>(&self, shifts: [u32; N]) -> [u64; N] {
        let area = self.projector.area();
        let add = |sums: [u64; N], bounds: &Bounds| {
            let (columns, rows) =
                (common(bounds.columns, area.left, area.right()), common(bounds.rows, area.top, area.bottom()));
            let (Some(columns), Some(rows)) = (columns, rows) else { return sums };
            let span = |[first, last]: [u32; 2], shift: u32| u64::from((last >> shift) - (first >> shift) + 1);
            std::array::from_fn(|at| sums[at] + span(columns, shifts[at]) * span(rows, shifts[at]))
        };
        let plus = |a: [u64; N], b: [u64; N]| std::array::from_fn(|at| a[at] + b[at]);
        let chunk = |bounds: &[Option<Bounds>]| bounds.iter().flatten().fold([0; N], add);
        self.bounds.par_chunks(CHUNK).map(chunk).reduce(|| [0; N], plus)
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
        let area = self.projector.area();
        let Some(rows) = common(bounds.rows, area.top, area.bottom()) else { return };
        let [first, last] = rows.map(|row| row >> self.shift);
        let tiles =
            |columns: [u32; 2]| common(columns, area.left, area.right()).map(|ends| ends.map(|x| x >> self.shift));
        let whole = tiles(bounds.columns);
        for row in first..=last {
            let ends = if bounds.is_rectangle() {
                whole
            } else {
                tiles(bounds.columns_in([row << self.shift, (row + 1) << self.shift], self.projector))
            };
            let Some([left, right]) = ends else { continue };
            let start = row as usize * self.across as usize;
            emit(start + left as usize, start + right as usize);
        }
    }
}

/// The first and the last of the pixels from the first to the last of these that are also from `first` up to `end`.
fn common([from, to]: [u32; 2], first: u32, end: u32) -> Option<[u32; 2]> {
    let (from, to) = (from.max(first), to.min(end - 1));
    (from <= to).then_some([from, to])
}
