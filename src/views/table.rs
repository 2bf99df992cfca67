//! A CSV file of views: a header line with the names of columns, and a line for each frame.

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::{Frame, Placement};
use crate::report::csv::{Cell, cells};
use crate::scene::{
    Collector, Detail, Fov, Line, MAX_RESOLUTION, OPPOSITE, Span, are_edges, first_line, parse_number,
    show_diagnostics, shown,
};
use crate::words::{count, slips};

/// A column of the file; its value is its place here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Column(usize);

/// The names of all columns.
const NAMES: [&str; 18] = [
    "eye_x", "eye_y", "eye_z", "at_x", "at_y", "at_z", "up_x", "up_y", "up_z", "width", "height", "near", "left",
    "right", "bottom", "top", "fov", "scene",
];
const EYE: usize = 0;
const AT: usize = 3;
const UP: usize = 6;
const SIZE: usize = 9;
const WINDOW: usize = 11;
const FOV: usize = 16;
const SCENE: usize = 17;

/// The frames of `text`. An empty cell, like a column that is not there, means what `given` has, or the scene. Paths of scenes are
/// relative to `folder`; `name` and `color` are for the report.
///
/// # Errors
///
/// A report of all that is wrong, each with line, column and token.
pub fn table(name: &str, folder: &Path, text: &[u8], given: &Placement, color: bool) -> Result<Vec<Frame>, String> {
    let mut reader = Reader { folder, given, collector: Collector::default(), columns: None, frames: Vec::new() };
    let mut rest = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    let mut line = Line { number: 1, bytes: b"" };
    let mut number = 0;
    while !rest.is_empty() {
        let (bytes, length) = first_line(rest);
        number += 1;
        line = Line { number, bytes };
        reader.line(line);
        rest = &rest[length..];
    }
    reader.finish(name, line, color)
}

struct Reader<'a> {
    folder: &'a Path,
    given: &'a Placement,
    collector: Collector,
    /// What the header has, from left to right; an unknown name is none.
    columns: Option<Vec<Option<Column>>>,
    frames: Vec<Frame>,
}

/// The cells of a row by column, those that are not empty.
type Row<'a> = [Option<(Span, &'a Cell)>; NAMES.len()];

