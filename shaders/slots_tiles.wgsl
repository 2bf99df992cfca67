// Which pixel a slot belongs to: 64 pixels of each tile, row by row.

fn pixel_of(slot: u32) -> vec2<u32> {
    let pixel = slot / (SAMPLES * SAMPLES);
    let in_tile = pixel % 64u;
    return tiles[pixel / 64u] + vec2(in_tile % 8u, in_tile / 8u);
}
