// One sample a pixel: its result is the pixel.

// Red, green, blue in the low bytes, status in the high one.
@group(0) @binding(7) var<storage, read_write> pixels: array<u32>;

fn finish(slot: u32, color: vec3r) {
    pixels[slot] = packed_pixel(color) | select(0u, STATUS_CUT << 24u, is_cut);
}

fn see_pixel(pixel: vec2<u32>, slot: u32) {
    see(pixel, slot, 0u);
}
