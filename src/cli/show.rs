//! `trueray render --show`: the picture in the terminal.

use std::fmt::Write as _;
use std::io::IsTerminal as _;

use base64::prelude::{BASE64_STANDARD, Engine as _};
use clap::ValueEnum;

use super::failure::{Failure, OUTPUT};
use super::output::out;
use super::sixel::sixels;
use crate::film::{Picture, encode_png};

/// Columns where there is no terminal that tells its own.
const COLUMNS: u32 = 80;
/// Pixels of a column where the terminal does not tell.
const COLUMN_PIXELS: u32 = 8;
/// Bytes of a picture in one command of the kitty graphics protocol at the most.
const CHUNK: usize = 4096;

/// How a terminal is given a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Show {
    /// `kitty` where standard output is kitty, which `KITTY_WINDOW_ID` or `TERM` says; otherwise `blocks`
    Auto,
    /// Half blocks of 24-bit colour
    Blocks,
    /// The kitty graphics protocol
    Kitty,
    /// Sixels of 256 colours
    Sixel,
}

impl Show {
    /// What `Auto` stands for here.
    fn decided(self) -> Self {
        let is_kitty = || {
            std::env::var_os("KITTY_WINDOW_ID").is_some()
                || std::env::var("TERM").is_ok_and(|terminal| terminal.contains("kitty"))
        };
        match self {
            Self::Auto if is_kitty() && std::io::stdout().is_terminal() => Self::Kitty,
            Self::Auto => Self::Blocks,
            decided => decided,
        }
    }
}

/// Prints `picture` to standard output, no wider than the terminal.
pub(super) fn show(picture: &Picture, how: Show) -> Result<(), Failure> {
    let columns = terminal_size::terminal_size().map_or(COLUMNS, |(width, _)| u32::from(width.0));
    match how.decided() {
        Show::Auto | Show::Blocks => out!("{}", half_blocks(&reduced(picture, columns))),
        Show::Kitty => {
            let file = encode_png(picture.width(), picture.height(), picture.rgb());
            let failed = |error| Failure::new(OUTPUT, format!("cannot encode the picture to show: {error}"));
            out!("{}", kitty(&file.map_err(failed)?, columns));
        }
        Show::Sixel => {
            let pixels = terminal_pixels().unwrap_or(columns.saturating_mul(COLUMN_PIXELS));
            out!("{}", sixels(&reduced(picture, pixels)));
        }
    }
    Ok(())
}

/// Pixels across the terminal, where it tells them.
#[cfg(unix)]
fn terminal_pixels() -> Option<u32> {
    let size = rustix::termios::tcgetwinsize(std::io::stdout()).ok()?;
    (size.ws_xpixel > 0).then_some(u32::from(size.ws_xpixel))
}

#[cfg(not(unix))]
fn terminal_pixels() -> Option<u32> {
    None
}

/// A PNG file by the kitty graphics protocol, as wide as the terminal.
fn kitty(file: &[u8], columns: u32) -> String {
    let data = BASE64_STANDARD.encode(file);
    let mut text = String::new();
    let mut control = format!("a=T,f=100,c={columns},");
    let mut rest = data.as_str();
    while !rest.is_empty() {
        let (part, after) = rest.split_at(rest.len().min(CHUNK));
        let _ = write!(text, "\x1b_G{control}m={};{part}\x1b\\", u8::from(!after.is_empty()));
        control.clear();
        rest = after;
    }
    text + "\n"
}

/// Two rows of pixels a line: the upper half of each character in one colour, the lower in another.
fn half_blocks(picture: &Picture) -> String {
    let mut text = String::new();
    for upper in (0..picture.height()).step_by(2) {
        for column in 0..picture.width() {
            let [red, green, blue] = picture.pixel(column, upper);
            let _ = write!(text, "\x1b[38;2;{red};{green};{blue}m");
            if upper + 1 < picture.height() {
                let [red, green, blue] = picture.pixel(column, upper + 1);
                let _ = write!(text, "\x1b[48;2;{red};{green};{blue}m");
            }
            text.push('▀');
        }
        text += "\x1b[0m\n";
    }
    text
}

/// The picture, where it is wider than `most` made smaller by means of its levels.
fn reduced(picture: &Picture, most: u32) -> Picture {
    let width = most.clamp(1, picture.width());
    let height = (u64::from(picture.height()) * u64::from(width)).div_ceil(u64::from(picture.width())) as u32;
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    Picture::assemble(width, height, places.flat_map(|place| mean(picture, place, [width, height])).collect())
}

/// The mean of the pixels under one of a smaller picture of this size.
fn mean(picture: &Picture, [x, y]: [u32; 2], [width, height]: [u32; 2]) -> [u8; 3] {
    let range = |at: u32, count: u32, whole: u32| {
        let start = |at: u32| (u64::from(at) * u64::from(whole) / u64::from(count)) as u32;
        start(at)..start(at + 1).max(start(at) + 1).min(whole)
    };
    let (columns, rows) = (range(x, width, picture.width()), range(y, height, picture.height()));
    let pixels = u64::from(columns.end - columns.start) * u64::from(rows.end - rows.start);
    let mut sums = [0_u64; 3];
    for row in rows {
        for pixel in &picture.row(row)[columns.start as usize..columns.end as usize] {
            sums = std::array::from_fn(|c| sums[c] + u64::from(pixel[c]));
        }
    }
    sums.map(|sum| ((sum + pixels / 2) / pixels) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, height: u32, level: impl Fn(u32, u32) -> u8) -> Picture {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Picture::assemble(width, height, pixels.flat_map(|(x, y)| [level(x, y); 3]).collect())
    }

    #[test]
    fn two_rows_share_a_line_and_a_last_one_has_its_own() {
        let text = half_blocks(&picture(1, 3, |_, y| y as u8));
        assert_eq!(text, "\x1b[38;2;0;0;0m\x1b[48;2;1;1;1m▀\x1b[0m\n\x1b[38;2;2;2;2m▀\x1b[0m\n");
    }

    #[test]
    fn wide_pictures_are_made_smaller_by_means() {
        let text = half_blocks(&reduced(&picture(160, 4, |x, _| if x % 2 == 0 { 10 } else { 20 }), 80));
        assert_eq!(text.lines().count(), 1);
        assert_eq!(text.matches("\x1b[38;2;15;15;15m\x1b[48;2;15;15;15m▀").count(), 80);
    }

    #[test]
    fn kitty_gets_a_file_in_parts() {
        let text = kitty(&[7; 2 * CHUNK], 40);
        let parts: Vec<_> = text.split("\x1b\\").collect();
        assert!(parts[0].starts_with("\x1b_Ga=T,f=100,c=40,m=1;") && parts[1].starts_with("\x1b_Gm=1;"), "{text}");
        assert!(parts[2].starts_with("\x1b_Gm=0;") && parts[3] == "\n", "{text}");
    }
}
