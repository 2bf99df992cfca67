// One sample a pixel: its result is the pixel.
// needs: bound, counters, effects, quantize, real, slots, trace
// host: STATUS_CUT, STATUS_UNSURE

// Red, green, blue in the low bytes, status in the high one.
@group(0) @binding(7) var<storage, read_write> pixels: array<u32>;

// What the primary ray says of itself, for whoever finishes its path.
fn keep_status(slot: u32, hits: bool) {
    if TANGENTS {
        pixels[slot] = select(0u, STATUS_UNSURE << 24u, is_unsure);
    }
}

fn finish(slot: u32, color: vec3r) {
    var status = (dispatch_bits() | select(0u, STATUS_CUT, is_cut)) << 24u;
    if TANGENTS {
        status |= pixels[slot] & (STATUS_UNSURE << 24u);
    }
    var pixel = levels(color);
    if CERTIFIED {
        pixel = bound_levels(pixel);
        status |= select(STATUS_UNSURE << 24u, 0u, has_sure_levels(color) & !is_unsure);
    }
    pixels[slot] = pixel | status;
}

fn trace_pixel(pixel: vec2<u32>, slot: u32) {
    trace(pixel, slot, 0u);
}
