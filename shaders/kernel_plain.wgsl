// Ray against sphere in plain arithmetic, f32 or f64; read it beside src/cpu/intersect.rs.
//
// The quadratic |c'|^2 t^2 + 2(S'.c')t + |S'|^2 - r^2 = 0 in its numerically sound form: the discriminant from the distance of
// the ray to the centre, the roots as a stable pair (Haines, Gunther, Akenine-Moller, "Precision Improvements for Ray/Sphere
// Intersection", Ray Tracing Gems, chapter 7).
// needs: body, difference, distance, effects, intersect, ray, real, types

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

fn approach(ray: Ray, body: Body) -> Approach {
    let shape = body.shape;
    let from_center = difference(ray.origin, shape.center_radius.xyz);
    var origin = from_center.hi;
    var origin_low = from_center.lo;
    var direction = ray.direction;
    var a = ray.a;
    var inv_a = ray.inv_a;
    if ELLIPSOIDS {
        origin *= shape.inv_scale;
        origin_low *= shape.inv_scale;
        direction *= shape.inv_scale;
        a = dot(direction, direction);
        inv_a = real(1.0) / a;
    }
    let b = -dot(origin, direction);
    // What the difference lost matters for the closest point alone. An error of b/a moves the point along the ray, which
    // changes its distance to second order only.
    let perpendicular = along(origin, direction, b * inv_a) + origin_low;
    let radius = shape.center_radius.w;
    let discriminant = radius * radius - dot(perpendicular, perpendicular);
    return Approach(origin, direction, a, b, perpendicular, discriminant);
}

// Whether rounding could decide whether the line of a primary ray touches the sphere: src/exact.rs has the margin.
fn may_touch(ray: Ray, body: Body) -> bool {
    let radius = body.shape.center_radius.w;
    return abs(approach(ray, body).discriminant) < real(params.tangent_margin) * (radius * radius);
}

// Both intersections of the line.
struct Roots {
    // Whether there are any. Ordered comparisons decide: a NaN is never a hit.
    exist: bool,
    lesser: Distance,
    greater: Distance,
}

fn roots(ray: Ray, body: Body) -> Roots {
    let at = approach(ray, body);
    let radius = body.shape.center_radius.w;
    let hits = at.discriminant >= real(0.0);
    let root = sqrt(at.a * at.discriminant);
    let c = dot(at.origin, at.origin) - radius * radius;
    let is_ahead = at.b >= real(0.0);
    let q = at.b + select(-root, root, is_ahead);
    let stable = c / q;
    let other = q / at.a;
    return Roots(hits, select(other, stable, is_ahead), select(stable, other, is_ahead));
}

// Whether a root lies beyond t_min and before t = 1: from where both ends lie, without a square root.
fn root_between(ray: Ray, body: Body, t_min: real) -> bool {
    let at = approach(ray, body);
    let radius = body.shape.center_radius.w;
    let start = at.origin + at.direction * t_min;
    let end = at.origin + at.direction;
    let end_squared = dot(end, end);
    let starts_outside = dot(start, start) > radius * radius;
    let crosses = select(end_squared > radius * radius, end_squared < radius * radius, starts_outside);
    // An end on the very surface is not beyond it.
    let passes = starts_outside & (end_squared >= radius * radius) & (at.b > at.a * t_min) & (at.b < at.a);
    return (at.discriminant >= real(0.0)) & (crosses | passes);
}

// The hit in object space: from the closest approach half a chord back or forth, since S' + t c' would lose what distance costs.
fn local_hit(ray: Ray, body: Body, hit: Hit) -> vec3r {
    let at = approach(ray, body);
    let half_chord = at.direction * sqrt(max(at.discriminant, real(0.0)) / at.a);
    return at.perpendicular + select(-half_chord, half_chord, hit.inside);
}
