// From colours to levels.
// needs: real, types
// host: STATUS_NOT_FINITE

fn levels(color: vec3r) -> u32 {
    let level = vec3<u32>(params.quantize_scale * clamp(color, vec3r(), vec3r(real(1.0))) + params.quantize_bias);
    let finite = is_finite(color.x) && is_finite(color.y) && is_finite(color.z);
    let status = select(STATUS_NOT_FINITE, 0u, finite);
    return level.x | (level.y << 8u) | (level.z << 16u) | (status << 24u);
}

// The same rule with 16 bits: levels16 in src/settings.rs.
fn deep_levels(color: vec3r) -> vec3<u32> {
    let scale = params.quantize_scale + real(65280.0);
    return vec3<u32>(scale * clamp(color, vec3r(), vec3r(real(1.0))) + params.quantize_bias);
}
