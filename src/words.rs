//! Words for people: counts, numbers, and names that a terminal neither obeys nor hides.

use std::path::Path;

/// `1 sphere`, `2 spheres`.
pub(crate) fn count(number: impl Into<u64>, noun: &str) -> String {
    match number.into() {
        1 => format!("1 {noun}"),
        number => format!("{number} {noun}s"),
    }
}

/// A calculated number without the last digits, which are rounding's, and with an exponent where it would be long.
pub(crate) fn number(x: f64) -> String {
    let rounded: f64 = format!("{x:.12e}").parse().unwrap_or(x);
    if rounded == 0.0 || (1e-6..1e15).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

/// Text safe to print, whoever wrote it: see [`push_visible`].
pub(crate) fn visible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    push_visible(&mut shown, text.as_bytes());
    shown
}

/// A path, safe to print.
pub(crate) fn visible_path(path: &Path) -> String {
    let mut shown = String::new();
    push_visible(&mut shown, path.as_os_str().as_encoded_bytes());
    shown
}

/// Several lines of text, each safe to print.
pub(crate) fn visible_lines(text: &str) -> String {
    text.split('\n').map(visible).collect::<Vec<_>>().join("\n")
}

/// Appends text character by character; each sequence that is not UTF-8 becomes one replacement character, characters that a
/// terminal obeys or hides are escaped.
pub(crate) fn push_visible(text: &mut String, bytes: &[u8]) {
    for chunk in bytes.utf8_chunks() {
        for c in chunk.valid().chars() {
            match c {
                '\t' => text.push(c),
                // The control pictures.
                '\0'..='\u{1F}' => text.push(char::from_u32(0x2400 + c as u32).unwrap_or(char::REPLACEMENT_CHARACTER)),
                '\u{7F}' => text.push('␡'),
                _ if is_hidden(c) => text.extend(c.escape_unicode()),
                _ => text.push(c),
            }
        }
        if !chunk.invalid().is_empty() {
            text.push(char::REPLACEMENT_CHARACTER);
        }
    }
}

/// Control characters, marks that cannot be seen and those that reverse the direction of writing: Unicode's categories Cc, Cf,
/// Zl and Zp.
pub(crate) fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{AD}'
            | '\u{600}'..='\u{605}'
            | '\u{61C}'
            | '\u{6DD}'
            | '\u{70F}'
            | '\u{890}'..='\u{891}'
            | '\u{8E2}'
            | '\u{180E}'
            | '\u{200B}'..='\u{200F}'
            | '\u{2028}'..='\u{202E}'
            | '\u{2060}'..='\u{206F}'
            | '\u{FEFF}'
            | '\u{FFF9}'..='\u{FFFB}'
            | '\u{110BD}'
            | '\u{110CD}'
            | '\u{13430}'..='\u{1343F}'
            | '\u{1BCA0}'..='\u{1BCA3}'
            | '\u{1D173}'..='\u{1D17A}'
            | '\u{E0001}'
            | '\u{E0020}'..='\u{E007F}')
}

/// How many letters must be inserted, removed, replaced or swapped with their neighbour to turn `a` into `b`; of texts whose lengths
/// differ by more than any caller accepts, too many.
pub(crate) fn slips(a: &[u8], b: &str) -> usize {
    if a.len().abs_diff(b.len()) > 2 { usize::MAX } else { strsim::osa_distance(&String::from_utf8_lossy(a), b) }
}
