//! Whether a PNG has more pixel data than its picture: decoders stop at the last row.

use std::io::{self, ErrorKind, Read};

use flate2::{Decompress, FlushDecompress, Status};
use png::Info;

use super::png::MAGIC;

/// What is said of a file that has.
pub(super) const SURPLUS: &str = "the PNG has more pixel data than its picture";

/// Bytes that are read, and inflated, at a time.
const BUFFER: usize = 1 << 15;

/// First column and row, and steps, of each pass of an interlaced picture: Portable Network Graphics, section 8.2.
const PASSES: [[u32; 4]; 7] =
    [[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]];

/// Whether the IDAT chunks of a file hold more than its picture, inflated or behind the end of their stream. What else may be wrong
/// with them is not looked at.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn has_surplus(mut file: impl Read, info: &Info) -> io::Result<bool> {
    let mut data = PixelData {
        inflate: Decompress::new(true),
        has_ended: false,
        expected: raw_bytes(info),
        read: vec![0; BUFFER],
        inflated: vec![0; BUFFER],
    };
    io::copy(&mut file.by_ref().take(MAGIC.len() as u64), &mut io::sink())?;
    let mut head = [0; 8];
    loop {
        match file.read_exact(&mut head) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(false),
            read => read?,
        }
        let [a, b, c, d, name @ ..] = head;
        let mut chunk = file.by_ref().take(u32::from_be_bytes([a, b, c, d]).into());
        if name == *b"IEND" {
            return Ok(false);
        }
        if name == *b"IDAT" && data.goes_on_beyond_in(&mut chunk)? {
            return Ok(true);
        }
        // The rest of the chunk, and its checksum.
        io::copy(&mut chunk, &mut io::sink())?;
        io::copy(&mut file.by_ref().take(4), &mut io::sink())?;
    }
}

/// Bytes of all rows, each with its filter's.
fn raw_bytes(info: &Info) -> u64 {
    let bits = info.bits_per_pixel() as u64;
    let rows = |width: u64, height: u64| if width == 0 { 0 } else { height * (1 + (width * bits).div_ceil(8)) };
    if !info.interlaced {
        return rows(info.width.into(), info.height.into());
    }
    let steps = |size: u32, first: u32, step: u32| u64::from(size.saturating_sub(first).div_ceil(step));
    PASSES.iter().map(|&[x, y, dx, dy]| rows(steps(info.width, x, dx), steps(info.height, y, dy))).sum()
}

struct PixelData {
    inflate: Decompress,
    has_ended: bool,
    /// Bytes of the picture.
    expected: u64,
    /// What is at hand of the file, and of what it stands for.
    read: Vec<u8>,
    inflated: Vec<u8>,
}

impl PixelData {
    fn goes_on_beyond_in(&mut self, chunk: &mut impl Read) -> io::Result<bool> {
        loop {
            let length = chunk.read(&mut self.read)?;
            let mut rest = &self.read[..length];
            if rest.is_empty() {
                return Ok(false);
            }
            if self.has_ended {
                return Ok(true);
            }
            loop {
                let (taken, given) = (self.inflate.total_in(), self.inflate.total_out());
                // The decoder has judged the stream.
                let Ok(status) = self.inflate.decompress(rest, &mut self.inflated, FlushDecompress::None) else {
                    return Ok(false);
                };
                rest = &rest[(self.inflate.total_in() - taken) as usize..];
                self.has_ended = status == Status::StreamEnd;
                if self.inflate.total_out() > self.expected || self.has_ended && !rest.is_empty() {
                    return Ok(true);
                }
                let has_moved = (self.inflate.total_in(), self.inflate.total_out()) != (taken, given);
                if self.has_ended || !has_moved {
                    break;
                }
            }
        }
    }
}
