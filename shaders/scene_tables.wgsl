// Spheres and lights of any number, in tables.
// needs: real, tables, types

override LIGHT_COUNT: u32 = 0u;

// Whether the second halves are there: of ellipsoids, and of spheres that share surfaces.
override SHAPE_ENDS: bool = true;

fn shape_of(sphere: u32) -> Shape {
    let first = shape_at(sphere);
    var second = ShapeEnd(vec3r(1.0), sphere);
    if SHAPE_ENDS {
        second = shape_end_at(sphere);
    }
    return Shape(first, second.inv_scale, second.index);
}

fn low_shape_of(sphere: u32) -> Shape {
    let first = low_shape_at(sphere);
    var second = ShapeEnd(vec3r(), sphere);
    if SHAPE_ENDS {
        second = low_shape_end_at(sphere);
    }
    return Shape(first, second.inv_scale, second.index);
}

// Vectors of a material: material_vectors in src/gpu/kernel/specialisation.rs.
override MATERIAL: u32 = 3u;

fn material_of(sphere: u32) -> Material {
    let at = MATERIAL * sphere;
    let color = material_at(at);
    let factors = material_at(at + 1u);
    var scale = vec3r(1.0);
    var ambient_levels = real(0.0);
    if MATERIAL == 3u {
        let last = material_at(at + 2u);
        scale = last.xyz;
        ambient_levels = last.w;
    }
    return Material(color.xyz, color.w, factors.x, factors.y, factors.z, factors.w, scale, ambient_levels);
}

// Not from `params`: compilers for software devices look for conditions that depend on uniform buffers alone, and compile anew
// for what is in them.
fn light_count() -> u32 {
    return LIGHT_COUNT;
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
        light0 = light_at(0u);
        if LIGHT_COUNT > 1u {
            light1 = light_at(1u);
        }
        if LIGHT_COUNT > 2u {
            light2 = light_at(2u);
        }
        if LIGHT_COUNT > 3u {
            light3 = light_at(3u);
        }
    }
}

// The second where `is_second`, else the first.
fn either_light(first: Light, second: Light, is_second: bool) -> Light {
    return Light(select(first.position, second.position, is_second), select(first.intensity, second.intensity, is_second));
}

fn light_of(index: u32) -> Light {
    if LIGHT_COUNT > FEW_LIGHTS {
        return light_at(index);
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
    return low_light_at(index);
}

fn window_at(index: u32) -> vec3r {
    return window_entry_at(index).xyz;
}
