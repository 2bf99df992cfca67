//! What decides which text a kernel has.

use std::num::NonZeroU32;

use crate::accel::Rounding;
use crate::precision::Tier;

/// What intersects rays with spheres: a tier, or what goes wrong without its care.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// The kernel of a tier, which renders.
    Tier(Tier),
    /// The kernel of [`Tier::Double`] where the device has no `f64`: pairs of `f32` up to the roots.
    Pairs,
    /// The schoolbook formula in `f32`: for study only.
    Schoolbook,
    /// The robust kernel whose error-free transforms are left to the compiler, without barriers and free to be contracted: for study
    /// only.
    NoBarrier,
}

impl Kernel {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tier(tier) => tier.name(),
            Self::Pairs => "pairs",
            Self::Schoolbook => "schoolbook",
            Self::NoBarrier => "no-barrier",
        }
    }

    /// Whether numbers carry what rounding took from them.
    pub fn carries_low(self) -> bool {
        matches!(self, Self::Tier(Tier::Robust) | Self::Pairs | Self::NoBarrier)
    }

    /// How it rounds.
    pub fn rounding(self) -> Rounding {
        if self.is_double() {
            Rounding::DOUBLE
        } else if self.carries_low() {
            Rounding::COMPENSATED
        } else {
            Rounding::SINGLE
        }
    }

    /// Whether its pixels say where rounding could decide whether a primary ray touches a sphere.
    pub fn tells_tangents(self) -> bool {
        self.is_double() || self.carries_low()
    }

    /// Whether it calculates in `f64`.
    pub fn is_double(self) -> bool {
        self == Self::Tier(Tier::Double)
    }
}

/// Where the spheres are that secondary rays look for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Secondary {
    /// All in the cells of the grid.
    Grid,
    /// All too large for the cells of the grid, or so few.
    Large,
    /// Some of each.
    Both,
}

/// What holds the tables of a scene, and what goes from kernel to kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Tables {
    /// Storage buffers.
    Buffers,
    /// Storage textures.
    Stored,
    /// Sampled textures.
    Sampled,
}

/// How spheres and lights reach the kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Storage {
    /// In tables, with lists of those that a ray can meet.
    Tables(Tables),
    /// In storage buffers, a range of spheres for each ray of a batch.
    Ranges,
}

/// How the bounces of paths are scheduled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Schedule {
    /// To the end, by the invocation that casts the primary ray.
    InPlace,
    /// No bounce, where nothing refracts: a term of the first hit stands in place of the colour.
    First,
    /// A bounce at a time: one an invocation, which also shades what it meets.
    AtOnce,
    /// A bounce at a time: so many an invocation, one after another; then a kernel shades what they have met.
    InTurn(NonZeroU32),
}

/// Which pixels a dispatch renders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Slots {
    /// All of each tile.
    Tiles,
    /// Those of a list.
    List,
}

/// What decides which text renders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Variant {
    /// What intersects rays with spheres.
    pub kernel: Kernel,
    /// How spheres and lights reach it.
    pub storage: Storage,
    /// Where the spheres are that secondary rays look for.
    pub secondary: Secondary,
    /// Whether the colours of samples are kept, for another kernel to make pixels of them.
    pub samples: bool,
    /// Where something refracts, how many rays wait at the most.
    pub refraction: Option<NonZeroU32>,
    /// Which pixels a dispatch renders.
    pub slots: Slots,
    /// How the bounces of paths are scheduled, where nothing refracts.
    pub schedule: Schedule,
    /// Whether samples say where rounding could decide what they show.
    pub certified: bool,
    /// Tiles of a dispatch at the most.
    pub dispatch_tiles: u32,
}

impl Variant {
    /// For a kernel that renders no picture: with spheres in storage buffers, and whatever for the rest.
    pub(crate) fn of_ranges(kernel: Kernel) -> Self {
        Self {
            kernel,
            storage: Storage::Ranges,
            secondary: Secondary::Large,
            samples: false,
            refraction: None,
            slots: Slots::Tiles,
            schedule: Schedule::InPlace,
            certified: false,
            dispatch_tiles: 0,
        }
    }

    /// Whether paths are kept from bounce to bounce.
    pub fn keeps_paths(&self) -> bool {
        self.refraction.is_none() && !matches!(self.schedule, Schedule::InPlace | Schedule::First)
    }

    /// Whether walks read copies of the spheres in the order of the grid's lists.
    pub fn copies(&self) -> bool {
        self.refraction.is_none() && matches!(self.schedule, Schedule::InTurn(_)) && !self.kernel.carries_low()
    }
}
