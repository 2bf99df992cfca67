//! Where a sphere appears in the window, without looking at any other.

use std::f64::consts::FRAC_PI_4;

use glam::DVec3;

use crate::scene::{Sphere, Window};
use crate::view::View;

/// Parallel rays come from so many times as far as the window is large.
const FAR: f64 = 1e3;

/// The eye's axes and window, with the window at distance 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    right: DVec3,
    up: DVec3,
    back: DVec3,
    /// Left and right edge, then bottom and top.
    edges: [[f64; 2]; 2],
    /// Where rays are parallel, from how far away they are taken to come.
    far: Option<f64>,
}

/// The part of a sphere that lies within the window, as if nothing hid it. Lengths and areas are those of the window at distance 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outline {
    pub area: f64,
    /// Length of the outline, or of the window's edge where the sphere goes on beyond it.
    pub perimeter: f64,
    /// Length of what of it is really seen: where the sphere ends.
    pub silhouette: f64,
    /// A point of the surface about in the middle.
    pub place: DVec3,
    /// How far away that is, in world units.
    pub distance: f64,
    /// How far away from the eye the window is there.
    pub stretch: f64,
}

impl Frame {
    /// Of an eye at the origin with these axes: to the right, upwards and against the view.
    pub(super) fn new(view: &View, window: &Window) -> Self {
        let [right, up, back] = view.axes();
        let far = view.is_parallel().then(|| FAR * window.greatest());
        let near = far.unwrap_or(window.near);
        let edges = |a: f64, b: f64| [a.min(b) / near, a.max(b) / near];
        Self { far, right, up, back, edges: [edges(window.left, window.right), edges(window.bottom, window.top)] }
    }

    /// Whether rays are parallel.
    pub(super) fn is_parallel(&self) -> bool {
        self.far.is_some()
    }

    /// Area of the window.
    pub(super) fn area(&self) -> f64 {
        self.edges.iter().map(|[low, high]| high - low).product()
    }

    /// The outline of `sphere`; `None` where it is not seen.
    pub(super) fn outline(&self, sphere: &Sphere) -> Option<Outline> {
        let (center, scale) = (sphere.center, sphere.scale.abs());
        if self.back.dot(center) >= (scale * self.back).length() {
            return None;
        }
        let bounds = [self.right, self.up].map(|axis| self.bounds(axis, center, scale));
        let mut sides = [0.0; 2];
        let mut middle = [0.0; 2];
        // How many of the sides across each axis lie within the window.
        let mut ends = [0.0; 2];
        for axis in 0..2 {
            let ([low, high], [left, right]) = (bounds[axis], self.edges[axis]);
            let inside = [low.max(left), high.min(right)];
            sides[axis] = inside[1] - inside[0];
            middle[axis] = f64::midpoint(inside[0], inside[1]);
            ends[axis] = f64::from(u8::from(low > left)) + f64::from(u8::from(high < right));
            if !(sides[axis] > 0.0) {
                return None;
            }
        }
        let is_whole = ends == [2.0; 2];
        let around = 2.0 * FRAC_PI_4 * (2.0 * (sides[0] * sides[0] + sides[1] * sides[1])).sqrt();
        let point = self.right * middle[0] + self.up * middle[1];
        let (start, direction) = match self.far {
            Some(far) => (point * far, -self.back),
            None => (DVec3::ZERO, point - self.back),
        };
        let stretch = direction.length();
        let along = first_root((center - start) / scale, direction / scale)
            .unwrap_or_else(|| ((center - start).dot(direction) / (stretch * stretch)).max(f64::MIN_POSITIVE));
        Some(Outline {
            area: sides[0] * sides[1] * if is_whole { FRAC_PI_4 } else { 1.0 },
            perimeter: if is_whole { around } else { around.min(2.0 * (sides[0] + sides[1])) },
            silhouette: FRAC_PI_4 * (ends[0] * sides[1] + ends[1] * sides[0]),
            place: start + direction * along,
            distance: self.far.unwrap_or(along * stretch),
            stretch,
        })
    }

    /// From where to where along `axis` an ellipsoid that is not behind the eye reaches: the planes through the eye and across
    /// the axis that touch it, v·P = 0 with v = axis + m back, for which (v·c)² = |S v|².
    fn bounds(&self, axis: DVec3, center: DVec3, scale: DVec3) -> [f64; 2] {
        if let Some(far) = self.far {
            let (middle, half) = (axis.dot(center), (scale * axis).length());
            return [middle - half, middle + half].map(|end| end / far);
        }
        let everything = [f64::NEG_INFINITY, f64::INFINITY];
        let (across, depth) = (axis.dot(center), self.back.dot(center));
        let (thick, deep) = (scale * axis, scale * self.back);
        let a = depth * depth - deep.length_squared();
        let b = across * depth - thick.dot(deep);
        let c = across * across - thick.length_squared();
        let discriminant = b * b - a * c;
        if !(discriminant > 0.0) {
            return everything;
        }
        let q = -b - discriminant.sqrt().copysign(b);
        // A plane may touch behind the eye.
        let is_ahead = |m: &f64| {
            let v = axis + self.back * *m;
            m.is_finite() && depth * (scale * v).length_squared() < deep.dot(scale * v) * v.dot(center)
        };
        let mut ahead = [q / a, c / q].into_iter().filter(is_ahead);
        match (ahead.next(), ahead.next()) {
            (Some(m), Some(n)) => [m.min(n), m.max(n)],
            (Some(m), None) if across > 0.0 => [m, f64::INFINITY],
            (Some(m), None) => [f64::NEG_INFINITY, m],
            _ => everything,
        }
    }
}

/// The first t > 0 at which a ray from the origin meets the unit sphere around `center`.
fn first_root(center: DVec3, direction: DVec3) -> Option<f64> {
    let (a, b, c) = (direction.length_squared(), center.dot(direction), center.length_squared() - 1.0);
    let discriminant = b * b - a * c;
    if !(discriminant >= 0.0) {
        return None;
    }
    let q = b + discriminant.sqrt().copysign(b);
    let roots = [q / a, c / q];
    roots.into_iter().filter(|&t| t > 0.0).reduce(f64::min)
}
