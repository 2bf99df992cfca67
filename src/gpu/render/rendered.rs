//! What the pixels of a picture say of themselves.

/// What the pixels of a picture say of themselves. Whoever wants all of it has to calculate those of both lists elsewhere.
#[must_use]
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Rendered {
    /// How many are not finite, those below left out.
    pub not_finite: u64,
    /// Pixels with a ray that passes so near to touching a sphere that rounding decides whether it does: each shows either answer.
    pub tangents: Vec<[u32; 2]>,
    /// Pixels that need more turns of a loop than the device has for them, some 65,535: what they show is wrong.
    pub cut: Vec<[u32; 2]>,
}

impl Rendered {
    pub(super) fn add(&mut self, other: Self) {
        self.not_finite += other.not_finite;
        self.tangents.extend(other.tangents);
        self.cut.extend(other.cut);
    }
}
