//! Lists of spheres, one for each cell of whatever space is cut into cells.

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
#[derive(Clone, Copy)]
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
    pub offsets: Vec<u32>,
    /// Sphere indices.
    pub entries: Vec<u32>,
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

    /// The lists of `binning`: first the spheres' cells in buckets of neighbours, then a counting sort within each. The result
    /// does not depend on the number of threads.
    pub(super) fn build(binning: &impl Binning) -> Self {
        let shift = binning.cells().div_ceil(BUCKETS).next_power_of_two().trailing_zeros().min(MAX_BUCKET);
        let bucket_cells = 1 << shift;
        let buckets = binning.cells().div_ceil(bucket_cells);
        let chunks = (2 * rayon::current_num_threads()).min(binning.len().div_ceil(1024).max(1));
        let expected = 3 * binning.len() / (chunks * buckets).max(1);
        let chunk = |chunk: usize| {
            let mut runs: Vec<Vec<Run>> =
                std::iter::repeat_with(|| Vec::with_capacity(expected)).take(buckets).collect();
            for rank in binning.len() * chunk / chunks..binning.len() * (chunk + 1) / chunks {
                let sphere = binning.sphere(rank);
                binning.visit(rank, &mut |mut first, last| {
                    while first <= last {
                        let (bucket, end) = (first >> shift, (first | (bucket_cells - 1)).min(last));
                        let place = |cell: usize| (cell & (bucket_cells - 1)) as u16;
                        runs[bucket].push(Run { sphere, first: place(first), last: place(end) });
                        first = end + 1;
                    }
                });
            }
            runs
        };
        let runs: Vec<Vec<Vec<Run>>> = (0..chunks).into_par_iter().map(chunk).collect();

        let len = |bucket: usize| runs.iter().flat_map(|chunk| &chunk[bucket]).map(|run| run.cells().count()).sum();
        let lens: Vec<usize> = (0..buckets).into_par_iter().map(len).collect();
        let mut lists = Self { offsets: vec![0; binning.cells() + 1], entries: vec![0; lens.iter().sum()] };
        let mut base = 0;
        let mut offsets = &mut lists.offsets[1..];
        let mut entries = lists.entries.as_mut_slice();
        let mut tasks = Vec::with_capacity(buckets);
        for (bucket, len) in lens.into_iter().enumerate() {
            let (ends, later_offsets) = offsets.split_at_mut(offsets.len().min(bucket_cells));
            let (own, later_entries) = entries.split_at_mut(len);
            tasks.push((bucket, base as u32, ends, own));
            (offsets, entries, base) = (later_offsets, later_entries, base + len);
        }
        tasks.into_par_iter().for_each(|(bucket, base, ends, entries)| {
            let runs = || runs.iter().flat_map(|chunk| &chunk[bucket]);
            fill(runs, base, ends, entries);
        });
        lists
    }
}

/// Sorts the cells of `runs` into `entries`; `ends` gets where each cell's list ends, counted from `base` before the first.
fn fill<'a, I: Iterator<Item = &'a Run>>(runs: impl Fn() -> I, base: u32, ends: &mut [u32], entries: &mut [u32]) {
    for run in runs() {
        ends[run.cells()].iter_mut().for_each(|count| *count += 1);
    }
    // From counts to beginnings, which become ends as the lists fill.
    let mut next = 0;
    for end in &mut *ends {
        (next, *end) = (next + *end, next);
    }
    for run in runs() {
        for place in &mut ends[run.cells()] {
            entries[*place as usize] = run.sphere;
            *place += 1;
        }
    }
    for end in ends {
        *end += base;
    }
}
