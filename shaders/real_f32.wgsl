// The scalar of the kernel: f32.

alias real = f32;
alias vec3r = vec3<f32>;

// Greater roots, infinity and NaN are never a hit.
const FAR: real = 3e38;

fn is_finite(x: real) -> bool {
    // By the bits: comparisons with NaN may be folded away.
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// ln(1 - d) for d in [0, 1): a series where 1 - d would lose the digits of d.
fn log1m(d: real) -> real {
    if d < 0.05 {
        return -d * (1.0 + d * (1.0 / 2.0 + d * (1.0 / 3.0 + d * (1.0 / 4.0 + d * (1.0 / 5.0 + d * (1.0 / 6.0))))));
    }
    return log(1.0 - d);
}

fn exponential(x: real) -> real {
    return exp(x);
}
