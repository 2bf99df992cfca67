//! What the pixels of a picture say of themselves.

/// What the pixels of a picture say of themselves. Whoever wants all of it has to calculate those of both lists elsewhere.
#[must_use]
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Rendered {
    /// How many are not finite, those below left out.
    pub not_finite: u64,
    /// Pixels of which rounding could decide what they show. At tiers that tell tangents, these are pixels with a primary ray that
    /// passes so near to touching a sphere that rounding decides whether it does; of a certified picture, all of which the kernel's
    /// bound of error does not say that they are right.
    pub unsure: Vec<[u32; 2]>,
    /// Pixels that need more turns of a loop than the device has for them, some 65,535: what they show is wrong.
    pub cut: Vec<[u32; 2]>,
}

impl Rendered {
    /// What others say, too.
    pub(crate) fn add(&mut self, other: Self) {
        self.not_finite += other.not_finite;
        self.unsure.extend(other.unsure);
        self.cut.extend(other.cut);
    }
}
