//! Writing pictures: rows in, a finished file or nothing out.

use std::ffi::OsStr;
use std::fmt;
use std::fs::{self, OpenOptions, Permissions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use png::StreamWriter;

use super::rows::NOTE;
use super::{Format, sample_count};
use crate::atomic::{self, Destination, folder_of};

/// Where a picture goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Target {
    /// A file, replaced as a whole when the picture is complete.
    File(PathBuf),
    /// Standard output.
    Stdout,
}

impl Target {
    /// The target that a command line argument names: `-` is standard output, everything else a file.
    pub fn from_argument(argument: &OsStr) -> Self {
        if argument == "-" { Self::Stdout } else { Self::File(argument.into()) }
    }

    /// The command line argument that names it.
    pub fn argument(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Stdout => Path::new("-"),
        }
    }

    /// A file whose name does not say how to write it.
    pub(super) fn unknown_ending(&self) -> OutputError {
        let why = "the name has to end in .ppm or .png";
        self.error("choose the format of", io::Error::new(io::ErrorKind::InvalidInput, why))
    }

    pub(super) fn error(&self, attempted: &'static str, source: io::Error) -> OutputError {
        OutputError { target: self.clone(), attempted, source }
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(f),
            Self::Stdout => f.pad("standard output"),
        }
    }
}

/// A picture that could not be written: where to, what was being done, and what went wrong.
///
/// Its text names all three, so there is no further [`source`](std::error::Error::source) to print.
#[derive(Debug)]
pub struct OutputError {
    target: Target,
    attempted: &'static str,
    source: io::Error,
}

impl OutputError {
    /// Where the picture was to go.
    pub fn target(&self) -> &Target {
        &self.target
    }

    /// What went wrong; [`io::ErrorKind::BrokenPipe`] is a reader of standard output that has seen enough.
    pub fn kind(&self) -> io::ErrorKind {
        self.source.kind()
    }
}

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "cannot {} {}: {}", self.attempted, self.target, self.source)
    }
}

impl std::error::Error for OutputError {}

/// Writes a picture row by row in bounded memory.
///
/// A file is written under a temporary name in the same folder and takes its real name in [`finish`](Self::finish);
/// a writer dropped before leaves no trace, and a file that was there stays as it was. What surely exceeds the room on the disk is
/// refused before its first byte. A replaced file's permissions are
/// kept. A symbolic link stays and the file behind it is replaced. What is no regular file (`/dev/null`, a FIFO) is
/// written to directly, as is standard output.
pub struct PictureWriter {
    // Dropped in this order: the encoder closes the temporary file before the destination removes it.
    encoder: Encoder,
    destination: Option<Destination>,
    target: Target,
    failure: Failure,
    missing: u64, // samples
}

impl PictureWriter {
    /// Opens the target and writes the header of a picture of `width`×`height` pixels, both at least 1.
    ///
    /// # Errors
    /// An impossible size, a folder that does not exist, a file or folder without write permission.
    pub fn create(target: &Target, format: Format, width: u32, height: u32) -> Result<Self, OutputError> {
        Self::with_note(target, format, (width, height), None)
    }

    /// Likewise; the file has this note, one line that [`RowReader`](super::RowReader) finds again.
    ///
    /// # Errors
    /// As those of [`create`](Self::create).
    pub fn with_note(
        target: &Target,
        format: Format,
        size: (u32, u32),
        note: Option<&str>,
    ) -> Result<Self, OutputError> {
        Self::with_text(target, format, size, note.map(|note| (NOTE, note)))
    }

    /// Likewise, with a text of one line under any keyword.
    pub(crate) fn with_text(
        target: &Target,
        format: Format,
        (width, height): (u32, u32),
        text: Option<(&str, &str)>,
    ) -> Result<Self, OutputError> {
        let error = |source| target.error("create", source);
        let missing = sample_count(width, height).map_err(|wrong| error(invalid(wrong)))? as u64;
        let (raw, destination) = target.open(format.least_bytes(width, height)).map_err(error)?;
        let failure = Failure::default();
        let output = BufWriter::with_capacity(1 << 16, Watched { raw, failure: Arc::clone(&failure) });
        let encoder = Encoder::new(format, output, (width, height), text)
            .map_err(|wrapped| error(original(&failure, wrapped)))?;
        Ok(Self { encoder, destination, target: target.clone(), failure, missing })
    }

