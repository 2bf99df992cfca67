//! The scene as the file states it.

use glam::DVec3;

use crate::words::visible;

/// The greatest accepted `RES` value per axis: pixel numbers up to here are exact in `f32`.
pub const MAX_RESOLUTION: u32 = 1 << 24;

/// Columns and rows from a text such as `640x480`.
///
/// # Errors
///
/// What was expected.
pub fn resolution(text: &str) -> Result<(u32, u32), String> {
    let side = |text: &str| text.trim().parse().ok().filter(|side| (1..=MAX_RESOLUTION).contains(side));
    text.split_once(['x', 'X', '×'])
        .and_then(|(width, height)| Some((side(width)?, side(height)?)))
        .ok_or_else(|| format!("expected WxH with sides from 1 to {MAX_RESOLUTION}, such as 640x480"))
}

/// A whole scene: what is seen, from where, and where the picture goes.
///
/// Fields can be set at will: `Scene { spheres, lights, ..Scene::new(window, 640, 480) }`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    /// The window on the image plane through which the eye at the origin looks down −Z.
    pub window: Window,
    /// Picture width in pixels (columns), 1 to [`MAX_RESOLUTION`].
    pub width: u32,
    /// Picture height in pixels (rows), 1 to [`MAX_RESOLUTION`].
    pub height: u32,
    /// Spheres in the order of the file; the index of a sphere is its place here.
    pub spheres: Vec<Sphere>,
    /// The label of each sphere, same order as `spheres`; may lack some.
    pub sphere_names: Names,
    /// Point lights in the order of the file.
    pub lights: Vec<Light>,
    /// The label of each light, same order as `lights`; may lack some.
    pub light_names: Names,
    /// `BACK`: the colour of a primary ray that hits nothing.
    pub background: DVec3,
    /// `AMBIENT`: the ambient intensity.
    pub ambient: DVec3,
    /// `OUTPUT` as written in the file, if it is there.
    pub output: Option<String>,
}

/// The window `LEFT RIGHT BOTTOM TOP` on the image plane z = −`near`.
///
/// The default is what the eye sees at 90 degrees: NEAR 1, edges at ±1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Distance of the image plane, > 0.
    pub near: f64,
    /// x of the left edge of column 0.
    pub left: f64,
    /// x of the right edge of the last column; ≠ `left`.
    pub right: f64,
    /// y of the bottom edge of the last row; ≠ `top`.
    pub bottom: f64,
    /// y of the top edge of row 0.
    pub top: f64,
}

impl Window {
    /// The greatest coordinate of a point on it.
    pub(crate) fn greatest(&self) -> f64 {
        let Self { near, left, right, bottom, top } = *self;
        [left, right, bottom, top].iter().fold(near, |greatest, edge| greatest.max(edge.abs()))
    }
}

impl Default for Window {
    fn default() -> Self {
        Self { near: 1.0, left: -1.0, right: 1.0, bottom: -1.0, top: 1.0 }
    }
}

/// One `SPHERE` line: the unit sphere, scaled by `scale`, then moved to `center`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Centre (px, py, pz).
    pub center: DVec3,
    /// Semi-axes (sx, sy, sz); never zero, a negative one means its absolute value.
    pub scale: DVec3,
    /// Object colour (r, g, b), usually within 0..=1.
    pub color: DVec3,
    /// Ambient coefficient Ka.
    pub ka: f64,
    /// Diffuse coefficient Kd.
    pub kd: f64,
    /// Specular coefficient Ks.
    pub ks: f64,
    /// Reflection coefficient Kr.
    pub kr: f64,
    /// Specular exponent n, ≥ 0.
    pub n: f64,
    /// Transmission coefficient Kt; 0 where the line does not carry the refraction extension.
    pub kt: f64,
    /// Index of refraction of the inside relative to the outside, > 0; 1 where the line does not carry it.
    pub eta: f64,
}

impl Sphere {
    /// A sphere of matt material.
    pub fn new(center: impl Into<DVec3>, radius: f64, color: impl Into<DVec3>) -> Self {
        Self { center: center.into(), scale: DVec3::splat(radius), color: color.into(), ..Self::default() }
    }
}

/// The unit sphere, white and matt: all of the ambient light, all of the diffuse term, nothing else.
impl Default for Sphere {
    fn default() -> Self {
        let (center, scale, color) = (DVec3::ZERO, DVec3::ONE, DVec3::ONE);
        Self { center, scale, color, ka: 1.0, kd: 1.0, ks: 0.0, kr: 0.0, n: 1.0, kt: 0.0, eta: 1.0 }
    }
}

/// One `LIGHT` line: a point light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Position (px, py, pz).
    pub position: DVec3,
    /// Intensity (Ir, Ig, Ib).
    pub intensity: DVec3,
}

/// Labels in one allocation, so that millions of them stay cheap.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Names {
    text: String,
    ends: Vec<u64>,
}

impl Names {
    /// Appends one label.
    pub fn push(&mut self, name: &str) {
        self.text.push_str(name);
        self.ends.push(self.text.len() as u64);
    }

    /// Appends all labels of `others`.
    pub(crate) fn append(&mut self, others: &Self) {
        let before = self.text.len() as u64;
        self.text.push_str(&others.text);
        self.ends.extend(others.ends.iter().map(|end| before + end));
    }

    /// The label at `index`, or `""` past the end.
    pub fn get(&self, index: usize) -> &str {
        let Some(&end) = self.ends.get(index) else {
            return "";
        };
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.text[start as usize..end as usize]
    }

    /// What this noun calls, by the label at `index`, safe to print since it may hold whatever the file has; without one by the
    /// index: `sphere 'moon'`, `sphere 3`.
    pub fn in_words(&self, noun: &str, index: usize) -> String {
        match self.get(index) {
            "" => format!("{noun} {index}"),
            label => format!("{noun} '{}'", visible(label)),
        }
    }

    /// How many labels there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }
}
