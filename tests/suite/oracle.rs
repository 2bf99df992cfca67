//! Double-double arithmetic and the intersections computed in it, against exact rational arithmetic.

use std::cmp::Ordering;

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use dashu_ratio::{RBig, Relaxed};
use glam::DVec3;
use trueray::cpu::{Dd, Real, oracle};

/// u² with u = 2⁻⁵³, the unit of double-double errors.
const U2: f64 = 1.0 / (1_u128 << 106) as f64;

/// `SplitMix64`: the tests see the same numbers everywhere.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn coin(&mut self) -> bool {
        self.bits() & 1 == 0
    }

    fn sign(&mut self) -> f64 {
        if self.coin() { 1.0 } else { -1.0 }
    }

    /// 10 to a power between `low` and `high`.
    fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.within(low, high))
    }

    /// ±10 to a power up to `decades` either way, with every bit of the mantissa random.
    fn number(&mut self, decades: f64) -> f64 {
        self.sign() * self.magnitude(-decades, decades)
    }

    /// A double-double number whose low part is zero, small, or at its limit of half a unit of the high part.
    fn pair(&mut self, decades: f64) -> Dd {
        let hi = self.number(decades);
        self.tail(hi)
    }

    /// `hi` with a random low part.
    fn tail(&mut self, hi: f64) -> Dd {
        let half_unit = (hi.abs().next_up() - hi.abs()) / 2.0;
        let lo = match self.bits() % 8 {
            0 => 0.0,
            1 => half_unit.next_down(),
            2 => half_unit * self.magnitude(-30.0, 0.0),
            _ => half_unit * self.within(0.0, 1.0),
        };
        Dd::from_sum(hi, self.sign() * lo)
    }

    /// A number that nearly cancels `x`: negated, shifted by no or a few units, with another low part.
    fn nearly_minus(&mut self, x: Dd) -> Dd {
        let shift = (0..self.bits() % 3).fold(-x.hi(), |hi, _| if self.coin() { hi.next_up() } else { hi.next_down() });
        match self.bits() % 4 {
            0 => Dd::from_sum(shift, -x.lo()),
            1 => Dd::from_sum(shift, -x.lo() * (1.0 + self.number(16.0).min(1.0))),
            _ => self.tail(shift),
        }
    }

    fn vector(&mut self, mut component: impl FnMut(&mut Self) -> f64) -> DVec3 {
        DVec3::new(component(self), component(self), component(self))
    }

    fn unit(&mut self) -> DVec3 {
        loop {
            let v = self.vector(|random| random.within(-1.0, 1.0));
            if v.length() > 0.1 && v.length() < 1.0 {
                return v.normalize();
            }
        }
    }
}

fn exact(x: f64) -> Relaxed {
    Relaxed::try_from(x).unwrap()
}

fn exact_pair(x: Dd) -> Relaxed {
    exact(x.hi()) + exact(x.lo())
}

fn magnitude(x: Relaxed) -> Relaxed {
    if x < Relaxed::ZERO { -x } else { x }
}

/// |error|/|truth|, 0 where there is no error.
fn relative(error: Relaxed, truth: Relaxed) -> f64 {
    if error == Relaxed::ZERO { 0.0 } else { magnitude(error / truth).to_f64_fast() }
}

/// Relative error of `x` in units of u².
fn error(x: Dd, truth: &Relaxed) -> f64 {
    assert_eq!(x.hi() + x.lo(), x.hi(), "{x:?} is not normalised");
    relative(exact_pair(x) - truth.clone(), truth.clone()) / U2
}

/// The greatest of `count` errors must not exceed `bound`.
fn at_most(what: &str, bound: f64, count: usize, mut error: impl FnMut() -> f64) {
    let worst = (0..count).map(|_| error()).fold(0.0, f64::max);
    println!("{what}: {worst:.3} of {bound}");
    assert!(worst <= bound, "{what}: error {worst} exceeds {bound}");
}

