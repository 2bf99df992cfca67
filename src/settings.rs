//! What decides the picture besides the scene: conventions, depth, samples.

use std::str::FromStr;

use clap::ValueEnum;
use glam::DVec3;
use serde::{Serialize, Serializer};

use crate::pattern::Pattern;
use crate::view::View;

/// Where in its pixel a sample lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum SampleOffset {
    /// The top-left corner, offsets (0, 0): what the official pictures pin.
    Corner,
    /// The bottom-left corner, offsets (0, 1): the second most common course template.
    BottomLeft,
    /// The centre, offsets (½, ½).
    Center,
}

impl SampleOffset {
    /// Offsets (sx, sy) within the pixel, x to the right and y downwards, each in 0..=1.
    pub fn offset(self) -> (f64, f64) {
        match self {
            Self::Corner => (0.0, 0.0),
            Self::BottomLeft => (0.0, 1.0),
            Self::Center => (0.5, 0.5),
        }
    }
}

/// How a colour in 0..=1 becomes an 8-bit level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Quantize {
    /// ⌊255·c⌋.
    Truncate,
    /// ⌊255·c + ½⌋.
    Round,
    /// ⌊255.9·c⌋, as another template of the assignment has it: 255 is not for c = 1 alone.
    #[serde(rename = "255.9")]
    #[value(name = "255.9")]
    Overscale,
}

impl Quantize {
    /// What c is multiplied by.
    pub fn scale(self) -> f64 {
        match self {
            Self::Truncate | Self::Round => 255.0,
            Self::Overscale => 255.9,
        }
    }

    /// What is added to that before the fraction is cut off.
    pub fn bias(self) -> f64 {
        match self {
            Self::Truncate | Self::Overscale => 0.0,
            Self::Round => 0.5,
        }
    }

    /// The 8-bit RGB of an unclamped colour; NaN becomes 0.
    pub fn levels(self, color: DVec3) -> [u8; 3] {
        color.to_array().map(|c| (self.scale() * c.clamp(0.0, 1.0) + self.bias()) as u8)
    }

    /// The same rule with 16 bits: ⌊65535·c⌋, ⌊65535·c + ½⌋ or ⌊65535.9·c⌋.
    pub fn levels16(self, color: DVec3) -> [u16; 3] {
        let scale = self.scale() + (65535.0 - 255.0);
        color.to_array().map(|c| (scale * c.clamp(0.0, 1.0) + self.bias()) as u16)
    }

    /// The level of 8 bits of a colour whose level by this rule is `sample` of 0..=`most`; where both rules begin steps at other
    /// places, that of the middle of its step.
    pub fn narrowed(self, sample: u32, most: u32) -> u8 {
        let scale = self.scale() + (f64::from(most) - 255.0);
        let color = (f64::from(sample) + 0.5 - self.bias()) / scale;
        (self.scale() * color + self.bias()) as u8
    }
}

/// From where on shadow and reflection rays meet a surface. The one that they leave they meet at its analytic roots, 0 and −2B/A.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Secondary {
    /// Part of the way to the light beyond which a blocker counts, in 0..1.
    pub shadow: f64,
    /// Distance beyond which a reflection ray's hit counts, in world units.
    pub reflection: f64,
}

impl Secondary {
    /// The least distances of the official pictures.
    pub const CLASSIC: Self = Self { shadow: 1e-3, reflection: 1e-3 };
    /// Every surface counts from t > 0 on.
    pub const EXACT: Self = Self { shadow: 0.0, reflection: 0.0 };
}

/// The specular term.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Specular {
    /// (R·V)ⁿ with R = 2(N·L)N − L.
    Phong,
    /// (N·H)ⁿ with H = (L + V)/|L + V|.
    Blinn,
}

/// Rendering rules that go together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Convention {
    /// What the assignment's official pictures pin.
    Classic,
    /// What the physics says.
    Exact,
}

impl Convention {
    /// Its settings; depth, samples and view are those of the command line without options.
    pub fn settings(self) -> Settings {
        match self {
            Self::Classic => Settings::classic(),
            Self::Exact => Settings::exact(),
        }
    }
}

impl FromStr for Convention {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        <Self as ValueEnum>::from_str(name, false).map_err(|_| format!("no convention is called '{name}'"))
    }
}

/// Everything besides the scene that a picture depends on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Settings {
    /// Where the eye is and where it looks.
    pub view: View,
    /// Sample position within the pixel.
    pub sampling: SampleOffset,
    /// Rounding of the 8-bit value.
    pub quantize: Quantize,
    /// Least distances of shadow and reflection rays.
    pub secondary: Secondary,
    /// Specular term.
    pub specular: Specular,
    /// Greatest number of reflection bounces, 0 to [`Settings::MAX_DEPTH`].
    pub max_depth: u32,
    /// The samples of each pixel, which is their mean.
    #[serde(flatten, serialize_with = "plain")]
    pub pattern: Pattern,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes it so")]
fn plain<S: Serializer>(pattern: &Pattern, serializer: S) -> Result<S::Ok, S::Error> {
    pattern.plain().serialize(serializer)
}

impl Settings {
    /// The greatest accepted `max_depth`; beyond some tens of bounces nothing is left of a ray's weight or accuracy.
    pub const MAX_DEPTH: u32 = 1000;

    /// The convention that the official pictures pin.
    pub fn classic() -> Self {
        Self {
            view: View::FILE,
            sampling: SampleOffset::Corner,
            quantize: Quantize::Truncate,
            secondary: Secondary::CLASSIC,
            specular: Specular::Phong,
            max_depth: 3,
            pattern: Pattern::ONE,
        }
    }

    /// These settings by the rules of `convention`; depth, samples and view stay.
    #[must_use]
    pub fn with_convention(&self, convention: &Self) -> Self {
        let Self { view, max_depth, pattern, .. } = *self;
        Self { view, max_depth, pattern, ..*convention }
    }

    /// The convention whose rules these are, if there is one.
    pub fn convention(&self) -> Option<Convention> {
        let is_of = |convention: &&Convention| self.with_convention(&convention.settings()) == *self;
        Convention::value_variants().iter().find(is_of).copied()
    }

    /// The convention that the physics asks for.
    pub fn exact() -> Self {
        Self {
            sampling: SampleOffset::Center,
            quantize: Quantize::Round,
            secondary: Secondary::EXACT,
            ..Self::classic()
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::classic()
    }
}
