// Spheres and lights of any number, in storage buffers.

@group(0) @binding(1) var<storage, read> shapes: array<Shape>;
@group(0) @binding(3) var<storage, read> lights: array<Light>;
// What rounding took from each of their numbers, for the tiers that carry it.
@group(0) @binding(9) var<storage, read> shapes_low: array<Shape>;
@group(0) @binding(10) var<storage, read> lights_low: array<Light>;

// Whether leaving a loop over the spheres early pays.
const MANY: bool = true;

fn first_sphere() -> u32 {
    return 0u;
}

fn sphere_count() -> u32 {
    return params.sphere_count;
}

fn light_count() -> u32 {
    return params.light_count;
}
