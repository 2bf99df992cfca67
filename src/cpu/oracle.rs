//! Where a ray meets an ellipsoid, in truth: all geometry from the `f64` inputs in the scalar asked for.
//!
//! The renderers round ellipsoids to their object space first; here nothing is rounded before the first operation. Two
//! independent formulas stand side by side: [`intersect`] runs the reference's own code, [`truth`] the moment form.

use glam::DVec3;

use super::dd::Dd;
use super::intersect::{Ray, approach, roots};
use super::real::Real;
use super::scene::Shape;
use super::vec3::Vec3;

/// What is known of a line and an ellipsoid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Both roots in units of the direction, lesser first, equal where the line touches; none where it misses.
    ///
    /// Their relative error is about 1e-32, times 1/√clearance near a tangent, times the radius over the root where the
    /// origin lies near the surface: some 1e-25 at a clearance of 1e-12 or at 1e-7 radii from the surface.
    pub roots: Option<[Dd; 2]>,
    /// 1 − l², with l the distance of the line from the centre in the space where the ellipsoid is the unit sphere:
    /// 1 through the centre, 0 at a tangent, negative for a miss, NaN without direction or semi-axis.
    ///
    /// Its absolute error is below 2e-31·max(1, |S'|), |S'| being the distance of the origin in that space.
    pub clearance: Dd,
}

/// The line `origin` + t·`direction` and the ellipsoid |(x − `center`)/`scale`| = 1, in double-double.
///
/// The moment form: |c'|²t² + 2(S'·c')t + |S'|² − 1 = 0 has the discriminant |c'|² − |S'×c'|² (Lagrange's identity), free of
/// the cancellation in (S'·c')² − |c'|²(|S'|² − 1).
pub fn truth(origin: DVec3, direction: DVec3, center: DVec3, scale: DVec3) -> Truth {
    let radii = Vec3::from_f64(scale.abs());
    let s = quotient(Vec3::from_f64(origin) - Vec3::from_f64(center), radii);
    let c = quotient(Vec3::from_f64(direction), radii);
    let a = c.dot(c);
    let moment = cross(s, c);
    let discriminant = a - moment.dot(moment);
    let clearance = discriminant / a;
    // Ordered comparison: a NaN is never a hit.
    let meets = clearance >= Dd::ZERO;
    Truth { roots: meets.then(|| stable_pair(a, s.dot(c), s.dot(s) - Dd::ONE, discriminant.sqrt())), clearance }
}

/// Both roots, lesser first, by the reference's own code in `T`: the formula of the renderer, without rounding the
/// ellipsoid to `f64` on the way into object space.
pub fn intersect<T: Real>(origin: DVec3, direction: DVec3, center: DVec3, scale: DVec3) -> Option<(T, T)> {
    let ray = Ray { origin: Vec3::from_f64(origin), direction: Vec3::from_f64(direction) };
    let inv_scale = quotient(Vec3::new(T::ONE, T::ONE, T::ONE), Vec3::from_f64(scale.abs()));
    let shape = Shape { center: Vec3::from_f64(center), inv_scale, radius: T::ONE, index: 0 };
    roots(&approach(&ray, &shape), shape.radius)
}

/// a/b, componentwise.
fn quotient<T: Real>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    Vec3::new(a.x / b.x, a.y / b.y, a.z / b.z)
}

/// Vector product.
fn cross(a: Vec3<Dd>, b: Vec3<Dd>) -> Vec3<Dd> {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// The roots of at² + 2bt + c = 0, lesser first, without cancellation; `root` is √(b² − ac).
fn stable_pair(a: Dd, b: Dd, c: Dd, root: Dd) -> [Dd; 2] {
    if b < Dd::ZERO {
        let q = root - b;
        [c / q, q / a]
    } else {
        let q = -(b + root);
        // q = 0: touches the surface at the very origin.
        [q / a, if q == Dd::ZERO { q } else { c / q }]
    }
}
