// The mean over each pixel's samples.
// needs: effects, quantize, real, types
// host: STATUS_CUT, STATUS_FLAGS, STATUS_HIT, TILE_PIXELS

@group(0) @binding(7) var<storage, read> colors: array<vec4r>;
@group(0) @binding(15) var<storage, read_write> pixels: array<u32>;
// With LINEAR, the mean of each pixel, and the part of its samples that hit something.
@group(0) @binding(20) var<storage, read_write> means: array<vec4r>;

// Unclamped; read it beside src/cpu/render.rs. Taken from differences to the first sample, it is exact where all
// are equal.
@compute @workgroup_size(TILE_PIXELS)
fn resolve(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    let first = colors[id.x * SAMPLES];
    var excess = vec3r();
    var status = u32(first.w) & 255u;
    var hits = u32(first.w) / STATUS_HIT;
    var is_whole = true;
    // A sample that was cut stands for those that follow.
    var is_cut = (status & STATUS_CUT) != 0u;
    for (var sample = 1u; sample < SAMPLES; sample++) {
        let color = colors[id.x * SAMPLES + sample];
        excess += color.xyz - first.xyz;
        let own = u32(color.w) & 255u;
        hits += u32(color.w) / STATUS_HIT;
        is_whole &= is_cut | ((own | STATUS_FLAGS) == (status | STATUS_FLAGS));
        status |= select(own & STATUS_FLAGS, 0u, is_cut);
        is_cut |= (own & STATUS_CUT) != 0u;
    }
    // No dispatch is number 0.
    status &= select(STATUS_FLAGS, 255u, is_whole);
    let mean = first.xyz + excess / real(SAMPLES);
    pixels[id.x] = levels(mean) | (status << 24u);
    if LINEAR {
        means[id.x] = vec4r(mean, real(hits) / real(SAMPLES));
    }
}
