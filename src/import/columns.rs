//! Which column of a file is what, and one row of it.

use std::borrow::Cow;

use glam::DVec3;

use super::color::hex_of;
use super::frame::Frame;
use super::options::{ByColumn, Coloring, Map, Options, Radius};
use super::source::{Stop, stop};
use crate::scene::{Collector, Detail, Fault, Line, Location, Span, Topic, parse_number, shown};
use crate::words::count;

/// Coordinates beyond this are no lengths.
const MOST: f64 = 1e100;
/// Radii below this are none.
const LEAST_RADIUS: f64 = 1e-100;

/// The greatest level of a colour that is not 0 to 1.
pub(super) const LEVELS: f64 = 255.0;

/// The coordinates of most files.
pub(super) const XYZ: &[[&str; 3]] = &[
    ["x", "y", "z"],
    ["X", "Y", "Z"],
    ["pos_x", "pos_y", "pos_z"],
    ["position_x", "position_y", "position_z"],
    ["Points:0", "Points:1", "Points:2"],
];
/// Names for chemical elements.
const ELEMENTS: [&str; 5] = ["element", "species", "type_symbol", "symbol", "elem"];
/// Names for types of particles.
const TYPES: [&str; 2] = ["type", "atom_type"];
const COLORS: [[&str; 3]; 5] = [
    ["r", "g", "b"],
    ["red", "green", "blue"],
    ["diffuse_red", "diffuse_green", "diffuse_blue"],
    ["color_r", "color_g", "color_b"],
    ["color_1", "color_2", "color_3"],
];

/// A row of a file.
pub(super) trait Row {
    /// The field of a column.
    fn token(&self, column: usize) -> Cow<'_, [u8]>;

    /// Where it is.
    fn place(&self, column: usize) -> Location<'_>;

    /// It as a number.
    fn number(&self, column: usize) -> Result<f64, Fault> {
        parse_number(&self.token(column))
    }
}

/// A row of text.
#[derive(Clone, Copy)]
pub(super) struct TextRow<'a> {
    pub(super) line: Line<'a>,
    pub(super) spans: &'a [Span],
}

impl Row for TextRow<'_> {
    fn token(&self, column: usize) -> Cow<'_, [u8]> {
        self.line.token(self.spans[column]).into()
    }

    fn place(&self, column: usize) -> Location<'_> {
        self.line.place(self.spans[column])
    }
}

/// What a column is for, beside coordinates.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Element(usize),
    Type(usize),
}

/// Which columns are used, by their places in a row.
#[derive(Debug)]
pub(super) struct Columns {
    position: [usize; 3],
    kind: Option<Kind>,
    /// With 0.5 for a diameter, else 1.
    radius: Option<(usize, f64)>,
    color: Option<[usize; 3]>,
    hex: Option<usize>,
    value: Option<usize>,
    /// Whether values are words; unknown before the first row.
    has_words: Option<bool>,
    names: Vec<String>,
}

impl Columns {
    /// The columns that are used of those with these names, which are at `place`.
    pub(super) fn of(
        names: Vec<String>,
        coordinates: &[[&str; 3]],
        options: &Options,
        place: Location<'_>,
        log: &mut Collector,
    ) -> Result<Self, Stop> {
        let columns = Self::choose(names, coordinates, options).map_err(|detail| stop(log, place, || *detail))?;
        match columns.ambiguous() {
            None => Ok(columns),
            Some(name) => Err(stop(log, second(place, name), || {
                let message = format!("a second column `{}`, and one of them is used", shown(name.as_bytes()));
                Detail::new(message, format!("expected each column once: {}", listed(&columns.names)))
            })),
        }
    }

    /// The first name of a column that is used and that is not the only one of this name.
    fn ambiguous(&self) -> Option<&str> {
        let kind = self.kind.map(|(Kind::Element(column) | Kind::Type(column))| column);
        let single = [kind, self.radius.map(|(column, _)| column), self.hex, self.value].into_iter().flatten();
        let names = self.position.into_iter().chain(self.color.into_iter().flatten()).chain(single);
        let mut names = names.map(|column| &self.names[column]);
        names.find(|name| self.names.iter().filter(|other| other == name).count() > 1).map(String::as_str)
    }

