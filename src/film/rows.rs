//! Reading pictures row by row, in bounded memory, with the note that [`PictureWriter`](super::PictureWriter) leaves in them.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use ::png::{BitDepth, ColorType, Decoder, DecodingError, Info, Limits, Reader};

use super::problem::{Problem, ProblemKind, ReadError};
use super::read::{Kind, recognise};
use super::surplus::{SURPLUS, has_surplus};
use super::{png, ppm, sample_count};
use crate::panics;

/// What a note is called: the keyword of a PNG's text, and the first word of a PPM's comment.
pub(super) const NOTE: &str = "trueray";

/// A note has no more bytes; so many of a file can be its PPM header.
const MAX_NOTE: usize = 1 << 16;

/// Memory of the PNG decoder: some rows of the widest picture.
const DECODER_BYTES: usize = 1 << 28;

/// A picture file as [`PictureWriter`](super::PictureWriter) writes it, as P6 or PNG, whose rows are read one after another.
pub struct RowReader {
    path: PathBuf,
    size: (u32, u32),
    note: Option<String>,
    /// Why rows at the end are not there, where that is known.
    cut: Option<Problem>,
    rows: Rows,
}

enum Rows {
    P6(BufReader<File>),
    Png(Box<Reader<BufReader<File>>>),
}

impl RowReader {
    /// Opens a picture.
    ///
    /// # Errors
    /// A file that cannot be read, is another format, or whose header is damaged; a P6 file of another length than its picture has.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Self::begin(path)?.whole()
    }

    /// Likewise, also where a P6 file with a note has too few rows.
    pub(crate) fn begin(path: &Path) -> Result<Self, ReadError> {
        opened(path).map_err(|problem| ReadError { path: path.to_owned(), problem })
    }

    fn whole(self) -> Result<Self, ReadError> {
        match self.cut {
            Some(problem) => Err(ReadError { path: self.path, problem }),
            None => Ok(self),
        }
    }

    /// Width and height, both at least 1.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The note, where there is one.
    pub fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    /// Reads the next row, 3 bytes a pixel.
    ///
    /// # Errors
    /// A row that is damaged, or is not there.
    pub fn read(&mut self, row: &mut [u8]) -> Result<(), ReadError> {
        let read = match &mut self.rows {
            Rows::P6(file) => file.read_exact(row).map_err(Problem::from),
            Rows::Png(reader) => decoded(|| match reader.next_row() {
                Ok(Some(next)) if next.data().len() == row.len() => {
                    row.copy_from_slice(next.data());
                    Ok(())
                }
                Ok(_) => Err(Problem::fatal("damaged PNG: rows are missing").of_kind(ProblemKind::CutOff)),
                Err(error) => Err(damaged(&error)),
            }),
        };
        read.map_err(|problem| ReadError { path: self.path.clone(), problem })
    }

    /// Looks at what is behind the last row.
    ///
    /// # Errors
    /// A file that does not end as it should.
    pub fn finish(self) -> Result<(), ReadError> {
        let finished = match self.rows {
            // Its length is right.
            Rows::P6(_) => Ok(()),
            Rows::Png(mut reader) => {
                let ended = decoded(|| reader.finish().map_err(|error| damaged(&error)));
                ended.and_then(|()| {
                    let file = BufReader::new(File::open(&self.path)?);
                    if has_surplus(file, reader.info())? { Err(Problem::fatal(SURPLUS)) } else { Ok(()) }
                })
            }
        };
        finished.map_err(|problem| ReadError { path: self.path, problem })
    }

    /// Reads all rows that are left and what is behind them: whether the file is whole.
    ///
    /// # Errors
    /// A file that is damaged or cut off.
    pub fn check(self) -> Result<(), ReadError> {
        let mut whole = self.whole()?;
        let mut row = vec![0; whole.size.0 as usize * 3];
        for _ in 0..whole.size.1 {
            whole.read(&mut row)?;
        }
        whole.finish()
    }
}

