//! The precision ladder: what each tier promises, what a scene demands, and which tier covers it.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

use glam::DVec3;
use serde::Serialize;

use crate::brightness::{Brightness, Scalar};
use crate::effects::{Effect, Effects};
use crate::geometry::Units;
use crate::limits;
use crate::scene::Scene;
use crate::settings::Secondary;

/// A kernel of the GPU path, by what it promises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tier {
    /// `f32`, stable formulas.
    Fast,
    /// `f32` with error-free transforms where rounding would decide.
    Robust,
    /// `f64`, or pairs of `f32` up to the roots where the device has none.
    Double,
}

impl Tier {
    /// All tiers, cheapest first.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Robust, Self::Double];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Robust => "robust",
            Self::Double => "double",
        }
    }
}

impl fmt::Display for Tier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The tier that the user asks for; `None` is `auto`: the cheapest that covers the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Request(pub Option<Tier>);

impl FromStr for Request {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match Tier::ALL.into_iter().find(|tier| tier.name() == text) {
            Some(tier) => Ok(Self(Some(tier))),
            None if text == "auto" => Ok(Self(None)),
            None => Err("expected auto, fast, robust or double".into()),
        }
    }
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.map_or("auto", Tier::name))
    }
}

/// What a tier covers; beyond it the tier promises nothing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Promise {
    /// Greatest distance of the eye from a sphere, in least semi-axes of the sphere.
    pub distance: f64,
    /// The same for any other surface, where shadow and reflection rays start: an error there moves the edge of a shadow or
    /// of a mirror image by a part of the sphere's radius, not the edge of the sphere itself.
    pub secondary_distance: f64,
    /// Least distance of the eye or a light from a surface, in semi-axes.
    pub nearness: f64,
    /// Greatest ratio of a sphere's semi-axes.
    pub axis_ratio: f64,
    /// Least gap between two spheres of which one is around the other, in radii.
    pub gap: f64,
    /// Greatest specular exponent.
    pub exponent: f64,
    /// Greatest coordinate of a sphere or of a light that casts shadows, seen from the eye, in least semi-axes of any sphere: squares
    /// of it stay within the range of the tier's numbers.
    pub reach: f64,
    /// Greatest [`Brightness`].
    pub brightness: f64,
}

impl Tier {
    /// What the tier covers.
    pub fn promise(self) -> Promise {
        match self {
            Self::Fast => Promise {
                distance: 1e3,
                secondary_distance: 1e4,
                nearness: 1e-2,
                axis_ratio: 1e4,
                gap: 1e-5,
                exponent: 1e6,
                reach: 1e15,
                brightness: Scalar::Single.max_brightness(),
            },
            Self::Robust => Promise {
                distance: 1e7,
                secondary_distance: 1e7,
                nearness: 1e-7,
                axis_ratio: 1e4,
                gap: 1e-6,
                exponent: 1e6,
                reach: 1e15,
                brightness: Scalar::Single.max_brightness(),
            },
            Self::Double => Promise {
                distance: 1e9,
                secondary_distance: 1e9,
                nearness: 1e-12,
                axis_ratio: 1e6,
                gap: 1e-13,
                exponent: 1e12,
                reach: f64::INFINITY,
                brightness: Scalar::Double.max_brightness(),
            },
        }
    }
}

/// How hard a scene is, in the terms of [`Promise`]; each with the sphere that makes it so.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Demand {
    /// Greatest distance of the eye from a sphere, in least semi-axes.
    pub distance: Extreme,
    /// Greatest distance of a surface from a sphere, in least semi-axes of the latter.
    pub secondary_distance: Extreme,
    /// Least distance of the eye or a light from a surface, in semi-axes.
    pub nearness: Extreme,
    /// Greatest ratio of semi-axes.
    pub axis_ratio: Extreme,
    /// Least gap of nested surfaces, in radii.
    pub gap: Extreme,
    /// Greatest specular exponent.
    pub exponent: Extreme,
    /// Greatest coordinate of a sphere or of a light that casts shadows, in least semi-axes of any sphere.
    pub reach: Extreme,
    /// Greatest [`Brightness`], with the sphere that makes it so.
    pub brightness: Extreme,
}