    /// Appends RGB samples in reading order; calls may end anywhere, also within a row or a pixel.
    ///
    /// # Errors
    /// More samples than the picture has (none of them is written then), or whatever the system says. After an error
    /// the writer can only be dropped.
    pub fn write_rows(&mut self, rgb: &[u8]) -> Result<(), OutputError> {
        let count = rgb.len() as u64;
        if count > self.missing {
            let excess = count - self.missing;
            return Err(self
                .target
                .error("write", invalid(format!("samples beyond the end of the picture: {excess}"))));
        }
        self.encoder.write(rgb).map_err(|error| self.target.error("write", original(&self.failure, error)))?;
        self.missing -= count;
        Ok(())
    }

    /// Completes the picture and gives the file its name.
    ///
    /// # Errors
    /// Samples that never came, or whatever the system says; a file that was there before is untouched then.
    pub fn finish(self) -> Result<(), OutputError> {
        let Self { encoder, destination, target, failure, missing } = self;
        let error = |source| target.error("finish", source);
        if missing > 0 && failure.get().is_none() {
            return Err(error(invalid(format!("samples missing at the end of the picture: {missing}"))));
        }
        encoder.finish().map_err(|wrapped| error(original(&failure, wrapped)))?;
        if let Some(unreported) = failure.get() {
            return Err(error(duplicate(unreported)));
        }
        if target == Target::Stdout {
            io::stdout().flush().map_err(error)?;
        }
        destination.map_or(Ok(()), Destination::commit).map_err(error)
    }
}

impl fmt::Debug for PictureWriter {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("PictureWriter")
            .field("target", &self.target)
            .field("missing", &self.missing)
            .finish_non_exhaustive()
    }
}

/// Writes a text: a file is complete or not there at all.
///
/// # Errors
/// A folder that does not exist, a file or folder without write permission, or whatever the system says.
pub fn save_text(target: &Target, text: &str) -> Result<(), OutputError> {
    save_bytes(target, text.as_bytes())
}

/// Likewise of bytes.
pub(crate) fn save_bytes(target: &Target, bytes: &[u8]) -> Result<(), OutputError> {
    save_by(target, bytes.len() as u64, |output| output.write_all(bytes))
}

/// Likewise of what `write` writes, so many bytes or more.
pub(crate) fn save_by(
    target: &Target,
    bytes: u64,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), OutputError> {
    let (raw, destination) = target.open(bytes).map_err(|source| target.error("create", source))?;
    let mut output = Watched { raw, failure: Failure::default() };
    write(&mut output).and_then(|()| output.flush()).map_err(|source| target.error("write", source))?;
    drop(output);
    destination.map_or(Ok(()), Destination::commit).map_err(|source| target.error("finish", source))
}

fn invalid(reason: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, reason)
}

// --- where the bytes go ---------------------------------------------------------------------------------------------

/// An output, and the place that its file takes once its bytes are complete, where it has not its place yet.
type Opened = (Box<dyn Write + Send>, Option<Destination>);

impl Target {
    /// Opens it for so many bytes or more.
    fn open(&self, bytes: u64) -> io::Result<Opened> {
        match self {
            Self::File(path) => open(path, bytes),
            Self::Stdout => Ok((Box::new(io::stdout()), None)),
        }
    }
}

/// Opens a file for so many bytes or more.
fn open(path: &Path, bytes: u64) -> io::Result<Opened> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_file() => replace(path, bytes),
        Ok(found) if found.is_symlink() && leads_to_replaceable(path)? => replace(&fs::canonicalize(path)?, bytes),
        Ok(found) if found.is_symlink() && leads_nowhere(path) => {
            open(&folder_of(path).join(fs::read_link(path)?), bytes)
        }
        Ok(_) => {
            let file = OpenOptions::new().write(true).create(true).truncate(true).open(path)?;
            Ok((Box::new(file), None))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => create_new(path, bytes),
        Err(error) => Err(error),
    }
}

/// Whether a symbolic link stands for a regular file that may be exchanged for another.
///
/// Links below `/dev` and `/proc` stand for a file that someone holds open (`/dev/stdout`): exchanging it would leave
/// the holder with the old one.
fn leads_to_replaceable(link: &Path) -> io::Result<bool> {
    if !fs::metadata(link).is_ok_and(|found| found.is_file()) {
        return Ok(false);
    }
    let folder = fs::canonicalize(folder_of(link))?;
    Ok(!folder.starts_with("/dev") && !folder.starts_with("/proc"))
}

