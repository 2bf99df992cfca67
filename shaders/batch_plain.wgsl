// Rays of a batch as plain vectors.
// needs: probe, ray

fn probe_ray(index: u32) -> Ray {
    return ray_from(probe_vector(6u * index), probe_vector(6u * index + 3u));
}
