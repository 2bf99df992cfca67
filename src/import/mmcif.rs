//! The atoms of mmCIF: the loop of `_atom_site`, a row an atom. A frame ends where the number of the model changes.

use super::columns::{Columns, TextRow};
use super::frame::Frame;
use super::options::Options;
use super::reader::Reader;
use super::source::{Source, Stop, end_of, stop};
use super::xyz::whole;
use crate::scene::{Collector, Detail, Span};

const CATEGORY: &[u8] = b"_atom_site.";
/// How the dictionary for small molecules begins the names of coordinates in the cell.
const FRACTIONS: &[u8] = b"_atom_site_fract_";
const COORDINATES: &[[&str; 3]] = &[["Cartn_x", "Cartn_y", "Cartn_z"]];
const MODEL: &str = "pdbx_PDB_model_num";

#[derive(Debug, Default)]
pub(super) struct Mmcif {
    spans: Vec<Span>,
    /// The names of the loop that is being read.
    names: Vec<String>,
}

impl Reader for Mmcif {
    fn next(
        &mut self,
        source: &mut Source<'_>,
        mut frame: Option<&mut Frame>,
        options: &Options,
        log: &mut Collector,
    ) -> Result<bool, Stop> {
        if self.names.is_empty() && !self.find_loop(source, log)? {
            return Ok(false);
        }
        let model_column = self.names.iter().position(|name| name == MODEL);
        let mut model: Option<Vec<u8>> = None;
        let mut columns = None;
        let mut is_begun = false;
        while let Some(line) = source.peek()?.filter(|line| is_row(line.bytes) || is_empty(line.bytes)) {
            // Loops may have comments in them.
            if is_empty(line.bytes) {
                source.line()?;
                continue;
            }
            split_values(line.bytes, &mut self.spans);
            if let (Some(column), true) = (model_column, self.spans.len() == self.names.len()) {
                let number = line.token(self.spans[column]);
                if model.as_deref().is_some_and(|model| model != number) {
                    return Ok(true);
                }
                if model.is_none() {
                    model = Some(number.to_vec());
                }
            }
            let Some(line) = source.line()? else { break };
            if !is_begun {
                is_begun = true;
                if let Some(frame) = &mut frame {
                    frame.clear();
                    columns = Some(Columns::of(self.names.clone(), COORDINATES, options, whole(line), log)?);
                }
            }
            if self.spans.len() != self.names.len() {
                log.error(end_of(line), || {
                    let message = format!("{} values in a row of {}", self.spans.len(), self.names.len());
                    Detail::new(message, "expected a row of _atom_site, all of it in one line")
                });
            } else if let (Some(columns), Some(frame)) = (&mut columns, &mut frame) {
                columns.read(&TextRow { line, spans: &self.spans }, None, frame, log);
            }
        }
        self.names.clear();
        if is_begun {
            return Ok(true);
        }
        Err(stop(log, source.end(), || Detail::new("no row of _atom_site", "expected atoms")))
    }
}

impl Mmcif {
    /// Takes all that is before the rows of the next loop of atoms; whether there is one.
    fn find_loop(&mut self, source: &mut Source<'_>, log: &mut Collector) -> Result<bool, Stop> {
        let mut in_text = false;
        let mut in_loop = false;
        while let Some(line) = source.peek()? {
            let bytes = line.bytes.trim_ascii();
            if line.bytes.starts_with(b";") {
                in_text = !in_text;
            } else if !in_text {
                if bytes.starts_with(FRACTIONS) {
                    let Some(line) = source.line()? else { break };
                    return Err(stop(log, whole(line), || {
                        Detail::new("fractional coordinates are not read", "expected _atom_site.Cartn_x")
                            .help("other programs write such a crystal as XYZ: `ase convert crystal.cif crystal.xyz`")
                    }));
                }
                if let Some(name) = bytes.strip_prefix(CATEGORY) {
                    if !in_loop {
                        let Some(line) = source.line()? else { break };
                        return Err(stop(log, whole(line), || {
                            Detail::new("_atom_site is no loop", "expected loop_ before its names")
                        }));
                    }
                    self.names.push(String::from_utf8_lossy(name.trim_ascii()).into_owned());
                } else if !self.names.is_empty() && !is_empty(bytes) {
                    return Ok(true);
                }
                let keeps = bytes.starts_with(b"_") || is_empty(bytes);
                in_loop = bytes.eq_ignore_ascii_case(b"loop_") || in_loop && keeps;
            }
            source.line()?;
        }
        Ok(!self.names.is_empty())
    }
}

/// Whether a line has nothing but a comment.
fn is_empty(line: &[u8]) -> bool {
    matches!(line.trim_ascii_start(), [] | [b'#', ..])
}

/// Whether a loop goes on with this line.
fn is_row(line: &[u8]) -> bool {
    let start = line.trim_ascii_start();
    let ends = |word: &[u8]| start.get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word));
    !(is_empty(line) || start.starts_with(b"_") || ends(b"loop_") || ends(b"data_"))
}

/// The values of a line: words, or text in quotes that end before a blank.
fn split_values(line: &[u8], spans: &mut Vec<Span>) {
    spans.clear();
    let mut at = 0;
    while let Some(start) = line[at..].iter().position(|byte| !byte.is_ascii_whitespace()) {
        let start = at + start;
        let quote = line[start];
        if quote == b'#' {
            return;
        }
        if matches!(quote, b'\'' | b'"') {
            let inner = start + 1;
            let is_end =
                |&index: &usize| line[index] == quote && line.get(index + 1).is_none_or(u8::is_ascii_whitespace);
            let end = (inner..line.len()).find(is_end).unwrap_or(line.len());
            spans.push(Span { start: inner, end });
            at = (end + 1).min(line.len());
        } else {
            at = line[start..].iter().position(u8::is_ascii_whitespace).map_or(line.len(), |length| start + length);
            spans.push(Span { start, end: at });
        }
    }
}
