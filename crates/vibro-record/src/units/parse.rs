//! Grammar of unit texts: `product := number? factor (('*' | '·' | ' ' | '/') factor)*`, `factor := atom power?`,
//! `atom := '(' product ')' | 'sqrt(' product ')' | '√' factor | '1' | symbol`.
//!
//! A number before a product is a factor, as in `100 mV/g`. A negative exponent behind `/` is not understood: whoever
//! writes `m/s-2` may mean either power.

use super::Dimension;
use std::iter::Peekable;
use std::str::Chars;

/// Symbols with their dimension (m, kg, s, A, K, rad; not doubled), factor to SI, and whether a prefix may stand before them.
const SYMBOLS: &[(&str, [i8; 6], f64, bool)] = &[
    ("m", [1, 0, 0, 0, 0, 0], 1.0, true),
    ("s", [0, 0, 1, 0, 0, 0], 1.0, true),
    ("sec", [0, 0, 1, 0, 0, 0], 1.0, true),
    ("Sec", [0, 0, 1, 0, 0, 0], 1.0, false),
    ("min", [0, 0, 1, 0, 0, 0], 60.0, false),
    ("kg", [0, 1, 0, 0, 0, 0], 1.0, false),
    ("Kg", [0, 1, 0, 0, 0, 0], 1.0, false),
    ("g", [1, 0, -2, 0, 0, 0], 9.806_65, true),
    ("gn", [1, 0, -2, 0, 0, 0], 9.806_65, false),
    ("g_n", [1, 0, -2, 0, 0, 0], 9.806_65, false),
    ("N", [1, 1, -2, 0, 0, 0], 1.0, true),
    ("lbf", [1, 1, -2, 0, 0, 0], 4.448_221_615_260_5, false),
    ("Pa", [-1, 1, -2, 0, 0, 0], 1.0, true),
    ("bar", [-1, 1, -2, 0, 0, 0], 1e5, true),
    ("J", [2, 1, -2, 0, 0, 0], 1.0, true),
    ("W", [2, 1, -3, 0, 0, 0], 1.0, true),
    ("A", [0, 0, 0, 1, 0, 0], 1.0, true),
    ("V", [2, 1, -3, -1, 0, 0], 1.0, true),
    ("Hz", [0, 0, -1, 0, 0, 0], 1.0, true),
    ("cps", [0, 0, -1, 0, 0, 0], 1.0, false),
    ("rpm", [0, 0, -1, 0, 0, 0], 1.0 / 60.0, false),
    ("K", [0, 0, 0, 0, 1, 0], 1.0, false),
    ("in", [1, 0, 0, 0, 0, 0], 0.0254, false),
    ("inch", [1, 0, 0, 0, 0, 0], 0.0254, false),
    ("ips", [1, 0, -1, 0, 0, 0], 0.0254, false),
    ("mil", [1, 0, 0, 0, 0, 0], 2.54e-5, false),
    ("ft", [1, 0, 0, 0, 0, 0], 0.3048, false),
    ("rad", [0, 0, 0, 0, 0, 1], 1.0, false),
    ("deg", [0, 0, 0, 0, 0, 1], std::f64::consts::PI / 180.0, false),
    ("°", [0, 0, 0, 0, 0, 1], std::f64::consts::PI / 180.0, false),
    ("%", [0, 0, 0, 0, 0, 0], 0.01, false),
];

const PREFIXES: &[(char, f64)] = &[
    ('p', 1e-12),
    ('n', 1e-9),
    ('u', 1e-6),
    ('µ', 1e-6),
    ('μ', 1e-6),
    ('m', 1e-3),
    ('c', 1e-2),
    ('d', 1e-1),
    ('k', 1e3),
    ('K', 1e3),
    ('M', 1e6),
    ('G', 1e9),
];

/// How deep parentheses may nest: units never do, hostile input might.
const MAX_DEPTH: usize = 16;

type Parsed = (Dimension, f64);

