// How far rounding may have moved what a sample shows, carried along while it is traced; read it beside src/cpu/bound.rs.
//
// A ray is known as a cone: its origin to bound_position, in world units, its direction to bound_direction, as an angle. At every
// decision the cone has to lie on one side; where it does not, the sample is marked, and so where its colour is not known well
// enough to name its level. Roundings are counted in src/roundings.rs, in units of the unit roundoff ROUNDOFF.
// needs: body, counters, effects, elementary, intersect, kernel, quantize, ray, real, scene, shade, types
// host: ANGLE, AXES, LENGTH, LOCAL, LOST, NEAR, NOTHING, OTHERS, PLACE, POWER, ROOT, ROOT_AT_EDGE, ROUNDOFF, SQUARE, TERM

// Of the ray in hand: errors of its origin, in world units, and of its direction, as an angle.
var<private> bound_position: real;
var<private> bound_direction: real;
// The width of the cone at t is bound_base + |t| bound_slope, in world units.
var<private> bound_base: real;
var<private> bound_slope: real;
// Of the search in hand: the least distance at which the ray may meet a sphere, and the least of another one; the index of the
// first one's shape;
var<private> bound_first: real;
var<private> bound_second: real;
var<private> bound_shape: u32;
// the greatest squared error of such a distance, and that of the own sphere's.
var<private> bound_error: real;
var<private> bound_exit: real;
// Of the shadow ray in hand: whether its own sphere may block it, whether it surely meets a blocker, and whether it may.
var<private> bound_is_exit_near: bool;
var<private> bound_is_blocked: bool;
var<private> bound_may_be_blocked: bool;
// Error of the unit normal of the surface in hand.
var<private> bound_normal: real;
// Weight of the ray in hand.
var<private> bound_weight: real;
// How far the colour may be off, and the sizes of all its terms but a first product of constants: of the channels the greatest. Before
// there are other terms the levels of that product as a number: -1 - it.
var<private> bound_color: real;
var<private> bound_sizes: real;

// Roundings of a place on its way into object space, as a part of its distance.
fn bound_place() -> real {
    return ROUNDOFF * select(PLACE, PLACE + AXES, ELLIPSOIDS);
}

// Likewise as a part of the radius, with the roundings of its square.
fn bound_local() -> real {
    return ROUNDOFF * select(LOCAL + SQUARE, LOCAL + AXES + SQUARE, ELLIPSOIDS);
}

fn size_of(v: vec3r) -> real {
    return abs(v.x) + abs(v.y) + abs(v.z);
}

fn largest(v: vec3r) -> real {
    return max(v.x, max(v.y, v.z));
}

// How many times as long world vectors may become in the object space of the sphere.
fn stretch_of(body: Body) -> real {
    return select(real(1.0), largest(body.shape.inv_scale), ELLIPSOIDS);
}

// A sample's primary ray.
fn begin_bound() {
    bound_position = params.position_error;
    bound_direction = params.direction_error;
    bound_weight = real(1.0);
    bound_color = real(0.0);
    bound_sizes = real(-1.0) - params.background_levels;
}

// The search for the nearest hit.
fn begin_search(ray: Ray) {
    let length = sqrt(ray.a);
    bound_base = bound_position + params.moved + bound_place() * size_of(ray.origin);
    bound_slope = length * (bound_direction + bound_place());
    bound_first = FAR;
    bound_second = FAR;
    bound_shape = NO_SHAPE;
    bound_error = real(0.0);
    bound_exit = real(0.0);
}

// Likewise along a ray that leaves a surface, and may leave its sphere again.
fn begin_secondary(ray: Ray, own: Own, exit: Exit, range: Range) {
    begin_search(ray);
    // From the outside it does not meet it again.
    if own.inside {
        bound_exit = exit_error(ray, own);
        let is_near = !(abs(exit.t - range.t_min) > bound_exit);
        add_root(select(exit.t, range.t_min, is_near), is_near, exit.shape, is_near | (exit.t > range.t_min), false);
    }
}

// The centre of a sphere is no farther away than the way to its surface and its radius; that of an ellipsoid may be.
fn center_error(body: Body) -> real {
    return select(real(0.0), ROUNDOFF * size_of(body.shape.center_radius.xyz), ELLIPSOIDS);
}

// Half the width of the cone at t, in the object space of the sphere, with the rounding on the way there.
fn bound_width(body: Body, t: real) -> real {
    let world = bound_base + abs(t) * bound_slope + center_error(body);
    return stretch_of(body) * world + bound_local() * body.shape.center_radius.w;
}

