//! What a renderer is asked for: the kind is part of its type, since the kernels differ.

use std::fmt;

use crate::gpu::kernel::variant::Slots;

/// What a renderer renders: [`Rows`] or [`Pixels`].
pub trait Output: fmt::Debug + sealed::Sealed {
    /// Which pixels a dispatch renders.
    const SLOTS: Slots;
}

/// Rows of the picture.
#[derive(Debug, Clone, Copy)]
pub struct Rows;

/// Lists of pixels, in any order.
#[derive(Debug, Clone, Copy)]
pub struct Pixels;

impl Output for Rows {
    const SLOTS: Slots = Slots::Tiles;
}

impl Output for Pixels {
    const SLOTS: Slots = Slots::List;
}

impl sealed::Sealed for Rows {}
impl sealed::Sealed for Pixels {}

mod sealed {
    pub trait Sealed {}
}
