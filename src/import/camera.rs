//! The camera that sees all of a scene.

use glam::DVec3;

use super::options::Framing;
use crate::scene::Window;

/// Half the angle of view across the shorter side of the picture, in degrees.
const HALF_ANGLE: f64 = 15.0;
/// The part of the window, from its middle to an edge, that spheres fill at the most.
pub(super) const FILLED: f64 = 0.96;
/// The image plane is at most this part of the way from the eye to the nearest sphere: there is room to fly.
const NEAR: f64 = 1.0 / 64.0;

/// Where the eye is, and the window through which it looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Camera {
    axes: [DVec3; 3],
    /// The eye, along the axes.
    eye: DVec3,
    pub(super) window: Window,
}

impl Camera {
    /// The nearest eye that sees all spheres, each a centre and a radius, within [`FILLED`] of the window, or the ball around all of
    /// them. What is seen touches that frame on two opposite sides.
    pub(super) fn fit(
        spheres: impl Iterator<Item = (DVec3, f64)> + Clone,
        axes: [DVec3; 3],
        size: (u32, u32),
        framing: Framing,
    ) -> Self {
        let turned = spheres.map(|(center, radius)| (turn(axes, center), radius));
        match framing {
            Framing::Picture => Self::fit_turned(turned, axes, size),
            Framing::Ball => Self::fit_turned(std::iter::once(ball(turned)), axes, size),
        }
    }

    /// A sphere is to one side of a plane through the eye exactly if the eye is far enough along the plane's normal, so each of the
    /// four planes of the frame asks for its greatest distance, and two opposite ones together for the eye's.
    fn fit_turned(
        turned: impl Iterator<Item = (DVec3, f64)> + Clone,
        axes: [DVec3; 3],
        (width, height): (u32, u32),
    ) -> Self {
        let shorter = f64::from(width.min(height));
        let half = HALF_ANGLE.to_radians().tan();
        let tangents = [width, height].map(|side| half * f64::from(side) / shorter);
        let mut reach = [[f64::NEG_INFINITY; 2]; 2];
        let normals = tangents.map(|tangent| (FILLED * tangent).atan().sin_cos());
        for (center, radius) in turned.clone() {
            for ((reach, (sin, cos)), at) in reach.iter_mut().zip(normals).zip([center.x, center.y]) {
                reach[0] = reach[0].max(at * cos + center.z * sin + radius);
                reach[1] = reach[1].max(center.z * sin - at * cos + radius);
            }
        }
        let [(x, from_sides), (y, from_ends)] = [0, 1].map(|axis| {
            let ([high, low], (sin, cos)) = (reach[axis], normals[axis]);
            ((high - low) / (2.0 * cos), (high + low) / (2.0 * sin))
        });
        let eye = DVec3::new(x, y, from_sides.max(from_ends));
        let nearest = turned.fold(f64::INFINITY, |nearest, (center, radius)| nearest.min(eye.z - center.z - radius));
        // A power of two keeps the window's numbers short.
        let near = (nearest * NEAR).log2().floor().exp2();
        let [right, top] = tangents.map(|tangent| near * tangent);
        Self { axes, eye, window: Window { near, left: -right, right, bottom: -top, top } }
    }

    /// A point of the file as the eye at the origin sees it.
    pub(super) fn see(&self, point: DVec3) -> DVec3 {
        turn(self.axes, point) - self.eye
    }

    /// Whether all of a sphere is in the picture, its centre as the eye at the origin sees it.
    pub(super) fn shows(&self, center: DVec3, radius: f64) -> bool {
        let Window { near, right, top, .. } = self.window;
        let is_within = |(edge, at): (f64, f64)| {
            let (sin, cos) = (edge / near).atan().sin_cos();
            at.abs() * cos + center.z * sin + radius <= 0.0
        };
        [(right, center.x), (top, center.y)].into_iter().all(is_within) && center.z + radius < -near
    }
}

/// The ball around all spheres whose centre is the middle of the box around them, which a turntable goes around.
fn ball(spheres: impl Iterator<Item = (DVec3, f64)> + Clone) -> (DVec3, f64) {
    let (low, high) = spheres.clone().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), (center, radius)| {
        (low.min(center - radius), high.max(center + radius))
    });
    let middle = low.midpoint(high);
    let reach = spheres.map(|(center, radius)| (center - middle).length() + radius);
    (middle, reach.fold(0.0, f64::max))
}

/// A point along the axes.
fn turn(axes: [DVec3; 3], point: DVec3) -> DVec3 {
    DVec3::from(axes.map(|axis| axis.dot(point)))
}