// How far the discriminant may be off where the line is about a radius from the centre.
fn reach_of(width: real, radius: real) -> real {
    return (width + width) * (radius + width);
}

// Likewise, to the side where the ray passes: long axes count less there.
fn reach_aside(at: Approach, body: Body, t: real, width: real) -> real {
    let gradient = at.perpendicular * body.shape.inv_scale;
    let world = bound_base + abs(t) * bound_slope + center_error(body);
    let radius = body.shape.center_radius.w;
    let rounding = bound_place() * abs(t) * sqrt(at.a) + bound_local() * radius;
    let aside = sqrt(dot(gradient, gradient)) * world + sqrt(dot(at.perpendicular, at.perpendicular)) * rounding;
    return real(2.0) * (aside + width * width);
}

// Whether it is in doubt that the line meets the sphere. NaN is in doubt.
fn is_edge(at: Approach, body: Body, t: real, width: real, reach: real) -> bool {
    var edge = reach;
    if ELLIPSOIDS {
        edge = min(edge, reach_aside(at, body, t, width));
    }
    return !(abs(at.discriminant) > edge);
}

// How near to a surface the end of a ray, squared, has to lie for its side to be in doubt: the width at the closest approach, which
// `reach` is of, does for that of the end.
fn near_of(reach: real) -> real {
    return real(0.5) * NEAR * reach;
}

// A sphere is met from t on; where that is in doubt, it counts as two. The same one counts once, however often it is listed.
fn add_root(t: real, is_doubt: bool, shape: u32, is_met: bool, is_listed_once: bool) {
    var counts = is_met;
    if !is_listed_once {
        counts &= !((t == bound_first) & (shape == bound_shape));
    }
    let is_first = counts & (t < bound_first);
    let later = max(t, bound_first);
    bound_second = select(bound_second, min(bound_second, select(later, t, is_doubt)), counts);
    bound_first = select(bound_first, t, is_first);
    bound_shape = select(bound_shape, shape, is_first);
}

// A ray has been tested with a sphere that it does not leave; `starts` is whether it may begin within one.
fn note_other(ray: Ray, body: Body, range: Range, is_other: bool, starts: bool, is_listed_once: bool) {
    let at = approach(ray, body);
    let radius = body.shape.center_radius.w;
    let inv_a = select(ray.inv_a, real(1.0) / at.a, ELLIPSOIDS);
    let closest = at.b * inv_a;
    let width = bound_width(body, closest);
    let reach = reach_of(width, radius);
    var is_doubt = is_edge(at, body, closest, width, reach);
    let roots = roots(ray, body);
    var t = select(roots.lesser, max(closest - radius * sqrt(inv_a), range.t_min), is_doubt);
    var counts = is_doubt | roots.exist;
    if starts {
        // The squared distance of the place where roots begin to count.
        let start = dot(at.origin, at.origin) - radius * radius - range.t_min * (at.b + at.b - range.t_min * at.a);
        let is_near = !(abs(start) > near_of(reach)) & !(at.discriminant < -reach);
        let is_outside = start > real(0.0);
        let is_behind = at.b <= at.a * range.t_min;
        counts = (counts & (!is_behind | !is_outside) & (is_outside | range.greater)) | is_near;
        t = select(select(roots.greater, t, is_outside | is_doubt), range.t_min, is_near);
        is_doubt |= is_near;
    }
    counts &= is_other;
    add_root(t, is_doubt, body.shape.index, counts, is_listed_once);
    bound_error = max(bound_error, select(real(0.0), reach * inv_a, counts & !is_doubt));
}

// A primary ray has been tested with a sphere, which `nearest` does not count yet.
fn note_seen(ray: Ray, body: Body, range: Range, root: Root, nearest: Hit) {
    if SHELLS {
        note_other(ray, body, range, true, true, true);
    } else {
        let at = approach(ray, body);
        let radius = body.shape.center_radius.w;
        let inv_a = select(ray.inv_a, real(1.0) / at.a, ELLIPSOIDS);
        let closest = at.b * inv_a;
        let width = bound_width(body, closest);
        let reach = reach_of(width, radius);
        let edge = max(closest - radius * sqrt(inv_a), range.t_min);
        let doubtful = select(FAR, edge, is_edge(at, body, closest, width, reach));
        let later = max(select(FAR, root.t, root.counts), nearest.t);
        bound_second = min(bound_second, min(doubtful, later));
        bound_error = max(bound_error, reach * inv_a);
    }
}

