// Ray against sphere by the schoolbook: the discriminant as B^2 - A C, the roots as (-B -+ root)/A. The baseline of studies and
// of `trueray stress`; no picture is made with it. The same functions as kernel_plain.wgsl.
// needs: body, distance, intersect, ray, real

// The quadratic in the sphere's object space.
struct Approach {
    origin: vec3r,
    direction: vec3r,
    a: real,
    b: real,
    discriminant: real,
}

fn approach(ray: Ray, body: Body) -> Approach {
    let shape = body.shape;
    let origin = (ray.origin - shape.center_radius.xyz) * shape.inv_scale;
    let direction = ray.direction * shape.inv_scale;
    let a = dot(direction, direction);
    let b = dot(origin, direction);
    let c = dot(origin, origin) - shape.center_radius.w * shape.center_radius.w;
    return Approach(origin, direction, a, b, b * b - a * c);
}

// Both intersections of the line.
struct Roots {
    exist: bool,
    lesser: Distance,
    greater: Distance,
}

fn roots(ray: Ray, body: Body) -> Roots {
    let at = approach(ray, body);
    let root = sqrt(at.discriminant);
    return Roots(at.discriminant >= real(0.0), (-at.b - root) / at.a, (-at.b + root) / at.a);
}

// Whether a root lies beyond t_min and before t = 1.
fn root_between(ray: Ray, body: Body, t_min: real) -> bool {
    let at = roots(ray, body);
    let lesser = at.lesser > t_min && at.lesser < real(1.0);
    let greater = at.lesser <= t_min && at.greater > t_min && at.greater < real(1.0);
    return at.exist && (lesser || greater);
}

// The hit in object space.
fn local_hit(ray: Ray, body: Body, hit: Hit) -> vec3r {
    let at = approach(ray, body);
    return at.origin + at.direction * hit.t;
}

// Nobody asks the schoolbook.
fn may_touch(ray: Ray, body: Body) -> bool {
    return false;
}
