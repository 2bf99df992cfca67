// The scene and what goes from kernel to kernel, in storage buffers.
// needs: real, types

// The first half of each shape, which every test reads, and the second.
@group(0) @binding(1) var<storage, read> shapes: array<vec4r>;
@group(0) @binding(20) var<storage, read> shape_ends: array<ShapeEnd>;
@group(0) @binding(2) var<storage, read> materials: array<vec4r>;
@group(0) @binding(3) var<storage, read> lights: array<Light>;
// What each column of samples and then each row gives to the direction of its rays.
@group(0) @binding(4) var<storage, read> window: array<vec4r>;
// What rounding took from the numbers of the spheres and lights, for the tiers that carry it.
@group(0) @binding(9) var<storage, read> shapes_low: array<vec4r>;
@group(0) @binding(21) var<storage, read> shape_ends_low: array<ShapeEnd>;
@group(0) @binding(10) var<storage, read> lights_low: array<Light>;
// Where the list of each cell begins in `entries` and where it ends; then the lists, one after another.
@group(0) @binding(13) var<storage, read> cells: array<vec2<u32>>;
@group(0) @binding(17) var<storage, read> entries: array<u32>;
// The shapes, entry by entry of the grid's lists.
@group(0) @binding(24) var<storage, read> grid_shapes: array<vec4r>;
@group(0) @binding(25) var<storage, read> grid_shape_ends: array<ShapeEnd>;
// Sides of the cubes of directions around the lights, six of each light.
@group(0) @binding(14) var<storage, read> faces: array<Face>;
// Paths of this bounce, and of the next: see path_kept.wgsl.
@group(0) @binding(11) var<storage, read> paths: array<vec4r>;
@group(0) @binding(18) var<storage, read_write> next_paths: array<vec4r>;
// What the rays of paths have met: see walk_in_turn.wgsl.
@group(0) @binding(22) var<storage, read> hits: array<u32>;
@group(0) @binding(23) var<storage, read_write> kept_hits: array<u32>;

fn shape_at(sphere: u32) -> vec4r {
    return shapes[sphere];
}

fn shape_end_at(sphere: u32) -> ShapeEnd {
    return shape_ends[sphere];
}

fn material_at(index: u32) -> vec4r {
    return materials[index];
}

fn light_at(index: u32) -> Light {
    return lights[index];
}

fn window_entry_at(index: u32) -> vec4r {
    return window[index];
}

fn low_shape_at(sphere: u32) -> vec4r {
    return shapes_low[sphere];
}

fn low_shape_end_at(sphere: u32) -> ShapeEnd {
    return shape_ends_low[sphere];
}

fn low_light_at(index: u32) -> Light {
    return lights_low[index];
}

fn cell_at(index: u32) -> vec2<u32> {
    return cells[index];
}

fn entry_at(index: u32) -> u32 {
    return entries[index];
}

fn grid_shape_at(index: u32) -> vec4r {
    return grid_shapes[index];
}

fn grid_shape_end_at(index: u32) -> ShapeEnd {
    return grid_shape_ends[index];
}

fn face_of(index: u32) -> Face {
    return faces[index];
}

fn path_at(index: u32) -> vec4r {
    return paths[index];
}

fn keep_path(index: u32, v: vec4r) {
    next_paths[index] = v;
}

fn hit_at(index: u32) -> u32 {
    return hits[index];
}

fn keep_hit(index: u32, word: u32) {
    kept_hits[index] = word;
}
