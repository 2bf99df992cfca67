// The scalar of the kernel: f32.

alias real = f32;
alias vec2r = vec2<f32>;
alias vec3r = vec3<f32>;
alias vec4r = vec4<f32>;

// Greater roots, infinity and NaN are never a hit.
const FAR: real = 3e38;

fn is_finite(x: real) -> bool {
    // By the bits: comparisons with NaN may be folded away.
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}
