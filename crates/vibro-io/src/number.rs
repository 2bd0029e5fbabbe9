//! Parses numbers as instruments print them.
//!
//! Reads more than Rust's own parser: Fortran's `1.0D+03`, exponents of three digits without a letter
//! (`1.234-101`), a decimal comma, digits grouped in threes, a typographic or trailing minus, blanks around
//! a number.
//!
//! Results are correctly rounded. Up to 19 digits are gathered in a 64-bit integer. If it is below 2⁵³ and
//! the power of ten at most 10²², one multiplication or division of exact numbers gives the nearest double
//! (Clinger, "How to read floating point numbers accurately", 1990, section 4). Otherwise the standard
//! library parses the digits.

/// 10⁰ … 10²², all exact in a double.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// Words that instruments print for a missing or over-range value, in lower case, separated by `|`.
const MISSING: &str = "novalue|nan|nat|inf|infinity|∞|na|n/a|null|none|ol|over|overload|overrange|over range|ovld|burnout|fffffff\
                       |err|#err|#div/0!|#n/a|#nv|#num!|#value!|#ref!|#name?|#null!|#wert!|#zahl!";

/// Numbers that instruments print for infinity and "not a number" (SCPI-1999, volume 1, 7.2.1.4 and 7.2.1.5).
const OVERLOAD: [f64; 2] = [9.9e37, 9.91e37];

/// Parses one number with a decimal point. Blanks around it are allowed; any other text beside it gives
/// `None`.
pub fn parse(text: &[u8]) -> Option<f64> {
    parse_with(text, b'.')
}

/// Parses one number with a decimal point or else a decimal comma.
pub(crate) fn either(text: &[u8]) -> Option<f64> {
    parse(text).or_else(|| parse_with(text, b','))
}

/// Parses one number with `decimal` as its decimal mark.
pub(crate) fn parse_with(text: &[u8], decimal: u8) -> Option<f64> {
    let text = text.trim_ascii();
    match prefix(text, decimal) {
        Some((value, used)) if used == text.len() => Some(value),
        Some(_) => ungrouped(text, decimal, false).or_else(|| negative(text, decimal)),
        None => negative(text, decimal),
    }
}

/// A number with a typographic minus, or with a trailing minus, as spreadsheets and old programs write it:
/// `−0.5`, `0.5-`.
#[cold]
fn negative(text: &[u8], decimal: u8) -> Option<f64> {
    let before = || ["−", "–"].iter().find_map(|minus| text.strip_prefix(minus.as_bytes()));
    let magnitude = text.strip_suffix(b"-").or_else(before)?;
    let (value, used) = prefix(magnitude, decimal)?;
    (used == magnitude.len() && magnitude[0] != b'-' && magnitude[0] != b'+').then_some(-value)
}

/// As [`parse_with`] for a decimal mark that the user stated: the other mark may then also separate
/// thousands in whole numbers.
pub(crate) fn parse_stated(text: &[u8], decimal: u8) -> Option<f64> {
    parse_with(text, decimal).or_else(|| ungrouped(text.trim_ascii(), decimal, true))
}

/// Whether the mark in `text` may either separate thousands in a whole number or be its decimal mark:
/// `1,000` is 1000 or 1.
pub(crate) fn may_be_grouped(text: &[u8]) -> bool {
    [b'.', b','].iter().any(|decimal| {
        !text.contains(decimal)
            && parse_with(text, *decimal).is_none()
            && ungrouped(text, *decimal, true).is_some()
    })
}

/// Parses a number with digits in groups of three. Apostrophes or narrow blanks separate groups. The other
/// mark does so only if the number contains its decimal mark, or the user `stated` the decimal mark.
#[cold]
fn ungrouped(text: &[u8], decimal: u8, stated: bool) -> Option<f64> {
    let text = std::str::from_utf8(text).ok()?;
    let mark = if decimal == b',' { '.' } else { ',' };
    let own = char::from(decimal);
    let group = text.find(['\'', '’', '\u{a0}', '\u{202f}', '\u{2009}', mark])?;
    let group =
        text[group..].chars().next().filter(|group| *group != mark || stated || text.contains(own))?;
    let whole = text.split(own).next()?.trim_start_matches(['-', '+']);
    // A number with thousands separators does not begin with 0: `0.123` has three decimals.
    if group == mark && whole.starts_with('0') {
        return None;
    }
    let mut parts = whole.split(group);
    let threes = (1..=3).contains(&parts.next()?.len()) && parts.all(|part| part.len() == 3);
    if threes { parse_with(text.replace(group, "").as_bytes(), decimal) } else { None }
}