/// Whether a symbolic link stands for a file that is yet to be made.
fn leads_nowhere(link: &Path) -> bool {
    fs::metadata(link).is_err_and(|error| error.kind() == io::ErrorKind::NotFound)
}

/// Refuses a file that cannot fit beside what is there: its old version stays until it is complete.
#[cfg(unix)]
fn ensure_room(path: &Path, bytes: u64) -> io::Result<()> {
    // A file system that does not tell its size tells no room either.
    match rustix::fs::statvfs(folder_of(path)) {
        Ok(disk) if disk.f_blocks > 0 && disk.f_bavail.saturating_mul(disk.f_frsize) < bytes => {
            let free = size(disk.f_bavail.saturating_mul(disk.f_frsize));
            let message = format!("it takes {} or more, and {free} are free", size(bytes));
            Err(io::Error::new(io::ErrorKind::StorageFull, message))
        }
        _ => Ok(()),
    }
}

/// Bytes in a unit that suits them.
#[cfg(unix)]
fn size(bytes: u64) -> String {
    let units = ["kB", "MB", "GB", "TB", "PB"];
    let power = (bytes.max(1).ilog10() / 3).clamp(1, units.len() as u32);
    format!("{:.1} {}", bytes as f64 / 1000_f64.powi(power.cast_signed()), units[power as usize - 1])
}

#[cfg(not(unix))]
fn ensure_room(_path: &Path, _bytes: u64) -> io::Result<()> {
    Ok(())
}

fn replace(path: &Path, bytes: u64) -> io::Result<Opened> {
    // Renaming needs no write permission on the file itself; ask for it as an ordinary write would.
    let permissions = OpenOptions::new().write(true).open(path)?.metadata()?.permissions();
    temporary_for(path, Some(permissions), bytes)
}

fn create_new(path: &Path, bytes: u64) -> io::Result<Opened> {
    if path.file_name().is_none() {
        return Err(invalid("that is no file name"));
    }
    let folder = folder_of(path);
    if !folder.exists() {
        return Err(io::Error::new(io::ErrorKind::NotFound, format!("there is no folder `{}`", folder.display())));
    }
    temporary_for(path, None, bytes)
}

fn temporary_for(path: &Path, permissions: Option<Permissions>, bytes: u64) -> io::Result<Opened> {
    ensure_room(path, bytes)?;
    let (part, destination) = atomic::begin(path, permissions)?;
    Ok((Box::new(part), Some(destination)))
}

/// The first error of an output.
type Failure = Arc<OnceLock<io::Error>>;

/// An output that remembers its first error: the PNG encoder writes its last bytes while it is dropped, where nobody
/// else would hear of one.
struct Watched {
    raw: Box<dyn Write + Send>,
    failure: Failure,
}

impl Watched {
    fn watch<T>(&self, result: io::Result<T>) -> io::Result<T> {
        if let Err(error) = &result
            && error.kind() != io::ErrorKind::Interrupted
        {
            self.failure.get_or_init(|| duplicate(error));
        }
        result
    }
}

impl Write for Watched {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let result = self.raw.write(bytes);
        self.watch(result)
    }

    fn flush(&mut self) -> io::Result<()> {
        let result = self.raw.flush();
        self.watch(result)
    }
}

/// The system's error behind one of the encoder's, which may have lost its kind on the way.
fn original(failure: &Failure, error: io::Error) -> io::Error {
    failure.get().map_or(error, duplicate)
}

fn duplicate(error: &io::Error) -> io::Error {
    match error.raw_os_error() {
        Some(code) => io::Error::from_raw_os_error(code),
        None => io::Error::new(error.kind(), error.to_string()),
    }
}

// --- what the bytes are ---------------------------------------------------------------------------------------------

type Output = BufWriter<Watched>;

enum Encoder {
    P6(Output),
    P3(Plain),
    Png(Box<StreamWriter<'static, Output>>),
}

impl Encoder {
    fn new(
        format: Format,
        mut output: Output,
        (width, height): (u32, u32),
        text: Option<(&str, &str)>,
    ) -> io::Result<Self> {
        let comment = text.map(|(keyword, text)| format!("# {keyword} {text}\n")).unwrap_or_default();
        match format {
            Format::P6 => {
                write!(output, "P6\n{comment}{width} {height}\n255\n")?;
                Ok(Self::P6(output))
            }
            Format::P3 => {
                write!(output, "P3\n{comment}{width} {height}\n255\n")?;
                Ok(Self::P3(Plain::new(output, width)))
            }
            Format::Png => {
                Ok(Self::Png(Box::new(png_writer(output, (width, height), RGB8, text)?.into_stream_writer()?)))
            }
        }
    }

