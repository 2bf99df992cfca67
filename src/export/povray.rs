//! Scenes for POV-Ray 3.7.
//!
//! Its model is ours except for a few defaults: gamma, the pruning of faint rays, highlights. It has no image plane that cuts
//! spheres open, but objects that only some rays see: a cut sphere becomes a clipped one for the eye and a whole one for all
//! other rays. In the same way BACK becomes a sky for the eye alone where reflection rays that hit nothing must be black.

use std::fmt::{self, Write as _};

use glam::DVec3;

use super::rules::View;
use super::window;
use crate::effects::{Effect, Effects};
use crate::scene::{Light, Scene, Sphere};
use crate::settings::{Settings, Specular};
use crate::view::Projection;

/// Where in its pixel POV-Ray samples.
const SAMPLE: (f64, f64) = (0.5, 0.5);

/// `x, y, z` in angle brackets.
struct Triple(DVec3);

impl fmt::Display for Triple {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DVec3 { x, y, z } = self.0;
        write!(f, "<{x:?}, {y:?}, {z:?}>")
    }
}

pub(super) fn write(text: &mut String, scene: &Scene, settings: &Settings, effects: &Effects) -> fmt::Result {
    let Scene { width, height, background, ambient, .. } = scene;
    let [left, right, bottom, top] = window(scene, settings, SAMPLE);
    let middle = DVec3::new(f64::midpoint(left, right), f64::midpoint(bottom, top), 0.0);
    let (kind, location, direction) = match settings.view.projection() {
        Projection::Perspective => ("perspective", DVec3::ZERO, middle - DVec3::Z),
        Projection::Orthographic => ("orthographic", middle, DVec3::NEG_Z),
    };
    writeln!(text, "// povray +ISCENE.pov +OPICTURE.ppm +FP File_Gamma=1 +W{width} +H{height} -A -D")?;
    writeln!(text, "#version 3.7;")?;
    let levels = levels(effects);
    writeln!(text, "global_settings {{ assumed_gamma 1 adc_bailout 0 max_trace_level {levels} }}")?;
    writeln!(text, "camera {{ {kind} location {} direction {}", Triple(location), Triple(direction))?;
    writeln!(text, "  right <{:?}, 0, 0> up <0, {:?}, 0> }}", right - left, top - bottom)?;
    if let Some(radius) = sky(scene, effects) {
        writeln!(text, "background {{ rgb 0 }}")?;
        writeln!(
            text,
            "sphere {{ <0, 0, 0>, {:?} pigment {{ rgb {} }} finish {{ ambient 1 diffuse 0 }} hollow no_shadow no_reflection }}",
            radius,
            Triple(*background)
        )?;
    } else {
        writeln!(text, "background {{ rgb {} }}", Triple(*background))?;
    }
    for Light { position, intensity } in scene.lights.iter().filter(|light| light.intensity != DVec3::ZERO) {
        writeln!(text, "light_source {{ {}, rgb {} }}", Triple(*position), Triple(*intensity))?;
    }
    for sphere in &scene.spheres {
        let body = SphereText { sphere, ambient: *ambient, settings, effects };
        match View::of(&scene.window, settings.view.projection(), sphere) {
            View::Whole => writeln!(text, "{body} }}")?,
            View::Hidden => writeln!(text, "{body} hollow no_image }}")?,
            View::Cut => {
                let near = -scene.window.near;
                writeln!(text, "{body} hollow clipped_by {{ plane {{ z, {near:?} }} }} no_shadow no_reflection }}")?;
                writeln!(text, "{body} hollow no_image }}")?;
            }
        }
    }
    Ok(())
}

/// Rays from the eye count as the first level.
fn levels(effects: &Effects) -> u32 {
    (effects.depth + 1).min(256)
}

/// The radius of a sky for the eye alone, where there is to be one: beyond everything, the window among it, where rays may begin.
pub(super) fn sky(scene: &Scene, effects: &Effects) -> Option<f64> {
    let reach = |s: &Sphere| s.center.length() + s.scale.abs().max_element();
    let is_needed = effects.set.has(Effect::Reflections) && scene.background != DVec3::ZERO;
    is_needed.then(|| scene.spheres.iter().map(reach).fold(2.0 * scene.window.greatest(), f64::max) * 1.01)
}

/// A sphere up to its closing brace.
struct SphereText<'a> {
    sphere: &'a Sphere,
    ambient: DVec3,
    settings: &'a Settings,
    effects: &'a Effects,
}

impl fmt::Display for SphereText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Sphere { center, scale, color, ka, kd, ks, kr, n, .. } = *self.sphere;
        let has = |effect| self.effects.set.has(effect);
        let scale = scale.abs();
        if scale == DVec3::splat(scale.x) {
            write!(f, "sphere {{ {}, {:?}", Triple(center), scale.x)?;
        } else {
            write!(f, "sphere {{ <0, 0, 0>, 1 scale {} translate {}", Triple(scale), Triple(center))?;
        }
        let ambient = if has(Effect::Ambient) { self.ambient * ka } else { DVec3::ZERO };
        let diffuse = if has(Effect::Diffuse) { kd } else { 0.0 };
        write!(f, " pigment {{ rgb {} }} finish {{ ambient rgb {}", Triple(color), Triple(ambient))?;
        write!(f, " diffuse {diffuse:?}")?;
        if has(Effect::Specular) && ks != 0.0 {
            match self.settings.specular {
                Specular::Phong => write!(f, " phong {ks:?} phong_size {n:?}")?,
                Specular::Blinn => write!(f, " specular {ks:?} roughness {:?}", 1.0 / n)?,
            }
        }
        if has(Effect::Reflections) && kr != 0.0 {
            write!(f, " reflection {kr:?}")?;
        }
        write!(f, " }}")
    }
}
