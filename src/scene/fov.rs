//! The window that a field of view stands for.

use std::str::FromStr;

use super::check::Invalid;
use super::model::{Scene, Window};

/// A vertical field of view: the angle at the eye between the top and the bottom edge of the picture, above 0 and below 180 degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fov(f64);

impl Fov {
    /// That of so many degrees; `None` where they are not above 0 and below 180.
    pub fn from_degrees(degrees: f64) -> Option<Self> {
        (degrees > 0.0 && degrees < 180.0).then_some(Self(degrees))
    }

    /// In degrees.
    pub fn degrees(self) -> f64 {
        self.0
    }

    /// The window at `near` of a picture of so many columns and rows: symmetric, with square pixels. TOP is NEAR · tan(angle / 2), RIGHT
    /// is TOP · columns / rows.
    pub fn window(self, near: f64, (width, height): (u32, u32)) -> Window {
        let (sine, cosine) = self.0.to_radians().sin_cos();
        // The tangent of half the angle; so it is exactly 1 at 90 degrees, and nothing cancels.
        let half = if cosine >= 0.0 { sine / (1.0 + cosine) } else { (1.0 - cosine) / sine };
        let top = near * half;
        let right = top * (f64::from(width) / f64::from(height));
        Window { near, left: -right, right, bottom: -top, top }
    }
}

impl FromStr for Fov {
    type Err = &'static str;

    fn from_str(degrees: &str) -> Result<Self, Self::Err> {
        degrees
            .trim()
            .parse()
            .ok()
            .and_then(Self::from_degrees)
            .ok_or("expected an angle above 0 and below 180 degrees")
    }
}

impl Scene {
    /// Looks through the window of `fov` at NEAR, for a picture of the size that the scene has now.
    ///
    /// # Errors
    ///
    /// Where `f64` does not hold the window, whose NEAR is extreme or whose angle is; the scene keeps its own then.
    pub fn set_fov(&mut self, fov: Fov) -> Result<(), Invalid> {
        let window = fov.window(self.window.near, (self.width, self.height));
        let own = std::mem::replace(&mut self.window, window);
        self.check_window().inspect_err(|_| self.window = own)
    }
}
