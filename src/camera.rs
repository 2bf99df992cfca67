//! The eye at the origin and its window: the one place that turns a pixel into a ray, for CPU and GPU alike.

use crate::scene::{Scene, Window};
use crate::settings::Sampling;

/// A primary ray counts hits beyond this τ: what lies before the image plane, or just touches it, is cut away.
pub const NEAR_T_MIN: f64 = 1.0 + 1e-6;

/// Positions of all sample columns and rows on the image plane. The ray of pixel (i, j) is τ·(`x(i)`, `y(j)`, −`near`),
/// not normalised: τ = 1 lies on the image plane.
#[derive(Debug, Clone, Copy)]
pub struct Camera {
    window: Window,
    width: u32,
    height: u32,
    offset: (f64, f64),
}

impl Camera {
    /// The camera of `scene` with its samples placed by `sampling`.
    pub fn new(scene: &Scene, sampling: Sampling) -> Self {
        Self { window: scene.window, width: scene.width, height: scene.height, offset: sampling.offset() }
    }

    /// x on the image plane of the sample in column `i` (0 = left).
    pub fn x(&self, i: u32) -> f64 {
        self.x_at(f64::from(i) + self.offset.0)
    }

    /// y on the image plane of the sample in row `j` (0 = top).
    pub fn y(&self, j: u32) -> f64 {
        self.y_at(f64::from(j) + self.offset.1)
    }

    /// x on the image plane at `i` pixel widths from the left edge.
    pub fn x_at(&self, i: f64) -> f64 {
        self.window.left + (self.window.right - self.window.left) * i / f64::from(self.width)
    }

    /// y on the image plane at `j` pixel heights from the top edge.
    pub fn y_at(&self, j: f64) -> f64 {
        self.window.top - (self.window.top - self.window.bottom) * j / f64::from(self.height)
    }

    /// Column coordinate (in pixel widths from the left edge) of `x` on the image plane: the inverse of [`Camera::x_at`].
    pub fn column_of(&self, x: f64) -> f64 {
        (x - self.window.left) / (self.window.right - self.window.left) * f64::from(self.width)
    }

    /// Row coordinate (in pixel heights from the top edge) of `y` on the image plane: the inverse of [`Camera::y_at`].
    pub fn row_of(&self, y: f64) -> f64 {
        (self.window.top - y) / (self.window.top - self.window.bottom) * f64::from(self.height)
    }

    /// Distance of the image plane.
    pub fn near(&self) -> f64 {
        self.window.near
    }

    /// Picture width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Picture height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }
}
