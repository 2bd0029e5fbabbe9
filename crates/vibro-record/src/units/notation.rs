//! How numbers, uncertainties and units are written.

/// Minus sign, as wide as a digit.
const MINUS: &str = "\u{2212}";

/// A number with a fixed count of decimals and a true minus sign; never `−0`.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| matches!(b, b'0' | b'.')) => digits.to_owned(),
        Some(digits) => format!("{MINUS}{digits}"),
        None => text,
    }
}

/// Superscript digits, for exponents.
pub(super) const RAISED: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/// `10ⁿ` in superscript digits.
pub fn power_of_ten(exponent: i32) -> String {
    let raised =
        |c: char| RAISED.chars().zip('0'..='9').find(|(_, digit)| *digit == c).map_or('⁻', |(r, _)| r);
    "10".chars().chain(exponent.to_string().chars().map(raised)).collect()
}

/// Rewrites the numbers of a text with powers of ten and true minus signs: `1e-9 m` becomes `10⁻⁹ m`.
pub fn typeset(text: &str) -> String {
    let word = |word: &str| {
        let number = word.trim_end_matches([',', ';', ':']);
        if number.parse::<f64>().is_err() || !number.ends_with(|c: char| c.is_ascii_digit()) {
            return word.to_owned();
        }
        let rest = &word[number.len()..];
        let power = number.split_once('e').and_then(|(m, e)| Some((m, power_of_ten(e.parse().ok()?))));
        match power {
            Some(("1", power)) => format!("{power}{rest}"),
            Some((mantissa, power)) => format!("{}×{power}{rest}", mantissa.replace('-', MINUS)),
            None => word.replace('-', MINUS),
        }
    };
    text.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// A number with this many significant digits, as a plain decimal between 10⁻⁴ and 10⁷, else with a power of
/// ten.
///
/// Infinite values are written `∞`, a missing one (NaN) as a dash.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return match value {
            v if v.is_nan() => "–".to_owned(),
            v if v > 0.0 => "∞".to_owned(),
            _ => format!("{MINUS}∞"),
        };
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let (exponent, places) = (decade(value, digits), digits.max(1) as i32 - 1);
    if (-4..7).contains(&exponent) {
        return rounded(value, places - exponent);
    }
    let (mantissa, _) = scientific(value, digits);
    format!("{}×{}", mantissa.replace('-', MINUS), power_of_ten(exponent))
}

/// Shortest text of a number rounded to twelve significant digits; further digits are rounding errors.
pub fn shortest(value: f64) -> String {
    format!("{value:.11e}").parse().unwrap_or(value).to_string()
}

/// Largest number of significant digits of a value with an uncertainty: no measurement has more.
const DIGITS: i32 = 10;

/// A value with its standard uncertainty, both rounded to two significant digits of the uncertainty (GUM,
/// 7.2.6).
///
/// Without a usable uncertainty the value has five significant digits; with a very small one it has ten.
///
/// ```
/// use vibro_record::units::notation::estimate;
/// assert_eq!(estimate(7.489_51, Some(0.012_34)), "7.490 ± 0.012");
/// assert_eq!(estimate(-3.2e-9, Some(1.1e-10)), "(−3.20 ± 0.11)×10⁻⁹");
/// assert_eq!(estimate(7.489_51, None), "7.4895");
/// ```
pub fn estimate(value: f64, std: Option<f64>) -> String {
    let Some(std) = std.filter(|s| s.is_finite() && *s > 0.0 && value.is_finite()) else {
        return significant(value, 5);
    };
    let exponent = engineering(value.abs().max(std));
    if value != 0.0 && std < 10f64.powi(decade(value, 1) - DIGITS) {
        // No measurement has more digits.
        return format!("{} ± {}", significant(value, DIGITS as usize), significant(std, 2));
    }
    let scale = if (-3..=3).contains(&exponent) { 1.0 } else { 10f64.powi(-exponent) };
    let places = 1 - decade(std * scale, 2);
    let both = format!("{} ± {}", rounded(value * scale, places), rounded(std * scale, places));
    if scale == 1.0 { both } else { format!("({both})×{}", power_of_ten(exponent)) }
}