impl Reader<'_> {
    fn error(&mut self, line: Line, span: Span, detail: Detail) {
        self.collector.error(line.place(span), || detail);
    }

    fn line(&mut self, line: Line) {
        let end = Span { start: line.bytes.len(), end: line.bytes.len() };
        if line.bytes.trim_ascii().is_empty() {
            return;
        }
        let cells = match cells(line.bytes) {
            Ok(cells) => cells,
            Err(start) => {
                let span = Span { start, end: line.bytes.len() };
                let detail = Detail::new("a quote that nothing closes", "expected a closing quote in the same line");
                return self.error(line, span, detail);
            }
        };
        let Some(columns) = self.columns.take() else {
            self.header(line, &cells);
            return;
        };
        let span = |cell: &Cell| Span { start: cell.range.start, end: cell.range.end };
        if cells.len() == columns.len() {
            let mut row: Row = [None; NAMES.len()];
            for (column, cell) in columns.iter().zip(&cells) {
                if let (Some(Column(column)), false) = (column, cell.text.is_empty()) {
                    row[*column] = Some((span(cell), cell));
                }
            }
            if let Some(frame) = self.frame(line, &row) {
                self.frames.push(frame);
            }
        } else {
            let (has, expected) = (count(cells.len() as u64, "cell"), count(columns.len() as u64, "cell"));
            let place = cells.get(columns.len()).map_or(end, span);
            let detail = Detail::new(format!("a row of {has}"), format!("expected {expected}, as the header has"));
            self.error(line, place, detail);
        }
        self.columns = Some(columns);
    }

    fn header(&mut self, line: Line, cells: &[Cell]) {
        let mut columns: Vec<Option<Column>> = Vec::new();
        for cell in cells {
            let (span, name) = (Span { start: cell.range.start, end: cell.range.end }, shown(&cell.text));
            let column = NAMES.iter().position(|known| known.as_bytes() == cell.text).map(Column);
            if column.is_some() && columns.contains(&column) {
                self.error(line, span, Detail::new(format!("a second column {name}"), "expected each column once"));
            } else if column.is_none() {
                let detail = Detail::new(format!("no column is called '{name}'"), "expected the name of a column");
                let near = NAMES.iter().find(|known| slips(&cell.text, known) <= 1);
                let all = format!("columns are {}", NAMES.join(", "));
                let help = near.map_or(all, |near| format!("did you mean {near}?"));
                self.error(line, span, detail.help(help));
            }
            columns.push(column);
        }
        self.columns = Some(columns);
    }

    fn frame(&mut self, line: Line, row: &Row) -> Option<Frame> {
        let errors = self.collector.error_count();
        let numbers: [Option<f64>; SCENE] = std::array::from_fn(|column| self.number(line, row, column));
        let vector = |first: usize, given: DVec3| {
            DVec3::from_array(std::array::from_fn(|axis| numbers[first + axis].unwrap_or(given[axis])))
        };
        let target = &row[AT..UP];
        let look_at = match (self.given.look_at, target.iter().any(Option::is_some)) {
            (Some(given), _) => Some(vector(AT, given)),
            (None, false) => None,
            (None, true) => {
                if let Some(axis) = target.iter().position(Option::is_none) {
                    let span = target.iter().flatten().next().map_or(Span { start: 0, end: 0 }, |(span, _)| *span);
                    let expected = "expected all of at_x, at_y and at_z, or none of them";
                    self.error(line, span, Detail::new(format!("{} is missing", NAMES[AT + axis]), expected));
                }
                Some(vector(AT, DVec3::ZERO))
            }
        };
        let size = [0, 1].map(|side| numbers[SIZE + side].map(|number| number as u32));
        let window = std::array::from_fn(|edge| numbers[WINDOW + edge]);
        for low in [WINDOW + 1, WINDOW + 3] {
            if let (Some(from), Some(to)) = (numbers[low], numbers[low + 1])
                && let (Some((_, first)), Some((span, second))) = (row[low], row[low + 1])
                && !are_edges(from, to)
            {
                let [first, second] = [first, second].map(|cell| shown(&cell.text));
                let message = format!("{} is '{first}' and {} is '{second}'", NAMES[low], NAMES[low + 1]);
                self.error(line, span, Detail::new(message, OPPOSITE));
            }
        }
        let fov = numbers[FOV].and_then(Fov::from_degrees).or(self.given.fov);
        if let (Some((span, _)), Some(edge)) = (row[FOV], (WINDOW + 1..FOV).find(|&edge| row[edge].is_some())) {
            let message = format!("both fov and {} say how large the window is", NAMES[edge]);
            self.error(line, span, Detail::new(message, "expected one of them"));
        }
        let scene = row[SCENE].map(|(_, cell)| self.folder.join(path(&cell.text)));
        if self.collector.error_count() > errors {
            return None;
        }
        let (eye, up, projection) = (vector(EYE, self.given.eye), vector(UP, self.given.up), self.given.projection);
        let placement = Placement { eye, look_at, up, fov, projection };
        match placement.view() {
            Ok(view) => Some(Frame { view, size, fov, window, scene }),
            Err(why) => {
                // What the row itself says of the camera, or all of it.
                let told: Vec<Span> = row[..SIZE].iter().flatten().map(|(span, _)| *span).collect();
                let start = told.iter().map(|span| span.start).min().unwrap_or_default();
                let end = told.iter().map(|span| span.end).max().unwrap_or(line.bytes.len());
                self.error(line, Span { start, end }, Detail::new(why.to_string(), "expected another view"));
                None
            }
        }
    }

    /// The number of a column, which some columns limit.
    fn number(&mut self, line: Line, row: &Row, column: usize) -> Option<f64> {
        let (span, cell) = row[column]?;
        let name = NAMES[column];
        let is_side = (SIZE..WINDOW).contains(&column);
        let is_right = |x: f64| match column {
            _ if is_side => x.fract() == 0.0 && (1.0..=f64::from(MAX_RESOLUTION)).contains(&x),
            WINDOW => x > 0.0,
            FOV => Fov::from_degrees(x).is_some(),
            _ => true,
        };
        let number = parse_number(&cell.text).ok();
        if let Some(number) = number.filter(|&number| is_right(number)) {
            return Some(number);
        }
        let what = if number.is_none() { "is no finite number" } else { "is out of range" };
        let expected = match column {
            _ if is_side => format!("expected a whole number from 1 to {MAX_RESOLUTION}"),
            WINDOW => "expected a number above 0".into(),
            FOV => "expected an angle above 0 and below 180 degrees".into(),
            _ => "expected a number".into(),
        };
        self.error(line, span, Detail::new(format!("{name} {what}: '{}'", shown(&cell.text)), expected));
        None
    }

    /// `last` is the last line.
    fn finish(mut self, name: &str, last: Line, color: bool) -> Result<Vec<Frame>, String> {
        let end = Span { start: last.bytes.len(), end: last.bytes.len() };
        let absent = |message: &str, expected: &str| Detail { absent: "end of file", ..Detail::new(message, expected) };
        if self.columns.is_none() && self.collector.error_count() == 0 {
            self.error(last, end, absent("the file has no header", "expected a line with the names of columns"));
        } else if self.frames.is_empty() && self.collector.error_count() == 0 {
            self.error(last, end, absent("the file has no frame", "expected a line for each frame"));
        }
        if self.collector.error_count() == 0 {
            return Ok(self.frames);
        }
        let (diagnostics, omitted) = self.collector.finish();
        Err(show_diagnostics(name, &diagnostics, &omitted, color))
    }
}

#[cfg(unix)]
fn path(bytes: &[u8]) -> PathBuf {
    use std::os::unix::ffi::OsStrExt;
    std::ffi::OsStr::from_bytes(bytes).into()
}

#[cfg(not(unix))]
fn path(bytes: &[u8]) -> PathBuf {
    String::from_utf8_lossy(bytes).into_owned().into()
}