#[test]
fn sums_and_products_of_two_are_exact() {
    let mut random = Random(1);
    for _ in 0..3000 {
        let (a, b) = (random.number(140.0), random.number(140.0));
        let b = if random.coin() { b } else { -a * random.within(0.5, 2.0) };
        assert_eq!(exact_pair(Dd::from_sum(a, b)), exact(a) + exact(b));
        assert_eq!(exact_pair(Dd::from_product(a, b)), exact(a) * exact(b));
        let (large, small) = (random.magnitude(299.0, 306.0), random.magnitude(-306.0, -299.0));
        assert_eq!(exact_pair(Dd::from_product(large, small)), exact(large) * exact(small));
    }
}

#[test]
fn operations_keep_their_bounds() {
    let mut random = Random(2);
    at_most("+", 3.0 + 1e-12, 20_000, || {
        let x = random.pair(150.0);
        let y = match random.bits() % 3 {
            0 => random.pair(150.0),
            1 => random.nearly_minus(x),
            _ => {
                let hi = x.hi() * random.number(17.0);
                random.tail(hi)
            }
        };
        error(x + y, &(exact_pair(x) + exact_pair(y))).max(error(x - y, &(exact_pair(x) - exact_pair(y))))
    });
    for decades in [1.0, 140.0] {
        at_most("×", 5.0, 10_000, || {
            let (x, y) = (random.pair(decades), random.pair(decades));
            error(x * y, &(exact_pair(x) * exact_pair(y)))
        });
        at_most("÷", 15.0 + 1e-12, 10_000, || {
            let (x, y) = (random.pair(decades), random.pair(decades));
            error(x / y, &(exact_pair(x) / exact_pair(y)))
        });
        // r² − x = 2e·x for a relative error e of r, but for e².
        at_most("√", 25.0 / 8.0, 10_000, || {
            let x = random.pair(decades).abs();
            let root = exact_pair(x.sqrt());
            relative(root.clone() * root - exact_pair(x), exact_pair(x)) / U2 / 2.0
        });
    }
}

#[test]
fn squares_have_their_roots() {
    for n in 1..1000_u32 {
        let n = Dd::from(f64::from(n).sqrt());
        assert_eq!((n * n).sqrt(), n);
        assert_eq!(n * n / n, n);
    }
}

#[test]
fn large_and_small_operands() {
    let mut random = Random(3);
    at_most("1e150 × 1e150 and / 1e-150", 15.0 + 1e-12, 1000, || {
        let (x, y) = (random.pair(1.0) * Dd::from(1e150), random.pair(1.0) * Dd::from(1e150));
        let small = random.pair(1.0) * Dd::from(1e-150);
        let product = error(x * y, &(exact_pair(x) * exact_pair(y)));
        product.max(error(x / small, &(exact_pair(x) / exact_pair(small))))
    });
    // At 1e-300 a low part has some 60 bits fewer.
    let tiny = Dd::from(1.0 / 3.0) * Dd::from(1e-150) * (Dd::from(1.0 / 7.0) * Dd::from(1e-150));
    let truth = exact(1.0 / 3.0) * exact(1.0 / 7.0) * exact(1e-150) * exact(1e-150);
    assert!(error(tiny, &truth) * U2 < 1e-20);
}

#[test]
fn orders_exactly() {
    let mut random = Random(4);
    for _ in 0..3000 {
        let x = random.pair(100.0);
        let y = if random.coin() { -random.nearly_minus(x) } else { random.pair(100.0) };
        assert_eq!(x.partial_cmp(&y), Some(exact_pair(x).cmp(&exact_pair(y))), "{x:?} {y:?}");
        assert_eq!(x == y, exact_pair(x) == exact_pair(y));
        assert_eq!(exact_pair(x.abs()), magnitude(exact_pair(x)));
        assert_eq!((x + -x, x - x), (Dd::ZERO, Dd::ZERO));
    }
    assert_eq!(Dd::from_sum(1.0, 1e-30).partial_cmp(&Dd::ONE), Some(Ordering::Greater));
    assert_eq!(Dd::from(f64::NAN).partial_cmp(&Dd::ONE), None);
}

