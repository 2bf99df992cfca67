//! A uniform grid for rays that share nothing: reflections.

use glam::{DVec3, IVec3, UVec3};
use rayon::prelude::*;

use super::bounds::{Enclosure, Rounding, Solid};
use super::lists::{Binning, Lists};

/// Cells along an axis at the most, so that their number times a rounding error of `f32` stays far below one.
const MAX_ACROSS: f64 = 512.0;
/// What is added on each side of a sphere, in cells, for the walk's own rounding.
const CELL_MARGIN: f64 = 4e-3;
/// Rounding errors of the place where a ray enters, relative to the greatest coordinate: some six operations on differences of two
/// places, each of them as large as two such coordinates along each axis, and some more.
const PLACE_STEPS: f64 = 16.0;
/// Spheres outside the cells at the most: every ray is tested against each of them.
pub const MAX_LARGE: usize = 16;
/// A hit that is nearer than the end of a cell by this factor ends the walk: the hits in later cells are good to far less.
pub const WALK_SLACK: f64 = 1.0 + 1.0 / 1024.0;
/// A sphere this many times larger than the typical one does not belong into cells made for that.
const LARGE: f64 = 32.0;
/// Spheres among which the typical size is sought.
const MAX_SAMPLE: usize = 4096;

/// Cells of equal size, and the spheres that are too large for them.
#[derive(Debug, Clone)]
pub struct Grid {
    /// The corner with the least coordinates; `f32` holds it.
    pub low: DVec3,
    /// Cells per unit of length along each axis; `f32` holds it.
    pub per_unit: DVec3,
    /// Number of cells along each axis.
    pub cells: UVec3,
    /// Spheres of each cell, x fastest; the last list has the large spheres, which are in no cell. In ascending order of
    /// index.
    pub lists: Lists,
}

struct Cells<'a> {
    enclosure: &'a Enclosure<'a>,
    is_large: Vec<u32>,
    low: DVec3,
    per_unit: DVec3,
    cells: UVec3,
    margin: DVec3,
}

impl Grid {
    /// Bins everything that `enclosure` has, with so many cells for each sphere, roughly.
    pub(super) fn new(enclosure: &Enclosure, cells_per_sphere: f64, rounding: Rounding) -> Self {
        let large = large_spheres(enclosure);
        let is_small = |sphere: &usize| large.binary_search(&(*sphere as u32)).is_err();
        let small = (0..enclosure.len()).into_par_iter().filter(is_small).map(|sphere| enclosure.solid(sphere));
        let ends = small.map(|s| (s.center - s.semi_axes, s.center + s.semi_axes));
        let (low, high) = ends.reduce_with(|(a, b), (c, d)| (a.min(c), b.max(d))).unwrap_or_default();
        let (low, high) = (DVec3::from_array(low.to_array().map(below)), high + DVec3::splat(enclosure.play));
        let size = (high - low).max(DVec3::splat(1e-30));
        // Cells as nearly cubes as the box allows.
        let wanted = cells_per_sphere * (enclosure.len() - large.len()).max(1) as f64;
        let sorted = {
            let mut edges = size.to_array();
            edges.sort_by(f64::total_cmp);
            edges
        };
        // A flat box has one layer of cells.
        let mut edge = (size.x * size.y * size.z / wanted).cbrt();
        if edge > sorted[0] {
            edge = (sorted[1] * sorted[2] / wanted).sqrt();
        }
        if edge > sorted[1] {
            edge = sorted[2] / wanted;
        }
        let limit = 24 * enclosure.len() as u64 + 4096;
        // Devices walk in f32 at every tier.
        let lookups = rounding.lookups.max(Rounding::SINGLE.lookups);
        loop {
            let cells = (size / edge).ceil().clamp(DVec3::ONE, DVec3::splat(MAX_ACROSS));
            let per_unit = cells / size;
            let per_unit = DVec3::from_array(per_unit.to_array().map(|x| f64::from((x as f32).next_down())));
            let margin = DVec3::splat(CELL_MARGIN) + per_unit * (PLACE_STEPS * lookups * enclosure.magnitude);
            let grid = Cells { enclosure, is_large: large.clone(), low, per_unit, cells: cells.as_uvec3(), margin };
            if cells == DVec3::ONE || grid.boxes() <= limit {
                return Self { low, per_unit, cells: grid.cells, lists: Lists::build(&grid) };
            }
            edge *= 1.5;
        }
    }

