// Numbers in the texels of textures.
// needs: real, texture, vectors

// The place of a texel; rows have 2^12: ROW in src/gpu/upload.rs.
fn place_of_texel(index: u32) -> vec2<u32> {
    return vec2<u32>(index & 4095u, index >> 12u);
}

// The numbers with this index, four to a vector.
fn vector_at(table: Table, index: u32) -> vec4r {
    return vector_from(table, TEXELS * index);
}
