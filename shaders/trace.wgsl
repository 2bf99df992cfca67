// One sample of one pixel: its primary ray, and what follows from it.
// needs: bound, counters, effects, film, path, ray, search

fn trace(pixel: vec2<u32>, first_slot: u32, sample: u32) {
    let slot = first_slot + sample;
    begin(slot);
    begin_bound();
    let ray = primary_ray(pixel * SAMPLES + vec2(sample % SAMPLES, sample / SAMPLES));
    let hit = nearest_seen(ray, pixel);
    keep_status(slot, hit.found);
    follow(ray, hit, slot);
}
