//! Which tiles of the picture any sphere can cover: the others are background and need no ray.

use glam::DVec3;

use crate::camera::Camera;
use crate::geometry::{Ellipsoid, ellipsoids};
use crate::scene::Scene;

/// Edge of a tile in pixels; the workgroup of the render kernel has this size in both directions.
pub const TILE: u32 = 8;

/// Conservative bounds of all spheres on the picture.
#[derive(Debug, Clone)]
pub struct Cover {
    /// One per sphere that can be seen at all, in pixels: columns and rows, both ends included.
    bounds: Vec<[u32; 4]>,
    width: u32,
    height: u32,
}

impl Cover {
    /// Projects the spheres of `scene`; without `true_axes` their bounding spheres.
    pub fn new(scene: &Scene, camera: &Camera, true_axes: bool) -> Self {
        let project = |e: &Ellipsoid| pixel_bounds(e, camera);
        Self {
            bounds: ellipsoids(scene, true_axes).iter().filter_map(project).collect(),
            width: scene.width,
            height: scene.height,
        }
    }

    /// Top-left pixels of the covered tiles in rows `first` to `first + count`, in reading order; `first` is a multiple of
    /// [`TILE`].
    pub fn tiles(&self, first: u32, count: u32) -> Vec<[u32; 2]> {
        let last = (first + count).min(self.height) - 1;
        let across = self.width.div_ceil(TILE);
        let (top, down) = (first / TILE, last / TILE - first / TILE + 1);
        let mut covered = vec![false; across as usize * down as usize];
        for &[left, right, upper, lower] in &self.bounds {
            if lower < first || upper > last {
                continue;
            }
            for row in upper.max(first) / TILE..=lower.min(last) / TILE {
                let start = (row - top) as usize * across as usize;
                covered[start + (left / TILE) as usize..=start + (right / TILE) as usize].fill(true);
            }
        }
        let place = |index: usize| [index as u32 % across * TILE, (top + index as u32 / across) * TILE];
        covered.iter().enumerate().filter(|&(_, &covered)| covered).map(|(index, _)| place(index)).collect()
    }
}

/// Columns and rows that the part of the ellipsoid beyond the image plane can cover.
fn pixel_bounds(ellipsoid: &Ellipsoid, camera: &Camera) -> Option<[u32; 4]> {
    let semi_axes = ellipsoid.scale * ellipsoid.radius;
    let DVec3 { x, y, z } = ellipsoid.center;
    let across = slopes(x, z, semi_axes.x, semi_axes.z, camera.near())?;
    let down = slopes(y, z, semi_axes.y, semi_axes.z, camera.near())?;
    let columns = across.map(|slope| camera.column_of(slope * camera.near()));
    let rows = down.map(|slope| camera.row_of(slope * camera.near()));
    let [left, right] = pixel_range(columns, camera.width())?;
    let [upper, lower] = pixel_range(rows, camera.height())?;
    Some([left, right, upper, lower])
}

/// The pixels within one of a range, cut to the picture.
fn pixel_range([a, b]: [f64; 2], size: u32) -> Option<[u32; 2]> {
    // A pixel on each side for where the sample lies, one in 2¹⁶ for f32 rays, which are good to some 2⁻²².
    let margin = 1.0 + (f64::from(size) + a.abs().max(b.abs())) / 65536.0;
    let (low, high) = (a.min(b) - margin, a.max(b) + margin);
    // NaN comes from products beyond the range of f64: then the bound is left open.
    let low = if low.is_nan() { 0.0 } else { low };
    let high = if high.is_nan() { f64::from(size) } else { high };
    (high >= 0.0 && low < f64::from(size)).then(|| [low.max(0.0) as u32, (high as u32).min(size - 1)])
}

/// Least and greatest x/(−z) of the ellipse around (x, z) with semi-axes (sx, sz) where it lies beyond z = −near; none
/// where it does not.
fn slopes(x: f64, z: f64, sx: f64, sz: f64, near: f64) -> Option<[f64; 2]> {
    if z - sz > -near {
        return None;
    }
    let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
    let mut include = |slope: f64| ends = [ends[0].min(slope), ends[1].max(slope)];
    // Tangents from the eye: lines x + m z = 0 at the distance of the ellipse's support.
    let a = z * z - sz * sz;
    let discriminant = x * x * sz * sz + z * z * sx * sx - sx * sx * sz * sz;
    if a != 0.0 && discriminant >= 0.0 {
        for sign in [-1.0, 1.0] {
            let m = (-x * z + sign * discriminant.sqrt()) / a;
            let touch = z - m * sz * sz * (x + m * z) / (sx * sx + m * m * sz * sz);
            if touch <= -near {
                include(m);
            }
        }
    }
    // The cut with the image plane.
    let height = (-near - z) / sz;
    if height.abs() <= 1.0 {
        let half = sx * (1.0 - height * height).sqrt();
        include((x - half) / near);
        include((x + half) / near);
    }
    if ends[0] > ends[1] {
        // Only rounding leaves neither tangent nor cut: leave both ends open.
        return Some([f64::NAN, f64::NAN]);
    }
    Some(ends)
}
