//! The options of foveated and sparse sampling.

use super::failure::{Failure, USAGE};
use crate::sampling::{Density, Fill, Fovea, Samples};

/// Which pixels are sampled; the others are filled.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Sampling")]
pub(super) struct SamplingOptions {
    /// Sample all pixels around this place and ever fewer away from it: `center`, or X,Y from the top left in parts of the
    /// picture (0.5,0.5) or in pixels (320px,240px)
    #[arg(long, value_name = "center|X,Y", allow_hyphen_values = true, value_parser = picture_point, group = "partial")]
    foveate: Option<PicturePoint>,
    /// How far all pixels are sampled, in parts of the picture's shorter side
    #[arg(long, value_name = "R", default_value_t = 0.15, value_parser = radius, requires = "foveate", conflicts_with = "sparse")]
    fovea_radius: f64,
    /// How far beyond `--fovea-radius` a quarter of the pixels is sampled, in parts of the picture's shorter side
    #[arg(long, value_name = "F", default_value_t = 0.15, value_parser = falloff, requires = "foveate", conflicts_with = "sparse")]
    falloff: f64,
    /// The part of the pixels that is sampled far away from the place, above 0
    #[arg(long, value_name = "D", default_value_t = 0.0625, value_parser = density, requires = "foveate", conflicts_with = "sparse")]
    density: f64,
    /// Sample this part of the pixels, evenly, above 0
    #[arg(long, value_name = "D", value_parser = density, group = "partial")]
    sparse: Option<f64>,
    /// How the others are filled
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Fill::Nearest, requires = "partial")]
    fill: Fill,
}

/// What is sampled of a picture, and how the rest is filled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Choice {
    pub(super) density: Density,
    pub(super) fill: Fill,
}

impl SamplingOptions {
    /// Whether a part of the pixels is asked for.
    pub(super) fn is_given(&self) -> bool {
        self.foveate.is_some() || self.sparse.is_some()
    }

    /// What is asked for of a picture of this size; none where all pixels are sampled.
    pub(super) fn choice(&self, size: (u32, u32)) -> Result<Option<Choice>, Failure> {
        let sides = [f64::from(size.0), f64::from(size.1)];
        let density = match (&self.foveate, self.sparse) {
            (None, None) => return Ok(None),
            (None, Some(part)) => Density::sparse(part),
            (Some(PicturePoint(coordinates)), _) => {
                let center = [0, 1].map(|axis| coordinates[axis].in_pixels(sides[axis]));
                let unit = sides[0].min(sides[1]);
                let fovea = Fovea { center, radius: self.fovea_radius * unit, falloff: self.falloff * unit };
                Density { fovea: Some(fovea), far: self.density }
            }
        };
        if let Some(why) = Samples::obstacle(size) {
            return Err(Failure::new(USAGE, why));
        }
        Ok(Some(Choice { density, fill: self.fill }))
    }
}

impl Choice {
    /// What `--explain` says of it.
    pub(super) fn explanation(&self) -> String {
        let percent = |part: f64| format!("{} %", (part * 1e4).round() / 100.0);
        let far = percent(self.density.far);
        let what = match self.density.fovea {
            None => format!("sparse: {far} of the pixels, evenly"),
            Some(Fovea { center: [x, y], radius, falloff }) => format!(
                "foveated: all pixels within {radius:.0} of ({x:.0}, {y:.0}), a quarter of them {falloff:.0} farther out, {far} far \
                 away"
            ),
        };
        format!("  sampling     {what}; the others by {}\n", self.fill_in_words())
    }

    fn fill_in_words(&self) -> &'static str {
        match self.fill {
            Fill::Nearest => "their nearest sample",
            Fill::Smooth => "a mean of samples around",
        }
    }
}

/// A coordinate, from the left or from the top.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Coordinate {
    Part(f64),
    Pixels(f64),
}

impl Coordinate {
    fn in_pixels(self, side: f64) -> f64 {
        match self {
            Self::Part(part) => part * side,
            Self::Pixels(pixels) => pixels,
        }
    }
}

/// A place on the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PicturePoint([Coordinate; 2]);

fn picture_point(text: &str) -> Result<PicturePoint, String> {
    if text == "center" {
        return Ok(PicturePoint([Coordinate::Part(0.5); 2]));
    }
    let coordinate = |text: &str| {
        let text = text.trim();
        match text.strip_suffix("px") {
            Some(pixels) => pixels.parse().ok().filter(|x| (0.0..=16_777_216.0).contains(x)).map(Coordinate::Pixels),
            None => text.parse().ok().filter(|x| (0.0..=1.0).contains(x)).map(Coordinate::Part),
        }
    };
    text.split_once(',').and_then(|(x, y)| Some(PicturePoint([coordinate(x)?, coordinate(y)?]))).ok_or_else(|| {
        "expected center, or X,Y in parts of the picture from 0 to 1, or in pixels such as 320px,240px".into()
    })
}

fn number(text: &str, accepted: impl Fn(f64) -> bool, expected: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x| accepted(*x)).ok_or_else(|| format!("expected {expected}"))
}

fn radius(text: &str) -> Result<f64, String> {
    number(text, |x| (0.0..=100.0).contains(&x), "a number from 0 to 100")
}

fn falloff(text: &str) -> Result<f64, String> {
    number(text, |x| x > 0.0 && x <= 100.0, "a number above 0, up to 100")
}

fn density(text: &str) -> Result<f64, String> {
    number(text, |x| x > 0.0 && x <= 1.0, "a number above 0, up to 1")
}
