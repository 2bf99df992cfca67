//! Reading PPM, as binary (P6) and as text (P3).
//!
//! The rules are Netpbm's: a comment runs from `#` to the line feed or carriage return that ends its line and stands for
//! that one; it may be anywhere before a P6 raster, also right after the maximum, and anywhere in P3. Lines may be longer
//! than the 70 characters that writers should keep to.

use super::problem::{FilePosition, Problem, ProblemKind, SamplePosition, Warning};
use super::read::{Leniency, Reading};
use super::{Picture, sample_count};
use crate::words::count;

/// The most samples that a lenient reading makes up: a header alone must not decide how much memory is used.
const MAX_MADE_UP: usize = 1 << 26;

/// Width and height as the header has them.
pub(super) fn size(bytes: &[u8]) -> Result<(u32, u32), Problem> {
    Header::read(&mut Scanner { bytes, at: 0, line: 1 }).map(|header| (header.width, header.height))
}

/// What there is to know before the samples of a P6 file with a byte for each.
pub(super) struct Head {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Where its samples begin.
    pub(super) raster: usize,
}

impl Head {
    /// From the start of a file.
    pub(super) fn of(start: &[u8]) -> Result<Self, Problem> {
        let mut scanner = Scanner { bytes: start, at: 0, line: 1 };
        let header = Header::read(&mut scanner)?;
        if header.plain || header.maximum != 255 {
            let why = "the PPM is no P6 with samples up to 255";
            return Err(Problem::fatal(why).of_kind(ProblemKind::Unsupported));
        }
        Ok(Self { width: header.width, height: header.height, raster: scanner.at })
    }
}

pub(super) fn decode(bytes: Vec<u8>, leniency: Leniency) -> Result<Reading, Problem> {
    let mut scanner = Scanner { bytes: &bytes, at: 0, line: 1 };
    let header = Header::read(&mut scanner)?;
    if header.maximum > 255 && leniency == Leniency::Strict {
        let message = format!("samples up to {} take 16 bits; pictures here have 8 bits a channel", header.maximum);
        return Err(Problem::mendable(message).of_kind(ProblemKind::Unsupported));
    }
    let mut tally = Tally { header: &header, leniency, warnings: Vec::new(), clamped: None };
    let rgb = if header.plain {
        plain_samples(&mut scanner, &mut tally)?
    } else {
        let raster = scanner.at;
        binary_samples(bytes, raster, &mut tally)?
    };
    let warnings = tally.into_warnings();
    let picture = Picture::assemble(header.width, header.height, rgb);
    Ok(Reading { picture, warnings, color_spaces: Vec::new() })
}

struct Header {
    plain: bool,
    width: u32,
    height: u32,
    maximum: u32,
    samples: usize,
}

impl Header {
    fn read(scanner: &mut Scanner) -> Result<Self, Problem> {
        let plain = scanner.bytes.get(1) == Some(&b'3');
        scanner.at = 2;
        if scanner.peek().is_some_and(|byte| !ends_token(byte)) {
            return Err(header_error(1, "white space must follow the P3 or P6"));
        }
        let (width, line) = scanner.header_number("width")?;
        let (height, _) = scanner.header_number("height")?;
        let samples = sample_count(width, height).map_err(|wrong| header_error(line, &wrong.to_string()))?;
        let (maximum, line) = scanner.header_number("maximum")?;
        if !(1..=65535).contains(&maximum) {
            return Err(header_error(line, &format!("the maximum is {maximum}; it must be 1 to 65535")));
        }
        if !plain {
            // Exactly one byte of white space, be it that of a comment: the next may already be a sample.
            if scanner.peek() == Some(b'#') {
                scanner.skip_comment();
            }
            scanner.at = (scanner.at + 1).min(scanner.bytes.len());
        }
        Ok(Self { plain, width, height, maximum, samples })
    }

    fn position(&self, index: usize) -> SamplePosition {
        SamplePosition::new(index as u64, self.width)
    }

    /// What is wrong with a sample, in words.
    fn wrong_sample(&self, place: FilePosition, index: usize, found: &str) -> String {
        let (sample, maximum) = (self.position(index), self.maximum);
        format!("{place}: {sample} is {found}; samples are whole numbers from 0 to {maximum}")
    }

    /// A sample in range, from 0…maximum to 0…255.
    fn scale(&self, value: u32, leniency: Leniency) -> u8 {
        if self.maximum == 255 { value as u8 } else { leniency.level(value, self.maximum) }
    }
}

fn header_error(line: u64, message: &str) -> Problem {
    Problem::fatal(format!("line {line}: {message}"))
}

