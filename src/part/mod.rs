//! Parts of a picture in files of their own: what each says it is of, and how they come together again.

mod claim;
mod merge;
mod puzzle;

pub use claim::{Claim, Identity};
pub use merge::{MergeError, Merger};
pub use puzzle::{Puzzle, overlap};
