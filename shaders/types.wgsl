// What the host packs: src/gpu/table/layout.rs has the same structs under the same names, held together by tests.
// needs: real

struct Params {
    background: vec3r,
    // A primary ray's hit counts beyond this.
    primary_t_min: real,
    ambient: vec3r,
    // A blocker counts beyond this part of the way to the light.
    shadow_t_min: real,
    // A reflection ray's hit counts beyond this.
    reflection_t_min: real,
    // Added to a colour's level before the fraction is cut off.
    quantize_bias: real,
    // What a blocker must be farther from the light than a point, beside REACH radii, to end a light's list.
    light_slack: real,
    // Where in `window` the rows begin.
    window_rows: u32,
    // The corner of the grid with the least coordinates, and cells per unit of length.
    grid_low: vec3<f32>,
    // Shift from pixels to the tiles that have lists.
    screen_shift: u32,
    grid_per_unit: vec3<f32>,
    // Such tiles in a row.
    screen_across: u32,
    // Number of cells along each axis.
    grid_cells: vec3<u32>,
    // Where in `cells` those of the grid begin; those of the tiles are first.
    grid_first: u32,
    // Where in `window` begins what rounding took from the columns and then the rows.
    window_low: u32,
    light_count: u32,
    max_depth: u32,
    // 0, which no compiler knows: see barrier().
    zero: u32,
    // Where in `entries` those of the grid begin.
    grid_entries: u32,
    // A primary ray with a discriminant below this, in radii squared, may touch a sphere or not.
    tangent_margin: f32,
    // What a colour is multiplied by to be a level.
    quantize_scale: real,
    // For certified pictures: the error of a primary ray's direction, as an angle;
    direction_error: real,
    // a ball around all spheres;
    middle: vec3r,
    extent: real,
    // how far a ray that leaves a surface may lie beside where lists take it, and one to a light;
    allowance: real,
    light_allowance: real,
    // the levels of the background, as a number;
    background_levels: real,
    // what rounding takes of all places when the eye is moved to the origin;
    moved: real,
    // and the error of a primary ray's origin.
    position_error: real,
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
    kd: real,
    ks: real,
    kr: real,
    n: real,
    // Object to world space.
    scale: vec3r,
    // For certified pictures the levels of its ambient light, as a number.
    ambient_levels: real,
}

// The second half of a shape in a table of its own, which spheres that are no ellipsoids and share no surface do without.
struct ShapeEnd {
    inv_scale: vec3r,
    index: u32,
}

// One side of the cube of directions around a light: as in src/accel/light_buffer.rs.
struct Face {
    // Least u and v of any sphere.
    low: vec2r,
    // Cells per unit of u and v.
    per_unit: real,
    // Number of cells along u and v.
    @align(16) cells: vec2<u32>,
    // Where in `cells` those of the face begin.
    first: u32,
}

struct Light {
    position: vec3r,
    intensity: vec3r,
}

@group(0) @binding(0) var<uniform> given_params: Params;

// Set by each entry point that reads it: software devices load what is uniform once for all lanes, but lane by lane in a loop.
var<private> params: Params;
