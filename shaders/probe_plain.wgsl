// Rays of a batch for kernels without low parts.

fn probe_ray(index: u32) -> Ray {
    return ray_from(probe_vector(6u * index), probe_vector(6u * index + 3u));
}
