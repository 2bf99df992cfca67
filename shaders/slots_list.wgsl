// Single pixels of a list.
// needs: effects, film, scene, types
// host: TILE_PIXELS

struct List {
    // Above the flags of a status byte.
    dispatch_bits: u32,
    // Filled up to whole workgroups with any pixels.
    pixels: array<vec2<u32>>,
}

@group(0) @binding(6) var<storage, read> list: List;

fn dispatch_bits() -> u32 {
    return list.dispatch_bits;
}

// One lane casts the primary rays of one pixel and shades what they hit.
@compute @workgroup_size(TILE_PIXELS)
fn trace_samples(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    load_lights();
    trace_pixel(list.pixels[id.x], id.x * SAMPLES);
}
