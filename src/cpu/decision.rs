//! The decisions of a path that rounding may take otherwise.

use serde::Serialize;

/// A decision that a ray within the cone takes differently.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Decision {
    /// A sphere is just hit or just missed.
    Silhouette,
    /// Two surfaces are hit at nearly the same distance.
    Tie,
    /// A hit lies just before or behind the image plane.
    NearPlane,
    /// A hit lies just before or behind the least distance of a secondary ray.
    Epsilon,
    /// A blocker is just hit or just missed, or ends just at the light.
    ShadowEdge,
    /// A light stands just above or below the tangent plane.
    Terminator,
    /// A ray meets glass just within or beyond the critical angle.
    CriticalAngle,
    /// The colour lies just above or below a quantisation step.
    QuantisationStep,
}

impl Decision {
    /// The decision in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Silhouette => "silhouette",
            Self::Tie => "two surfaces at one distance",
            Self::NearPlane => "near plane",
            Self::Epsilon => "secondary epsilon",
            Self::ShadowEdge => "shadow edge",
            Self::Terminator => "terminator",
            Self::CriticalAngle => "critical angle",
            Self::QuantisationStep => "quantisation step",
        }
    }
}
