// Differences of numbers that nearly cancel: plain ones.
// needs: real

// a - b; what rounding takes does not matter here.
struct Difference {
    hi: vec3r,
    lo: vec3r,
}

fn difference(a: vec3r, b: vec3r) -> Difference {
    return Difference(a - b, vec3r());
}

// origin + t direction.
fn along(origin: vec3r, direction: vec3r, t: real) -> vec3r {
    return origin + direction * t;
}
