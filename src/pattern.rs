//! Where the samples of a pixel lie. All of it is whole numbers, so that every renderer has the very same places.

mod filter;

use std::sync::Arc;

use clap::ValueEnum;
use serde::Serialize;

pub use filter::Filter;

/// The kinds of [`Pattern`], by their names.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum Placing {
    /// A regular grid over the pixel
    #[default]
    Grid,
    /// A Fibonacci lattice of any number of samples: edges that are nearly level or upright have many more shades
    Fibonacci,
}

/// How the samples of a pixel are placed: the same in each pixel, which is their mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Pattern {
    /// A regular grid of k × k.
    Grid {
        /// Its side k, 1 to [`Pattern::MAX_SIDE`].
        #[serde(rename = "samples_per_side")]
        side: u32,
    },
    /// A Fibonacci lattice: of N samples the one in the i-th of N columns lies in the row that i/φ, without its whole part, has among
    /// those of all, φ being the golden ratio. So each column and each row has one, and no edge meets many at once.
    Fibonacci {
        /// The number N of samples, 1 to [`Pattern::MAX_COUNT`].
        #[serde(rename = "fibonacci")]
        count: u32,
        /// How they are spread over the pixel and what is around it.
        filter: Filter,
    },
}

/// 2³²/φ to the nearest odd number.
const GOLDEN: u32 = 0x9E37_79B9;

/// Filters other than the box place samples on steps of this part of a pixel.
const FINE_STEPS: u32 = 1 << 16;

impl Pattern {
    /// One sample.
    pub const ONE: Self = Self::Grid { side: 1 };
    /// The greatest side of a grid.
    pub const MAX_SIDE: u32 = 16;
    /// The greatest number of samples.
    pub const MAX_COUNT: u32 = Self::MAX_SIDE * Self::MAX_SIDE;

    /// One sample of a pattern of this kind, which [`Pattern::with_count`] has more of; none where a grid is to have a filter.
    pub fn one_of(placing: Placing, filter: Filter) -> Option<Self> {
        match placing {
            Placing::Grid => (filter == Filter::Box).then_some(Self::ONE),
            Placing::Fibonacci => Some(Self::Fibonacci { count: 1, filter }),
        }
    }

    /// A grid of `count` samples.
    ///
    /// # Errors
    ///
    /// Where `count` is no square number of a grid that is accepted.
    pub fn grid_of(count: u32) -> Result<Self, String> {
        let greatest = Self::MAX_COUNT;
        let side = count.isqrt();
        if (1..=greatest).contains(&count) && side * side == count {
            Ok(Self::Grid { side })
        } else {
            Err(format!("expected a square number from 1 to {greatest}: 1, 4, 9, 16, 25, …"))
        }
    }

    /// The same pattern with another number of samples.
    ///
    /// # Errors
    ///
    /// Where it has no such number.
    pub fn with_count(self, count: u32) -> Result<Self, String> {
        match self {
            Self::Grid { .. } => Self::grid_of(count),
            Self::Fibonacci { filter, .. } if (1..=Self::MAX_COUNT).contains(&count) => {
                Ok(Self::Fibonacci { count, filter })
            }
            Self::Fibonacci { .. } => Err(format!("expected a number from 1 to {}", Self::MAX_COUNT)),
        }
    }

    /// The same pattern with about four times as many samples, as far as it has them.
    #[must_use]
    pub fn finer(self) -> Self {
        match self {
            Self::Grid { side } => Self::Grid { side: (2 * side).min(Self::MAX_SIDE) },
            Self::Fibonacci { count, filter } => Self::Fibonacci { count: (4 * count).min(Self::MAX_COUNT), filter },
        }
    }

    /// Samples of a pixel.
    pub fn count(self) -> u32 {
        match self {
            Self::Grid { side } => side * side,
            Self::Fibonacci { count, .. } => count,
        }
    }

    /// The pattern by the name that is the same for the same samples: a single one lies where a grid has it, whatever the filter.
    pub(crate) fn plain(self) -> Self {
        if self.count() == 1 { Self::ONE } else { self }
    }

    /// Columns of samples that a pixel has, and as many rows: those of the grid, or one for each sample.
    pub fn side(self) -> u32 {
        match self {
            Self::Grid { side } => side,
            Self::Fibonacci { count, .. } => count,
        }
    }

