//! Decimal numbers, correctly rounded.

/// The powers of ten that `f64` holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];
/// So many decimal digits always fit into a `u64`.
const DIGITS: usize = 19;
/// Up to here `f64` holds every integer exactly.
const EXACT: u64 = 1 << 53;

/// Why a token is no number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    /// It is not written like one.
    Syntax,
    /// It is `NaN` or an infinity by name.
    NotFinite,
    /// Its size is beyond the largest `f64`.
    Overflow,
}

/// The `f64` nearest to a decimal number such as `-1`, `.5`, `5.` or `+2.5e-3`.
///
/// Short numbers are one exact integer and one exact power of ten, so that a single division or multiplication rounds
/// correctly; all others go to the standard library.
pub(crate) fn parse_number(token: &[u8]) -> Result<f64, Fault> {
    let (negative, unsigned) = match token {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, token),
    };
    let mantissa = Mantissa::read(unsigned);
    let exponent = match &unsigned[mantissa.len..] {
        _ if mantissa.digits == 0 => return Err(fault(unsigned)),
        [] => 0,
        [b'e' | b'E', rest @ ..] => read_exponent(rest).ok_or(Fault::Syntax)?,
        _ => return Err(Fault::Syntax),
    };
    let exponent = exponent.saturating_sub_unsigned(mantissa.decimals as u64);
    match usize::try_from(exponent.unsigned_abs()).ok().and_then(|index| POWERS.get(index)) {
        Some(power) if mantissa.digits <= DIGITS && mantissa.value <= EXACT => {
            let integer = mantissa.value as f64;
            let size = if exponent < 0 { integer / power } else { integer * power };
            Ok(if negative { -size } else { size })
        }
        _ => parse_slowly(token),
    }
}

/// The digits before the exponent.
struct Mantissa {
    /// All digits as one integer; wrapped around where there are more than [`DIGITS`].
    value: u64,
    digits: usize,
    /// How many of the digits follow the point.
    decimals: usize,
    /// Bytes read.
    len: usize,
}

impl Mantissa {
    fn read(bytes: &[u8]) -> Self {
        let (value, whole) = read_digits(bytes, 0);
        let [b'.', rest @ ..] = &bytes[whole..] else {
            return Self { value, digits: whole, decimals: 0, len: whole };
        };
        let (value, decimals) = read_digits(rest, value);
        Self { value, digits: whole + decimals, decimals, len: whole + 1 + decimals }
    }
}

/// Appends the leading digits of `bytes` to `value`; how many there were.
fn read_digits(bytes: &[u8], mut value: u64) -> (u64, usize) {
    let mut count = 0;
    while let Some(digit) = bytes.get(count).map(|byte| byte.wrapping_sub(b'0')).filter(|&digit| digit < 10) {
        value = value.wrapping_mul(10).wrapping_add(digit.into());
        count += 1;
    }
    (value, count)
}

/// The integer after the `e`, brought within what fits; `None` if there is none.
fn read_exponent(bytes: &[u8]) -> Option<i64> {
    let (sign, digits) = match bytes {
        [b'-', rest @ ..] => (-1, rest),
        [b'+', rest @ ..] => (1, rest),
        _ => (1, bytes),
    };
    let is_number = !digits.is_empty() && digits.iter().all(u8::is_ascii_digit);
    let append = |value: u32, digit: &u8| value.saturating_mul(10).saturating_add((digit - b'0').into());
    is_number.then(|| sign * i64::from(digits.iter().fold(0, append)))
}

/// For tokens whose syntax is known to be right.
#[cold]
fn parse_slowly(token: &[u8]) -> Result<f64, Fault> {
    let value: f64 = str::from_utf8(token).ok().and_then(|text| text.parse().ok()).ok_or(Fault::Syntax)?;
    if value.is_finite() { Ok(value) } else { Err(Fault::Overflow) }
}

#[cold]
fn fault(unsigned: &[u8]) -> Fault {
    let names: [&[u8]; 3] = [b"nan", b"inf", b"infinity"];
    if names.iter().any(|name| unsigned.eq_ignore_ascii_case(name)) { Fault::NotFinite } else { Fault::Syntax }
}

/// Whether a number that is written with other digits than 0 has lost precision because it is so near to 0.
pub(super) fn is_tiny(value: f64, token: &[u8]) -> bool {
    let mut mantissa = token.iter().take_while(|byte| !matches!(byte, b'e' | b'E'));
    value.is_subnormal() || (value == 0.0 && mantissa.any(|byte| matches!(byte, b'1'..=b'9')))
}