    /// The cells that the ray origin + t direction meets for t ≥ 0, in order.
    pub fn walk(&self, origin: DVec3, direction: DVec3) -> Walk {
        Walk::new(self, origin, direction)
    }

    /// The list of the spheres that are in no cell.
    pub fn large(&self) -> &[u32] {
        self.lists.of(self.lists.cells() - 1)
    }
}

/// A number of `f32` below `x`, and none that devices may take for 0.
pub(super) fn below(x: f64) -> f64 {
    let below = (x as f32).next_down();
    f64::from(if below.is_subnormal() { below.signum().min(0.0) * f32::MIN_POSITIVE } else { below })
}

/// The few spheres that are far larger than the typical one.
fn large_spheres(enclosure: &Enclosure) -> Vec<u32> {
    let count = enclosure.len();
    let size = |sphere: usize| enclosure.solid(sphere).semi_axes.max_element();
    let with_size = |sphere: usize| (size(sphere), sphere as u32);
    let descending = |a: &(f64, u32), b: &(f64, u32)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
    let mut sizes: Vec<(f64, u32)> = if count > MAX_LARGE {
        // The typical one of a sample.
        let mut sample: Vec<f64> = (0..count).step_by(count.div_ceil(MAX_SAMPLE)).map(size).collect();
        let middle = sample.len() / 2;
        let typical = *sample.select_nth_unstable_by(middle, f64::total_cmp).1;
        (0..count).into_par_iter().map(with_size).filter(|&(size, _)| size > LARGE * typical).collect()
    } else {
        (0..count).map(with_size).collect()
    };
    if sizes.len() > MAX_LARGE {
        sizes.sort_by(descending);
        sizes.truncate(MAX_LARGE);
    }
    let mut large: Vec<u32> = sizes.into_iter().map(|(_, sphere)| sphere).collect();
    large.sort_unstable();
    large
}

impl Cells<'_> {
    /// First and last cell along each axis that the box around the solid meets.
    fn span(&self, solid: &Solid) -> (UVec3, UVec3) {
        let last = (self.cells - UVec3::ONE).as_dvec3();
        let cell = |corner: DVec3| corner.clamp(DVec3::ZERO, last).as_uvec3();
        let place = |corner: DVec3| (corner - self.low) * self.per_unit;
        let [low, high] = [solid.center - solid.semi_axes, solid.center + solid.semi_axes].map(place);
        (cell(low - self.margin), cell(high + self.margin))
    }

    fn solid(&self, sphere: usize) -> Option<Solid> {
        self.is_large.binary_search(&(sphere as u32)).is_err().then(|| self.enclosure.solid(sphere))
    }

    /// How many cells the boxes around the spheres meet.
    fn boxes(&self) -> u64 {
        let boxes = |sphere: usize| {
            let Some(solid) = self.solid(sphere) else { return 0 };
            let (first, last) = self.span(&solid);
            let span = (last - first + UVec3::ONE).as_u64vec3();
            span.x * span.y * span.z
        };
        (0..self.enclosure.len()).into_par_iter().map(boxes).sum()
    }
}

