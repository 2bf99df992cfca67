//! Which primary rays may just touch a sphere: where rounding could decide whether they meet, exact arithmetic does.

use std::cmp::Ordering;

use rayon::iter::ParallelIterator;

use super::intersect::Approach;
use super::real::Real;
use super::scene::Shape;
use crate::exact::TangentMargin;
use crate::geometry::Ellipsoid;
use crate::viewed::ViewedScene;

/// How far rounding can move discriminants of primary rays.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Tangents {
    margin: TangentMargin,
    /// The greatest margin of any sphere.
    widest: f64,
}

impl Tangents {
    /// Of the `ellipsoids` of `viewed`, with a scalar of this unit roundoff.
    pub(crate) fn of(ellipsoids: impl ParallelIterator<Item = Ellipsoid>, viewed: &ViewedScene, unit: f64) -> Self {
        let margin = TangentMargin::new(viewed, unit);
        Self { margin, widest: margin.widest(ellipsoids) }
    }

    /// Of one ellipsoid.
    pub(crate) fn of_one(margin: TangentMargin, ellipsoid: Ellipsoid) -> Self {
        Self { margin, widest: margin.greatest(ellipsoid) }
    }

    /// The sign of the discriminant where rounding could decide it: what `touches` says.
    #[inline]
    pub(crate) fn decided<T: Real>(
        &self,
        at: &Approach<T>,
        shape: &Shape<T>,
        touches: impl FnOnce() -> Ordering,
    ) -> Option<Ordering> {
        // Ordered comparison: a NaN is never a hit, and needs no exact arithmetic.
        if at.discriminant.abs() <= T::from_f64(self.widest) { self.exactly(at, shape, touches) } else { None }
    }

    #[cold]
    fn exactly<T: Real>(
        &self,
        at: &Approach<T>,
        shape: &Shape<T>,
        touches: impl FnOnce() -> Ordering,
    ) -> Option<Ordering> {
        let [a, discriminant, perpendicular, distance] =
            [at.a, at.discriminant, at.perpendicular.dot(at.perpendicular).sqrt(), at.origin.dot(at.origin).sqrt()]
                .map(T::to_f64);
        let stretch = shape.inv_scale.to_f64().max_element();
        let is_near = !(discriminant.abs() > self.margin.of(perpendicular, distance, stretch, a.sqrt()));
        is_near.then(touches)
    }
}
