//! What a scene calls for: the one place that decides which code a renderer needs, and says why.
//!
//! An effect may be off only where the picture is the same, byte for byte, with it on. Every geometric test here is
//! conservative: in doubt the effect is on.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;
use rayon::prelude::*;
use serde::{Serialize, Serializer};

use crate::census::{Census, Extents};
use crate::scene::{Light, Scene, Sphere};
use crate::settings::Settings;
use crate::viewed::ViewedScene;
use crate::words::count;

/// Something a renderer can simulate or leave out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effect {
    /// Ka·Ia·O.
    Ambient,
    /// Kd·Ip·(N·L)·O.
    Diffuse,
    /// Ks·Ip·(R·V)ⁿ.
    Specular,
    /// Shadow rays.
    Shadows,
    /// Reflection rays.
    Reflections,
    /// Refraction rays.
    Refraction,
    /// Primary rays test the image plane and see inner walls.
    Shells,
    /// Object space differs from world space by more than a translation.
    Ellipsoids,
}

impl Effect {
    /// All effects, in the order of the tables.
    pub const ALL: [Self; 8] = [
        Self::Ambient,
        Self::Diffuse,
        Self::Specular,
        Self::Shadows,
        Self::Reflections,
        Self::Refraction,
        Self::Shells,
        Self::Ellipsoids,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ambient => "ambient",
            Self::Diffuse => "diffuse",
            Self::Specular => "specular",
            Self::Shadows => "shadows",
            Self::Reflections => "reflections",
            Self::Refraction => "refraction",
            Self::Shells => "shells",
            Self::Ellipsoids => "ellipsoids",
        }
    }

    fn bit(self) -> u16 {
        1 << self as u16
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A set of effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct EffectSet(u16);

impl EffectSet {
    /// No effect.
    pub const NONE: Self = Self(0);
    /// Every effect.
    pub const ALL: Self = Self((1 << Effect::ALL.len()) - 1);

    /// Whether `effect` is in the set.
    pub fn has(self, effect: Effect) -> bool {
        self.0 & effect.bit() != 0
    }

    /// Whether rays leave surfaces.
    pub fn has_secondary_rays(self) -> bool {
        [Effect::Shadows, Effect::Reflections, Effect::Refraction].into_iter().any(|effect| self.has(effect))
    }

    /// The set with `effect` in it or not.
    #[must_use]
    pub fn with(self, effect: Effect, on: bool) -> Self {
        if on { Self(self.0 | effect.bit()) } else { Self(self.0 & !effect.bit()) }
    }

    /// The effects in the set.
    pub fn iter(self) -> impl Iterator<Item = Effect> {
        Effect::ALL.into_iter().filter(move |&effect| self.has(effect))
    }

    /// Every possible set.
    pub fn every() -> impl Iterator<Item = Self> {
        (0..=Self::ALL.0).map(Self)
    }
}

impl FromIterator<Effect> for EffectSet {
    fn from_iter<I: IntoIterator<Item = Effect>>(effects: I) -> Self {
        effects.into_iter().fold(Self::NONE, |set, effect| set.with(effect, true))
    }
}

impl Serialize for EffectSet {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

impl fmt::Display for EffectSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::NONE {
            return f.write_str("none");
        }
        let names: Vec<_> = self.iter().map(Effect::name).collect();
        f.write_str(&names.join(","))
    }
}

/// What the user asks for: `auto`, `all`, `none`, a plain list (exactly those), or a list of `+name` and `-name` (what
/// the scene calls for, with these switched on or off).
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Request {
    /// What the scene calls for.
    #[default]
    Auto,
    /// Exactly this set.
    Exactly(EffectSet),
    /// What the scene calls for, changed.
    Changed(Vec<(Effect, bool)>),
}