impl Binning for Cells<'_> {
    fn len(&self) -> usize {
        self.enclosure.len()
    }

    fn cells(&self) -> usize {
        (self.cells.x * self.cells.y * self.cells.z) as usize + 1
    }

    fn visit(&self, rank: usize, emit: &mut impl FnMut(usize, usize)) {
        let Some(solid) = self.solid(rank) else {
            emit(self.cells() - 1, self.cells() - 1);
            return;
        };
        let (first, last) = self.span(&solid);
        // Distances in semi-axes: a cell is met where its nearest point is within 1.
        let center = (solid.center - self.low) * self.per_unit;
        let inverse = 1.0 / (solid.semi_axes * self.per_unit + self.margin);
        let gap = |axis: usize, cell: u32| {
            let (low, high) = (f64::from(cell) - center[axis], f64::from(cell) + 1.0 - center[axis]);
            let gap = low.max(-high).max(0.0) * inverse[axis];
            gap * gap
        };
        for z in first.z..=last.z {
            let gap_z = gap(2, z);
            for y in first.y..=last.y {
                let gap_yz = gap_z + gap(1, y);
                // The nearest cell of the row is in the middle, so those that are met lie side by side.
                let is_met = |x: &u32| gap_yz + gap(0, *x) <= 1.0;
                if let Some(left) = (first.x..=last.x).find(is_met) {
                    let right = (left..=last.x).rfind(is_met).unwrap_or(left);
                    let start = (z * self.cells.y + y) * self.cells.x;
                    emit((start + left) as usize, (start + right) as usize);
                }
            }
        }
    }
}

/// One cell on a ray's way.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// Its index.
    pub cell: usize,
    /// t at which the ray leaves it.
    exit: f64,
}

impl Step {
    /// Whether a hit at `t` is nearer than whatever later cells have.
    pub fn ends_the_walk(&self, t: f64) -> bool {
        t * WALK_SLACK < self.exit
    }
}

/// A ray's way through the cells (Amanatides, Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987); read it beside
/// `shaders/grid.wgsl`.
#[derive(Debug, Clone)]
pub struct Walk {
    /// In cells.
    origin: DVec3,
    /// t for each cell's width.
    inverse: DVec3,
    /// t at which the ray leaves the grid; before 0 where it misses it.
    leave: f64,
    step: DVec3,
    /// What a step along each axis adds to the index of the cell.
    strides: IVec3,
    /// Where the ray leaves the cell along each axis.
    wall: DVec3,
    cell: i32,
    inside: bool,
}

impl Walk {
    fn new(grid: &Grid, origin: DVec3, direction: DVec3) -> Self {
        let size = grid.cells.as_dvec3();
        let origin = (origin - grid.low) * grid.per_unit;
        let direction = direction * grid.per_unit;
        // A direction along a plane never leaves it.
        let inverse = DVec3::from_array(direction.to_array().map(|d| if d.abs() < 1e-30 { 1e38 } else { 1.0 / d }));
        let ends = [-origin * inverse, (size - origin) * inverse];
        let enter = ends[0].min(ends[1]).max_element().max(0.0);
        let leave = ends[0].max(ends[1]).min_element();
        let inside = enter <= leave;
        let place = (origin + direction * enter).floor().clamp(DVec3::ZERO, size - DVec3::ONE);
        let is_ahead = inverse.cmpge(DVec3::ZERO);
        let step = DVec3::select(is_ahead, DVec3::ONE, DVec3::NEG_ONE);
        let cells = grid.cells.as_ivec3();
        let strides = IVec3::new(1, cells.x, cells.x * cells.y);
        let cell = place.as_ivec3().dot(strides);
        let strides = strides * step.as_ivec3();
        Self { origin, inverse, leave, step, strides, wall: place + step.max(DVec3::ZERO), cell, inside }
    }
}

impl Iterator for Walk {
    type Item = Step;

    fn next(&mut self) -> Option<Step> {
        if !self.inside {
            return None;
        }
        let cell = self.cell as usize;
        // From the place of the wall, since a sum would drift.
        let next = (self.wall - self.origin) * self.inverse;
        let DVec3 { x, y, z } = next;
        // Whatever the comparisons say, of NaN even, one axis is taken, so that the walk ends.
        let axis = if x <= y && x <= z { 0 } else { 1 + usize::from(!(y <= z)) };
        let exit = next[axis];
        // `leave` is of the last walls, by the very same operations.
        self.inside = exit < self.leave;
        self.wall[axis] += self.step[axis];
        self.cell += self.strides[axis];
        Some(Step { cell, exit })
    }
}
