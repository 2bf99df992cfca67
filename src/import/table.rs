//! Tables: a line with the names of the columns, then a line a particle; between fields commas, tabs or semicolons.
//! Lines that begin with `#` or `//` are comments. Without names, numbers say by how many there are what they are; a comment above them
//! may name them, and a line with a whole number says how many rows follow.

use super::columns::{Columns, TextRow, XYZ};
use super::frame::Frame;
use super::options::Options;
use super::points;
use super::reader::Reader;
use super::source::{Source, Stop, end_of, stop};
use super::xyz::whole;
use crate::scene::{Collector, Detail, Span, is_statement, parse_number};
use crate::words::count;

/// What may stand between fields.
const SEPARATORS: [u8; 3] = [b'\t', b';', b','];

/// Whether a line names the columns of a table: fields of which two at least are no numbers, the first of which begins no statement
/// of a scene. Some may have no name.
pub(super) fn is_header(line: &[u8]) -> bool {
    let is_text = str::from_utf8(line).is_ok_and(|line| !line.contains(|c: char| c.is_control() && c != '\t'));
    let is_code = line.trim_ascii_start().first().is_some_and(|first| b"{[(<".contains(first));
    if !is_text || is_code {
        return false;
    }
    let mut spans = Vec::new();
    separator(line).is_some_and(|separator| {
        split_cells(line, separator, &mut spans);
        let cells = spans.iter().map(|span| &line[span.start..span.end]);
        let mut names = cells.filter(|cell| !cell.is_empty() && parse_number(cell).is_err());
        names.next().is_some_and(|first| !is_statement(first)) && names.next().is_some()
    })
}

/// Whether there is nothing in a line, or a comment.
pub(super) fn is_empty(line: &[u8]) -> bool {
    let start = line.trim_ascii_start();
    start.is_empty() || start.starts_with(b"#") || start.starts_with(b"//")
}

/// The first of the separators that the line has at all.
pub(super) fn separator(header: &[u8]) -> Option<u8> {
    SEPARATORS.into_iter().find(|separator| header.contains(separator))
}

/// The number of the rows that follow, as some programs write it before points.
fn count_in(line: &[u8]) -> Option<u64> {
    str::from_utf8(line.trim_ascii()).ok()?.parse().ok()
}

/// The names that a comment above rows of so many fields has, if it has them.
fn names_in(comment: &[u8], fields: usize) -> Option<Vec<String>> {
    let marks = comment.iter().take_while(|byte| byte.is_ascii_whitespace() || b"#/".contains(byte)).count();
    let text = &comment[marks..];
    let mut spans = Vec::new();
    [separator(text), None].into_iter().find_map(|separator| {
        points::split(text, separator, &mut spans);
        let names: Vec<_> =
            spans.iter().map(|span| String::from_utf8_lossy(&text[span.start..span.end]).into_owned()).collect();
        let has = |three: &[&str; 3]| three.iter().all(|name| names.iter().any(|other| other == name));
        (names.len() == fields && XYZ.iter().any(has)).then_some(names)
    })
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
        let mut comment = skip_comments(source)?;
        let Some(mut first) = source.peek()? else { return Ok(false) };
        let Some(frame) = frame else {
            while source.line()?.is_some() {}
            return Ok(true);
        };
        frame.clear();
        let count = count_in(first.bytes);
        if count.is_some() {
            source.line()?;
            comment = skip_comments(source)?.or(comment);
            let Some(next) = source.peek()? else { return Err(no_rows(source, log)) };
            first = next;
        }
        let separator = separator(first.bytes);
        let numbers = points::numbers(first.bytes);
        let mut columns = if let Some(numbers) = &numbers {
            let named = comment.and_then(|comment| names_in(&comment, numbers.len()));
            let names = named.unwrap_or_else(|| points::names(numbers, count.is_some()));
            Columns::of(names, XYZ, options, whole(first), log)?
        } else {
            let Some(header) = source.line()? else { return Ok(false) };
            points::split(header.bytes, separator, &mut self.spans);
            let name = |(number, span): (usize, &Span)| match header.token(*span) {
                b"" => format!("column_{number}"),
                name => String::from_utf8_lossy(name).into_owned(),
            };
            Columns::of((1..).zip(&self.spans).map(name).collect(), XYZ, options, whole(header), log)?
        };
        let mut rows = 0;
        while let Some(line) = source.line()? {
            if is_empty(line.bytes) {
                continue;
            }
            if count == Some(rows) {
                return Err(stop(log, whole(line), || too_many(rows)));
            }
            rows += 1;
            points::split(line.bytes, separator, &mut self.spans);
            if self.spans.len() == columns.len() {
                columns.read(&TextRow { line, spans: &self.spans }, None, frame, log);
            } else {
                log.error(end_of(line), || columns.missing(self.spans.len()));
            }
        }
        match count {
            Some(all) if rows < all => Err(stop(log, source.end(), || too_few(rows, all))),
            _ if rows == 0 => Err(no_rows(source, log)),
            _ => Ok(true),
        }
    }
}

/// Takes empty lines and comments, and gives the last comment.
fn skip_comments(source: &mut Source<'_>) -> Result<Option<Vec<u8>>, Stop> {
    let mut last = None;
    while source.peek()?.is_some_and(|line| is_empty(line.bytes)) {
        last = source.line()?.map(|line| line.bytes.to_vec()).filter(|line| !line.trim_ascii().is_empty()).or(last);
    }
    Ok(last)
}

fn no_rows(source: &Source<'_>, log: &mut Collector) -> Stop {
    stop(log, source.end(), || Detail::new("a table without rows", "expected a row of numbers"))
}

fn too_few(rows: u64, all: u64) -> Detail<'static> {
    let message = format!("the file ends after {rows} of {}", count(all, "point"));
    Detail { absent: "end of file", ..Detail::new(message, "expected a point") }
}

fn too_many(all: u64) -> Detail<'static> {
    let message = format!("the file goes on behind {}", count(all, "point"));
    Detail::new(message, "expected the end of the file")
        .help("the number above the points says how many there are; with a comment below it, the file would be XYZ")
}

/// The cells of a line without blanks and quotes around them.
pub(super) fn split_cells(line: &[u8], separator: u8, spans: &mut Vec<Span>) {
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