impl FromStr for Request {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => return Ok(Self::Auto),
            "all" => return Ok(Self::Exactly(EffectSet::ALL)),
            "none" => return Ok(Self::Exactly(EffectSet::NONE)),
            _ => {}
        }
        let mut plain = Vec::new();
        let mut changes = Vec::new();
        for word in text.split(',').map(str::trim) {
            match word.split_at_checked(1) {
                Some(("+", name)) => changes.push((effect_named(name)?, true)),
                Some(("-", name)) => changes.push((effect_named(name)?, false)),
                _ => plain.push(effect_named(word)?),
            }
        }
        match (plain.is_empty(), changes.is_empty()) {
            (true, _) => Ok(Self::Changed(changes)),
            (_, true) => Ok(Self::Exactly(plain.into_iter().collect())),
            _ => Err("either plain names (exactly those effects) or +name and -name (changes), not both".into()),
        }
    }
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Exactly(EffectSet::ALL) => f.write_str("all"),
            Self::Exactly(set) => set.fmt(f),
            Self::Changed(changes) => {
                let words: Vec<_> =
                    changes.iter().map(|(effect, on)| format!("{}{effect}", if *on { '+' } else { '-' })).collect();
                f.write_str(&words.join(","))
            }
        }
    }
}

fn effect_named(name: &str) -> Result<Effect, String> {
    Effect::ALL.into_iter().find(|effect| effect.name() == name).ok_or_else(|| {
        let names: Vec<_> = Effect::ALL.into_iter().map(Effect::name).collect();
        format!("no effect is called '{name}'; there are auto, all, none and a list of {}", names.join(", "))
    })
}

/// One row of the table that explains the effects.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Row {
    /// The effect.
    pub effect: Effect,
    /// Whether it is simulated.
    pub on: bool,
    /// Why, in words.
    pub reason: String,
}

/// The effects that are simulated, each with its reason.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Effects {
    /// The effects that are on.
    pub set: EffectSet,
    /// Greatest number of bounces, reflected or refracted, that can matter; 0 where there are none.
    pub depth: u32,
    /// One row for each effect.
    pub rows: Vec<Row>,
}

impl Effects {
    /// What `viewed` calls for.
    pub fn of(viewed: &ViewedScene) -> Self {
        let _span = tracing::info_span!("find effects").entered();
        // In its units no square below overflows or underflows, and what is too small for kernels is seen.
        let settings = viewed.settings();
        let needs = Needs::new(viewed);
        let (depth, reflections) = needs.reflections();
        let refraction = needs.refraction();
        let depth = if refraction.is_ok() { settings.max_depth } else { depth };
        let mut findings = vec![
            (Effect::Ambient, needs.ambient()),
            (Effect::Diffuse, needs.diffuse()),
            (Effect::Specular, needs.specular()),
        ];
        let lit = findings[1].1.is_ok() || findings[2].1.is_ok();
        findings
            .push((Effect::Shadows, if lit { needs.shadows() } else { Err("no surface is lit by a light".into()) }));
        findings.push((Effect::Reflections, reflections));
        findings.push((Effect::Refraction, refraction));
        findings.push((Effect::Shells, needs.shells()));
        findings.push((Effect::Ellipsoids, needs.ellipsoids()));
        let rows: Vec<_> = findings
            .into_iter()
            .map(|(effect, finding)| Row { effect, on: finding.is_ok(), reason: finding.unwrap_or_else(|why| why) })
            .collect();
        Self { set: rows.iter().filter(|row| row.on).map(|row| row.effect).collect(), depth, rows }
    }

    /// The greatest number of waiting rays that a picture may call for: every bounce doubles the rays.
    pub const MAX_WAITING: u32 = 32;

    /// How many refraction rays wait at the most until the reflected rays beside them have been followed to their ends.
    pub fn waiting(&self, scene: &Scene) -> u32 {
        if !self.set.has(Effect::Refraction) {
            return 0;
        }
        let reflects = self.set.has(Effect::Reflections);
        let branches = reflects && scene.spheres.iter().any(|s| s.kr != 0.0 && s.kt != 0.0);
        if branches { self.depth.max(1) } else { 1 }
    }

    /// Why `scene` cannot be rendered so deep; `None` where it can.
    pub fn too_deep(&self, scene: &Scene) -> Option<String> {
        let waiting = self.waiting(scene);
        (waiting > Self::MAX_WAITING).then(|| {
            format!("a depth of {waiting} is too much where a sphere has both Kr and Kt: every bounce doubles the rays")
        })
    }

