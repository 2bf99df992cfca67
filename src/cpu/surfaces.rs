//! The surfaces of a world in nested balls, so that a cone of rays is tested with few of them.

use std::collections::HashSet;
use std::iter;
use std::ops::Range;

use glam::DVec3;

use super::margin::{Margins, size};
use super::scene::World;

/// Surfaces that are tested one by one.
const LEAF: usize = 8;

/// A ball around some surfaces.
#[derive(Debug, Clone)]
struct Ball {
    center: DVec3,
    radius: f64,
    /// Where in the order of surfaces these stand; none where smaller balls follow.
    surfaces: Range<usize>,
    /// The next ball that is not within this one.
    next: usize,
}

/// All surfaces of a world. Of equal ones only that of the lowest index, which wins on every device.
#[derive(Debug, Clone)]
pub(super) struct Surfaces {
    order: Vec<usize>,
    /// From the outermost on, each followed by those within it.
    balls: Vec<Ball>,
}

impl Surfaces {
    pub(super) fn of(world: &World<f64>) -> Self {
        let mut seen = HashSet::new();
        let order = (0..world.shapes.all().len()).filter(|&sphere| seen.insert(world.shapes[sphere].bits())).collect();
        let mut surfaces = Self { order, balls: Vec::new() };
        surfaces.divide(world, 0..surfaces.order.len());
        surfaces
    }

    /// Adds the balls of a part of the order, which it sorts by place.
    fn divide(&mut self, world: &World<f64>, range: Range<usize>) {
        if range.is_empty() {
            return;
        }
        let center_of = |sphere: usize| world.shapes[sphere].center.to_f64();
        let part = &mut self.order[range.clone()];
        let low = part.iter().map(|&sphere| center_of(sphere)).fold(DVec3::INFINITY, DVec3::min);
        let high = part.iter().map(|&sphere| center_of(sphere)).fold(DVec3::NEG_INFINITY, DVec3::max);
        let center = 0.5 * low + 0.5 * high;
        let reach = |sphere: usize| (center_of(sphere) - center).length() + size(world, sphere);
        let radius = part.iter().map(|&sphere| reach(sphere)).fold(0.0, f64::max);
        let index = self.balls.len();
        let is_leaf = range.len() <= LEAF;
        let surfaces = if is_leaf { range.clone() } else { 0..0 };
        self.balls.push(Ball { center, radius, surfaces, next: 0 });
        if !is_leaf {
            let extent = high - low;
            let axis = (0..3).fold(0, |longest, axis| if extent[axis] > extent[longest] { axis } else { longest });
            let middle = range.len() / 2;
            let place = |sphere: &usize| center_of(*sphere)[axis];
            self.order[range.clone()].select_nth_unstable_by(middle, |a, b| place(a).total_cmp(&place(b)));
            self.divide(world, range.start..range.start + middle);
            self.divide(world, range.start + middle..range.end);
        }
        self.balls[index].next = self.balls.len();
    }

    /// Those that rays of a cone may meet from t = 0 to `t_max`, and some more.
    pub(super) fn near(&self, margins: &Margins, t_max: f64) -> impl Iterator<Item = usize> {
        let mut at = 0;
        let leaves = iter::from_fn(move || {
            while let Some(ball) = self.balls.get(at) {
                let is_near = margins.may_meet(ball.center, ball.radius, t_max);
                at = if is_near { at + 1 } else { ball.next };
                if is_near && !ball.surfaces.is_empty() {
                    return Some(&self.order[ball.surfaces.clone()]);
                }
            }
            None
        });
        leaves.flatten().copied()
    }
}
