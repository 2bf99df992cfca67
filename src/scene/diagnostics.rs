//! Errors and warnings about a scene file, and how they are shown.
//!
//! A diagnostic owns the few words and the piece of the line that it shows, so that it outlives the text of the file,
//! which may be of any size. How many are kept is bounded; the rest is counted.

use std::fmt;
use std::ops::Range;

use codespan_reporting::diagnostic as codespan;
use codespan_reporting::files::{Error as FilesError, Files};
use codespan_reporting::term::{self, termcolor::Buffer};
use serde::Serialize;

use crate::words::{push_visible, visible};

/// So many errors are kept.
const ERRORS_KEPT: usize = 50;
/// So many warnings are kept of each [`Topic`].
const WARNINGS_KEPT: usize = 20;
/// Bytes of the line that are shown before and from the start of the token; what exceeds them is cut.
const SHOWN_BEFORE: usize = 150;
const SHOWN_FROM: usize = 250;
/// Characters of a token that are quoted in a message.
const TOKEN_SHOWN: usize = 40;

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The file is no scene: nothing is rendered.
    Error,
    /// The scene can be rendered, but may not be what was meant.
    Warning,
}

/// One error or warning, with the place in the file that it is about.
///
/// All texts are safe to print: bytes that are not UTF-8 and characters that a terminal would obey or hide are escaped.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// Line of the token, from 1. For what the whole file lacks: its last line.
    pub line: usize,
    /// Column of the token's first character, from 1, in characters.
    pub column: usize,
    /// The token as written, or its first 40 characters and `…`; `end of line` where a field is missing, `end of file`
    /// where a whole statement is.
    pub token: String,
    /// What is wrong, in one line.
    pub message: String,
    /// What was expected in the token's place.
    pub expected: String,
    /// How to set it right, where there is something to say.
    pub help: Option<String>,
    #[serde(skip)]
    excerpt: Excerpt,
    #[serde(skip)]
    earlier: Option<Earlier>,
}

/// An earlier line that a diagnostic also points to.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Earlier {
    excerpt: Excerpt,
    label: &'static str,
}

/// How many diagnostics of one kind were counted but not kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Omitted {
    /// Errors or warnings.
    pub severity: Severity,
    /// How many, > 0.
    pub count: usize,
    /// Which, as the subject of a sentence with its verb, such as `errors are`.
    pub what: &'static str,
}

impl fmt::Display for Omitted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} more {} not shown", self.count, self.what)
    }
}

/// A part of a line, as byte range; empty where something is missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Span {
    pub(crate) start: usize,
    pub(crate) end: usize,
}

/// One line of the file without its end.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line<'a> {
    /// From 1.
    pub(crate) number: usize,
    pub(crate) bytes: &'a [u8],
}

impl<'a> Line<'a> {
    pub(crate) fn token(self, span: Span) -> &'a [u8] {
        &self.bytes[span.start..span.end]
    }

    pub(crate) fn place(self, span: Span) -> Location<'a> {
        Location { line: self, span }
    }
}

/// Where a diagnostic points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Location<'a> {
    pub(crate) line: Line<'a>,
    pub(crate) span: Span,
}

/// What a diagnostic says.
pub(crate) struct Detail<'a> {
    pub(crate) message: String,
    pub(crate) expected: String,
    pub(crate) help: Option<String>,
    /// Shown instead of the token where the place is empty.
    pub(crate) absent: &'static str,
    pub(crate) earlier: Option<(Location<'a>, &'static str)>,
}

impl Detail<'_> {
    pub(crate) fn new(message: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { message: message.into(), expected: expected.into(), help: None, absent: "end of line", earlier: None }
    }

    pub(crate) fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}

/// What a warning is about; each is bounded on its own, so that a million colours do not hide a mirrored window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Topic {
    Color,
    Coefficient,
    Intensity,
    Tiny,
    Window,
    /// Of imported files.
    Kind,
    Record,
    Coordinate,
    Value,
    Frame,
}

impl Topic {
    const ALL: [Self; 10] = [
        Self::Color,
        Self::Coefficient,
        Self::Intensity,
        Self::Tiny,
        Self::Window,
        Self::Kind,
        Self::Record,
        Self::Coordinate,
        Self::Value,
        Self::Frame,
    ];

    fn warnings(self) -> &'static str {
        match self {
            Self::Color => "warnings about colours outside 0 to 1 are",
            Self::Coefficient => "warnings about coefficients outside 0 to 1 are",
            Self::Intensity => "warnings about negative or huge intensities are",
            Self::Tiny => "warnings about numbers too small for full precision are",
            Self::Window => "warnings about the window are",
            Self::Kind => "warnings about unknown elements are",
            Self::Record => "warnings about unknown records are",
            Self::Coordinate => "warnings about rows without coordinates are",
            Self::Value => "warnings about missing colours are",
            Self::Frame => "warnings about empty frames are",
        }
    }
}