    /// What `request` makes of what `viewed` calls for.
    pub fn requested(viewed: &ViewedScene, request: &Request) -> Self {
        let settings = viewed.settings();
        let mut effects = Self::of(viewed);
        let set = match request {
            Request::Auto => return effects,
            Request::Exactly(set) => *set,
            Request::Changed(changes) => changes.iter().fold(effects.set, |set, &(effect, on)| set.with(effect, on)),
        };
        for row in &mut effects.rows {
            let on = set.has(row.effect);
            if on != row.on {
                row.reason = format!("forced {}; the scene: {}", if on { "on" } else { "off" }, row.reason);
                row.on = on;
            }
        }
        effects.set = set;
        // Forcing means running the code in full, not the depth that is known to suffice.
        let forced = *request == Request::Exactly(EffectSet::ALL);
        let bounces = set.has(Effect::Reflections) || set.has(Effect::Refraction);
        effects.depth = match (bounces, effects.depth) {
            (false, _) => 0,
            (true, 0) => settings.max_depth,
            (true, _) if forced => settings.max_depth,
            (true, depth) => depth,
        };
        effects
    }
}

/// Beyond this many pairs of a light and a sphere the search for blockers is not worth its time.
const MAX_SHADOW_PAIRS: usize = 4096;
/// Spheres within this range of semi-axes need no rescaling to keep f32 squares in range.
pub(crate) const COMMON_SIZES: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// Yes or no, with the reason.
type Finding = Result<String, String>;

/// What the rules look at.
struct Needs<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    census: &'a Census,
    /// The first sphere of which a primary ray may see the inner wall.
    first_cut: Option<usize>,
    /// The first sphere that refracts.
    glass: Option<usize>,
}

impl<'a> Needs<'a> {
    fn new(viewed: &'a ViewedScene) -> Self {
        let (scene, settings, census) = (viewed.scene(), viewed.settings(), viewed.census());
        let is_cut = |sphere: &Sphere| !beyond_image_plane(scene, settings, sphere);
        // Most often one look at all of them together is enough.
        let first_cut =
            if all_beyond_image_plane(viewed) { None } else { scene.spheres.par_iter().position_first(is_cut) };
        let glass = census.glass.filter(|_| settings.max_depth > 0);
        Self { scene, settings, census, first_cut, glass }
    }

    fn name(&self, index: usize) -> String {
        self.scene.sphere_names.in_words("sphere", index)
    }

    fn ambient(&self) -> Finding {
        let light = self.scene.ambient;
        if light == DVec3::ZERO {
            return Err("AMBIENT is 0".into());
        }
        match self.scene.spheres.iter().position(|s| s.ka != 0.0 && s.color * light != DVec3::ZERO) {
            Some(index) => Ok(format!("{} has Ka > 0", self.name(index))),
            None => Err("no sphere has a Ka and a colour that AMBIENT shows".into()),
        }
    }

    /// The first sphere that `find` finds among those that one of some lights shows, if there is any light.
    fn lit_by_lights(&self, coefficient: &str, find: impl Fn(&[&Light]) -> Option<usize>) -> Finding {
        if self.scene.lights.is_empty() {
            return Err("no lights".into());
        }
        let useful: Vec<_> = self.scene.lights.iter().filter(|l| l.intensity != DVec3::ZERO).collect();
        if useful.is_empty() {
            return Err("every light has intensity 0".into());
        }
        match find(&useful) {
            Some(index) => Ok(format!("{} has {coefficient} > 0", self.name(index))),
            None => Err(format!("no sphere has a {coefficient} that the lights show")),
        }
    }

    fn diffuse(&self) -> Finding {
        self.lit_by_lights("Kd", |lights| {
            let shows = |s: &Sphere| lights.iter().any(|light| s.color * light.intensity != DVec3::ZERO);
            self.scene.spheres.iter().position(|s| s.kd != 0.0 && shows(s))
        })
    }

    fn specular(&self) -> Finding {
        self.lit_by_lights("Ks", |_| self.census.shiny)
    }

