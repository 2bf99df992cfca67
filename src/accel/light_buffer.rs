//! Lists for shadow rays: all those to one light share an end, so directions from the light are binned like the picture's
//! pixels (Haines, Greenberg, "The Light Buffer: A Shadow-Testing Accelerator", 1986).

use glam::DVec3;
use rayon::prelude::*;

use super::bounds::{Enclosure, Rounding, Solid};
use super::lists::{Binning, Lists};

/// Cells along an edge of a face at the most, so that their number times a rounding error of `f32` stays far below one.
const MAX_ACROSS: f64 = 4096.0;
/// What is added on each side of a sphere, in cells, for the way from a direction to its cell.
const CELL_MARGIN: f64 = 4e-3;
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
    /// Index of the first cell.
    pub first: u32,
}

/// Lists for one or more lights: spheres in ascending order of their least distance from the light.
#[derive(Debug, Clone, Default)]
pub struct LightBuffer {
    /// Six faces a light: +x, −x, +y, −y, +z, −z.
    pub faces: Vec<[Face; 6]>,
    /// The cells of all faces of all lights.
    pub lists: Lists,
    /// What a sphere must be farther from the light than a point, beside [`REACH`] radii, so that neither it nor any that
    /// follows in a list can stand before the point.
    pub slack: f64,
}

impl LightBuffer {
    /// Bins everything that `enclosure` has around each light; `entries` limits their number for each, roughly.
    pub(super) fn new(enclosure: &Enclosure, lights: &[DVec3], entries: u64, rounding: Rounding) -> Self {
        let lists = Lists { offsets: vec![0], entries: Vec::new() };
        let mut buffer = Self { faces: Vec::new(), lists, slack: enclosure.slack() };
        for &light in lights {
            let around = Around::new(enclosure, light, entries, rounding, buffer.lists.cells() as u32);
            let lists = Lists::build(&around);
            let base = buffer.lists.entries.len() as u32;
            buffer.lists.offsets.extend(lists.offsets[1..].iter().map(|offset| base + offset));
            buffer.lists.entries.extend(lists.entries);
            buffer.faces.push(around.faces);
        }
        buffer
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
        self.cell(light, direction).map_or(&[], |cell| self.lists.of(cell))
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
struct Around<'a> {
    enclosure: &'a Enclosure<'a>,
    light: DVec3,
    faces: [Face; 6],
    /// Spheres by their least distance from the light.
    order: Vec<u32>,
    cells: usize,
    first: u32,
    /// Error of u and v.
    error: f64,
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

impl<'a> Around<'a> {
    fn new(enclosure: &'a Enclosure, light: DVec3, entries: u64, rounding: Rounding, first: u32) -> Self {
        let count = enclosure.len();
        // As the kernels calculate it: what they leave out must follow in the list.
        let nearness = |sphere| (enclosure.center(sphere) - light).length() - enclosure.radius(sphere) * REACH;
        let mut keys: Vec<(f32, u32)> = (0..count).into_par_iter().map(|s| (nearness(s) as f32, s as u32)).collect();
        keys.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let order = keys.into_iter().map(|(_, sphere)| sphere).collect();
        let error = 8.0 * rounding.lookups;
        let mut around = Self { enclosure, light, faces: [Face::default(); 6], order, cells: 0, first, error };
        around.cut(entries);
        around
    }

    /// Chooses the cells so that all lists together have no more than about so many entries.
    fn cut(&mut self, entries: u64) {
        let add = |mut extents: [Extent; 6], sphere: usize| {
            self.ranges(sphere, &mut |face, ranges| extents[face] = extents[face].with(ranges));
            extents
        };
        let union = |a: [Extent; 6], b: [Extent; 6]| std::array::from_fn(|face| Extent::union(a[face], b[face]));
        let empty = || [Extent::EMPTY; 6];
        let extents = (0..self.enclosure.len()).into_par_iter().fold(empty, add).reduce(empty, union);

        let sum = |term: fn(&Extent) -> f64| extents.iter().map(term).sum::<f64>();
        let (area, border, count) = (sum(|e| e.area), sum(|e| e.border), sum(|e| e.count));
        let span = |e: &Extent, axis: usize| (e.high[axis] - e.low[axis]).max(0.0);
        let surface: f64 = extents.iter().map(|e| span(e, 0) * span(e, 1)).sum();
        // Cells of edge h: a range of length x meets x/h + 1 of them, so there are area/h² + border/h + count entries.
        let rest = (entries as f64 - count).max(count);
        let cells_per_unit = (-border + (border * border + 4.0 * area * rest).sqrt()) / (2.0 * area).max(1e-300);
        let density = cells_per_unit.min((entries as f64 / surface.max(1e-300)).sqrt());
        let mut first = self.first;
        for (face, extent) in self.faces.iter_mut().zip(&extents) {
            if extent.count == 0.0 {
                continue;
            }
            let longest = span(extent, 0).max(span(extent, 1)).max(1e-30);
            let per_unit = density.min(MAX_ACROSS / longest);
            // The margin of the outermost spheres, and what rounding their ends takes.
            let margin = CELL_MARGIN / per_unit + self.error;
            let low = extent.low.map(|x| f64::from((x - margin) as f32) - margin);
            let cells = [0, 1].map(|axis| ((extent.high[axis] + margin - low[axis]) * per_unit).ceil().max(1.0) as u32);
            *face = Face { low, per_unit, cells, first };
            first += cells[0] * cells[1];
        }
        self.cells = (first - self.first) as usize;
    }

    /// Hands each face that sees the sphere to `emit`, with the ranges of u and v.
    fn ranges(&self, sphere: usize, emit: &mut impl FnMut(usize, [[f64; 2]; 2])) {
        let Solid { center, semi_axes } = self.enclosure.solid(sphere);
        let from_light = center - self.light;
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for (face, depth) in [(2 * axis, from_light[axis]), (2 * axis + 1, -from_light[axis])] {
                let range = |across: usize| slopes(from_light[across], depth, semi_axes[across], semi_axes[axis]);
                if let Some(u) = range(u)
                    && let Some(v) = range(v)
                {
                    emit(face, [u, v].map(|[low, high]| [low - self.error, high + self.error]));
                }
            }
        }
    }
}

impl Binning for Around<'_> {
    fn len(&self) -> usize {
        self.order.len()
    }

