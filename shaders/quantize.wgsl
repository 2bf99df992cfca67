// From colours to levels.
// needs: real, types

// The bits of a pixel's status byte.
const STATUS_FINITE: u32 = 0u;
const STATUS_NOT_FINITE: u32 = 1u;
const STATUS_CUT: u32 = 2u;
const STATUS_TANGENT: u32 = 4u;
// The bits above are the number of the dispatch, which the host gives: whatever a dispatch has not written shows another one.
const STATUS_FLAGS: u32 = 7u;

fn packed_pixel(color: vec3r) -> u32 {
    let level = vec3<u32>(params.quantize_scale * clamp(color, vec3r(), vec3r(real(1.0))) + params.quantize_bias);
    let finite = is_finite(color.x) && is_finite(color.y) && is_finite(color.z);
    let status = select(STATUS_NOT_FINITE, STATUS_FINITE, finite);
    return level.x | (level.y << 8u) | (level.z << 16u) | (status << 24u);
}
