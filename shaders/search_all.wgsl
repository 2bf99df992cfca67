// The nearest hit and any hit among all spheres of first_sphere() and sphere_count().
// needs: body, distance, intersect, ray, scene, types

// The nearest intersection in the range; of equal ones the lowest index.
fn nearest_hit(ray: Ray, own: Own, within: Range) -> Hit {
    let exit = exit_of(own, ray);
    var range = within;
    var nearest = no_hit();
    for (var sphere = first_sphere(); sphere < sphere_count(); sphere++) {
        let root = accepted_root(ray, body_of(sphere), exit, range);
        nearest = nearer_hit(nearest, Hit(true, root.t, sphere, root.inside), root.counts);
        range.t_max = either(range.t_max, root.t, root.counts);
    }
    return nearest;
}

// Whether any sphere stands between the ray's origin and the light with this index, at t = 1.
fn any_hit(ray: Ray, own: Own, light: Light, index: u32) -> bool {
    let exit = exit_of(own, ray);
    var blocked = false;
    for (var sphere = first_sphere(); sphere < sphere_count() && !blocked; sphere++) {
        blocked = blocks(ray, body_of(sphere), exit, params.shadow_t_min);
    }
    return blocked;
}
