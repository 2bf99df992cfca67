//! The precision ladder: what each tier promises, what a scene demands, and which tier covers it.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use crate::brightness::{Brightness, Scalar};
use crate::census::CHUNK;
use crate::effects::{Effect, Effects};
use crate::limits;
use crate::scene::{Scene, Sphere};
use crate::viewed::ViewedScene;

mod outline;
mod share;

use share::{LargestSpheres, Shares};

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

/// What the user asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Request {
    /// The cheapest tier that covers the scene.
    #[default]
    Auto,
    /// This tier.
    Tier(Tier),
    /// The reference's picture, with whatever kernels get it soonest.
    Certified,
}

impl FromStr for Request {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match Tier::ALL.into_iter().find(|tier| tier.name() == text) {
            Some(tier) => Ok(Self::Tier(tier)),
            None if text == "auto" => Ok(Self::Auto),
            None if text == CERTIFIED => Ok(Self::Certified),
            None => Err("expected auto, fast, robust, double or certified".into()),
        }
    }
}

/// What a picture is called that is the reference's for sure.
const CERTIFIED: &str = "certified";

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::Tier(tier) => tier.name(),
            Self::Certified => CERTIFIED,
        })
    }
}

/// What a tier covers; beyond it the tier promises nothing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Promise {
    /// Greatest share of the pixels that rounding is expected to change.
    pub share: f64,
    /// Least distance of the eye or a light from a surface, in parts of the coordinates that it is the difference of.
    pub nearness: f64,
    /// Greatest ratio of a sphere's semi-axes.
    pub axis_ratio: f64,
    /// Greatest specular exponent.
    pub exponent: f64,
    /// Greatest index of refraction, or reciprocal of one, of what one looks through.
    pub bending: f64,
    /// Greatest coordinate of a sphere or of a light that casts shadows, seen from the eye, in least semi-axes of any sphere: squares
    /// of it stay within the range of the tier's numbers.
    pub reach: f64,
    /// Greatest [`Brightness`].
    pub brightness: f64,
}

/// One pixel in so many is what a tier may differ by.
const MAX_SHARE: f64 = 1e-4;
/// The share of which a certified picture is begun by `fast` at the most, where `double` is cheap: `fast` is unsure of some five times as
/// many pixels.
const MAX_CERTIFIED_SHARE: f64 = 0.1;

impl Tier {
    /// What the tier covers.
    pub fn promise(self) -> Promise {
        match self {
            Self::Fast => Promise {
                share: MAX_SHARE,
                nearness: 1e-6,
                axis_ratio: 1e4,
                exponent: 1e6,
                bending: 30.0,
                reach: 1e15,
                brightness: Scalar::Single.max_brightness(),
            },
            Self::Robust => Promise { nearness: 2e-8, axis_ratio: 1e5, ..Self::Fast.promise() },
            Self::Double => Promise {
                share: MAX_SHARE,
                nearness: 1e-12,
                axis_ratio: 1e6,
                exponent: 1e12,
                bending: f64::INFINITY,
                reach: f64::INFINITY,
                brightness: Scalar::Double.max_brightness(),
            },
        }
    }
}

/// How hard a scene is, in the terms of [`Promise`]; each with the sphere that makes it so.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Demand {
    /// For each tier the share of the pixels that rounding is expected to change, with the sphere that adds most to it.
    pub share: [Extreme; 3],
    /// Least distance of the eye or a light from a surface, in parts of the coordinates that it is the difference of.
    pub nearness: Extreme,
    /// Greatest ratio of semi-axes.
    pub axis_ratio: Extreme,
    /// Greatest specular exponent.
    pub exponent: Extreme,
    /// Greatest index of refraction, or reciprocal of one, of what one looks through.
    pub bending: Extreme,
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
    /// What is raised, of no sphere.
    pub(crate) const NONE: Self = Self { value: 0.0, sphere: None };
    /// What is lowered, of no sphere.
    pub(crate) const NOTHING_LESS: Self = Self { value: f64::INFINITY, sphere: None };

    pub(crate) fn raise(&mut self, value: f64, sphere: usize) {
        if value > self.value {
            *self = Self { value, sphere: Some(sphere) };
        }
    }

    pub(crate) fn lower(&mut self, value: f64, sphere: usize) {
        if value < self.value {
            *self = Self { value, sphere: Some(sphere) };
        }
    }

    /// To that of later spheres.
    pub(crate) fn raise_to(&mut self, later: Self) {
        if later.value > self.value {
            *self = later;
        }
    }

    /// Likewise.
    pub(crate) fn lower_to(&mut self, later: Self) {
        if later.value < self.value {
            *self = later;
        }
    }
}

/// Pairs of spheres are searched for nested surfaces up to this many spheres; beyond, each against its successor.
const MAX_PAIRWISE: usize = 2000;
/// Nested spheres are no farther apart, in radii.
const CLOSE: f64 = 0.1;

