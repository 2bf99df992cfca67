// A sample's way from bounce to bounce, by the kernels of walk_*.wgsl; read it beside src/cpu/trace.rs.
// needs: bound, counters, effects, film, intersect, queue, ray, real, reflect, scene, shade, tables, types

// Paths are samples' reflection rays and what they have gathered so far: those of this bounce, and those of the next.
// Each path has VECTORS vectors:
//   the start of its ray, and the throughput;
//   the direction, and the index of the sample's result, which is below 2^24;
//   the colour gathered, and the shape index, below 2^24, of the sphere that the ray leaves;
//   the start in the object space of that sphere, and 1 where it is on the inner wall; with CERTIFIED, 2 more where it is unsure;
//   for the tiers that carry it, what rounding took from the start; with CERTIFIED what bound_cone.wgsl keeps.
//
// Vectors of a path: as path_vectors in src/gpu/kernel/specialisation.rs has it.
override VECTORS: u32;

// Whether there is a next bounce: 0 or 1.
@group(0) @binding(19) var<uniform> has_next: u32;

struct Path {
    ray: Ray,
    own: Own,
    slot: u32,
    color: vec3r,
    throughput: real,
}

// A path of this bounce.
fn path_of(index: u32) -> Path {
    let at = index * VECTORS;
    let start = path_at(at);
    let way = path_at(at + 1u);
    let gathered = path_at(at + 2u);
    let local = path_at(at + 3u);
    var inside = local.w != real(0.0);
    if CERTIFIED {
        is_unsure |= local.w >= real(2.0);
        inside = (u32(local.w) & 1u) != 0u;
    }
    let own = Own(u32(gathered.w), inside, local.xyz);
    var low = vec3r();
    if CARRIES_LOW {
        low = path_at(at + VECTORS - 1u).xyz;
    }
    if CERTIFIED {
        go_on_with_bound(path_at(at + VECTORS - 1u), start.w);
    }
    return Path(ray_from(point_from(start.xyz, low), way.xyz), own, u32(way.w), gathered.xyz, start.w);
}

// The path goes on along the mirrored ray.
fn reflect(surface: Surface, color: vec3r, throughput: real, slot: u32) {
    if COUNT_RAYS {
        reflection_rays++;
    }
    let ray = reflection_ray(surface);
    note_reflected(throughput);
    let at = atomicAdd(&path_queue.next_path_count, 1u) * VECTORS;
    keep_path(at, vec4r(high_of(ray.origin), throughput));
    keep_path(at + 1u, vec4r(direction_of(ray), real(slot)));
    keep_path(at + 2u, vec4r(color, real(surface.own.shape)));
    var marks = select(real(0.0), real(1.0), surface.own.inside);
    if CERTIFIED {
        marks += select(real(0.0), real(2.0), is_unsure);
    }
    keep_path(at + 3u, vec4r(surface.own.local, marks));
    if CARRIES_LOW {
        keep_path(at + VECTORS - 1u, vec4r(low_of(ray.origin), real(0.0)));
    }
    if CERTIFIED {
        keep_path(at + VECTORS - 1u, kept_bound());
    }
}

// What a ray has found: its colour is added to what the sample has gathered, and the path goes on if it is mirrored.
fn shade(ray: Ray, hit: Hit, is_path: bool, slot: u32, before: vec3r, throughput: real) {
    let material = material_of(hit.sphere);
    let surface = surface_at(ray, hit, material);
    let color = select(before, before + local_color(surface, material, hit.found) * throughput, hit.found);
    let goes_on = hit.found & !is_cut & (material.kr != real(0.0)) & (has_next != 0u);
    if goes_on {
        reflect(surface, color, weakened(throughput, material.kr), slot);
    }
    if is_path {
        if !goes_on {
            finish(slot, color);
        }
        add_counts(slot);
    }
}

// From the hit of a primary ray on.
fn follow(ray: Ray, hit: Hit, slot: u32) {
    // What hits nothing shows the background; a reflection ray that hits nothing adds black.
    shade(ray, hit, true, slot, select(params.background, vec3r(), hit.found), real(1.0));
}