    fn choose(names: Vec<String>, coordinates: &[[&str; 3]], options: &Options) -> Result<Self, Box<Detail<'static>>> {
        let at = |name: &str| names.iter().position(|other| other == name);
        let any_case = |name: &str| names.iter().position(|other| other.eq_ignore_ascii_case(name));
        let all = |three: &[&str; 3], find: &dyn Fn(&str) -> Option<usize>| -> Option<[usize; 3]> {
            Some([find(three[0])?, find(three[1])?, find(three[2])?])
        };
        let wanted = |name: &str, option: &str| {
            at(name).or_else(|| any_case(name)).ok_or_else(|| {
                let message = format!("there is no column `{}`, which {option} names", shown(name.as_bytes()));
                Box::new(Detail::new(message, format!("the columns are {}", listed(&names))))
            })
        };
        let position = coordinates.iter().find_map(|three| all(three, &at)).ok_or_else(|| {
            let choice: Vec<_> = coordinates.iter().map(|three| three.join(", ")).collect();
            let message = format!("no columns of coordinates among {}", listed(&names));
            Box::new(Detail::new(message, format!("expected {}", choice.join(" or "))))
        })?;
        let color = COLORS.iter().find_map(|three| all(three, &any_case));
        let radius = match &options.radius {
            Radius::Column(name) => Some((wanted(name, "--radius")?, 1.0)),
            Radius::Auto => any_case("radius").map(|at| (at, 1.0)).or_else(|| any_case("diameter").map(|at| (at, 0.5))),
            _ => None,
        };
        let (value, has_words) = match &options.coloring {
            Coloring::Column(ByColumn { name, map, .. }) => {
                (Some(wanted(name, "--color-by")?), map.map(|map| map == Map::Categories))
            }
            _ => (None, None),
        };
        let element = ELEMENTS.iter().find_map(|name| any_case(name)).map(Kind::Element);
        let kind = element.or_else(|| TYPES.iter().find_map(|name| any_case(name)).map(Kind::Type));
        let wants_elements = [
            (options.coloring == Coloring::Element, "--color-by element"),
            (options.radius == Radius::VanDerWaals, "--radius element"),
            (options.radius == Radius::Covalent, "--radius covalent"),
        ];
        if let (Some((_, option)), false) = (wants_elements.iter().find(|(wants, _)| *wants), element.is_some()) {
            let message = format!("there is no column of elements, which {option} needs");
            return Err(Box::new(Detail::new(message, format!("the columns are {}", listed(&names)))));
        }
        // Columns that an option puts aside are not read.
        let is_auto = options.coloring == Coloring::Auto;
        let color = color.filter(|_| is_auto);
        let hex = any_case("color").or_else(|| any_case("colour")).filter(|_| is_auto && color.is_none());
        Ok(Self { position, kind, radius, color, hex, value, has_words, names })
    }

    /// How many a row has.
    pub(super) fn len(&self) -> usize {
        self.names.len()
    }

    /// Adds the particle of a row. `element` is taken in place of the row's own.
    pub(super) fn read(&mut self, row: &impl Row, element: Option<&[u8]>, frame: &mut Frame, log: &mut Collector) {
        if let Some(position) = self.coordinates(row, log) {
            self.read_at(position, row, element, frame, log);
        }
    }

    /// The coordinates of a row; one without them is left out with a warning.
    pub(super) fn coordinates(&self, row: &impl Row, log: &mut Collector) -> Option<DVec3> {
        self.three(self.position, row, log).map_err(|column| self.warn_of(Topic::Coordinate, row, column, log)).ok()
    }

    /// The same at a position of its own.
    pub(super) fn read_at(
        &mut self,
        position: DVec3,
        row: &impl Row,
        element: Option<&[u8]>,
        frame: &mut Frame,
        log: &mut Collector,
    ) {
        frame.positions.push(position);
        if let Some(kind) = self.kind {
            let (Kind::Element(column) | Kind::Type(column)) = kind;
            let own = || row.token(column);
            let token = element.map_or_else(own, Cow::Borrowed);
            if frame.push_kind(&token, matches!(kind, Kind::Element(_))) {
                log.warning(Topic::Kind, row.place(column), || unknown_element(&token));
            }
        }
        if let Some((column, factor)) = self.radius {
            let radius = self.number(row, column, log) * factor;
            if !(LEAST_RADIUS..=MOST).contains(&radius) {
                log.error(row.place(column), || {
                    let message = format!("a radius cannot be {}", shown(&row.token(column)));
                    Detail::new(message, format!("expected `{}` greater than 0", self.names[column]))
                });
            }
            frame.radii.push(radius);
        }
        if let Some(columns) = self.color {
            let color = self.three(columns, row, log).unwrap_or_else(|column| {
                self.warn_of(Topic::Value, row, column, log);
                DVec3::NAN
            });
            for (column, level) in columns.into_iter().zip(color.to_array()) {
                if !level.is_nan() && !(0.0..=frame.levels.unwrap_or(LEVELS)).contains(&level) {
                    log.error(row.place(column), || {
                        let message = format!("`{}` is no part of a colour", shown(&row.token(column)));
                        Detail::new(message, "expected 0 to 1, or 0 to 255")
                            .help("--color-by takes another column, or one colour for all")
                    });
                }
            }
            frame.colors.push(color);
        }
        if let Some(column) = self.hex {
            let token = row.token(column);
            let color = hex_of(&token).unwrap_or_else(|| {
                if is_missing(&token) {
                    self.warn_of(Topic::Value, row, column, log);
                } else {
                    log.error(row.place(column), || {
                        let message = format!("`{}` is no colour", shown(&token));
                        Detail::new(message, "expected #rrggbb").help("--color-by COLUMN colours by any column")
                    });
                }
                DVec3::NAN
            });
            frame.colors.push(color);
        }
        if let Some(column) = self.value {
            let value = self.value(row, column, frame, log);
            frame.values.push(value);
        }
    }

    /// The value that gives a colour, a number or that of a word.
    fn value(&mut self, row: &impl Row, column: usize, frame: &mut Frame, log: &mut Collector) -> f64 {
        if self.has_words != Some(true) {
            let number = row.number(column);
            // Sodium may be the first word.
            let may_be_word = || self.has_words.is_none() && row.token(column).eq_ignore_ascii_case(b"na");
            if number.is_err() && is_missing(&row.token(column)) && !may_be_word() {
                self.warn_of(Topic::Value, row, column, log);
                return f64::NAN;
            }
            if !*self.has_words.get_or_insert(matches!(number, Err(Fault::Syntax))) {
                return self.checked(number, row, column, log);
            }
        }
        f64::from(frame.words.number(&row.token(column)).0)
    }

    /// The numbers of three columns, or the first of these in which one is missing.
    fn three(&self, columns: [usize; 3], row: &impl Row, log: &mut Collector) -> Result<DVec3, usize> {
        let [x, y, z] = columns.map(|column| (column, row.number(column)));
        let lacks =
            |(column, number): &&(usize, Result<f64, Fault>)| number.is_err() && is_missing(&row.token(*column));
        if let Some(&(column, _)) = [&x, &y, &z].into_iter().find(lacks) {
            return Err(column);
        }
        let mut checked = |(column, number)| self.checked(number, row, column, log);
        Ok(DVec3::new(checked(x), checked(y), checked(z)))
    }

    fn warn_of(&self, topic: Topic, row: &impl Row, column: usize, log: &mut Collector) {
        log.warning(topic, row.place(column), || {
            let is_left_out = topic == Topic::Coordinate;
            let help = if is_left_out { "the row is left out" } else { "the particle is grey" };
            Detail::new(format!("`{}` is missing", self.names[column]), "expected a value").help(help)
        });
    }

    /// The number of a column; an error is reported, and 1 goes in its place.
    fn number(&self, row: &impl Row, column: usize, log: &mut Collector) -> f64 {
        self.checked(row.number(column), row, column, log)
    }

    fn checked(&self, number: Result<f64, Fault>, row: &impl Row, column: usize, log: &mut Collector) -> f64 {
        match number {
            Ok(number) if number.abs() <= MOST => number,
            result => {
                log.error(row.place(column), || {
                    no_number(&row.token(column), result.err().unwrap_or(Fault::Overflow), &self.names[column])
                });
                1.0
            }
        }
    }

    /// The column that follows the first missing ones, in words.
    pub(super) fn missing(&self, given: usize) -> Detail<'static> {
        let expected = match self.names.get(given) {
            Some(name) => format!("expected `{name}`: {}", listed(&self.names)),
            None => format!("expected no more than {}", listed(&self.names)),
        };
        Detail::new(format!("{} in a row of {}", count(given as u64, "field"), self.len()), expected)
    }
}

