// What counts as a hit, over the roots that the tier's kernel finds; read it beside src/cpu/intersect.rs.

// The sphere that a secondary ray leaves.
struct Own {
    // Shape index of the sphere.
    shape: u32,
    // Whether the ray starts on the inner wall.
    inside: bool,
    // Start of the ray in the sphere's object space.
    local: vec3r,
}

// The nearest accepted intersection.
struct Hit {
    found: bool,
    t: Distance,
    sphere: u32,
    // Whether it is the greater root: the sphere is seen from inside.
    inside: bool,
}

// Which roots count.
struct Range {
    // A root counts beyond this.
    t_min: real,
    // A root counts before this.
    t_max: Distance,
    // Whether the greater root counts where the lesser is too near.
    greater: bool,
}

fn primary_range() -> Range {
    return Range(params.primary_t_min, distance_of(FAR), SHELLS);
}

fn reflection_range() -> Range {
    return Range(params.reflection_t_min, distance_of(FAR), true);
}

// Where a ray that starts on the inner wall leaves its own sphere: C = 0, so t = -2B/A and no quadratic is needed.
fn exit_root(own: Own, direction_in_world: vec3r, sphere: u32) -> real {
    var direction = direction_in_world;
    if ELLIPSOIDS {
        direction *= shapes[sphere].inv_scale;
    }
    let projection = -dot(own.local, direction);
    return (projection + projection) / dot(direction, direction);
}

// The least root of one sphere that counts.
struct Root {
    counts: bool,
    t: Distance,
    // Whether it is the greater one.
    inside: bool,
}

fn accepted_root(ray: Ray, sphere: u32, own: Own, range: Range) -> Root {
    if SKIP_SELF && own.shape == shapes[sphere].index {
        // The outside of a convex surface is never met again.
        let t = distance_of(exit_root(own, direction_of(ray), sphere));
        return Root(own.inside && is_beyond(t, range.t_min) && is_nearer(t, range.t_max), t, true);
    }
    let roots = roots(ray, sphere);
    if is_beyond(roots.lesser, range.t_min) {
        return Root(roots.exist && is_nearer(roots.lesser, range.t_max), roots.lesser, false);
    }
    let is_within = is_beyond(roots.greater, range.t_min) && is_nearer(roots.greater, range.t_max);
    return Root(roots.exist && range.greater && is_within, roots.greater, true);
}

fn no_hit() -> Hit {
    return Hit(false, distance_of(FAR), 0u, false);
}

// Whether a root that counts lies beyond t_min and before t = 1.
fn blocks(ray: Ray, sphere: u32, own: Own) -> bool {
    let t_min = params.shadow_t_min;
    if SKIP_SELF && own.shape == shapes[sphere].index {
        let t = exit_root(own, direction_of(ray), sphere);
        return own.inside && t > t_min && t < real(1.0);
    }
    return root_between(ray, sphere, t_min);
}
