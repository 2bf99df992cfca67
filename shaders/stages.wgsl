// A picture in stages, each over those alone that need it: see_tiles, shade_hits, then walk_paths and shade_hits for each bounce.
// So no lane shades what hit nothing, or waits for its neighbours' reflections. The latter stages are in paths.wgsl, or where
// something refracts in trees.wgsl.

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

// The primary ray of a slot: the samples of a pixel row by row; pixel_of is in slots_*.wgsl.
fn ray_through(slot: u32) -> Ray {
    let sample = slot % (SAMPLES * SAMPLES);
    return primary_ray(pixel_of(slot) * SAMPLES + vec2(sample % SAMPLES, sample / SAMPLES));
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
