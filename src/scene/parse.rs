//! From the bytes of a scene file to the model.
//!
//! One statement a line; a line ends with LF, CRLF or CR. Fields are separated by blanks and tabs, `#` starts a comment,
//! a UTF-8 byte order mark before the first line is skipped. A line with an error does not stop the parser: all errors
//! of the file are found in one run.

mod keyword;
mod number;
mod piece;

use glam::DVec3;

pub(super) use self::keyword::{Field, Keyword};
use self::keyword::{Guess, MAX_FIELDS, Rule};
use self::number::is_tiny;
pub(crate) use self::number::{Fault, parse_number};
use super::diagnostics::{Collector, Detail, Diagnostic, Line, Location, Omitted, Span, Topic, render, shown};
use super::{Light, MAX_RESOLUTION, Names, Scene, Sphere, Window};
use crate::words::{count, is_hidden};

/// What a scene file was found to be.
#[derive(Debug, Clone)]
pub struct Parsed {
    /// The scene; `None` if there are errors.
    pub scene: Option<Scene>,
    /// Errors and warnings in the order of the file: the first 50 errors, and of each kind of warning the first 20.
    pub diagnostics: Vec<Diagnostic>,
    /// What was counted beyond those.
    pub omitted: Vec<Omitted>,
    /// How many errors there are, those not kept included; 0 exactly if there is a scene.
    pub errors: usize,
    /// How many warnings there are, those not kept included.
    pub warnings: usize,
    file: String,
}

impl Parsed {
    /// What a collector of diagnostics says of a file; the scene goes where there are errors.
    pub(crate) fn of(file: &str, scene: Option<Scene>, collector: Collector) -> Self {
        let (errors, warnings) = (collector.error_count(), collector.warning_count());
        let (diagnostics, omitted) = collector.finish();
        let scene = scene.filter(|_| errors == 0);
        Self { scene, diagnostics, omitted, errors, warnings, file: file.to_owned() }
    }

    /// All diagnostics as text for people, each with its source line; with ANSI colours if `color`.
    ///
    /// Empty if there are none, else it ends with a blank line.
    pub fn report(&self, color: bool) -> String {
        render(&self.file, &self.diagnostics, &self.omitted, color)
    }
}

/// Reads a scene. `file` is only the name that the report shows; `text` may be any bytes of any length.
///
/// Takes time linear in the length of `text` and no memory beyond the scene and a bounded number of diagnostics.
pub fn parse(file: &str, text: &[u8]) -> Parsed {
    let mut parser = Parser::default();
    if text.starts_with(b"\xFF\xFE") || text.starts_with(b"\xFE\xFF") {
        parser.refuse_utf16(text);
    } else {
        parser.run(text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text), piece::SIZE);
    }
    parser.finish(file)
}

/// Whether a token begins a statement of a scene.
pub(crate) fn is_statement(token: &[u8]) -> bool {
    Keyword::from_token(token).is_some()
}

/// Where the fields of a line are. One is reused for all lines.
struct Tokens {
    spans: [Span; Self::KEPT],
    /// How many there are in the line, those not kept included.
    count: usize,
}

impl Tokens {
    /// The longest statement (keyword, name and numbers) and the first token too many.
    const KEPT: usize = 2 + MAX_FIELDS + 1;

    const fn new() -> Self {
        Self { spans: [Span { start: 0, end: 0 }; Self::KEPT], count: 0 }
    }

    fn split(&mut self, line: &[u8]) {
        self.count = 0;
        let mut at = 0;
        loop {
            at += length(&line[at..], |byte| matches!(byte, b' ' | b'\t'));
            let start = at;
            at += length(&line[at..], |byte| !matches!(byte, b' ' | b'\t' | b'#'));
            if start == at {
                return;
            }
            if let Some(span) = self.spans.get_mut(self.count) {
                *span = Span { start, end: at };
            }
            self.count += 1;
        }
    }

    fn kept(&self) -> &[Span] {
        &self.spans[..self.count.min(Self::KEPT)]
    }

