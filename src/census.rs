//! What the spheres of a scene come to: how far they reach from the eye, and what no eye changes. One pass finds what many ask for.

use glam::DVec3;
use rayon::prelude::*;

use crate::brightness::Parts;
use crate::effects::COMMON_SIZES;
use crate::geometry::extent;
use crate::precision::Extreme;
use crate::scene::{Scene, Sphere};

/// Spheres that one thread looks at in turn.
pub(crate) const CHUNK: usize = 4096;

/// How far spheres reach, seen from the origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extents {
    /// The greatest coordinate of a centre, or semi-axis.
    pub(crate) greatest: f64,
    /// The greatest coordinate of any point.
    pub(crate) magnitude: f64,
    /// The least and the greatest coordinates of balls around the spheres; none has such numbers where there is no sphere.
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
}

impl Extents {
    /// Of no sphere.
    pub(crate) const NONE: Self =
        Self { greatest: 0.0, magnitude: 0.0, low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    /// Of `spheres`.
    pub(crate) fn of(spheres: &[Sphere]) -> Self {
        let chunk = |spheres: &[Sphere]| spheres.iter().fold(Self::NONE, Self::with);
        spheres.par_chunks(CHUNK).map(chunk).reduce(|| Self::NONE, Self::and)
    }

    /// Of this sphere, too.
    pub(crate) fn with(self, sphere: &Sphere) -> Self {
        let (center, radius) = (sphere.center, extent(sphere.scale));
        let around = DVec3::splat(radius);
        Self {
            greatest: self.greatest.max(extent(center)).max(radius),
            magnitude: self.magnitude.max(extent(center) + radius),
            low: self.low.min(center - around),
            high: self.high.max(center + around),
        }
    }

    /// Of the spheres of both.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            greatest: self.greatest.max(other.greatest),
            magnitude: self.magnitude.max(other.magnitude),
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
}

/// What no eye changes. Spheres are named by their indices.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Census {
    /// AMBIENT and all lights, as [`Parts::light`] has them.
    light: [f64; 2],
    /// The first sphere that refracts.
    pub(crate) glass: Option<usize>,
    /// The first with a highlight.
    pub(crate) shiny: Option<usize>,
    /// The first two that reflect.
    pub(crate) mirrors: [Option<usize>; 2],
    /// The first with unequal semi-axes.
    pub(crate) uneven: Option<usize>,
    /// The first whose size is none of [`COMMON_SIZES`].
    pub(crate) uncommon: Option<usize>,
    /// The least semi-axis, and the greatest ratio of two.
    pub(crate) least: Extreme,
    pub(crate) axis_ratio: Extreme,
    /// The greatest exponent of a highlight.
    pub(crate) exponent: Extreme,
    /// The greatest index of refraction, or reciprocal of one, of what one looks through.
    pub(crate) bending: Extreme,
    /// What colours add up to.
    pub(crate) brightness: Parts,
}

impl Census {
    /// Of a scene in the units of kernels.
    pub(crate) fn of(scene: &Scene) -> Self {
        let none = Self {
            light: Parts::light(scene),
            glass: None,
            shiny: None,
            mirrors: [None; 2],
            uneven: None,
            uncommon: None,
            least: Extreme::NOTHING_LESS,
            axis_ratio: Extreme::NONE,
            exponent: Extreme::NONE,
            bending: Extreme::NONE,
            brightness: Parts::NONE,
        };
        let chunk = |(chunk, spheres): (usize, &[Sphere])| {
            let mut census = none;
            (chunk * CHUNK..).zip(spheres).for_each(|(index, sphere)| census.add(index, sphere));
            census
        };
        scene.spheres.par_chunks(CHUNK).enumerate().map(chunk).reduce(|| none, Self::and)
    }

    /// Whether it is also that of a scene with the same spheres.
    pub(crate) fn serves(&self, scene: &Scene) -> bool {
        self.light == Parts::light(scene)
    }

