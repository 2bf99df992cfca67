// Rays against spheres; read it beside src/cpu/intersect.rs.
//
// The quadratic |c'|^2 t^2 + 2(S'.c')t + |S'|^2 - r^2 = 0 in its numerically sound form: the discriminant from the distance of
// the ray to the centre, the roots as a stable pair (Haines, Gunther, Akenine-Moller, "Precision Improvements for Ray/Sphere
// Intersection", Ray Tracing Gems, chapter 7).

// origin + t direction; the direction need not be normalised.
struct Ray {
    origin: vec3r,
    direction: vec3r,
    // direction . direction, and one over it.
    a: real,
    inv_a: real,
}

fn ray_from(origin: vec3r, direction: vec3r) -> Ray {
    let a = dot(direction, direction);
    return Ray(origin, direction, a, 1.0 / a);
}

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
    t: real,
    sphere: u32,
    // Whether it is the greater root: the sphere is seen from inside.
    inside: bool,
}

// Which roots count.
struct Range {
    // A root counts beyond this.
    t_min: real,
    // A root counts before this.
    t_max: real,
    // Whether the greater root counts where the lesser is too near.
    greater: bool,
}

fn primary_range() -> Range {
    return Range(params.primary_t_min, FAR, SHELLS);
}

fn secondary_range() -> Range {
    return Range(params.secondary_t_min, FAR, true);
}

// A ray's closest approach to a sphere's centre, in the sphere's object space.
struct Approach {
    // S': origin minus centre.
    origin: vec3r,
    // c'.
    direction: vec3r,
    // c'.c'.
    a: real,
    // -S'.c'.
    b: real,
    // From the centre to the closest point of the line.
    perpendicular: vec3r,
    // radius^2 - |perpendicular|^2: negative where the line misses.
    discriminant: real,
}

fn approach(ray: Ray, shape: Shape) -> Approach {
    var origin = ray.origin - shape.center;
    var direction = ray.direction;
    var a = ray.a;
    var inv_a = ray.inv_a;
    if ELLIPSOIDS {
        origin *= shape.inv_scale;
        direction *= shape.inv_scale;
        a = dot(direction, direction);
        inv_a = 1.0 / a;
    }
    let b = -dot(origin, direction);
    // An error of b/a moves the point along the ray, which changes its distance to second order only.
    let perpendicular = origin + direction * (b * inv_a);
    let discriminant = shape.radius * shape.radius - dot(perpendicular, perpendicular);
    return Approach(origin, direction, a, b, perpendicular, discriminant);
}

// Both roots, lesser first. Only where the discriminant is not negative.
fn roots(at: Approach, radius: real) -> vec2<real> {
    let root = sqrt(at.a * at.discriminant);
    let c = dot(at.origin, at.origin) - radius * radius;
    if at.b >= 0.0 {
        let q = at.b + root;
        return vec2<real>(c / q, q / at.a);
    }
    let q = at.b - root;
    return vec2<real>(q / at.a, c / q);
}

// Where a ray that starts on the inner wall leaves its own sphere: C = 0, so t = -2B/A and no quadratic is needed.
fn exit_root(own: Own, ray: Ray, shape: Shape) -> real {
    var direction = ray.direction;
    var a = ray.a;
    if ELLIPSOIDS {
        direction *= shape.inv_scale;
        a = dot(direction, direction);
    }
    let projection = -dot(own.local, direction);
    return (projection + projection) / a;
}

// The least root of one sphere that counts.
struct Root {
    counts: bool,
    t: real,
    // Whether it is the greater one.
    inside: bool,
}

fn accepted_root(ray: Ray, shape: Shape, own: Own, range: Range) -> Root {
    if SKIP_SELF && own.shape == shape.index {
        // The outside of a convex surface is never met again.
        let t = exit_root(own, ray, shape);
        return Root(own.inside && t > range.t_min && t < range.t_max, t, true);
    }
    let at = approach(ray, shape);
    // Ordered comparison: a NaN is never a hit.
    if !(at.discriminant >= 0.0) {
        return Root(false, FAR, false);
    }
    let t = roots(at, shape.radius);
    if t.x > range.t_min {
        return Root(t.x < range.t_max, t.x, false);
    }
    return Root(range.greater && t.y > range.t_min && t.y < range.t_max, t.y, true);
}

// The nearest intersection in the range; of equal ones the lowest index.
fn nearest_hit(ray: Ray, own: Own, within: Range) -> Hit {
    var range = within;
    var nearest = Hit(false, FAR, 0u, false);
    for (var sphere = 0u; sphere < sphere_count(); sphere++) {
        let root = accepted_root(ray, shapes[sphere], own, range);
        if root.counts {
            nearest = Hit(true, root.t, sphere, root.inside);
            range.t_max = root.t;
        }
    }
    return nearest;
}

// Whether a root that counts lies beyond t_min and before t = 1: from where both ends lie, without a square root.
fn blocks(ray: Ray, shape: Shape, own: Own) -> bool {
    let t_min = params.secondary_t_min;
    if SKIP_SELF && own.shape == shape.index {
        let t = exit_root(own, ray, shape);
        return own.inside && t > t_min && t < 1.0;
    }
    let at = approach(ray, shape);
    let start = at.origin + at.direction * t_min;
    let end = at.origin + at.direction;
    let starts_outside = dot(start, start) > shape.radius * shape.radius;
    let ends_outside = dot(end, end) > shape.radius * shape.radius;
    let passes = starts_outside && ends_outside && at.b > at.a * t_min && at.b < at.a;
    return at.discriminant >= 0.0 && (starts_outside != ends_outside || passes);
}

// Whether any sphere stands between the ray's origin and t = 1.
fn any_hit(ray: Ray, own: Own) -> bool {
    var blocked = false;
    for (var sphere = 0u; sphere < sphere_count(); sphere++) {
        blocked |= blocks(ray, shapes[sphere], own);
        if MANY && blocked {
            break;
        }
    }
    return blocked;
}
