// e^x and ln(1 - d): Vulkan has no f64 exp and log.
// needs: real

const LN_2_HIGH: real = 6.93147180369123816490e-01lf;
const LN_2_LOW: real = 1.90821492927058770002e-10lf;

// 2^k for whole k in [-1022, 1023], by its bits.
fn power_of_two(k: i32) -> real {
    // A product of two powers of two that f32 holds.
    let half = k / 2;
    let low = bitcast<f32>(u32(half + 127) << 23u);
    let high = bitcast<f32>(u32(k - half + 127) << 23u);
    return real(low) * real(high);
}

// e^x for x <= 0, and 0 below 1e-73, which no picture sees: x = k ln 2 + r, |r| <= ln 2 / 2, then the Taylor series of e^r to
// r^14 / 14!, which leaves 2e-18.
fn exponential(x: real) -> real {
    let is_seen = x > -170.0lf;
    let power = select(0.0lf, x, is_seen);
    let k = i32(f32(power) * 1.442695 - 0.5);
    let r = (power - real(k) * LN_2_HIGH) - real(k) * LN_2_LOW;
    var sum = 1.0lf;
    for (var i = 14; i >= 1; i--) {
        sum = 1.0lf + r * sum / real(i);
    }
    return select(0.0lf, sum * power_of_two(k), is_seen);
}

// ln(1 - d) for d in [0, 1). 1 - d = 2^k m with m in [0.7, 1.4], ln m = 2 atanh(s), s = (m - 1)/(m + 1); for small d
// s = -d / (2 - d) without rounding 1 - d. The series of atanh to s^21 leaves 3e-18.
fn log1m(d: real) -> real {
    var s = -d / (2.0lf - d);
    var k = 0;
    if d > 0.3lf {
        let y = 1.0lf - d;
        let exponent = bitcast<u32>(f32(y)) >> 23u;
        k = i32(exponent) - 127;
        var m = y * power_of_two(-k);
        if m > 1.4lf {
            m *= 0.5lf;
            k += 1;
        }
        s = (m - 1.0lf) / (m + 1.0lf);
    }
    let s2 = s * s;
    var sum = 0.0lf;
    for (var i = 21; i >= 1; i -= 2) {
        sum = 1.0lf / real(i) + s2 * sum;
    }
    return 2.0lf * s * sum + real(k) * LN_2_LOW + real(k) * LN_2_HIGH;
}
