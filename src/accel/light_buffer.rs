//! Lists for shadow rays: all those to one light share an end, so directions from the light are binned like the picture's
//! pixels (Haines, Greenberg, "The Light Buffer: A Shadow-Testing Accelerator", 1986).

use bytemuck::{Zeroable, zeroed_vec};
use glam::DVec3;
use rayon::prelude::*;

use super::bounds::{Enclosure, Rounding, Solid};
use super::lists::{Binning, Lists};

/// Cells along an edge of a face at the most, so that their number times a rounding error of `f32` stays far below one.
const MAX_ACROSS: f64 = 4096.0;
/// What is added on each side of a sphere, in cells, for the way from a direction to its cell.
const CELL_MARGIN: f64 = 4e-3;
/// Rounding errors of u and v: of the place of the light, of the direction from it, of the quotient, and of the face's least u
/// and v, two or three each.
const LOOKUP_STEPS: f64 = 16.0;
/// Faces reach a little beyond the edges of the cube: rounding may take a direction for one of the next face.
const FACE_EDGE: f64 = 1.0 + 1e-4;

/// Radii that a sphere reaches towards the light, rounding included.
pub const REACH: f64 = 1.01;

/// One side of the cube around a light: directions whose greatest component is that of `axis`, with its sign.
///
/// u and v of a direction are the components that follow the axis, cyclically, over the absolute value of the greatest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Face {
    /// Least u and v of any sphere.
    pub low: [f64; 2],
    /// Cells per unit of u and v.
    pub per_unit: f64,
    /// Number of cells along u and v; 0 where there is no sphere.
    pub cells: [u32; 2],
    /// Index of the first cell among those of the light.
    pub first: u32,
}

impl Face {
    /// The cells that ranges of u and v meet on this face, which is number `index`.
    fn rectangle(&self, index: usize, ranges: [[f64; 2]; 2]) -> Rectangle {
        let place = |axis: usize, end: usize, margin: f64| {
            let cell = (ranges[axis][end] - self.low[axis]) * self.per_unit + margin;
            cell.clamp(0.0, f64::from(self.cells[axis] - 1)) as u32
        };
        let [low, high] =
            [(0, -CELL_MARGIN), (1, CELL_MARGIN)].map(|(end, margin)| [place(0, end, margin), place(1, end, margin)]);
        Rectangle::new(index, [low[0], low[1], high[0], high[1]])
    }
}

/// Lists for one or more lights: spheres in ascending order of their least distance from the light.
#[derive(Debug, Clone, Default)]
pub struct LightBuffer {
    /// Six faces a light: +x, −x, +y, −y, +z, −z.
    pub faces: Vec<[Face; 6]>,
    /// The cells of all faces of each light.
    pub lists: Vec<Lists>,
    /// What a sphere must be farther from the light than a point, beside [`REACH`] radii, so that neither it nor any that
    /// follows in a list can stand before the point.
    pub slack: f64,
}

impl LightBuffer {
    /// Bins everything that `enclosure` has around each light; `entries` limits their number for each, roughly.
    pub(super) fn new(enclosure: &Enclosure, lights: &[DVec3], entries: u64, rounding: Rounding) -> Self {
        let arounds = lights.iter().map(|&light| {
            let around = Around::new(enclosure, light, entries, rounding);
            (around.faces, Lists::build(&around))
        });
        let (faces, lists) = arounds.unzip();
        Self { faces, lists, slack: enclosure.slack() }
    }

    /// The cell of a direction from the light with this index; none where no sphere is.
    pub fn cell(&self, light: usize, direction: DVec3) -> Option<usize> {
        let (face, [u, v]) = face_of(direction);
        let face = &self.faces[light][face];
        let [x, y] = [(u - face.low[0]) * face.per_unit, (v - face.low[1]) * face.per_unit];
        let [across, down] = face.cells;
        let inside = x >= 0.0 && y >= 0.0 && x < f64::from(across) && y < f64::from(down);
        inside.then(|| face.first as usize + y as usize * across as usize + x as usize)
    }

    /// The spheres that may stand between the light and whatever lies in this direction from it.
    pub fn at(&self, light: usize, direction: DVec3) -> &[u32] {
        self.cell(light, direction).map_or(&[], |cell| self.lists[light].of(cell))
    }
}

/// The face that a direction belongs to, and u and v on it.
fn face_of(direction: DVec3) -> (usize, [f64; 2]) {
    let size = direction.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let inverse = 1.0 / size[axis];
    let uv = [direction[(axis + 1) % 3] * inverse, direction[(axis + 2) % 3] * inverse];
    (2 * axis + usize::from(direction[axis] < 0.0), uv)
}

/// The spheres around one light.
struct Around {
    faces: [Face; 6],
    /// What each sphere reaches on each face that sees it, in ascending order of the spheres' least distance from the light.
    reaches: Vec<(Key, Rectangle)>,
    cells: usize,
}

/// A sphere's least distance from the light as bits in the order of the numbers, and then its index.
type Key = u64;

