//! Parts of a picture into its rows, in bounded memory.

use std::fmt;
use std::path::{Path, PathBuf};

use super::claim::Claim;
use super::puzzle::{Puzzle, overlap};
use crate::area::Area;
use crate::film::{ReadError, RowReader};
use crate::words::visible_path;

/// Missing rectangles that are named.
const NAMED: usize = 8;

/// Why files are no whole picture.
#[derive(Debug)]
pub enum MergeError {
    /// Rectangles that no file has.
    Missing(Vec<Area>),
    /// A file that cannot be read, is damaged or does not say what it is of; in words.
    File(String),
    /// Two files that do not go together; in words.
    Together(String),
}

impl From<ReadError> for MergeError {
    fn from(error: ReadError) -> Self {
        Self::File(error.to_string())
    }
}

impl fmt::Display for MergeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(why) | Self::Together(why) => f.write_str(why),
            Self::Missing(areas) => {
                write!(f, "the picture is not complete: no file has")?;
                for area in areas.iter().take(NAMED) {
                    write!(f, "\n  --crop {area}")?;
                }
                match areas.len().saturating_sub(NAMED) {
                    0 => Ok(()),
                    more => write!(f, "\n  and {more} more rectangles"),
                }
            }
        }
    }
}

impl std::error::Error for MergeError {}

/// Files that make a picture.
#[derive(Debug)]
pub struct Merger {
    /// By place, from the top.
    parts: Vec<(Area, PathBuf)>,
    size: (u32, u32),
}

impl Merger {
    /// From these files, each of one part; their rows are read later.
    ///
    /// # Errors
    /// What does not fit together. Pictures of different devices do only if they are certified, or with `mixed_devices`.
    pub fn new(paths: &[PathBuf], mixed_devices: bool) -> Result<Self, MergeError> {
        let claims = paths.iter().map(|path| claim_of(path)).collect::<Result<Vec<Claim>, _>>()?;
        let Some((first, others)) = claims.split_first() else { return Err(MergeError::Missing(Vec::new())) };
        let name = |index: usize| visible_path(&paths[index]);
        for (index, claim) in (1..).zip(others) {
            if let Some([field, here, there]) = first.difference(claim) {
                let (a, b) = (name(0), name(index));
                let why = format!("{b} is of another picture than {a}: {field} is {there} there and {here} in {a}");
                return Err(MergeError::Together(why));
            }
            if !mixed_devices && !first.rounds_like(claim) {
                let why = format!(
                    "{} was rendered by {}, and {} by {}: their pixels may round differently\n  help: --allow-mixed-devices takes \
                     them as they are; pictures of --precision certified have the same bytes everywhere",
                    name(0),
                    first.device,
                    name(index),
                    claim.device
                );
                return Err(MergeError::Together(why));
            }
        }
        let areas: Vec<Area> = claims.iter().map(|claim| claim.area).collect();
        if let Some([a, b]) = overlap(&areas) {
            let why = format!("{} and {} overlap: {} and {}", name(a), name(b), areas[a], areas[b]);
            return Err(MergeError::Together(why));
        }
        let missing = Puzzle::new(first.size, &areas).missing;
        if !missing.is_empty() {
            return Err(MergeError::Missing(missing));
        }
        let mut parts: Vec<_> = areas.into_iter().zip(paths.iter().cloned()).collect();
        parts.sort_unstable();
        Ok(Self { parts, size: first.size })
    }

    /// Width and height of the picture.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Hands its rows to `sink`, one after the other, 3 bytes a pixel.
    ///
    /// # Errors
    /// A file that is damaged, or no longer what it was; what `sink` says.
    pub fn rows<E: From<MergeError>>(self, mut sink: impl FnMut(&[u8]) -> Result<(), E>) -> Result<(), E> {
        let mut row = vec![0; self.size.0 as usize * 3];
        let mut waiting = self.parts.into_iter().peekable();
        let mut open: Vec<(Area, RowReader)> = Vec::new();
        for y in 0..self.size.1 {
            while let Some((area, path)) = waiting.next_if(|(area, _)| area.top == y) {
                let reader = RowReader::open(&path).map_err(MergeError::from)?;
                if reader.size() != area.size() {
                    return Err(MergeError::File(format!("{} has changed", visible_path(&path))).into());
                }
                open.push((area, reader));
            }
            for (area, reader) in &mut open {
                let part = &mut row[area.left as usize * 3..area.right() as usize * 3];
                reader.read(part).map_err(MergeError::from)?;
            }
            for (_, reader) in open.extract_if(.., |(area, _)| area.bottom() == y + 1) {
                reader.finish().map_err(MergeError::from)?;
            }
            sink(&row)?;
        }
        Ok(())
    }
}

/// What a file says of itself.
fn claim_of(path: &Path) -> Result<Claim, MergeError> {
    let reader = RowReader::open(path)?;
    let of_file = |why: &str| MergeError::File(format!("{}: {why}", visible_path(path)));
    let Some(note) = reader.note() else {
        return Err(of_file(
            "it does not say of what it is: `render --crop`, `--tile` and `--resume` write files that do",
        ));
    };
    Claim::parse(note, reader.size()).map_err(|why| of_file(&why))
}