    /// The empty place behind the last token.
    fn end(&self) -> Span {
        let end = self.kept().last().map_or(0, |last| last.end);
        Span { start: end, end }
    }
}

/// How many bytes at the start of `bytes` are all of a kind.
fn length(bytes: &[u8], kind: impl Fn(u8) -> bool) -> usize {
    bytes.iter().position(|&byte| !kind(byte)).unwrap_or(bytes.len())
}

/// The line at the start of `text`, and how many bytes it takes with its end.
pub(crate) fn first_line(text: &[u8]) -> (&[u8], usize) {
    match memchr::memchr2(b'\n', b'\r', text) {
        None => (text, text.len()),
        Some(end) => (&text[..end], end + if text[end..].starts_with(b"\r\n") { 2 } else { 1 }),
    }
}

/// The numbers of one statement; behind the last one 0, but 1 for `eta`.
type Values = [f64; MAX_FIELDS];

const NO_VALUES: Values = {
    let mut values = [0.0; MAX_FIELDS];
    values[MAX_FIELDS - 1] = 1.0;
    values
};

/// A statement that may occur only once.
#[derive(Clone, Copy)]
struct Single<'a> {
    line: Line<'a>,
    keyword: Span,
    /// The first field.
    field: Span,
    /// `None` if there are errors in it.
    values: Option<Values>,
}

#[derive(Default)]
struct Parser<'a> {
    /// The first of each statement that may occur only once, by `Keyword as usize`.
    singles: [Option<Single<'a>>; Keyword::ALL.len()],
    /// Whether an unknown keyword was probably meant to be this one: then it is not reported as missing.
    misspelt: [bool; Keyword::ALL.len()],
    spheres: Vec<Sphere>,
    sphere_names: Names,
    lights: Vec<Light>,
    light_names: Names,
    output: Option<String>,
    /// What follows the line that is being read.
    rest: &'a [u8],
    /// The number of the line that the next one with a statement was found to continue.
    broken: Option<usize>,
    collector: Collector,
}

impl<'a> Parser<'a> {
    fn run(&mut self, text: &'a [u8], piece: usize) {
        let last = self.lines(text, piece);
        // Of an empty file it is the first, too.
        self.require_statements(Line { number: last.number.max(1), ..last });
        self.check_window();
    }

    fn statement(&mut self, line: Line<'a>, tokens: &Tokens) {
        let Some(&first) = tokens.kept().first() else {
            return;
        };
        let broken = self.broken.take();
        let Some(keyword) = Keyword::from_token(line.token(first)) else {
            return self.refuse_keyword(line.place(first), broken);
        };
        let values = self.fields(keyword, line, tokens);
        match keyword {
            Keyword::Sphere => self.sphere(line, tokens, values),
            Keyword::Light => self.light(line, tokens, values),
            _ => {
                let field = tokens.kept().get(1).copied().unwrap_or_default();
                self.single(keyword, Single { line, keyword: first, field, values });
            }
        }
    }

    /// The numbers of a statement, or `None` if there are errors, which are reported.
    fn fields(&mut self, keyword: Keyword, line: Line<'_>, tokens: &Tokens) -> Option<Values> {
        let form = keyword.form();
        let first = 1 + usize::from(form.named);
        let given = tokens.count.saturating_sub(first);
        let complete = tokens.count >= first && form.takes(given);
        let mut values = NO_VALUES;
        let mut valid = complete;
        let spans = tokens.kept().get(first..).unwrap_or_default();
        for ((value, field), &span) in values.iter_mut().zip(form.fields).zip(spans) {
            let place = line.place(span);
            match self.number(keyword, field, place) {
                // Where the count is wrong it is unknown which field a number is meant for.
                Some(number) if complete => {
                    *value = number;
                    valid &= self.check(keyword, field, number, place);
                }
                Some(number) => *value = number,
                None => valid = false,
            }
        }
        if !complete {
            self.broken = is_continued(keyword, tokens, self.rest).then_some(line.number);
            let broken = self.broken.is_some();
            self.collector.error(wrong_count_place(keyword, line, tokens), || {
                wrong_count(keyword, line, tokens, &values, broken)
            });
        }
        valid.then_some(values)
    }

