// Several samples a pixel: their results are colours, of which the pixel is the mean.

@group(0) @binding(7) var<storage, read_write> colors: array<vec3r>;

fn finish(slot: u32, color: vec3r) {
    // No colour at all, as the status of the pixel will say.
    var zero = real(0.0);
    colors[slot] = select(color, vec3r(real(1.0) / zero), is_cut);
}

// Row by row in the pixel.
fn see_pixel(pixel: vec2<u32>, first_slot: u32) {
    var sample = 0u;
    loop {
        see(pixel, first_slot, sample);
        sample++;
        if sample == SAMPLES * SAMPLES {
            break;
        }
    }
    // The first that was left out stands for all: it has no path that could finish it later.
    if sample < SAMPLES * SAMPLES {
        is_cut = true;
        finish(first_slot + sample, vec3r());
    }
}
