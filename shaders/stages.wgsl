// A picture in stages, each over those alone that need it: see_tiles of slots_tiles.wgsl or see_samples of slots_list.wgsl, then
// walk_paths of paths.wgsl for each bounce.
//
// All lanes of a workgroup go the same way, whether they see something or not: software devices execute both sides of a branch
// anyway.

// How many paths there are; stage.wgsl goes from one bounce to the next.
struct Stage {
    // Paths of this bounce, and so far of the next.
    path_count: u32,
    next_path_count: atomic<u32>,
}

@group(0) @binding(12) var<storage, read_write> stage: Stage;
