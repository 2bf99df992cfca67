// All pixels of tiles.

// Tiles that a sphere may cover, column and row in 16 bits each. The length is a quarter of MAX_DISPATCH_TILES of
// src/gpu/render.rs.
@group(0) @binding(6) var<uniform> tiles: array<vec4<u32>, 4096>;

// One sample of one pixel: its primary ray, and what follows from it.
fn see(tile: vec2<u32>, index: u32, first_slot: u32, sample: u32) {
    let pixel = tile + vec2(index % 8u, index / 8u);
    let ray = primary_ray(pixel * SAMPLES + vec2(sample % SAMPLES, sample / SAMPLES));
    begin(first_slot + sample);
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
