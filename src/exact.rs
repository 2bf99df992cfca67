//! Whether rays from the eye meet spheres, in exact arithmetic on the numbers of the scene.
//!
//! A number stands for the shortest decimal that reads as it: what the file has, up to 15 digits. So a sphere that the file lets
//! a ray touch is touched, whatever its decimals are in binary.

use std::cmp::Ordering;

use dashu_ratio::RBig;
use glam::DVec3;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::geometry::Ellipsoid;
use crate::scene::Sphere;
use crate::viewed::ViewedScene;

/// How far rounding can move the discriminant r² − |perpendicular|² of a ray from the eye, in object space.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TangentMargin {
    /// Unit roundoff.
    unit: f64,
    /// Distance of the eye from the origin of the scene file, in the units of kernels.
    eye: f64,
    /// The greatest coordinate on the window, as rays have it.
    window: f64,
    /// The least length of a ray's direction.
    shortest: f64,
}

impl TangentMargin {
    /// For rays from the eye of `viewed` in arithmetic with this unit roundoff.
    pub fn new(viewed: &ViewedScene, unit: f64) -> Self {
        let (eye, camera) = (viewed.eye_distance(), Camera::new(viewed));
        Self { unit, eye, window: camera.greatest() * camera.stretch(), shortest: camera.near() * camera.stretch() }
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
        ellipsoids.map(|ellipsoid| self.greatest(ellipsoid)).reduce(|| 0.0, f64::max)
    }

    /// That of a ray that may touch this one.
    pub(crate) fn greatest(&self, e: Ellipsoid) -> f64 {
        let distance = (e.center * e.inv_scale).length();
        let [most, least] = [e.inv_scale.max_element(), e.inv_scale.min_element()];
        // Where |perpendicular|² − r² is within the margin, |perpendicular| is below 2.1 and 2.5 times what it moves.
        let moved = self.moved(distance, most, least * self.shortest);
        16.0 * (moved + moved * moved) + 40.0 * self.unit
    }
}

/// The rays from the eye.
#[derive(Debug, Clone, Default)]
pub struct ExactCamera {
    eye: [RBig; 3],
    /// The picture's axes in the world.
    axes: [[RBig; 3]; 3],
    /// Left edge, what the right one adds, and the columns of samples between them.
    across: [RBig; 3],
    /// Top edge, what the bottom one adds, and the rows of samples between them.
    down: [RBig; 3],
    /// Where in its cell a sample lies.
    offset: [RBig; 2],
    near: RBig,
}

impl ExactCamera {
    /// Of the scene as the file has it.
    pub fn new(viewed: &ViewedScene) -> Self {
        let (scene, settings) = viewed.in_file();
        let window = scene.window;
        let [left, right, top, bottom] = [window.left, window.right, window.top, window.bottom].map(exact);
        let [columns, rows] =
            [scene.width, scene.height].map(|size| RBig::from(u64::from(size) * u64::from(settings.samples_per_side)));
        let (x, y) = settings.sampling.offset();
        Self {
            eye: vector(settings.view.eye),
            axes: settings.view.axes().map(vector),
            across: [left.clone(), right - left, columns],
            down: [top.clone(), bottom - top, rows],
            offset: [x, y].map(exact),
            near: exact(window.near),
        }
    }

    /// The way to the image plane along the ray of the sample in this column and row of samples.
    fn direction(&self, [column, row]: [u32; 2]) -> [RBig; 3] {
        let [dx, dy] = &self.offset;
        let place = |[edge, size, count]: &[RBig; 3], index: u32, offset: &RBig| {
            edge + size * ((RBig::from(index) + offset) / count)
        };
        let x = place(&self.across, column, dx);
        let y = place(&self.down, row, dy);
        let [right, up, back] = &self.axes;
        std::array::from_fn(|axis| &right[axis] * &x + &up[axis] * &y - &back[axis] * &self.near)
    }

    /// The sign of B² − AC for the ray of a sample and the ellipsoid around `center` with these semi-axes: less where the line
    /// misses it, equal where it touches it.
    pub fn discriminant(&self, sample: [u32; 2], center: DVec3, semi_axes: DVec3) -> Ordering {
        let (center, semi_axes) = (vector(center), vector(semi_axes));
        let direction = self.direction(sample);
        // In object space, where the ellipsoid is the unit sphere: B² − AC = A − |S' × c'|².
        let d: [RBig; 3] = std::array::from_fn(|axis| &direction[axis] / &semi_axes[axis]);
        let s: [RBig; 3] = std::array::from_fn(|axis| (&self.eye[axis] - &center[axis]) / &semi_axes[axis]);
        let moment = [[1, 2], [2, 0], [0, 1]].map(|[i, j]| &s[i] * &d[j] - &s[j] * &d[i]);
        let squared = |v: &[RBig; 3]| v.iter().fold(RBig::ZERO, |sum, x| sum + x * x);
        squared(&d).cmp(&squared(&moment))
    }
}

/// A scene's spheres before anything is rounded, and the rays from its eye.
#[derive(Debug, Clone, Default)]
pub struct ExactScene {
    camera: ExactCamera,
    spheres: Vec<[DVec3; 2]>,
}

impl ExactScene {
    /// Of the scene as the file has it; without `true_axes` each sphere is its bounding sphere.
    pub fn new(viewed: &ViewedScene, true_axes: bool) -> Self {
        let sphere = |sphere: &Sphere| {
            let scale = sphere.scale.abs();
            [sphere.center, if true_axes { scale } else { DVec3::splat(scale.max_element()) }]
        };
        Self { camera: ExactCamera::new(viewed), spheres: viewed.in_file().0.spheres.iter().map(sphere).collect() }
    }

    /// The sign of B² − AC for the ray of a sample, by its column and row, and the sphere with this index.
    pub fn discriminant(&self, sample: [u32; 2], sphere: usize) -> Ordering {
        let [center, semi_axes] = self.spheres[sphere];
        self.camera.discriminant(sample, center, semi_axes)
    }
}

fn vector(v: DVec3) -> [RBig; 3] {
    v.to_array().map(exact)
}

/// The shortest decimal that reads as `x`, which is finite.
fn exact(x: f64) -> RBig {
    let text = format!("{x:e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let exponent = exponent.parse::<i32>().unwrap_or_default() - i32::try_from(fraction.len()).unwrap_or_default();
    let zeros = "0".repeat(exponent.unsigned_abs() as usize);
    let text = if exponent < 0 { format!("{whole}{fraction}/1{zeros}") } else { format!("{whole}{fraction}{zeros}") };
    text.parse().unwrap_or(RBig::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_the_decimals_of_the_file() {
        for (x, text) in [
            (0.1, "1/10"),
            (-1.1, "-11/10"),
            (0.0, "0"),
            (-0.0, "0"),
            (3.0, "3"),
            (1e22, "10000000000000000000000"),
            (-2.5e-7, "-1/4000000"),
            (123_456.75, "493827/4"),
        ] {
            assert_eq!(exact(x).to_string(), text);
        }
        assert!(exact(f64::MAX) > exact(1e308) && exact(5e-324) > RBig::ZERO);
    }
}
