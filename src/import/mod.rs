//! Particles of other programs as scenes: atoms, simulations, point clouds.
//!
//! A file's format is told by what it begins with ([`Format`]). Its frames are read one after another, and no more than one is in
//! memory. Each particle becomes a sphere with a radius and a colour that [`Options`] choose.
//!
//! The scene is the file's, turned and moved as one body so that the eye at the origin sees all of it: lengths stay those of the
//! file. Camera, range of colours and substitute radii are those of the first frame that is read, so that pictures of a trajectory
//! fit together.
//!
//! ```
//! use trueray::import::{Options, Radius, scene};
//!
//! let water = b"3\nwater\nO 0 0 0.119\nH 0 0.763 -0.477\nH 0 -0.763 -0.477\n";
//! let options = Options { radius: Radius::Covalent, ..Options::default() };
//! let water = scene("water.xyz", water, &options).unwrap();
//! assert_eq!(water.spheres.len(), 3);
//! assert_eq!(water.spheres[1].scale.x, 0.31);
//!
//! let error = scene("bad.xyz", b"1\nhelium\nHe 0 0 zero\n", &options).unwrap_err().to_string();
//! assert!(error.contains("bad.xyz:3:8") && error.contains("`zero` is not a number"));
//! ```

mod atom_name;
mod camera;
mod color;
mod columns;
mod elements;
mod format;
mod frame;
mod frames;
mod lammps;
mod light;
mod map;
mod mmcif;
mod options;
mod pdb;
mod ply;
mod points;
mod reader;
mod scene;
mod source;
mod table;
mod xyz;

use std::io::Read;

use self::frame::Frame;
use self::reader::{Reader, reader_of};
use self::scene::{Look, Made, scene_of};
use self::source::{Source, Stop};
use crate::scene::{Collector, Detail, Line, Parsed, Scene, SceneError, Span, Topic};

pub use color::ColorScale;
pub(crate) use color::color_at;
pub use elements::{ELEMENTS, Element};
pub use format::Format;
pub use light::Lamps;
pub use options::{ByColumn, Coloring, Frames, Framing, Lighting, Map, Options, Radius, color, direction};

/// A frame as a scene.
#[derive(Debug, Clone)]
pub struct Imported {
    /// Of the frame, from 1.
    pub number: usize,
    /// The scene and warnings, or what is wrong with the file. Of several frames, one without particles has neither scene nor errors.
    pub parsed: Parsed,
    /// The scene's lights, which turn with the eye.
    pub lamps: Option<Lamps>,
    /// What its colours stand for, where they are those of a column of numbers.
    pub color_scale: Option<ColorScale>,
    /// What was decided in the user's place.
    pub notes: Vec<String>,
}

/// The chosen frames of a file, read one after another. After one with errors there are no more.
pub struct Import<'r> {
    name: String,
    source: Source<'r>,
    reader: Box<dyn Reader>,
    options: Options,
    frame: Frame,
    look: Option<Look>,
    number: usize,
    is_ended: bool,
}

impl<'r> Import<'r> {
    /// Of a file that `reader` reads from its beginning; `name` is what errors call it.
    pub fn new(name: &str, format: Format, reader: impl Read + 'r, options: Options) -> Self {
        let (source, reader) = (Source::new(reader), reader_of(format));
        let name = name.to_owned();
        Self { name, source, reader, options, frame: Frame::default(), look: None, number: 0, is_ended: false }
    }

    /// Reads up to the next chosen frame, whether there is one.
    fn read(&mut self, log: &mut Collector) -> Result<bool, Stop> {
        if self.number == 0 && self.source.peek()?.is_some_and(|line| line.bytes.starts_with(b"\xEF\xBB\xBF")) {
            self.source.bytes(3)?;
        }
        let frames = self.options.frames.clone();
        loop {
            if frames.end().is_some_and(|end| self.number >= end) {
                return Ok(false);
            }
            let is_wanted = frames.wants(self.number + 1);
            let frame = is_wanted.then_some(&mut self.frame);
            if !self.reader.next(&mut self.source, frame, &self.options, log)? {
                let (found, last) = (self.number, frames == Frames::Last);
                if let Some(end) = frames.end().or((found == 0).then_some(1)) {
                    log.error(self.source.end(), || no_frame(end, found));
                }
                return Ok(last && found > 0);
            }
            self.number += 1;
            if is_wanted && frames != Frames::Last {
                return Ok(true);
            }
        }
    }