/// A number of things: `1 field`, `3 fields`.
pub fn counted(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

/// Number of decimals that show `value` to `digits` significant digits without trailing zeros.
pub fn decimals_needed(value: f64, digits: usize) -> usize {
    let (mantissa, exponent) = scientific(value, digits);
    let kept = mantissa.trim_start_matches('-').trim_end_matches('0').len().saturating_sub(2) as i32;
    usize::try_from(kept - exponent).unwrap_or(0)
}

/// Exponent n, a multiple of three, for which `largest`/10ⁿ lies from 1 to below 1000; 0 for numbers from 0.1
/// to below 10 000, which are written without a power of ten.
pub fn engineering(largest: f64) -> i32 {
    if !largest.is_finite() || largest == 0.0 || (0.1..1e4).contains(&largest.abs()) {
        return 0;
    }
    // Ten digits, so that 999.999 999 999 9 counts as 1000.
    decade(largest, 10).div_euclid(3) * 3
}

/// Times in s below this are rounding errors of 0: no clock resolves them.
const ROUNDING: f64 = 1e-15;

/// Value and unit for a sentence, with an SI prefix where one fits. A time below 10⁻¹⁵ s is written as 0 s.
///
/// ```
/// use vibro_record::units::notation::quantity;
/// assert_eq!(quantity(0.018_34, "s", 3), "18.3 ms");
/// assert_eq!(quantity(-0.25, "m/s", 2), "−0.25 m/s");
/// assert_eq!(quantity(3e-6, "1", 2), "3.0×10⁻⁶");
/// assert_eq!(quantity(0.0104, "FS", 3), "10.4×10⁻³ FS");
/// assert_eq!(quantity(8.88e-16, "s", 3), "0 s");
/// ```
pub fn quantity(value: f64, unit: &str, digits: usize) -> String {
    let value = if unit == "s" && value.abs() < ROUNDING { 0.0 } else { value };
    let exponent = engineering(value);
    let unit = if unit == "1" { "" } else { unit };
    if exponent == 0 || unit.is_empty() || !value.is_finite() {
        return format!("{} {unit}", significant(value, digits)).trim_end().to_owned();
    }
    let (number, unit) = (significant(value / 10f64.powi(exponent), digits), scaled_unit(unit, exponent));
    // A unit that takes no prefix is preceded by the power of ten.
    let between = if unit.starts_with("10") { "×" } else { " " };
    [number.as_str(), between, &unit].concat()
}

/// The reference of a level: a number from 1 to below 1000 in a unit with a prefix, such as `1 µm/s`; so
/// 0.1 V is written as `100 mV`.
///
/// ```
/// use vibro_record::units::notation::reference;
/// assert_eq!(reference(1e-9, "m/s"), "1 nm/s");
/// assert_eq!(reference(0.1, "V"), "100 mV");
/// ```
pub fn reference(value: f64, unit: &str) -> String {
    let power = if value > 0.0 && value.is_finite() { (value.log10() + 1e-9).floor() as i32 } else { 0 };
    let power = power.div_euclid(3) * 3;
    let number = value / 10f64.powi(power);
    format!("{} {}", fixed(number, decimals_needed(number, 3)), scaled_unit(unit, power))
}

/// A unit multiplied by a power of ten, with an SI prefix where one fits (`m` and −3 give `mm`).
///
/// Only a coherent SI unit (m, not mm) in first place and to the first power takes a prefix; metres and
/// seconds take only prefixes below 1. Any other unit is preceded by the power of ten.
pub fn scaled_unit(unit: &str, exponent: i32) -> String {
    const PREFIXES: [(i32, &str); 8] =
        [(-12, "p"), (-9, "n"), (-6, "µ"), (-3, "m"), (3, "k"), (6, "M"), (9, "G"), (12, "T")];
    const PARTS: [&str; 2] = ["m", "s"];
    const COHERENT: [&str; 9] = ["N", "V", "A", "K", "W", "J", "Pa", "Hz", "Ω"];
    let unit = if unit == "1" { "" } else { unit };
    if exponent == 0 {
        return unit.to_owned();
    }
    let start = unit.find(|c| c != '(').unwrap_or(0);
    let (opening, rest) = unit.split_at(start);
    let end = rest.find(|c: char| !c.is_alphabetic()).unwrap_or(rest.len());
    let (symbol, tail) = rest.split_at(end);
    let first_power = !tail.starts_with(['²', '³', '⁴', '⁻', '^', '·']);
    let (symbol, total) = if symbol == "kg" { ("g", exponent + 3) } else { (symbol, exponent) };
    let takes = COHERENT.contains(&symbol) || PARTS.contains(&symbol) && total < 0 || rest.starts_with("kg");
    if first_power && takes {
        if total == 0 {
            return format!("{opening}{symbol}{tail}");
        }
        if let Some((_, prefix)) = PREFIXES.iter().find(|p| p.0 == total) {
            return format!("{opening}{prefix}{symbol}{tail}");
        }
    }
    if unit.is_empty() { power_of_ten(exponent) } else { format!("{} {unit}", power_of_ten(exponent)) }
}

/// Label of an axis or a column: `Displacement amplitude (mm)`. A quotient by time between brackets is
/// written as a product, to avoid brackets within brackets: `(m/s²)/N` as `m s⁻²/N`.
pub fn labelled(label: &str, unit: &str) -> String {
    match (label.is_empty(), unit.is_empty() || unit == "1") {
        (_, true) => label.to_owned(),
        (true, false) => unit.to_owned(),
        (false, false) => format!("{label} ({})", unbracketed(unit)),
    }
}

/// The unit with a quotient by time between brackets written as a product: `(m/s)/N` becomes `m s⁻¹/N`.
fn unbracketed(unit: &str) -> String {
    const PRODUCTS: [(&str, &str); 4] =
        [("/s)²", "² s⁻²"), ("/s²)²", "² s⁻⁴"), ("/s)", " s⁻¹"), ("/s²)", " s⁻²")];
    let product = PRODUCTS.iter().find(|(quotient, _)| unit.contains(quotient));
    product
        .map_or(unit.to_owned(), |(quotient, product)| unit.replacen('(', "", 1).replace(quotient, product))
}

/// Rounds to `places` decimals; to tens, hundreds, … where `places` is negative.
fn rounded(value: f64, places: i32) -> String {
    if places >= 0 {
        return fixed(value, places as usize);
    }
    let unit = 10f64.powi(-places);
    fixed((value / unit).round() * unit, 0)
}

/// Exponent of ten of the first digit, after `value` is rounded to `digits` significant digits.
fn decade(value: f64, digits: usize) -> i32 {
    scientific(value, digits).1
}

fn scientific(value: f64, digits: usize) -> (String, i32) {
    let text = format!("{:.*e}", digits.max(1) - 1, value);
    match text.split_once('e') {
        Some((mantissa, exponent)) => (mantissa.to_owned(), exponent.parse().unwrap_or(0)),
        None => (text, 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_uncertainty_has_two_digits_and_sets_those_of_the_value() {
        assert_eq!(estimate(5.583_4, Some(0.012)), "5.583 ± 0.012");
        assert_eq!(estimate(5.583_4, Some(0.099_6)), "5.58 ± 0.10");
        assert_eq!(estimate(149_876.0, Some(2_345.0)), "149900 ± 2300");
        assert_eq!(estimate(0.0, Some(3.0)), "0.0 ± 3.0");
        assert_eq!(estimate(-0.04, Some(2.0)), "0.0 ± 2.0");
        assert_eq!(estimate(0.211_2, Some(0.0)), "0.21120");
        assert_eq!(estimate(2.0 - 4e-14, Some(7.8e-31)), "2.000000000 ± 7.8×10⁻³¹");
        assert_eq!(estimate(29.999_986, Some(0.000_052)), "29.999986 ± 0.000052");
        assert_eq!(estimate(f64::NAN, Some(1.0)), "–");
        assert_eq!(estimate(25.0e6, Some(0.4e6)), "(25.00 ± 0.40)×10⁶");
    }

    #[test]
    fn numbers_have_a_true_minus_and_no_negative_zero() {
        assert_eq!(fixed(-0.04, 1), "0.0");
        assert_eq!(fixed(-1.25, 2), "−1.25");
        assert_eq!(significant(-6.9e9, 3), "−6.90×10⁹");
        assert_eq!(significant(0.21117, 3), "0.211");
        assert_eq!(significant(f64::NEG_INFINITY, 3), "−∞");
        assert_eq!(power_of_ten(-120), "10⁻¹²⁰");
        assert_eq!(power_of_ten(456_789), "10⁴⁵⁶⁷⁸⁹");
    }

    #[test]
    fn numbers_in_a_text_are_set_as_numbers() {
        for (text, set) in [
            ("-10 dB", "−10 dB"),
            ("R 0.75 + 1e-3, where rest begins", "R 0.75 + 10⁻³, where rest begins"),
            ("-2.5e8 N/m", "−2.5×10⁸ N/m"),
            ("soft-corrected form", "soft-corrected form"),
            ("a level of inf, e-mail", "a level of inf, e-mail"),
        ] {
            assert_eq!(typeset(text), set);
        }
    }

    #[test]
    fn prefixes_go_only_where_they_may() {
        assert_eq!(scaled_unit("m", -3), "mm");
        assert_eq!(scaled_unit("m/s²", -6), "µm/s²");
        assert_eq!(scaled_unit("(m/s²)/N", -3), "(mm/s²)/N");
        assert_eq!(scaled_unit("m/s²", 3), "10³ m/s²");
        assert_eq!(scaled_unit("N/m", 3), "kN/m");
        assert_eq!(scaled_unit("kg", -3), "g");
        assert_eq!(scaled_unit("kg", -6), "mg");
        assert_eq!(scaled_unit("N s", -3), "mN s");
        assert_eq!(scaled_unit("m²/Hz", -6), "10⁻⁶ m²/Hz");
        assert_eq!(scaled_unit("mm", 3), "10³ mm");
        assert_eq!(scaled_unit("1", -3), "10⁻³");
        assert_eq!(scaled_unit("m", 21), "10²¹ m");
        assert_eq!(scaled_unit("", 0), "");
    }

    #[test]
    fn engineering_powers_leave_ordinary_numbers_alone() {
        let cases = [(0.5, 0), (9_999.0, 0), (10_000.0, 3), (0.02, -3), (0.099_9, -3), (3e-7, -9), (0.0, 0)];
        for (value, power) in cases {
            assert_eq!(engineering(value), power, "{value}");
        }
        assert_eq!(engineering(f64::INFINITY), 0);
    }

    #[test]
    fn labels_carry_their_unit() {
        assert_eq!(labelled("Frequency", "Hz"), "Frequency (Hz)");
        assert_eq!(labelled("Accelerance", "(m/s²)/N"), "Accelerance (m s⁻²/N)");
        assert_eq!(labelled("Mobility", "10⁻³ (m/s)/N"), "Mobility (10⁻³ m s⁻¹/N)");
        assert_eq!(labelled("Density", "(m/s²)²/Hz"), "Density (m² s⁻⁴/Hz)");
        assert_eq!(labelled("Density", "(m/s)²/Hz"), "Density (m² s⁻²/Hz)");
        assert_eq!(labelled("Ratio", "(m/(s A))/N"), "Ratio ((m/(s A))/N)");
        assert_eq!(labelled("Coherence", "1"), "Coherence");
    }

    #[test]
    fn decimals_do_not_trail_zeros() {
        assert_eq!(decimals_needed(5.5, 5), 1);
        assert_eq!(decimals_needed(60.0, 5), 0);
        assert_eq!(decimals_needed(0.012_345_678, 5), 6);
        assert_eq!(decimals_needed(1.0 / 3.0, 5), 5);
    }
}
