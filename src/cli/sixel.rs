//! Pictures as sixels: in bands of six rows a character has the pixels of a column that are of one colour.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use color_quant::NeuQuant;

use crate::film::Picture;

/// Colours of a picture at the most, as most terminals have it.
const COLORS: usize = 256;
/// Rows of a band.
const BAND: u32 = 6;
/// Where there are more colours, about so many pixels are looked at for those that stand for them, which takes a tenth of a second.
const LOOKED_AT: u64 = 50_000;

/// `picture` for a terminal that shows sixels, in its own colours where it has few, without dithering. A terminal has levels in whole
/// percents.
pub(super) fn sixels(picture: &Picture) -> String {
    let (palette, index_of) = palette(picture);
    let mut text = format!("\x1bP0;1;0q\"1;1;{};{}", picture.width(), picture.height());
    for (index, color) in palette.iter().enumerate() {
        let [red, green, blue] = color.map(|level| (u32::from(level) * 100 + 127) / 255);
        let _ = write!(text, "#{index};2;{red};{green};{blue}");
    }
    for top in (0..picture.height()).step_by(BAND as usize) {
        let rows: Vec<_> = (top..picture.height().min(top + BAND)).map(|y| picture.row(y)).collect();
        let band: Vec<Vec<usize>> = rows.iter().map(|row| row.iter().map(|pixel| index_of[pixel]).collect()).collect();
        let present: BTreeSet<usize> = band.iter().flatten().copied().collect();
        for color in present {
            let _ = write!(text, "#{color}");
            let columns = (0..picture.width() as usize).map(|x| {
                let bits = band.iter().enumerate().filter(|(_, row)| row[x] == color).map(|(row, _)| 1 << row);
                b'?' + bits.sum::<u8>()
            });
            push_runs(&mut text, columns);
            text.push('$');
        }
        text.push('-');
    }
    text + "\x1b\\\n"
}

/// Characters, those that repeat as their number and the character.
fn push_runs(text: &mut String, characters: impl Iterator<Item = u8>) {
    let mut run = (0, 0);
    for character in characters.map(Some).chain([None]) {
        if character == Some(run.0) {
            run.1 += 1;
            continue;
        }
        match run {
            (_, 0..=3) => (0..run.1).for_each(|_| text.push(char::from(run.0))),
            (last, times) => _ = write!(text, "!{times}{}", char::from(last)),
        }
        run = (character.unwrap_or_default(), 1);
    }
}

/// The colours that stand for those of the picture, and which of them stands for each.
fn palette(picture: &Picture) -> (Vec<[u8; 3]>, BTreeMap<[u8; 3], usize>) {
    let own: BTreeSet<[u8; 3]> = picture.pixels().iter().copied().collect();
    if own.len() <= COLORS {
        let index_of = own.iter().enumerate().map(|(index, &color)| (color, index)).collect();
        return (own.into_iter().collect(), index_of);
    }
    let opaque = |[red, green, blue]: [u8; 3]| [red, green, blue, 255];
    let pixels: Vec<u8> = picture.pixels().iter().flat_map(|&pixel| opaque(pixel)).collect();
    // One of so many, of which the crate takes 30 at the most.
    let one_of = (picture.pixel_count() / LOOKED_AT).clamp(1, 30) as i32;
    let quantised = NeuQuant::new(one_of, COLORS, &pixels);
    let index_of = own.into_iter().map(|color| (color, quantised.index_of(&opaque(color)))).collect();
    (quantised.color_map_rgb().as_chunks::<3>().0.to_vec(), index_of)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a terminal shows: the levels of each pixel, in rows; `None` where it is no picture in sixels, or a pixel has no colour.
    fn shown(text: &str) -> Option<Vec<Vec<[u8; 3]>>> {
        let data = text.strip_prefix("\x1bP0;1;0q\"")?.strip_suffix("\x1b\\\n")?;
        let (size, mut rest) = data.split_at(data.find('#')?);
        let size: Vec<usize> = size.split(';').filter_map(|number| number.parse().ok()).collect();
        let mut rows = vec![vec![None; *size.get(2)?]; *size.get(3)?];
        let (mut palette, mut color, mut x, mut top, mut times) = (BTreeMap::new(), 0, 0, 0, 1);
        while let Some(command) = rest.bytes().next() {
            rest = &rest[1..];
            let end = rest.find(|c: char| !c.is_ascii_digit() && c != ';').unwrap_or(rest.len());
            let numbers: Vec<usize> = rest[..end].split(';').filter_map(|number| number.parse().ok()).collect();
            match (command, &numbers[..]) {
                (b'#', &[index, 2, red, green, blue]) => {
                    palette.insert(index, [red, green, blue].map(|part| ((part * 255 + 50) / 100) as u8));
                }
                (b'#', &[index]) => color = index,
                (b'!', &[count]) => times = count,
                (b'$', []) => x = 0,
                (b'-', []) => (x, top) = (0, top + 6),
                (b'?'..=b'~', []) => {
                    for row in (0..6).filter(|row| ((command - b'?') >> row) & 1 == 1) {
                        for pixel in rows.get_mut(top + row)?.get_mut(x..x + times)? {
                            assert_eq!(pixel.replace(*palette.get(&color)?), None, "drawn twice");
                        }
                    }
                    (x, times) = (x + times, 1);
                }
                _ => return None,
            }
            rest = &rest[end..];
        }
        rows.into_iter().map(|row| row.into_iter().collect()).collect()
    }

    fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 3]) -> Picture {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Picture::assemble(width, height, pixels.flat_map(|(x, y)| pixel(x, y)).collect())
    }

    #[test]
    fn few_colours_come_back_as_they_are() {
        // Levels that are whole percents; a last band of one row, runs and single pixels.
        let picture =
            picture(37, 13, |x, y| [51 * (x / 7 % 6) as u8, 51 * (y % 6) as u8, if x == y { 255 } else { 0 }]);
        let rows: Vec<Vec<[u8; 3]>> = picture.rows().map(<[_]>::to_vec).collect();
        assert_eq!(shown(&sixels(&picture)), Some(rows));
    }

    #[test]
    fn many_colours_are_near() {
        let picture = picture(96, 64, |x, y| [(2 * x) as u8, (4 * y) as u8, (x + y) as u8]);
        let rows = shown(&sixels(&picture)).unwrap_or_default();
        let distinct: BTreeSet<_> = rows.iter().flatten().collect();
        assert!((200..=COLORS).contains(&distinct.len()), "{}", distinct.len());
        let off = |(a, b): (&[u8; 3], &[u8; 3])| a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>();
        let errors: Vec<f64> = rows.iter().flatten().zip(picture.pixels()).map(off).collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        assert!(mean < 18.0 && errors.iter().all(|&error| error < 60.0), "{mean}");
    }
}
