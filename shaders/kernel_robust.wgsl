// Ray against sphere in f32 with error-free transforms where rounding would decide; the same functions as kernel_plain.wgsl.
//
// Far from the sphere the discriminant is A r^2 - |S' x c'|^2 (Lagrange's identity), whose cross product is compensated; near
// its surface, where that cancels, it is B^2 - A C with compensated B and C. Origins, directions, centres and scales carry
// what rounding took from them.
// needs: body, distance, effects, eft, intersect, ray, real, roots, types

// The ray in the sphere's object space.
struct Approach {
    // c'.
    direction: Pair3,
    // S' x c'.
    moment: Pair3,
    // c'.c', -S'.c' and S'.S' - r^2.
    a: Pair,
    b: Pair,
    c: Pair,
    // B^2 - A C: negative where the line misses.
    discriminant: Pair,
}

fn approach(ray: Ray, body: Body) -> Approach {
    let shape = body.shape;
    let low = body.low;
    var origin = pair_difference3(ray.origin, Pair3(shape.center_radius.xyz, low.center_radius.xyz));
    var direction = ray.direction;
    if ELLIPSOIDS {
        let inv_scale = Pair3(shape.inv_scale, low.inv_scale);
        origin = pair_product3(origin, inv_scale);
        direction = pair_product3(direction, inv_scale);
    }
    let moment = pair_cross(origin, direction);
    let a = pair_dot(direction, direction);
    let minus_b = pair_dot(origin, direction);
    let radius = Pair(shape.center_radius.w, low.center_radius.w);
    let radius_squared = pair_product(radius, radius);
    let c = pair_difference(pair_dot(origin, origin), radius_squared);
    let far = pair_difference(pair_product(a, radius_squared), pair_dot(moment, moment));
    let near = pair_difference(pair_product(minus_b, minus_b), pair_product(a, c));
    let is_near = abs(c.hi) < 0.5 * radius_squared.hi;
    return Approach(direction, moment, a, Pair(-minus_b.hi, -minus_b.lo), c, Pair(select(far.hi, near.hi, is_near), select(far.lo, near.lo, is_near)));
}

// Whether rounding could decide whether the line of a primary ray touches the sphere: src/exact.rs has the margin.
fn may_touch(ray: Ray, body: Body) -> bool {
    let at = approach(ray, body);
    let radius = body.shape.center_radius.w;
    return abs(at.discriminant.hi) < params.tangent_margin * (at.a.hi * (radius * radius));
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
    let hits = at.discriminant.hi >= 0.0;
    let root = square_root(at.discriminant);
    let is_ahead = at.b.hi >= 0.0;
    let q = pair_sum(at.b, Pair(select(-root.hi, root.hi, is_ahead), select(-root.lo, root.lo, is_ahead)));
    let stable = quotient(at.c, q);
    let other = quotient(q, at.a);
    return Roots(hits, either(other, stable, is_ahead), either(stable, other, is_ahead));
}

// Whether a root lies beyond t_min and before t = 1.
fn root_between(ray: Ray, body: Body, t_min: real) -> bool {
    let at = roots(ray, body);
    let end = distance_of(1.0);
    let lesser = is_beyond(at.lesser, t_min);
    let greater = is_beyond(at.greater, t_min) & is_nearer(at.greater, end);
    return at.exist & select(greater, is_nearer(at.lesser, end), lesser);
}

// The hit in object space: from the closest approach c' x (S' x c') / A half a chord back or forth. In pairs, since what comes
// next may lie far nearer than a radius: the eye, a light, another surface.
fn local_hit(ray: Ray, body: Body, hit: Hit) -> Point {
    let at = approach(ray, body);
    let perpendicular = pair_cross(at.direction, at.moment);
    let discriminant = Pair(max(at.discriminant.hi, 0.0), select(0.0, at.discriminant.lo, at.discriminant.hi > 0.0));
    let root = pair_square_root(discriminant);
    let half_chord = pair_scaled3(at.direction, Pair(select(-root.hi, root.hi, hit.inside), select(-root.lo, root.lo, hit.inside)));
    return pair_quotient3(pair_sum3(perpendicular, half_chord), at.a);
}
