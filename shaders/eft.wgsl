// Error-free transforms in f32. Compilers may rewrite (a + b) - a to b, factor sums of products and fuse a product into a sum,
// so results that such a rule could reach pass through barrier(), which costs one instruction; parts cut off by
// a mask are out of reach as they are. A self-test on the device decides whether it all holds (src/gpu/run/selftest.rs).
// needs: barrier

// hi + lo, lo some units in the last place of hi at most.
struct Pair {
    hi: f32,
    lo: f32,
}

struct Pair3 {
    hi: vec3<f32>,
    lo: vec3<f32>,
}

// a + b without error (Knuth, The Art of Computer Programming, volume 2, 4.2.2, theorem B).
fn two_sum(a: f32, b: f32) -> Pair {
    let sum = barrier(a + b);
    let b_part = barrier(sum - a);
    return Pair(sum, (a - (sum - b_part)) + (b - b_part));
}

fn two_sum3(a: vec3<f32>, b: vec3<f32>) -> Pair3 {
    let sum = barrier3(a + b);
    let b_part = barrier3(sum - a);
    return Pair3(sum, (a - (sum - b_part)) + (b - b_part));
}

// a + b without error where |a| >= |b| (Dekker, "A floating-point technique for extending the available precision", 1971).
fn fast_two_sum(a: f32, b: f32) -> Pair {
    let sum = barrier(a + b);
    return Pair(sum, b - (sum - a));
}

fn fast_two_sum3(a: vec3<f32>, b: vec3<f32>) -> Pair3 {
    let sum = barrier3(a + b);
    return Pair3(sum, b - (sum - a));
}

// The upper 12 bits of x's significand; the rest has 12 more.
fn upper_half(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0xfffff000u);
}

fn upper_half3(x: vec3<f32>) -> vec3<f32> {
    return bitcast<vec3<f32>>(bitcast<vec3<u32>>(x) & vec3<u32>(0xfffff000u));
}

// a b without error, but for underflow (Dekker 1971, with the split by mask).
fn two_product(a: f32, b: f32) -> Pair {
    let product = barrier(a * b);
    let a_hi = upper_half(a);
    let b_hi = upper_half(b);
    let a_lo = a - a_hi;
    let b_lo = b - b_hi;
    return Pair(product, (((a_hi * b_hi - product) + a_hi * b_lo) + a_lo * b_hi) + a_lo * b_lo);
}

fn two_product3(a: vec3<f32>, b: vec3<f32>) -> Pair3 {
    let product = barrier3(a * b);
    let a_hi = upper_half3(a);
    let b_hi = upper_half3(b);
    let a_lo = a - a_hi;
    let b_lo = b - b_hi;
    return Pair3(product, (((a_hi * b_hi - product) + a_hi * b_lo) + a_lo * b_hi) + a_lo * b_lo);
}

// Pairs: about 46 bits where the parts do not cancel.

fn pair_difference3(a: Pair3, b: Pair3) -> Pair3 {
    let sum = two_sum3(a.hi, -b.hi);
    return fast_two_sum3(sum.hi, sum.lo + (a.lo - b.lo));
}

fn pair_sum3(a: Pair3, b: Pair3) -> Pair3 {
    let sum = two_sum3(a.hi, b.hi);
    return fast_two_sum3(sum.hi, sum.lo + (a.lo + b.lo));
}

fn pair_product3(a: Pair3, b: Pair3) -> Pair3 {
    let product = two_product3(a.hi, b.hi);
    return Pair3(product.hi, product.lo + (a.hi * b.lo + a.lo * b.hi));
}

fn pair_difference(a: Pair, b: Pair) -> Pair {
    let sum = two_sum(a.hi, -b.hi);
    return fast_two_sum(sum.hi, sum.lo + (a.lo - b.lo));
}

fn pair_product(a: Pair, b: Pair) -> Pair {
    let product = two_product(a.hi, b.hi);
    return Pair(product.hi, product.lo + (a.hi * b.lo + a.lo * b.hi));
}

fn pair_scaled3(a: Pair3, factor: Pair) -> Pair3 {
    return pair_product3(a, Pair3(vec3<f32>(factor.hi), vec3<f32>(factor.lo)));
}

// One step of Newton's method after the rounded root.
fn pair_square_root(x: Pair) -> Pair {
    let root = sqrt(x.hi);
    let square = two_product(root, root);
    let low = ((x.hi - square.hi) - square.lo + x.lo) / (root + root);
    return Pair(root, select(low, 0.0, root == 0.0));
}

// Likewise after the rounded quotient.
fn pair_quotient(a: Pair, b: Pair) -> Pair {
    let high = a.hi / b.hi;
    let product = two_product(high, b.hi);
    let low = ((a.hi - product.hi) - product.lo + (a.lo - high * b.lo)) / b.hi;
    return fast_two_sum(high, low);
}

fn pair_quotient3(a: Pair3, b: Pair) -> Pair3 {
    let high = a.hi / b.hi;
    let product = two_product3(high, vec3<f32>(b.hi));
    let low = ((a.hi - product.hi) - product.lo + (a.lo - high * b.lo)) / b.hi;
    return fast_two_sum3(high, low);
}

// a . b as if in twice the precision (Ogita, Rump, Oishi, "Accurate sum and dot product", 2005, algorithm Dot2).
fn pair_dot(a: Pair3, b: Pair3) -> Pair {
    let products = two_product3(a.hi, b.hi);
    let xy = two_sum(products.hi.x, products.hi.y);
    let xyz = two_sum(xy.hi, products.hi.z);
    let low = (products.lo.x + products.lo.y + products.lo.z) + (dot(a.hi, b.lo) + dot(a.lo, b.hi));
    return fast_two_sum(xyz.hi, (xy.lo + xyz.lo) + low);
}

// a x b likewise.
fn pair_cross(a: Pair3, b: Pair3) -> Pair3 {
    let left = two_product3(a.hi.yzx, b.hi.zxy);
    let right = two_product3(a.hi.zxy, b.hi.yzx);
    let high = two_sum3(left.hi, -right.hi);
    let mixed = (a.hi.yzx * b.lo.zxy - a.hi.zxy * b.lo.yzx) + (a.lo.yzx * b.hi.zxy - a.lo.zxy * b.hi.yzx);
    return fast_two_sum3(high.hi, high.lo + ((left.lo - right.lo) + mixed));
}