fn key(distance: f32, sphere: usize) -> Key {
    let bits = distance.to_bits();
    let ascending = bits ^ if distance.is_sign_negative() { u32::MAX } else { 1 << 31 };
    u64::from(ascending) << 32 | sphere as u64
}

/// Cells of a face, in one word: the face, first column and row, last column and row.
#[derive(Debug, Clone, Copy, Zeroable)]
struct Rectangle(u64);

impl Rectangle {
    /// Bits of a column or row, which are at most [`MAX_ACROSS`] and two.
    const BITS: u32 = 13;

    fn new(face: usize, corners: [u32; 4]) -> Self {
        Self(corners.iter().fold(face as u64, |bits, &corner| bits << Self::BITS | u64::from(corner)))
    }

    fn face(self) -> usize {
        (self.0 >> (4 * Self::BITS)) as usize
    }

    fn corners(self) -> [u32; 4] {
        [3, 2, 1, 0].map(|place| (self.0 >> (place * Self::BITS)) as u32 & ((1 << Self::BITS) - 1))
    }
}

/// What decides how fine a face is cut.
#[derive(Debug, Clone, Copy)]
struct Extent {
    low: [f64; 2],
    high: [f64; 2],
    /// Sums over the spheres: of u range times v range, and of both ranges.
    area: f64,
    border: f64,
    count: f64,
}

impl Extent {
    const EMPTY: Self =
        Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2], area: 0.0, border: 0.0, count: 0.0 };

    fn with(mut self, [u, v]: [[f64; 2]; 2]) -> Self {
        self.low = [self.low[0].min(u[0]), self.low[1].min(v[0])];
        self.high = [self.high[0].max(u[1]), self.high[1].max(v[1])];
        self.area += (u[1] - u[0]) * (v[1] - v[0]);
        self.border += (u[1] - u[0]) + (v[1] - v[0]);
        self.count += 1.0;
        self
    }

    fn union(a: Self, b: Self) -> Self {
        Self {
            low: [a.low[0].min(b.low[0]), a.low[1].min(b.low[1])],
            high: [a.high[0].max(b.high[0]), a.high[1].max(b.high[1])],
            area: a.area + b.area,
            border: a.border + b.border,
            count: a.count + b.count,
        }
    }
}

/// Spheres that one task takes at a time: sums over them are added in the same order whatever the number of threads.
const CHUNK: usize = 4096;

impl Around {
    /// Looks at each sphere twice: keeping its ranges until the faces are cut would take twice as much memory.
    fn new(enclosure: &Enclosure, light: DVec3, entries: u64, rounding: Rounding) -> Self {
        let error = LOOKUP_STEPS * rounding.lookups;
        let count = enclosure.len();
        let spheres = |chunk: usize| chunk * CHUNK..count.min((chunk + 1) * CHUNK);
        let extents = |chunk: usize| {
            let mut extents = [Extent::EMPTY; 6];
            for sphere in spheres(chunk) {
                let Solid { center, semi_axes } = enclosure.solid(sphere);
                for_each_face(center - light, semi_axes, error, |face, ranges| {
                    extents[face] = extents[face].with(ranges);
                });
            }
            extents
        };
        let found: Vec<[Extent; 6]> = (0..count.div_ceil(CHUNK)).into_par_iter().map(extents).collect();
        let union = |a: [Extent; 6], b: &[Extent; 6]| std::array::from_fn(|face| Extent::union(a[face], b[face]));
        let (faces, cells) = cut(&found.iter().fold([Extent::EMPTY; 6], union), entries, error);

        // As many places for each task as it found faces.
        let lens = found.iter().map(|extents| extents.iter().map(|extent| extent.count).sum::<f64>() as usize);
        let mut reaches: Vec<(Key, Rectangle)> = zeroed_vec(lens.clone().sum());
        let mut rest = reaches.as_mut_slice();
        let parts: Vec<_> = lens.map_while(|len| rest.split_off_mut(..len)).collect();
        parts.into_par_iter().enumerate().for_each(|(chunk, part)| {
            let mut places = part.iter_mut();
            for sphere in spheres(chunk) {
                let Solid { center, semi_axes } = enclosure.solid(sphere);
                let from_light = center - light;
                // As the kernels calculate it: what they leave out must follow in the list.
                let key = key((from_light.length() - enclosure.radius(sphere) * REACH) as f32, sphere);
                for_each_face(from_light, semi_axes, error, |face, ranges| {
                    if let Some(place) = places.next() {
                        *place = (key, faces[face].rectangle(face, ranges));
                    }
                });
            }
        });
        reaches.par_sort_unstable_by_key(|&(key, _)| key);
        Self { faces, reaches, cells }
    }
}