#[test]
fn special_values() {
    let special = [0.0, -0.0, 1.0, -1.0, 1e308, -1e308, f64::MAX, f64::MIN_POSITIVE, 5e-324, f64::INFINITY, f64::NAN];
    let agrees = |x: Dd, expected: f64, what: &str| {
        let same = x.hi() == expected || (x.hi().is_nan() && expected.is_nan());
        assert!(same && x.lo().is_finite(), "{what}: {x:?} instead of {expected}");
        assert_eq!(x.is_finite(), expected.is_finite());
    };
    for a in special {
        let x = Dd::from(a);
        agrees(-x, -a, "-");
        agrees(x.abs(), a.abs(), "abs");
        agrees(x.sqrt(), a.sqrt(), "sqrt");
        for b in special {
            let y = Dd::from(b);
            agrees(x + y, a + b, &format!("{a} + {b}"));
            agrees(x - y, a - b, &format!("{a} - {b}"));
            agrees(x * y, a * b, &format!("{a} * {b}"));
            agrees(x / y, a / b, &format!("{a} / {b}"));
        }
    }
    for (x, exp, log1p) in [
        (0.0, 1.0, 0.0),
        (-1.0, (-1.0_f64).exp(), f64::NEG_INFINITY),
        (-1.5, (-1.5_f64).exp(), f64::NAN),
        (1e5, f64::INFINITY, 1e5_f64.ln_1p()),
        (-1e5, 0.0, f64::NAN),
        (f64::INFINITY, f64::INFINITY, f64::INFINITY),
        (f64::NEG_INFINITY, 0.0, f64::NAN),
        (f64::NAN, f64::NAN, f64::NAN),
    ] {
        agrees(Dd::from(x).exp(), exp, "exp");
        agrees(Dd::from(x).log1p(), log1p, "log1p");
    }
}

#[test]
fn constants() {
    assert_eq!((Dd::ZERO, Dd::ONE, Dd::FAR), (Dd::from(0.0), Dd::from(1.0), Dd::from(3e38)));
    let third = Dd::from_f64(1.0) / Dd::from_f64(3.0);
    assert_eq!((third.to_f64(), third.hi()), (1.0 / 3.0, 1.0 / 3.0));
    let mut x = third;
    x += third;
    x *= Dd::from(3.0);
    assert_eq!(x, Dd::from(2.0));
}

type Big = FBig<HalfEven>;

/// With 500 bits.
fn big(x: Dd) -> Big {
    let part = |x: f64| Big::try_from(x).unwrap().with_precision(500).value();
    part(x.hi()) + part(x.lo())
}

fn big_error(x: Dd, truth: Big) -> f64 {
    error(x, &RBig::try_from(truth).unwrap().relax())
}

#[test]
fn exponential_and_logarithm() {
    let mut random = Random(5);
    at_most("exp of up to ±600", 2e-31 / U2, 600, || {
        let x = random.pair(4.0);
        let x = if x.abs() > Dd::from(600.0) { x / Dd::from(20.0) } else { x };
        big_error(x.exp(), big(x).exp())
    });
    at_most("log1p near 0", 2e-31 / U2, 400, || {
        let hi = random.sign() * random.magnitude(-100.0, -0.1);
        let x = random.tail(hi);
        big_error(x.log1p(), big(x).ln_1p())
    });
    at_most("log1p near -1", 2e-31 / U2, 200, || {
        let lo = random.magnitude(-100.0, -17.0);
        let x = if random.coin() { Dd::from_sum(-1.0, lo) } else { Dd::from(random.within(-1.0, -0.5)) };
        big_error(x.log1p(), big(x + Dd::ONE).ln())
    });
    at_most("log1p of large numbers", 2e-31 / U2, 200, || {
        let x = random.pair(300.0).abs();
        big_error(x.log1p(), big(x).ln_1p())
    });
}

#[test]
fn powers_of_a_highlight() {
    // cosⁿ as exp(n·log1p(−d)), for exponents up to 3000, against exact powers.
    let mut random = Random(6);
    at_most("highlight", 1e-28 / U2, 20, || {
        let (n, d) = ((1 + random.bits() % 3000) as i16, random.magnitude(-6.0, -2.0));
        let power = (Dd::from(f64::from(n)) * (-Dd::from(d)).log1p()).exp();
        error(power, &(Relaxed::ONE - exact(d)).pow(isize::from(n)))
    });
}

/// A line and an ellipsoid.
#[derive(Debug, Clone, Copy)]
struct Case {
    origin: DVec3,
    direction: DVec3,
    center: DVec3,
    scale: DVec3,
}

