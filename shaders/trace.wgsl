// A pixel's colour: the primary ray and its chain of reflections; read it beside src/cpu/trace.rs.

// The unclamped colour seen along the ray.
fn trace(primary: Ray) -> vec3r {
    var own = Own(NO_SHAPE, false, vec3r());
    var ray = primary;
    var hit = nearest_hit(ray, own, primary_range());
    if !hit.found {
        return params.background;
    }
    var color = vec3r();
    if !REFLECTIONS {
        let surface = surface_at(ray, hit);
        return local_color(surface);
    }
    var throughput = real(1.0);
    var depth = 0u;
    // A reflection ray that hits nothing adds black.
    while hit.found {
        let surface = surface_at(ray, hit);
        color += local_color(surface) * throughput;

        let kr = materials[surface.sphere].kr;
        if depth == params.max_depth || kr == real(0.0) {
            break;
        }
        depth += 1u;
        throughput = min(throughput * kr, MAX_THROUGHPUT);
        ray = reflection_ray(surface);
        own = surface.own;
        if COUNT_RAYS {
            reflection_rays++;
        }
        hit = nearest_hit(ray, own, reflection_range());
    }
    return color;
}
