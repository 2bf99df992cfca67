//! Text dumps of LAMMPS: items, each with its own head.
//!
//! The coordinates are `x y z`, unwrapped `xu yu zu`, or fractions of the box `xs ys zs` and `xsu ysu zsu`. The box may be
//! orthogonal, restricted triclinic (`xy xz yz`) or general triclinic (`abc origin`), as `LAMMPS` documents under `dump` and
//! `Howto_triclinic`.

use glam::{DMat3, DVec3};

use super::columns::{Columns, TextRow, XYZ, no_number};
use super::frame::Frame;
use super::options::Options;
use super::reader::Reader;
use super::source::{Source, Stop, end_of, split_blanks, stop};
use super::xyz::{skip, too_few, whole};
use crate::scene::{Collector, Detail, Line, Span, parse_number, shown};
use crate::words::count;

const UNWRAPPED: [[&str; 3]; 1] = [["xu", "yu", "zu"]];
const SCALED: [[&str; 3]; 2] = [["xs", "ys", "zs"], ["xsu", "ysu", "zsu"]];

#[derive(Debug, Default)]
pub(super) struct Lammps {
    spans: Vec<Span>,
}

/// The box: where fractions 0, 0, 0 are, and the edges.
#[derive(Debug, Clone, Copy)]
struct Cell {
    origin: DVec3,
    edges: DMat3,
}

/// How the lines of the box are to be read.
#[derive(Debug, Clone, Copy)]
enum Bounds {
    Orthogonal,
    Restricted,
    General,
}

impl Reader for Lammps {
    fn next(
        &mut self,
        source: &mut Source<'_>,
        mut frame: Option<&mut Frame>,
        options: &Options,
        log: &mut Collector,
    ) -> Result<bool, Stop> {
        source.skip_blank_lines()?;
        if source.peek()?.is_none() {
            return Ok(false);
        }
        let (mut atoms, mut cell) = (None, None);
        loop {
            let head = source.demand(log, || Detail::new("the file ends before the atoms", "expected ITEM: ATOMS"))?;
            let item = head.bytes.trim_ascii_end();
            if item.starts_with(b"ITEM: NUMBER OF ATOMS") {
                atoms = Some(number_of_atoms(source, log)?);
            } else if let Some(kind) = item.strip_prefix(b"ITEM: BOX BOUNDS") {
                let bounds = bounds_of(kind);
                cell = Some(self.cell(source, bounds, log)?);
            } else if item.starts_with(b"ITEM: ATOMS") {
                let Some(atoms) = atoms else {
                    let detail = Detail::new("atoms without their number", "expected ITEM: NUMBER OF ATOMS before");
                    return Err(stop(log, whole(head), || detail));
                };
                match &mut frame {
                    Some(frame) => self.atoms(source, atoms, cell, frame, options, log)?,
                    None => skip(source, atoms, log)?,
                }
                source.skip_blank_lines()?;
                if let Some(line) = source.peek()?.filter(|line| !line.bytes.starts_with(b"ITEM:")) {
                    return Err(stop(log, whole(line), || no_item(line.bytes.trim_ascii_end())));
                }
                return Ok(true);
            } else if item.starts_with(b"ITEM:") {
                source.demand(log, || Detail::new("the file ends within an item", "expected a value"))?;
            } else {
                return Err(stop(log, whole(head), || no_item(item)));
            }
        }
    }
}

impl Lammps {
    fn cell(&mut self, source: &mut Source<'_>, bounds: Bounds, log: &mut Collector) -> Result<Cell, Stop> {
        let fields = match bounds {
            Bounds::Orthogonal => 2,
            Bounds::Restricted => 3,
            Bounds::General => 4,
        };
        let mut rows = [[0.0; 4]; 3];
        for row in &mut rows {
            let line = source.demand(log, || Detail::new("the file ends within the box", "expected bounds"))?;
            split_blanks(line.bytes, &mut self.spans);
            if self.spans.len() != fields {
                return Err(stop(log, end_of(line), || {
                    let message = format!("{} in a bound of the box", count(self.spans.len() as u64, "field"));
                    Detail::new(message, format!("expected {fields} numbers"))
                }));
            }
            for (number, &span) in row.iter_mut().zip(&self.spans) {
                *number = parse_number(line.token(span)).map_err(|fault| {
                    stop(log, line.place(span), || no_number(line.token(span), fault, "BOX BOUNDS"))
                })?;
            }
        }
        let cell = Cell::new(bounds, rows);
        if cell.is_usable(bounds) {
            return Ok(cell);
        }
        Err(stop(log, source.end(), || {
            Detail::new(
                "a box that has no size, or is beyond what a number can hold",
                "expected upper bounds above the lower ones",
            )
        }))
    }

