// Single pixels of a list.

// Filled up to whole workgroups with any pixels.
@group(0) @binding(6) var<storage, read> pixel_list: array<vec2<u32>>;

// One lane casts the primary rays of one pixel and shades what they hit.
@compute @workgroup_size(64)
fn see_samples(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    load_lights();
    see_pixel(pixel_list[id.x], id.x * SAMPLES * SAMPLES);
}