    fn number(&mut self, keyword: Keyword, field: &Field, place: Location<'_>) -> Option<f64> {
        let token = place.line.token(place.span);
        if field.rule == Rule::Pixels {
            let pixels = parse_pixels(token);
            if pixels.is_none() {
                self.collector.error(place, || not_pixels(keyword, field, token));
            }
            return pixels;
        }
        match parse_number(token) {
            Ok(number) => Some(number),
            Err(fault) => {
                self.collector.error(place, || not_a_number(keyword, field, token, fault));
                None
            }
        }
    }

    /// Whether the field takes the number; an error is reported if not, a warning if the number is unusual.
    fn check(&mut self, keyword: Keyword, field: &Field, number: f64, place: Location<'_>) -> bool {
        let token = place.line.token(place.span);
        if is_tiny(number, token) {
            self.collector.warning(Topic::Tiny, place, || {
                Detail::new(format!("`{}` is too near to 0 for full precision", shown(token)), "read as about 0")
            });
        }
        if !field.rule.takes(number) {
            self.collector.error(place, || out_of_range(keyword, field, token));
            return false;
        }
        let usual = match field.rule {
            Rule::Any | Rule::Pixels | Rule::NonZero | Rule::Positive | Rule::NotNegative => true,
            Rule::Color | Rule::Coefficient => (0.0..=1.0).contains(&number),
            Rule::Intensity => number >= 0.0 && number != WHITE_LEVEL,
        };
        if !usual {
            let topic = match field.rule {
                Rule::Color => Topic::Color,
                Rule::Coefficient => Topic::Coefficient,
                _ => Topic::Intensity,
            };
            self.collector.warning(topic, place, || unusual(keyword, field, token, number));
        }
        true
    }

    fn sphere(&mut self, line: Line<'_>, tokens: &Tokens, values: Option<Values>) {
        let Some([px, py, pz, sx, sy, sz, r, g, b, ka, kd, ks, kr, n, kt, eta]) = values else {
            return;
        };
        self.spheres.push(Sphere {
            center: DVec3::new(px, py, pz),
            scale: DVec3::new(sx, sy, sz),
            color: DVec3::new(r, g, b),
            ka,
            kd,
            ks,
            kr,
            n,
            kt,
            eta,
        });
        push_name(&mut self.sphere_names, line.token(tokens.spans[1]));
    }

    fn light(&mut self, line: Line<'_>, tokens: &Tokens, values: Option<Values>) {
        let Some([px, py, pz, r, g, b, ..]) = values else {
            return;
        };
        self.lights.push(Light { position: DVec3::new(px, py, pz), intensity: DVec3::new(r, g, b) });
        push_name(&mut self.light_names, line.token(tokens.spans[1]));
    }

    fn single(&mut self, keyword: Keyword, single: Single<'a>) {
        if let Some(first) = self.singles[keyword as usize] {
            let place = single.line.place(single.keyword);
            return self.collector.error(place, || second(keyword, first));
        }
        if keyword == Keyword::Output && single.values.is_some() {
            let place = single.line.place(single.field);
            match file_name(single.line.token(single.field)) {
                Ok(name) => self.output = Some(name.to_owned()),
                Err(fault) => self.collector.error(place, || bad_output(place, &fault)),
            }
        }
        self.singles[keyword as usize] = Some(single);
    }

    /// `broken` is the line that this one probably continues.
    fn refuse_keyword(&mut self, place: Location<'_>, broken: Option<usize>) {
        let token = place.line.token(place.span);
        let Guess { keyword, help } = keyword::guess(token);
        if let Some(keyword) = keyword {
            self.misspelt[keyword as usize] = true;
        }
        self.collector.error(place, || {
            let help = match broken {
                Some(line) => format!("the statement of line {line} is broken over two lines: write it in one"),
                None => invisible(token).unwrap_or(help),
            };
            Detail::new(format!("unknown keyword `{}`", shown(token)), "expected a keyword").help(help)
        });
    }

