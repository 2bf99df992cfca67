// All pixels of tiles.

// Tiles that a sphere may cover, column and row in 16 bits each. The length is a quarter of MAX_DISPATCH_TILES of
// src/gpu/render.rs.
@group(0) @binding(6) var<uniform> tiles: array<vec4<u32>, 4096>;

// One workgroup casts the primary rays of one tile, row by row, and shades what they hit.
@compute @workgroup_size(64)
fn see_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    params = given_params;
    load_lights();
    let tile = tiles[group.x / 4u][group.x % 4u];
    let pixel = vec2(tile & 0xffffu, tile >> 16u) * 8u + vec2(index % 8u, index / 8u);
    see_pixel(pixel, (group.x * 64u + index) * SAMPLES * SAMPLES);
}