    /// Whether some sphere can stand between a light and a point that it lights.
    fn shadows(&self) -> Finding {
        let Scene { spheres, lights, .. } = self.scene;
        if let Some(index) = self.glass {
            return Ok(format!("{} shows inner walls, which shadow themselves", self.name(index)));
        }
        if let Some(index) = self.first_cut.filter(|_| spheres.len() == 1) {
            return Ok(format!("{} may be seen from inside, where it shadows itself", self.name(index)));
        }
        if spheres.len() * lights.len() > MAX_SHADOW_PAIRS {
            return Ok(format!("{} may stand in each other's light", count(spheres.len() as u64, "sphere")));
        }
        for (r, receiver) in spheres.iter().enumerate().filter(|(_, s)| s.kd != 0.0 || s.ks != 0.0) {
            if !beyond_image_plane(self.scene, self.settings, receiver) {
                return Ok(format!("{} may be seen from inside, where it shadows itself", self.name(r)));
            }
            for (l, light) in lights.iter().enumerate().filter(|(_, l)| l.intensity != DVec3::ZERO) {
                let blocker =
                    spheres.iter().enumerate().find(|&(b, blocker)| b != r && may_block(light, receiver, blocker));
                if let Some((b, _)) = blocker {
                    let light = self.scene.light_names.in_words("light", l);
                    return Ok(format!("{} may stand between {light} and {}", self.name(b), self.name(r)));
                }
            }
        }
        if spheres.len() == 1 {
            Err("the only sphere is convex and seen from outside".into())
        } else {
            Err("no sphere stands between a light and a lit sphere".into())
        }
    }

    /// The depth that can matter, and the finding.
    fn reflections(&self) -> (u32, Finding) {
        let Scene { spheres, .. } = self.scene;
        if self.settings.max_depth == 0 {
            return (0, Err("the greatest depth is 0".into()));
        }
        let [first, second] = self.census.mirrors;
        let Some(first) = first else {
            return (0, Err("no sphere has Kr > 0".into()));
        };
        let name = self.name(first);
        if self.glass.is_some() {
            // Refraction rays see mirrors from anywhere, and their inner walls.
            return (self.settings.max_depth, Ok(format!("{name} has Kr > 0")));
        }
        let outside_only =
            beyond_image_plane(self.scene, self.settings, &spheres[first]) && self.far_from_others(first);
        match (second, outside_only) {
            (None, true) if spheres.len() == 1 => {
                (0, Err(format!("{name} is alone, convex and seen from outside: its reflection rays hit nothing")))
            }
            (None, true) => (1, Ok(format!("{name} is the only one with Kr > 0: one bounce is all that matters"))),
            _ => (self.settings.max_depth, Ok(format!("{name} has Kr > 0"))),
        }
    }

    fn refraction(&self) -> Finding {
        match self.glass {
            Some(index) => Ok(format!("{} has Kt > 0", self.name(index))),
            None if self.settings.max_depth == 0 => Err("the greatest depth is 0".into()),
            None => Err("no sphere has Kt > 0".into()),
        }
    }

    /// Whether a reflection ray that leaves this sphere can never start within rounding or epsilon of a surface.
    fn far_from_others(&self, index: usize) -> bool {
        let own = &self.scene.spheres[index];
        let epsilon = self.settings.secondary.reflection;
        self.scene.spheres.iter().enumerate().filter(|&(other, _)| other != index).all(|(_, other)| {
            let gap = (own.center - other.center).length() - radius(own) - radius(other);
            gap > 2.0 * epsilon + rounding(own) + rounding(other)
        })
    }

    fn shells(&self) -> Finding {
        match self.first_cut {
            Some(index) => Ok(format!("{} is not wholly beyond the image plane", self.name(index))),
            None => Err("every sphere is wholly beyond the image plane".into()),
        }
    }

    fn ellipsoids(&self) -> Finding {
        if let Some(index) = self.census.uneven {
            return Ok(format!("{} has unequal semi-axes", self.name(index)));
        }
        match self.census.uncommon {
            Some(index) => Ok(format!("{} is so small or large that its size must be scaled out", self.name(index))),
            None => Err("every sphere has three equal semi-axes".into()),
        }
    }
}

/// The radius of the bounding sphere.
fn radius(sphere: &Sphere) -> f64 {
    sphere.scale.abs().max_element()
}