    fn refuse_utf16(&mut self, text: &[u8]) {
        let place = Line { number: 1, bytes: &text[..2] }.place(Span { start: 0, end: 2 });
        self.collector.error(place, || {
            Detail::new("the file is UTF-16 text", "expected plain text (ASCII or UTF-8)")
                .help("in the editor, choose the encoding UTF-8 in \"Save as\"")
        });
    }

    fn require_statements(&mut self, last: Line<'_>) {
        let end = Span { start: last.bytes.len(), end: last.bytes.len() };
        for keyword in Keyword::REQUIRED {
            if self.singles[keyword as usize].is_none() && !self.misspelt[keyword as usize] {
                self.collector.error(last.place(end), || missing(keyword));
            }
        }
    }

    /// Whether the edges of the window, each valid by itself, make a window.
    fn check_window(&mut self) {
        for (low, high) in [(Keyword::Left, Keyword::Right), (Keyword::Bottom, Keyword::Top)] {
            let (Some(first), Some(second)) = (self.singles[low as usize], self.singles[high as usize]) else {
                continue;
            };
            let (Some([from, ..]), Some([to, ..])) = (first.values, second.values) else {
                continue;
            };
            let later = if first.line.number > second.line.number { first } else { second };
            let place = later.line.place(later.field);
            if from == to {
                self.collector.error(place, || empty_window(low, high));
            } else if !(to - from).is_finite() {
                self.collector.error(place, || huge_window(low, high));
            } else if from > to {
                self.collector.warning(Topic::Window, place, || mirrored_window(low, high));
            }
        }
    }

    fn finish(self, file: &str) -> Parsed {
        let singles = self.singles;
        let values = |keyword: Keyword| singles[keyword as usize].and_then(|single| single.values).unwrap_or(NO_VALUES);
        let color = |keyword| DVec3::from_slice(&values(keyword)[..3]);
        let [width, height, ..] = values(Keyword::Res);
        let scene = || Scene {
            window: Window {
                near: values(Keyword::Near)[0],
                left: values(Keyword::Left)[0],
                right: values(Keyword::Right)[0],
                bottom: values(Keyword::Bottom)[0],
                top: values(Keyword::Top)[0],
            },
            width: width as u32,
            height: height as u32,
            spheres: self.spheres,
            sphere_names: self.sphere_names,
            lights: self.lights,
            light_names: self.light_names,
            background: color(Keyword::Back),
            ambient: color(Keyword::Ambient),
            output: self.output,
        };
        let scene = (self.collector.error_count() == 0).then(scene);
        Parsed::of(file, scene, self.collector)
    }
}

fn push_name(names: &mut Names, token: &[u8]) {
    match str::from_utf8(token) {
        Ok(name) => names.push(name),
        Err(_) => names.push(&String::from_utf8_lossy(token)),
    }
}

/// A count of pixels per axis; exact in `f64`.
fn parse_pixels(token: &[u8]) -> Option<f64> {
    let text = str::from_utf8(token).ok()?;
    let pixels: u32 = text.parse().ok()?;
    (1..=MAX_RESOLUTION).contains(&pixels).then_some(pixels.into())
}

/// Why an `OUTPUT` is refused.
enum NameFault {
    Encoding,
    Folder,
    Hidden,
    Quotes,
}

/// The name of a file in the working directory.
fn file_name(token: &[u8]) -> Result<&str, NameFault> {
    let name = str::from_utf8(token).map_err(|_| NameFault::Encoding)?;
    let drive = matches!(token, [letter, b':', ..] if letter.is_ascii_alphabetic());
    if drive || matches!(name, "." | "..") || name.contains(['/', '\\']) {
        return Err(NameFault::Folder);
    }
    if name.contains(is_hidden) {
        return Err(NameFault::Hidden);
    }
    let quotes = ['"', '\'', '`', '“', '”', '‘', '’'];
    if name.starts_with(quotes) || name.ends_with(quotes) {
        return Err(NameFault::Quotes);
    }
    Ok(name)
}

