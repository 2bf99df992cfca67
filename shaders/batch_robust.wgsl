// Rays of a batch with what rounding took from them.
// needs: eft, probe, ray, real, types
// host: SMALL_GROUP

@group(0) @binding(14) var<storage, read> probe_low: array<real>;

fn probe_vector_low(at: u32) -> vec3r {
    return vec3r(probe_low[at], probe_low[at + 1u], probe_low[at + 2u]);
}

fn probe_ray(index: u32) -> Ray {
    let origin = Pair3(probe_vector(6u * index), probe_vector_low(6u * index));
    return ray_with(origin, Pair3(probe_vector(6u * index + 3u), probe_vector_low(6u * index + 3u)));
}

// The residuals of the error-free sum and product of two numbers.
@compute @workgroup_size(SMALL_GROUP)
fn probe_transforms(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    let a = probe_reals[6u * id.x];
    let b = probe_reals[6u * id.x + 1u];
    probe_flags[id.x] = vec2<u32>(bitcast<u32>(two_sum(a, b).lo), bitcast<u32>(two_product(a, b).lo));
    // 0, from the parameters, which stay bound so even where no barrier reads them.
    probe_values[id.x] = real(params.zero);
}
