//! Scenes for Tachyon 0.99.
//!
//! Its space is left-handed, so z changes its sign. Its AMBIENT and DIFFUSE are Ka·Ia and Kd, its SPECULAR is our Kr and its
//! PHONG our Ks.

use std::fmt::{self, Write as _};

use glam::DVec3;

use super::window;
use crate::effects::{Effect, Effects};
use crate::scene::{Light, Scene, Sphere};
use crate::settings::{Settings, Specular};
use crate::view::Projection;

/// Where in its pixel Tachyon samples: in the top right corner.
const SAMPLE: (f64, f64) = (1.0, 0.0);

/// `x y z`, mirrored into the left-handed space.
struct Mirrored(DVec3);

impl fmt::Display for Mirrored {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DVec3 { x, y, z } = self.0;
        write!(f, "{x:?} {y:?} {:?}", -z)
    }
}

struct Color(DVec3);

impl fmt::Display for Color {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DVec3 { x, y, z } = self.0;
        write!(f, "{x:?} {y:?} {z:?}")
    }
}

pub(super) fn write(text: &mut String, scene: &Scene, settings: &Settings, effects: &Effects) -> fmt::Result {
    let Scene { width, height, background, ambient, .. } = scene;
    let [left, right, bottom, top] = window(scene, settings, SAMPLE);
    let has = |effect| effects.set.has(effect);
    let highlights = match settings.specular {
        Specular::Phong => "-shade_phong",
        Specular::Blinn => "-shade_blinn",
    };
    writeln!(text, "BEGIN_SCENE\nRESOLUTION {width} {height}")?;
    writeln!(text, "# tachyon SCENE.dat {highlights} -format PPM -o PICTURE.ppm")?;
    let projection = match settings.view.projection() {
        Projection::Perspective => "PERSPECTIVE",
        Projection::Orthographic => "ORTHOGRAPHIC",
    };
    writeln!(
        text,
        "CAMERA\n  PROJECTION {projection}\n  ZOOM 1\n  ASPECTRATIO 1\n  ANTIALIASING 0\n  RAYDEPTH {}",
        effects.depth + 1
    )?;
    writeln!(text, "  CENTER 0 0 0\n  VIEWDIR 0 0 1\n  UPDIR 0 1 0")?;
    writeln!(text, "  FRUSTUM {left:?} {right:?} {bottom:?} {top:?}\nEND_CAMERA")?;
    writeln!(text, "BACKGROUND {}", Color(*background))?;
    for Light { position, intensity } in scene.lights.iter().filter(|light| light.intensity != DVec3::ZERO) {
        writeln!(text, "LIGHT CENTER {} RAD 0 COLOR {}", Mirrored(*position), Color(*intensity))?;
    }
    // Of two surfaces at one distance it shows the one that comes last in its file, here that is the first.
    for Sphere { center, scale, color, ka, kd, ks, kr, n, .. } in scene.spheres.iter().rev() {
        let on = |effect, value: f64| if has(effect) { value } else { 0.0 };
        let ambient = on(Effect::Ambient, ka * ambient.x);
        let (diffuse, phong) = (on(Effect::Diffuse, *kd), on(Effect::Specular, *ks));
        let mirror = on(Effect::Reflections, *kr);
        writeln!(text, "SPHERE CENTER {} RAD {:?}", Mirrored(*center), scale.x.abs())?;
        writeln!(
            text,
            "  TEXTURE AMBIENT {ambient:?} DIFFUSE {diffuse:?} SPECULAR {mirror:?} OPACITY 1 PHONG PLASTIC {phong:?} PHONG_SIZE {n:?} COLOR {} TEXFUNC 0",
            Color(*color)
        )?;
    }
    writeln!(text, "END_SCENE")
}
