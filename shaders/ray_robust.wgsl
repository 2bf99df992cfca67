// Rays whose places and directions carry what rounding took from them.
// needs: effects, eft, real, scene, types

// A place in the world.
alias Point = Pair3;

// Whether a place carries what rounding took.
const CARRIES_LOW: bool = true;

fn high_of(place: Point) -> vec3r {
    return place.hi;
}

fn low_of(place: Point) -> vec3r {
    return place.lo;
}

fn point_from(high: vec3r, low: vec3r) -> Point {
    return Point(high, low);
}

// origin + t direction; the direction need not be normalised.
struct Ray {
    origin: Point,
    direction: Pair3,
    // direction . direction, of the high parts.
    a: real,
}

fn ray_with(origin: Point, direction: Pair3) -> Ray {
    return Ray(origin, direction, dot(direction.hi, direction.hi));
}

fn ray_from(origin: Point, direction: vec3r) -> Ray {
    return ray_with(origin, Pair3(direction, vec3r()));
}

fn primary_ray(pixel: vec2<u32>) -> Ray {
    let column = pixel.x;
    let row = params.window_rows + pixel.y;
    let low = params.window_low;
    let sum = two_sum3(window_at(column), window_at(row));
    // Where the sum cancels, the low parts may be the greater.
    let place = two_sum3(sum.hi, sum.lo + (window_at(low + column) + window_at(low + row)));
    if PARALLEL {
        return ray_with(place, Pair3(window_at(low - 1u), window_at(low + low - 1u)));
    }
    return ray_with(Point(vec3r(), vec3r()), place);
}

// From a point to the light with this index, which lies at t = 1.
fn ray_to_light(origin: Point, light: Light, index: u32) -> Ray {
    return ray_with(origin, pair_difference3(Pair3(light.position, low_light_of(index).position), origin));
}

fn direction_of(ray: Ray) -> vec3r {
    return ray.direction.hi;
}

// A place seen from a corner of the world, in f32.
fn offset_from(place: Point, corner: vec3<f32>) -> vec3<f32> {
    return (place.hi - corner) + place.lo;
}

// From the origin, the ray's direction times the ratio, plus the offset; a ratio of 1 keeps the low part too.
fn bent_ray(ray: Ray, origin: Point, ratio: real, offset: vec3r) -> Ray {
    return ray_with(origin, Pair3(ray.direction.hi * ratio + offset, ray.direction.lo * ratio));
}
