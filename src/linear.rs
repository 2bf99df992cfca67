//! The colour of a pixel before it becomes levels.

use glam::DVec3;

/// What a pixel shows, as a number: neither clamped nor quantised, the mean over its samples.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Linear {
    /// Red, green and blue, as a kernel of `f32` or `f64` has them.
    pub color: DVec3,
    /// The part of the samples whose primary rays hit a sphere, 0 to 1; glass counts like any other sphere.
    pub coverage: f64,
}

impl Linear {
    /// The colour without the part that the background has in it where a primary ray hits nothing.
    pub fn premultiplied(&self, background: DVec3) -> DVec3 {
        if self.coverage == 0.0 { DVec3::ZERO } else { self.color - background * (1.0 - self.coverage) }
    }

    /// The colour of what covers the pixel; 0 where nothing does.
    pub fn straight(&self, background: DVec3) -> DVec3 {
        if self.coverage == 0.0 { DVec3::ZERO } else { self.premultiplied(background) / self.coverage }
    }
}