/// Dimension and factor of a unit text, `None` where any part is unknown.
pub fn parse(text: &str) -> Option<Parsed> {
    let text = text.trim();
    let text = text.strip_prefix('[').and_then(|t| t.strip_suffix(']')).unwrap_or(text).trim();
    if text.is_empty() {
        return None;
    }
    if text == "-" {
        return Some((Dimension::NONE, 1.0));
    }
    let mut chars = text.chars().peekable();
    let result = product(&mut chars, 0)?;
    (chars.next().is_none() && result.1.is_finite() && result.1 > 0.0).then_some(result)
}

fn product(chars: &mut Peekable<Chars>, depth: usize) -> Option<Parsed> {
    if depth > MAX_DEPTH {
        return None;
    }
    let number = number(chars);
    // A number may touch its unit, as in `100mV`.
    let (mut total, mut blank, mut alone) = match number {
        Some(number) => ((Dimension::NONE, number), true, number != 1.0),
        None => (factor(chars, depth, false)?, false, false),
    };
    loop {
        while chars.next_if(|c| c.is_whitespace()).is_some() {
            blank = true;
        }
        let divide = match chars.peek() {
            None | Some(')') => return Some(total).filter(|_| !alone),
            Some('*' | '·' | '⋅' | '×') => false,
            Some('/') => true,
            Some(_) if blank => {
                total = combine(total, factor(chars, depth, false)?, false);
                (blank, alone) = (false, false);
                continue;
            }
            Some(_) => return None,
        };
        chars.next();
        while chars.next_if(|c| c.is_whitespace()).is_some() {}
        total = combine(total, factor(chars, depth, divide)?, divide);
        (blank, alone) = (false, false);
    }
}

fn combine(a: Parsed, b: Parsed, divide: bool) -> Parsed {
    if divide { (a.0.times(b.0.inverse()), a.1 / b.1) } else { (a.0.times(b.0), a.1 * b.1) }
}

/// A real number such as `10` or `2.5e-3`, where one begins.
fn number(chars: &mut Peekable<Chars>) -> Option<f64> {
    let mut text = String::new();
    let digits = |chars: &mut Peekable<Chars>, text: &mut String| {
        let before = text.len();
        while let Some(c) = chars.next_if(char::is_ascii_digit) {
            text.push(c);
        }
        text.len() > before
    };
    if !digits(chars, &mut text) {
        return None;
    }
    if chars.next_if_eq(&'.').is_some() {
        text.push('.');
        digits(chars, &mut text);
    }
    // The letter may also begin a symbol.
    let (mut ahead, mut exponent) = (chars.clone(), String::from("e"));
    if ahead.next_if(|c| matches!(c, 'e' | 'E')).is_some() {
        exponent.extend(ahead.next_if(|c| matches!(c, '-' | '+')));
        if digits(&mut ahead, &mut exponent) {
            *chars = ahead;
            text.push_str(&exponent);
        }
    }
    text.parse().ok()
}

/// An atom with its exponent; `below` says that it stands right behind a `/`.
fn factor(chars: &mut Peekable<Chars>, depth: usize, below: bool) -> Option<Parsed> {
    if depth > MAX_DEPTH {
        return None;
    }
    let base = match chars.peek()? {
        '(' => {
            chars.next();
            let inner = product(chars, depth + 1)?;
            chars.next_if_eq(&')')?;
            inner
        }
        '√' => {
            chars.next();
            return root(factor(chars, depth + 1, below)?);
        }
        '1' => {
            // Digits behind it would be another number, not its exponent.
            chars.next();
            return Some((Dimension::NONE, 1.0));
        }
        _ => {
            let mut name = String::new();
            while let Some(c) = chars.next_if(|c| c.is_alphabetic() || matches!(c, '%' | '°' | '_')) {
                name.push(c);
            }
            if name.eq_ignore_ascii_case("sqrt") || name.eq_ignore_ascii_case("rt") {
                chars.next_if_eq(&'(')?;
                let inner = product(chars, depth + 1)?;
                chars.next_if_eq(&')')?;
                return root(inner);
            }
            symbol(&name)?
        }
    };
    Some(match power(chars)? {
        2 => base,
        halves if below && halves < 0 => return None,
        halves => (base.0.half_power(halves)?, base.1.powf(f64::from(halves) / 2.0)),
    })
}

