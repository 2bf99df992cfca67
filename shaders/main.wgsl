// One workgroup renders one tile: primary rays and what they hit. Where that is a mirror, a path goes on in later dispatches over
// the paths alone, so that no lane waits for its neighbours' reflections.

// A sample's reflection ray and what it has gathered so far.
struct Path {
    origin: Point,
    direction: vec3r,
    throughput: real,
    color: vec3r,
    // Index of the sample's result.
    slot: u32,
    // Start of the ray in the object space of the sphere that it leaves.
    local: vec3r,
    // Shape index of that sphere, and in the highest bit whether the ray starts on the inner wall.
    own: u32,
}

// Those of this bounce, and those of the next.
@group(0) @binding(11) var<storage, read_write> paths: array<Path>;

// How far a picture's paths are.
struct Stage {
    // Where in `paths` those of this bounce begin, and those of the next.
    first: u32,
    next_first: u32,
    // How many there are of this bounce, and so far of the next.
    count: u32,
    next_count: atomic<u32>,
    // Bounces of the paths of this one.
    bounce: u32,
}

@group(0) @binding(12) var<storage, read_write> stage: Stage;

const INSIDE: u32 = 0x80000000u;

// The path goes on along the mirrored ray.
fn reflect(surface: Surface, color: vec3r, throughput: real, slot: u32) {
    if COUNT_RAYS {
        reflection_rays++;
    }
    let ray = reflection_ray(surface);
    let own = surface.own.shape | select(0u, INSIDE, surface.own.inside);
    let at = stage.next_first + atomicAdd(&stage.next_count, 1u);
    paths[at] = Path(ray.origin, direction_of(ray), throughput, color, slot, surface.own.local, own);
}

@compute @workgroup_size(8, 8)
fn render_tiles(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) index: u32,
) {
    let pixel = tiles[group.x] + local.xy;
    let first_slot = (group.x * 64u + index) * SAMPLES * SAMPLES;
    for (var sample = 0u; sample < SAMPLES * SAMPLES; sample++) {
        let ray = primary_ray(pixel * SAMPLES + vec2(sample % SAMPLES, sample / SAMPLES));
        let slot = first_slot + sample;
        let hit = nearest_seen(ray, tiles[group.x]);
        var color = params.background;
        var goes_on = false;
        shadow_rays = 0u;
        reflection_rays = 0u;
        if hit.found {
            let surface = surface_at(ray, hit);
            color = local_color(surface);
            if REFLECTIONS {
                let kr = materials[surface.sphere].kr;
                goes_on = kr != real(0.0) && params.max_depth > 0u;
                if goes_on {
                    reflect(surface, color, next_throughput(real(1.0), kr), slot);
                }
            }
        }
        if !goes_on {
            finish(slot, color);
        }
        keep_counts(slot, 0u);
    }
}

// One bounce of each path.
@compute @workgroup_size(64)
fn trace_paths(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= stage.count {
        return;
    }
    let path = paths[stage.first + id.x];
    let own = Own(path.own & ~INSIDE, (path.own & INSIDE) != 0u, path.local);
    let ray = ray_from(path.origin, path.direction);
    let hit = nearest_reflected(ray, own);
    var color = path.color;
    var goes_on = false;
    // A reflection ray that hits nothing adds black.
    if hit.found {
        let surface = surface_at(ray, hit);
        color += local_color(surface) * path.throughput;
        let kr = materials[surface.sphere].kr;
        goes_on = kr != real(0.0) && stage.bounce < params.max_depth;
        if goes_on {
            reflect(surface, color, next_throughput(path.throughput, kr), path.slot);
        }
    }
    if !goes_on {
        finish(path.slot, color);
    }
    if COUNT_RAYS {
        keep_counts(path.slot, ray_counts[path.slot]);
    }
}
