// The nearest hit and any hit among all spheres of first_sphere() and sphere_count().

// The nearest intersection in the range; of equal ones the lowest index.
fn nearest_hit(ray: Ray, own: Own, within: Range) -> Hit {
    var range = within;
    var nearest = no_hit();
    var sphere = first_sphere();
    if sphere == sphere_count() {
        return nearest;
    }
    loop {
        let root = accepted_root(ray, sphere, own, range);
        if root.counts {
            nearest = Hit(true, root.t, sphere, root.inside);
            range.t_max = root.t;
        }
        sphere++;
        if sphere == sphere_count() {
            break;
        }
    }
    return nearest;
}

// The nearest intersection of a primary ray through the tile of this pixel.
fn nearest_seen(ray: Ray, pixel: vec2<u32>) -> Hit {
    return nearest_hit(ray, Own(NO_SHAPE, false, vec3r()), primary_range());
}

// The nearest intersection of a ray that leaves a surface.
fn nearest_secondary(ray: Ray, own: Own, range: Range) -> Hit {
    return nearest_hit(ray, own, range);
}

// Whether any sphere stands between the ray's origin and the light with this index, at t = 1.
fn any_hit(ray: Ray, own: Own, light: u32) -> bool {
    var blocked = false;
    var sphere = first_sphere();
    if sphere == sphere_count() {
        return blocked;
    }
    loop {
        blocked |= blocks(ray, sphere, own);
        sphere++;
        if sphere == sphere_count() || (LEAVES_EARLY && blocked) {
            break;
        }
    }
    return blocked;
}
