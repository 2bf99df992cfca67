//! What encloses a sphere for sure: all that its intersection test, rounding included, may take for a hit.

use glam::DVec3;
use rayon::prelude::*;

use super::kept::{ROOM, moved_at_most};
use crate::camera::Camera;
use crate::census::Extents;
use crate::geometry::extent;
use crate::scene::Sphere;
use crate::viewed::ViewedScene;

/// How a renderer rounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounding {
    /// Unit roundoff of the intersection tests.
    pub tests: f64,
    /// Unit roundoff of the way from a place or a direction to its cell; that of `f32` for the cells of the grid, through which
    /// devices walk so at every tier.
    pub lookups: f64,
    /// Whether there is room for the cones around its rays.
    pub cones: bool,
}

impl Rounding {
    /// `f32` throughout.
    pub const SINGLE: Self = Self { tests: 6e-8, lookups: 6e-8, cones: false };
    /// Error-free transforms of `f32` in the tests.
    pub const COMPENSATED: Self = Self { tests: 1e-12, lookups: 6e-8, cones: false };
    /// Nothing is known: every list has every sphere.
    pub const UNKNOWN: Self = Self { tests: 1e9, lookups: 6e-8, cones: false };
    /// `f64` throughout.
    pub const DOUBLE: Self = Self { tests: 1.2e-16, lookups: 1.2e-16, cones: false };

    /// The same, with room for what the errors of all that came before may move a ray in `f64`.
    pub fn proven(self) -> Self {
        Self { tests: self.tests.max(1e-7), ..self }
    }

    /// The same, of a certified picture: with room for what the errors of all that came before may move a ray.
    pub fn certified(self) -> Self {
        Self { tests: (64.0 * self.tests).max(1e-9), lookups: 4.0 * self.lookups, cones: true }
    }
}

/// What is added to each radius, as a part of it. A ray that starts outside the larger sphere has roots good to a tenth of
/// this even where they nearly cancel, so that a hit can be compared with the ends of cells.
const MARGIN: f64 = 1e-3;

/// Rounding errors of a position in a test, relative to the greatest coordinate of a sphere: some ten operations on differences of
/// two positions, each as large as 2 √3 such coordinates. Those of rays from the eye are half as large, which leaves room for
/// the rounding of the ray's direction: of the vectors of its column and its row, at right angles, and of their sum, together
/// some (√2 + 1) √3 at the greatest distance. What rounding takes from the place of a light turns the rays to it a little; from
/// a point of one sphere to another that moves them by less than the rest, however far away the light is.
const ERROR_STEPS: f64 = 32.0;

/// Semi-axes of what encloses a sphere at the most, in greatest coordinates: beyond, all that a ray can meet looks flat.
const MAX_AXIS: f64 = 1e13;

/// Encloses the spheres of a scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct Enclosure<'a> {
    spheres: &'a [Sphere],
    true_axes: bool,
    /// Error of a position in object space, times the least semi-axis.
    error: f64,
    /// The greatest coordinate of any point of a sphere.
    pub(super) magnitude: f64,
    /// Likewise, or of a light.
    pub(super) reach: f64,
    /// The least and the greatest coordinates of balls around the spheres.
    ends: [DVec3; 2],
    /// How far what is made for it may be moved beside its place.
    pub(super) play: f64,
    rounding: Rounding,
}

impl<'a> Enclosure<'a> {
    /// Of the spheres of `viewed`, or of their bounding spheres without `true_axes`.
    pub(super) fn new(viewed: &'a ViewedScene, true_axes: bool, rounding: Rounding) -> Self {
        let scene = viewed.scene();
        let Extents { magnitude, low, high, .. } = viewed.extents();
        let reach = scene.lights.iter().map(|light| extent(light.position)).fold(magnitude, f64::max);
        // Of the file's numbers they take what the eye at the origin makes of them.
        let start = Camera::new(viewed).position_error(0.0);
        let error = ERROR_STEPS * rounding.tests * magnitude + 2.0 * viewed.moved_by() + 2.0 * start;
        Self { spheres: &scene.spheres, true_axes, error, magnitude, reach, ends: [low, high], play: 0.0, rounding }
    }

    /// The same for lists that [`super::KeptLists`] gives to other eyes, too.
    pub(super) fn for_other_eyes(mut self, viewed: &ViewedScene) -> Self {
        let moved = viewed.moved_by() + moved_at_most(viewed.moved_by(), self.magnitude);
        self.magnitude *= ROOM;
        self.reach *= ROOM;
        self.error = ERROR_STEPS * self.rounding.tests * self.magnitude + 2.0 * moved;
        self.play = 4.0 * f64::from(f32::EPSILON) * self.magnitude;
        self
    }

    /// How far a ray may lie beside where a renderer's tests take it: half of what is taken for their rounding.
    pub(super) fn allowance(&self) -> f64 {
        0.5 * self.error
    }

    /// The same with room around each sphere for this part of the mean radius, where the rays of `rounding` have cones.
    pub(super) fn with_room(mut self, part: f64, rounding: Rounding) -> Self {
        if rounding.cones {
            let radius = |s: &Sphere| s.scale.abs().max_element();
            let mean = self.spheres.par_iter().map(radius).sum::<f64>() / self.spheres.len().max(1) as f64;
            self.error = self.error.max(part * mean);
        }
        self
    }

    /// Middle and radius of a ball around all spheres.
    pub(super) fn ball(&self) -> (DVec3, f64) {
        let [low, high] = self.ends;
        if low.x > high.x {
            return (DVec3::ZERO, 0.0);
        }
        (0.5 * (low + high), 0.5 * (high - low).length())
    }

    /// Number of spheres.
    pub(super) fn len(&self) -> usize {
        self.spheres.len()
    }

    /// More than the error of a sphere's distance from a point, in single precision.
    pub(super) fn slack(&self) -> f64 {
        let ratio = |s: &Sphere| s.scale.abs().max_element() / s.scale.abs().min_element();
        let ratio = if self.true_axes { self.spheres.par_iter().map(ratio).reduce(|| 1.0, f64::max) } else { 1.0 };
        self.error.max(ERROR_STEPS * Rounding::SINGLE.tests * self.reach) * ratio
    }

    /// The greatest semi-axis as it is.
    pub(super) fn radius(&self, sphere: usize) -> f64 {
        self.spheres[sphere].scale.abs().max_element()
    }

    /// Centre and enlarged semi-axes.
    pub(super) fn solid(&self, sphere: usize) -> Solid {
        let Sphere { center, scale, .. } = self.spheres[sphere];
        let scale = scale.abs();
        let axes = if self.true_axes { scale } else { DVec3::splat(scale.max_element()) };
        // The test errs alike along all axes of object space, where the ellipsoid is a sphere.
        let semi_axes = axes * (1.0 + MARGIN + self.error / axes.min_element());
        Solid { center, semi_axes: semi_axes.min(DVec3::splat(MAX_AXIS * self.magnitude)) }
    }
}

/// An axis-aligned ellipsoid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solid {
    pub(super) center: DVec3,
    pub(super) semi_axes: DVec3,
}