// A secondary ray has been tested with any sphere.
fn note_tested(ray: Ray, body: Body, exit: Exit, range: Range) {
    note_other(ray, body, range, exit.shape != body.shape.index, true, false);
}

// Error of the distance at which a ray leaves its own sphere.
fn exit_error(ray: Ray, own: Own) -> real {
    var a = ray.a;
    var stretch = real(1.0);
    if ELLIPSOIDS {
        let inv_scale = shape_of(select(own.shape, 0u, own.shape == NO_SHAPE)).inv_scale;
        let direction = ray.direction * inv_scale;
        a = dot(direction, direction);
        stretch = largest(inv_scale);
    }
    let radius = sqrt(dot(own.local, own.local));
    let inv_length = real(1.0) / sqrt(a);
    let place = stretch * bound_base + bound_local() * radius;
    return real(2.0) * (place + real(3.0) * radius * (stretch * bound_slope * inv_length)) * inv_length;
}

// The search has ended with this hit.
fn end_search(ray: Ray, hit: Hit, is_primary: bool) {
    let error = real(2.0) * ROOT_AT_EDGE * sqrt(bound_error) + bound_exit + ROUNDOFF * ROOT * abs(hit.t);
    // NaN is in doubt.
    is_unsure |= select(bound_second < FAR, !(bound_second - hit.t > error), hit.found);
    if !is_primary {
        // Lists of spheres take a ray for what it is but for so much.
        let along = dot(ray.origin - params.middle, ray.direction) * sqrt(ray.inv_a);
        let rest = max(params.extent - along, real(0.0)) * (bound_direction + bound_place());
        is_unsure |= !(bound_base + select(rest, abs(hit.t) * bound_slope, hit.found) <= params.allowance);
    }
}

// The search for what stands before a light.
fn begin_shadow(ray: Ray, own: Own, exit: Exit, t_min: real) {
    let length = sqrt(ray.a);
    // Both ends of the way are known.
    bound_base = bound_position + params.moved + bound_place() * (size_of(ray.origin) + length);
    bound_slope = bound_place() * length;
    is_unsure |= !(bound_position <= params.light_allowance);
    bound_is_exit_near = false;
    if own.inside {
        let error = exit_error(ray, own);
        bound_is_exit_near = !(abs(exit.t - t_min) > error) | !(abs(exit.t - real(1.0)) > error);
    }
    bound_is_blocked = false;
    bound_may_be_blocked = false;
}

// A shadow ray has been tested with a sphere.
fn note_crossed(ray: Ray, body: Body, exit: Exit, t_min: real) {
    let at = approach(ray, body);
    let radius = body.shape.center_radius.w;
    let closest = at.b * select(ray.inv_a, real(1.0) / at.a, ELLIPSOIDS);
    let width = bound_width(body, closest);
    let reach = reach_of(width, radius);
    let start = at.origin + at.direction * t_min;
    let end = at.origin + at.direction;
    let near = near_of(reach);
    let is_near = !(abs(dot(start, start) - radius * radius) > near) | !(abs(dot(end, end) - radius * radius) > near);
    let passes = (at.b > at.a * t_min) & (at.b < at.a);
    let is_crossed = ((passes & is_edge(at, body, closest, width, reach)) | is_near) & !(at.discriminant < -reach);
    let is_doubt = select(is_crossed, bound_is_exit_near, exit.shape == body.shape.index);
    bound_may_be_blocked |= is_doubt;
    bound_is_blocked |= !is_doubt & blocks(ray, body, exit, t_min);
}

// All that stands before a light is known.
fn end_shadow() {
    is_unsure |= bound_may_be_blocked & !bound_is_blocked;
}

