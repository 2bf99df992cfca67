// One sample of one pixel: its primary ray, and what follows from it.
// needs: counters, effects, film, path, ray, search

fn trace(pixel: vec2<u32>, first_slot: u32, sample: u32) {
    let slot = first_slot + sample;
    begin(slot);
    let ray = primary_ray(pixel * SAMPLES + vec2(sample % SAMPLES, sample / SAMPLES));
    let hit = nearest_seen(ray, pixel);
    keep_status(slot);
    follow(ray, hit, slot);
}