impl Demand {
    /// What `viewed` demands where `effects` are simulated.
    pub fn of(viewed: &ViewedScene, effects: &Effects) -> Self {
        // The brightness aside, all of it is the same in any units: in these no square leaves the range.
        let (scene, census) = (viewed.scene(), viewed.census());
        let (brightness, reach) = (Brightness::of(viewed, effects), limits::reach(viewed, effects));
        let lights = scene.lights.iter().filter(|_| effects.set.has(Effect::Shadows)).map(|light| light.position);
        // Where rays are parallel none begins at the eye, and what is near the plane where they begin is cut away.
        let eye = (!viewed.settings().view.is_parallel()).then_some(DVec3::ZERO);
        let origins: Vec<DVec3> = eye.into_iter().chain(lights).collect();
        let count = scene.spheres.len();
        let chunk = |chunk: usize| {
            let mut found = Found::none();
            for index in chunk * CHUNK..count.min((chunk + 1) * CHUNK) {
                let sphere = &scene.spheres[index];
                found.add_nearness(index, sphere, &origins);
                found.largest.add(index, sphere);
                if count > MAX_PAIRWISE && index > 0 {
                    found.nested.extend(gap_of(scene, index - 1, index));
                }
            }
            found
        };
        let found = (0..count.div_ceil(CHUNK)).into_par_iter().map(chunk).reduce(Found::none, Found::and);
        let Found { nearness, largest, mut nested } = found;
        if count <= MAX_PAIRWISE {
            nested = nested_pairs(scene);
        }
        let on = |effect, extreme| if effects.set.has(effect) { extreme } else { Extreme::NONE };
        Self {
            share: Shares::new(scene, &viewed.settings().view, effects).estimate(&largest, &nested),
            nearness,
            axis_ratio: census.axis_ratio,
            exponent: on(Effect::Specular, census.exponent),
            bending: on(Effect::Refraction, census.bending),
            reach: Extreme { value: reach / census.least.value, ..census.least },
            brightness: Extreme { value: brightness.greatest(), sphere: brightness.sphere },
        }
    }

    /// The first demand that `tier` does not cover, in words; `None` where it covers all.
    pub fn beyond(&self, tier: Tier, scene: &Scene) -> Option<String> {
        self.beyond_with_share(tier, tier.promise().share, scene)
    }

    /// Likewise, where rounding may change this share of the pixels.
    fn beyond_with_share(&self, tier: Tier, most: f64, scene: &Scene) -> Option<String> {
        let promise = tier.promise();
        let name = |extreme: &Extreme| match extreme.sphere {
            Some(sphere) => scene.sphere_names.in_words("sphere", sphere),
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
        let share = &self.share[tier as usize];
        let too_many = !(share.value <= most);
        let pixels = || {
            let most = if share.sphere.is_some() { format!(", most by {}", name(share)) } else { String::new() };
            format!("rounding changes about one pixel in {:.0}{most}", (1.0 / share.value).max(1.0))
        };
        below("nearness of the eye or a light to the surface", &self.nearness, promise.nearness)
            .or_else(|| above("axis ratio", &self.axis_ratio, promise.axis_ratio))
            .or_else(|| above("specular exponent", &self.exponent, promise.exponent))
            .or_else(|| above("index of refraction", &self.bending, promise.bending))
            .or_else(|| above("greatest coordinate over radius", &self.reach, promise.reach))
            .or_else(|| above("brightness", &self.brightness, promise.brightness))
            .or_else(|| too_many.then(pixels))
    }

    /// The demands, a line.
    pub fn summary(&self) -> String {
        let Self { share, nearness, axis_ratio, exponent, bending, reach, brightness } = self;
        // Of no spheres there is no extreme.
        let one = |extreme: &Extreme| {
            if extreme.value.is_finite() { format!("{:.3e}", extreme.value) } else { "none".into() }
        };
        let shares = Tier::ALL.map(|tier| format!("{:.1e} at {tier}", share[tier as usize].value));
        format!(
            "share of pixels changed by rounding about {}, nearness {}, axis ratio {}, exponent {}, index of refraction {}, distance/radius {}, brightness {}",
            shares.join(", "),
            one(nearness),
            one(axis_ratio),
            exponent.value,
            bending.value,
            one(reach),
            one(brightness)
        )
    }
}

/// What one look at each sphere finds that each eye sees otherwise.
struct Found {
    nearness: Extreme,
    largest: LargestSpheres,
    /// Of many spheres: those that are nested with the one before them.
    nested: Vec<(usize, f64)>,
}

impl Found {
    fn none() -> Self {
        Self { nearness: Extreme::NOTHING_LESS, largest: LargestSpheres::default(), nested: Vec::new() }
    }