    fn add(&mut self, index: usize, sphere: &Sphere) {
        let first = |found: &mut Option<usize>, is_one: bool| {
            if is_one && found.is_none() {
                *found = Some(index);
            }
        };
        let scale = sphere.scale.abs();
        first(&mut self.glass, sphere.kt != 0.0);
        first(&mut self.shiny, sphere.ks != 0.0);
        let at = usize::from(self.mirrors[0].is_some());
        first(&mut self.mirrors[at], sphere.kr != 0.0);
        first(&mut self.uneven, scale != DVec3::splat(scale.x));
        first(&mut self.uncommon, !COMMON_SIZES.contains(&scale.x));
        let (short, long) = (scale.min_element(), scale.max_element());
        self.least.lower(short, index);
        self.axis_ratio.raise(long / short, index);
        if sphere.ks != 0.0 {
            self.exponent.raise(sphere.n, index);
        }
        if sphere.kt != 0.0 {
            self.bending.raise(sphere.eta.max(1.0 / sphere.eta), index);
        }
        self.brightness = self.brightness.greater(Parts::of(index, sphere, self.light));
    }

    /// Of these spheres and of `later` ones.
    fn and(mut self, later: Self) -> Self {
        let mut mirrors = self.mirrors.into_iter().chain(later.mirrors).flatten();
        self.least.lower_to(later.least);
        self.axis_ratio.raise_to(later.axis_ratio);
        self.exponent.raise_to(later.exponent);
        self.bending.raise_to(later.bending);
        Self {
            glass: self.glass.or(later.glass),
            shiny: self.shiny.or(later.shiny),
            mirrors: [mirrors.next(), mirrors.next()],
            uneven: self.uneven.or(later.uneven),
            uncommon: self.uncommon.or(later.uncommon),
            brightness: self.brightness.greater(later.brightness),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::scene::Window;

    /// The pass over chunks finds what one after another finds.
    #[test]
    fn the_first_and_the_least_of_many_are_found() {
        let mut random = Random::new(11, 1);
        let mut scene = Scene::new(Window::default(), 8, 8);
        let mut count = |scene: &mut Scene| {
            let center = random.in_box(9.0);
            scene.spheres.push(Sphere::new(center, random.within(0.5, 2.0), random.in_ball()));
        };
        (0..3 * CHUNK + 5).for_each(|_| count(&mut scene));
        for (index, change) in [(5000, 0.3), (9000, 0.4), (12_000, 0.5)] {
            let sphere = &mut scene.spheres[index];
            (sphere.kr, sphere.kt, sphere.ks, sphere.scale.y) = (change, change, change, 1e-12);
        }
        scene.spheres[9001].ka = -8.0;
        scene.spheres[9002].scale = DVec3::splat(1e12);
        let census = Census::of(&scene);
        assert_eq!([census.glass, census.shiny, census.uneven], [Some(5000); 3]);
        assert_eq!((census.mirrors, census.uncommon), ([Some(5000), Some(9000)], Some(9002)));
        assert_eq!(census.least, Extreme { value: 1e-12, sphere: Some(5000) });
        assert!(census.axis_ratio.value > 1e11 && census.exponent.sphere == Some(5000) && census.bending.value == 1.0);
        let mut none = Parts::NONE;
        (0..).zip(&scene.spheres).for_each(|(index, s)| none = none.greater(Parts::of(index, s, Parts::light(&scene))));
        assert_eq!(census.brightness, none);
        let extents = Extents::of(&scene.spheres);
        let all = scene.spheres.iter().fold(Extents::NONE, Extents::with);
        assert!(extents.low == all.low && extents.high == all.high && extents.greatest == 1e12);
        assert!(extents.magnitude == all.magnitude && extents.magnitude > 1e12);
        scene.ambient = DVec3::splat(7.0);
        assert!(!census.serves(&scene), "the ambient light has changed");
    }
}