/// An extreme value and the index of the sphere that has it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extreme {
    /// The value.
    pub value: f64,
    /// The sphere; `None` where no sphere has any.
    pub sphere: Option<usize>,
}

impl Extreme {
    fn raise(&mut self, value: f64, sphere: usize) {
        if value > self.value {
            *self = Self { value, sphere: Some(sphere) };
        }
    }

    fn lower(&mut self, value: f64, sphere: usize) {
        if value < self.value {
            *self = Self { value, sphere: Some(sphere) };
        }
    }
}

/// Pairs of spheres are searched for nested surfaces up to this many spheres; beyond, each against its successor.
const MAX_PAIRWISE: usize = 2000;

impl Demand {
    /// What `scene` demands where `effects` are simulated.
    pub fn of(scene: &Scene, effects: &Effects) -> Self {
        // The brightness aside, all of it is the same in any units: in those of kernels no square leaves the range.
        let scene = &*Units::of(scene, Secondary::EXACT).applied_to(Cow::Borrowed(scene));
        let (brightness, reach) = (Brightness::of(scene, effects), limits::reach(scene, effects));
        let least = Extreme { value: 0.0, sphere: None };
        let greatest = Extreme { value: f64::INFINITY, sphere: None };
        let mut demand = Self {
            distance: least,
            secondary_distance: least,
            nearness: greatest,
            axis_ratio: least,
            gap: greatest,
            exponent: least,
            reach: least,
            brightness: Extreme { value: brightness.greatest(), sphere: brightness.sphere },
        };
        // Secondary rays start on any surface.
        let secondary = effects.set.has_secondary_rays();
        let bounds = scene.spheres.iter().map(|s| (s.center - s.scale.abs(), s.center + s.scale.abs()));
        let (low, high) = bounds.reduce(|(a, b), (c, d)| (a.min(c), b.max(d))).unwrap_or_default();
        let lights = scene.lights.iter().filter(|_| effects.set.has(Effect::Shadows)).map(|light| light.position);
        let origins: Vec<DVec3> = std::iter::once(DVec3::ZERO).chain(lights).collect();

        for (index, sphere) in scene.spheres.iter().enumerate() {
            let scale = sphere.scale.abs();
            let (short, long) = (scale.min_element(), scale.max_element());
            demand.axis_ratio.raise(long / short, index);
            if effects.set.has(Effect::Specular) && sphere.ks != 0.0 {
                demand.exponent.raise(sphere.n, index);
            }
            demand.distance.raise(sphere.center.length() / short, index);
            if secondary && scene.spheres.len() > 1 {
                let corner = (sphere.center - low).abs().max((sphere.center - high).abs());
                demand.secondary_distance.raise(corner.length() / short, index);
            }
            demand.reach.raise(reach / short, index);
            for origin in &origins {
                let height = ((*origin - sphere.center) / scale).length() - 1.0;
                demand.nearness.lower(height.abs(), index);
            }
        }
        demand.find_gaps(scene);
        demand
    }

    /// Nested surfaces: nearly concentric spheres whose radii differ by little; equal ones are one surface.
    fn find_gaps(&mut self, scene: &Scene) {
        let spheres = &scene.spheres;
        let mut pair = |i: usize, j: usize| {
            let (a, b) = (&spheres[i], &spheres[j]);
            let size = a.scale.abs().max_element();
            let offset = (a.center - b.center).length() / size;
            let gap = (a.scale.abs() - b.scale.abs()).abs().max_element() / size;
            if offset < 0.1 && gap < 0.1 && (offset > 0.0 || gap > 0.0) {
                self.gap.lower(gap.max(offset), j);
            }
        };
        for i in 0..spheres.len() {
            let last = if spheres.len() <= MAX_PAIRWISE { spheres.len() } else { (i + 2).min(spheres.len()) };
            (i + 1..last).for_each(|j| pair(i, j));
        }
    }

