//! Scenes that no file says: whether a file could.

use std::fmt;
use std::path::Path;

use rayon::prelude::*;

use super::model::{Light, MAX_RESOLUTION, Scene, Sphere, Window};
use super::parse::{Field, Keyword, parse};

/// A number that no scene file may have.
#[derive(Debug, Clone, PartialEq)]
pub struct Invalid {
    /// Whose it is, such as `sphere 3`, counted from 0, or `the window`.
    pub of: String,
    /// What the documentation of the format calls it, such as `sx`.
    pub field: &'static str,
    /// The number.
    pub number: f64,
    /// What it has to be.
    pub expected: &'static str,
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { of, field, number, expected } = self;
        write!(f, "{field} of {of} is {number}: {expected}")
    }
}

impl std::error::Error for Invalid {}

/// A scene file that cannot be read or has errors; its text is the whole report, with file, line, column and token of each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneError(String);

impl SceneError {
    /// With this text.
    pub(crate) fn new(text: String) -> Self {
        Self(text)
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.trim_end())
    }
}

impl std::error::Error for SceneError {}

impl Scene {
    /// An empty scene of `width` × `height` pixels, seen through `window`, black and without light.
    pub fn new(window: Window, width: u32, height: u32) -> Self {
        Self { window, width, height, ..Self::default() }
    }

    /// Reads a scene file.
    ///
    /// # Errors
    ///
    /// Where it cannot be read, or has errors.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        let text = std::fs::read(path);
        let text = text.map_err(|error| SceneError(format!("cannot read the scene {}: {error}", path.display())))?;
        Self::from_text(&path.display().to_string(), &text)
    }

    /// The scene that `text` says; `name` is what errors call it.
    ///
    /// ```
    /// # use trueray::Scene;
    /// let error = Scene::from_text("mine.txt", b"NEAR one").unwrap_err().to_string();
    /// assert!(error.contains("mine.txt:1:6"));
    /// ```
    ///
    /// # Errors
    ///
    /// Where it has errors.
    pub fn from_text(name: &str, text: &[u8]) -> Result<Self, SceneError> {
        let mut parsed = parse(name, text);
        parsed.scene.take().ok_or_else(|| SceneError(parsed.report(false)))
    }

    /// Whether a scene file may have these numbers; what is read from one always passes.
    ///
    /// # Errors
    ///
    /// The first number that it may not have.
    pub fn check(&self) -> Result<(), Invalid> {
        for (field, side) in [("width", self.width), ("height", self.height)] {
            if !(1..=MAX_RESOLUTION).contains(&side) {
                return Err(invalid("the picture", field, side.into(), "expected 1 to 16777216 pixels"));
            }
        }
        self.check_window()?;
        for (keyword, numbers) in [(Keyword::Back, self.background), (Keyword::Ambient, self.ambient)] {
            check(keyword.form().fields, numbers.as_ref(), || keyword.text().into())?;
        }
        let spheres = self.spheres.par_iter().enumerate().map(|(index, sphere)| {
            let Sphere { center: p, scale: s, color: c, ka, kd, ks, kr, n, kt, eta } = *sphere;
            let numbers = [p.x, p.y, p.z, s.x, s.y, s.z, c.x, c.y, c.z, ka, kd, ks, kr, n, kt, eta];
            check(Keyword::Sphere.form().fields, &numbers, || format!("sphere {index}"))
        });
        spheres.find_first(Result::is_err).unwrap_or(Ok(()))?;
        self.lights.iter().enumerate().try_for_each(|(index, &Light { position: p, intensity: i })| {
            check(Keyword::Light.form().fields, &[p.x, p.y, p.z, i.x, i.y, i.z], || format!("light {index}"))
        })
    }

    /// The same of the window alone.
    pub(super) fn check_window(&self) -> Result<(), Invalid> {
        let Window { near, left, right, bottom, top } = self.window;
        let edges = [
            (Keyword::Near, near),
            (Keyword::Left, left),
            (Keyword::Right, right),
            (Keyword::Bottom, bottom),
            (Keyword::Top, top),
        ];
        for (keyword, number) in edges {
            check(keyword.form().fields, &[number], || keyword.text().into())?;
        }
        for (field, from, to) in [("right", left, right), ("top", bottom, top)] {
            if !are_edges(from, to) {
                return Err(invalid("the window", field, to, OPPOSITE));
            }
        }
        Ok(())
    }
}

/// Whether a window may lie between these.
pub(crate) fn are_edges(from: f64, to: f64) -> bool {
    from != to && (to - from).is_finite()
}

/// What they have to be.
pub(crate) const OPPOSITE: &str = "expected another number than at the opposite edge, not too far from it";

fn invalid(of: &str, field: &'static str, number: f64, expected: &'static str) -> Invalid {
    Invalid { of: of.into(), field, number, expected }
}

fn check(fields: &'static [Field], numbers: &[f64], of: impl FnOnce() -> String) -> Result<(), Invalid> {
    match fields.iter().zip(numbers).find(|(field, number)| !number.is_finite() || !field.rule.takes(**number)) {
        None => Ok(()),
        Some((field, &number)) => Err(Invalid { of: of(), field: field.name, number, expected: field.rule.expected() }),
    }
}
