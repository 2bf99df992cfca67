//! Pictures of samples on their way to the page, which shows each pixel as its nearest sample.
//!
//! [`SAMPLE_MAP`] says, once for many pictures, which sample a pixel shows: in little-endian `u32`s [`SAMPLE_MAP`], its
//! number, the picture's width and height, the number of samples, and the slot that the page keeps all this in, below
//! [`SLOTS`]; then for each pixel in reading order how many columns to the right and how many rows down its nearest sample lies, a signed byte
//! each. Samples are the pixels where both are 0.
//!
//! [`SAMPLE_COLORS`] is one picture: [`SAMPLE_COLORS`], its number, width and height, the number of samples, the slot of
//! their map; then the colour of each in reading order, 3 bytes.

/// First word of a message with a map of samples.
pub const SAMPLE_MAP: u32 = 3;
/// First word of a message with the colours of samples.
pub const SAMPLE_COLORS: u32 = 4;

/// How many maps a page keeps at the most.
pub const SLOTS: u32 = 4;

/// Which sample each pixel shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SampleMap {
    /// Size of the picture in pixels.
    pub size: (u32, u32),
    /// Number of samples.
    pub count: u32,
    /// The offset from each pixel to its nearest sample, in columns and rows.
    pub offsets: Vec<[i8; 2]>,
    /// Whether all offsets fit into their bytes.
    pub fits: bool,
}

/// The colours of a picture's samples.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SampleColors {
    /// Size of the picture in pixels.
    pub size: (u32, u32),
    /// 3 bytes a sample, in reading order.
    pub rgb: Vec<u8>,
}

impl SampleMap {
    /// From where the nearest sample of each pixel lies, packed as in [`crate::sampling::packed`].
    pub fn new(size: (u32, u32), owners: &[u32]) -> Self {
        let (mut count, mut fits) = (0, true);
        let mut offsets = Vec::with_capacity(owners.len());
        for (row, owners) in (0_i32..).zip(owners.chunks(size.0 as usize)) {
            for (column, owner) in (0_i32..).zip(owners) {
                let offset = [(owner & 0xffff).cast_signed() - column, (owner >> 16).cast_signed() - row];
                count += u32::from(offset == [0, 0]);
                fits &= offset.iter().all(|part| i8::try_from(*part).is_ok());
                offsets.push(offset.map(|part| part as i8));
            }
        }
        Self { size, count, offsets, fits }
    }

    /// The message; its number is written where it is sent.
    pub fn encode(&self, slot: u32) -> Vec<u8> {
        let mut message = head([SAMPLE_MAP, 0, self.size.0, self.size.1, self.count, slot], 2 * self.offsets.len());
        message.extend_from_slice(bytemuck::cast_slice(&self.offsets));
        message
    }
}

impl SampleColors {
    /// The message; its number is written where it is sent.
    pub fn encode(&self, slot: u32) -> Vec<u8> {
        let count = (self.rgb.len() / 3) as u32;
        let mut message = head([SAMPLE_COLORS, 0, self.size.0, self.size.1, count, slot], self.rgb.len());
        message.extend_from_slice(&self.rgb);
        message
    }
}

fn head(words: [u32; 6], rest: usize) -> Vec<u8> {
    let mut message = Vec::with_capacity(4 * words.len() + rest);
    message.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    message
}