// The surface of a hit is known, with its place in object space.
fn note_surface(ray: Ray, body: Body, scale: vec3r, local: vec3r, hit: Hit) {
    let at = approach(ray, body);
    let radius = body.shape.center_radius.w;
    let center = body.shape.center_radius.xyz;
    let inv_length = sqrt(select(ray.inv_a, real(1.0) / at.a, ELLIPSOIDS));
    // |D local|, the gradient in the world of half the squared distance from the centre.
    var gradient = radius;
    var greatest = real(1.0);
    if ELLIPSOIDS {
        let g = local * body.shape.inv_scale;
        gradient = sqrt(dot(g, g));
        greatest = largest(scale);
    }
    // From the place itself: kernels that do not keep t know it.
    let way = local - at.origin;
    let far = sqrt(dot(way, way));
    var along = far * (bound_direction + bound_place());
    if ELLIPSOIDS {
        along = far / sqrt(at.a) * bound_slope;
    }
    let world = bound_base + along + center_error(body);
    let rounding = bound_place() * far + bound_local() * radius;
    let stretched = stretch_of(body) * world + rounding;
    let reach = real(2.0) * (gradient * world + radius * rounding + stretched * stretched);
    let rest = at.discriminant - reach;
    is_unsure |= hit.found & !(rest > real(0.0));
    // w/|N.d| with N.d = sqrt(a discriminant)/|g|, of the least discriminant.
    var slant = real(1.0) / sqrt(rest);
    if ELLIPSOIDS {
        slant *= sqrt(ray.a / at.a);
    }
    // How far the closest approach, and so the hit, is off along the ray is seen from the former: it is at right angles to the ray.
    let shifted = greatest * (abs(dot(at.perpendicular, at.direction)) * inv_length + ROUNDOFF * (LENGTH + ANGLE) * radius);
    let aside = slant * (real(0.5) * reach);
    // Along the ray a normal of a sphere turns by no more than where the ray is aslant.
    let aslant = select(sqrt(max(real(1.0) - at.discriminant / (radius * radius), real(0.0))), real(1.0), ELLIPSOIDS);
    bound_normal = normal_error(body, local, gradient, aside + aslant * shifted, world + shifted) + ROUNDOFF * ANGLE;
    let place = ROUNDOFF * ANGLE * (size_of(center) + greatest * radius);
    bound_position = aside + shifted + place + params.moved;
}

// Error of the unit normal where the place is off by `along` along the surface and by `off` from it, in world units.
fn normal_error(body: Body, local: vec3r, gradient: real, along: real, off: real) -> real {
    if !ELLIPSOIDS {
        return along / body.shape.center_radius.w;
    }
    let d = body.shape.inv_scale * body.shape.inv_scale;
    let normal = local * body.shape.inv_scale * (real(1.0) / gradient);
    let n = normal * normal;
    let trace = d.x * (n.y + n.z) + d.y * (n.z + n.x) + d.z * (n.x + n.y);
    let determinant = n.x * d.y * d.z + n.y * d.z * d.x + n.z * d.x * d.y;
    let root = sqrt(max(trace * trace - real(4.0) * determinant, real(0.0)));
    let sideways = real(0.5) * (trace + root) * along;
    let across = d * normal;
    let turn = across - normal * dot(normal, across);
    let curved = real(0.5) * largest(d) * (sideways / gradient) * along;
    let error = (sideways + curved + sqrt(dot(turn, turn)) * off) / gradient;
    // An error half as long as the gradient can turn it anywhere.
    return select(real(2.0), error / (real(1.0) - error), error < real(0.5));
}

// Adds a term of this size to the colour, with its error.
fn add_bound(size: real, error: real, counts: bool) {
    let weight = abs(bound_weight);
    let sizes = max(bound_sizes, real(0.0)) + size * weight;
    bound_sizes = select(bound_sizes, sizes, counts);
    bound_color += select(real(0.0), error * weight + ROUNDOFF * (TERM * (size * weight) + sizes), counts);
}

// The colour's first product of constants, or one more.
fn note_ambient(material: Material, is_seen: bool) {
    let is_first = bound_weight == real(1.0) && bound_sizes == real(-1.0) - params.background_levels;
    let size = select(real(0.0), largest(abs(params.ambient * material.color)) * abs(material.ka), AMBIENT);
    add_bound(size, real(0.0), is_seen & !is_first);
    bound_sizes = select(bound_sizes, real(-1.0) - material.ambient_levels, is_seen & is_first);
}

// The background behind glass.
fn note_background() {
    add_bound(largest(abs(params.background)), real(0.0), true);
}

// Error of the direction to the light in hand.
fn light_error(surface: Surface, at: Incidence) -> real {
    let place = ROUNDOFF * ANGLE * (size_of(at.light.position) + size_of(surface.position)) + params.moved;
    return (bound_position + place) * at.inv_distance + ROUNDOFF * ANGLE;
}

// A light in hand, before anything comes of it: whether the surface faces it. cos changes by no more than the angle and its square, and
// with the lengths of both unit vectors.
fn note_light(surface: Surface, at: Incidence, material: Material, is_seen: bool) {
    let angle = bound_normal + light_error(surface, at);
    let error = angle + angle * angle + ROUNDOFF * (real(2.0) * LENGTH + ANGLE) * abs(at.n_dot_l);
    let shows = (material.kd != real(0.0)) | (material.ks != real(0.0));
    // NaN is in doubt.
    is_unsure |= is_seen & shows & (!(angle < LOST) | !(abs(at.n_dot_l) > error));
}

