// Differences of numbers that nearly cancel.
// needs: barrier, real

// a - b and what rounding takes from it (two_sum of eft.wgsl); nothing breaks where a compiler loses the latter.
struct Difference {
    hi: vec3r,
    lo: vec3r,
}

fn difference(a: vec3r, b: vec3r) -> Difference {
    let hi = a - b;
    let b_part = barrier3(hi) - a;
    let a_part = barrier3(hi - b_part);
    return Difference(hi, (a - a_part) - (b + b_part));
}

// origin + t direction where the two nearly cancel: the product of the upper halves is exact, so that only the sum is rounded,
// and the rest is small.
fn along(origin: vec3r, direction: vec3r, t: real) -> vec3r {
    let upper = bitcast<vec3<f32>>(bitcast<vec3<u32>>(direction) & vec3<u32>(0xfffff000u));
    let t_upper = bitcast<f32>(bitcast<u32>(t) & 0xfffff000u);
    return (origin + upper * t_upper) + (upper * (t - t_upper) + (direction - upper) * t);
}
