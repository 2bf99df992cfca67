//! Where the eye is and where it looks.

use std::fmt;

use clap::ValueEnum;
use glam::DVec3;
use serde::{Serialize, Serializer};

/// Below this sine of the angle between the view and the upward direction, rounding would choose the picture's rotation.
const LEAST_SINE: f64 = 1e-9;

/// Where the rays of a picture come from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Projection {
    /// From the eye through the window: what is farther away is smaller
    #[default]
    Perspective,
    /// Along the view from the points of the window, in world units: all is shown as large as it is
    Orthographic,
}

impl Projection {
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks so")]
    fn is_usual(&self) -> bool {
        *self == Self::default()
    }
}

/// The eye and the axes of the picture in the world, orthonormal. The default is the scene file's camera.
///
/// Renderers keep the eye at the origin: the scene is moved instead, so that what is near the eye stays exact wherever that is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct View {
    /// The eye in the world.
    #[serde(serialize_with = "coordinates")]
    pub eye: DVec3,
    /// The picture's x axis in the world.
    #[serde(serialize_with = "coordinates")]
    right: DVec3,
    /// The picture's y axis in the world.
    #[serde(serialize_with = "coordinates")]
    up: DVec3,
    /// Against the direction of view.
    #[serde(serialize_with = "coordinates")]
    back: DVec3,
    /// How the world is projected.
    #[serde(skip_serializing_if = "Projection::is_usual")]
    projection: Projection,
}

/// Why there is no such view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViewError {
    /// A coordinate is infinite or NaN, or the distance between eye and target is.
    NotFinite,
    /// Eye and target are the same point.
    NoDirection,
    /// The upward direction is 0.
    NoUp,
    /// The upward direction lies along the direction of view.
    UpAlongView,
    /// A field of view is asked for where rays are parallel.
    FovOfParallel,
}

impl fmt::Display for ViewError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "eye, look-at and up must be finite, and so must the way from eye to look-at",
            Self::NoDirection => "eye and look-at are the same point: there is no direction of view",
            Self::NoUp => "up is 0,0,0: it has no direction",
            Self::UpAlongView => "up is parallel to the direction of view: choose another --up",
            Self::FovOfParallel => {
                "an orthographic picture has no field of view: LEFT, RIGHT, BOTTOM and TOP say how much it shows"
            }
        })
    }
}

impl std::error::Error for ViewError {}

impl View {
    /// The eye at the origin, looking along −z, with y upwards.
    pub const FILE: Self =
        Self { eye: DVec3::ZERO, right: DVec3::X, up: DVec3::Y, back: DVec3::Z, projection: Projection::Perspective };

    /// From `eye` towards `look_at` (without one along −z), with `up` upwards on the picture as far as the direction of view
    /// allows.
    ///
    /// # Errors
    ///
    /// Where these do not define a view.
    pub fn new(eye: DVec3, look_at: Option<DVec3>, up: DVec3) -> Result<Self, ViewError> {
        let back = look_at.map_or(DVec3::Z, |target| eye - target);
        if ![eye, back, up].iter().all(|v| v.is_finite()) {
            return Err(ViewError::NotFinite);
        }
        let back = unit(back).ok_or(ViewError::NoDirection)?;
        let sideways = unit(up).ok_or(ViewError::NoUp)?.cross(back);
        if sideways.length() < LEAST_SINE {
            return Err(ViewError::UpAlongView);
        }
        // Where up is nearly along the view, rounding leaves a part of it.
        let right = unit(sideways).ok_or(ViewError::UpAlongView)?;
        let right = unit(right - back * right.dot(back)).ok_or(ViewError::UpAlongView)?;
        Ok(Self { eye, right, up: back.cross(right), back, projection: Projection::Perspective })
    }

    /// The same axes with the eye at the origin.
    #[must_use]
    pub(crate) fn at_origin(self) -> Self {
        Self { eye: DVec3::ZERO, ..self }
    }

    /// The same view in this projection.
    #[must_use]
    pub fn projected(self, projection: Projection) -> Self {
        Self { projection, ..self }
    }

    /// How the world is projected.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// Whether all rays from the eye are parallel.
    pub(crate) fn is_parallel(&self) -> bool {
        self.projection == Projection::Orthographic
    }

    /// The picture's axes in the world: to the right, upwards, and against the direction of view.
    pub fn axes(&self) -> [DVec3; 3] {
        [self.right, self.up, self.back]
    }
}

impl Default for View {
    fn default() -> Self {
        Self::FILE
    }
}

/// `v` with length 1; none for 0.
fn unit(v: DVec3) -> Option<DVec3> {
    let greatest = v.abs().max_element();
    if greatest == 0.0 {
        return None;
    }
    let v = v / greatest;
    // Quotients, since these leave a vector along an axis exact; + 0 turns −0 into 0.
    Some(v / v.length() + DVec3::ZERO)
}

fn coordinates<S: Serializer>(v: &DVec3, serializer: S) -> Result<S::Ok, S::Error> {
    v.to_array().serialize(serializer)
}