impl Case {
    /// From an origin and a direction in the space where the ellipsoid is the unit sphere.
    fn new(origin: DVec3, direction: DVec3, center: DVec3, scale: DVec3) -> Self {
        Self { origin: center + scale * origin, direction: scale * direction, center, scale }
    }

    /// A line that passes the centre of the unit sphere with the given clearance 1 − l², from `distance` before.
    fn passing(random: &mut Random, clearance: f64, distance: f64, center: DVec3, scale: DVec3) -> Self {
        let direction = random.unit();
        let side = direction.cross(random.unit()).normalize();
        let origin = side * (1.0 - clearance).sqrt() - direction * distance;
        Self::new(origin, direction * random.magnitude(-3.0, 3.0), center, scale)
    }
}

/// at² + 2bt + c, whose coefficients are exact.
struct Quadratic {
    a: Relaxed,
    b: Relaxed,
    c: Relaxed,
}

impl Quadratic {
    /// Of |(origin + t·direction − center)/scale|² = 1.
    fn new(case: &Case) -> Self {
        let axes = (0..3).map(|i| {
            let scale = exact(case.scale[i]);
            ((exact(case.origin[i]) - exact(case.center[i])) / scale.clone(), exact(case.direction[i]) / scale)
        });
        let start = Self { a: Relaxed::ZERO, b: Relaxed::ZERO, c: -Relaxed::ONE };
        axes.fold(start, |q, (s, d)| Self {
            a: q.a + d.clone() * d.clone(),
            b: q.b + s.clone() * d,
            c: q.c + s.clone() * s,
        })
    }

    fn discriminant(&self) -> Relaxed {
        self.b.clone() * self.b.clone() - self.a.clone() * self.c.clone()
    }

    fn at(&self, t: &Relaxed) -> Relaxed {
        (self.a.clone() * t.clone() + self.b.clone() + self.b.clone()) * t.clone() + self.c.clone()
    }

    /// Relative error of `t`, from one step of Newton's method.
    fn root_error(&self, t: Dd) -> f64 {
        let t = exact_pair(t);
        let half_slope = self.a.clone() * t.clone() + self.b.clone();
        relative(self.at(&t) / (half_slope.clone() + half_slope), t)
    }

    /// Whether the lesser or greater root lies within `tolerance`, relative, of `t`: exactly, by the change of sign.
    fn brackets(&self, t: Dd, lesser: bool, tolerance: f64) -> bool {
        let t = exact_pair(t);
        let width = magnitude(t.clone()) * exact(tolerance);
        let (before, after) = (self.at(&(t.clone() - width.clone())), self.at(&(t + width)));
        let (outside, inside) = if lesser { (before, after) } else { (after, before) };
        outside >= Relaxed::ZERO && inside <= Relaxed::ZERO
    }
}

/// What a class of rays showed.
#[derive(Debug, Default)]
struct Findings {
    rays: u32,
    hits: u32,
    mismatches: u32,
    single_mismatches: u32,
    root: f64,
    reference_root: f64,
    clearance: f64,
}

impl Findings {
    fn add(&mut self, case: &Case, tolerance: f64) {
        let Case { origin, direction, center, scale } = *case;
        let quadratic = Quadratic::new(case);
        let discriminant = quadratic.discriminant();
        let truth = oracle::truth(origin, direction, center, scale);
        let reference = oracle::intersect::<Dd>(origin, direction, center, scale);
        let single = oracle::intersect::<f32>(origin, direction, center, scale);
        let hit = discriminant >= Relaxed::ZERO;
        self.rays += 1;
        self.hits += u32::from(hit);
        self.mismatches += u32::from(truth.roots.is_some() != hit) + u32::from(reference.is_some() != hit);
        self.single_mismatches += u32::from(single.is_some() != hit);
        let clearance = discriminant / quadratic.a.clone();
        let distance = ((origin - center) / scale).length().max(1.0);
        let error = magnitude(exact_pair(truth.clearance) - clearance).to_f64_fast() / distance;
        self.clearance = self.clearance.max(error);
        for (roots, worst) in [
            (truth.roots, &mut self.root),
            (reference.map(|(lesser, greater)| [lesser, greater]), &mut self.reference_root),
        ] {
            for (root, lesser) in roots.into_iter().flatten().zip([true, false]) {
                *worst = worst.max(quadratic.root_error(root));
                assert!(
                    quadratic.brackets(root, lesser, tolerance),
                    "{case:?} {root:?} {}",
                    quadratic.root_error(root)
                );
            }
        }
    }
}

