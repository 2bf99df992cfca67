// What counts as a hit, over the roots that the tier's kernel finds; read it beside src/cpu/intersect.rs.
//
// No branches: software devices execute both sides of each.

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
fn exit_root(own: Own, direction_in_world: vec3r, body: Body) -> real {
    var direction = direction_in_world;
    if ELLIPSOIDS {
        direction *= body.shape.inv_scale;
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

fn accepted_root(ray: Ray, body: Body, own: Own, range: Range) -> Root {
    let roots = roots(ray, body);
    let is_lesser = is_beyond(roots.lesser, range.t_min);
    var t = either(roots.greater, roots.lesser, is_lesser);
    var is_accepted = roots.exist & (is_lesser | (range.greater & is_beyond(roots.greater, range.t_min)));
    var inside = !is_lesser;
    // The outside of a convex surface is never met again.
    let is_own = own.shape == body.shape.index;
    let exit = distance_of(exit_root(own, direction_of(ray), body));
    t = either(t, exit, is_own);
    is_accepted = select(is_accepted, own.inside & is_beyond(exit, range.t_min), is_own);
    inside |= is_own;
    return Root(is_accepted & is_nearer(t, range.t_max), t, inside);
}

fn no_hit() -> Hit {
    return Hit(false, distance_of(FAR), 0u, false);
}

// The second where `is_second`, else the first.
fn nearer_hit(first: Hit, second: Hit, is_second: bool) -> Hit {
    return Hit(
        select(first.found, second.found, is_second),
        either(first.t, second.t, is_second),
        select(first.sphere, second.sphere, is_second),
        select(first.inside, second.inside, is_second),
    );
}

// Whether a root that counts lies beyond t_min and before t = 1.
fn blocks(ray: Ray, body: Body, own: Own, t_min: real) -> bool {
    let t = exit_root(own, direction_of(ray), body);
    let is_own = own.shape == body.shape.index;
    return select(root_between(ray, body, t_min), own.inside & (t > t_min) & (t < real(1.0)), is_own);
}
