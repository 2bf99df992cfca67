// How far along a ray: one number.
// needs: real

alias Distance = real;

fn distance_of(t: real) -> Distance {
    return t;
}

// The second where `is_second`, else the first.
fn either(first: Distance, second: Distance, is_second: bool) -> Distance {
    return select(first, second, is_second);
}

fn nearest_real(t: Distance) -> real {
    return t;
}

fn is_nearer(a: Distance, b: Distance) -> bool {
    return a < b;
}

fn is_beyond(t: Distance, t_min: real) -> bool {
    return t > t_min;
}
