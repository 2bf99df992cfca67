// The last steps of the quadratic, in pairs.
// needs: distance, eft

fn square_root(x: Pair) -> Pair {
    return pair_square_root(x);
}

fn pair_sum(a: Pair, b: Pair) -> Pair {
    let sum = two_sum(a.hi, b.hi);
    return fast_two_sum(sum.hi, sum.lo + (a.lo + b.lo));
}

fn quotient(a: Pair, b: Pair) -> Distance {
    return pair_quotient(a, b);
}
