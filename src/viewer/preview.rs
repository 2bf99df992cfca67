//! How the picture is sampled while the eye moves.

use serde::{Deserialize, Serialize};

use super::requests::PageRequest;
use crate::sampling::{Density, Fovea};

/// What a moving picture has fewer of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PreviewMode {
    /// Samples away from where one looks.
    Foveated,
    /// Samples everywhere.
    Sparse,
    /// Pixels.
    Coarse,
}

/// How the moving pictures of a page are sampled; pictures at rest do not depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PreviewOptions {
    /// What a moving picture has fewer of.
    pub mode: PreviewMode,
    /// The least part of the pixels that is sampled.
    pub least: f64,
    /// Radius and falloff of the fovea, in parts of the picture's shorter side.
    pub fovea: [f64; 2],
    /// Where one looks, in parts of the picture from its top left.
    pub gaze: [f64; 2],
}

impl PreviewOptions {
    /// The least densities that a page can ask for; below, nearest samples would be too far away for two bytes.
    pub const DENSITIES: [f64; 2] = [1.0 / 64.0, 1.0];

    /// Does what the page asks; a message says why it cannot be.
    pub(super) fn apply(&mut self, request: &PageRequest) -> Result<(), String> {
        match request {
            PageRequest::Gaze { x, y } => self.gaze = [x, y].map(|part| part.clamp(0.0, 1.0)),
            PageRequest::Preview { mode, least, radius, falloff } => {
                let mut preview = *self;
                preview.mode = mode.unwrap_or(preview.mode);
                if let Some(least) = *least {
                    let [low, high] = Self::DENSITIES;
                    if !(low..=high).contains(&least) {
                        return Err(format!("the least density is from {low} to {high}"));
                    }
                    preview.least = least;
                }
                if let Some(radius) = *radius {
                    if !(0.0..=1.0).contains(&radius) {
                        return Err("the radius of the fovea is from 0 to 1".into());
                    }
                    preview.fovea[0] = radius;
                }
                if let Some(falloff) = *falloff {
                    if !(0.01..=10.0).contains(&falloff) {
                        return Err("the falloff is from 0.01 to 10".into());
                    }
                    preview.fovea[1] = falloff;
                }
                *self = preview;
            }
            _ => {}
        }
        Ok(())
    }

    /// Number of ever cheaper densities.
    pub(super) fn levels(&self) -> usize {
        match self.mode {
            PreviewMode::Foveated | PreviewMode::Sparse => 5,
            PreviewMode::Coarse => 0,
        }
    }

    /// The density at a level, 0 being the densest.
    pub(super) fn density(&self, level: usize, size: (u32, u32)) -> Density {
        // From half of the pixels, or less, to the least in equal ratios.
        let ratio = level.min(4) as f64 / 4.0;
        let part = self.least.max(0.5).powf(1.0 - ratio) * self.least.powf(ratio);
        if self.mode != PreviewMode::Foveated {
            return Density::sparse(part);
        }
        let unit = f64::from(size.0.min(size.1));
        // The fovea shrinks as well.
        let scale = [1.0, 1.0, 0.8, 0.5, 0.25][level.min(4)];
        let [radius, falloff] = self.fovea.map(|part| part * unit * scale);
        let center = [self.gaze[0] * f64::from(size.0), self.gaze[1] * f64::from(size.1)].map(f64::round);
        Density { fovea: Some(Fovea { center, radius, falloff }), far: part }
    }
}

impl Default for PreviewOptions {
    fn default() -> Self {
        Self { mode: PreviewMode::Foveated, least: 1.0 / 64.0, fovea: [0.15, 0.15], gaze: [0.5, 0.5] }
    }
}