/// `count` rays of a class: no hit or miss is wrong, every root lies within `tolerance`, relative.
fn check(name: &str, seed: u64, count: usize, tolerance: f64, mut case: impl FnMut(&mut Random) -> Case) -> Findings {
    let mut random = Random(seed);
    let mut findings = Findings::default();
    for _ in 0..count {
        findings.add(&case(&mut random), tolerance);
    }
    println!("{name}: {findings:?}");
    assert_eq!(findings.mismatches, 0, "{name}");
    assert!(findings.clearance < 2e-31, "{name}: {findings:?}");
    assert!(findings.hits > 0, "{name}");
    findings
}

fn near_centre(random: &mut Random) -> DVec3 {
    random.vector(|random| random.within(-3.0, 3.0))
}

fn sphere(random: &mut Random) -> DVec3 {
    DVec3::splat(random.magnitude(-2.0, 2.0))
}

/// Semi-axes in a ratio of up to 1 to 1e4.
fn ellipsoid(random: &mut Random) -> DVec3 {
    random.vector(|random| random.magnitude(-2.0, 2.0))
}

/// 1 − l² of a line that nearly touches.
fn grazing(random: &mut Random) -> f64 {
    random.sign() * random.magnitude(-12.0, -2.0)
}

#[test]
fn ordinary_rays() {
    check("ordinary", 10, 4000, 1e-28, |random| {
        let (clearance, center, scale) = (random.within(-0.5, 1.0), near_centre(random), ellipsoid(random));
        Case::passing(random, clearance, 5.0, center, scale)
    });
}

#[test]
fn far_rays() {
    check("far", 11, 4000, 1e-25, |random| {
        let (clearance, distance) = (random.within(-0.5, 1.0), random.magnitude(1.0, 7.0));
        let (center, scale) = (near_centre(random), sphere(random));
        Case::passing(random, clearance, distance, center, scale)
    });
}

#[test]
fn grazing_rays() {
    let findings = check("grazing", 12, 4000, 1e-25, |random| {
        let (clearance, distance) = (grazing(random), random.magnitude(0.0, 1.0));
        let (center, scale) = (near_centre(random), ellipsoid(random));
        Case::passing(random, clearance, distance, center, scale)
    });
    assert!(findings.single_mismatches > 100, "f32 cannot tell these apart: {findings:?}");
}

#[test]
fn origins_near_the_surface() {
    check("near the surface", 13, 4000, 1e-24, |random| {
        let gap = random.sign() * random.magnitude(-7.0, -2.0);
        let (center, scale) = (near_centre(random), ellipsoid(random));
        Case::new(random.unit() * (1.0 + gap), random.unit(), center, scale)
    });
}

#[test]
fn thin_ellipsoids() {
    check("axis ratio 1e4", 14, 4000, 1e-25, |random| {
        let axis = (random.bits() % 3) as usize;
        let thin = random.coin();
        let mut scale = DVec3::splat(if thin { 1.0 } else { 1e-4 });
        scale[axis] = if thin { 1e-4 } else { 1.0 };
        let (clearance, distance, center) =
            (random.within(-0.1, 1.0), random.magnitude(-1.0, 4.0), near_centre(random));
        Case::passing(random, clearance, distance, center, scale)
    });
}

#[test]
fn rays_a_million_away_from_zero() {
    check("translated by 1e6", 15, 4000, 1e-25, |random| {
        let center = random.unit() * 1e6;
        let (clearance, distance, scale) = (random.within(-0.5, 1.0), random.magnitude(0.0, 1.0), sphere(random));
        Case::passing(random, clearance, distance, center, scale)
    });
}

#[test]
fn rays_from_inside() {
    let findings = check("inside", 16, 1000, 1e-25, |random| {
        let (center, scale) = (near_centre(random), ellipsoid(random));
        let origin = random.unit() * random.within(0.0, 0.999);
        Case::new(origin, random.unit(), center, scale)
    });
    assert_eq!(findings.hits, findings.rays);
}

