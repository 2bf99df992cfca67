//! Decisions that were taken with more bits, for a tracer with fewer to go by.

use super::intersect::{Hit, Own, Range, Ray};
use super::real::Real;
use super::refract::Snell;
use super::scene::{PointLight, World};
use super::shade::Surface;
use super::witness::Witness;

/// One decision of a path.
#[derive(Debug, Clone, Copy)]
enum Decided {
    Nearest(Option<Hit<f64>>),
    IsLit(bool),
    IsBlocked(bool),
    IsTotal(bool),
}

/// Notes the decisions of a path in their order.
#[derive(Debug, Default)]
pub(super) struct Notes(Vec<Decided>);

impl Notes {
    /// For a tracer to take the same ones.
    pub(super) fn replay(mut self) -> Replay {
        self.0.reverse();
        Replay(self.0)
    }
}

impl<T: Real> Witness<T> for Notes {
    fn nearest(
        &mut self,
        _world: &World<T>,
        _ray: &Ray<T>,
        _own: Option<&Own<T>>,
        _range: &Range<T>,
        hit: Option<Hit<T>>,
    ) -> Option<Hit<T>> {
        let Hit { sphere, inside, t } = hit.unwrap_or(Hit { t: T::ZERO, sphere: 0, inside: false });
        self.0.push(Decided::Nearest(hit.is_some().then(|| Hit { t: t.to_f64(), sphere, inside })));
        hit
    }

    fn lit(&mut self, _: &World<T>, _: &Surface<T>, _: &PointLight<T>, _n_dot_l: T, is_lit: bool) -> bool {
        self.0.push(Decided::IsLit(is_lit));
        is_lit
    }

    fn blocked(&mut self, _world: &World<T>, _ray: &Ray<T>, _own: &Own<T>, is_blocked: bool) -> bool {
        self.0.push(Decided::IsBlocked(is_blocked));
        is_blocked
    }

    fn refracted(&mut self, _: &World<T>, _: &Surface<T>, snell: Snell<T>, _throughput: T) -> Snell<T> {
        self.0.push(Decided::IsTotal(snell.is_total()));
        snell
    }
}

/// Takes the decisions that were noted, one after the other; the last one is the next.
#[derive(Debug)]
pub(super) struct Replay(Vec<Decided>);

impl<T: Real> Witness<T> for Replay {
    fn nearest(
        &mut self,
        _world: &World<T>,
        _ray: &Ray<T>,
        _own: Option<&Own<T>>,
        _range: &Range<T>,
        hit: Option<Hit<T>>,
    ) -> Option<Hit<T>> {
        match self.0.pop() {
            Some(Decided::Nearest(decided)) => decided.map(|decided| {
                let Hit { t, sphere, inside } = decided;
                // The tracer's own, where it has found the same.
                let own = hit.filter(|hit| hit.sphere == sphere && hit.inside == inside);
                own.unwrap_or(Hit { t: T::from_f64(t), sphere, inside })
            }),
            _ => hit,
        }
    }

    fn lit(&mut self, _: &World<T>, _: &Surface<T>, _: &PointLight<T>, n_dot_l: T, is_lit: bool) -> bool {
        let Some(Decided::IsLit(decided)) = self.0.pop() else { return is_lit };
        // A light at the very point, for the tracer, has no direction.
        let has_direction = n_dot_l.partial_cmp(&n_dot_l).is_some();
        if decided && !has_direction && matches!(self.0.last(), Some(Decided::IsBlocked(_))) {
            self.0.pop();
        }
        decided && has_direction
    }

    fn blocked(&mut self, _world: &World<T>, _ray: &Ray<T>, _own: &Own<T>, is_blocked: bool) -> bool {
        if let Some(Decided::IsBlocked(decided)) = self.0.pop() { decided } else { is_blocked }
    }

    fn refracted(&mut self, _: &World<T>, _: &Surface<T>, snell: Snell<T>, _throughput: T) -> Snell<T> {
        match self.0.pop() {
            Some(Decided::IsTotal(is_total)) if is_total != snell.is_total() => {
                let square = if is_total { T::ZERO } else { T::from_f64(f64::MIN_POSITIVE) };
                Snell { square, bend: snell.ratio * snell.cosine, ..snell }
            }
            _ => snell,
        }
    }
}
