// One sample of one pixel: its primary ray, and what follows from it.
// needs: bound, counters, effects, film, path, ray, search

// Column and row of a sample in its pixel, as src/pattern.rs has it: row by row in a grid; or each has its own.
fn sample_place(sample: u32) -> vec2<u32> {
    if SIDE == SAMPLES {
        return vec2(sample);
    }
    return vec2(sample % SIDE, sample / SIDE);
}

fn trace(pixel: vec2<u32>, first_slot: u32, sample: u32) {
    let slot = first_slot + sample;
    begin(slot);
    begin_bound();
    let ray = primary_ray(pixel * SIDE + sample_place(sample));
    let hit = nearest_seen(ray, pixel);
    keep_status(slot, hit.found);
    follow(ray, hit, slot);
}