fn root(inner: Parsed) -> Option<Parsed> {
    Some((inner.0.half_power(1)?, inner.1.sqrt()))
}

/// The exponent that follows an atom, doubled; 2 where there is none.
fn power(chars: &mut Peekable<Chars>) -> Option<i8> {
    let mut text = String::new();
    if chars.next_if_eq(&'^').is_some() {
        let bracket = chars.next_if_eq(&'(').is_some();
        while let Some(c) = chars.next_if(|c| c.is_ascii_digit() || matches!(c, '-' | '.')) {
            text.push(c);
        }
        if bracket {
            chars.next_if_eq(&')')?;
        }
        if text.is_empty() {
            return None;
        }
    } else if chars.peek().is_some_and(|c| c.is_ascii_digit() || *c == '-') {
        // `m/s2` and `m s-2`: a digit that follows a symbol is its exponent.
        while let Some(c) = chars.next_if(|c| c.is_ascii_digit() || *c == '-') {
            text.push(c);
        }
    } else {
        while let Some(c) = chars.next_if(|c| "⁻⁰¹²³⁴⁵⁶⁷⁸⁹".contains(*c)) {
            text.push(match c {
                '⁻' => '-',
                '¹' => '1',
                '²' => '2',
                '³' => '3',
                other => char::from_digit(other as u32 - '⁰' as u32, 10)?,
            });
        }
    }
    if text.is_empty() {
        return Some(2);
    }
    let doubled = text.parse::<f64>().ok()? * 2.0;
    (doubled.fract() == 0.0 && doubled.abs() <= 12.0).then_some(doubled as i8)
}

fn symbol(name: &str) -> Option<Parsed> {
    let find = |name: &str| SYMBOLS.iter().find(|s| s.0 == name);
    if let Some(s) = find(name) {
        return Some((Dimension(s.1.map(|e| 2 * e)), s.2));
    }
    let mut rest = name.chars();
    let first = rest.next()?;
    let (_, scale) = PREFIXES.iter().find(|p| p.0 == first)?;
    let s = find(rest.as_str()).filter(|s| s.3)?;
    Some((Dimension(s.1.map(|e| 2 * e)), s.2 * scale))
}

/// Spelling of a dimension without a name: base units with exponents, e.g. `m²·s⁻³`.
pub(crate) fn spell(dimension: Dimension) -> String {
    let names = ["m", "kg", "s", "A", "K", "rad"];
    let parts: Vec<String> = names
        .iter()
        .zip(dimension.0)
        .filter(|(_, e)| *e != 0)
        .map(|(name, e)| match e {
            2 => (*name).to_owned(),
            e if e % 2 == 0 => format!("{name}^{}", e / 2),
            e => format!("{name}^{:.1}", f64::from(e) / 2.0),
        })
        .collect();
    if parts.is_empty() { "1".to_owned() } else { parts.join("·") }
}

#[cfg(test)]
mod tests {
    use super::super::{Quantity, Unit};

    fn check(text: &str, quantity: Quantity, factor: f64) {
        let unit = Unit::parse(text).unwrap_or_else(|| panic!("{text} not understood"));
        assert_eq!(unit.quantity(), quantity, "{text}");
        assert!((unit.factor() / factor - 1.0).abs() < 1e-15, "{text}: {} against {factor}", unit.factor());
    }

    #[test]
    fn spellings_seen_in_exports() {
        check("mm/s", Quantity::Velocity, 1e-3);
        check("m/s²", Quantity::Acceleration, 1.0);
        check("m/s2", Quantity::Acceleration, 1.0);
        check("m/s^2", Quantity::Acceleration, 1.0);
        check("m/s/s", Quantity::Acceleration, 1.0);
        check("m s^-2", Quantity::Acceleration, 1.0);
        check("m s⁻²", Quantity::Acceleration, 1.0);
        check("µm", Quantity::Displacement, 1e-6);
        check("um", Quantity::Displacement, 1e-6);
        check("g", Quantity::Acceleration, 9.80665);
        check("mg", Quantity::Acceleration, 9.80665e-3);
        check("(m/s²)/N", Quantity::Accelerance, 1.0);
        check("(1/N)*(m/s²)", Quantity::Accelerance, 1.0);
        check("(m/s)/N", Quantity::Mobility, 1.0);
        check("mm/N", Quantity::Receptance, 1e-3);
        check("1/kg", Quantity::Accelerance, 1.0);
        check("kHz", Quantity::Frequency, 1e3);
        check("(Sec)", Quantity::Time, 1.0);
        check("[mV]", Quantity::Voltage, 1e-3);
        check("-", Quantity::Ratio, 1.0);
        check("rpm", Quantity::Frequency, 1.0 / 60.0);
    }