/// Whether a field stands for a missing value: blank, `NaN`, `Inf`, `∞`, `-`, `--.--`, `NA`, `1.#QNAN`,
/// `***`, `OVER`, `9.9E+37`, `#DIV/0!`, …
pub(crate) fn is_missing(text: &[u8]) -> bool {
    let text = text.trim_ascii();
    let text = text.strip_prefix(b"-").or(text.strip_prefix(b"+")).unwrap_or(text);
    if [b"**", b"-.", b"++"].iter().any(|marks| text.iter().all(|b| marks.contains(b))) {
        return true;
    }
    let lower = text.to_ascii_lowercase();
    let overload = || {
        String::from_utf8_lossy(&lower).replace(',', ".").parse().is_ok_and(|v: f64| OVERLOAD.contains(&v))
    };
    MISSING.split('|').any(|word| word.as_bytes() == lower)
        || lower.starts_with(b"9") && overload()
        || lower.starts_with(b"nan(")
        || lower.starts_with(b"1.#")
}

/// Parses the number at the start of `text`: its value and its length in bytes. Leading blanks are not
/// allowed.
///
/// A number that overflows a double gives `None`; one that underflows gives 0 or a subnormal.
#[inline]
pub fn prefix(text: &[u8], decimal: u8) -> Option<(f64, usize)> {
    // No branch on the sign: measured signs are random, and a wrong branch prediction takes longer than
    // parsing the whole number.
    let first = *text.first()?;
    let negative = first == b'-';
    let mut at = usize::from(negative) + usize::from(first == b'+');
    let digits_from = at;
    let mut mantissa: u64 = 0;
    while let Some(d) = text.get(at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(d));
        at += 1;
    }
    let mut digits = at - digits_from;
    let mut exponent: i32 = 0;
    if text.get(at) == Some(&decimal) {
        at += 1;
        let from = at;
        while let Some(eight) = text[at..].first_chunk::<8>().and_then(|t| eight_digits(*t)) {
            mantissa = mantissa.wrapping_mul(100_000_000).wrapping_add(eight);
            at += 8;
        }
        while let Some(d) = text.get(at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(d));
            at += 1;
        }
        digits += at - from;
        exponent = -i32::try_from(at - from).ok()?;
    }
    if digits == 0 {
        return None;
    }
    let mantissa_to = at;
    let mut printed: i32 = 0;
    if let Some((power, used)) = exponent_part(&text[at..]) {
        printed = power;
        at += used;
    }
    let exponent = exponent.saturating_add(printed);
    let magnitude = if digits <= 19 && mantissa < (1 << 53) && exponent.unsigned_abs() <= 22 {
        let power = POWERS[exponent.unsigned_abs() as usize];
        if exponent < 0 { mantissa as f64 / power } else { mantissa as f64 * power }
    } else {
        slow(&text[digits_from..mantissa_to], decimal, printed)?
    };
    Some((if negative { -magnitude } else { magnitude }, at))
}

/// Parses a field of `W` characters as Fortran's `1PEw.d` and C's `%w.de` print it: a blank, a sign or blank,
/// a digit, the point, `W` − 8 digits, `E`, a sign, two digits. `None` for every other field, which
/// [`prefix`] may still read.
#[inline]
pub fn scientific<const W: usize>(field: &[u8; W]) -> Option<f64> {
    if field[0] != b' ' || !matches!(field[1], b' ' | b'-') {
        return None;
    }
    let magnitude = exponential(&field[2..])?;
    Some(if field[1] == b'-' { -magnitude } else { magnitude })
}