/// The cells, so that all lists together have no more than about so many entries, and their number.
fn cut(extents: &[Extent; 6], entries: u64, error: f64) -> ([Face; 6], usize) {
    let sum = |term: fn(&Extent) -> f64| extents.iter().map(term).sum::<f64>();
    let (area, border, count) = (sum(|e| e.area), sum(|e| e.border), sum(|e| e.count));
    let span = |e: &Extent, axis: usize| (e.high[axis] - e.low[axis]).max(0.0);
    let surface: f64 = extents.iter().map(|e| span(e, 0) * span(e, 1)).sum();
    // Cells of edge h: a range of length x meets x/h + 1 of them, so there are area/h² + border/h + count entries.
    let rest = (entries as f64 - count).max(count);
    let cells_per_unit = 2.0 * rest / (border + (border * border + 4.0 * area * rest).sqrt());
    let density = cells_per_unit.min((entries as f64 / surface.max(1e-300)).sqrt());
    let mut next = 0;
    let faces = extents.map(|extent| {
        if extent.count == 0.0 {
            return Face::default();
        }
        // With what rounding their ends takes: all of them may lie closer together.
        let longest = span(&extent, 0).max(span(&extent, 1)) + 2.0 * error;
        let per_unit = density.min(MAX_ACROSS / longest);
        let margin = CELL_MARGIN / per_unit + error;
        let low = extent.low.map(|x| x - margin);
        let cells = [0, 1].map(|axis| ((extent.high[axis] + margin - low[axis]) * per_unit).ceil().max(1.0) as u32);
        let face = Face { low, per_unit, cells, first: next };
        next += cells[0] * cells[1];
        face
    });
    (faces, next as usize)
}

/// Hands each face that sees the solid to `emit`, with the ranges of u and v, wider by `error` at each end.
fn for_each_face(from_light: DVec3, semi_axes: DVec3, error: f64, mut emit: impl FnMut(usize, [[f64; 2]; 2])) {
    for axis in 0..3 {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let depth = semi_axes[axis];
        for (face, ahead) in [(2 * axis, from_light[axis]), (2 * axis + 1, -from_light[axis])] {
            // Most faces are out of question at once: the solid lies behind, or its box beyond an edge.
            let farthest = FACE_EDGE * (ahead + depth);
            let nearest = |across: usize| from_light[across].abs() - semi_axes[across];
            if farthest <= 0.0 || nearest(u) > farthest || nearest(v) > farthest {
                continue;
            }
            let range = |across: usize| slopes(from_light[across], ahead, semi_axes[across], depth);
            if let (Some(u), Some(v)) = (range(u), range(v)) {
                emit(face, [u, v].map(|[low, high]| [low - error, high + error]));
            }
        }
    }
}

impl Binning for Around {
    fn len(&self) -> usize {
        self.reaches.len()
    }

    fn cells(&self) -> usize {
        self.cells
    }

    fn sphere(&self, rank: usize) -> u32 {
        self.reaches[rank].0 as u32
    }

    fn visit(&self, rank: usize, emit: &mut impl FnMut(usize, usize)) {
        let rectangle = self.reaches[rank].1;
        let face = &self.faces[rectangle.face()];
        let [left, top, right, bottom] = rectangle.corners();
        for row in top..=bottom {
            let start = face.first + row * face.cells[0];
            emit((start + left) as usize, (start + right) as usize);
        }
    }
}

/// Least and greatest x/depth, cut at the edges of a face, of the ellipse around (x, depth) with semi-axes (sx, sd) where
/// its depth is positive; none where it is not or the face does not see it.
fn slopes(x: f64, depth: f64, sx: f64, sd: f64) -> Option<[f64; 2]> {
    // Wholly behind, or beyond one of the edges, where x = ± FACE_EDGE depth.
    let beyond = x.abs() - FACE_EDGE * depth;
    if depth + sd <= 0.0 || (beyond > 0.0 && beyond * beyond > sx * sx + FACE_EDGE * FACE_EDGE * sd * sd) {
        return None;
    }
    let mut ends = [-FACE_EDGE, FACE_EDGE];
    // Tangents u through the light: (x − u depth)² = sx² + u² sd². Where the light is inside, there are none.
    let (a, c) = (depth * depth - sd * sd, x * x - sx * sx);
    let discriminant = x * x * sd * sd + depth * depth * sx * sx - sx * sx * sd * sd;
    if depth > 0.0 && a > 1e-3 * depth * depth {
        // Wholly ahead, and so far that the roots of the quadratic lose no more than some digits.
        let (middle, half) = (x * depth / a, discriminant.max(0.0).sqrt() / a);
        ends = [ends[0].max(middle - half), ends[1].min(middle + half)];
        return (ends[0] <= ends[1]).then_some(ends);
    }
    if discriminant >= 0.0 {
        let q = x * depth + discriminant.sqrt().copysign(x * depth);
        for u in [q / a, c / q] {
            // The whole ellipse lies on one side of the tangent, and so does the part ahead.
            if x > u * depth {
                ends[0] = ends[0].max(u);
            } else {
                ends[1] = ends[1].min(u);
            }
        }
    }
    (ends[0] <= ends[1]).then_some(ends)
}
