//! The vertices of PLY files as particles, in text and both binary orders of bytes.

use std::borrow::Cow;

use super::columns::{Columns, LEVELS, Row, TextRow, XYZ};
use super::frame::Frame;
use super::options::Options;
use super::reader::Reader;
use super::source::{Source, Stop, end_of, split_blanks, stop};
use super::xyz::whole;
use crate::scene::{Collector, Detail, Fault, Line, Location, shown};

#[derive(Debug, Default)]
pub(super) struct Ply {
    is_read: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Coding {
    Text,
    LittleEndian,
    BigEndian,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

#[derive(Debug)]
struct Property {
    name: String,
    of: Type,
    /// The type of its length, where it is a list.
    length: Option<Type>,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

/// Longer rows are no vertices.
const MOST_PROPERTIES: usize = 1000;

impl Reader for Ply {
    fn next(
        &mut self,
        source: &mut Source<'_>,
        frame: Option<&mut Frame>,
        options: &Options,
        log: &mut Collector,
    ) -> Result<bool, Stop> {
        if self.is_read {
            return Ok(false);
        }
        self.is_read = true;
        let Some(frame) = frame else { return Ok(true) };
        frame.clear();
        let (coding, elements) = header(source, log)?;
        let is_vertex = |element: &Element| element.name == "vertex";
        let Some(at) = elements.iter().position(is_vertex) else {
            return Err(stop(log, source.end(), || Detail::new("no element `vertex`", "expected it in the header")));
        };
        let vertex = &elements[at];
        let names = vertex.properties.iter().map(|property| property.name.clone()).collect();
        let mut columns = Columns::of(names, XYZ, options, whole(source.last()), log)?;
        let is_color = |property: &&Property| property.name.ends_with("red") || property.name == "r";
        frame.levels = match vertex.properties.iter().find(is_color).map(|property| property.of) {
            Some(Type::F32 | Type::F64) => Some(1.0),
            Some(Type::U16 | Type::I16) => Some(65535.0),
            Some(_) => Some(LEVELS),
            None => None,
        };
        for element in &elements[..at] {
            pass(source, coding, element, log)?;
        }
        if coding == Coding::Text {
            text(source, vertex, &mut columns, frame, log)?;
        } else {
            binary(source, coding, vertex, &mut columns, frame, log)?;
        }
        for element in &elements[at + 1..] {
            pass(source, coding, element, log)?;
        }
        check_end(source, coding, log)?;
        Ok(true)
    }
}

fn text(
    source: &mut Source<'_>,
    vertex: &Element,
    columns: &mut Columns,
    frame: &mut Frame,
    log: &mut Collector,
) -> Result<(), Stop> {
    let mut spans = Vec::new();
    for done in 0..vertex.count {
        let line = source.demand(log, || cut(vertex, done))?;
        split_blanks(line.bytes, &mut spans);
        if spans.len() == columns.len() {
            columns.read(&TextRow { line, spans: &spans }, None, frame, log);
        } else {
            log.error(end_of(line), || columns.missing(spans.len()));
        }
    }
    Ok(())
}

/// The numbers of a vertex. It has no place in a text: messages show its number.
struct BinaryRow<'a> {
    values: &'a [f64],
    line: Line<'a>,
}

impl Row for BinaryRow<'_> {
    fn token(&self, column: usize) -> Cow<'_, [u8]> {
        self.values[column].to_string().into_bytes().into()
    }

    fn place(&self, _column: usize) -> Location<'_> {
        whole(self.line)
    }

    fn number(&self, column: usize) -> Result<f64, Fault> {
        Some(self.values[column]).filter(|value| value.is_finite()).ok_or(Fault::NotFinite)
    }
}

fn binary(
    source: &mut Source<'_>,
    coding: Coding,
    vertex: &Element,
    columns: &mut Columns,
    frame: &mut Frame,
    log: &mut Collector,
) -> Result<(), Stop> {
    let length = vertex.properties.iter().map(|property| property.of.size()).sum();
    let mut values = vec![0.0; vertex.properties.len()];
    let number = source.last().number;
    for done in 0..vertex.count {
        let Some(mut bytes) = source.bytes(length)? else {
            return Err(stop(log, source.end(), || Detail { absent: "end of file", ..cut(vertex, done) }));
        };
        for (value, property) in values.iter_mut().zip(&vertex.properties) {
            let (own, rest) = bytes.split_at(property.of.size());
            (*value, bytes) = (property.of.value(own, coding), rest);
        }
        let errors = log.error_count();
        let shown = format!("vertex {}", done + 1);
        columns.read(&BinaryRow { values: &values, line: Line { number, bytes: shown.as_bytes() } }, None, frame, log);
        if log.error_count() > errors {
            return Err(Stop::Reported);
        }
    }
    Ok(())
}

fn cut(element: &Element, done: u64) -> Detail<'static> {
    let name = shown(element.name.as_bytes());
    Detail::new(format!("the file ends after {done} of {} `{name}`", element.count), format!("expected `{name}`"))
}

