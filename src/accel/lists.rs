//! Lists of spheres, one for each cell of whatever space is cut into cells.

use std::sync::atomic::{AtomicU32, Ordering};

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
    /// Hands each cell that the sphere with this rank may reach to `emit`, once; the same at every call.
    fn visit(&self, rank: usize, emit: &mut impl FnMut(usize));
}

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

    /// Bins all spheres: a counting sort in two passes, whose result does not depend on the number of threads.
    pub(super) fn build(binning: &impl Binning) -> Self {
        // More chunks than threads gain nothing, and each holds a counter for every cell.
        let chunks = rayon::current_num_threads().clamp(1, 8).min(binning.len().div_ceil(256).max(1));
        let ranks = |chunk: usize| binning.len() * chunk / chunks..binning.len() * (chunk + 1) / chunks;
        let mut starts: Vec<Vec<u32>> = (0..chunks)
            .into_par_iter()
            .map(|chunk| {
                let mut counts = vec![0_u32; binning.cells()];
                ranks(chunk).for_each(|rank| binning.visit(rank, &mut |cell| counts[cell] += 1));
                counts
            })
            .collect();
        // From counts to the places of each chunk's entries.
        let mut offsets = Vec::with_capacity(binning.cells() + 1);
        let mut total = 0;
        for cell in 0..binning.cells() {
            offsets.push(total);
            for counts in &mut starts {
                let count = counts[cell];
                counts[cell] = total;
                total += count;
            }
        }
        offsets.push(total);
        let entries: Vec<AtomicU32> = std::iter::repeat_with(AtomicU32::default).take(total as usize).collect();
        starts.into_par_iter().enumerate().for_each(|(chunk, mut next)| {
            for rank in ranks(chunk) {
                let sphere = binning.sphere(rank);
                binning.visit(rank, &mut |cell| {
                    entries[next[cell] as usize].store(sphere, Ordering::Relaxed);
                    next[cell] += 1;
                });
            }
        });
        Self { offsets, entries: entries.into_iter().map(AtomicU32::into_inner).collect() }
    }
}