    /// A turn is 2π rad, so an angular velocity is no frequency.
    #[test]
    fn angles_are_not_numbers() {
        check("rad", Quantity::Angle, 1.0);
        check("rad/s", Quantity::AngularVelocity, 1.0);
        check("deg/s", Quantity::AngularVelocity, std::f64::consts::PI / 180.0);
        check("°", Quantity::Angle, std::f64::consts::PI / 180.0);
        check("rad/s²", Quantity::AngularAcceleration, 1.0);
        check("1/s", Quantity::Frequency, 1.0);
        check("cps", Quantity::Frequency, 1.0);
        check("rpm", Quantity::Frequency, 1.0 / 60.0);
        assert_eq!(Unit::parse("deg/s").unwrap().si().symbol(), "rad/s");
        assert_eq!(Unit::parse("rad/s").unwrap().times_seconds(1), Unit::of(Quantity::Angle));
        assert_eq!(Unit::parse("m/rad").unwrap().si().symbol(), "m·rad^-1");
        // 360° a second is one turn a second; two roundings.
        assert!((Unit::parse("deg/s").unwrap().hertz().unwrap() * 360.0 - 1.0).abs() < 1e-15);
        assert_eq!(Unit::parse("m/s").unwrap().hertz(), None);
    }

    #[test]
    fn a_number_before_a_product_is_a_factor() {
        check("100 mV", Quantity::Voltage, 0.1);
        check("100mV", Quantity::Voltage, 0.1);
        check("10 mm/s", Quantity::Velocity, 0.01);
        check("2.5e-3 m", Quantity::Displacement, 2.5e-3);
        check("1e3*N", Quantity::Force, 1e3);
        check("1", Quantity::Ratio, 1.0);
        check("m/1", Quantity::Displacement, 1.0);
        let sensitivity = Unit::parse("100 mV/g").unwrap();
        assert_eq!(sensitivity.dimension(), Unit::parse("V/g").unwrap().dimension());
        // Two products and a quotient, each rounded by half an ulp.
        assert!((sensitivity.factor() * 9.806_65 / 0.1 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn densities_have_half_exponents() {
        let psd = Unit::parse("g²/Hz").unwrap();
        assert!((psd.factor() - 9.80665f64.powi(2)).abs() < 1e-12);
        let asd = Unit::parse("m/s/√Hz").unwrap();
        assert_eq!(asd.dimension(), Unit::parse("m/s/sqrt(Hz)").unwrap().dimension());
        assert_eq!(asd.dimension(), Unit::parse("m/s/Hz^0.5").unwrap().dimension());
    }

    #[test]
    fn unknown_texts_are_not_guessed() {
        for text in [
            "",
            "EU",
            "m//s",
            "(m",
            "m)",
            "m/s^99",
            "dB",
            "furlong",
            "m^",
            "sqrt(sqrt(m))",
            "m/s-2",
            "m/s^-2",
            "m/s⁻²",
            "m/√Hz-1",
            "1-2",
            "1²",
            "12",
            "(100)/s",
            "100",
            "0 m",
            "1e999 m",
            "m/12",
            "m 10",
            "1.5.2 m",
            "(((((((((((((((((((m",
        ] {
            assert!(Unit::parse(text).is_none(), "{text:?} was read as {:?}", Unit::parse(text));
        }
    }

    #[test]
    fn si_spelling_of_a_nameless_dimension() {
        assert_eq!(Unit::parse("mm^2").unwrap().si().symbol(), "m^2");
        assert_eq!(Unit::of(Quantity::Velocity).times_seconds(1), Unit::of(Quantity::Displacement));
    }
}
