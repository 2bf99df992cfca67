// Vectors of four f32 in tables, and their bits.
// needs: real, texture

// The vector of four numbers that begins with this texel.
fn vector_from(table: Table, first: u32) -> vec4r {
    return bitcast<vec4<f32>>(texel_at(table, first));
}

// Texels of a vector, and each of them.
const TEXELS: u32 = 1u;

fn texel_of(v: vec4r, part: u32) -> vec4<u32> {
    return bitcast<vec4<u32>>(v);
}

// What stands in place of the fourth number, if that is a u32.
fn bits_at(table: Table, index: u32) -> u32 {
    return texel_at(table, index).w;
}
