// What the host packs: src/gpu/layout.rs has the same structs under the same names, held together by tests.

struct Params {
    background: vec3r,
    // z of the image plane is -near.
    near: real,
    ambient: vec3r,
    // A primary ray's hit counts beyond this.
    primary_t_min: real,
    // A blocker counts beyond this part of the way to the light.
    shadow_t_min: real,
    // A reflection ray's hit counts beyond this.
    reflection_t_min: real,
    // Added to 255 c before the fraction is cut off.
    quantize_bias: real,
    // What rounding took from near.
    near_low: real,
    sphere_count: u32,
    light_count: u32,
    max_depth: u32,
    // 0, which no compiler knows: see barrier() in eft.wgsl.
    zero: u32,
}

// What the intersection reads of a sphere.
struct Shape {
    center: vec3r,
    // In object space.
    radius: real,
    // World to object space.
    inv_scale: vec3r,
    // Lowest index of a sphere with this very surface.
    index: u32,
}

// What only shading reads of a sphere.
struct Material {
    color: vec3r,
    ka: real,
    // Object to world space.
    scale: vec3r,
    kd: real,
    ks: real,
    kr: real,
    n: real,
}

struct Light {
    position: vec3r,
    intensity: vec3r,
}

// Bindings 1 and 3, and their low parts 9 and 10, are in many.wgsl or few.wgsl: shapes and lights.
@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(2) var<storage, read> materials: array<Material>;
// x of each column and y of each row of samples on the image plane; for the tiers that carry it, what rounding took from each follows in
// the second half.
@group(0) @binding(4) var<storage, read> columns: array<real>;
@group(0) @binding(5) var<storage, read> rows: array<real>;
// Top-left pixel of each tile that a sphere may cover.
@group(0) @binding(6) var<storage, read> tiles: array<vec2<u32>>;
// One pixel of this dispatch each, tile by tile: red, green, blue in the low bytes, status in the high one.
@group(0) @binding(7) var<storage, read_write> pixels: array<u32>;
// With COUNT_RAYS, the shadow rays (low half) and reflection rays (high half) of each of those pixels.
@group(0) @binding(8) var<storage, read_write> ray_counts: array<u32>;

var<private> shadow_rays: u32;
var<private> reflection_rays: u32;
