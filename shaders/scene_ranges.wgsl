// Spheres and lights of any number in storage buffers, of which each ray of a batch sees its own range.
// needs: real, types

@group(0) @binding(1) var<storage, read> shapes: array<Shape>;
@group(0) @binding(2) var<storage, read> materials: array<Material>;
@group(0) @binding(3) var<storage, read> lights: array<Light>;
// What each column of samples and then each row gives to the direction of its rays.
@group(0) @binding(4) var<storage, read> window: array<vec4r>;
// What rounding took from the numbers of the spheres and lights, for the tiers that carry it.
@group(0) @binding(9) var<storage, read> shapes_low: array<Shape>;
@group(0) @binding(10) var<storage, read> lights_low: array<Light>;

fn shape_of(sphere: u32) -> Shape {
    return shapes[sphere];
}

fn low_shape_of(sphere: u32) -> Shape {
    return shapes_low[sphere];
}

fn material_of(sphere: u32) -> Material {
    return materials[sphere];
}

fn light_count() -> u32 {
    return arrayLength(&lights);
}

fn light_of(index: u32) -> Light {
    return lights[index];
}

fn low_light_of(index: u32) -> Light {
    return lights_low[index];
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
