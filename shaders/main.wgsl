// One workgroup renders one tile.

// The status byte of a pixel.
const STATUS_FINITE: u32 = 0u;
const STATUS_NOT_FINITE: u32 = 1u;

fn packed_pixel(color: vec3r) -> u32 {
    let level = vec3<u32>(real(255.0) * clamp(color, vec3r(), vec3r(real(1.0))) + params.quantize_bias);
    let finite = is_finite(color.x) && is_finite(color.y) && is_finite(color.z);
    let status = select(STATUS_NOT_FINITE, STATUS_FINITE, finite);
    return level.x | (level.y << 8u) | (level.z << 16u) | (status << 24u);
}

// The mean over the pixel's samples, row by row, unclamped; read it beside src/cpu/render.rs. Taken from differences to the
// first sample, it is exact where all are equal.
fn pixel_color(pixel: vec2<u32>) -> vec3r {
    if SAMPLES == 1u {
        return trace(primary_ray(pixel));
    }
    var first = vec3r();
    var excess = vec3r();
    for (var y = 0u; y < SAMPLES; y++) {
        for (var x = 0u; x < SAMPLES; x++) {
            let color = trace(primary_ray(pixel * SAMPLES + vec2(x, y)));
            if x + y == 0u {
                first = color;
            } else {
                excess += color - first;
            }
        }
    }
    return first + excess / real(SAMPLES * SAMPLES);
}

@compute @workgroup_size(8, 8)
fn render_tiles(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) index: u32,
) {
    let pixel = tiles[group.x] + local.xy;
    pixels[group.x * 64u + index] = packed_pixel(pixel_color(pixel));
    if COUNT_RAYS {
        ray_counts[group.x * 64u + index] = min(shadow_rays, 0xffffu) | (min(reflection_rays, 0xffffu) << 16u);
    }
}
