// The same tables as tables_buffers.wgsl in textures, bit for bit what buffers would hold: software devices load from a texture for
// all lanes at once, from a storage buffer lane by lane. The types of textures are in texture_*.wgsl, numbers in vectors_*.wgsl.
// needs: real, texels, texture, types, vectors

@group(0) @binding(1) var shapes: Table;
@group(0) @binding(20) var shape_ends: Table;
@group(0) @binding(2) var materials: Table;
@group(0) @binding(3) var lights: Table;
@group(0) @binding(4) var window: Table;
@group(0) @binding(9) var shapes_low: Table;
@group(0) @binding(21) var shape_ends_low: Table;
@group(0) @binding(10) var lights_low: Table;
@group(0) @binding(13) var cells: PairTable;
@group(0) @binding(17) var entries: PairTable;
@group(0) @binding(24) var grid_shapes: Table;
@group(0) @binding(25) var grid_shape_ends: Table;
@group(0) @binding(14) var faces: Table;
@group(0) @binding(11) var paths: Table;
@group(0) @binding(18) var next_paths: texture_storage_2d<rgba32uint, write>;
@group(0) @binding(22) var hits: WordTable;
@group(0) @binding(23) var kept_hits: texture_storage_2d<r32uint, write>;

fn shape_at(sphere: u32) -> vec4r {
    return vector_at(shapes, sphere);
}

fn shape_end_at(sphere: u32) -> ShapeEnd {
    return ShapeEnd(vector_at(shape_ends, sphere).xyz, bits_at(shape_ends, sphere));
}

fn material_at(index: u32) -> vec4r {
    return vector_at(materials, index);
}

fn light_at(index: u32) -> Light {
    return Light(vector_at(lights, 2u * index).xyz, vector_at(lights, 2u * index + 1u).xyz);
}

fn window_entry_at(index: u32) -> vec4r {
    return vector_at(window, index);
}

fn low_shape_at(sphere: u32) -> vec4r {
    return vector_at(shapes_low, sphere);
}

fn low_shape_end_at(sphere: u32) -> ShapeEnd {
    return ShapeEnd(vector_at(shape_ends_low, sphere).xyz, bits_at(shape_ends_low, sphere));
}

fn low_light_at(index: u32) -> Light {
    return Light(vector_at(lights_low, 2u * index).xyz, vector_at(lights_low, 2u * index + 1u).xyz);
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

fn grid_shape_at(index: u32) -> vec4r {
    return vector_at(grid_shapes, index);
}

fn grid_shape_end_at(index: u32) -> ShapeEnd {
    return ShapeEnd(vector_at(grid_shape_ends, index).xyz, bits_at(grid_shape_ends, index));
}

// A vector, and a texel of words.
fn face_of(index: u32) -> Face {
    let at = index * (TEXELS + 1u);
    let place = vector_from(faces, at);
    let words = texel_at(faces, at + TEXELS);
    return Face(place.xy, place.z, words.xy, words.z);
}

fn path_at(index: u32) -> vec4r {
    return vector_at(paths, index);
}

fn keep_path(index: u32, v: vec4r) {
    for (var part = 0u; part < TEXELS; part++) {
        textureStore(next_paths, place_of_texel(index * TEXELS + part), texel_of(v, part));
    }
}

fn hit_at(index: u32) -> u32 {
    return word_at(hits, index);
}

fn keep_hit(index: u32, word: u32) {
    textureStore(kept_hits, place_of_texel(index), vec4<u32>(word));
}
