// Numbers in textures, bit for bit what buffers would hold: software devices load from a texture for all lanes at once, from a
// storage buffer lane by lane. See tables_*.wgsl for their types, vector_from in vectors_*.wgsl for numbers.

// The place of a texel; rows have 2^12: ROW in src/gpu/upload.rs.
fn place_of_texel(index: u32) -> vec2<u32> {
    return vec2<u32>(index & 4095u, index >> 12u);
}

// The numbers with this index, four to a vector.
fn vector_at(table: Table, index: u32) -> vec4r {
    return vector_from(table, TEXELS * index);
}
