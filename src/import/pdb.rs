//! The Protein Data Bank's format of fixed columns: a record a line, an atom in each `ATOM` and `HETATM` record.
//!
//! Columns as in the format's version 3.3. A frame ends with `ENDMDL` or `END`.

use super::atom_name::symbol;
use super::columns::{Columns, TextRow, XYZ};
use super::elements::Element;
use super::frame::Frame;
use super::options::Options;
use super::reader::Reader;
use super::source::{Source, Stop, end_of};
use super::xyz::whole;
use crate::scene::{Collector, Detail, Line, Span, Topic, shown};

/// Names of the fields of an atom, with their first and last column from 1.
const FIELDS: [(&str, usize, usize); 13] = [
    ("serial", 7, 11),
    ("name", 13, 16),
    ("altloc", 17, 17),
    ("resname", 18, 20),
    ("chain", 22, 22),
    ("resseq", 23, 26),
    ("x", 31, 38),
    ("y", 39, 46),
    ("z", 47, 54),
    ("occupancy", 55, 60),
    ("bfactor", 61, 66),
    ("segid", 73, 76),
    ("element", ELEMENT, ELEMENT + 1),
];
const NAME: usize = 13;
/// The residue's name; programs that have names of four letters use the blank behind it.
const RESIDUE: [usize; 2] = [18, 21];
/// The last column of the coordinates.
const LAST: usize = 54;
const ELEMENT: usize = 77;

/// All records of the format but those of atoms, and some that programs add.
const RECORDS: [&str; 58] = [
    "HEADER", "OBSLTE", "TITLE", "SPLIT", "CAVEAT", "COMPND", "SOURCE", "KEYWDS", "EXPDTA", "NUMMDL", "MDLTYP",
    "AUTHOR", "REVDAT", "SPRSDE", "JRNL", "REMARK", "FTNOTE", "DBREF", "DBREF1", "DBREF2", "SEQADV", "SEQRES",
    "MODRES", "HET", "HETNAM", "HETSYN", "FORMUL", "HELIX", "SHEET", "TURN", "SSBOND", "LINK", "CISPEP", "SLTBRG",
    "HYDBND", "SITE", "CRYST1", "ORIGX1", "ORIGX2", "ORIGX3", "SCALE1", "SCALE2", "SCALE3", "MTRIX1", "MTRIX2",
    "MTRIX3", "TVECT", "MODEL", "ANISOU", "SIGATM", "SIGUIJ", "TER", "ENDMDL", "CONECT", "MASTER", "END", "USER",
    "COMMENT",
];

/// Whether a file may begin with this line.
pub(super) fn is_record(line: &[u8]) -> bool {
    let name = record(line);
    is_atom(name) || RECORDS.iter().any(|known| known.as_bytes() == name)
}

fn record(line: &[u8]) -> &[u8] {
    let name = line[..line.len().min(6)].trim_ascii_end();
    // Numbers may follow at once.
    ["REMARK", "CONECT", "ANISOU"].iter().find(|known| name == known.as_bytes()).map_or(name, |known| known.as_bytes())
}

fn is_atom(record: &[u8]) -> bool {
    record == b"ATOM" || record == b"HETATM"
}

#[derive(Debug)]
pub(super) struct Pdb;

impl Reader for Pdb {
    fn next(
        &mut self,
        source: &mut Source<'_>,
        mut frame: Option<&mut Frame>,
        options: &Options,
        log: &mut Collector,
    ) -> Result<bool, Stop> {
        let mut columns = None;
        let mut is_begun = false;
        loop {
            // A frame without its end ends before the next one.
            if is_begun && source.peek()?.is_some_and(|line| record(line.bytes) == b"MODEL") {
                return Ok(true);
            }
            let Some(line) = source.line()? else { break };
            let record = record(line.bytes);
            if !is_atom(record) {
                if is_begun && (record == b"ENDMDL" || record == b"END") {
                    return Ok(true);
                }
                if frame.is_some() && !is_record(line.bytes) && !line.bytes.trim_ascii().is_empty() {
                    log.warning(Topic::Record, whole(line), || unknown_record(record));
                }
                continue;
            }
            if !is_begun {
                is_begun = true;
                if let Some(frame) = &mut frame {
                    frame.clear();
                }
            }
            let Some(frame) = &mut frame else { continue };
            let columns = if let Some(columns) = &mut columns {
                columns
            } else {
                let names = FIELDS.map(|(name, ..)| name.to_owned()).to_vec();
                columns.insert(Columns::of(names, XYZ, options, whole(line), log)?)
            };
            if line.bytes.len() < LAST {
                log.error(end_of(line), || {
                    let message = format!("an atom's record of {} columns", line.bytes.len());
                    Detail::new(message, "expected x, y and z in the columns 31 to 54")
                });
                continue;
            }
            let spans = FIELDS.map(|(_, first, last)| field(line, first, last));
            let own = own_element(line.bytes);
            let guessed = own.is_none().then(|| {
                let [first, last] = RESIDUE;
                symbol(&line.bytes[NAME - 1..NAME + 3], line.bytes[first - 1..last].trim_ascii())
            });
            let before = frame.positions.len();
            columns.read(&TextRow { line, spans: &spans }, own.or(guessed.as_deref()), frame, log);
            let is_guess = guessed.is_some_and(|symbol| Element::of(&symbol).is_some());
            frame.guesses += u64::from(is_guess && frame.positions.len() > before);
        }
        Ok(is_begun)
    }
}

/// A field without the blanks around it.
fn field(line: Line<'_>, first: usize, last: usize) -> Span {
    let end = last.min(line.bytes.len());
    let start = (first - 1).min(end);
    let bytes = &line.bytes[start..end];
    let blanks = bytes.len() - bytes.trim_ascii_start().len();
    let start = start + blanks;
    Span { start, end: start + bytes.trim_ascii().len() }
}

/// The element that an atom's record names.
fn own_element(line: &[u8]) -> Option<&[u8]> {
    let own = line.get(ELEMENT - 1..).unwrap_or_default();
    let own = own[..own.len().min(2)].trim_ascii();
    (!own.is_empty() && Element::of(own).is_some()).then_some(own)
}

fn unknown_record(record: &[u8]) -> Detail<'static> {
    Detail::new(format!("`{}` is no record of a PDB file", shown(record)), "expected a record such as ATOM")
        .help("the line is left out")
}
