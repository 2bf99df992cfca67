//! How great the numbers become that make up a colour: beyond the range of the scalar that adds them up they would be infinite.

use glam::DVec3;

use crate::effects::{Effect, Effects};
use crate::scene::{Scene, Sphere};
use crate::viewed::ViewedScene;

/// The greatest colour that a path can gather, as a product of which no factor is taken as less than 1: no partial product is
/// greater, and what underflow takes from one is invisible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Brightness {
    /// Of one surface.
    local: f64,
    /// What all bounces together multiply it by at the most.
    gain: f64,
    /// Whether a factor is negative: then what is too bright for the picture may be taken away again.
    has_negative: bool,
    /// The sphere that makes it so; none where it is AMBIENT or BACK.
    pub sphere: Option<usize>,
}

/// A scalar that adds up colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scalar {
    /// `f32`.
    Single,
    /// `f64`.
    Double,
}

impl Scalar {
    /// Its unit roundoff: half a unit in the last place of 1.
    pub const fn unit(self) -> f64 {
        match self {
            Self::Single => f32::EPSILON as f64 / 2.0,
            Self::Double => f64::EPSILON / 2.0,
        }
    }

    /// The greatest weight of a ray, and its negative the least: mirrors and glass with a coefficient beyond 1 or -1 amplify no
    /// further, or products would overflow; where nothing is negative, whatever is lit at all is white long before.
    pub const fn max_throughput(self) -> f64 {
        match self {
            Self::Single => 1e25,
            Self::Double => 1e280,
        }
    }

    /// The greatest brightness that leaves room for the sum over a path, over a pixel's samples, and for 255.
    pub fn max_brightness(self) -> f64 {
        match self {
            Self::Single => 1e33,
            Self::Double => 1e300,
        }
    }
}

/// What a sphere, or several, add: each with the sphere that adds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Parts {
    local: (f64, Option<usize>),
    /// Of a bounce: by reflection, by refraction, by both.
    gains: [(f64, Option<usize>); 3],
    has_negative: bool,
}

impl Parts {
    /// Of no sphere.
    pub(crate) const NONE: Self = Self { local: (1.0, None), gains: [(1.0, None); 3], has_negative: false };

    /// The light of AMBIENT, and that of all lights together.
    pub(crate) fn light(scene: &Scene) -> [f64; 2] {
        [greatest(scene.ambient), scene.lights.iter().map(|light| greatest(light.intensity)).sum()]
    }

    /// Of one sphere in this light.
    pub(crate) fn of(index: usize, sphere: &Sphere, [ambient, lights]: [f64; 2]) -> Self {
        let at_least_1 = |x: f64| x.abs().max(1.0);
        let shown = ambient * at_least_1(sphere.ka) + lights * (at_least_1(sphere.kd) + at_least_1(sphere.ks));
        let gains = [sphere.kr.abs(), sphere.kt.abs(), sphere.kr.abs() + sphere.kt.abs()];
        let coefficients = [sphere.ka, sphere.kd, sphere.ks, sphere.kr, sphere.kt];
        Self {
            local: (greatest(sphere.color) * shown, Some(index)),
            gains: gains.map(|gain| (gain, Some(index))),
            has_negative: coefficients.iter().any(|&k| k < 0.0) || sphere.color.min_element() < 0.0,
        }
    }

    /// Of these and of `later` spheres.
    pub(crate) fn greater(self, later: Self) -> Self {
        Self {
            local: later_if_greater(self.local, later.local),
            gains: [0, 1, 2].map(|kind| later_if_greater(self.gains[kind], later.gains[kind])),
            has_negative: self.has_negative || later.has_negative,
        }
    }
}

/// The greatest component, or 1.
fn greatest(color: DVec3) -> f64 {
    color.abs().max_element().max(1.0)
}

fn later_if_greater(first: (f64, Option<usize>), later: (f64, Option<usize>)) -> (f64, Option<usize>) {
    if later.0 > first.0 { later } else { first }
}

impl Brightness {
    /// Of `viewed` where `effects` are simulated.
    pub fn of(viewed: &ViewedScene, effects: &Effects) -> Self {
        let scene = viewed.scene();
        let Parts { local, gains, has_negative } = viewed.census().brightness;
        let gain = match [Effect::Reflections, Effect::Refraction].map(|effect| effects.set.has(effect)) {
            [false, false] => (1.0, None),
            [true, false] => gains[0],
            [false, true] => gains[1],
            [true, true] => gains[2],
        };
        let mut colors = scene.lights.iter().map(|light| light.intensity).chain([scene.ambient, scene.background]);
        let (local, local_sphere) =
            later_if_greater((greatest(scene.ambient).max(greatest(scene.background)), None), local);
        let bounces = gain.0.powf(f64::from(effects.depth));
        Self {
            local,
            gain: bounces,
            has_negative: has_negative || colors.any(|color| color.min_element() < 0.0),
            sphere: if bounces > local { gain.1 } else { local_sphere },
        }
    }

    /// The greatest colour.
    pub fn greatest(&self) -> f64 {
        self.local * self.gain
    }

    /// Whether colours become infinite in `scalar`, or wrong where the weight of a ray is limited.
    pub fn overflows(&self, scalar: Scalar) -> bool {
        let gain = if self.has_negative { self.gain } else { self.gain.min(scalar.max_throughput()) };
        self.local * gain > scalar.max_brightness()
    }

    /// Why `scene`, which this is the brightness of, cannot be rendered in `scalar`; `None` where it can.
    pub fn problem(&self, scene: &Scene, scalar: Scalar) -> Option<String> {
        self.overflows(scalar).then(|| {
            let source = match self.sphere {
                Some(sphere) => format!("the numbers of {}", scene.sphere_names.in_words("sphere", sphere)),
                None => "the numbers of AMBIENT or BACK".into(),
            };
            let (name, limit) = match scalar {
                Scalar::Single => ("f32", scalar.max_brightness()),
                Scalar::Double => ("f64", scalar.max_brightness()),
            };
            format!("{source} make colours of up to {:.0e}, beyond what {name} adds up, {limit:.0e}", self.greatest())
        })
    }
}
