// Rays whose places are plain vectors.
// needs: effects, real, scene, types

// A place in the world.
alias Point = vec3r;

// Whether a place carries what rounding took.
const CARRIES_LOW: bool = false;

fn high_of(place: Point) -> vec3r {
    return place;
}

fn low_of(place: Point) -> vec3r {
    return vec3r();
}

fn point_from(high: vec3r, low: vec3r) -> Point {
    return high;
}

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
    let sum = window_at(pixel.x) + window_at(params.window_rows + pixel.y);
    if PARALLEL {
        return ray_from(sum, window_at(params.window_low - 1u));
    }
    return ray_from(vec3r(), sum);
}

// From a point to the light with this index, which lies at t = 1.
fn ray_to_light(origin: Point, light: Light, index: u32) -> Ray {
    return ray_from(origin, light.position - origin);
}

fn direction_of(ray: Ray) -> vec3r {
    return ray.direction;
}

// A place seen from a corner of the world, in f32.
fn offset_from(place: Point, corner: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(place - vec3r(corner));
}

// From the origin, the ray's direction times the ratio, plus the offset.
fn bent_ray(ray: Ray, origin: Point, ratio: real, offset: vec3r) -> Ray {
    return ray_from(origin, ray.direction * ratio + offset);
}
