// Spheres and lights of any number in storage buffers, of which each ray of a batch sees its own range; otherwise many.wgsl.

@group(0) @binding(1) var<storage, read> shapes: array<Shape>;
@group(0) @binding(2) var<storage, read> materials: array<Material>;
// What each column of samples and then each row gives to the direction of its rays.
@group(0) @binding(4) var<storage, read> window: array<vec4r>;
// What rounding took from the numbers of the spheres, for the tiers that carry it.
@group(0) @binding(9) var<storage, read> shapes_low: array<Shape>;

fn shape_of(sphere: u32) -> Shape {
    return shapes[sphere];
}

fn low_shape_of(sphere: u32) -> Shape {
    return shapes_low[sphere];
}

fn material_of(sphere: u32) -> Material {
    return materials[sphere];
}

fn window_at(index: u32) -> vec3r {
    return window[index].xyz;
}

// Set by the entry points of probe.wgsl.
var<private> first_of_range: u32;
var<private> end_of_range: u32;

fn first_sphere() -> u32 {
    return first_of_range;
}

fn sphere_count() -> u32 {
    return end_of_range;
}
