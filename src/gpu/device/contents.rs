//! What the host packs for a device, piece by piece.

use std::ops::Range;

use bytemuck::Pod;
use rayon::prelude::*;

/// Packs the elements of a range.
type Write<'a> = Box<dyn Fn(Range<usize>, &mut [u8]) + Sync + 'a>;

/// What a buffer holds: elements that are packed when and where they are needed.
pub(crate) struct Contents<'a> {
    /// Number of elements.
    count: usize,
    /// Bytes of an element.
    size: usize,
    write: Write<'a>,
}

impl<'a> Contents<'a> {
    /// `count` elements of `element` by index.
    pub(crate) fn new<T: Pod>(count: usize, element: impl Fn(usize) -> T + Sync + 'a) -> Self {
        let write = move |range: Range<usize>, bytes: &mut [u8]| {
            for (place, index) in bytes.chunks_exact_mut(size_of::<T>()).zip(range) {
                place.copy_from_slice(bytemuck::bytes_of(&element(index)));
            }
        };
        Self { count, size: size_of::<T>(), write: Box::new(write) }
    }

    /// Some of the bytes of each element.
    pub(crate) fn part<T: Pod>(count: usize, part: Range<usize>, element: impl Fn(usize) -> T + Sync + 'a) -> Self {
        let size = part.len();
        let write = move |range: Range<usize>, bytes: &mut [u8]| {
            for (place, index) in bytes.chunks_exact_mut(size).zip(range) {
                place.copy_from_slice(&bytemuck::bytes_of(&element(index))[part.clone()]);
            }
        };
        Self { count, size, write: Box::new(write) }
    }

    /// Elements of so many bytes, by their indices among those in `all`.
    pub(crate) fn gathered(all: &'a [u8], size: usize, indices: &'a [u32]) -> Self {
        let write = move |range: Range<usize>, bytes: &mut [u8]| match size {
            // A copy of a size that the compiler knows is no call.
            16 => gather::<16>(all, &indices[range], bytes),
            32 => gather::<32>(all, &indices[range], bytes),
            _ => {
                for (place, &index) in bytes.chunks_exact_mut(size).zip(&indices[range]) {
                    place.copy_from_slice(&all[index as usize * size..][..size]);
                }
            }
        };
        Self { count: indices.len(), size, write: Box::new(write) }
    }

    /// Elements that are packed already.
    pub(crate) fn packed<T: Pod + Sync>(all: &'a [T]) -> Self {
        let write = |range: Range<usize>, bytes: &mut [u8]| bytes.copy_from_slice(bytemuck::cast_slice(&all[range]));
        Self { count: all.len(), size: size_of::<T>(), write: Box::new(write) }
    }

    /// No elements.
    pub(crate) fn none() -> Self {
        Self::packed::<u8>(&[])
    }

    /// The elements of several parts, one part after another.
    pub(crate) fn joined(parts: Vec<Contents<'a>>) -> Self {
        let count = parts.iter().map(|part| part.count).sum();
        let size = parts.first().map_or(1, |part| part.size);
        let write = move |range: Range<usize>, mut bytes: &mut [u8]| {
            let mut start = 0;
            for part in &parts {
                let here = |index: usize| index.clamp(start, start + part.count) - start;
                let range = here(range.start)..here(range.end);
                let (own, rest) = bytes.split_at_mut(range.len() * size);
                (part.write)(range, own);
                bytes = rest;
                start += part.count;
            }
        };
        Self { count, size, write: Box::new(write) }
    }

    /// Bytes of all elements.
    pub(crate) fn len(&self) -> usize {
        self.count * self.size
    }

    /// Bytes of an element.
    pub(crate) fn element_size(&self) -> usize {
        self.size
    }

    /// Packs the elements whose bytes are those from `start` on; `bytes` has whole elements.
    pub(crate) fn write(&self, start: usize, bytes: &mut [u8]) {
        let first = start / self.size;
        (self.write)(first..first + bytes.len() / self.size, bytes);
    }

    /// All elements.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut bytes = vec![0; self.len()];
        let piece = self.size << 14;
        let pieces = bytes.par_chunks_mut(piece.max(1)).enumerate();
        pieces.for_each(|(index, bytes)| self.write(index * piece, bytes));
        bytes
    }
}

/// Copies elements of `N` bytes by their indices.
fn gather<const N: usize>(all: &[u8], indices: &[u32], bytes: &mut [u8]) {
    let (elements, places) = (all.as_chunks::<N>().0, bytes.as_chunks_mut::<N>().0);
    for (place, &index) in places.iter_mut().zip(indices) {
        *place = elements[index as usize];
    }
}