/// C's `isspace` knows it, Rust's `is_ascii_whitespace` does not.
const VERTICAL_TAB: u8 = 0x0b;

fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == VERTICAL_TAB
}

fn ends_token(byte: u8) -> bool {
    is_space(byte) || byte == b'#'
}

/// Walks through text, token by token.
struct Scanner<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u64,
}

impl<'a> Scanner<'a> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// The next run of characters that are neither white space nor comment, with `line` being the one it stands on.
    fn token(&mut self) -> Option<&'a [u8]> {
        self.skip_blank();
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|&byte| ends_token(byte)).unwrap_or(rest.len());
        self.at += length;
        (length > 0).then(|| &rest[..length])
    }

    fn skip_blank(&mut self) {
        while let Some(byte) = self.peek() {
            match byte {
                b'\n' => self.line += 1,
                b'\r' if self.bytes.get(self.at + 1) != Some(&b'\n') => self.line += 1,
                b'#' => {
                    self.skip_comment();
                    continue;
                }
                _ if is_space(byte) => {}
                _ => return,
            }
            self.at += 1;
        }
    }

    /// From `#` to before the end of its line.
    fn skip_comment(&mut self) {
        let rest = &self.bytes[self.at..];
        self.at += memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
    }

    fn header_number(&mut self, name: &str) -> Result<(u32, u64), Problem> {
        let Some(token) = self.token() else {
            let ends = header_error(self.line, &format!("the file ends where the {name} should stand"));
            return Err(ends.of_kind(ProblemKind::CutOff));
        };
        match number(token) {
            Number::Value(value) => Ok((value, self.line)),
            Number::Negative | Number::Huge | Number::None => {
                let message = format!("the {name} is {}; it must be a whole number", excerpt(token));
                Err(header_error(self.line, &message))
            }
        }
    }
}

enum Number {
    Value(u32),
    /// A whole number below zero.
    Negative,
    /// A whole number above `u32`'s.
    Huge,
    /// No whole number.
    None,
}

fn number(token: &[u8]) -> Number {
    let (negative, digits) = match token {
        [b'-', digits @ ..] => (true, digits),
        digits => (false, digits),
    };
    if digits.is_empty() || !digits.iter().all(u8::is_ascii_digit) {
        return Number::None;
    }
    let value = digits.iter().try_fold(0_u32, |value, digit| value.checked_mul(10)?.checked_add((digit - b'0') as u32));
    match (negative, value) {
        (_, Some(0)) => Number::Value(0),
        (true, _) => Number::Negative,
        (false, Some(value)) => Number::Value(value),
        (false, None) => Number::Huge,
    }
}

/// A token for a message: numbers as they are, all else quoted, nothing longer than a glance.
fn excerpt(token: &[u8]) -> String {
    const LONGEST: usize = 20;
    let text: String = token.iter().take(LONGEST).flat_map(|&byte| byte.escape_ascii()).map(char::from).collect();
    let dots = if token.len() > LONGEST { "..." } else { "" };
    if matches!(number(token), Number::None) { format!("`{text}{dots}`") } else { format!("{text}{dots}") }
}

/// Decides about each irregularity: an error, or a warning.
struct Tally<'a> {
    header: &'a Header,
    leniency: Leniency,
    warnings: Vec<Warning>,
    clamped: Option<Warning>,
}

impl Tally<'_> {
    /// Called for a whole number out of range.
    fn out_of_range(&mut self, place: FilePosition, index: usize, found: String) -> Result<(), Problem> {
        if self.leniency == Leniency::Strict {
            return Err(Problem::mendable(self.header.wrong_sample(place, index, &found)));
        }
        let sample = self.header.position(index);
        match &mut self.clamped {
            Some(Warning::Clamped { count, .. }) => *count += 1,
            _ => self.clamped = Some(Warning::Clamped { count: 1, place, sample, found }),
        }
        Ok(())
    }

    /// Called at the end of the file with the samples found; makes up the missing ones.
    fn complete(&mut self, rgb: &mut Vec<u8>, place: FilePosition) -> Result<(), Problem> {
        let expected = self.header.samples;
        let count = expected - rgb.len();
        if count == 0 {
            return Ok(());
        }
        let first = self.header.position(rgb.len());
        if self.leniency == Leniency::Strict {
            let found = rgb.len();
            let message = format!("{place}: the file ends after {found} of {expected} samples; {first} is missing");
            return Err(Problem::mendable(message).of_kind(ProblemKind::CutOff));
        }
        if count > MAX_MADE_UP {
            return Err(Problem::too_large(self.header.width, self.header.height));
        }
        rgb.resize(expected, 0);
        self.warnings.push(Warning::Missing { count: count as u64, first });
        Ok(())
    }

    /// Called for data after the last sample.
    fn trailing(&mut self, place: FilePosition, bytes: usize, found: &str) -> Result<(), Problem> {
        if self.leniency == Leniency::Strict {
            let expected = self.header.samples;
            return Err(Problem::mendable(format!("{place}: unexpected {found} after the last of {expected} samples")));
        }
        self.warnings.push(Warning::Trailing { bytes: bytes as u64 });
        Ok(())
    }

    fn into_warnings(self) -> Vec<Warning> {
        let scaled = (self.header.maximum != 255).then_some(Warning::Scaled { maximum: self.header.maximum });
        scaled.into_iter().chain(self.clamped).chain(self.warnings).collect()
    }
}

