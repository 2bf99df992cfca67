// The mirrored view ray and what every secondary ray shares.

// The mirrored view ray, of unit length.
fn reflection_ray(surface: Surface) -> Ray {
    let n_dot_v = dot(surface.normal, surface.view);
    return ray_from(surface.position, surface.normal * (n_dot_v + n_dot_v) - surface.view);
}

// Not the index of any shape: a primary ray leaves no sphere.
const NO_SHAPE: u32 = 0xffffffffu;

// Mirrors with Kr > 1 and glass with Kt > 1 amplify no further, or products would overflow; whatever is lit at all is white
// long before.
const MAX_THROUGHPUT: real = real(1e30);
