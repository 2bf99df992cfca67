// Several samples a pixel, or colours that are wanted themselves: results are colours, of which the pixel is the mean.
// needs: bound, counters, effects, real, slots, trace
// host: STATUS_CUT, STATUS_HIT, STATUS_UNSURE

// With the status, as a number.
@group(0) @binding(7) var<storage, read_write> colors: array<vec4r>;

// What the primary ray says of itself, for whoever finishes its path.
fn keep_status(slot: u32, hits: bool) {
    if TANGENTS | LINEAR {
        colors[slot].w = real(select(0u, STATUS_UNSURE, TANGENTS & is_unsure) | select(0u, STATUS_HIT, LINEAR & hits));
    }
}

fn finish(slot: u32, color: vec3r) {
    var status = dispatch_bits() | select(0u, STATUS_CUT, is_cut);
    if TANGENTS | LINEAR {
        status |= u32(colors[slot].w);
    }
    if CERTIFIED {
        // Nobody knows how far the mean of several is off.
        status |= select(STATUS_UNSURE, 0u, SAMPLES == 1u && has_sure_levels(color) && !is_unsure);
    }
    colors[slot] = vec4r(color, real(status));
}

fn trace_pixel(pixel: vec2<u32>, first_slot: u32) {
    var sample = 0u;
    loop {
        trace(pixel, first_slot, sample);
        sample++;
        if sample == SAMPLES {
            break;
        }
    }
    // The first that was left out stands for all: it has no path that could finish it later.
    if sample < SAMPLES {
        is_cut = true;
        keep_status(first_slot + sample, false);
        finish(first_slot + sample, vec3r());
    }
}
