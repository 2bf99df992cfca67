//! The rules of a picture, each of which can be broken.

use crate::settings::Specular;

/// Which roots of a primary ray count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Near {
    /// Beyond the image plane.
    Beyond,
    /// On the image plane, too.
    AtLeast,
    /// All before the eye.
    Ignored,
    /// More than one unit of length away from the eye.
    OneUnitAway,
}

/// Which of the spheres that a ray meets it shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Winner {
    Nearest,
    FirstInFile,
    LastInFile,
}

/// The unit normal, or what is taken for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Normal {
    /// (P − p)/s², of unit length.
    InverseTranspose,
    /// P − p, of unit length.
    FromCenter,
    /// (P − p)/s, of unit length.
    ObjectSpace,
    /// (P − p)/s², as long as it is.
    RawInverseTranspose,
    /// P − p, as long as it is.
    RawFromCenter,
    /// (P − p)/s, as long as it is: of unit length in object space alone.
    RawObjectSpace,
}

/// The vector to a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ToLight {
    Unit,
    /// As long as the way to the light.
    Raw,
    /// As long as the way to the light in N·L alone.
    RawInDiffuse,
    /// As long as the way to the light in the specular term alone.
    RawInSpecular,
    /// The same everywhere: from the origin to the light.
    FromOrigin,
}

/// The vector to the viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ToViewer {
    AgainstRay,
    /// As long as the ray's direction.
    Raw,
    /// Along +Z.
    AlongZ,
    /// To the eye, in mirrors too.
    ToEye,
}

/// What becomes of N·L below 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Behind {
    /// The light adds nothing.
    Dark,
    /// The specular term stays.
    SpecularStays,
    /// The diffuse term is negative, the specular term stays.
    Subtracts,
    /// |N·L| counts.
    TwoSided,
    /// |N·L| counts, also for R.
    TwoSidedInR,
}

/// What becomes of R·V below 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum NegativeCosine {
    Clamped,
    /// Its power counts: an even one shines.
    Kept,
    /// |R·V| counts.
    Absolute,
}

/// What the specular term is multiplied by besides Ks, the light and the power.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SpecularFactor {
    One,
    ObjectColor,
    NDotL,
    Kd,
}

/// How often ambient light is added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum AmbientCount {
    Times(f64),
    PerLight,
    PerUnblockedLight,
}

/// How light fades.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fading {
    None,
    Distance,
    DistanceSquared,
}

/// What a blocked light takes away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shadow {
    None,
    OwnLight,
    /// The specular term alone stays.
    DiffuseOnly,
    /// The diffuse term alone stays.
    SpecularOnly,
    /// All lights.
    AllLights,
    /// All lights and the ambient term.
    Everything,
}

/// How the reflected colour comes to the local one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Mirror {
    /// local + Kr·reflected.
    Added,
    /// local + reflected, where Kr > 0.
    Unweighted,
    /// (1 − Kr)·local + Kr·reflected.
    Blended,
    /// local + Kr·O·reflected.
    Colored,
    /// local + Ks·reflected.
    ByKs,
}

/// What is clamped to 0..=1 within a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Clamp {
    None,
    Reflected,
    EveryColor,
}

/// Every rule that the textbook renderer goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rules {
    /// Where in its pixel the sample lies, to the right and downwards.
    pub offset: (f64, f64),
    /// Whether the last sample lies on the far edge: pixels are counted in N − 1.
    pub edge_to_edge: bool,
    /// Whether the image plane lies at distance 1, wherever NEAR has it.
    pub near_is_one: bool,
    pub near: Near,
    /// Whether the greater root counts where the lesser is too near.
    pub far_root: bool,
    /// Whether spheres that the image plane cuts are seen.
    pub cut_spheres: bool,
    pub winner: Winner,
    pub normal: Normal,
    /// Whether the normal of an inner wall points inwards.
    pub flipped_inside: bool,
    pub to_light: ToLight,
    pub to_viewer: ToViewer,
    pub behind: Behind,
    pub specular: Specular,
    pub negative_cosine: NegativeCosine,
    pub specular_factor: SpecularFactor,
    /// Whether highlights have the light's colour.
    pub specular_takes_light: bool,
    /// Exponents are these times n plus that.
    pub exponent: (f64, f64),
    pub diffuse: f64,
    pub highlights: f64,
    pub ambient: AmbientCount,
    pub ambient_takes_ka: bool,
    pub ambient_takes_color: bool,
    pub fading: Fading,
    pub shadow: Shadow,
    /// Whether the sphere of the lit point blocks light.
    pub own_blocks: bool,
    /// Whether a ray that leaves a sphere from outside may meet it again.
    pub own_from_outside: bool,
    /// Whether the greater root blocks light.
    pub far_root_blocks: bool,
    /// Whether what the image plane cuts away blocks light.
    pub cut_part_blocks: bool,
    /// Which part of the way to a light blockers may lie on.
    pub shadow_range: (f64, f64),
    /// Least distance of a blocker in world units, in place of the above.
    pub shadow_distance: Option<f64>,
    pub shadows_in_mirrors: bool,
    pub mirror: Mirror,
    pub depth: u32,
    /// Least distance of a reflected hit.
    pub reflection_epsilon: f64,
    /// Whether mirrors show BACK.
    pub back_in_mirrors: bool,
    pub clamp: Clamp,
    /// Lights, by bits, that shine on no surface that the eye sees.
    pub darkened: u32,
}