/// Where the line of column names has this one for the second time, or the property of extended XYZ that it is a field of; all of
/// `place` where names stand otherwise.
fn second<'a>(place: Location<'a>, name: &str) -> Location<'a> {
    let line = place.line;
    let is_part = |byte: Option<&u8>| byte.is_some_and(|byte| byte.is_ascii_alphanumeric() || b"_.".contains(byte));
    let property = name.trim_end_matches(|c: char| c.is_ascii_digit()).strip_suffix('_');
    let found = [Some(name), property].into_iter().flatten().find_map(|name| {
        let spans = memchr::memmem::find_iter(line.bytes, name).map(|start| Span { start, end: start + name.len() });
        spans.filter(|span| !is_part(line.bytes[..span.start].last()) && !is_part(line.bytes.get(span.end))).nth(1)
    });
    found.map_or(place, |span| line.place(span))
}

/// Whether a field has nothing in it, or one of the words for that.
pub(super) fn is_missing(token: &[u8]) -> bool {
    let token = token.trim_ascii();
    ["", "nan", "-nan", "+nan", "na"].iter().any(|word| token.eq_ignore_ascii_case(word.as_bytes()))
}

/// What is wrong with a number.
pub(super) fn no_number(token: &[u8], fault: Fault, name: &str) -> Detail<'static> {
    let token = shown(token);
    let message = match fault {
        Fault::Syntax if token.is_empty() => format!("`{name}` is missing"),
        Fault::Syntax => format!("`{token}` is not a number"),
        Fault::NotFinite => format!("`{token}` is not a finite number"),
        Fault::Overflow => format!("`{token}` is too large"),
    };
    Detail::new(message, format!("expected a number: `{name}`"))
}

fn unknown_element(token: &[u8]) -> Detail<'static> {
    Detail::new(format!("`{}` is no chemical element", shown(token)), "expected a symbol or an atomic number")
        .help("it has a colour of its own, and without --radius half the mean distance of particles for its radius")
}

/// Names in a message, the first twenty of them.
fn listed(names: &[String]) -> String {
    const SHOWN: usize = 20;
    let more = if names.len() > SHOWN { format!(" and {} more", names.len() - SHOWN) } else { String::new() };
    let names: Vec<_> = names.iter().take(SHOWN).map(|name| shown(name.as_bytes())).collect();
    names.join(", ") + &more
}
