//! How densely a picture is sampled, and where: a pure function of the place.

use serde::Serialize;

use super::order::{is_sampled, rank};

/// Where a viewer looks: all pixels are sampled there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fovea {
    /// Its centre, in pixels from the left and from the top edge.
    pub center: [f64; 2],
    /// Within so many pixels of the centre every pixel is sampled.
    pub radius: f64,
    /// So many pixels beyond the radius, a quarter of them is.
    pub falloff: f64,
}

/// The part of the pixels that is sampled at each place of a picture.
///
/// At the distance d from the centre of the fovea, beyond its radius r, it is 1/(1 + (d − r)/f)² with the falloff f, as the
/// acuity of the eye falls with the angle (B. Guenter and others, "Foveated 3D Graphics", 2012), but never less than `far`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Density {
    /// Where all pixels are sampled; nowhere in particular where there is none.
    pub fovea: Option<Fovea>,
    /// The part that is sampled far from the fovea, in 0..=1.
    pub far: f64,
}

impl Density {
    /// Every pixel.
    pub const FULL: Self = Self { fovea: None, far: 1.0 };

    /// The same part everywhere.
    pub fn sparse(far: f64) -> Self {
        Self { fovea: None, far }
    }

    /// The density at a place in pixels.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let Some(Fovea { center, radius, falloff }) = self.fovea else { return self.far };
        let (dx, dy) = (x - center[0], y - center[1]);
        // Products and roots of IEEE 754 alone, so that every machine takes the same pixels.
        let beyond = (dx * dx + dy * dy).sqrt() - radius;
        if beyond <= 0.0 {
            return 1.0;
        }
        let slope = 1.0 + beyond / falloff;
        (1.0 / (slope * slope)).max(self.far)
    }

    /// Whether the pixel in column `x` and row `y` is sampled.
    pub fn takes(&self, x: u32, y: u32) -> bool {
        let rank = rank(x, y);
        is_sampled(rank, self.far)
            || (self.fovea.is_some() && is_sampled(rank, self.at(f64::from(x) + 0.5, f64::from(y) + 0.5)))
    }

    /// Whether a pixel lies in the part of the picture that is sampled in full.
    pub fn is_inside(&self, x: u32, y: u32) -> bool {
        self.at(f64::from(x) + 0.5, f64::from(y) + 0.5) >= 1.0
    }

    /// About how many pixels of a picture of this size are sampled.
    pub fn forecast(&self, (width, height): (u32, u32)) -> f64 {
        const PLACES: u32 = 48;
        let place = |index: u32, side: u32| (f64::from(index) + 0.5) / f64::from(PLACES) * f64::from(side);
        let mut sum = 0.0;
        for index in 0..PLACES * PLACES {
            sum += self.at(place(index % PLACES, width), place(index / PLACES, height));
        }
        sum * f64::from(width) * f64::from(height) / f64::from(PLACES * PLACES)
    }
}