fn plain_samples(scanner: &mut Scanner, tally: &mut Tally) -> Result<Vec<u8>, Problem> {
    let header = tally.header;
    // A sample takes a digit and a blank, so the file's length bounds the memory.
    let mut rgb = Vec::with_capacity(header.samples.min((scanner.bytes.len() - scanner.at) / 2 + 1));
    while rgb.len() < header.samples {
        let Some(token) = scanner.token() else { break };
        rgb.push(plain_sample(token, FilePosition::Line(scanner.line), rgb.len(), tally)?);
    }
    tally.complete(&mut rgb, FilePosition::Line(scanner.line))?;
    if let Some(token) = scanner.token() {
        let bytes = scanner.bytes.len() - (scanner.at - token.len());
        tally.trailing(FilePosition::Line(scanner.line), bytes, &excerpt(token))?;
    }
    Ok(rgb)
}

fn plain_sample(token: &[u8], place: FilePosition, index: usize, tally: &mut Tally) -> Result<u8, Problem> {
    let header = tally.header;
    let value = match number(token) {
        Number::Value(value) if value <= header.maximum => return Ok(header.scale(value, tally.leniency)),
        Number::Value(_) | Number::Huge => header.maximum,
        Number::Negative => 0,
        Number::None => {
            return Err(Problem::fatal(header.wrong_sample(place, index, &excerpt(token))));
        }
    };
    tally.out_of_range(place, index, excerpt(token))?;
    Ok(header.scale(value, tally.leniency))
}

fn binary_samples(mut bytes: Vec<u8>, mut raster: usize, tally: &mut Tally) -> Result<Vec<u8>, Problem> {
    let header = tally.header;
    let sample_bytes = if header.maximum > 255 { 2 } else { 1 };
    let size = header.samples.saturating_mul(sample_bytes);
    let length = bytes.len();
    if has_cr_lf_header(&bytes, raster, size) {
        if tally.leniency == Leniency::Strict {
            let why = "the header ends in CR LF where one byte is allowed (written in text mode?)";
            return Err(Problem::mendable(why));
        }
        raster += 1;
        tally.warnings.push(Warning::CrLfHeader);
    }
    let end = raster.saturating_add(size);
    if length > end {
        let excess = length - end;
        tally.trailing(FilePosition::Byte(end as u64), excess, &format!("data ({})", count(excess as u64, "byte")))?;
        bytes.truncate(end);
    }
    if header.maximum == 255 {
        bytes.drain(..raster); // in place: a picture may take half the memory there is
    } else {
        bytes = scaled_samples(&bytes, raster, sample_bytes, tally)?;
    }
    tally.complete(&mut bytes, FilePosition::Byte(length as u64))?;
    Ok(bytes)
}

/// Whether a writer in text mode ended the header with two bytes, so that the raster is one byte longer than it should be.
fn has_cr_lf_header(bytes: &[u8], raster: usize, size: usize) -> bool {
    raster.checked_add(size).and_then(|end| end.checked_add(1)) == Some(bytes.len())
        && bytes[..raster].last() == Some(&b'\r')
        && bytes[raster] == b'\n'
}

/// The samples of a raster whose maximum is not 255; an incomplete last one counts as missing.
fn scaled_samples(bytes: &[u8], raster: usize, sample_bytes: usize, tally: &mut Tally) -> Result<Vec<u8>, Problem> {
    let header = tally.header;
    let mut rgb = Vec::with_capacity((bytes.len() - raster) / sample_bytes);
    for (index, sample) in bytes[raster..].chunks_exact(sample_bytes).enumerate() {
        let value = sample.iter().fold(0, |value, &byte| value << 8 | byte as u32);
        if value > header.maximum {
            let offset = raster + index * sample_bytes;
            tally.out_of_range(FilePosition::Byte(offset as u64), index, value.to_string())?;
        }
        rgb.push(header.scale(value.min(header.maximum), tally.leniency));
    }
    Ok(rgb)
}
