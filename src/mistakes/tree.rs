//! A tree of boxes around the spheres, so that scenes of many take no longer than they have to.

use glam::DVec3;

use super::world::Body;

/// As many spheres are tested one after the other.
const LEAF: usize = 6;

/// Boxes in depth-first order.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// Spheres in the order of the leaves.
    order: Vec<u32>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// Where its spheres are in the order.
    first: u32,
    count: u32,
    /// The node that follows where a ray misses the box.
    skip: u32,
    is_leaf: bool,
}

impl Tree {
    pub(super) fn over(bodies: &[Body]) -> Self {
        let is_there = |index: &u32| bodies[*index as usize].is_there;
        let mut tree = Self { nodes: Vec::new(), order: (0..bodies.len() as u32).filter(is_there).collect() };
        tree.split(bodies, 0, tree.order.len());
        tree
    }

    fn split(&mut self, bodies: &[Body], first: usize, count: usize) {
        let part = &mut self.order[first..first + count];
        let [mut low, mut high] = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for &index in part.iter() {
            let body = &bodies[index as usize];
            // Wider than rounding.
            let reach = body.shape.scale * body.shape.radius * 1.000_001 + body.shape.center.abs() * 1e-12;
            low = low.min(body.shape.center - reach);
            high = high.max(body.shape.center + reach);
        }
        let node = self.nodes.len();
        let is_leaf = count <= LEAF;
        self.nodes.push(Node { low, high, first: first as u32, count: count as u32, skip: 0, is_leaf });
        if !is_leaf {
            let size = high - low;
            let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
            let place = |index: &u32| bodies[*index as usize].shape.center[axis];
            part.select_nth_unstable_by(count / 2, |a, b| place(a).total_cmp(&place(b)));
            self.split(bodies, first, count / 2);
            self.split(bodies, first + count / 2, count - count / 2);
        }
        self.nodes[node].skip = self.nodes.len() as u32;
    }

    /// Calls `test` with the spheres that a ray may meet between `from` and the value that the last call has returned, at first `to`.
    pub(super) fn walk(
        &self,
        origin: DVec3,
        direction: DVec3,
        from: f64,
        mut to: f64,
        mut test: impl FnMut(usize) -> f64,
    ) {
        let inverse = direction.recip();
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            let [a, b] = [(node.low - origin) * inverse, (node.high - origin) * inverse];
            // NaN, of a ray along a face, is within.
            let enters = a.min(b).to_array().into_iter().fold(from, f64::max);
            let leaves = a.max(b).to_array().into_iter().fold(to, f64::min);
            if enters > leaves {
                at = node.skip as usize;
                continue;
            }
            if node.is_leaf {
                for &index in &self.order[node.first as usize..][..node.count as usize] {
                    to = test(index as usize);
                }
            }
            at += 1;
        }
    }
}