#[test]
fn worlds_of_any_size() {
    for (seed, size) in [(17, 1e-30), (18, 1e20)] {
        check(&format!("world of size {size:e}"), seed, 500, 1e-25, |random| {
            let (center, scale) = (near_centre(random) * size, ellipsoid(random) * size);
            let (clearance, distance) = (grazing(random), random.magnitude(0.0, 1.0));
            Case::passing(random, clearance, distance, center, scale)
        });
    }
}

#[test]
fn everything_at_once() {
    check("everything at once", 19, 4000, 1e-23, |random| {
        let (center, scale) = (random.unit() * random.magnitude(0.0, 6.0), ellipsoid(random));
        let (clearance, distance) = (grazing(random), random.magnitude(0.0, 7.0));
        Case::passing(random, clearance, distance, center, scale)
    });
}

#[test]
fn exact_tangents() {
    // Axes of powers of two: nothing is rounded, so touching is touching.
    for (offset, meets) in [(2.0, true), (2.0_f64.next_down(), true), (2.0_f64.next_up(), false)] {
        let case = (DVec3::new(-3.0, offset, 0.0), DVec3::X, DVec3::ZERO, DVec3::new(8.0, 2.0, 0.5));
        let truth = oracle::truth(case.0, case.1, case.2, case.3);
        assert_eq!((truth.roots.is_some(), truth.clearance >= Dd::ZERO), (meets, meets));
        assert_eq!(oracle::intersect::<Dd>(case.0, case.1, case.2, case.3).is_some(), meets);
    }
    let touch = oracle::truth(DVec3::new(-3.0, 2.0, 0.0), DVec3::X, DVec3::ZERO, DVec3::splat(2.0));
    assert_eq!((touch.roots, touch.clearance), (Some([Dd::from(3.0); 2]), Dd::ZERO));
    let at_origin = oracle::truth(DVec3::new(0.0, 2.0, 0.0), DVec3::X, DVec3::ZERO, DVec3::splat(2.0));
    assert_eq!(at_origin.roots, Some([Dd::ZERO; 2]));
    let middle = oracle::truth(DVec3::new(-3.0, 0.0, 0.0), DVec3::X, DVec3::ZERO, DVec3::new(-2.0, 1.0, 1.0));
    assert_eq!((middle.roots, middle.clearance), (Some([Dd::ONE, Dd::from(5.0)]), Dd::ONE));
}

#[test]
fn roots_do_not_cancel() {
    // 1e-13 from the surface, with few enough bits that |S'|² − 1 is exact: the near root keeps every digit.
    for (y, z) in [(1.0, -1.0), (-1.0, 1.0), (0.5, 1.0)] {
        let (offset, gap) = (1.0 / (1_u64 << 20) as f64, 1.0 / (1_u64 << 45) as f64);
        for gap in [gap, -gap] {
            let origin = DVec3::new(0.0, offset, 1.0 + gap);
            let case =
                Case { origin, direction: DVec3::new(0.0, y / 1024.0, z), center: DVec3::ZERO, scale: DVec3::ONE };
            Findings::default().add(&case, 1e-30);
        }
    }
}

#[test]
fn nothing_is_no_hit() {
    let (o, d, c, s) = (DVec3::new(-3.0, 0.0, 0.0), DVec3::X, DVec3::ZERO, DVec3::ONE);
    for (o, d, c, s) in [
        (o, DVec3::ZERO, c, s),
        (o, d, c, DVec3::ZERO),
        (o, d, c, DVec3::new(0.0, 1.0, 1.0)),
        (DVec3::NAN, d, c, s),
        (o, DVec3::NAN, c, s),
        (o, d, DVec3::NAN, s),
        (o, d, c, DVec3::NAN),
        (DVec3::INFINITY, d, c, s),
        (o, DVec3::INFINITY, c, s),
    ] {
        assert_eq!(oracle::truth(o, d, c, s).roots, None, "{o} {d} {c} {s}");
        assert_eq!(oracle::intersect::<Dd>(o, d, c, s), None, "{o} {d} {c} {s}");
    }
}
