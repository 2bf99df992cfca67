// The mirrored view ray and what every secondary ray shares.
// needs: ray, real, shade
// host: MAX_THROUGHPUT

// The mirrored view ray, of unit length.
fn reflection_ray(surface: Surface) -> Ray {
    let n_dot_v = dot(surface.normal, surface.view);
    return ray_from(surface.position, surface.normal * (n_dot_v + n_dot_v) - surface.view);
}

// The weight of a ray that `coefficient` of what has this weight follows.
fn weakened(throughput: real, coefficient: real) -> real {
    return max(min(throughput * coefficient, MAX_THROUGHPUT), -MAX_THROUGHPUT);
}
