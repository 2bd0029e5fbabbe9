//! Grammar of unit texts: `product := factor (('*' | '·' | ' ' | '/') factor)*`, `factor := atom power?`,
//! `atom := '(' product ')' | 'sqrt(' product ')' | '√' factor | '1' | symbol`.

use super::Dimension;
use std::iter::Peekable;
use std::str::Chars;

/// Symbols with their dimension (m, kg, s, A, K; not doubled), factor to SI, and whether a prefix may stand before them.
const SYMBOLS: &[(&str, [i8; 5], f64, bool)] = &[
    ("m", [1, 0, 0, 0, 0], 1.0, true),
    ("s", [0, 0, 1, 0, 0], 1.0, true),
    ("sec", [0, 0, 1, 0, 0], 1.0, true),
    ("Sec", [0, 0, 1, 0, 0], 1.0, false),
    ("min", [0, 0, 1, 0, 0], 60.0, false),
    ("kg", [0, 1, 0, 0, 0], 1.0, false),
    ("Kg", [0, 1, 0, 0, 0], 1.0, false),
    ("g", [1, 0, -2, 0, 0], 9.806_65, true),
    ("gn", [1, 0, -2, 0, 0], 9.806_65, false),
    ("g_n", [1, 0, -2, 0, 0], 9.806_65, false),
    ("N", [1, 1, -2, 0, 0], 1.0, true),
    ("lbf", [1, 1, -2, 0, 0], 4.448_221_615_260_5, false),
    ("Pa", [-1, 1, -2, 0, 0], 1.0, true),
    ("bar", [-1, 1, -2, 0, 0], 1e5, true),
    ("J", [2, 1, -2, 0, 0], 1.0, true),
    ("W", [2, 1, -3, 0, 0], 1.0, true),
    ("A", [0, 0, 0, 1, 0], 1.0, true),
    ("V", [2, 1, -3, -1, 0], 1.0, true),
    ("Hz", [0, 0, -1, 0, 0], 1.0, true),
    ("rpm", [0, 0, -1, 0, 0], 1.0 / 60.0, false),
    ("K", [0, 0, 0, 0, 1], 1.0, false),
    ("in", [1, 0, 0, 0, 0], 0.0254, false),
    ("inch", [1, 0, 0, 0, 0], 0.0254, false),
    ("ips", [1, 0, -1, 0, 0], 0.0254, false),
    ("mil", [1, 0, 0, 0, 0], 2.54e-5, false),
    ("ft", [1, 0, 0, 0, 0], 0.3048, false),
    ("rad", [0, 0, 0, 0, 0], 1.0, false),
    ("deg", [0, 0, 0, 0, 0], std::f64::consts::PI / 180.0, false),
    ("°", [0, 0, 0, 0, 0], std::f64::consts::PI / 180.0, false),
    ("%", [0, 0, 0, 0, 0], 0.01, false),
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
    let mut total = factor(chars, depth)?;
    loop {
        let mut blank = false;
        while chars.next_if(|c| c.is_whitespace()).is_some() {
            blank = true;
        }
        let divide = match chars.peek() {
            None | Some(')') => return Some(total),
            Some('*' | '·' | '⋅' | '×') => false,
            Some('/') => true,
            Some(_) if blank => {
                total = combine(total, factor(chars, depth)?, false);
                continue;
            }
            Some(_) => return None,
        };
        chars.next();
        while chars.next_if(|c| c.is_whitespace()).is_some() {}
        total = combine(total, factor(chars, depth)?, divide);
    }
}

fn combine(a: Parsed, b: Parsed, divide: bool) -> Parsed {
    if divide { (a.0.times(b.0.inverse()), a.1 / b.1) } else { (a.0.times(b.0), a.1 * b.1) }
}

fn factor(chars: &mut Peekable<Chars>, depth: usize) -> Option<Parsed> {
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
            return root(factor(chars, depth + 1)?);
        }
        '1' => {
            chars.next();
            (Dimension::NONE, 1.0)
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
pub fn spell(dimension: Dimension) -> String {
    let names = ["m", "kg", "s", "A", "K"];
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
