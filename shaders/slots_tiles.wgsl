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

// Eight invocations in turn have a block of 4 x 2 pixels, so that vectors of eight lanes have few edges in them: the bits of the column
// are 0, 1 and 3 of the index, those of the row 2, 4 and 5.
fn place_in_tile(index: u32) -> vec2<u32> {
    return vec2((index & 3u) | ((index >> 1u) & 4u), ((index >> 2u) & 1u) | ((index >> 3u) & 6u));
}

// One workgroup casts the primary rays of one tile and shades what they hit.
@compute @workgroup_size(TILE_PIXELS)
fn trace_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    params = given_params;
    load_lights();
    let word = tiles.words[group.x / 4u][group.x % 4u];
    let row = word >> tiles.column_bits;
    let tile = vec2(word - (row << tiles.column_bits), tiles.first_row + row);
    let place = place_in_tile(index);
    trace_pixel(tile * TILE + place, (group.x * TILE_PIXELS + place.y * TILE + place.x) * SAMPLES);
}
