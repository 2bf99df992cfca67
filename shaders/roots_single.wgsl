// The last steps of the quadratic, rounded in each.
// needs: distance, eft

fn square_root(x: Pair) -> Pair {
    return Pair(sqrt(x.hi), 0.0);
}

fn pair_sum(a: Pair, b: Pair) -> Pair {
    return Pair(a.hi + (b.hi + (a.lo + b.lo)), 0.0);
}

fn quotient(a: Pair, b: Pair) -> Distance {
    return a.hi / b.hi;
}