    fn atoms(
        &mut self,
        source: &mut Source<'_>,
        atoms: u64,
        cell: Option<Cell>,
        frame: &mut Frame,
        options: &Options,
        log: &mut Collector,
    ) -> Result<(), Stop> {
        frame.clear();
        let head = source.last();
        let text = String::from_utf8_lossy(&head.bytes[b"ITEM: ATOMS".len()..]).into_owned();
        let names: Vec<_> = text.split_ascii_whitespace().map(str::to_owned).collect();
        let has = |three: &[&str; 3]| three.iter().all(|name| names.iter().any(|other| other == name));
        let is_scaled = !XYZ.iter().chain(&UNWRAPPED).any(has) && SCALED.iter().any(has);
        let coordinates = if is_scaled { SCALED.to_vec() } else { [&XYZ[..1], &UNWRAPPED, &SCALED].concat() };
        let mut columns = Columns::of(names, &coordinates, options, whole(head), log)?;
        let cell = match (is_scaled, cell) {
            (true, None) => {
                let detail = Detail::new("fractions of a box without a box", "expected ITEM: BOX BOUNDS before");
                return Err(stop(log, whole(head), || detail));
            }
            (true, cell) => cell,
            (false, _) => None,
        };
        for done in 0..atoms {
            let line = source.demand(log, || too_few(done, atoms))?;
            split_blanks(line.bytes, &mut self.spans);
            if self.spans.len() != columns.len() {
                log.error(end_of(line), || columns.missing(self.spans.len()));
                continue;
            }
            let row = TextRow { line, spans: &self.spans };
            match cell {
                None => columns.read(&row, None, frame, log),
                Some(Cell { origin, edges }) => {
                    if let Some(fractions) = columns.coordinates(&row, log) {
                        columns.read_at(origin + edges * fractions, &row, None, frame, log);
                    }
                }
            }
        }
        Ok(())
    }
}

impl Cell {
    /// Whether every place in it has finite coordinates, and its upper bounds are above the lower ones.
    fn is_usable(&self, bounds: Bounds) -> bool {
        let DMat3 { x_axis, y_axis, z_axis } = self.edges;
        let corner = self.origin + x_axis + y_axis + z_axis;
        let is_positive = matches!(bounds, Bounds::General) || x_axis.x >= 0.0 && y_axis.y >= 0.0 && z_axis.z >= 0.0;
        corner.is_finite() && self.origin.is_finite() && self.edges.is_finite() && is_positive
    }

    fn new(bounds: Bounds, rows: [[f64; 4]; 3]) -> Self {
        let [x, y, z] = rows;
        if let Bounds::General = bounds {
            let edge = |row: [f64; 4]| DVec3::new(row[0], row[1], row[2]);
            return Self { origin: DVec3::new(x[3], y[3], z[3]), edges: DMat3::from_cols(edge(x), edge(y), edge(z)) };
        }
        // The bounds are those of the box that encloses a tilted one; the tilts are 0 where there are none.
        let [xy, xz, yz] = [x[2], y[2], z[2]];
        let least = [xy, xz, xy + xz].into_iter().fold(0.0, f64::min);
        let greatest = [xy, xz, xy + xz].into_iter().fold(0.0, f64::max);
        let origin = DVec3::new(x[0] - least, y[0] - yz.min(0.0), z[0]);
        let high = DVec3::new(x[1] - greatest, y[1] - yz.max(0.0), z[1]);
        let lengths = high - origin;
        let edges = DMat3::from_cols(
            DVec3::new(lengths.x, 0.0, 0.0),
            DVec3::new(xy, lengths.y, 0.0),
            DVec3::new(xz, yz, lengths.z),
        );
        Self { origin, edges }
    }
}

fn no_item(line: &[u8]) -> Detail<'static> {
    Detail::new(format!("`{}` is no item", shown(line)), "expected ITEM: and its name")
        .help("a frame may have more atoms than ITEM: NUMBER OF ATOMS says")
}

/// What the words behind `BOX BOUNDS` say.
fn bounds_of(kind: &[u8]) -> Bounds {
    let has = |word: &[u8]| kind.split(u8::is_ascii_whitespace).any(|other| other == word);
    if has(b"abc") {
        Bounds::General
    } else if has(b"xy") {
        Bounds::Restricted
    } else {
        Bounds::Orthogonal
    }
}

fn number_of_atoms(source: &mut Source<'_>, log: &mut Collector) -> Result<u64, Stop> {
    let line: Line<'_> = source.demand(log, || Detail::new("the file ends early", "expected the number of atoms"))?;
    let token = line.bytes.trim_ascii();
    str::from_utf8(token).ok().and_then(|text| text.parse().ok()).ok_or_else(|| {
        stop(log, whole(line), || {
            Detail::new(format!("`{}` is no number of atoms", shown(token)), "expected a whole number")
        })
    })
}
