//! Colours that no geometry changes: background and ambient light, also in mirrors and through glass.
//!
//! Renderers differ in nothing but the order in which they multiply and add, so that there is no margin where all orders give the
//! same value.

use glam::DVec3;

use super::vec3::Vec3;

/// A ray of a path, with what it adds of its own.
#[derive(Debug, Clone, Copy)]
struct Ray {
    /// The ray that it goes on from; that of the first is itself.
    parent: usize,
    /// What it counts for in its parent's colour, and in the pixel's.
    coefficient: f64,
    weight: f64,
    /// The least and the greatest value of its product of constants.
    own: [DVec3; 2],
}

/// The constants along a path or tree of rays, in a renderer's arithmetic.
#[derive(Debug, Clone)]
pub(super) struct Constants {
    /// Whether that is `f32`.
    is_single: bool,
    rays: Vec<Ray>,
}

impl Constants {
    /// With the ray from the eye.
    pub(super) fn new(is_single: bool) -> Self {
        let eye = Ray { parent: 0, coefficient: 1.0, weight: 1.0, own: [DVec3::ZERO; 2] };
        Self { is_single, rays: vec![eye] }
    }

    /// Goes on with a ray that counts for this much in the colour of an earlier one; returns its index.
    pub(super) fn follow(&mut self, parent: usize, coefficient: f64) -> usize {
        let coefficient = self.rounded(DVec3::splat(coefficient)).x;
        let weight = self.rounded(DVec3::splat(self.rays[parent].weight * coefficient)).x;
        self.rays.push(Ray { parent, coefficient, weight, own: [DVec3::ZERO; 2] });
        self.rays.len() - 1
    }

    /// The last ray shows the product of these.
    pub(super) fn set(&mut self, factors: [Vec3<f64>; 3]) {
        let [a, b, c] = factors.map(|factor| self.rounded(factor.to_f64()));
        let [x, y, z] = [[a, b, c], [b, c, a], [c, a, b]].map(|[a, b, c]| self.rounded(self.rounded(a * b) * c));
        if let Some(ray) = self.rays.last_mut() {
            ray.own = [x.min(y).min(z), x.max(y).max(z)];
        }
    }

    /// The least and the greatest colour of the pixel: the sum of what all rays add by their weights, or from each ray to the one that
    /// it goes on from.
    pub(super) fn ends(&self) -> [DVec3; 2] {
        let times = |[low, high]: [DVec3; 2], factor: f64| {
            let [a, b] = [low, high].map(|end| self.rounded(end * factor));
            [a.min(b), a.max(b)]
        };
        let plus = |a: [DVec3; 2], b: [DVec3; 2]| [self.rounded(a[0] + b[0]), self.rounded(a[1] + b[1])];
        let sum = self.rays.iter().map(|ray| times(ray.own, ray.weight)).reduce(plus).unwrap_or_default();
        let mut nested: Vec<[DVec3; 2]> = self.rays.iter().map(|ray| ray.own).collect();
        for (index, ray) in self.rays.iter().enumerate().skip(1).rev() {
            nested[ray.parent] = plus(nested[ray.parent], times(nested[index], ray.coefficient));
        }
        [sum[0].min(nested[0][0]), sum[1].max(nested[0][1])]
    }

    /// The nearest colour that the renderer has.
    fn rounded(&self, color: DVec3) -> DVec3 {
        if self.is_single { color.as_vec3().as_dvec3() } else { color }
    }
}