    fn write(&mut self, rgb: &[u8]) -> io::Result<()> {
        match self {
            Self::P6(output) => output.write_all(rgb),
            Self::P3(plain) => plain.write(rgb),
            Self::Png(stream) => stream.write_all(rgb),
        }
    }

    fn finish(self) -> io::Result<()> {
        match self {
            Self::P6(mut output) | Self::P3(Plain { mut output, .. }) => output.flush(),
            Self::Png(stream) => Ok(stream.finish()?),
        }
    }
}

/// The bytes of the PNG file that [`PictureWriter`] writes of the same picture, whose rows `rgb` holds.
///
/// # Errors
/// More or fewer samples than the picture has.
pub fn encode_png(width: u32, height: u32, rgb: &[u8]) -> io::Result<Vec<u8>> {
    encode_png_of((width, height), RGB8, None, rgb)
}

/// The bytes of a PNG file of such samples, with a text under a keyword.
///
/// # Errors
/// More or fewer samples than the picture has.
pub(super) fn encode_png_of(
    size: (u32, u32),
    kind: Kind,
    text: Option<(&str, &str)>,
    samples: &[u8],
) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut writer = png_writer(&mut bytes, size, kind, text)?;
    let mut stream = writer.stream_writer()?;
    stream.write_all(samples)?;
    stream.finish()?;
    writer.finish()?;
    Ok(bytes)
}

/// The channels of a PNG, and the bits of each.
type Kind = (png::ColorType, png::BitDepth);

const RGB8: Kind = (png::ColorType::Rgb, png::BitDepth::Eight);

fn png_writer<W: Write>(
    output: W,
    (width, height): (u32, u32),
    (color, depth): Kind,
    text: Option<(&str, &str)>,
) -> Result<png::Writer<W>, png::EncodingError> {
    let mut encoder = png::Encoder::new(output, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(png::Compression::Fast);
    if let Some((keyword, text)) = text {
        encoder.add_itxt_chunk(keyword.to_owned(), text.to_owned())?;
    }
    encoder.write_header()
}

/// Samples in a line of P3: five pixels, at most 59 characters where the format allows 70.
const LINE_SAMPLES: u64 = 15;

/// The decimal text of each sample value, padded with blanks, and its length with one blank after it.
const DECIMALS: [([u8; 4], usize); 256] = {
    let mut table = [([b' '; 4], 0); 256];
    let mut value = 0;
    while value < 256 {
        let digits = [b'0' + (value / 100) as u8, b'0' + (value / 10 % 10) as u8, b'0' + (value % 10) as u8];
        let skipped = if value < 10 {
            2
        } else if value < 100 {
            1
        } else {
            0
        };
        let mut at = skipped;
        while at < 3 {
            table[value].0[at - skipped] = digits[at];
            at += 1;
        }
        table[value].1 = 4 - skipped;
        value += 1;
    }
    table
};

/// The encoder of P3; each picture row starts on a new line.
struct Plain {
    output: Output,
    row_samples: u64,
    row_left: u64,
    line_left: u64,
}

impl Plain {
    fn new(output: Output, width: u32) -> Self {
        let row_samples = width as u64 * 3;
        Self { output, row_samples, row_left: row_samples, line_left: row_samples.min(LINE_SAMPLES) }
    }

    fn write(&mut self, mut rgb: &[u8]) -> io::Result<()> {
        while !rgb.is_empty() {
            let count = self.line_left.min(rgb.len() as u64);
            let (now, later) = rgb.split_at(count as usize);
            self.write_in_line(now)?;
            rgb = later;
        }
        Ok(())
    }

    /// Writes samples that fit into the current line.
    fn write_in_line(&mut self, rgb: &[u8]) -> io::Result<()> {
        let mut text = [0; 4 * LINE_SAMPLES as usize];
        let mut length = 0;
        for &sample in rgb {
            let (digits, used) = DECIMALS[sample as usize];
            text[length..length + 4].copy_from_slice(&digits);
            length += used;
        }
        self.line_left -= rgb.len() as u64;
        self.row_left -= rgb.len() as u64;
        if self.line_left == 0 {
            text[length - 1] = b'\n';
            if self.row_left == 0 {
                self.row_left = self.row_samples;
            }
            self.line_left = self.row_left.min(LINE_SAMPLES);
        }
        self.output.write_all(&text[..length])
    }
}