/// How far 64 roundings in f32 can move a point of the sphere; grazing rays magnify them by the axis ratio.
fn rounding(sphere: &Sphere) -> f64 {
    let ratio = radius(sphere) / sphere.scale.abs().min_element();
    64.0 * f64::from(f32::EPSILON) * (sphere.center.length() + radius(sphere)) * ratio
}

/// Whether the box around all spheres lies so far beyond the image plane that each of them does.
fn all_beyond_image_plane(viewed: &ViewedScene) -> bool {
    let (Extents { low, high, .. }, near) = (viewed.extents(), viewed.scene().window.near);
    let [_, _, back] = viewed.settings().view.axes();
    let ends = [back * low, back * high];
    let [nearest, farthest] = [ends[0].max(ends[1]), ends[0].min(ends[1])].map(DVec3::element_sum);
    // Twice what each sphere keeps, which leaves room for rounding.
    nearest < -near - 2e-4 * (near + nearest.abs().max(farthest.abs()))
}

/// Whether no primary ray can meet the sphere at or before the image plane, nor from inside.
fn beyond_image_plane(scene: &Scene, settings: &Settings, sphere: &Sphere) -> bool {
    let near = scene.window.near;
    let [_, _, back] = settings.view.axes();
    let z = back.dot(sphere.center);
    let margin = 1e-4 * (near + z.abs());
    // The support of the ellipsoid, scaled so that no square overflows.
    let half_axes = back * sphere.scale;
    let greatest = half_axes.abs().max_element();
    z + greatest * (half_axes / greatest).length() < -near - margin
}

/// Whether `blocker` comes near the hull of the light and the receiver, both taken as bounding spheres.
fn may_block(light: &Light, receiver: &Sphere, blocker: &Sphere) -> bool {
    let axis = receiver.center - light.position;
    let to_blocker = blocker.center - light.position;
    let (r, b) = (radius(receiver), radius(blocker));
    // A sphere of radius s·r around light + s·axis, s in 0..=1, sweeps the hull: its distance to the blocker at the s that
    // is nearest. Linear in s, so the ends and the stationary point are enough.
    let clearance = |s: f64| (to_blocker - axis * s).length() - s * r;
    let length_squared = axis.length_squared();
    let nearest = if length_squared > r * r {
        // The distance from the cone's surface: shift the foot point along the axis by the half angle.
        let along = to_blocker.dot(axis) / length_squared;
        let aside = (to_blocker - axis * along).length();
        along + aside * r / (length_squared * (length_squared - r * r)).sqrt()
    } else {
        return true; // the light is inside the receiver's bound
    };
    let least = clearance(0.0).min(clearance(1.0)).min(clearance(nearest.clamp(0.0, 1.0)));
    let scale = light.position.length() + receiver.center.length() + blocker.center.length() + r + b;
    least < b + 1e-3 * scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::scene::Window;
    use crate::view::View;

    /// The look at all spheres together finds nothing that the look at each does not.
    #[test]
    fn where_all_are_beyond_the_image_plane_each_is() {
        let mut random = Random::new(10, 1);
        let mut beyond = 0;
        for _ in 0..3000 {
            let mut scene = Scene::new(Window::default(), 8, 8);
            let at = random.in_box(20.0);
            for _ in 0..random.bits() % 4 {
                let mut sphere = Sphere::new(at + random.in_box(2.0), 1.0, DVec3::ONE);
                sphere.scale = random.in_box(0.5) + DVec3::splat(0.6);
                scene.spheres.push(sphere);
            }
            let view = View::new(random.in_box(1.0), Some(at), random.unit()).expect("it is far");
            let viewed = scene.viewed_by(&Settings { view, ..Settings::default() }, None);
            if all_beyond_image_plane(&viewed) {
                beyond += 1;
                let is_beyond = |s: &Sphere| beyond_image_plane(viewed.scene(), viewed.settings(), s);
                assert!(viewed.scene().spheres.iter().all(is_beyond), "{:?}", viewed.scene().spheres);
            }
        }
        assert!(beyond > 1000, "{beyond}");
    }
}
