// Single pixels of a list.

// Filled up to whole workgroups with any pixels.
@group(0) @binding(6) var<storage, read> pixel_list: array<vec2<u32>>;

// One lane casts the primary rays of one pixel and shades what they hit.
@compute @workgroup_size(64)
fn see_samples(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = pixel_list[id.x];
    let first_slot = id.x * SAMPLES * SAMPLES;
    var sample = 0u;
    loop {
        let ray = primary_ray(pixel * SAMPLES + vec2(sample % SAMPLES, sample / SAMPLES));
        begin(first_slot + sample);
        follow(ray, nearest_seen(ray, pixel), first_slot + sample);
        sample++;
        if sample == SAMPLES * SAMPLES {
            break;
        }
    }
}
