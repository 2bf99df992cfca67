//! Scenes for other renderers, such that their picture is ours as far as their models allow.
//!
//! What a renderer cannot express is an [`Obstacle`], and nothing is written; what comes out slightly different is a warning.

mod povray;
mod rules;
mod tachyon;

use std::fmt;
use std::str::FromStr;

use crate::effects::Effects;
use crate::scene::Scene;
use crate::settings::Settings;

/// Another renderer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Peer {
    /// POV-Ray 3.7.
    PovRay,
    /// Tachyon 0.99.
    Tachyon,
}

impl Peer {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::PovRay, Self::Tachyon];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::PovRay => "povray",
            Self::Tachyon => "tachyon",
        }
    }
}

impl fmt::Display for Peer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::PovRay => "POV-Ray",
            Self::Tachyon => "Tachyon",
        })
    }
}

impl FromStr for Peer {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let expected = || format!("expected {}", Self::ALL.map(Self::name).join(" or "));
        Self::ALL.into_iter().find(|peer| peer.name() == name).ok_or_else(expected)
    }
}

/// Something in a scene or its settings that a renderer cannot express, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Obstacle {
    /// In the scene.
    Scene(String),
    /// In the settings.
    Settings(String),
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(what) | Self::Settings(what) => f.write_str(what),
        }
    }
}

/// A scene in the language of another renderer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Export {
    /// The file.
    pub text: String,
    /// What comes out slightly different, in words.
    pub warnings: Vec<String>,
}

/// Writes `scene` for `peer`; `effects` is what the scene calls for under `settings`.
///
/// # Errors
/// Everything that the renderer cannot express.
pub fn export(scene: &Scene, settings: &Settings, effects: &Effects, peer: Peer) -> Result<Export, Vec<Obstacle>> {
    let (obstacles, warnings) = rules::judge(scene, settings, effects, peer);
    if !obstacles.is_empty() {
        return Err(obstacles);
    }
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = match peer {
        Peer::PovRay => povray::write(&mut text, scene, settings, effects),
        Peer::Tachyon => tachyon::write(&mut text, scene, settings, effects),
    };
    Ok(Export { text, warnings })
}

/// The window as a renderer needs it that samples pixels at offsets `own` from their left and top, in parts of a pixel, so
/// that its samples lie where the settings want them: left, right, bottom, top, in a perspective picture at distance 1 from the eye.
fn window(scene: &Scene, settings: &Settings, own: (f64, f64)) -> [f64; 4] {
    let window = &scene.window;
    let (sx, sy) = settings.sampling.offset();
    let right = (window.right - window.left) * (sx - own.0) / f64::from(scene.width);
    let down = (window.top - window.bottom) * (sy - own.1) / f64::from(scene.height);
    let distance = if settings.view.is_parallel() { 1.0 } else { window.near };
    [window.left + right, window.right + right, window.bottom - down, window.top - down].map(|x| x / distance)
}
