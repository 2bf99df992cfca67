// The cones of refraction rays that wait; read it beside src/cpu/bound.rs.
// needs: bound, counters, real, refract, shade
// host: ANGLE, LENGTH, MAX_WAITING, ROUNDOFF

// Error of the origin, error of the direction, weight.
var<private> waiting_cones: array<vec3r, MAX_WAITING>;

// A refraction ray of this weight is put aside.
fn keep_cone(index: u32, surface: Surface, weight: real) {
    let snell = snell_at(surface);
    let ratio = snell.ratio;
    let cosine = max(dot(surface.normal, surface.view), real(0.0));
    let sine_squared = max(real(1.0) - cosine * cosine, real(0.0));
    // The angle between ray and normal is off by so much, its cosine by sin da + da^2/2.
    let angle = bound_direction + bound_normal + ROUNDOFF * ANGLE;
    let lengths = ROUNDOFF * (real(2.0) * LENGTH + ANGLE);
    let cosine_error = sqrt(sine_squared) * angle + angle * angle + lengths * cosine;
    let ratio_error = select(ROUNDOFF * real(4.0) * ratio, real(0.0), ratio == real(1.0));
    // k = 1 - r^2(1 - c^2).
    let along = ratio * cosine;
    let square_error = real(2.0) * ratio * ratio * cosine * cosine_error
        + ratio * ratio * cosine_error * cosine_error
        + real(2.0) * ratio * sine_squared * ratio_error
        + ROUNDOFF * real(2.0) * ANGLE * max(along * along, abs(ratio * ratio - real(1.0)));
    is_unsure |= !(abs(snell.square) > square_error);
    let mirrored = bound_direction + real(2.0) * (bound_normal + ROUNDOFF * (LENGTH + ANGLE));
    // The derivatives of the bend r c - sqrt(k) by c and by r, of the least k.
    let root = sqrt(max(snell.square - square_error, real(1e-30)));
    let bend = abs(snell.bend);
    let bent = ratio * bound_direction
        + bend * bound_normal
        + ratio * (bend / root) * cosine_error
        + (real(2.0) + ratio * sine_squared / root) * ratio_error
        + lengths * (bend + ratio);
    waiting_cones[index] = vec3r(bound_position, select(mirrored, bent, snell.square > real(0.0)), weight);
}

// That ray is followed.
fn go_on_with_cone(index: u32) {
    let cone = waiting_cones[index];
    bound_position = cone.x;
    bound_direction = cone.y;
    bound_weight = cone.z;
}
