//! Terms of what primary rays hit, in place of colours.

use crate::gpu::shared::{
    TERM_AMBIENT, TERM_BACKGROUND, TERM_DIFFUSE, TERM_HIT, TERM_INCIDENCE, TERM_NORMAL, TERM_POSITION, TERM_SPECULAR,
};

/// Three numbers of what a primary ray hits, in the units of kernels; of a light by its index. Where it hits nothing all are 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Term {
    /// t, the index of the sphere, and 1 where it is seen from inside.
    Hit,
    /// Where it hits.
    Position,
    /// The unit normal there.
    Normal,
    /// The background, where it hits nothing; 0 where it does.
    Background,
    /// The ambient term.
    Ambient,
    /// N·L, and 1 where a sphere blocks the light.
    Incidence(u32),
    /// The diffuse term of a light.
    Diffuse(u32),
    /// The specular term of a light.
    Specular(u32),
}

impl Term {
    /// As `shaders/path_first.wgsl` has it.
    pub(super) fn words(self) -> [u32; 2] {
        match self {
            Self::Hit => [TERM_HIT, 0],
            Self::Position => [TERM_POSITION, 0],
            Self::Normal => [TERM_NORMAL, 0],
            Self::Background => [TERM_BACKGROUND, 0],
            Self::Ambient => [TERM_AMBIENT, 0],
            Self::Incidence(light) => [TERM_INCIDENCE, light],
            Self::Diffuse(light) => [TERM_DIFFUSE, light],
            Self::Specular(light) => [TERM_SPECULAR, light],
        }
    }
}
