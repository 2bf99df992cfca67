// A picture in stages, each over those alone that need it: see_tiles of slots_tiles.wgsl or see_samples of slots_list.wgsl, then,
// where paths are kept, walk_paths of walk_at_once.wgsl or walk_in_turn.wgsl for each bounce.

// How many paths there are; stage.wgsl goes from one bounce to the next.
struct Stage {
    // Paths of this bounce, and so far of the next.
    path_count: u32,
    next_path_count: atomic<u32>,
}

@group(0) @binding(12) var<storage, read_write> stage: Stage;

// One sample of one pixel: its primary ray, and what follows from it.
fn see(pixel: vec2<u32>, first_slot: u32, sample: u32) {
    let slot = first_slot + sample;
    begin(slot);
    let ray = primary_ray(pixel * SAMPLES + vec2(sample % SAMPLES, sample / SAMPLES));
    let hit = nearest_seen(ray, pixel);
    keep_status(slot);
    follow(ray, hit, slot);
}
