//! PFM: numbers as they are, for programs.

/// A PFM file of `width` pixels a row with one number or three each: `Pf` or `PF`, little-endian, the last row first.
pub(crate) fn encode_pfm(width: u32, height: u32, channels: usize, values: &[f32]) -> Vec<u8> {
    let kind = if channels == 3 { "PF" } else { "Pf" };
    let mut file = format!("{kind}\n{width} {height}\n-1.0\n").into_bytes();
    for row in values.chunks_exact(width as usize * channels).rev() {
        file.extend(row.iter().flat_map(|value| value.to_le_bytes()));
    }
    file
}
