// The mean over each pixel's samples.

@group(0) @binding(7) var<storage, read> colors: array<vec3r>;
@group(0) @binding(15) var<storage, read_write> pixels: array<u32>;

// Row by row, unclamped; read it beside src/cpu/render.rs. Taken from differences to the first sample, it is exact where all
// are equal.
@compute @workgroup_size(64)
fn resolve(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    let first = colors[id.x * SAMPLES * SAMPLES];
    var excess = vec3r();
    for (var sample = 1u; sample < SAMPLES * SAMPLES; sample++) {
        excess += colors[id.x * SAMPLES * SAMPLES + sample] - first;
    }
    pixels[id.x] = packed_pixel(first + excess / real(SAMPLES * SAMPLES));
}