fn bad_output(place: Location<'_>, fault: &NameFault) -> Detail<'static> {
    let message = format!("OUTPUT `{}` is not a plain file name", shown(place.line.token(place.span)));
    match fault {
        NameFault::Encoding => Detail::new(message, "expected a file name in UTF-8"),
        NameFault::Hidden => Detail::new(message, "expected a file name without control or invisible characters"),
        NameFault::Quotes => Detail::new(message, "expected a file name without quotes around it")
            .help("quotes are not part of the format: write the name alone"),
        NameFault::Folder => Detail::new(message, "expected a file name without a folder")
            .help("OUTPUT names a file, not a path; use -o to choose a folder"),
    }
}

fn second(keyword: Keyword, first: Single<'_>) -> Detail<'_> {
    let text = keyword.text();
    let message = format!("a second {text}; the first is in line {}", first.line.number);
    let mut detail = Detail::new(message, format!("expected only one {text} in the file"));
    detail.earlier = Some((first.line.place(first.keyword), "the first is here"));
    detail
}

fn missing(keyword: Keyword) -> Detail<'static> {
    let text = keyword.text();
    let mut detail = Detail::new(format!("the scene has no {text}"), format!("expected a line `{}`", keyword.usage()));
    detail.absent = "end of file";
    detail
}

fn empty_window(low: Keyword, high: Keyword) -> Detail<'static> {
    let (low, high) = (low.text(), high.text());
    Detail::new(format!("{low} and {high} are the same"), format!("expected {low} and {high} to differ"))
        .help("the window on the image plane has no extent; usual are -1 and 1")
}

fn huge_window(low: Keyword, high: Keyword) -> Detail<'static> {
    let (low, high) = (low.text(), high.text());
    Detail::new(format!("{low} and {high} are too far apart"), "expected a window whose extent is a finite number")
}

fn mirrored_window(low: Keyword, high: Keyword) -> Detail<'static> {
    let (low, high) = (low.text(), high.text());
    Detail::new(format!("{low} is greater than {high}"), format!("usually {low} is less than {high}"))
        .help("the picture will be mirrored")
}

fn out_of_range(keyword: Keyword, field: &Field, token: &[u8]) -> Detail<'static> {
    let (text, name, token) = (keyword.text(), field.name, shown(token));
    let expected = format!("{}: {}", field.rule.expected(), field.about);
    let detail = Detail::new(format!("`{name}` of {text} cannot be {token}"), expected);
    match (keyword, field.rule) {
        (_, Rule::NonZero) => {
            detail.help("a sphere without thickness cannot be rendered; use a small scale like 0.001")
        }
        (Keyword::Near, _) => detail.help("the image plane lies in front of the eye, at z = -n"),
        _ => detail,
    }
}

fn unusual(keyword: Keyword, field: &Field, token: &[u8], number: f64) -> Detail<'static> {
    let (text, name, token) = (keyword.text(), field.name, shown(token));
    let (fault, usual) = match field.rule {
        Rule::Intensity if number > 0.0 => ("far beyond 1", "usually about 0 to 1"),
        Rule::Intensity => ("negative", "usually 0 or more"),
        _ => ("outside 0 to 1", "usually 0 to 1"),
    };
    let detail = Detail::new(format!("`{name}` of {text} is {fault}: {token}"), format!("{usual}: {}", field.about));
    match level(field.rule, number) {
        Some(part) => detail.help(format!("{token} looks like a level of 0 to 255; colours are 0 to 1: write {part}")),
        None => detail,
    }
}

/// The greatest 8-bit level.
const WHITE_LEVEL: f64 = 255.0;

