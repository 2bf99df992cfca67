//! How particles become spheres.

use std::str::FromStr;

use glam::DVec3;

use super::color::hex_of;
use super::columns::LEVELS;
use crate::view::{View, ViewError};

pub use super::frames::Frames;
pub use super::map::Map;

/// What decides how particles are shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Which frames of the file; without an answer the first.
    pub frames: Frames,
    /// Where radii come from.
    pub radius: Radius,
    /// What all radii are multiplied by, > 0.
    pub radius_scale: f64,
    /// Where colours come from.
    pub coloring: Coloring,
    /// The direction of view in the file's coordinates.
    pub direction: DVec3,
    /// What is upwards in the picture as far as the view allows; without an answer y, or z where the view is along y.
    pub vertical: Option<DVec3>,
    /// The lights.
    pub lighting: Lighting,
    /// The scene's background, each part 0 to 1.
    pub background: DVec3,
    /// The picture's width and height in pixels.
    pub size: (u32, u32),
    /// What fills the picture.
    pub framing: Framing,
    /// The eye for which the lights are set, in the scene's coordinates.
    pub view: View,
}

impl Options {
    /// The picture's axes in the file: to the right, upwards, against the direction of view.
    ///
    /// # Errors
    ///
    /// Where the directions make no view, as parallel ones do.
    pub fn axes(&self) -> Result<[DVec3; 3], ViewError> {
        let along = |up| View::new(DVec3::ZERO, Some(self.direction), up).map(|view| view.axes());
        match self.vertical {
            Some(vertical) => along(vertical),
            None => along(DVec3::Y).or_else(|_| along(DVec3::Z)),
        }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            frames: Frames::default(),
            radius: Radius::Auto,
            radius_scale: 1.0,
            coloring: Coloring::Auto,
            direction: DVec3::NEG_Z,
            vertical: None,
            lighting: Lighting::default(),
            background: DVec3::ONE,
            size: (1024, 768),
            framing: Framing::default(),
            view: View::FILE,
        }
    }
}

/// Where radii come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Radius {
    /// The file's own column, else the elements' van der Waals radii, else half the mean distance of particles.
    Auto,
    /// One for all, > 0.
    Fixed(f64),
    /// Van der Waals radii; what is no element gets half the mean distance of particles.
    VanDerWaals,
    /// Covalent radii, likewise.
    Covalent,
    /// A column of the file.
    Column(String),
}

impl FromStr for Radius {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse::<f64>()) {
            (_, Ok(radius)) if (1e-100..=1e100).contains(&radius) => Ok(Self::Fixed(radius)),
            ("", _) | (_, Ok(_)) => {
                Err("expected a number greater than 0, element, covalent or the name of a column".into())
            }
            ("element", _) => Ok(Self::VanDerWaals),
            ("covalent", _) => Ok(Self::Covalent),
            _ => Ok(Self::Column(text.into())),
        }
    }
}

/// Where colours come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Coloring {
    /// The file's own colours, else the elements', else a colour for each type, else one for all.
    Auto,
    /// One for all.
    Fixed(DVec3),
    /// The elements'.
    Element,
    /// Those of a column's values.
    Column(ByColumn),
}

/// Colours by a column.
#[derive(Debug, Clone, PartialEq)]
pub struct ByColumn {
    /// Its name.
    pub name: String,
    /// The colours; without an answer viridis for numbers, categories for words.
    pub map: Option<Map>,
    /// The values at the ends of the map; without an answer the least and the greatest.
    pub range: Option<(f64, f64)>,
}

impl FromStr for Coloring {
    type Err = String;

    /// `element`, `R,G,B`, `#rrggbb`, or `COLUMN[:MAP][:LO..HI]`.
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "element" {
            return Ok(Self::Element);
        }
        match color(text) {
            Ok(color) => return Ok(Self::Fixed(color)),
            Err(why) if parts(text).is_some_and(|parts| parts.len() == 3) => return Err(why),
            Err(_) => {}
        }
        let (rest, range) = match text.rsplit_once(':') {
            Some((rest, last)) if last.contains("..") => (rest, Some(range(last)?)),
            _ => (text, None),
        };
        let (name, map) = match rest.rsplit_once(':').map(|(name, map)| (name, map.parse())) {
            Some((name, Ok(map))) => (name, Some(map)),
            _ => (rest, None),
        };
        if name.is_empty() {
            return Err("expected element, R,G,B or COLUMN:MAP".into());
        }
        if map == Some(Map::Categories) && range.is_some() {
            return Err("categories have no range".into());
        }
        Ok(Self::Column(ByColumn { name: name.into(), map, range }))
    }
}

