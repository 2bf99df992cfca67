//! Pixels on their way to the page.
//!
//! A patch is, in little-endian `u32`s: [`PATCH`], its number, the picture's width and height, the step k, the number of
//! rectangles; then for each rectangle its left, top, width and height in pixels of the picture, followed by its pixels, 3
//! bytes each, row by row. With step k > 1 each pixel that is sent stands for k × k of the picture, whose corner it has.

/// First word of a message with pixels.
pub const PATCH: u32 = 1;
/// First word of a message whose rest, from the third word on, is a PNG file.
pub const PICTURE_FILE: u32 = 2;

/// A rectangle of the picture, in its pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rectangle {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// A message with pixels that is being written, or has been read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Patch {
    /// Size of the picture in pixels.
    pub size: (u32, u32),
    /// Pixels of the picture that one sent pixel stands for, on each side.
    pub step: u32,
    /// The rectangles with their pixels, 3 bytes each.
    pub parts: Vec<(Rectangle, Vec<u8>)>,
}

impl Patch {
    /// Columns and rows that are sent of a rectangle.
    pub fn sent(&self, part: &Rectangle) -> (usize, usize) {
        (part.width.div_ceil(self.step) as usize, part.height.div_ceil(self.step) as usize)
    }

    /// The message; its number is written where it is sent.
    pub fn encode(&self) -> Vec<u8> {
        let bytes = 24 + self.parts.iter().map(|(_, rgb)| 16 + rgb.len()).sum::<usize>();
        let mut message = Vec::with_capacity(bytes);
        let head = [PATCH, 0, self.size.0, self.size.1, self.step, self.parts.len() as u32];
        message.extend(head.iter().flat_map(|word| word.to_le_bytes()));
        for (part, rgb) in &self.parts {
            message.extend([part.x, part.y, part.width, part.height].iter().flat_map(|side| side.to_le_bytes()));
            message.extend_from_slice(rgb);
        }
        message
    }

    /// Reads a message; `None` where it is none.
    pub fn decode(message: &[u8]) -> Option<Self> {
        let (head, mut rest) = words::<6>(message)?;
        let [PATCH, _, width, height, step, count] = head else { return None };
        if step == 0 {
            return None;
        }
        let mut patch = Self { size: (width, height), step, parts: Vec::new() };
        for _ in 0..count {
            let ([x, y, width, height], tail) = words(rest)?;
            let part = Rectangle { x, y, width, height };
            let (columns, rows) = patch.sent(&part);
            let (rgb, tail) = tail.split_at_checked(columns * rows * 3)?;
            patch.parts.push((part, rgb.to_vec()));
            rest = tail;
        }
        rest.is_empty().then_some(patch)
    }
}

/// The first words, and the rest.
fn words<const N: usize>(message: &[u8]) -> Option<([u32; N], &[u8])> {
    let (head, rest) = message.split_at_checked(4 * N)?;
    let words = head.as_chunks::<4>().0;
    Some((std::array::from_fn(|index| u32::from_le_bytes(words[index])), rest))
}