/// What a colour or intensity is that was written as an 8-bit level, such as 1 for 255.
fn level(rule: Rule, number: f64) -> Option<f64> {
    let is_level = match rule {
        Rule::Color => number.fract() == 0.0 && (2.0..=WHITE_LEVEL).contains(&number),
        // Lights may be brighter than 1.
        Rule::Intensity => number == WHITE_LEVEL,
        _ => false,
    };
    is_level.then(|| (number / WHITE_LEVEL * 1000.0).round() / 1000.0)
}

fn not_a_number(keyword: Keyword, field: &Field, token: &[u8], fault: Fault) -> Detail<'static> {
    let shown = shown(token);
    let message = match fault {
        Fault::Syntax => format!("`{shown}` is not a number"),
        Fault::NotFinite => format!("`{shown}` is not a finite number"),
        Fault::Overflow => format!("`{shown}` is too large, numbers reach up to about 1.8e308"),
    };
    let expected = format!("expected a number: `{}` of {}, {}", field.name, keyword.text(), field.about);
    Detail { help: number_help(token), ..Detail::new(message, expected) }
}

fn not_pixels(keyword: Keyword, field: &Field, token: &[u8]) -> Detail<'static> {
    let shown = shown(token);
    let expected = format!("expected a whole number, 1 to {MAX_RESOLUTION}: {}", field.about);
    let message = format!("`{shown}` is not a number of pixels");
    let help = match parse_number(token) {
        Ok(number) if number.fract() == 0.0 && (1.0..=MAX_RESOLUTION as f64).contains(&number) => {
            Some(format!("{} takes whole numbers only: write {number}", keyword.text()))
        }
        Ok(_) => None,
        Err(_) => number_help(token),
    };
    Detail { help, ..Detail::new(message, expected) }
}

/// How to write a number that other programs or languages write as `token`.
fn number_help(token: &[u8]) -> Option<String> {
    if let Some(help) = invisible(token) {
        return Some(help);
    }
    let text = str::from_utf8(token).ok()?;
    let fixed = |text: &str| parse_number(text.as_bytes()).is_ok().then(|| shown(text.as_bytes()));
    if let Some(number) = fixed(&text.replace(['−', '–', '—'], "-")) {
        return Some(format!("write the minus sign as `-`: {number}"));
    }
    if let Some(number) = fixed(text.trim_end_matches([',', ';'])) {
        return Some(format!("fields are separated by blanks only: write {number}"));
    }
    if let Some(number) = fixed(&text.replacen(',', ".", 1)) {
        return Some(format!("write the decimal point as `.`: {number}"));
    }
    if text.split(',').all(|part| fixed(part).is_some()) {
        return Some("fields are separated by blanks, not by commas".to_owned());
    }
    if let Some(number) = fixed(text.trim_end_matches(['f', 'F'])) {
        return Some(format!("write the number without the letter: {number}"));
    }
    let unsigned = text.trim_start_matches(['+', '-']);
    (unsigned.starts_with("0x") || unsigned.starts_with("0X")).then(|| "numbers are decimal".to_owned())
}

/// Names the first character that looks like a blank, or like nothing, but is part of the token.
fn invisible(token: &[u8]) -> Option<String> {
    let is_invisible = |&c: &char| c.is_whitespace() || is_hidden(c);
    let hidden = token.utf8_chunks().flat_map(|chunk| chunk.valid().chars()).find(is_invisible)?;
    let code = u32::from(hidden);
    Some(format!("it contains the invisible character U+{code:04X}; fields are separated by blanks and tabs only"))
}

/// The first token too many, or the end of the line if one is missing.
fn wrong_count_place<'a>(keyword: Keyword, line: Line<'a>, tokens: &Tokens) -> Location<'a> {
    let form = keyword.form();
    let most = 1 + usize::from(form.named) + form.fields.len();
    let surplus = tokens.kept().get(most).copied();
    line.place(surplus.unwrap_or_else(|| tokens.end()))
}