fn range(text: &str) -> Result<(f64, f64), String> {
    let ends = text.split_once("..").and_then(|(low, high)| Some((low.parse().ok()?, high.parse().ok()?)));
    let (low, high) = ends
        .filter(|(low, high): &(f64, f64)| low.is_finite() && high.is_finite() && low != high)
        .ok_or_else(|| format!("expected a range of two different numbers such as 0..1, not {text}"))?;
    if (high - low).is_finite() {
        Ok((low, high))
    } else {
        Err(format!("expected a range that is no wider than {:e}, not {text}", f64::MAX))
    }
}

/// A colour as `R,G,B`, each part 0 to 1, or as `#rrggbb`.
///
/// # Errors
///
/// What was expected.
pub fn color(text: &str) -> Result<DVec3, String> {
    match parts(text).as_deref() {
        Some(&[r, g, b]) if [r, g, b].iter().all(|part| (0.0..=1.0).contains(part)) => Ok(DVec3::new(r, g, b)),
        Some(&[r, g, b]) if [r, g, b].iter().all(|part| (0.0..=LEVELS).contains(part)) => {
            let [r, g, b] = [r, g, b].map(|level| level.round() as u8);
            Err(format!("the parts of a colour are 0 to 1; this may be meant: #{r:02x}{g:02x}{b:02x}"))
        }
        _ => hex_of(text.as_bytes()).ok_or_else(|| "expected a colour R,G,B of parts 0 to 1, or #rrggbb".into()),
    }
}

/// Numbers between commas.
fn parts(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|part| part.trim().parse().ok()).collect()
}

/// What fills the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Framing {
    /// The particles as the eye sees them.
    #[default]
    Picture,
    /// The ball around them: they stay within the picture from all sides.
    Ball,
}

impl FromStr for Framing {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "picture" => Ok(Self::Picture),
            "ball" => Ok(Self::Ball),
            _ => Err("expected picture or ball".into()),
        }
    }
}

/// The lights of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lighting {
    /// One lamp at the eye: no shadow is seen.
    Headlight,
    /// A key light, a fill light and a rim light.
    Three,
    /// So many weak lamps around the scene: less light comes into hollows.
    Dome(u32),
}

impl Lighting {
    /// The most lamps of a dome.
    pub const MOST: u32 = 4096;
}

impl Default for Lighting {
    fn default() -> Self {
        Self::Dome(32)
    }
}

impl FromStr for Lighting {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lamps = |text: &str| text.parse().ok().filter(|lamps| (1..=Self::MOST).contains(lamps)).map(Self::Dome);
        match text {
            "headlight" => Some(Self::Headlight),
            "three" => Some(Self::Three),
            _ => text.strip_prefix("dome:").and_then(lamps),
        }
        .ok_or_else(|| format!("expected headlight, three or dome:N with 1 to {} lamps", Self::MOST))
    }
}

/// A direction: `X,Y,Z`, or an axis such as `x` or `-z`.
///
/// # Errors
///
/// What was expected.
pub fn direction(text: &str) -> Result<DVec3, String> {
    let axis = match text.trim_start_matches(['+', '-']) {
        "x" => Some(DVec3::X),
        "y" => Some(DVec3::Y),
        "z" => Some(DVec3::Z),
        _ => None,
    };
    match (axis, parts(text).as_deref()) {
        (Some(axis), _) if text.len() <= 2 => Ok(if text.starts_with('-') { -axis } else { axis }),
        (_, Some(&[x, y, z])) if [x, y, z].iter().all(|part| part.is_finite()) && [x, y, z] != [0.0; 3] => {
            Ok(DVec3::new(x, y, z))
        }
        _ => Err("expected a direction X,Y,Z or an axis: x, -x, y, -y, z or -z".into()),
    }
}
