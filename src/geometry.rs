//! Spheres as the intersection sees them: the same numbers for CPU and GPU.
//!
//! Object space is chosen so that nothing overflows and nothing is rounded needlessly: world vectors are multiplied by
//! `inv_scale` and the ellipsoid becomes a sphere of `radius` in [1, 2) around the origin. `inv_scale` is a power of two
//! times the ratio of the greatest semi-axis to each axis, so for a true sphere the way into object space is exact.

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::*;

use crate::scene::{Scene, Sphere, Window};
use crate::settings::{Secondary, Settings};

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
const COMMON_EXTENT: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// The power of two by which a world with this greatest coordinate is multiplied so that squared lengths stay within `f32`.
pub fn range_factor(greatest: f64) -> f64 {
    if COMMON_EXTENT.contains(&greatest) { 1.0 } else { reciprocal_power_of_two(greatest) }
}

/// Lights are no farther away than this many times the extent of the spheres, 2⁵⁶: already the rays to them are parallel to
/// less than `f64` can tell.
const FARTHEST_LIGHT: f64 = (1_u64 << 56) as f64;

/// The units in which the kernels read a scene whose eye is at the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// A power of two by which all coordinates are multiplied.
    pub factor: f64,
    /// The greatest coordinate or semi-axis of a sphere, in the new units.
    pub greatest: f64,
    /// The greatest coordinate of a light, in the new units; beyond it lights come nearer along their direction.
    farthest: f64,
}

impl Units {
    /// Those in which squared lengths neither overflow nor underflow in `f32`. They go by the spheres: a light in the distance
    /// does not make the spheres small.
    pub fn of(scene: &Scene, secondary: Secondary) -> Self {
        let spheres = scene.spheres.par_iter().map(|s| extent(s.center).max(extent(s.scale))).reduce(|| 0.0, f64::max);
        let lights = scene.lights.iter().map(|light| extent(light.position)).fold(0.0, f64::max);
        // The epsilon of shadow rays is a part of the way to the light: where a nearer light would bring it down to the size of
        // the spheres, the light has to stay.
        let may_move = secondary.shadow == 0.0 || secondary.shadow * FARTHEST_LIGHT > 64.0;
        let greatest = if may_move { spheres } else { spheres.max(lights) };
        let is_common = greatest == 0.0 || COMMON_EXTENT.contains(&greatest) && lights <= *COMMON_EXTENT.end();
        let factor = if is_common { 1.0 } else { reciprocal_power_of_two(greatest) };
        let farthest = if may_move && greatest > 0.0 { FARTHEST_LIGHT * (greatest * factor) } else { f64::INFINITY };
        Self { factor, greatest: spheres * factor, farthest }
    }

    /// Where a light is in these units.
    pub fn light(&self, position: DVec3) -> DVec3 {
        let greatest = extent(position);
        // Quotients, since products may leave the range.
        if greatest <= self.farthest / self.factor {
            return position * self.factor;
        }
        // Powers of two again, which leave the direction as it is to the last bit.
        position * reciprocal_power_of_two(greatest) / reciprocal_power_of_two(self.farthest)
    }

    /// `scene` in these units.
    pub fn applied_to<'a>(&self, scene: Cow<'a, Scene>) -> Cow<'a, Scene> {
        if self.factor == 1.0 && scene.lights.iter().all(|light| self.light(light.position) == light.position) {
            return scene;
        }
        let mut scene = scene.into_owned();
        let Window { near, left, right, bottom, top } = scene.window;
        let [near, left, right, bottom, top] = [near, left, right, bottom, top].map(|x| x * self.factor);
        scene.window = Window { near, left, right, bottom, top };
        for sphere in &mut scene.spheres {
            sphere.center *= self.factor;
            sphere.scale *= self.factor;
        }
        for light in &mut scene.lights {
            light.position = self.light(light.position);
        }
        Cow::Owned(scene)
    }
}

/// The greatest coordinate, without its sign.
pub(crate) fn extent(v: DVec3) -> f64 {
    v.abs().max_element()
}

/// The scene as the kernels read it: with the eye at the origin and in the [`Units`] of kernels, which changes neither a
/// digit nor a root nor a pixel. Distances in the settings follow.
pub fn in_range<'a>(scene: &'a Scene, settings: &Settings) -> (Cow<'a, Scene>, Settings) {
    let view = settings.view;
    let (scene, mut settings) = (view.relative(scene), Settings { view: view.at_origin(), ..*settings });
    let units = Units::of(&scene, settings.secondary);
    settings.secondary.reflection *= units.factor;
    (units.applied_to(scene), settings)
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
