// The picture from the nearest samples: each pixel as filled_nearest.wgsl or filled_smooth.wgsl says.
// needs: filled, flood
// host: SMALL_GROUP

// Colours of the sampled pixels, red, green, blue in the low bytes; 0 elsewhere.
@group(0) @binding(2) var<storage, read> known: array<u32>;
@group(0) @binding(3) var<storage, read_write> picture: array<u32>;

fn color_of(owner: u32) -> u32 {
    return known[index(place(owner))];
}

@compute @workgroup_size(SMALL_GROUP)
fn fill(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = vec2<i32>(id.xy);
    if pixel.x < flood.width {
        picture[index(pixel)] = filled(pixel);
    }
}
