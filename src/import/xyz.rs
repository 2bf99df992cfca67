//! XYZ, plain and extended: a line with the number of atoms, a comment, a line for each atom.
//!
//! The comment of extended XYZ names the columns: `Properties=species:S:1:pos:R:3:radius:R:1`. A column of several fields is called
//! by its name and a number from 1: `forces_2`.
//!
//! Rows of plain XYZ may have numbers only: a point, or an atom whose type or atomic number is before its coordinates.

use super::columns::{Columns, TextRow, XYZ, no_number};
use super::frame::Frame;
use super::options::Options;
use super::points;
use super::reader::Reader;
use super::source::{Source, Stop, end_of, split_blanks, stop};
use crate::scene::{Collector, Detail, Line, Span, parse_number, shown};

/// The columns of plain XYZ; what follows is numbered.
const PLAIN: [&str; 4] = ["element", "x", "y", "z"];
/// The coordinates of extended XYZ.
const PROPERTIES: &[[&str; 3]] = &[["pos_1", "pos_2", "pos_3"]];
/// How many numbers a `Lattice` has.
const LATTICE: usize = 9;

#[derive(Debug, Default)]
pub(super) struct Xyz {
    spans: Vec<Span>,
}

impl Reader for Xyz {
    fn next(
        &mut self,
        source: &mut Source<'_>,
        frame: Option<&mut Frame>,
        options: &Options,
        log: &mut Collector,
    ) -> Result<bool, Stop> {
        source.skip_blank_lines()?;
        let Some(line) = source.line()? else { return Ok(false) };
        let atoms = number_of_atoms(line, log)?;
        let comment = source.demand(log, || Detail::new("the file ends before the comment", "expected a comment"))?;
        let Some(frame) = frame else {
            skip(source, atoms, log)?;
            return check_end(source, log).map(|()| true);
        };
        frame.clear();
        // The comment of `dump xyz` of LAMMPS, which writes types.
        let are_types = comment.bytes.starts_with(b"Atoms. Timestep");
        let names = properties(comment, log)?;
        let is_extended = names.is_some();
        let mut columns = match names {
            Some(names) => Some(Columns::of(names, PROPERTIES, options, whole(comment), log)?),
            None => None,
        };
        for done in 0..atoms {
            let line = source.demand(log, || too_few(done, atoms))?;
            split_blanks(line.bytes, &mut self.spans);
            let columns = if let Some(columns) = &mut columns {
                columns
            } else {
                columns.insert(Columns::of(plain(line.bytes, self.spans.len()), XYZ, options, whole(line), log)?)
            };
            if self.spans.len() < columns.len() || (is_extended && self.spans.len() > columns.len()) {
                log.error(end_of(line), || columns.missing(self.spans.len()));
                continue;
            }
            columns.read(&TextRow { line, spans: &self.spans }, None, frame, log);
        }
        if !is_extended {
            frame.decide_numbers(are_types);
        }
        check_end(source, log).map(|()| true)
    }
}

/// Takes the lines of atoms that nobody asks for.
pub(super) fn skip(source: &mut Source<'_>, atoms: u64, log: &mut Collector) -> Result<(), Stop> {
    (0..atoms).try_for_each(|done| source.demand(log, || too_few(done, atoms)).map(drop))
}

pub(super) fn too_few(done: u64, all: u64) -> Detail<'static> {
    Detail::new(format!("the file ends after {done} of {all} atoms"), "expected an atom")
}

