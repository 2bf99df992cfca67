// How far along a ray: a pair, for the kernel that stands in for f64.
// needs: eft, real

alias Distance = Pair;

fn distance_of(t: real) -> Distance {
    return Pair(t, 0.0);
}

// The second where `is_second`, else the first.
fn either(first: Distance, second: Distance, is_second: bool) -> Distance {
    return Distance(select(first.hi, second.hi, is_second), select(first.lo, second.lo, is_second));
}

fn nearest_real(t: Distance) -> real {
    return t.hi + t.lo;
}

fn is_nearer(a: Distance, b: Distance) -> bool {
    return (a.hi < b.hi) | ((a.hi == b.hi) & (a.lo < b.lo));
}

fn is_beyond(t: Distance, t_min: real) -> bool {
    return (t.hi > t_min) | ((t.hi == t_min) & (t.lo > 0.0));
}
