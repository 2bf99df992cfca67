// Where something refracts: from the hit of a primary ray on, its tree of reflections and refractions, in which MAX_WAITING rays
// can wait; read it beside src/cpu/trace_refraction.rs.
// needs: bound, counters, effects, film, intersect, ray, real, reflect, refract, scene, secondary, shade, types, waiting
// host: MAX_WAITING

// With ONE_RAY, the number of that ray, from 1 on, in the order in which they are followed.
@group(0) @binding(19) var<uniform> asked: vec2<u32>;

// A refraction ray that waits until the reflected ray beside it has been followed to its end.
struct Waiting {
    ray: Ray,
    own: Own,
    throughput: real,
    depth: u32,
    shows_background: bool,
}

// The unclamped colour seen along the ray that has this hit: depth-first, the reflected ray first. Each depth leaves one
// refraction ray behind at the most.
fn tree_color(primary: Ray, seen: Hit) -> vec3r {
    var ray = primary;
    var own = Own(NO_SHAPE, false, vec3r());
    var range = primary_range();
    var hit = seen;
    var is_primary = true;
    var color = vec3r();
    var throughput = real(1.0);
    var depth = 0u;
    var waiting: array<Waiting, MAX_WAITING>;
    var count = 0u;
    var number = 0u;
    // One looks through glass at the background; a ray that was reflected and hits nothing adds black.
    var shows_background = true;
    loop {
        if !is_primary {
            hit = nearest_secondary(ray, own, range);
        }
        is_primary = false;
        if hit.found {
            let material = material_of(hit.sphere);
            let surface = surface_at(ray, hit, material);
            let light = local_color(surface, material, true) * throughput;
            if ONE_RAY {
                color = select(color, light, number == asked.x);
            } else {
                color += light;
            }

            if depth < params.max_depth {
                let kt = glasses[surface.sphere].kt;
                if kt != real(0.0) {
                    let refracted = refraction_ray(ray, surface);
                    let weight = weakened(throughput, kt);
                    keep_cone(count, surface, weight);
                    waiting[count] = Waiting(refracted.ray, refracted.own, weight, depth + 1u, shows_background);
                    count++;
                }
                if REFLECTIONS && material.kr != real(0.0) {
                    depth += 1u;
                    throughput = weakened(throughput, material.kr);
                    ray = reflection_ray(surface);
                    note_reflected(throughput);
                    own = surface.own;
                    range = reflection_range();
                    shows_background = false;
                    if COUNT_RAYS {
                        reflection_rays++;
                    }
                    if ONE_RAY {
                        number++;
                    }
                    continue;
                }
            }
        } else if shows_background {
            let light = params.background * throughput;
            if ONE_RAY {
                color = select(color, light, number == asked.x);
            } else {
                color += light;
            }
            note_background();
        }
        if count == 0u {
            break;
        }
        count--;
        go_on_with_cone(count);
        ray = waiting[count].ray;
        own = waiting[count].own;
        range = refraction_range();
        throughput = waiting[count].throughput;
        depth = waiting[count].depth;
        shows_background = waiting[count].shows_background;
        if COUNT_RAYS {
            reflection_rays++;
        }
        if ONE_RAY {
            number++;
        }
    }
    is_cut |= count != 0u;
    return color;
}

// The colour of a primary ray with this hit.
fn follow(ray: Ray, hit: Hit, slot: u32) {
    if hit.found {
        finish(slot, tree_color(ray, hit));
    } else if ONE_RAY {
        finish(slot, vec3r());
    } else {
        finish(slot, params.background);
    }
    add_counts(slot);
}
