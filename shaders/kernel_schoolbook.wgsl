// Ray against sphere by the schoolbook: the discriminant as B^2 - A C, the roots as (-B -+ root)/A. The baseline of studies and
// of `trueray stress`; no picture is made with it. The same functions as kernel_plain.wgsl.

// A place in the world.
alias Point = vec3r;

// origin + t direction; the direction need not be normalised.
struct Ray {
    origin: Point,
    direction: vec3r,
    // direction . direction, and one over it.
    a: real,
    inv_a: real,
}

fn ray_from(origin: Point, direction: vec3r) -> Ray {
    let a = dot(direction, direction);
    return Ray(origin, direction, a, real(1.0) / a);
}

fn primary_ray(pixel: vec2<u32>) -> Ray {
    return ray_from(vec3r(), vec3r(columns[pixel.x], rows[pixel.y], -params.near));
}

// From a point to a light, which lies at t = 1.
fn ray_to_light(origin: Point, light: u32) -> Ray {
    return ray_from(origin, lights[light].position - origin);
}

fn direction_of(ray: Ray) -> vec3r {
    return ray.direction;
}

// The quadratic in the sphere's object space.
struct Approach {
    origin: vec3r,
    direction: vec3r,
    a: real,
    b: real,
    discriminant: real,
}

fn approach(ray: Ray, sphere: u32) -> Approach {
    let shape = shapes[sphere];
    let origin = (ray.origin - shape.center) * shape.inv_scale;
    let direction = ray.direction * shape.inv_scale;
    let a = dot(direction, direction);
    let b = dot(origin, direction);
    let c = dot(origin, origin) - shape.radius * shape.radius;
    return Approach(origin, direction, a, b, b * b - a * c);
}

// Both intersections of the line.
struct Roots {
    exist: bool,
    lesser: Distance,
    greater: Distance,
}

fn roots(ray: Ray, sphere: u32) -> Roots {
    let at = approach(ray, sphere);
    let root = sqrt(at.discriminant);
    return Roots(at.discriminant >= real(0.0), (-at.b - root) / at.a, (-at.b + root) / at.a);
}

// Whether a root lies beyond t_min and before t = 1.
fn root_between(ray: Ray, sphere: u32, t_min: real) -> bool {
    let at = roots(ray, sphere);
    let lesser = at.lesser > t_min && at.lesser < real(1.0);
    let greater = at.lesser <= t_min && at.greater > t_min && at.greater < real(1.0);
    return at.exist && (lesser || greater);
}

// The hit in object space.
fn local_hit(ray: Ray, hit: Hit) -> vec3r {
    let at = approach(ray, hit.sphere);
    return at.origin + at.direction * hit.t;
}

// The place of a point of the sphere's surface, given in object space.
fn place_of(sphere: u32, local: vec3r) -> Point {
    if ELLIPSOIDS {
        return shapes[sphere].center + local * materials[sphere].scale;
    }
    return shapes[sphere].center + local;
}
