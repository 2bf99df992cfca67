// Numbers in the texels of textures.
// needs: real, texture, vectors
// host: ROW_BITS

// The place of a texel.
fn place_of_texel(index: u32) -> vec2<u32> {
    return vec2<u32>(index & ((1u << ROW_BITS) - 1u), index >> ROW_BITS);
}

// The numbers with this index, four to a vector.
fn vector_at(table: Table, index: u32) -> vec4r {
    return vector_from(table, TEXELS * index);
}