    /// The first demand that `tier` does not cover, in words; `None` where it covers all.
    pub fn beyond(&self, tier: Tier, scene: &Scene) -> Option<String> {
        let promise = tier.promise();
        let name = |extreme: &Extreme| match extreme.sphere {
            Some(sphere) => format!("sphere '{}'", scene.sphere_names.get(sphere)),
            None => "no sphere".into(),
        };
        let above = |what: &str, demand: &Extreme, limit: f64| {
            (demand.value > limit)
                .then(|| format!("{what} {:.3e} of {} exceeds {limit:.0e}", demand.value, name(demand)))
        };
        let below = |what: &str, demand: &Extreme, limit: f64| {
            (demand.value < limit)
                .then(|| format!("{what} {:.3e} of {} is below {limit:.0e}", demand.value, name(demand)))
        };
        above("eye distance over radius", &self.distance, promise.distance)
            .or_else(|| {
                above("distance of a surface over radius", &self.secondary_distance, promise.secondary_distance)
            })
            .or_else(|| below("nearness of an origin to the surface", &self.nearness, promise.nearness))
            .or_else(|| above("axis ratio", &self.axis_ratio, promise.axis_ratio))
            .or_else(|| below("gap to a nested surface", &self.gap, promise.gap))
            .or_else(|| above("specular exponent", &self.exponent, promise.exponent))
            .or_else(|| above("greatest coordinate over radius", &self.reach, promise.reach))
            .or_else(|| above("brightness", &self.brightness, promise.brightness))
    }

    /// The demands, a line.
    pub fn summary(&self) -> String {
        let Self { distance, secondary_distance, nearness, axis_ratio, gap, exponent, reach, brightness } = self;
        format!(
            "distance/radius {:.3e} (eye), {:.3e} (surfaces), {:.3e} (all), nearness {:.3e}, axis ratio {:.3e}, nested gap {:.3e}, \
             exponent {}, brightness {:.3e}",
            distance.value,
            secondary_distance.value,
            reach.value,
            nearness.value,
            axis_ratio.value,
            gap.value,
            exponent.value,
            brightness.value
        )
    }
}

/// The tier that renders a scene, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Selection {
    /// The tier.
    pub tier: Tier,
    /// Why, in words.
    pub reason: String,
    /// What the scene demands.
    pub demand: Demand,
    /// Whether the tier's promise covers the demand.
    pub covered: bool,
}

impl Selection {
    /// The tier asked for, or the first one of `ladder` whose promise covers `scene`; where none does, `double`.
    pub fn of(scene: &Scene, effects: &Effects, request: Request, ladder: &[Tier]) -> Self {
        let demand = Demand::of(scene, effects);
        let excess = |tier| demand.beyond(tier, scene);
        let (tier, reason) = if let Some(tier) = request.0 {
            let why = excess(tier).map_or_else(|| "covers the scene".into(), |why| format!("not covered: {why}"));
            (tier, format!("asked for; {why}"))
        } else {
            // Each tier that is passed over says why.
            let mut passed_over = Vec::new();
            let covering = ladder.iter().copied().find(|&tier| match excess(tier) {
                None => true,
                Some(why) => {
                    passed_over.push(format!("not {tier}: {why}"));
                    false
                }
            });
            match covering {
                Some(tier) if passed_over.is_empty() => (tier, "the cheapest tier covers the scene".into()),
                Some(tier) => (tier, passed_over.join("; ")),
                None => (Tier::Double, format!("none covers the scene; {}", passed_over.join("; "))),
            }
        };
        let covered = excess(tier).is_none();
        Self { tier, reason, demand, covered }
    }
}
