// Which pixel a slot belongs to: `tiles` is a list of single pixels here, filled up to whole workgroups with NO_PIXEL.

const NO_PIXEL: u32 = 0xffffffffu;

fn pixel_of(slot: u32) -> vec2<u32> {
    return tiles[slot / (SAMPLES * SAMPLES)];
}

// One lane casts the primary rays of one pixel.
@compute @workgroup_size(64)
fn see_samples(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = tiles[id.x];
    if pixel.x == NO_PIXEL {
        return;
    }
    let first_slot = id.x * SAMPLES * SAMPLES;
    var slot = first_slot;
    loop {
        let hit = nearest_seen(ray_through(slot), pixel);
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