/// Whether the next line with anything in it begins with a number and has no more fields than a statement lacks.
fn is_continued(keyword: Keyword, tokens: &Tokens, rest: &[u8]) -> bool {
    let form = keyword.form();
    let most = 1 + usize::from(form.named) + form.fields.len();
    let mut rest = rest;
    let mut next = Tokens::new();
    while !rest.is_empty() {
        let (line, taken) = first_line(rest);
        rest = &rest[taken..];
        next.split(line);
        if let Some(&first) = next.kept().first() {
            // A name may come first where not even that is there.
            let named = form.named && tokens.count == 1;
            let number = next.kept().get(usize::from(named)).copied().unwrap_or(first);
            let is_number = parse_number(&line[number.start..number.end]).is_ok();
            let is_keyword = Keyword::from_token(&line[first.start..first.end]).is_some();
            return is_number && !is_keyword && tokens.count + next.count <= most;
        }
    }
    false
}

/// What to say of a statement with too few or too many fields; `values` are its numbers as far as they are numbers.
fn wrong_count(keyword: Keyword, line: Line<'_>, tokens: &Tokens, values: &Values, broken: bool) -> Detail<'static> {
    let form = keyword.form();
    let text = keyword.text();
    let given = tokens.count - 1;
    if form.named && given == 0 && !broken {
        return Detail::new(format!("{text} has no name"), "expected a name")
            .help(format!("the line is written `{}`", keyword.usage()));
    }
    let numbers = given.saturating_sub(usize::from(form.named));
    let found = format!("{text} has {}", count(numbers as u64, "field"));
    let after = if form.named { " after its name" } else { "" };
    let wanted = match (form.least(), form.fields.len()) {
        (least, most) if least == most => least.to_string(),
        (least, most) => format!("{least} or {most}"),
    };
    let expected = match form.fields.get(numbers) {
        Some(field) => format!("expected `{}`, {}", field.name, field.about),
        None => "expected the end of the line".to_owned(),
    };
    let mut help = format!("the line is written `{}`", keyword.usage());
    let hint = || count_hint(keyword, line, tokens, values);
    let broken = broken.then(|| "the statement is broken over two lines: write it in one".to_owned());
    if let Some(hint) = broken.or_else(hint) {
        help = format!("{hint}\n{help}");
    }
    Detail::new(format!("{found}{after} instead of {wanted}"), expected).help(help)
}

/// The likely reason for a wrong number of fields.
fn count_hint(keyword: Keyword, line: Line<'_>, tokens: &Tokens, values: &Values) -> Option<String> {
    let form = keyword.form();
    let token = |index: usize| tokens.kept().get(index).map_or(&b""[..], |&span| line.token(span));
    let numbers = tokens.count.saturating_sub(1 + usize::from(form.named));
    if line.bytes.get(tokens.end().end) == Some(&b'#') && tokens.count <= Tokens::KEPT && numbers < form.least() {
        return Some("`#` starts a comment, also within a word".to_owned());
    }
    if let Some(other) = tokens.kept().iter().skip(1).find_map(|&span| Keyword::from_token(line.token(span))) {
        return Some(format!("one statement a line: put {} on a line of its own", other.text()));
    }
    if form.named && numbers > form.least() && parse_number(token(2)).is_err() {
        return Some("a name cannot contain blanks".to_owned());
    }
    let one_missing = numbers + 1 == form.least();
    if form.named && one_missing && parse_number(token(1)).is_ok() {
        return Some(format!("is the name missing? `{}` was taken for it", shown(token(1))));
    }
    if keyword == Keyword::Sphere && one_missing && values[numbers - 1] > 1.0 {
        let last = shown(token(tokens.count - 1));
        return Some(format!("the last number, {last}, looks like `n`: is one before it missing, such as `Kr`?"));
    }
    if keyword == Keyword::Sphere && numbers == form.fields.len() - 1 {
        return Some("`Kt` and `eta` come together".to_owned());
    }
    None
}
