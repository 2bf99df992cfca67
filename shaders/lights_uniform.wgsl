// Not too many lights, in uniform buffers. The lengths are MAX_UNIFORM_LIGHTS in src/gpu/pipeline.rs.

@group(0) @binding(3) var<uniform> lights: array<Light, 32>;

override LIGHT_COUNT: u32;

// Not from `params`: compilers for software devices look for conditions that depend on uniform buffers alone, and compile anew
// for what is in them.
fn light_count() -> u32 {
    return LIGHT_COUNT;
}

// What rounding took from each of their numbers, for the tiers that carry it.
@group(0) @binding(10) var<uniform> lights_low: array<Light, 32>;
