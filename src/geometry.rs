//! Spheres as the intersection sees them: the same numbers for CPU and GPU.
//!
//! Object space is chosen so that nothing overflows and nothing is rounded needlessly: world vectors are multiplied by
//! `inv_scale` and the ellipsoid becomes a sphere of `radius` in [1, 2) around the origin. `inv_scale` is a power of two
//! times the ratio of the greatest semi-axis to each axis, so for a true sphere the way into object space is exact.

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::scene::{Scene, Sphere, Window};
use crate::settings::Settings;

/// An axis-aligned ellipsoid prepared for intersection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    /// Centre in world space.
    pub center: DVec3,
    /// World to object: 2ᵏ·max|s| / |s| / max|s| per axis, i.e. 2ᵏ times a ratio ≥ 1.
    pub inv_scale: DVec3,
    /// Object to world: 1/`inv_scale`.
    pub scale: DVec3,
    /// Radius in object space: 2ᵏ·max|s|, in [1, 2).
    pub radius: f64,
}

impl Ellipsoid {
    /// Prepares `sphere`.
    pub fn new(sphere: &Sphere) -> Self {
        Self::with_axes(sphere.center, sphere.scale)
    }

    /// Prepares the ellipsoid around `center` with semi-axes `scale`; a negative one means its absolute value.
    pub fn with_axes(center: DVec3, scale: DVec3) -> Self {
        let s = scale.abs();
        let largest = s.max_element();
        let k = reciprocal_power_of_two(largest);
        Self {
            center,
            inv_scale: DVec3::new(largest / s.x, largest / s.y, largest / s.z) * k,
            scale: s / largest / k,
            radius: largest * k,
        }
    }

    /// Bits that are equal exactly when two ellipsoids are the same surface to the intersection.
    pub fn bits(&self) -> [u64; 7] {
        let (c, i) = (self.center + DVec3::ZERO, self.inv_scale); // + 0 turns −0 into 0
        [c.x, c.y, c.z, i.x, i.y, i.z, self.radius].map(f64::to_bits)
    }
}

/// The power of two k with `x`·k in [1, 2), for a positive normal `x`; subnormal scales are treated as the least normal one.
fn reciprocal_power_of_two(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    let exponent = (x.to_bits() & EXPONENT).max(1 << 52);
    // 2^-(e - bias): bias 1023 gives the stored exponent 2046 - e; the two largest binades map to the least normal number.
    f64::from_bits((2046_u64 << 52).saturating_sub(exponent).max(1 << 52))
}

/// Prepares every sphere of `scene`; without `true_axes` each becomes its bounding sphere.
pub fn ellipsoids(scene: &Scene, true_axes: bool) -> Vec<Ellipsoid> {
    scene.spheres.iter().map(|sphere| ellipsoid(sphere, true_axes)).collect()
}

/// Prepares a sphere; without `true_axes` it becomes its bounding sphere.
pub fn ellipsoid(sphere: &Sphere, true_axes: bool) -> Ellipsoid {
    let scale = if true_axes { sphere.scale } else { DVec3::splat(sphere.scale.abs().max_element()) };
    Ellipsoid::with_axes(sphere.center, scale)
}

/// Worlds whose greatest coordinate lies within this range keep their squares within the range of `f32` as they are.
const COMMON_EXTENT: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// The power of two by which a world with this greatest coordinate is multiplied so that squared lengths stay within `f32`.
pub fn range_factor(greatest: f64) -> f64 {
    if COMMON_EXTENT.contains(&greatest) { 1.0 } else { reciprocal_power_of_two(greatest) }
}

/// The scene as the kernels read it: with the eye at the origin, and in units in which squared lengths neither overflow nor
/// underflow in `f32`, which a power of two makes of them without changing a digit, a root or a pixel. Distances in the
/// settings follow.
pub fn in_range<'a>(scene: &'a Scene, settings: &Settings) -> (Cow<'a, Scene>, Settings) {
    let view = settings.view;
    let (scene, mut settings) = (view.relative(scene), Settings { view: view.at_origin(), ..*settings });
    let extent = |v: DVec3| v.abs().max_element();
    let spheres = scene.spheres.par_iter().map(|s| extent(s.center).max(extent(s.scale))).reduce(|| 0.0, f64::max);
    let lights = scene.lights.iter().map(|light| extent(light.position));
    let Window { near, left, right, bottom, top } = scene.window;
    let window = [near, left.abs(), right.abs(), bottom.abs(), top.abs()];
    let greatest = lights.chain(window).fold(spheres, f64::max);
    let k = range_factor(greatest);
    if k == 1.0 {
        return (scene, settings);
    }
    let mut scene = scene.into_owned();
    let [near, left, right, bottom, top] = [near, left, right, bottom, top].map(|x| x * k);
    scene.window = Window { near, left, right, bottom, top };
    for sphere in &mut scene.spheres {
        sphere.center *= k;
        sphere.scale *= k;
    }
    for light in &mut scene.lights {
        light.position *= k;
    }
    settings.secondary.reflection *= k;
    (Cow::Owned(scene), settings)
}

