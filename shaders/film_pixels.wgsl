// One sample a pixel: its result is the pixel.
// needs: counters, effects, quantize, real, see, slots
// host: STATUS_CUT, STATUS_UNSURE

// Red, green, blue in the low bytes, status in the high one.
@group(0) @binding(7) var<storage, read_write> pixels: array<u32>;

// What the primary ray says of itself, for whoever finishes its path.
fn keep_status(slot: u32) {
    if TANGENTS {
        pixels[slot] = select(0u, STATUS_UNSURE << 24u, is_unsure);
    }
}

fn finish(slot: u32, color: vec3r) {
    var status = (dispatch_bits() | select(0u, STATUS_CUT, is_cut)) << 24u;
    if TANGENTS {
        status |= pixels[slot] & (STATUS_UNSURE << 24u);
    }
    if CERTIFIED {
        // What is not finite here may be so with a greater range.
        let is_sure = !is_unsure & is_finite(color.x) & is_finite(color.y) & is_finite(color.z);
        status |= select(STATUS_UNSURE << 24u, 0u, is_sure);
    }
    pixels[slot] = packed_pixel(color) | status;
}

fn see_pixel(pixel: vec2<u32>, slot: u32) {
    see(pixel, slot, 0u);
}