    fn cells(&self) -> usize {
        self.cells
    }

    fn sphere(&self, rank: usize) -> u32 {
        self.order[rank]
    }

    fn visit(&self, rank: usize, emit: &mut impl FnMut(usize)) {
        self.ranges(self.order[rank] as usize, &mut |face, ranges| {
            let face = &self.faces[face];
            let [columns, rows] = [0, 1].map(|axis| {
                let place = |x: f64, margin: f64| {
                    let cell = (x - face.low[axis]) * face.per_unit + margin;
                    cell.clamp(0.0, f64::from(face.cells[axis] - 1)) as u32
                };
                place(ranges[axis][0], -CELL_MARGIN)..=place(ranges[axis][1], CELL_MARGIN)
            });
            for row in rows {
                let start = face.first - self.first + row * face.cells[0];
                columns.clone().for_each(|column| emit((start + column) as usize));
            }
        });
    }
}

/// Least and greatest x/depth, cut at the edges of a face, of the ellipse around (x, depth) with semi-axes (sx, sd) where
/// its depth is positive; none where it is not or the face does not see it.
fn slopes(x: f64, depth: f64, sx: f64, sd: f64) -> Option<[f64; 2]> {
    // Wholly behind, or beyond one of the edges, where x = ± FACE_EDGE depth.
    let reach = (sx * sx + FACE_EDGE * FACE_EDGE * sd * sd).sqrt();
    if depth + sd <= 0.0 || x.abs() - FACE_EDGE * depth > reach {
        return None;
    }
    let mut ends = [-FACE_EDGE, FACE_EDGE];
    // Tangents u through the light: (x − u depth)² = sx² + u² sd². Where the light is inside, there are none.
    let (a, c) = (depth * depth - sd * sd, x * x - sx * sx);
    let discriminant = x * x * depth * depth - a * c;
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
