// Refracted rays with what rounding took from their directions.

// From the origin, the ray's direction times the ratio, plus the offset; a ratio of 1 keeps the low part too.
fn bent_ray(ray: Ray, origin: Point, ratio: real, offset: vec3r) -> Ray {
    return ray_with(origin, Pair3(ray.direction.hi * ratio + offset, ray.direction.lo * ratio));
}
