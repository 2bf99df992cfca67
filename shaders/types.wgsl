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
    // The corner of the grid with the least coordinates, and cells per unit of length.
    grid_low: vec3<f32>,
    // Shift from pixels to the tiles that have lists.
    screen_shift: u32,
    grid_per_unit: vec3<f32>,
    // Such tiles in a row.
    screen_across: u32,
    // Number of cells along each axis.
    grid_cells: vec3<u32>,
    // Where in `lists` the offsets of the grid's cells begin; those of the tiles are first.
    grid_offsets: u32,
    // What a blocker must be farther from the light than a point, beside REACH radii, to end a light's list.
    light_slack: real,
    sphere_count: u32,
    light_count: u32,
    max_depth: u32,
    // 0, which no compiler knows: see barrier() in eft.wgsl.
    zero: u32,
    // Where in `window` the rows begin.
    first_row: u32,
}

// What the intersection reads of a sphere.
struct Shape {
    // Centre in the world, radius in object space: one vector, since each load costs where lanes read different spheres.
    center_radius: vec4r,
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

// Bindings 1 and 3, and their low parts 9 and 10, shapes and lights, are in few.wgsl or in many.wgsl and lights_*.wgsl.
@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(2) var<storage, read> materials: array<Material>;
// x of each column and then y of each row of samples on the image plane; for the tiers that carry it, what rounding took from
// each follows in the second half.
@group(0) @binding(4) var<storage, read> window: array<real>;
// Top-left pixel of each tile that a sphere may cover.
@group(0) @binding(6) var<storage, read> tiles: array<vec2<u32>>;