/// For each sphere the lowest index of a sphere with the bit-identical surface: rays that leave one leave them all. `None` where
/// no two are the same.
pub fn shape_indices(spheres: &[Sphere], true_axes: bool) -> Option<Vec<u32>> {
    let bits = |index: u32| ellipsoid(&spheres[index as usize], true_axes).bits();
    let hash = |bits: [u64; 7]| {
        // Any mixing will do: equal surfaces have equal hashes, and what is sorted below is but those that have.
        bits.into_iter().fold(0_u64, |hash, x| (hash.rotate_left(25) ^ x).wrapping_mul(0x9e37_79b9_7f4a_7c15))
    };
    let hashes: Vec<u64> = (0..spheres.len() as u32).into_par_iter().map(|index| hash(bits(index))).collect();
    let repeated: Vec<u64> = {
        let mut sorted = hashes.clone();
        sorted.par_sort_unstable();
        sorted.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect()
    };
    let mut order: Vec<u32> =
        (0..spheres.len() as u32).filter(|&index| repeated.binary_search(&hashes[index as usize]).is_ok()).collect();
    order.sort_unstable_by(|&a, &b| bits(a).cmp(&bits(b)).then(a.cmp(&b)));
    let mut indices = None;
    for same in order.chunk_by(|&a, &b| bits(a) == bits(b)).filter(|same| same.len() > 1) {
        let indices = indices.get_or_insert_with(|| (0..spheres.len() as u32).collect::<Vec<_>>());
        for &index in same {
            indices[index as usize] = same[0];
        }
    }
    indices
}

/// How far rounding can move the discriminant r² − |perpendicular|² of a ray from the eye, in object space.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TangentMargin {
    /// Unit roundoff.
    unit: f64,
    /// Distance of the eye from the origin of the scene file.
    eye: f64,
    /// The greatest coordinate on the window.
    window: f64,
    /// The least length of a ray's direction.
    shortest: f64,
}

impl TangentMargin {
    /// For rays of `camera`, whose eye was moved to the origin from so far away, in arithmetic with this unit roundoff.
    pub fn new(eye: f64, camera: &Camera, unit: f64) -> Self {
        Self { unit, eye, window: camera.greatest(), shortest: camera.near() }
    }

    /// Of a ray that passes at `perpendicular` from the centre of a sphere, which is at `distance` from the eye, all in its object
    /// space; where world vectors become at most `stretch` times as long there and the ray's direction becomes `length`.
    ///
    /// A direction is good to 16 u of the window's greatest coordinate (edge, difference, quotient, product, sum, and the turn
    /// into the world); S' to 4 u of itself and, since centre and eye are rounded, 2 u of the eye's distance; and the steps to the
    /// closest point, where an error along the ray does not count, to 4 u more. The square of the distance moves by twice what
    /// the distance does; the radius and the last operations add less than 40 u.
    pub fn of(&self, perpendicular: f64, distance: f64, stretch: f64, length: f64) -> f64 {
        let moved = self.moved(distance, stretch, length);
        moved * (2.0 * perpendicular + moved) + 40.0 * self.unit
    }

    fn moved(&self, distance: f64, stretch: f64, length: f64) -> f64 {
        let distance = distance + 2.0 * self.eye * stretch;
        self.unit * distance * (8.0 + 32.0 * self.window * stretch / length)
    }

    /// The greatest margin of a ray that may touch one of these, whose radii are in [1, 2).
    pub fn widest(&self, ellipsoids: impl ParallelIterator<Item = Ellipsoid>) -> f64 {
        let of = |e: Ellipsoid| {
            let distance = (e.center * e.inv_scale).length();
            let [most, least] = [e.inv_scale.max_element(), e.inv_scale.min_element()];
            // Where |perpendicular|² − r² is within the margin, |perpendicular| is below 2.1 and 2.5 times what it moves.
            let moved = self.moved(distance, most, least * self.shortest);
            16.0 * (moved + moved * moved) + 40.0 * self.unit
        };
        ellipsoids.map(of).reduce(|| 0.0, f64::max)
    }
}
