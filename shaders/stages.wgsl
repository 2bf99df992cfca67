// A picture in stages, each over those alone that need it: see_tiles, shade_hits, then walk_paths and shade_hits for each bounce.
// So no lane shades what hit nothing, or waits for its neighbours' reflections.

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

// How far a picture is; stage.wgsl goes from one stage to the next.
struct Stage {
    // Where in `paths` those of this bounce begin, and those of the next.
    first: u32,
    next_first: u32,
    // Paths of this bounce, and so far of the next.
    path_count: u32,
    next_path_count: atomic<u32>,
    // Hits of this bounce.
    hit_count: u32,
    next_hit_count: atomic<u32>,
    // Bounces of the paths of this one.
    bounce: u32,
    // Of each hit: the path, or the slot of a primary ray; then the sphere, with INSIDE.
    hits: array<vec2<u32>>,
}

@group(0) @binding(12) var<storage, read_write> stage: Stage;

// In the highest bit: seen from inside, or starts on the inner wall.
const INSIDE: u32 = 0x80000000u;

fn keep_hit(path: u32, hit: Hit) {
    let at = atomicAdd(&stage.next_hit_count, 1u);
    stage.hits[at] = vec2<u32>(path, hit.sphere | select(0u, INSIDE, hit.inside));
}

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

// The primary ray of a slot: samples row by row in the pixels of a tile, these row by row.
fn ray_through(slot: u32) -> Ray {
    let in_tile = (slot / (SAMPLES * SAMPLES)) % 64u;
    let sample = slot % (SAMPLES * SAMPLES);
    let pixel = tiles[slot / (64u * SAMPLES * SAMPLES)] + vec2(in_tile % 8u, in_tile / 8u);
    return primary_ray(pixel * SAMPLES + vec2(sample % SAMPLES, sample / SAMPLES));
}

// One workgroup casts the primary rays of one tile.
@compute @workgroup_size(64)
fn see_tiles(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    let first_slot = (group.x * 64u + index) * SAMPLES * SAMPLES;
    var slot = first_slot;
    loop {
        let hit = nearest_seen(ray_through(slot), tiles[group.x]);
        if hit.found {
            keep_hit(slot, hit);
        } else {
            finish(slot, params.background);
        }
        if COUNT_RAYS {
            ray_counts[slot] = 0u;
        }
        slot++;
        if slot == first_slot + SAMPLES * SAMPLES {
            break;
        }
    }
}

// One bounce of each path.
@compute @workgroup_size(64)
fn walk_paths(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= stage.path_count {
        return;
    }
    let path = stage.first + id.x;
    var own = Own(NO_SHAPE, false, vec3r());
    if SKIP_SELF {
        own = Own(paths[path].own & ~INSIDE, (paths[path].own & INSIDE) != 0u, paths[path].local);
    }
    let hit = nearest_reflected(ray_of(path), own);
    if hit.found {
        keep_hit(path, hit);
    } else {
        // A reflection ray that hits nothing adds black.
        finish(paths[path].slot, paths[path].color);
    }
}

// The colour of each hit, and the path that it begins or goes on.
@compute @workgroup_size(64)
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
            reflect(surface, color, next_throughput(throughput, kr), slot);
        }
    }
    if !goes_on {
        finish(slot, color);
    }
    add_counts(slot);
}