// The light's terms.
fn note_lit(surface: Surface, at: Incidence, material: Material, is_lit: bool) {
    let direction = light_error(surface, at);
    var size = real(0.0);
    var error = real(0.0);
    if DIFFUSE {
        size = largest(abs(at.light.intensity * material.color)) * abs(material.kd);
        let angle = bound_normal + direction;
        // cos changes by sin da + da^2/2, and with the lengths of both unit vectors.
        let sine = sqrt(max(real(1.0) - at.n_dot_l * at.n_dot_l, real(0.0)));
        error = size * (sine * angle + angle * angle + ROUNDOFF * (real(2.0) * LENGTH + ANGLE) * abs(at.n_dot_l));
    }
    if SPECULAR {
        var angle = real(2.0) * bound_normal + direction + bound_direction + ROUNDOFF * (real(4.0) * LENGTH + ANGLE);
        if BLINN {
            // The sum of two unit vectors turns by what they turn and by what is wrong in their lengths, over its own.
            let sum = at.to_light + surface.view;
            let parts = direction + bound_direction + ROUNDOFF * (real(2.0) * LENGTH + ANGLE);
            angle = bound_normal + parts / sqrt(dot(sum, sum)) + ROUNDOFF * (real(2.0) * LENGTH + ANGLE);
        }
        let intensity = largest(abs(at.light.intensity));
        let d = specular_distance(surface, at.to_light, at.n_dot_l);
        let specular = intensity * abs(material.ks);
        let power = specular_power(d, material.n);
        size += specular * power;
        error += specular * power_error(d, material.n, angle, power);
    }
    add_bound(size, error, is_lit);
}

// Error of this power, cos^n, where 1 - cos is d and the angle is off by `angle`.
//
// The chord of the angle is sqrt(2d) and moves by no more than it does. The logarithm of the power moves by no more than
// x = n Dd/(1 - d - Dd), and the power by the factor e^x, which is at most 1 + x + x^2 for x <= 1.
fn power_error(d: real, n: real, angle: real, power: real) -> real {
    let change = sqrt(d + d) * angle + real(0.5) * angle * angle;
    let least = real(1.0) - d - change;
    let greatest = real(1.0) - d + change;
    let exponent = n * log1m(d);
    let x = n * change / least + ROUNDOFF * POWER * (real(1.0) - exponent);
    let all = select(real(1.0), exponential(NOTHING), exponent + x < NOTHING);
    // A power of at least 1 is no greater than its base.
    let last = select(real(1.0), min(greatest, real(1.0)), n >= real(1.0));
    let error = select(last, select(all, power * (x + x * x), x <= real(1.0)), least > real(0.0));
    return select(error, real(0.0), (greatest <= real(0.0)) | (n <= real(0.0)));
}

// The mirrored ray is about to be followed.
fn note_reflected(throughput: real) {
    bound_direction += real(2.0) * (bound_normal + ROUNDOFF * (LENGTH + ANGLE));
    bound_weight = throughput;
}

// Whether all colours as near to this one as it is known have the same levels, with LINEAR also those of 16 bits; OTHERS is the unit
// roundoff of the reference, as a part of this one's. A product of constants is the reference's own where the kernel has `f64`, as it
// has with LINEAR; else the host knows its levels.
fn has_sure_levels(color: vec3r) -> bool {
    let error = (bound_color + ROUNDOFF * TERM * largest(abs(color))) * (real(1.0) + OTHERS) + ROUNDOFF * real(4.0);
    let low = levels(color - error);
    var is_sure = (low == levels(color + error)) & (low < 0x1000000u);
    if LINEAR {
        is_sure &= all(deep_levels(color - error) == deep_levels(color + error));
    }
    return (bound_sizes < real(0.0)) | is_sure;
}

// The levels of a colour that is a product of constants; else those that it has.
fn bound_levels(pixel: u32) -> u32 {
    return select(pixel, u32(real(-1.0) - bound_sizes), bound_sizes < real(0.0));
}

// What a kept path has to know.
fn kept_bound() -> vec4r {
    return vec4r(bound_position, bound_direction, bound_color, bound_sizes);
}

fn go_on_with_bound(kept: vec4r, throughput: real) {
    bound_position = kept.x;
    bound_direction = kept.y;
    bound_color = kept.z;
    bound_sizes = kept.w;
    bound_weight = throughput;
}
