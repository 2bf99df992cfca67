// Rays in batches through the code that renders: src/gpu/run/probe.rs.
// needs: batch, distance, intersect, ray, real, reflect, refract, scene, search, shade, types
// host: POINT_VALUES, PROBE_BLOCKED, PROBE_FACING, PROBE_FINITE, PROBE_FOUND, PROBE_INSIDE, SMALL_GROUP

// Six numbers a ray: origin and direction.
@group(0) @binding(13) var<storage, read> probe_reals: array<real>;
// First sphere, one past the last, which range of roots, and one more than the index of the own sphere or 0.
@group(0) @binding(15) var<storage, read> probe_words: array<vec4<u32>>;
// Bits of what was found, and the sphere.
@group(0) @binding(16) var<storage, read_write> probe_flags: array<vec2<u32>>;
// The root or another real number; with the point of the hit, POINT_VALUES a ray.
@group(0) @binding(17) var<storage, read_write> probe_values: array<real>;

fn probe_vector(at: u32) -> vec3r {
    return vec3r(probe_reals[at], probe_reals[at + 1u], probe_reals[at + 2u]);
}

// Sets the ray's spheres; its own one, whose outside it leaves.
fn probe_own(words: vec4<u32>) -> Own {
    first_of_range = words.x;
    end_of_range = words.y;
    var own = Own(NO_SHAPE, false, vec3r());
    if words.w != 0u {
        own.shape = shape_of(words.w - 1u).index;
    }
    return own;
}

fn probe_hit(ray: Ray, words: vec4<u32>) -> Hit {
    let own = probe_own(words);
    var range = reflection_range();
    if words.z == 0u {
        range = primary_range();
    }
    return nearest_hit(ray, own, range);
}

fn hit_bits(hit: Hit) -> u32 {
    return select(0u, PROBE_FOUND, hit.found) | select(0u, PROBE_INSIDE, hit.inside)
        | select(0u, PROBE_FINITE, is_finite(nearest_real(hit.t)));
}

// Bits and sphere of a hit, and t.
fn answer(index: u32, at: u32, hit: Hit) {
    probe_flags[index] = vec2<u32>(hit_bits(hit), hit.sphere);
    probe_values[at] = nearest_real(hit.t);
}

fn store(at: u32, v: vec3r) {
    probe_values[at] = v.x;
    probe_values[at + 1u] = v.y;
    probe_values[at + 2u] = v.z;
}

// The same, and the place of the hit, what it carries of it besides, its normal, and the direction in which it mirrors the ray.
fn answer_with_point(index: u32, ray: Ray, hit: Hit) {
    let at = POINT_VALUES * index;
    answer(index, at, hit);
    let surface = surface_at(ray, hit, material_of(hit.sphere));
    store(at + 1u, high_of(surface.position));
    store(at + 4u, low_of(surface.position));
    store(at + 7u, surface.normal);
    store(at + 10u, direction_of(reflection_ray(surface)));
}

// The nearest hit.
@compute @workgroup_size(SMALL_GROUP)
fn probe_nearest(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    answer(id.x, id.x, probe_hit(probe_ray(id.x), probe_words[id.x]));
}

// The nearest hit and its point.
@compute @workgroup_size(SMALL_GROUP)
fn probe_point(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    let ray = probe_ray(id.x);
    answer_with_point(id.x, ray, probe_hit(ray, probe_words[id.x]));
}

// Whether something stands between the origin and t = 1.
@compute @workgroup_size(SMALL_GROUP)
fn probe_blocked(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    let blocked = any_hit(probe_ray(id.x), probe_own(probe_words[id.x]), Light(), 0u);
    probe_flags[id.x] = vec2<u32>(select(0u, PROBE_BLOCKED, blocked), 0u);
    probe_values[id.x] = real(0.0);
}

// The nearest hit, whether it faces the ray's own light, N.L, and whether something stands between.
@compute @workgroup_size(SMALL_GROUP)
fn probe_lit(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    let ray = probe_ray(id.x);
    let hit = probe_hit(ray, probe_words[id.x]);
    var bits = hit_bits(hit);
    var n_dot_l = real(0.0);
    if hit.found {
        let surface = surface_at(ray, hit, material_of(hit.sphere));
        let shadow_ray = ray_to_light(surface.position, light_of(id.x), id.x);
        n_dot_l = dot(surface.normal, direction_of(shadow_ray) * (real(1.0) / sqrt(shadow_ray.a)));
        bits |= select(0u, PROBE_FACING, n_dot_l > real(0.0));
        bits |= select(0u, PROBE_BLOCKED, any_hit(shadow_ray, surface.own, light_of(id.x), id.x));
    }
    probe_flags[id.x] = vec2<u32>(bits, hit.sphere);
    probe_values[id.x] = n_dot_l;
}

// The hit after as many reflections as the ray's third word says, and its point.
@compute @workgroup_size(SMALL_GROUP)
fn probe_bounce(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    let words = probe_words[id.x];
    var own = probe_own(words);
    var ray = probe_ray(id.x);
    var hit = nearest_hit(ray, own, reflection_range());
    for (var bounce = 0u; bounce < words.z && hit.found; bounce++) {
        let surface = surface_at(ray, hit, material_of(hit.sphere));
        ray = reflection_ray(surface);
        own = surface.own;
        hit = nearest_hit(ray, own, reflection_range());
    }
    answer_with_point(id.x, ray, hit);
}

// The hit after the path of the refraction ray through as many surfaces as the ray's third word says, and its point.
@compute @workgroup_size(SMALL_GROUP)
fn probe_refract(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    let words = probe_words[id.x];
    var own = probe_own(words);
    var ray = probe_ray(id.x);
    var hit = nearest_hit(ray, own, reflection_range());
    for (var bounce = 0u; bounce < words.z && hit.found; bounce++) {
        let refracted = refraction_ray(ray, surface_at(ray, hit, material_of(hit.sphere)));
        ray = refracted.ray;
        own = refracted.own;
        hit = nearest_hit(ray, own, refraction_range());
    }
    answer_with_point(id.x, ray, hit);
}

// The nearest hit and the specular term of the ray's own light there.
@compute @workgroup_size(SMALL_GROUP)
fn probe_highlight(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    let ray = probe_ray(id.x);
    let hit = probe_hit(ray, probe_words[id.x]);
    let material = material_of(hit.sphere);
    let surface = surface_at(ray, hit, material);
    let shadow_ray = ray_to_light(surface.position, light_of(id.x), id.x);
    let to_light = direction_of(shadow_ray) * (real(1.0) / sqrt(shadow_ray.a));
    probe_flags[id.x] = vec2<u32>(hit_bits(hit), hit.sphere);
    probe_values[id.x] = specular_term(surface, material, to_light, dot(surface.normal, to_light));
}

// The specular power of d and n.
@compute @workgroup_size(SMALL_GROUP)
fn probe_power(@builtin(global_invocation_id) id: vec3<u32>) {
    let power = specular_power(probe_reals[6u * id.x], probe_reals[6u * id.x + 1u]);
    probe_flags[id.x] = vec2<u32>(select(0u, PROBE_FINITE, is_finite(power)), 0u);
    probe_values[id.x] = power;
}