/// Collects diagnostics, keeps the first of each kind and counts all.
#[derive(Default)]
pub(crate) struct Collector {
    kept: Vec<Diagnostic>,
    errors: usize,
    warnings: [usize; Topic::ALL.len()],
}

impl Collector {
    /// Counts an error; `detail` is only asked while errors are kept.
    #[cold]
    pub(crate) fn error<'a>(&mut self, place: Location<'_>, detail: impl FnOnce() -> Detail<'a>) {
        self.errors += 1;
        if self.errors <= ERRORS_KEPT {
            self.kept.push(Diagnostic::new(Severity::Error, place, detail()));
        }
    }

    /// Counts a warning; `detail` is only asked while warnings of this topic are kept.
    #[cold]
    pub(crate) fn warning<'a>(&mut self, topic: Topic, place: Location<'_>, detail: impl FnOnce() -> Detail<'a>) {
        let count = &mut self.warnings[topic as usize];
        *count += 1;
        if *count <= WARNINGS_KEPT {
            self.kept.push(Diagnostic::new(Severity::Warning, place, detail()));
        }
    }

    pub(crate) fn error_count(&self) -> usize {
        self.errors
    }

    pub(super) fn warning_count(&self) -> usize {
        self.warnings.iter().sum()
    }

    /// The kept diagnostics in the order of the file, and what was not kept.
    pub(crate) fn finish(self) -> (Vec<Diagnostic>, Vec<Omitted>) {
        let mut kept = self.kept;
        kept.sort_by_key(|diagnostic| (diagnostic.line, diagnostic.column));
        let errors = (Severity::Error, self.errors.saturating_sub(ERRORS_KEPT), "errors are");
        let warnings = Topic::ALL
            .iter()
            .zip(self.warnings)
            .map(|(topic, count)| (Severity::Warning, count.saturating_sub(WARNINGS_KEPT), topic.warnings()));
        let omitted = std::iter::once(errors)
            .chain(warnings)
            .filter(|&(_, count, _)| count > 0)
            .map(|(severity, count, what)| Omitted { severity, count, what })
            .collect();
        (kept, omitted)
    }
}

impl Diagnostic {
    fn new(severity: Severity, place: Location<'_>, detail: Detail<'_>) -> Self {
        let token = place.line.token(place.span);
        Self {
            severity,
            line: place.line.number,
            column: column(place),
            token: if token.is_empty() { detail.absent.to_owned() } else { shown(token) },
            message: detail.message,
            expected: detail.expected,
            help: detail.help,
            excerpt: Excerpt::new(place),
            earlier: detail.earlier.map(|(place, label)| Earlier { excerpt: Excerpt::new(place), label }),
        }
    }

    /// Where in the snippet's text the excerpts lie, and what is written there.
    fn to_codespan(&self) -> codespan::Diagnostic<()> {
        let mut labels = Vec::new();
        let mut offset = 0;
        if let Some(earlier) = &self.earlier {
            labels.push(codespan::Label::secondary((), earlier.excerpt.mark.clone()).with_message(earlier.label));
            offset = earlier.excerpt.text.len();
        }
        let mark = self.excerpt.mark.start + offset..self.excerpt.mark.end + offset;
        labels.push(codespan::Label::primary((), mark).with_message(&self.expected));
        codespan::Diagnostic::new(self.severity.into())
            .with_message(&self.message)
            .with_labels(labels)
            .with_notes_iter(self.help.iter().map(|help| format!("help: {help}")))
    }
}

impl From<Severity> for codespan::Severity {
    fn from(severity: Severity) -> Self {
        match severity {
            Severity::Error => Self::Error,
            Severity::Warning => Self::Warning,
        }
    }
}

/// Shows diagnostics with their source lines, one after the other; with ANSI colours if `color`.
pub(crate) fn render(file: &str, diagnostics: &[Diagnostic], omitted: &[Omitted], color: bool) -> String {
    let mut buffer = if color { Buffer::ansi() } else { Buffer::no_color() };
    let config = term::Config::default();
    let file = visible(file);
    for diagnostic in diagnostics {
        let snippet = Snippet::new(&file, diagnostic);
        emit(&mut buffer, &config, &snippet, &diagnostic.to_codespan());
    }
    let nowhere = Snippet { file: &file, text: String::new(), lines: Vec::new() };
    for rest in omitted {
        let diagnostic = codespan::Diagnostic::new(rest.severity.into()).with_message(rest);
        emit(&mut buffer, &config, &nowhere, &diagnostic);
    }
    String::from_utf8_lossy(buffer.as_slice()).into_owned()
}

fn emit(buffer: &mut Buffer, config: &term::Config, snippet: &Snippet<'_>, diagnostic: &codespan::Diagnostic<()>) {
    let shown = term::emit_to_write_style(buffer, config, snippet, diagnostic);
    debug_assert!(shown.is_ok(), "writing to memory cannot fail and the labels lie within the snippet: {shown:?}");
}