    /// The same, with all that goes wrong in the log.
    fn read_reporting(&mut self, log: &mut Collector) -> bool {
        self.read(log).unwrap_or_else(|stop| {
            if let Stop::Io(error) = stop {
                let place = Line { number: self.source.last().number, bytes: b"" }.place(Span::default());
                log.error(place, || Detail::new(format!("the file cannot be read: {error}"), "no more is read"));
            }
            false
        })
    }

    /// The first of the chosen frames.
    pub fn first(mut self) -> Imported {
        let mut log = Collector::default();
        self.read_reporting(&mut log);
        self.imported(log)
    }

    /// The frame that has been read.
    fn imported(&mut self, mut log: Collector) -> Imported {
        let mut made = None;
        if log.error_count() == 0 && self.frame.positions.is_empty() {
            let place = self.source.end();
            let detail = || Detail::new("a frame without particles", "expected at least one");
            if self.options.frames.is_one() {
                log.error(place, detail);
            } else {
                let number = self.number;
                log.warning(Topic::Frame, place, || detail().help(format!("frame {number} is left out")));
            }
        } else if log.error_count() == 0 {
            match scene_of(&self.frame, &self.options, &mut self.look) {
                Ok(found) => match found.scene.check() {
                    Ok(()) => made = Some(found),
                    // What is too large before it is moved, or after.
                    Err(why) => log.error(self.source.end(), || {
                        let message = format!("the particles of frame {} reach too far: {why}", self.number);
                        Detail::new(message, "expected numbers that a scene can have")
                    }),
                },
                Err(error) => log.error(self.source.end(), || Detail::new(error.to_string(), "no such view")),
            }
        }
        let number = self.number.max(1);
        let (scene, lamps, color_scale, notes) = match made {
            Some(Made { scene, lamps, color_scale, notes }) => (Some(scene), Some(lamps), color_scale, notes),
            None => (None, None, None, Vec::new()),
        };
        Imported { number, parsed: Parsed::of(&self.name, scene, log), lamps, color_scale, notes }
    }
}

impl Iterator for Import<'_> {
    type Item = Imported;

    fn next(&mut self) -> Option<Imported> {
        if self.is_ended {
            return None;
        }
        let mut log = Collector::default();
        let is_read = self.read_reporting(&mut log);
        self.is_ended = !is_read || log.error_count() > 0 || self.options.frames == Frames::Last;
        (is_read || log.error_count() > 0).then(|| self.imported(log))
    }
}

fn no_frame(wanted: usize, found: usize) -> Detail<'static> {
    let message = match found {
        0 => "the file ends before its first frame".to_owned(),
        1 => format!("there is no frame {wanted}: the file has one"),
        _ => format!("there is no frame {wanted}: the file has {found}"),
    };
    Detail { absent: "end of file", ..Detail::new(message, "expected a frame") }
}

/// The first of the chosen frames of a file that is in memory, as a scene; `name` is what errors call it.
///
/// # Errors
///
/// Where it has errors, or is of no known format.
pub fn scene(name: &str, text: &[u8], options: &Options) -> Result<Scene, SceneError> {
    let unknown = || SceneError::new(format!("{name}: of no format with particles that is known"));
    let format = Format::of(text).ok_or_else(unknown)?;
    let mut parsed = Import::new(name, format, text, options.clone()).first().parsed;
    parsed.scene.take().ok_or_else(|| SceneError::new(parsed.report(false)))
}
