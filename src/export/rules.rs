//! What the renderers can express and what they cannot.

use glam::DVec3;

use super::povray::sky;
use super::{Obstacle, Peer};
use crate::effects::{Effect, Effects};
use crate::geometry::shape_indices;
use crate::scene::{Scene, Sphere, Window};
use crate::settings::{Quantize, Secondary, Settings};
use crate::view::Projection;

/// POV-Ray finds no hit beyond this distance (its `MAX_DISTANCE`).
const POVRAY_REACH: f64 = 1e7;
/// POV-Ray's shadow rays pass over blockers this near (its `SHADOW_TOLERANCE`).
const POVRAY_EPSILON: f64 = 1e-3;
/// So many radii from the origin POV-Ray has single pixels wrong, and ten times as many whole surfaces.
const POVRAY_DISTANCE: f64 = 3e4;
/// Tachyon's secondary rays pass over surfaces this near (its `EPSILON`, with which it also moves their start).
const TACHYON_EPSILON: f64 = 5e-5;
/// Tachyon ignores contributions up to half a level (its `MINCONTRIB`).
const TACHYON_LEAST: f64 = 1.0 / 510.0;
/// Tachyon reads numbers as `f32`: at so many radii from the origin that moves a sphere by a thousandth of its radius.
const TACHYON_DISTANCE: f64 = 1e4;

/// Which part of a sphere eye rays may see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum View {
    /// All of it, or none because no eye ray comes near.
    Whole,
    /// The part beyond the image plane, and into the shell.
    Cut,
    /// Nothing, though it lies in the way: it is before the image plane.
    Hidden,
}

impl View {
    pub(super) fn of(window: &Window, projection: Projection, sphere: &Sphere) -> Self {
        let depth = (-sphere.center.z - sphere.scale.z.abs(), -sphere.center.z + sphere.scale.z.abs());
        if depth.0 > window.near || depth.1 <= 0.0 || beside(window, projection, sphere) {
            Self::Whole
        } else if depth.1 > window.near {
            Self::Cut
        } else {
            Self::Hidden
        }
    }
}

/// Whether the sphere lies wholly outside the pyramid or the beam of eye rays, on the far side of one of its four sides.
fn beside(window: &Window, projection: Projection, sphere: &Sphere) -> bool {
    let Window { near, left, right, bottom, top } = *window;
    let (left, right) = (left.min(right), left.max(right));
    let (bottom, top) = (bottom.min(top), bottom.max(top));
    let radius = sphere.scale.abs().max_element();
    // Samples may lie on the edges of the window.
    let (aside, above) = (0.01 * (right - left), 0.01 * (top - bottom));
    let edges =
        [(DVec3::X, right + aside), (-DVec3::X, aside - left), (DVec3::Y, top + above), (-DVec3::Y, above - bottom)];
    edges.into_iter().any(|(outward, edge)| match projection {
        Projection::Perspective => (outward * near + DVec3::Z * edge).normalize().dot(sphere.center) > radius,
        Projection::Orthographic => outward.dot(sphere.center) - edge > radius,
    })
}

/// What `peer` cannot express of `scene`, and what will differ slightly.
pub(super) fn judge(scene: &Scene, settings: &Settings, effects: &Effects, peer: Peer) -> (Vec<Obstacle>, Vec<String>) {
    let mut found = Found { scene, peer, obstacles: Vec::new(), warnings: Vec::new() };
    found.settings(settings);
    found.both(effects);
    found.epsilon(&settings.secondary, effects);
    match peer {
        Peer::PovRay => found.povray(effects),
        Peer::Tachyon => found.tachyon(settings.view.projection(), effects),
    }
    (found.obstacles, found.warnings)
}

struct Found<'a> {
    scene: &'a Scene,
    peer: Peer,
    obstacles: Vec<Obstacle>,
    warnings: Vec<String>,
}