    /// How near the origins of rays, the eye and lights that cast shadows, are to the surface of a sphere.
    fn add_nearness(&mut self, index: usize, sphere: &Sphere, origins: &[DVec3]) {
        let scale = sphere.scale.abs();
        let (short, long) = (scale.min_element(), scale.max_element());
        for &origin in origins {
            let from_center = origin - sphere.center;
            // What is farther away is not near.
            if from_center.length_squared() <= 4.0 * long * long {
                let height = (from_center / scale).length() - 1.0;
                let coordinates = sphere.center.length() + origin.length() + long;
                self.nearness.lower(height.abs() * short / coordinates, index);
            }
        }
    }

    fn and(mut self, later: Self) -> Self {
        self.nested.extend(later.nested);
        self.nearness.lower_to(later.nearness);
        Self { largest: self.largest.plus(later.largest), ..self }
    }
}

/// The second of two nearly concentric spheres whose radii differ by little, with the gap in world units; equal ones are one surface.
fn gap_of(scene: &Scene, i: usize, j: usize) -> Option<(usize, f64)> {
    let (a, b) = (&scene.spheres[i], &scene.spheres[j]);
    let size = a.scale.abs().max_element();
    let way = a.center - b.center;
    // Most are far apart, and no root is needed to see that.
    if way.abs().max_element() > CLOSE * size {
        return None;
    }
    let offset = way.length();
    let gap = (a.scale.abs() - b.scale.abs()).abs().max_element().max(offset);
    (gap < CLOSE * size && gap > 0.0).then_some((j, gap))
}

/// All such pairs.
fn nested_pairs(scene: &Scene) -> Vec<(usize, f64)> {
    let spheres = &scene.spheres;
    // Only spheres whose centres are close along x can be.
    let mut order: Vec<usize> = (0..spheres.len()).collect();
    order.sort_unstable_by(|&i, &j| spheres[i].center.x.total_cmp(&spheres[j].center.x));
    let close_to = |at: usize| {
        let sphere = &spheres[order[at]];
        let end = sphere.center.x + CLOSE * (1.0 + CLOSE) * sphere.scale.abs().max_element();
        order[at + 1..].iter().copied().take_while(move |&j| spheres[j].center.x <= end)
    };
    (0..order.len())
        .flat_map(|at| {
            close_to(at).filter_map(|j| gap_of(scene, order[at].min(j), order[at].max(j))).collect::<Vec<_>>()
        })
        .collect()
}

/// The tier that renders a scene, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Selection {
    /// The tier; of a certified picture, that of its first kernel.
    pub tier: Tier,
    /// Whether all that this kernel is unsure of is rendered again until it is what the reference has.
    pub certified: bool,
    /// Why, in words.
    pub reason: String,
    /// What the scene demands.
    pub demand: Demand,
    /// Whether the tier's promise covers the demand, or the picture is certified.
    pub covered: bool,
}

impl fmt::Display for Selection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(if self.certified { CERTIFIED } else { self.tier.name() })
    }
}

impl Selection {
    /// What is asked for, or the first tier of `ladder` whose promise covers `viewed`; where none does, `double`.
    pub fn of(viewed: &ViewedScene, effects: &Effects, request: Request, ladder: &[Tier]) -> Self {
        let _span = tracing::info_span!("choose precision").entered();
        let demand = Demand::of(viewed, effects);
        let excess = |tier| demand.beyond(tier, viewed.scene());
        let (tier, reason) = match request {
            Request::Tier(tier) => {
                let why = excess(tier).map_or_else(|| "covers the scene".into(), |why| format!("not covered: {why}"));
                (tier, format!("asked for; {why}"))
            }
            Request::Certified => {
                // However many pixels rounding changes, `fast` knows them. But where `double` is cheap, and so next to it, it costs less
                // than what is left to do.
                let most = if ladder.get(1) == Some(&Tier::Double) { MAX_CERTIFIED_SHARE } else { f64::INFINITY };
                match demand.beyond_with_share(Tier::Fast, most, viewed.scene()) {
                    None => (Tier::Fast, "asked for; begun by the cheapest tier".into()),
                    Some(why) => (Tier::Double, format!("asked for; begun by double, not fast: {why}")),
                }
            }
            // Where only `double` is left, a certified picture can be cheaper by a tenth, or dearer by far: PRECISION.md has figures.
            Request::Auto => {
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
            }
        };
        let certified = request == Request::Certified;
        let covered = certified || excess(tier).is_none();
        Self { tier, certified, reason, demand, covered }
    }

    /// The same for a picture of which colours are wanted: where it is certified, `double` begins, since `f32` tells no levels of 16 bits.
    #[must_use]
    pub fn with_colors(self, are_wanted: bool) -> Self {
        if !are_wanted || !self.certified {
            return self;
        }
        let reason = "asked for; begun by double: f32 has too few bits for levels of 16".into();
        Self { tier: Tier::Double, reason, ..self }
    }
}