/// The line as a place.
pub(super) fn whole(line: Line<'_>) -> crate::scene::Location<'_> {
    line.place(Span { start: 0, end: line.bytes.len() })
}

/// Behind a frame is another one, or nothing.
fn check_end(source: &mut Source<'_>, log: &mut Collector) -> Result<(), Stop> {
    source.skip_blank_lines()?;
    source.peek()?.map_or(Ok(()), |line| number_of_atoms(line, log).map(drop))
}

fn number_of_atoms(line: Line<'_>, log: &mut Collector) -> Result<u64, Stop> {
    let token = line.bytes.trim_ascii();
    let atoms = str::from_utf8(token).ok().and_then(|text| text.parse().ok());
    atoms.ok_or_else(|| {
        stop(log, whole(line), || {
            let message = format!("`{}` is no number of atoms", shown(token));
            Detail::new(message, "expected the number of atoms of the next frame")
                .help("a frame may have more lines than the number at its beginning says")
        })
    })
}

fn plain(row: &[u8], fields: usize) -> Vec<String> {
    let token = row.trim_ascii_start();
    let is_whole = token.iter().take_while(|byte| !byte.is_ascii_whitespace()).all(u8::is_ascii_digit);
    if let Some(numbers) = points::numbers(row) {
        let names = points::names(&numbers, false);
        // A whole number in the first place is a type, unless what follows is too little or looks like a colour.
        if !is_whole || fields == 3 || fields == 6 && names.iter().any(|name| name == "r") {
            return names;
        }
    }
    let rest = (PLAIN.len() + 1..=fields).map(|number| format!("column_{number}"));
    PLAIN.map(str::to_owned).into_iter().chain(rest).collect()
}

/// The names of all columns, if the comment has `Properties`.
fn properties(line: Line<'_>, log: &mut Collector) -> Result<Option<Vec<String>>, Stop> {
    if let Some(span) = value_of(line.bytes, b"Lattice") {
        check_lattice(line, span, log)?;
    }
    let Some(span) = value_of(line.bytes, b"Properties") else { return Ok(None) };
    let text = String::from_utf8_lossy(line.token(span)).into_owned();
    let parts: Vec<_> = text.split(':').collect();
    let mut names = Vec::new();
    for part in parts.chunks(3) {
        let count = |text: &str| text.parse().ok().filter(|count| (1..=1000).contains(count));
        let (name, count) = match part {
            [name, "S" | "I" | "R" | "L", fields] if count(fields).is_some() => (*name, count(fields).unwrap_or(1)),
            _ => {
                let message = format!("`{}` is no property", shown(part.join(":").as_bytes()));
                return Err(stop(log, line.place(span), || {
                    Detail::new(message, "expected NAME:TYPE:COLUMNS with the types S, I, R or L")
                }));
            }
        };
        match count {
            1 => names.push(name.to_owned()),
            _ => names.extend((1..=count).map(|number| format!("{name}_{number}"))),
        }
    }
    Ok(Some(names))
}

/// Where the value of `KEY=value` or `KEY="value"` is.
fn value_of(comment: &[u8], key: &[u8]) -> Option<Span> {
    let mut at = 0;
    loop {
        let found = at + memchr::memmem::find(&comment[at..], key)?;
        at = found + key.len();
        let is_word = found == 0 || comment[found - 1].is_ascii_whitespace();
        if !is_word || comment.get(at) != Some(&b'=') {
            continue;
        }
        let start = at + 1;
        let quoted = comment.get(start) == Some(&b'"');
        let start = start + usize::from(quoted);
        let ends = |byte: &u8| if quoted { *byte == b'"' } else { byte.is_ascii_whitespace() };
        let end = comment[start..].iter().position(ends).map_or(comment.len(), |length| start + length);
        return Some(Span { start, end });
    }
}

/// A box that is no box says that the file is not what it seems, although atoms are drawn where they are.
fn check_lattice(line: Line<'_>, span: Span, log: &mut Collector) -> Result<(), Stop> {
    let mut numbers = Vec::new();
    split_blanks(line.token(span), &mut numbers);
    for number in &numbers {
        let place = Span { start: span.start + number.start, end: span.start + number.end };
        if let Err(fault) = parse_number(line.token(place)) {
            return Err(stop(log, line.place(place), || no_number(line.token(place), fault, "Lattice")));
        }
    }
    if numbers.len() == LATTICE {
        return Ok(());
    }
    let detail = || Detail::new(format!("a lattice of {} numbers", numbers.len()), "expected 9 numbers: three vectors");
    Err(stop(log, line.place(span), detail))
}
