// A picture in stages, each over those alone that need it: see_tiles, then walk_paths for each bounce, which is in paths.wgsl.
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

// Tiles that a sphere may cover, column and row in 16 bits each. The length is a quarter of MAX_DISPATCH_TILES of
// src/gpu/render.rs.
@group(0) @binding(6) var<uniform> tiles: array<vec4<u32>, 4096>;

// One sample of one pixel: its primary ray, and what follows from it.
fn see(tile: vec2<u32>, index: u32, first_slot: u32, sample: u32) {
    let pixel = tile + vec2(index % 8u, index / 8u);
    let ray = primary_ray(pixel * SAMPLES + vec2(sample % SAMPLES, sample / SAMPLES));
    follow(ray, nearest_seen(ray, tile), first_slot + sample);
}

// One workgroup casts the primary rays of one tile and shades what they hit: samples row by row in the pixels of a tile, these
// row by row.
@compute @workgroup_size(64)
fn see_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    let packed_tile = tiles[group.x / 4u][group.x % 4u];
    let tile = vec2(packed_tile & 0xffffu, packed_tile >> 16u) * 8u;
    let first_slot = (group.x * 64u + index) * SAMPLES * SAMPLES;
    if SAMPLES == 1u {
        see(tile, index, first_slot, 0u);
    } else {
        var sample = 0u;
        loop {
            see(tile, index, first_slot, sample);
            sample++;
            if sample == SAMPLES * SAMPLES {
                break;
            }
        }
    }
}