/// Parses all of `field` as a digit, the point, digits, `E`, a sign and two digits; `None` for everything
/// else.
///
/// The loop over the digits has no branch; the compiler unrolls it if the length of the field is known.
#[inline(always)]
#[allow(clippy::inline_always)] // the length must be known to the compiler
pub fn exponential(field: &[u8]) -> Option<f64> {
    let w = field.len();
    // 24 characters hold 19 digits, which always fit into 64 bits. Whether the integer is exact in a double
    // is checked below.
    if !(8..=24).contains(&w) {
        return None;
    }
    let digit = |at: usize| field[at].wrapping_sub(b'0');
    // `d.dddddd` is read as eight digits at once: the first digit moves to the place of the point, and a
    // zero takes its place.
    let (mut mantissa, mut worst, mut at) = (u64::from(digit(0)), digit(0), 2);
    if w >= 12 {
        let mut eight = *field.first_chunk::<8>()?;
        (eight[0], eight[1]) = (b'0', field[0]);
        (mantissa, at) = (eight_digits(eight)?, 8);
    }
    for b in &field[at..w - 4] {
        let d = b.wrapping_sub(b'0');
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(d));
        worst = worst.max(d);
    }
    let (tens, ones) = (digit(w - 2), digit(w - 1));
    worst = worst.max(tens).max(ones);
    let marks =
        field[1] == b'.' && matches!(field[w - 4], b'E' | b'e') && matches!(field[w - 3], b'-' | b'+');
    if worst > 9 || !marks || mantissa >= 1 << 53 {
        return None;
    }
    let printed = i32::from(tens) * 10 + i32::from(ones);
    let printed = if field[w - 3] == b'-' { -printed } else { printed };
    let exponent = printed - (w as i32 - 6);
    let power = *POWERS.get(exponent.unsigned_abs() as usize)?;
    Some(if exponent < 0 { mantissa as f64 / power } else { mantissa as f64 * power })
}

/// Eight ASCII digits as a number, combined to pairs, fours and eight within one register. `None` if any
/// byte is not a digit.
#[inline]
fn eight_digits(text: [u8; 8]) -> Option<u64> {
    const ZEROS: u64 = 0x3030_3030_3030_3030;
    const HIGH: u64 = 0xf0f0_f0f0_f0f0_f0f0;
    let v = u64::from_le_bytes(text);
    // A byte is a digit if its high half is 3 and remains 3 when 6 is added.
    let other = ((v & HIGH) ^ ZEROS) | ((v.wrapping_add(0x0606_0606_0606_0606) & HIGH) ^ ZEROS);
    if other != 0 {
        return None;
    }
    let v = (v & 0x0f0f_0f0f_0f0f_0f0f).wrapping_mul(10 * 256 + 1) >> 8;
    let v = (v & 0x00ff_00ff_00ff_00ff).wrapping_mul(100 * 65_536 + 1) >> 16;
    Some((v & 0x0000_ffff_0000_ffff).wrapping_mul(10_000 * 4_294_967_296 + 1) >> 32)
}

/// A parser compiled for fields of one length.
pub type Exponential = fn(&[u8]) -> Option<f64>;

/// [`exponential`] compiled for fields of `width` characters; `None` outside 8 to 20, which instruments do
/// not print.
pub(crate) fn exponential_of(width: usize) -> Option<Exponential> {
    fn of<const W: usize>(field: &[u8]) -> Option<f64> {
        field.first_chunk::<W>().and_then(|field| exponential(field))
    }
    const FROM_8: [Exponential; 13] = [
        of::<8>, of::<9>, of::<10>, of::<11>, of::<12>, of::<13>, of::<14>, of::<15>, of::<16>, of::<17>,
        of::<18>, of::<19>, of::<20>,
    ];
    FROM_8.get(width.checked_sub(8)?).copied()
}

/// An exponent and its length in bytes: `E+03`, `D-3`, `e5`, or a bare sign and three digits; `None` if
/// there is none.
#[inline]
fn exponent_part(text: &[u8]) -> Option<(i32, usize)> {
    let lettered = matches!(text.first()?, b'e' | b'E' | b'd' | b'D' | b'q' | b'Q');
    let mut at = usize::from(lettered);
    let sign = *text.get(at)?;
    let negative = sign == b'-';
    let signed = matches!(sign, b'-' | b'+');
    if !lettered && !signed {
        return None;
    }
    at += usize::from(signed);
    let from = at;
    let mut value: i32 = 0;
    while let Some(d) = text.get(at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
        value = value.saturating_mul(10).saturating_add(i32::from(d));
        at += 1;
    }
    // An exponent without a letter has three digits, since Fortran drops the letter only if the exponent
    // needs its place. Without this rule, `1.5-2`, two numbers that touch, would be read as one number.
    let enough = if lettered { at > from } else { at - from == 3 };
    enough.then_some((if negative { -value } else { value }, at))
}