fn opened(path: &Path) -> Result<RowReader, Problem> {
    let reader = |size, note, cut, rows| Ok(RowReader { path: path.to_owned(), size, note, cut, rows });
    let mut file = File::open(path)?;
    let mut start = Vec::new();
    file.by_ref().take(MAX_NOTE as u64 + 256).read_to_end(&mut start)?;
    // What a crash of the system can leave of a file with a note. A PPM without one may be somebody else's.
    let noted = format!("P6\n# {NOTE} ");
    let is_cut = [png::MAGIC, noted.as_bytes()].iter().any(|begin| begin.starts_with(&start))
        || start.starts_with(noted.as_bytes());
    let cut_off = |problem: Problem| problem.of_kind(if is_cut { ProblemKind::CutOff } else { ProblemKind::Damaged });
    let kind = recognise(&start).map_err(cut_off)?;
    file.seek(SeekFrom::Start(0))?;
    match kind {
        Kind::Ppm => {
            let head = ppm::Head::of(&start).map_err(cut_off)?;
            let samples = sample_count(head.width, head.height).map_err(|wrong| Problem::fatal(wrong.to_string()))?;
            let (expected, found) = ((head.raster + samples) as u64, file.metadata()?.len());
            let note = note_in(&start[..head.raster]);
            let wrong = || {
                Problem::fatal(format!("the file has {found} bytes, and its picture takes {expected}"))
                    .of_kind(ProblemKind::Damaged)
            };
            if found > expected || found < expected && note.is_none() {
                return Err(wrong());
            }
            file.seek(SeekFrom::Start(head.raster as u64))?;
            let cut = (found < expected).then(wrong);
            reader((head.width, head.height), note, cut, Rows::P6(BufReader::new(file)))
        }
        Kind::Png => {
            let decoder = Decoder::new_with_limits(BufReader::new(file), Limits { bytes: DECODER_BYTES });
            let decoder = decoded(|| decoder.read_info().map_err(|error| damaged(&error)))?;
            let info = decoder.info();
            if (info.color_type, info.bit_depth, info.interlaced) != (ColorType::Rgb, BitDepth::Eight, false) {
                let why = "the PNG has other pixels than 8-bit RGB, row by row";
                return Err(Problem::fatal(why).of_kind(ProblemKind::Unsupported));
            }
            sample_count(info.width, info.height).map_err(|wrong| Problem::fatal(wrong.to_string()))?;
            let (size, note) = ((info.width, info.height), text_in(info));
            reader(size, note, None, Rows::Png(Box::new(decoder)))
        }
    }
}

/// The note in the header of a PPM.
fn note_in(header: &[u8]) -> Option<String> {
    let lines = header.split(|byte| matches!(byte, b'\n' | b'\r')).filter_map(|line| str::from_utf8(line).ok());
    let mut notes = lines.filter_map(|line| line.strip_prefix("# ")?.strip_prefix(NOTE)?.strip_prefix(' '));
    notes.next().map(str::to_owned)
}

/// The note in a PNG.
fn text_in(info: &Info) -> Option<String> {
    let mut text = info.utf8_text.iter().find(|text| text.keyword == NOTE)?.clone();
    text.decompress_text_with_limit(MAX_NOTE).ok()?;
    text.get_text().ok().filter(|text| text.len() <= MAX_NOTE)
}

fn damaged(error: &DecodingError) -> Problem {
    let is_end = matches!(error, DecodingError::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof);
    let kind = if is_end { ProblemKind::CutOff } else { ProblemKind::Damaged };
    Problem::fatal(format!("damaged PNG: {error}")).of_kind(kind)
}

/// A decoder's panic is a damaged file like any other.
fn decoded<T>(work: impl FnOnce() -> Result<T, Problem>) -> Result<T, Problem> {
    panics::caught(work)
        .unwrap_or_else(|why| Err(Problem::fatal(format!("the decoder cannot make sense of it ({why})"))))
}