/// The part of a line around a token, safe to print.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Excerpt {
    line: usize,
    /// Of the mark's first character in the whole line, from 1.
    column: usize,
    /// Ends with a line feed.
    text: String,
    /// The token in `text`.
    mark: Range<usize>,
}

impl Excerpt {
    fn new(place: Location<'_>) -> Self {
        let Span { start, end } = place.span;
        let bytes = place.line.bytes;
        let from = character_start(bytes, start.saturating_sub(SHOWN_BEFORE));
        let to = character_start(bytes, bytes.len().min(start + SHOWN_FROM));
        let end = end.min(to);
        let mut text = String::new();
        if from > 0 {
            text.push('…');
        }
        push_visible(&mut text, &bytes[from..start]);
        let mark = text.len();
        push_visible(&mut text, &bytes[start..end]);
        let mark = mark..text.len();
        push_visible(&mut text, &bytes[end..to]);
        if to < bytes.len() {
            text.push('…');
        }
        text.push('\n');
        Self { line: place.line.number, column: column(place), text, mark }
    }
}

/// The first byte of the UTF-8 character that `at` points into; `at` itself where the bytes are not UTF-8.
fn character_start(bytes: &[u8], at: usize) -> usize {
    let is_start = |&at: &usize| bytes.get(at).is_none_or(|byte| byte & 0xC0 != 0x80);
    (at.saturating_sub(3)..=at).rev().find(is_start).unwrap_or(at)
}

/// The one or two lines that a diagnostic shows, as the "file" that codespan sees.
struct Snippet<'a> {
    file: &'a str,
    text: String,
    lines: Vec<SnippetLine>,
}

struct SnippetLine {
    /// What codespan takes for the line's index: neighbours in the file are neighbours here, others far apart, which
    /// makes it draw a gap.
    index: usize,
    number: usize,
    column: usize,
    range: Range<usize>,
}

impl<'a> Snippet<'a> {
    fn new(file: &'a str, diagnostic: &Diagnostic) -> Self {
        let mut snippet = Self { file, text: String::new(), lines: Vec::new() };
        if let Some(earlier) = &diagnostic.earlier {
            snippet.push(&earlier.excerpt);
        }
        snippet.push(&diagnostic.excerpt);
        snippet
    }

    fn push(&mut self, excerpt: &Excerpt) {
        let index = match self.lines.last() {
            None => 0,
            Some(last) if excerpt.line == last.number + 1 => last.index + 1,
            Some(last) => last.index + 3,
        };
        let start = self.text.len();
        self.text.push_str(&excerpt.text);
        let (number, column) = (excerpt.line, excerpt.column);
        self.lines.push(SnippetLine { index, number, column, range: start..self.text.len() });
    }

    fn line(&self, index: usize) -> Result<&SnippetLine, FilesError> {
        let given = FilesError::LineTooLarge { given: index, max: self.lines.last().map_or(0, |line| line.index) };
        self.lines.iter().find(|line| line.index == index).ok_or(given)
    }
}

impl<'a> Files<'a> for Snippet<'_> {
    type FileId = ();
    type Name = &'a str;
    type Source = &'a str;

    fn name(&'a self, (): ()) -> Result<&'a str, FilesError> {
        Ok(self.file)
    }

    fn source(&'a self, (): ()) -> Result<&'a str, FilesError> {
        Ok(&self.text)
    }

    fn line_index(&'a self, (): (), byte_index: usize) -> Result<usize, FilesError> {
        let line = self.lines.iter().rev().find(|line| line.range.start <= byte_index);
        line.map(|line| line.index).ok_or(FilesError::FileMissing)
    }

    fn line_number(&'a self, (): (), line_index: usize) -> Result<usize, FilesError> {
        Ok(self.line(line_index)?.number)
    }

    /// Always the mark's: codespan asks only where a label starts, and each line has one label.
    fn column_number(&'a self, (): (), line_index: usize, _: usize) -> Result<usize, FilesError> {
        Ok(self.line(line_index)?.column)
    }

    fn line_range(&'a self, (): (), line_index: usize) -> Result<Range<usize>, FilesError> {
        Ok(self.line(line_index)?.range.clone())
    }
}

/// Column of the place's first character in the line, from 1; nothing is copied, the line may be of any length.
fn column(place: Location<'_>) -> usize {
    let before = &place.line.bytes[..place.span.start];
    let characters =
        before.utf8_chunks().map(|chunk| chunk.valid().chars().count() + usize::from(!chunk.invalid().is_empty()));
    characters.sum::<usize>() + 1
}

/// A token for use in a message: safe to print, cut if it is long.
pub(crate) fn shown(token: &[u8]) -> String {
    // No character takes more than 4 bytes; one more than are shown tells whether something is cut.
    let mut text = String::new();
    push_visible(&mut text, &token[..token.len().min(4 * (TOKEN_SHOWN + 1))]);
    match text.char_indices().nth(TOKEN_SHOWN) {
        Some((cut, _)) => format!("{}…", &text[..cut]),
        None => text,
    }
}
