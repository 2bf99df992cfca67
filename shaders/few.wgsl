// Few spheres and lights, in uniform buffers, their number compiled in: loops unroll and every lane reads the same element at
// once. The lengths are MAX_FEW in src/gpu/pipeline.rs.

@group(0) @binding(1) var<uniform> shapes: array<Shape, 16>;
@group(0) @binding(3) var<uniform> lights: array<Light, 16>;
// What rounding took from each of their numbers, for the tiers that carry it.
@group(0) @binding(9) var<uniform> shapes_low: array<Shape, 16>;
@group(0) @binding(10) var<uniform> lights_low: array<Light, 16>;

override SPHERE_COUNT: u32;
override LIGHT_COUNT: u32;

// Whether leaving a loop over the spheres early pays: not where it is unrolled.
const LEAVES_EARLY: bool = false;

fn first_sphere() -> u32 {
    return 0u;
}

fn sphere_count() -> u32 {
    return SPHERE_COUNT;
}

fn light_count() -> u32 {
    return LIGHT_COUNT;
}