#[cold]
fn slow(mantissa: &[u8], decimal: u8, exponent: i32) -> Option<f64> {
    let mut text: String =
        mantissa.iter().map(|b| if *b == decimal { '.' } else { char::from(*b) }).collect();
    text.push('e');
    text.push_str(&exponent.to_string());
    text.parse::<f64>().ok().filter(|v| v.is_finite() && !OVERLOAD.contains(v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn spellings_of_instruments() {
        let cases: [(&str, f64); 14] = [
            ("1.0D+03", 1e3),
            ("1.0d3", 1e3),
            ("-3.09944E-004", -3.09944e-4),
            ("1.234-101", 1.234e-101),
            ("-1.234+101", -1.234e101),
            ("+5", 5.0),
            (".5", 0.5),
            ("5.", 5.0),
            ("  2.5  ", 2.5),
            ("00000000000000000000001", 1.0),
            ("0.000000000000000000000000000001", 1e-30),
            ("123456789012345678901234567890", 123_456_789_012_345_678_901_234_567_890.0),
            ("1e-400", 0.0),
            ("4.9e-324", 4.9e-324),
        ];
        for (text, value) in cases {
            assert_eq!(parse(text.as_bytes()), Some(value), "{text}");
        }
        assert_eq!(parse_with(b"1,5E-3", b','), Some(1.5e-3));
        assert!(parse(b"-0").unwrap().is_sign_negative());
        assert_eq!(scientific(b" -1.47553E-02"), Some(-1.47553e-2));
        assert_eq!(scientific(b"-1.47553E-002"), None);
    }

    #[test]
    fn what_is_not_a_number() {
        for text in [
            "", " ", "-", ".", "e5", "1e", "1e+", "1.2.3", "1,5", "0x10", "1 2", "1e999", "1.5-2", "--1",
            "NaN",
        ] {
            assert_eq!(parse(text.as_bytes()), None, "{text:?}");
        }
    }

    #[test]
    fn missing_values() {
        for text in ["", "  ", "NaN", "-inf", "1.#QNAN", "*****", "NA", "-"] {
            assert!(is_missing(text.as_bytes()), "{text:?}");
        }
        assert!(!is_missing(b"0"));
        assert!(!is_missing(b"abc"));
    }

    proptest! {
        /// The standard library's parser is the reference. Both are correctly rounded, so they agree to the
        /// bit.
        #[test]
        fn agrees_with_the_standard_library(value in proptest::num::f64::NORMAL | proptest::num::f64::ZERO, digits in 0usize..20) {
            for text in [format!("{value:e}"), format!("{value:.digits$e}"), format!("{}", value as f32)] {
                let expected = text.parse::<f64>().ok().filter(|v| v.is_finite());
                prop_assert_eq!(parse(text.as_bytes()).map(f64::to_bits), expected.map(f64::to_bits), "{}", text);
            }
        }

        /// The general parser is the reference.
        #[test]
        fn scientific_fields_agree_with_the_general_parser(value in -1e20f64..1e20, power in -40i32..20) {
            fn check<const W: usize>(text: &str) -> Result<(), TestCaseError> {
                let field: &[u8; W] = text.as_bytes().try_into().expect("the field is as wide as asked");
                let general = parse(field).expect("a printed number");
                match scientific(field) {
                    Some(value) => prop_assert_eq!(value.to_bits(), general.to_bits(), "{}", text),
                    // Beyond 10²² the power of ten is not exact.
                    None => prop_assert!(general == 0.0 || !(1e-10..1e20).contains(&general.abs()), "{}", text),
                }
                Ok(())
            }
            let value = value / 1e20 * 10f64.powi(power);
            let printed = |digits: usize| {
                let text = format!("{value:.digits$e}");
                let (mantissa, exponent) = text.split_once('e').expect("an exponent");
                let exponent: i32 = exponent.parse().expect("a whole exponent");
                format!("{mantissa:>width$}E{}{:02}", if exponent < 0 { '-' } else { '+' }, exponent.abs(), width = digits + 4)
            };
            check::<13>(&printed(5))?;
            check::<20>(&printed(12))?;
        }

        #[test]
        fn scientific_takes_nothing_that_the_general_parser_refuses(
            at in 0usize..13,
            with in proptest::sample::select(b" -+.0123456789eED/:\0".to_vec()),
            then in 0usize..13,
        ) {
            let mut field = *b" -1.47553E-02";
            field[at] = with;
            field[then] = b' ';
            if let Some(value) = scientific(&field) {
                prop_assert_eq!(parse(&field).map(f64::to_bits), Some(value.to_bits()));
            }
        }

        #[test]
        fn never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..40)) {
            let _ = parse(&bytes);
            let _ = is_missing(&bytes);
        }
    }
}
