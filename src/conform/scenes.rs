//! The scenes that the program brings along: effects, hard cases, glass, odd windows and sizes.

use crate::scene::{Scene, parse};

/// A scene of the folder `scenes`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuiltIn {
    /// Folder and name, as `hard/contact`.
    pub name: &'static str,
    /// The scene file.
    pub text: &'static str,
}

macro_rules! scenes {
    ($($name:literal)*) => {
        &[$(BuiltIn { name: $name, text: include_str!(concat!("../../scenes/", $name, ".txt")) },)*]
    };
}

/// All of them, in the order in which they are rendered.
pub static SCENES: &[BuiltIn] = scenes! {
    "basic/mirrored-window" "basic/odd-size" "basic/one-row" "basic/overlap" "basic/seventeen-lights"
    "basic/seventeen-spheres" "basic/window-corner"
    "effects/ambient" "effects/blocker-beyond-light" "effects/coloured-shadows" "effects/diffuse" "effects/ellipsoids"
    "effects/everything" "effects/exponent-half" "effects/light-in-sphere" "effects/mirrors-over-one"
    "effects/reflections" "effects/refraction" "effects/same-place" "effects/shadows" "effects/shell-eye-inside"
    "effects/shells" "effects/specular" "effects/three-mirrors"
    "hard/concentric-shells" "hard/contact" "hard/discs" "hard/earth-at-one-metre" "hard/exponents"
    "hard/light-at-surface" "hard/mirror-corridor" "hard/near-plane-tangent" "hard/needles" "hard/pin-head"
    "hard/sharp-highlights" "hard/tangent-rays" "hard/tiny-blockers" "hard/translated" "hard/world-1e-30"
    "hard/world-1e20"
    "refraction/bubbles" "refraction/ellipsoids" "refraction/eye-inside" "refraction/glass-in-glass"
    "refraction/grazing" "refraction/image-plane" "refraction/total-reflection" "refraction/touching"
};

impl BuiltIn {
    /// The scene of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SCENES.iter().find(|scene| scene.name == name)
    }

    /// The scene; `None` where its file has errors, which a test excludes.
    pub fn scene(&self) -> Option<Scene> {
        parse(self.name, self.text.as_bytes()).scene
    }
}
