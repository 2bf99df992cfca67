//! Arbitrary output variables: what the tracer has calculated on the way to each pixel, as layers of numbers.
//!
//! All are from the CPU reference, by the witness that also tells of single pixels; some a device tells, too, by the shaders that
//! render.

mod device;
mod layers;
mod scale;

use std::fmt;

use clap::ValueEnum;

pub use device::DeviceLayers;
pub use layers::{Layer, MAX_BOUNCES, MAX_PIXELS, TooMany, layers, names};

/// What a layer shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub enum Aov {
    /// The unclamped colour
    Color,
    /// Parameter of the ray from the eye where it hits; 1 is the image plane
    T,
    /// Index of the sphere that it hits
    Sphere,
    /// Whether that is seen from inside
    Inside,
    /// Where it hits
    Position,
    /// The unit normal there
    Normal,
    /// N·L there, a layer a light
    NDotL,
    /// Whether a sphere blocks the light there, a layer a light
    Shadow,
    /// The background, where nothing is hit
    Background,
    /// The ambient term there
    Ambient,
    /// The diffuse term there, a layer a light
    Diffuse,
    /// The specular term there, a layer a light
    Specular,
    /// What each reflected or refracted ray adds to the colour, a layer a ray
    Bounce,
    /// Number of rays, those towards lights included
    Rays,
    /// Number of tests of a ray with a sphere
    Tests,
    /// How far the nearest decision is from being taken otherwise, but for quantisation
    Margin,
    /// How far the colour is from the next quantisation step, in levels
    Step,
    /// Levels of the device's picture less the reference's
    Error,
}

impl Aov {
    /// The name on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
    }

    /// What its layer has one for each of, beside the pixels.
    fn per_light(self) -> bool {
        matches!(self, Self::NDotL | Self::Shadow | Self::Diffuse | Self::Specular)
    }

    /// Whether a kernel tells it, of pixels with so many samples: means and sums of all, and of an only one the rest. Where no term needs
    /// lights, the reference looks at none, and its cosines and shadows are 0.
    fn is_told(self, samples: u32, is_lit: bool) -> bool {
        match self {
            Self::Color
            | Self::Background
            | Self::Ambient
            | Self::Diffuse
            | Self::Specular
            | Self::Rays
            | Self::Tests => true,
            Self::T | Self::Sphere | Self::Inside | Self::Position | Self::Normal | Self::Bounce => samples == 1,
            Self::NDotL | Self::Shadow => samples == 1 && is_lit,
            Self::Margin | Self::Step | Self::Error => false,
        }
    }

    /// How its numbers are called in files of named channels, after the layer's name.
    fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Color
            | Self::Background
            | Self::Ambient
            | Self::Diffuse
            | Self::Specular
            | Self::Bounce
            | Self::Error => &["R", "G", "B"],
            Self::Position | Self::Normal => &["X", "Y", "Z"],
            Self::T
            | Self::Sphere
            | Self::Inside
            | Self::NDotL
            | Self::Shadow
            | Self::Rays
            | Self::Tests
            | Self::Margin
            | Self::Step => &[""],
        }
    }
}

impl fmt::Display for Aov {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.name())
    }
}
