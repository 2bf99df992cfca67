//! Names of files with the number of a frame in them.

use std::path::{Path, PathBuf};

/// Digits that are asked for at the most.
const MOST_DIGITS: usize = 20;

/// A name in which `%d` or, with zeros up to so many digits, `%04d` stands for the number; `%%` is a percent sign.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Pattern {
    before: String,
    digits: usize,
    after: String,
}

impl Pattern {
    /// What `path` says; otherwise why it is no pattern.
    pub(super) fn of(path: &Path) -> Result<Self, String> {
        let mut rest = path.to_str().ok_or("it is not UTF-8")?;
        let (mut text, mut found) = (String::new(), None);
        while let Some((plain, after)) = rest.split_once('%') {
            text += plain;
            let width = after.len() - after.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            let (width, after) = after.split_at(width);
            if let (true, Some(after)) = (width.is_empty(), after.strip_prefix('%')) {
                text.push('%');
                rest = after;
                continue;
            }
            let digits = if width.is_empty() { Ok(0) } else { width.parse().map_err(|_| ()) };
            match (digits, after.strip_prefix('d')) {
                (Ok(digits @ 0..=MOST_DIGITS), Some(after)) if width.is_empty() || width.starts_with('0') => {
                    if found.replace((std::mem::take(&mut text), digits)).is_some() {
                        return Err("it has the number of the frame twice".into());
                    }
                    rest = after;
                }
                _ => {
                    return Err(format!(
                        "there is neither d nor % nor digits such as 04 and d behind a % in `{plain}%`"
                    ));
                }
            }
        }
        text += rest;
        let (before, digits) = found.ok_or("it has no place for the number of the frame")?;
        Ok(Self { before, digits, after: text })
    }

    /// For names such as `frame_0001.png` beside `frame.png`; none where that is not UTF-8.
    pub(super) fn numbered(path: &Path) -> Option<Self> {
        let before = path.with_extension("").to_str()?.to_owned() + "_";
        let after = path.extension().map_or(Some(String::new()), |ending| Some(format!(".{}", ending.to_str()?)))?;
        Some(Self { before, digits: 4, after })
    }

    /// The name with this number.
    pub(super) fn path(&self, number: u32) -> PathBuf {
        let Self { before, digits, after } = self;
        format!("{before}{number:0digits$}{after}").into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(pattern: &str, number: u32) -> Result<String, String> {
        Ok(Pattern::of(Path::new(pattern))?.path(number).to_str().unwrap_or_default().to_owned())
    }

    #[test]
    fn numbers_take_their_place() {
        for (pattern, number, expected) in [
            ("frame_%04d.png", 7, "frame_0007.png"),
            ("%d.ppm", 12, "12.ppm"),
            ("100%%/%03d", 1234, "100%/1234"),
            ("a%%d%d%%", 5, "a%d5%"),
        ] {
            assert_eq!(name(pattern, number).as_deref(), Ok(expected), "{pattern}");
        }
    }

    #[test]
    fn what_is_no_pattern_is_refused() {
        for (pattern, why) in [
            ("frame.png", "no place"),
            ("%%d.png", "no place"),
            ("%d_%04d.png", "twice"),
            ("%4d.png", "neither"),
            ("%x.png", "neither"),
            ("%d%", "neither"),
            ("%099999999999999999999d", "neither"),
            ("%021d", "neither"),
        ] {
            assert!(name(pattern, 1).is_err_and(|error| error.contains(why)), "{pattern}: {:?}", name(pattern, 1));
        }
    }

    #[test]
    fn other_names_get_a_number() {
        let numbered = |path: &str| Pattern::numbered(Path::new(path)).map(|pattern| pattern.path(3));
        assert_eq!(numbered("out/a.b.ppm"), Some("out/a.b_0003.ppm".into()));
        assert_eq!(numbered("plain"), Some("plain_0003".into()));
    }
}
