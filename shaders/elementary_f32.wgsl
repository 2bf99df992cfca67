// e^x and ln(1 - d): the device's own exp and log may be off by several units, which a large exponent multiplies.
// needs: real

// e^x for x <= 0: x = k ln 2 + r, |r| <= ln 2 / 2, ln 2 in two parts (Cody, Waite, "Software Manual for the Elementary
// Functions", 1980), then the Taylor series of e^r to r^7 / 7!, which leaves 6e-9.
fn exponential(x: real) -> real {
    let k = floor(x * 1.442695 + 0.5);
    let r = (x - k * 0.693359375) + k * 2.12194440e-4;
    let series = 1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0 + r * (1.0 / 5040.0)));
    let power = 1.0 + (r + r * r * (1.0 / 2.0 + r * (1.0 / 6.0 + r * series)));
    return select(0.0, power * bitcast<f32>(u32(i32(k) + 127) << 23u), x > -87.0);
}

// ln(1 - d) for d in [0, 1). 1 - d = 2^k m with m in [0.7, 1.4], ln m = 2 atanh(s), s = (m - 1)/(m + 1); for small d
// s = -d / (2 - d) without rounding 1 - d. The series of atanh to s^9 leaves 3e-9.
fn log1m(d: real) -> real {
    let bits = bitcast<u32>(1.0 - d);
    let mantissa = bitcast<f32>((bits & 0x007fffffu) | 0x3f800000u);
    let is_high = mantissa > 1.4;
    let m = select(mantissa, mantissa * 0.5, is_high);
    let is_large = d > 0.3;
    let k = select(0, i32(bits >> 23u) - 127 + i32(is_high), is_large);
    let s = select(-d, m - 1.0, is_large) / select(2.0 - d, m + 1.0, is_large);
    let s2 = s * s;
    let sum = s2 * (1.0 / 3.0 + s2 * (1.0 / 5.0 + s2 * (1.0 / 7.0 + s2 * (1.0 / 9.0))));
    return 2.0 * (s + s * sum) + f32(k) * 0.69314718;
}