/// Takes an element that is not used.
fn pass(source: &mut Source<'_>, coding: Coding, element: &Element, log: &mut Collector) -> Result<(), Stop> {
    if coding != Coding::Text && element.properties.is_empty() {
        return Ok(());
    }
    for done in 0..element.count {
        if coding == Coding::Text {
            source.demand(log, || cut(element, done))?;
            continue;
        }
        for property in &element.properties {
            let mut count = 1;
            if let Some(length) = property.length {
                let Some(bytes) = source.bytes(length.size())? else {
                    return Err(stop(log, source.end(), || Detail { absent: "end of file", ..cut(element, done) }));
                };
                let value = length.value(bytes, coding);
                if !(value >= 0.0 && value.fract() == 0.0) {
                    let shown = format!("{} {}", element.name, done + 1);
                    let line = Line { number: source.last().number, bytes: shown.as_bytes() };
                    return Err(stop(log, whole(line), || no_length(property, value)));
                }
                count = value as u64;
            }
            for _ in 0..count {
                if source.bytes(property.of.size())?.is_none() {
                    let detail = if count > 1 { cut_list(property, count) } else { cut(element, done) };
                    return Err(stop(log, source.end(), || Detail { absent: "end of file", ..detail }));
                }
            }
        }
    }
    Ok(())
}

fn cut_list(property: &Property, count: u64) -> Detail<'static> {
    let message = format!("the file ends within a list `{}` of {count}", shown(property.name.as_bytes()));
    Detail::new(message, "expected as many entries as it says")
}

fn no_length(property: &Property, value: f64) -> Detail<'static> {
    let message = format!("the list `{}` cannot have {value} entries", shown(property.name.as_bytes()));
    Detail::new(message, "expected a whole number from 0")
}

/// Behind the last element is nothing.
fn check_end(source: &mut Source<'_>, coding: Coding, log: &mut Collector) -> Result<(), Stop> {
    let detail = || {
        Detail::new("the file goes on behind its last element", "expected the end of the file")
            .help("an element may have more rows than its number in the header says")
    };
    if coding == Coding::Text {
        source.skip_blank_lines()?;
        let more = source.line()?;
        return more.map_or(Ok(()), |line| Err(stop(log, whole(line), detail)));
    }
    match source.bytes(1)? {
        None => Ok(()),
        Some(_) => Err(stop(log, source.end(), || Detail { absent: "more bytes", ..detail() })),
    }
}

/// Everything up to `end_header`.
fn header(source: &mut Source<'_>, log: &mut Collector) -> Result<(Coding, Vec<Element>), Stop> {
    let mut coding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut spans = Vec::new();
    source.line()?;
    loop {
        let line = source.demand(log, || Detail::new("the file ends in the header", "expected end_header"))?;
        split_blanks(line.bytes, &mut spans);
        let words: Vec<_> = spans.iter().map(|&span| String::from_utf8_lossy(line.token(span))).collect();
        let words: Vec<_> = words.iter().map(|word| &**word).collect();
        let property = |of: &str, length: Option<&str>, name: &str| {
            let length = match length {
                Some(length) => Some(Type::of(length)?),
                None => None,
            };
            Some(Property { name: name.to_owned(), of: Type::of(of)?, length })
        };
        let understood = match (&words[..], elements.last_mut()) {
            (["comment" | "obj_info", ..] | [], _) => true,
            (["format", name, _], _) => {
                coding = Coding::of(name);
                coding.is_some()
            }
            (["element", name, count], _) => count.parse().is_ok_and(|count| {
                elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new() });
                true
            }),
            (["property", "list", _, _, name], Some(element)) if element.name == "vertex" => {
                let message = format!("`{}` of vertices is a list", shown(name.as_bytes()));
                return Err(stop(log, line.place(spans[4]), || Detail::new(message, "expected a number")));
            }
            (["property", "list", length, of, name], Some(element)) => {
                property(of, Some(length), name).map(|property| element.properties.push(property)).is_some()
            }
            (["property", of, name], Some(element)) if element.properties.len() < MOST_PROPERTIES => {
                property(of, None, name).map(|property| element.properties.push(property)).is_some()
            }
            (["end_header"], _) => match coding {
                Some(coding) => return Ok((coding, elements)),
                None => false,
            },
            _ => false,
        };
        if !understood {
            return Err(stop(log, whole(line), || {
                let message = format!("`{}` is not understood in a PLY header", shown(line.bytes));
                Detail::new(message, "expected format, element, property or comment, and after these end_header")
            }));
        }
    }
}

impl Coding {
    fn of(name: &str) -> Option<Self> {
        match name {
            "ascii" => Some(Self::Text),
            "binary_little_endian" => Some(Self::LittleEndian),
            "binary_big_endian" => Some(Self::BigEndian),
            _ => None,
        }
    }
}

impl Type {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number that so many bytes are.
    fn value(self, bytes: &[u8], coding: Coding) -> f64 {
        let mut little = [0; 8];
        little[..bytes.len()].copy_from_slice(bytes);
        if coding == Coding::BigEndian {
            little[..bytes.len()].reverse();
        }
        let bits = u64::from_le_bytes(little);
        match self {
            Self::I8 => (bits as i8).into(),
            Self::U8 => (bits as u8).into(),
            Self::I16 => (bits as i16).into(),
            Self::U16 => (bits as u16).into(),
            Self::I32 => (bits as i32).into(),
            Self::U32 => (bits as u32).into(),
            Self::F32 => f32::from_bits(bits as u32).into(),
            Self::F64 => f64::from_bits(bits),
        }
    }
}