impl Found<'_> {
    /// Spheres with a property, by the first of them, for a message.
    fn spheres(&self, property: impl Fn(&Sphere) -> bool) -> Option<String> {
        let Scene { spheres, sphere_names, .. } = self.scene;
        let mut indices = (0..spheres.len()).filter(|&index| property(&spheres[index]));
        let first = indices.next()?;
        let name = sphere_names.in_words("sphere", first);
        Some(match indices.count() {
            0 => name,
            more => format!("{name} and {more} more"),
        })
    }

    fn obstacle(&mut self, property: impl Fn(&Sphere) -> bool, what: &str) {
        if let Some(who) = self.spheres(property) {
            self.obstacles.push(Obstacle::Scene(format!("{who}: {what}")));
        }
    }

    fn warning(&mut self, property: impl Fn(&Sphere) -> bool, what: &str) {
        if let Some(who) = self.spheres(property) {
            self.warnings.push(format!("{who}: {what}"));
        }
    }

    fn settings(&mut self, settings: &Settings) {
        if settings.view.projected(Projection::Perspective) != crate::view::View::FILE {
            let what = "a scene is exported with the camera of its file: leave --eye, --look-at and --up out";
            self.obstacles.push(Obstacle::Settings(what.into()));
        }
        if settings.pattern.count() > 1 {
            let what = format!("{} does not place samples as here: export one sample a pixel", self.peer);
            self.obstacles.push(Obstacle::Settings(what));
        }
        let own = quantize(self.peer);
        if settings.quantize != own {
            let (verb, word) = match own {
                Quantize::Truncate => ("truncates", "truncate"),
                Quantize::Round => ("rounds", "round"),
                Quantize::Overscale => ("scales by 255.9 and truncates", "255.9"),
            };
            self.warnings.push(format!("{} {verb} levels: compare with --quantize {word}", self.peer));
        }
    }

    fn both(&mut self, effects: &Effects) {
        self.obstacle(|s| s.kt != 0.0, "refraction (Kt, eta) is not exported");
        self.obstacle(|s| [s.ka, s.kd, s.ks, s.kr].iter().any(|k| *k < 0.0), "a coefficient is negative");
        if effects.set.has(Effect::Specular) {
            self.obstacle(|s| s.ks != 0.0 && s.n == 0.0, "n = 0 shows no highlight where R·V ≤ 0, unlike here");
        }
        let shapes = shape_indices(&self.scene.spheres, true).unwrap_or_default();
        if let Some(twin) = shapes.iter().enumerate().position(|(index, &first)| index != first as usize) {
            let name = self.scene.sphere_names.in_words("sphere", twin);
            self.warnings.push(format!(
                "{name} has the place and size of another one: here the first in the file is seen, {} may choose the other",
                self.peer
            ));
        }
    }

    /// What secondary rays pass over here alone shows where it is large beside a sphere.
    fn epsilon(&mut self, secondary: &Secondary, effects: &Effects) {
        let lights = self.scene.lights.iter().filter(|_| effects.set.has(Effect::Shadows));
        let of_shadows = lights.map(|light| secondary.shadow * light.position.length());
        let of_mirrors = [secondary.reflection].into_iter().filter(|_| effects.set.has(Effect::Reflections));
        let passed = of_shadows.chain(of_mirrors).fold(0.0, f64::max);
        let what =
            format!("shadow and reflection rays pass over what is nearer than {passed:.1e}, but not in {}", self.peer);
        self.warning(|s| s.scale.abs().min_element() < 10.0 * passed, &what);
    }

    fn povray(&mut self, effects: &Effects) {
        if sky(self.scene, effects).is_some_and(|radius| radius > POVRAY_REACH) {
            let what = "BACK with reflections: a sky around all this is beyond 1e7, where POV-Ray sees nothing";
            self.obstacles.push(Obstacle::Scene(what.into()));
        }
        let reach = |s: &Sphere| s.center.length() + s.scale.abs().max_element();
        self.obstacle(|s| reach(s) > POVRAY_REACH, "POV-Ray sees nothing beyond a distance of 1e7");
        let small = |s: &Sphere| s.scale.abs().min_element();
        let far = |s: &Sphere| s.center.length() / small(s);
        self.obstacle(|s| far(s) > 10.0 * POVRAY_DISTANCE, "too many radii from the origin for POV-Ray's tolerances");
        self.warning(
            |s| (POVRAY_DISTANCE..=10.0 * POVRAY_DISTANCE).contains(&far(s)),
            "so many radii from the origin that POV-Ray gets pixels wrong",
        );
        self.obstacle(|s| small(s) < POVRAY_EPSILON, "smaller than POV-Ray's tolerance of 1e-3");
        self.warning(
            |s| (POVRAY_EPSILON..30.0 * POVRAY_EPSILON).contains(&small(s)),
            "not much larger than POV-Ray's tolerance of 1e-3",
        );
    }

    fn tachyon(&mut self, projection: Projection, effects: &Effects) {
        let Scene { window, ambient, background, .. } = *self.scene;
        self.obstacle(|s| s.scale.abs() != DVec3::splat(s.scale.x.abs()), "Tachyon has spheres, but no ellipsoids");
        self.obstacle(
            |s| View::of(&window, projection, s) != View::Whole,
            "not wholly beyond the image plane: Tachyon cannot cut it open for the eye alone",
        );
        if effects.set.has(Effect::Ambient) && ambient != DVec3::splat(ambient.x) {
            self.obstacles.push(Obstacle::Scene("AMBIENT is coloured: Tachyon's ambient light is white".into()));
        }
        if effects.set.has(Effect::Reflections) && background != DVec3::ZERO {
            let what =
                "BACK with reflections: in Tachyon reflection rays that hit nothing show it, here they are black";
            self.obstacles.push(Obstacle::Scene(what.into()));
        }
        if effects.set.has(Effect::Specular) {
            self.warning(|s| s.ks != 0.0 && s.n < 1.0, "n < 1: Tachyon cuts the highlight off where R·V < 0.002");
        }
        self.warning(
            |s| [s.kd, s.ks, s.kr].iter().any(|k| *k > 0.0 && *k <= TACHYON_LEAST),
            "Tachyon ignores Kd, Ks and Kr up to 1/510",
        );
        let radius = |s: &Sphere| s.scale.x.abs();
        self.obstacle(|s| radius(s) < TACHYON_EPSILON, "smaller than Tachyon's tolerance of 5e-5");
        self.warning(
            |s| (TACHYON_EPSILON..100.0 * TACHYON_EPSILON).contains(&radius(s)),
            "not much larger than Tachyon's tolerance of 5e-5",
        );
        let reach = |s: &Sphere| s.center.length() + radius(s);
        self.obstacle(|s| !(reach(s) < f64::from(f32::MAX).sqrt()), "beyond what Tachyon's single precision holds");
        self.warning(
            |s| s.center.length() > TACHYON_DISTANCE * radius(s),
            "so many radii from the origin that Tachyon, which reads single precision, moves it",
        );
    }
}

/// How the renderer turns colours into levels.
fn quantize(peer: Peer) -> Quantize {
    match peer {
        Peer::PovRay => Quantize::Round,
        Peer::Tachyon => Quantize::Truncate,
    }
}
