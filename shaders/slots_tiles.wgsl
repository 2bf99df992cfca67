// All pixels of tiles.
// needs: effects, film, scene, types
// host: DISPATCH_TILES, TILE, TILE_PIXELS

struct Tiles {
    // Bits of a tile's column in its word; those above them are its row, counted from this one.
    column_bits: u32,
    first_row: u32,
    // Above the flags of a status byte.
    dispatch_bits: u32,
    // Tiles that a sphere may cover.
    @align(16) words: array<vec4<u32>, DISPATCH_TILES / 4u>,
}

@group(0) @binding(6) var<uniform> tiles: Tiles;

fn dispatch_bits() -> u32 {
    return tiles.dispatch_bits;
}

// One workgroup casts the primary rays of one tile, row by row, and shades what they hit.
@compute @workgroup_size(TILE_PIXELS)
fn trace_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    params = given_params;
    load_lights();
    let word = tiles.words[group.x / 4u][group.x % 4u];
    let row = word >> tiles.column_bits;
    let tile = vec2(word - (row << tiles.column_bits), tiles.first_row + row);
    let pixel = tile * TILE + vec2(index % TILE, index / TILE);
    trace_pixel(pixel, (group.x * TILE_PIXELS + index) * SAMPLES * SAMPLES);
}
