// From the hit of a primary ray on, to the end of its path; read it beside src/cpu/trace.rs.
//
// Whoever casts the primary ray follows the mirrored ones too. Lanes wait for the longest path among them, but no path has to be
// kept, and where nothing is hit there is nothing to shade.
// needs: bound, counters, distance, effects, film, intersect, ray, real, reflect, scene, secondary, shade, types

// With ONE_RAY, the number of that ray, from 1 on.
@group(0) @binding(19) var<uniform> asked: vec2<u32>;

fn follow(primary: Ray, seen: Hit, slot: u32) {
    var ray = primary;
    var hit = seen;
    // What hits nothing shows the background; a reflection ray that hits nothing adds black.
    var color = select(params.background, vec3r(), hit.found);
    if ONE_RAY {
        color = vec3r();
    }
    var throughput = real(1.0);
    var depth = 0u;
    if hit.found {
        loop {
            let material = material_of(hit.sphere);
            let surface = surface_at(ray, hit, material);
            let light = local_color(surface, material, true) * throughput;
            if ONE_RAY {
                color = select(color, light, depth == asked.x);
            } else {
                color += light;
            }
            hit = no_hit();
            if REFLECTIONS {
                throughput = weakened(throughput, material.kr);
                ray = reflection_ray(surface);
                note_reflected(throughput);
                if !is_cut & (material.kr != real(0.0)) & (depth < params.max_depth) {
                    if COUNT_RAYS {
                        reflection_rays++;
                    }
                    hit = nearest_secondary(ray, surface.own, reflection_range());
                }
                depth++;
            }
            if !hit.found {
                break;
            }
        }
        // Not by the condition of the loop, which compilers may take for granted behind it.
        is_cut |= is_nearer(hit.t, distance_of(FAR));
    }
    finish(slot, color);
    add_counts(slot);
}
