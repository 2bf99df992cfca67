//! Spheres as the intersection sees them: the same numbers for CPU and GPU.
//!
//! Object space is chosen so that nothing overflows and nothing is rounded needlessly: world vectors are multiplied by
//! `inv_scale` and the ellipsoid becomes a sphere of `radius` in [1, 2) around the origin. `inv_scale` is a power of two
//! times the ratio of the greatest semi-axis to each axis, so for a true sphere the way into object space is exact.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use crate::scene::{Scene, Sphere};

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
        let (inv_scale, scale) = if s == DVec3::splat(largest) {
            // The same numbers without a quotient for each axis.
            (DVec3::splat(k), DVec3::splat(1.0 / k))
        } else {
            (DVec3::new(largest / s.x, largest / s.y, largest / s.z) * k, s / largest / k)
        };
        Self { center, inv_scale, scale, radius: largest * k }
    }

    /// Bits that are equal exactly when two ellipsoids are the same surface to the intersection.
    pub fn bits(&self) -> [u64; 7] {
        let (c, i) = (self.center + DVec3::ZERO, self.inv_scale); // + 0 turns −0 into 0
        [c.x, c.y, c.z, i.x, i.y, i.z, self.radius].map(f64::to_bits)
    }
}

/// The power of two k with `x`·k in [1, 2), for a positive normal `x`; subnormal scales are treated as the least normal one.
pub(crate) fn reciprocal_power_of_two(x: f64) -> f64 {
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
pub(crate) const COMMON_EXTENT: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// The power of two by which a world with this greatest coordinate is multiplied so that squared lengths stay within `f32`.
pub fn range_factor(greatest: f64) -> f64 {
    if COMMON_EXTENT.contains(&greatest) { 1.0 } else { reciprocal_power_of_two(greatest) }
}

/// The greatest coordinate, without its sign.
pub(crate) fn extent(v: DVec3) -> f64 {
    v.abs().max_element()
}

/// For each sphere the lowest index of a sphere with the bit-identical surface: rays that leave one leave them all. `None` where
/// no two are the same.
pub fn shape_indices(spheres: &[Sphere], true_axes: bool) -> Option<Vec<u32>> {
    shape_indices_among(spheres, true_axes, &twins(spheres, 0.0))
}

/// The same where only these may share a surface.
pub(crate) fn shape_indices_among(spheres: &[Sphere], true_axes: bool, among: &[u32]) -> Option<Vec<u32>> {
    let bits = |index: u32| ellipsoid(&spheres[index as usize], true_axes).bits();
    let mut order: Vec<_> = among.par_iter().map(|&index| (bits(index), index)).collect();
    order.par_sort_unstable();
    let mut indices = None;
    for same in order.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
        let indices = indices.get_or_insert_with(|| (0..spheres.len() as u32).collect::<Vec<_>>());
        for &(_, index) in same {
            indices[index as usize] = same[0].1;
        }
    }
    indices
}

/// Spheres that are in the same place, or become so where rounding moves them: their coordinates are no greater than `reach`, before and
/// after. Some others are among them.
pub(crate) fn twins(spheres: &[Sphere], reach: f64) -> Arc<[u32]> {
    // Along this line hardly any two are in the same place by chance, nor where all lie in a plane.
    let line = DVec3::new(0.562_341_325, 0.749_894_209, 0.348_700_012);
    let place = |(index, sphere): (usize, &Sphere)| (sphere.center.dot(line), index as u32);
    let mut places: Vec<_> = spheres.par_iter().enumerate().map(place).collect();
    places.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    // Twice the rounding of each coordinate of both, and of the places themselves.
    let room = 32.0 * f64::EPSILON * reach;
    let is_near = |pair: &[(f64, u32)]| !(pair[1].0 - pair[0].0 > room);
    let near = |at: usize| is_near(&places[at - 1..=at]);
    let has_one = |&at: &usize| at > 0 && near(at) || at + 1 < places.len() && near(at + 1);
    (0..places.len()).filter(has_one).map(|at| places[at].1).collect()
}
