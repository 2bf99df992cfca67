// Refracted rays of kernels without low parts.

// From the origin, the ray's direction times the ratio, plus the offset.
fn bent_ray(ray: Ray, origin: Point, ratio: real, offset: vec3r) -> Ray {
    return ray_from(origin, ray.direction * ratio + offset);
}
