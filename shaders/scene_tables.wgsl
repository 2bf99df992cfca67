// Spheres and lights of any number, and the lists that rays look through, in tables: see texels.wgsl.
// needs: real, tables, texels, types, vectors

// The first half of each shape, which every test reads, and the second.
@group(0) @binding(1) var shapes: Table;
@group(0) @binding(20) var shape_ends: Table;
@group(0) @binding(2) var materials: Table;
@group(0) @binding(3) var lights: Table;
// What each column of samples and then each row gives to the direction of its rays.
@group(0) @binding(4) var window: Table;
// What rounding took from the numbers of the spheres and lights, for the tiers that carry it.
@group(0) @binding(9) var shapes_low: Table;
@group(0) @binding(21) var shape_ends_low: Table;
@group(0) @binding(10) var lights_low: Table;
// Where the list of each cell begins in `entries` and where it ends; then the lists, one after another.
@group(0) @binding(13) var cells: PairTable;
@group(0) @binding(17) var entries: PairTable;

override LIGHT_COUNT: u32 = 0u;

// Whether the second halves are there: of ellipsoids, and of spheres that share surfaces.
override SHAPE_ENDS: bool = true;

fn shape_of(sphere: u32) -> Shape {
    var shape = Shape(vector_at(shapes, sphere), vec3r(1.0), sphere);
    if SHAPE_ENDS {
        shape.inv_scale = vector_at(shape_ends, sphere).xyz;
        shape.index = bits_at(shape_ends, sphere);
    }
    return shape;
}

fn low_shape_of(sphere: u32) -> Shape {
    var shape = Shape(vector_at(shapes_low, sphere), vec3r(), sphere);
    if SHAPE_ENDS {
        shape.inv_scale = vector_at(shape_ends_low, sphere).xyz;
        shape.index = bits_at(shape_ends_low, sphere);
    }
    return shape;
}

// Vectors of a material: material_vectors in src/gpu/pack.rs.
override MATERIAL: u32 = 3u;

fn material_of(sphere: u32) -> Material {
    let at = MATERIAL * sphere;
    let color = vector_at(materials, at);
    let factors = vector_at(materials, at + 1u);
    var scale = vec3r(1.0);
    if MATERIAL == 3u {
        scale = vector_at(materials, at + 2u).xyz;
    }
    return Material(color.xyz, color.w, factors.x, factors.y, factors.z, factors.w, scale);
}

// Not from `params`: compilers for software devices look for conditions that depend on uniform buffers alone, and compile anew
// for what is in them.
fn light_count() -> u32 {
    return LIGHT_COUNT;
}

fn light_in_table(index: u32) -> Light {
    return Light(vector_at(lights, 2u * index).xyz, vector_at(lights, 2u * index + 1u).xyz);
}

// A few lights are loaded once an invocation: choosing among registers costs less than loading one again for each point.
const FEW_LIGHTS: u32 = 4u;
var<private> light0: Light;
var<private> light1: Light;
var<private> light2: Light;
var<private> light3: Light;

// Before the first light_of.
fn load_lights() {
    if LIGHT_COUNT > 0u && LIGHT_COUNT <= FEW_LIGHTS {
        light0 = light_in_table(0u);
        if LIGHT_COUNT > 1u {
            light1 = light_in_table(1u);
        }
        if LIGHT_COUNT > 2u {
            light2 = light_in_table(2u);
        }
        if LIGHT_COUNT > 3u {
            light3 = light_in_table(3u);
        }
    }
}

// The second where `is_second`, else the first.
fn either_light(first: Light, second: Light, is_second: bool) -> Light {
    return Light(select(first.position, second.position, is_second), select(first.intensity, second.intensity, is_second));
}

fn light_of(index: u32) -> Light {
    if LIGHT_COUNT > FEW_LIGHTS {
        return light_in_table(index);
    }
    var light = light0;
    if LIGHT_COUNT > 1u {
        light = either_light(light, light1, index == 1u);
    }
    if LIGHT_COUNT > 2u {
        light = either_light(light, light2, index == 2u);
    }
    if LIGHT_COUNT > 3u {
        light = either_light(light, light3, index == 3u);
    }
    return light;
}

fn low_light_of(index: u32) -> Light {
    return Light(vector_at(lights_low, 2u * index).xyz, vector_at(lights_low, 2u * index + 1u).xyz);
}

fn window_at(index: u32) -> vec3r {
    return vector_at(window, index).xyz;
}

fn cell_at(index: u32) -> vec2<u32> {
    return pair_at(cells, index);
}

// Two in each texel: software devices load a single word from each of several places with an instruction that is slower than all
// that it replaces.
fn entry_at(index: u32) -> u32 {
    let pair = pair_at(entries, index >> 1u);
    return select(pair.x, pair.y, (index & 1u) != 0u);
}
