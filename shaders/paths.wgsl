// A sample's way from bounce to bounce; read it beside src/cpu/trace.rs.

// A sample's reflection ray and what it has gathered so far.
struct Path {
    origin: Point,
    direction: vec3r,
    throughput: real,
    color: vec3r,
    // Index of the sample's result.
    slot: u32,
    // With SKIP_SELF, the start of the ray in the object space of the sphere that it leaves.
    local: vec3r,
    // Shape index of that sphere, and in the highest bit whether the ray starts on the inner wall.
    own: u32,
}

// Those of this bounce, and those of the next.
@group(0) @binding(11) var<storage, read_write> paths: array<Path>;

// The path goes on along the mirrored ray.
fn reflect(surface: Surface, color: vec3r, throughput: real, slot: u32) {
    if COUNT_RAYS {
        reflection_rays++;
    }
    let ray = reflection_ray(surface);
    let at = stage.next_first + atomicAdd(&stage.next_path_count, 1u);
    paths[at].origin = ray.origin;
    paths[at].direction = direction_of(ray);
    paths[at].throughput = throughput;
    paths[at].color = color;
    paths[at].slot = slot;
    if SKIP_SELF {
        paths[at].local = surface.own.local;
        paths[at].own = surface.own.shape | select(0u, INSIDE, surface.own.inside);
    }
}

// The ray of a path.
fn ray_of(path: u32) -> Ray {
    return ray_from(paths[path].origin, paths[path].direction);
}

// One bounce of each path.
@compute @workgroup_size(GROUP)
fn walk_paths(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= stage.path_count {
        return;
    }
    let path = stage.first + id.x;
    var own = Own(NO_SHAPE, false, vec3r());
    if SKIP_SELF {
        own = Own(paths[path].own & ~INSIDE, (paths[path].own & INSIDE) != 0u, paths[path].local);
    }
    let hit = nearest_secondary(ray_of(path), own, reflection_range());
    if hit.found {
        keep_hit(path, hit);
    } else {
        // A reflection ray that hits nothing adds black.
        finish(paths[path].slot, paths[path].color);
    }
}

// The colour of each hit, and the path that it begins or goes on.
@compute @workgroup_size(GROUP)
fn shade_hits(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= stage.hit_count {
        return;
    }
    shadow_rays = 0u;
    reflection_rays = 0u;
    let at = stage.hits[id.x];
    let hit = Hit(true, distance_of(real(0.0)), at.y & ~INSIDE, (at.y & INSIDE) != 0u);
    var ray: Ray;
    var slot = at.x;
    var color = vec3r();
    var throughput = real(1.0);
    if stage.bounce == 0u {
        ray = ray_through(slot);
    } else {
        ray = ray_of(at.x);
        slot = paths[at.x].slot;
        color = paths[at.x].color;
        throughput = paths[at.x].throughput;
    }
    let surface = surface_at(ray, hit);
    color += local_color(surface) * throughput;
    var goes_on = false;
    if REFLECTIONS {
        let kr = materials[surface.sphere].kr;
        goes_on = kr != real(0.0) && stage.bounce < params.max_depth;
        if goes_on {
            reflect(surface, color, min(throughput * kr, MAX_THROUGHPUT), slot);
        }
    }
    if !goes_on {
        finish(slot, color);
    }
    add_counts(slot);
}
