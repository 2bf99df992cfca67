// Spheres and lights of any number in storage buffers, of which each ray of a batch sees its own range; otherwise many.wgsl.

@group(0) @binding(1) var<storage, read> shapes: array<Shape>;
// What rounding took from each of their numbers, for the tiers that carry it.
@group(0) @binding(9) var<storage, read> shapes_low: array<Shape>;

// Whether leaving a loop over the spheres early pays.
const LEAVES_EARLY: bool = true;

// Set by the entry points of probe.wgsl.
var<private> first_of_range: u32;
var<private> end_of_range: u32;

fn first_sphere() -> u32 {
    return first_of_range;
}

fn sphere_count() -> u32 {
    return end_of_range;
}

fn light_count() -> u32 {
    return params.light_count;
}
