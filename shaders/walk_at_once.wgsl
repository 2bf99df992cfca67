// One bounce of each path: what its ray meets, and its shading.
// needs: effects, intersect, path, queue, scene, secondary, types

@compute @workgroup_size(GROUP)
fn walk_paths(@builtin(global_invocation_id) id: vec3<u32>) {
    params = given_params;
    load_lights();
    let count = path_queue.path_count;
    let is_path = id.x < count;
    let path = path_of(min(id.x, count - 1u));
    var hit = nearest_secondary(path.ray, path.own, reflection_range());
    hit.found &= is_path;
    shade(path.ray, hit, is_path, path.slot, path.color, path.throughput);
}
