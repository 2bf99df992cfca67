// What counts as a hit, over the roots that the tier's kernel finds; read it beside src/cpu/intersect.rs.
//
// No branches: software devices execute both sides of each.
// needs: body, distance, effects, kernel, ray, real, scene, types

// The sphere that a secondary ray leaves.
struct Own {
    // Shape index of the sphere.
    shape: u32,
    // Whether the ray starts on the inner wall.
    inside: bool,
    // Start of the ray in the sphere's object space.
    local: vec3r,
}

// Not the index of any shape: a primary ray leaves no sphere.
const NO_SHAPE: u32 = 0xffffffffu;

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

// Where a ray meets its own sphere once more: once for each ray, not for each sphere that it is tested against.
struct Exit {
    // Shape index of the sphere.
    shape: u32,
    // 0, which never counts, from the outside: a convex surface is not met again.
    t: real,
}

// A ray that starts on the inner wall leaves its sphere where C = 0, so t = -2B/A and no quadratic is needed.
fn exit_of(own: Own, ray: Ray) -> Exit {
    var direction = direction_of(ray);
    if ELLIPSOIDS {
        direction *= shape_of(select(own.shape, 0u, own.shape == NO_SHAPE)).inv_scale;
    }
    let projection = -dot(own.local, direction);
    return Exit(own.shape, select(real(0.0), (projection + projection) / dot(direction, direction), own.inside));
}

// The least root of one sphere that counts.
struct Root {
    counts: bool,
    t: Distance,
    // Whether it is the greater one.
    inside: bool,
}

// Of a sphere that the ray does not leave.
fn other_root(ray: Ray, body: Body, range: Range) -> Root {
    let roots = roots(ray, body);
    let is_lesser = is_beyond(roots.lesser, range.t_min);
    let t = either(roots.greater, roots.lesser, is_lesser);
    let counts = roots.exist & (is_lesser | (range.greater & is_beyond(roots.greater, range.t_min)));
    return Root(counts & is_nearer(t, range.t_max), t, !is_lesser);
}

// Of any sphere.
fn accepted_root(ray: Ray, body: Body, exit: Exit, range: Range) -> Root {
    let other = other_root(ray, body, range);
    let t = distance_of(exit.t);
    let counts = is_beyond(t, range.t_min) & is_nearer(t, range.t_max);
    let is_own = exit.shape == body.shape.index;
    return Root(select(other.counts, counts, is_own), either(other.t, t, is_own), other.inside | is_own);
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
fn blocks(ray: Ray, body: Body, exit: Exit, t_min: real) -> bool {
    let counts = (exit.t > t_min) & (exit.t < real(1.0));
    return select(root_between(ray, body, t_min), counts, exit.shape == body.shape.index);
}
