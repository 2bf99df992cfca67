// Several samples a pixel, or colours that are wanted themselves: results are colours, of which the pixel is the mean.
// needs: counters, effects, real, slots, trace
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
    var status = real(dispatch_bits()) + select(real(0.0), real(STATUS_CUT), is_cut);
    if CERTIFIED {
        // Nobody knows how far the mean of several is off.
        status += real(STATUS_UNSURE);
    } else if TANGENTS | LINEAR {
        status += colors[slot].w;
    }
    colors[slot] = vec4r(color, status);
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
