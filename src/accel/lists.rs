//! Lists of spheres, one for each cell of whatever space is cut into cells.

use std::sync::Arc;

use bytemuck::{Zeroable, zeroed_vec};
use rayon::prelude::*;

/// How spheres fall into cells.
pub(super) trait Binning: Sync {
    /// Number of spheres to be binned.
    fn len(&self) -> usize;
    /// Number of cells.
    fn cells(&self) -> usize;
    /// The index of the sphere that is binned as number `rank`: lists keep the order of ranks.
    fn sphere(&self, rank: usize) -> u32 {
        rank as u32
    }
    /// Hands all cells that the sphere with this rank may reach to `emit`, once: runs of them, by the first and the last.
    fn visit(&self, rank: usize, emit: &mut impl FnMut(usize, usize));
}

/// Cells of one sphere, side by side in one bucket.
#[derive(Clone, Copy, Zeroable)]
struct Run {
    sphere: u32,
    first: u16,
    last: u16,
}

impl Run {
    fn cells(self) -> std::ops::RangeInclusive<usize> {
        usize::from(self.first)..=usize::from(self.last)
    }
}

/// Cells of a bucket at the most, as a power of two: its counters and entries stay in a cache.
const MAX_BUCKET: u32 = 14;
/// Buckets where there are enough cells: several for each thread.
const BUCKETS: usize = 128;

/// Sphere indices, cell by cell.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Lists {
    /// Where each cell's list begins in `entries`, and at last where the last one ends.
    pub offsets: Arc<Vec<u32>>,
    /// Sphere indices.
    pub entries: Arc<Vec<u32>>,
}

impl Lists {
    /// The list of a cell.
    pub fn of(&self, cell: usize) -> &[u32] {
        &self.entries[self.offsets[cell] as usize..self.offsets[cell + 1] as usize]
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// The lists of `binning`: first the spheres' cells in buckets of neighbours, then a counting sort within each. Runs are
    /// counted before they are kept, in an array of just their number. The result does not depend on the number of threads.
    pub(super) fn build(binning: &impl Binning) -> Self {
        let buckets = Buckets::of(binning);
        let chunks = (2 * rayon::current_num_threads()).min(binning.len().div_ceil(1024).max(1));
        let ranks = |chunk: usize| binning.len() * chunk / chunks..binning.len() * (chunk + 1) / chunks;

        let count = |chunk: usize| {
            let mut counts = vec![Count::default(); buckets.count];
            buckets.visit(binning, ranks(chunk), |bucket, run| counts[bucket].add(run));
            counts
        };
        // By chunk, and by bucket in each.
        let counts: Vec<Vec<Count>> = (0..chunks).into_par_iter().map(count).collect();
        // Bucket by bucket, and chunk by chunk in each: all in the order of ranks.
        let mut runs: Vec<Run> = zeroed_vec(counts.iter().flatten().map(|count| count.runs).sum());
        let mut places: Vec<Vec<&mut [Run]>> = counts.iter().map(|_| Vec::with_capacity(buckets.count)).collect();
        let mut rest = runs.as_mut_slice();
        for bucket in 0..buckets.count {
            for (places, counts) in places.iter_mut().zip(&counts) {
                places.extend(rest.split_off_mut(..counts[bucket].runs));
            }
        }
        places.into_par_iter().enumerate().for_each(|(chunk, mut places)| {
            buckets.visit(binning, ranks(chunk), |bucket, run| {
                if let Some(place) = places[bucket].split_off_first_mut() {
                    *place = run;
                }
            });
        });

        let total = |bucket: usize| counts.iter().map(|counts| counts[bucket]).fold(Count::default(), Count::plus);
        let totals: Vec<Count> = (0..buckets.count).map(total).collect();
        let mut all_offsets = vec![0; binning.cells() + 1];
        let mut all_entries = vec![0; totals.iter().map(|total| total.cells).sum()];
        let (mut offsets, mut entries, mut runs) = (&mut all_offsets[1..], all_entries.as_mut_slice(), runs.as_slice());
        let mut tasks = Vec::with_capacity(buckets.count);
        let mut base = 0;
        for total in totals {
            let (ends, later_offsets) = offsets.split_at_mut(offsets.len().min(buckets.cells()));
            let (own, later_entries) = entries.split_at_mut(total.cells);
            let (own_runs, later_runs) = runs.split_at(total.runs);
            tasks.push((own_runs, base, ends, own));
            (offsets, entries, runs) = (later_offsets, later_entries, later_runs);
            base += total.cells as u32;
        }
        tasks.into_par_iter().for_each(|(runs, base, ends, entries)| fill(runs, base, ends, entries));
        Self { offsets: Arc::new(all_offsets), entries: Arc::new(all_entries) }
    }
}

/// How many runs, and how many cells they have together.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    runs: usize,
    cells: usize,
}

impl Count {
    fn add(&mut self, run: Run) {
        *self = self.plus(Self { runs: 1, cells: run.cells().count() });
    }

    fn plus(self, other: Self) -> Self {
        Self { runs: self.runs + other.runs, cells: self.cells + other.cells }
    }
}

/// Buckets of neighbouring cells.
struct Buckets {
    count: usize,
    /// Cells of a bucket, as a power of two.
    shift: u32,
}

impl Buckets {
    fn of(binning: &impl Binning) -> Self {
        let shift = binning.cells().div_ceil(BUCKETS).next_power_of_two().trailing_zeros().min(MAX_BUCKET);
        Self { count: binning.cells().div_ceil(1 << shift), shift }
    }

    fn cells(&self) -> usize {
        1 << self.shift
    }

    /// Hands the runs of the spheres with these ranks to `emit`, each with its bucket.
    fn visit(&self, binning: &impl Binning, ranks: std::ops::Range<usize>, mut emit: impl FnMut(usize, Run)) {
        let last_place = self.cells() - 1;
        let place = |cell: usize| (cell & last_place) as u16;
        for rank in ranks {
            let sphere = binning.sphere(rank);
            binning.visit(rank, &mut |mut first, last| {
                while first <= last {
                    let end = (first | last_place).min(last);
                    emit(first >> self.shift, Run { sphere, first: place(first), last: place(end) });
                    first = end + 1;
                }
            });
        }
    }
}

/// Sorts the cells of `runs` into `entries`; `ends` gets where each cell's list ends, counted from `base` before the first.
fn fill(runs: &[Run], base: u32, ends: &mut [u32], entries: &mut [u32]) {
    for run in runs {
        ends[run.cells()].iter_mut().for_each(|count| *count += 1);
    }
    // From counts to beginnings, which become ends as the lists fill.
    let mut next = 0;
    for end in &mut *ends {
        (next, *end) = (next + *end, next);
    }
    for run in runs {
        for place in &mut ends[run.cells()] {
            entries[*place as usize] = run.sphere;
            *place += 1;
        }
    }
    for end in ends {
        *end += base;
    }
}
