//! Tables: a line with the names of the columns, then a line a particle; between fields commas, tabs or semicolons.
//! Lines that begin with `#` are comments.

use super::columns::{Columns, TextRow, XYZ};
use super::frame::Frame;
use super::options::Options;
use super::reader::Reader;
use super::source::{Source, Stop, end_of, stop};
use super::xyz::whole;
use crate::scene::{Collector, Detail, Span, is_statement, parse_number};

/// What may stand between fields.
const SEPARATORS: [u8; 3] = [b'\t', b';', b','];
/// A table has at least so many columns.
const LEAST: usize = 3;

/// Whether a line names the columns of a table: fields that are no numbers, the first of which begins no statement of a scene.
pub(super) fn is_header(line: &[u8]) -> bool {
    let is_text = str::from_utf8(line).is_ok_and(|line| !line.contains(|c: char| c.is_control() && c != '\t'));
    let is_code = line.trim_ascii_start().first().is_some_and(|first| b"{[(<".contains(first));
    if !is_text || is_code {
        return false;
    }
    let mut spans = Vec::new();
    separator(line).is_some_and(|separator| {
        split_cells(line, separator, &mut spans);
        let cell = |span: &Span| &line[span.start..span.end];
        let is_name = |span: &Span| !cell(span).is_empty() && parse_number(cell(span)).is_err();
        spans.len() >= LEAST && spans.iter().all(is_name) && !is_statement(cell(&spans[0]))
    })
}

/// Whether there is nothing in a line, or a comment.
pub(super) fn is_empty(line: &[u8]) -> bool {
    line.trim_ascii_start().first().is_none_or(|&first| first == b'#')
}

/// The first of the separators that the line has at all.
fn separator(header: &[u8]) -> Option<u8> {
    SEPARATORS.into_iter().find(|separator| header.contains(separator))
}

#[derive(Debug, Default)]
pub(super) struct Table {
    spans: Vec<Span>,
}

impl Reader for Table {
    fn next(
        &mut self,
        source: &mut Source<'_>,
        frame: Option<&mut Frame>,
        options: &Options,
        log: &mut Collector,
    ) -> Result<bool, Stop> {
        while source.peek()?.is_some_and(|line| is_empty(line.bytes)) {
            source.line()?;
        }
        let Some(header) = source.line()? else { return Ok(false) };
        let Some(frame) = frame else {
            while source.line()?.is_some() {}
            return Ok(true);
        };
        frame.clear();
        let separator = separator(header.bytes).unwrap_or(b',');
        split_cells(header.bytes, separator, &mut self.spans);
        let name = |span: &Span| String::from_utf8_lossy(header.token(*span)).into_owned();
        let names = self.spans.iter().map(name).collect();
        let mut columns = Columns::of(names, XYZ, options, whole(header), log)?;
        while let Some(line) = source.line()? {
            if is_empty(line.bytes) {
                continue;
            }
            split_cells(line.bytes, separator, &mut self.spans);
            if self.spans.len() == columns.len() {
                columns.read(&TextRow { line, spans: &self.spans }, None, frame, log);
            } else {
                log.error(end_of(line), || columns.missing(self.spans.len()));
            }
        }
        if frame.positions.is_empty() {
            return Err(stop(log, source.end(), || Detail::new("a table without rows", "expected a row of numbers")));
        }
        Ok(true)
    }
}

/// The cells of a line without blanks and quotes around them.
fn split_cells(line: &[u8], separator: u8, spans: &mut Vec<Span>) {
    spans.clear();
    let mut start = 0;
    loop {
        let first = line[start..].iter().position(|&byte| byte == separator || !byte.is_ascii_whitespace());
        let quoted = first.is_some_and(|first| line[start + first] == b'"');
        let searched = if quoted {
            // The quote's end is the next quote that is not doubled.
            let mut at = start + first.unwrap_or(0) + 1;
            while let Some(next) = memchr::memchr(b'"', &line[at..]) {
                at += next + 1;
                if line.get(at) != Some(&b'"') {
                    break;
                }
                at += 1;
            }
            at
        } else {
            start
        };
        let end = memchr::memchr(separator, &line[searched..]).map_or(line.len(), |length| searched + length);
        spans.push(trimmed(line, start, end, quoted));
        if end == line.len() {
            return;
        }
        start = end + 1;
    }
}

fn trimmed(line: &[u8], start: usize, end: usize, quoted: bool) -> Span {
    let bytes = &line[start..end];
    let start = start + bytes.len() - bytes.trim_ascii_start().len();
    let span = Span { start, end: start + bytes.trim_ascii().len() };
    let is_whole = quoted && span.end - span.start >= 2 && line[span.end - 1] == b'"';
    if is_whole { Span { start: span.start + 1, end: span.end - 1 } } else { span }
}
