//! A file, line by line, in memory for one line.

use std::io::{self, ErrorKind, Read};
use std::ops::Range;

use crate::scene::{Collector, Detail, Line, Location, Span};

/// So much is read at once.
const CHUNK: usize = 1 << 18;
/// The longest line.
const LONGEST: usize = 1 << 26;

/// Why reading cannot go on.
#[derive(Debug)]
pub(super) enum Stop {
    /// An error that has been reported.
    Reported,
    /// The file cannot be read.
    Io(io::Error),
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// Reports an error after which reading cannot go on.
pub(super) fn stop<'a>(log: &mut Collector, place: Location<'_>, detail: impl FnOnce() -> Detail<'a>) -> Stop {
    log.error(place, detail);
    Stop::Reported
}

/// A file that is read once, from its beginning.
pub(super) struct Source<'r> {
    reader: Box<dyn Read + 'r>,
    buffer: Vec<u8>,
    /// Of `buffer`, what has been read.
    filled: usize,
    /// The line that was taken last, kept for messages.
    last: Range<usize>,
    /// Where the next one begins.
    next: usize,
    /// Of the last line, from 1.
    number: usize,
    ended: bool,
}

impl<'r> Source<'r> {
    pub(super) fn new(reader: impl Read + 'r) -> Self {
        let reader = Box::new(reader);
        Self { reader, buffer: Vec::new(), filled: 0, last: 0..0, next: 0, number: 0, ended: false }
    }

    /// Takes the next line, without its end; none at the end of the file.
    pub(super) fn line(&mut self) -> io::Result<Option<Line<'_>>> {
        let Some((range, next)) = self.find_line()? else { return Ok(None) };
        (self.last, self.next) = (range, next);
        self.number += 1;
        Ok(Some(self.last()))
    }

    /// The next line, which is not taken.
    pub(super) fn peek(&mut self) -> io::Result<Option<Line<'_>>> {
        let found = self.find_line()?;
        Ok(found.map(|(range, _)| Line { number: self.number + 1, bytes: &self.buffer[range] }))
    }

    /// Takes the next line; the end of the file is an error, `missing` says what was expected.
    pub(super) fn demand<'a>(
        &mut self,
        log: &mut Collector,
        missing: impl FnOnce() -> Detail<'a>,
    ) -> Result<Line<'_>, Stop> {
        if self.peek()?.is_none() {
            return Err(stop(log, self.end(), || Detail { absent: "end of file", ..missing() }));
        }
        self.line()?.ok_or(Stop::Reported)
    }

    /// Takes lines with nothing in them.
    pub(super) fn skip_blank_lines(&mut self) -> io::Result<()> {
        while self.peek()?.is_some_and(|line| line.bytes.iter().all(u8::is_ascii_whitespace)) {
            self.line()?;
        }
        Ok(())
    }

    /// Takes exactly so many bytes; none where the file ends before.
    pub(super) fn bytes(&mut self, length: usize) -> io::Result<Option<&[u8]>> {
        self.last = self.next..self.next;
        while self.filled - self.next < length {
            if self.ended {
                return Ok(None);
            }
            self.fill()?;
        }
        let start = self.next;
        self.next += length;
        Ok(Some(&self.buffer[start..self.next]))
    }

    /// The line that was taken last.
    pub(super) fn last(&self) -> Line<'_> {
        Line { number: self.number.max(1), bytes: &self.buffer[self.last.clone()] }
    }

    /// The place behind it.
    pub(super) fn end(&self) -> Location<'_> {
        end_of(self.last())
    }

    /// Where the next line lies, and where the one after it begins.
    fn find_line(&mut self) -> io::Result<Option<(Range<usize>, usize)>> {
        let mut searched = 0;
        loop {
            let start = self.next;
            let (end, next) = match memchr::memchr(b'\n', &self.buffer[start + searched..self.filled]) {
                Some(at) => (start + searched + at, start + searched + at + 1),
                None if self.ended && start == self.filled => return Ok(None),
                None if self.ended => (self.filled, self.filled),
                None => {
                    searched = self.filled - start;
                    self.fill()?;
                    continue;
                }
            };
            let has_return = self.buffer[start..end].ends_with(b"\r");
            return Ok(Some((start..end - usize::from(has_return), next)));
        }
    }

    /// Reads on; what is before the last line goes.
    fn fill(&mut self) -> io::Result<()> {
        let gone = self.last.start;
        self.buffer.copy_within(gone..self.filled, 0);
        self.last = 0..self.last.end - gone;
        self.next -= gone;
        self.filled -= gone;
        if self.filled > LONGEST {
            return Err(io::Error::new(ErrorKind::InvalidData, "a line has more than 64 MiB"));
        }
        if self.buffer.len() < self.filled + CHUNK {
            self.buffer.resize(self.filled + 2 * CHUNK, 0);
        }
        let got = loop {
            match self.reader.read(&mut self.buffer[self.filled..]) {
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                result => break result?,
            }
        };
        self.ended = got == 0;
        self.filled += got;
        Ok(())
    }
}

/// The place behind a line's last character.
pub(super) fn end_of(line: Line<'_>) -> Location<'_> {
    let end = line.bytes.trim_ascii_end().len();
    line.place(Span { start: end, end })
}

/// The fields of a line between blanks. The list is reused from line to line.
pub(super) fn split_blanks(bytes: &[u8], spans: &mut Vec<Span>) {
    spans.clear();
    let mut at = 0;
    while let Some(start) = bytes[at..].iter().position(|byte| !byte.is_ascii_whitespace()) {
        let start = at + start;
        at = bytes[start..].iter().position(u8::is_ascii_whitespace).map_or(bytes.len(), |length| start + length);
        spans.push(Span { start, end: at });
    }
}