    /// Column and row of a sample in its pixel; read it beside `shaders/trace.wgsl`.
    pub fn sample_place(self, sample: u32) -> [u32; 2] {
        match self {
            Self::Grid { side } => [sample % side, sample / side],
            Self::Fibonacci { .. } => [sample, sample],
        }
    }

    /// Column and row of the sample next to the middle of its pixel.
    pub fn middle(self) -> [u32; 2] {
        match self {
            Self::Grid { side } => [side / 2; 2],
            Self::Fibonacci { count, .. } => {
                let columns: Vec<u32> = (0..count).collect();
                let from_middle = |cell: u32| (2 * cell + 1).abs_diff(count).pow(2);
                let rows = ranks(&columns);
                let nearest = (0..count).min_by_key(|&i| from_middle(i) + from_middle(rows[i as usize]));
                self.sample_place(nearest.unwrap_or(0))
            }
        }
    }

    /// Where the columns and the rows of a pixel's samples lie, by the offsets of a convention: halves of a cell from the left and
    /// from the top, a cell being what one sample has of the pixel's width.
    #[doc(hidden)]
    pub fn ticks(self, offset: (f64, f64)) -> [Ticks; 2] {
        let halves = [offset.0, offset.1].map(|offset| (2.0 * offset) as i64);
        let even = |cells: &[u32], halves: i64| {
            let ticks = cells.iter().map(|&cell| 2 * i64::from(cell) + halves).collect();
            Ticks { steps: 2 * cells.len() as u32, ticks }
        };
        match self {
            Self::Grid { side } => {
                let cells: Vec<u32> = (0..side.max(1)).collect();
                halves.map(|halves| even(&cells, halves))
            }
            Self::Fibonacci { count, filter } => {
                let count = count.clamp(1, Self::MAX_COUNT);
                let columns: Vec<u32> = (0..count).collect();
                let cells = [columns.clone(), ranks(&columns)];
                let spread = filter.spread(count, FINE_STEPS);
                [0, 1].map(|axis| match &spread {
                    None => even(&cells[axis], halves[axis]),
                    Some(spread) => {
                        // Conventions move all samples alike, as they do without a filter.
                        let moved = rounded((halves[axis] - 1) * i64::from(FINE_STEPS), 2 * i64::from(count));
                        let ticks = cells[axis].iter().map(|&cell| spread[cell as usize] + moved).collect();
                        Ticks { steps: FINE_STEPS, ticks }
                    }
                })
            }
        }
    }
}

/// The rows of the samples in these columns, which are all.
fn ranks(columns: &[u32]) -> Vec<u32> {
    let key = |column: u32| (column + 1).wrapping_mul(GOLDEN);
    let rank = |&column: &u32| columns.iter().filter(|&&other| key(other) < key(column)).count() as u32;
    columns.iter().map(rank).collect()
}

/// a/b to the nearest whole number, for a positive b.
fn rounded(a: i64, b: i64) -> i64 {
    (2 * a + b).div_euclid(2 * b)
}

/// Where the samples of a pixel lie in one direction, in equal steps of its size.
#[derive(Debug, Clone, Default)]
pub struct Ticks {
    steps: u32,
    ticks: Arc<[i64]>,
}

impl Ticks {
    /// Steps in a pixel.
    pub fn steps(&self) -> u32 {
        self.steps
    }

    /// How many steps the column or row of samples with this index, counted through all pixels, lies from the picture's edge.
    pub fn steps_to(&self, index: u32) -> i64 {
        let side = self.ticks.len() as u32;
        i64::from(index / side) * i64::from(self.steps) + self.ticks[(index % side) as usize]
    }

    /// The same in pixels.
    pub fn place(&self, index: u32) -> f64 {
        self.steps_to(index) as f64 / f64::from(self.steps)
    }

    /// The least and the greatest place in a pixel.
    pub fn range(&self) -> [f64; 2] {
        let ends = [self.ticks.iter().min(), self.ticks.iter().max()];
        ends.map(|tick| tick.map_or(0.0, |&tick| tick as f64 / f64::from(self.steps)))
    }
}
