// Vectors of four f64 in tables of u32, and their bits.
// needs: real, texture

fn double_from(low: u32, high: u32) -> f64 {
    return bitcast<f64>(u64(low) | (u64(high) << 32u));
}

// The vector of four numbers that begins with this texel.
fn vector_from(table: Table, first: u32) -> vec4r {
    let a = texel_at(table, first);
    let b = texel_at(table, first + 1u);
    return vec4r(double_from(a.x, a.y), double_from(a.z, a.w), double_from(b.x, b.y), double_from(b.z, b.w));
}

fn two_words(x: f64) -> vec2<u32> {
    let bits = bitcast<u64>(x);
    return vec2<u32>(u32(bits), u32(bits >> 32u));
}

// Texels of a vector, and each of them.
const TEXELS: u32 = 2u;

fn texel_of(v: vec4r, part: u32) -> vec4<u32> {
    let half = select(v.xy, v.zw, part == 1u);
    return vec4<u32>(two_words(half.x), two_words(half.y));
}

// What stands in place of the fourth number, if that is a u32.
fn bits_at(table: Table, index: u32) -> u32 {
    return texel_at(table, 2u * index + 1u).z;
}
