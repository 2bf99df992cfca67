// Spheres of any number in textures, bit for bit what buffers would hold: software devices load from a texture for all lanes at
// once, from a storage buffer lane by lane. Four numbers make a vector; see vector_at in real_*.wgsl.

// The first half of each shape, which every test reads, and the second.
@group(0) @binding(1) var shapes: texture_2d<u32>;
@group(0) @binding(20) var shape_ends: texture_2d<u32>;
@group(0) @binding(2) var materials: texture_2d<u32>;
// What each column of samples and then each row gives to the direction of its rays.
@group(0) @binding(4) var window: texture_2d<u32>;
// What rounding took from the numbers of the spheres, for the tiers that carry it.
@group(0) @binding(9) var shapes_low: texture_2d<u32>;
@group(0) @binding(21) var shape_ends_low: texture_2d<u32>;
// Where the list of each cell begins in `entries` and where it ends; then the lists, one after another.
@group(0) @binding(13) var cells: texture_2d<u32>;
@group(0) @binding(17) var entries: texture_2d<u32>;

fn shape_of(sphere: u32) -> Shape {
    return Shape(vector_at(shapes, sphere), vector_at(shape_ends, sphere).xyz, bits_at(shape_ends, sphere));
}

fn low_shape_of(sphere: u32) -> Shape {
    return Shape(vector_at(shapes_low, sphere), vector_at(shape_ends_low, sphere).xyz, bits_at(shape_ends_low, sphere));
}

fn material_of(sphere: u32) -> Material {
    let at = 3u * sphere;
    let color = vector_at(materials, at);
    let factors = vector_at(materials, at + 1u);
    return Material(color.xyz, color.w, factors.x, factors.y, factors.z, factors.w, vector_at(materials, at + 2u).xyz);
}

fn window_at(index: u32) -> vec3r {
    return vector_at(window, index).xyz;
}

fn cell_at(index: u32) -> vec2<u32> {
    return textureLoad(cells, texel(index), 0).xy;
}

fn entry_at(index: u32) -> u32 {
    return textureLoad(entries, texel(index), 0).x;
}
