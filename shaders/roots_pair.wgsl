// The last steps of the quadratic, in pairs: one step of Newton's method after the rounded one.

fn square_root(x: Pair) -> Pair {
    let root = sqrt(x.hi);
    let square = two_product(root, root);
    let low = ((x.hi - square.hi) - square.lo + x.lo) / (root + root);
    return Pair(root, select(low, 0.0, root == 0.0));
}

fn pair_sum(a: Pair, b: Pair) -> Pair {
    let sum = two_sum(a.hi, b.hi);
    return fast_two_sum(sum.hi, sum.lo + (a.lo + b.lo));
}

fn quotient(a: Pair, b: Pair) -> Distance {
    let high = a.hi / b.hi;
    let product = two_product(high, b.hi);
    let low = ((a.hi - product.hi) - product.lo + (a.lo - high * b.lo)) / b.hi;
    return fast_two_sum(high, low);
}
