//! Grammar of unit texts: `product := number? factor (('*' | '·' | ' ' | '/') factor)*`, `factor := atom
//! power?`, `atom := '(' product ')' | 'sqrt(' product ')' | '√' factor | '1' | symbol`.
//!
//! A number before a product is a factor, as in `100 mV/g`. A negative exponent after `/` is refused: `m/s-2`
//! may mean either power.

use super::Dimension;
use super::notation::RAISED;

/// Symbols of a unit with their dimension (m, kg, s, A, K, rad; not doubled), factor to SI, and whether they
/// may take a prefix.
const SYMBOLS: &[(&str, [i8; 6], f64, bool)] = &[
    ("m", [1, 0, 0, 0, 0, 0], 1.0, true),
    ("s sec", [0, 0, 1, 0, 0, 0], 1.0, true),
    ("Sec", [0, 0, 1, 0, 0, 0], 1.0, false),
    ("min", [0, 0, 1, 0, 0, 0], 60.0, false),
    ("kg Kg", [0, 1, 0, 0, 0, 0], 1.0, false),
    ("g", [1, 0, -2, 0, 0, 0], 9.806_65, true),
    ("gn g_n", [1, 0, -2, 0, 0, 0], 9.806_65, false),
    ("gal Gal", [1, 0, -2, 0, 0, 0], 1e-2, false),
    ("N", [1, 1, -2, 0, 0, 0], 1.0, true),
    ("lbf lbF", [1, 1, -2, 0, 0, 0], 4.448_221_615_260_5, false),
    ("kgf kgF kp", [1, 1, -2, 0, 0, 0], 9.806_65, false),
    ("Nm", [2, 1, -2, 0, 0, 0], 1.0, true),
    ("Pa", [-1, 1, -2, 0, 0, 0], 1.0, true),
    ("hPa", [-1, 1, -2, 0, 0, 0], 100.0, false),
    ("bar", [-1, 1, -2, 0, 0, 0], 1e5, true),
    ("psi", [-1, 1, -2, 0, 0, 0], 6_894.757_293_168_361, false),
    ("mmHg Torr torr", [-1, 1, -2, 0, 0, 0], 133.322_368_421_052_63, false),
    ("J", [2, 1, -2, 0, 0, 0], 1.0, true),
    ("W", [2, 1, -3, 0, 0, 0], 1.0, true),
    ("A", [0, 0, 0, 1, 0, 0], 1.0, true),
    ("V", [2, 1, -3, -1, 0, 0], 1.0, true),
    ("T", [0, 1, -2, -1, 0, 0], 1.0, false),
    ("mT", [0, 1, -2, -1, 0, 0], 1e-3, false),
    ("µT μT uT", [0, 1, -2, -1, 0, 0], 1e-6, false),
    ("nT", [0, 1, -2, -1, 0, 0], 1e-9, false),
    ("Hz", [0, 0, -1, 0, 0, 0], 1.0, true),
    ("cps", [0, 0, -1, 0, 0, 0], 1.0, false),
    ("rpm RPM Rpm cpm CPM Cpm", [0, 0, -1, 0, 0, 0], 1.0 / 60.0, false),
    ("K", [0, 0, 0, 0, 1, 0], 1.0, false),
    ("in inch", [1, 0, 0, 0, 0, 0], 0.0254, false),
    ("ips IPS", [1, 0, -1, 0, 0, 0], 0.0254, false),
    ("mph", [1, 0, -1, 0, 0, 0], 0.447_04, false),
    ("mil mils", [1, 0, 0, 0, 0, 0], 2.54e-5, false),
    ("ft", [1, 0, 0, 0, 0, 0], 0.3048, false),
    ("rad", [0, 0, 0, 0, 0, 1], 1.0, false),
    ("deg Deg °", [0, 0, 0, 0, 0, 1], std::f64::consts::PI / 180.0, false),
    ("%", [0, 0, 0, 0, 0, 0], 0.01, false),
    ("ε", [0, 0, 0, 0, 0, 0], 1.0, true),
];

/// Letters of a prefix, and its factor.
const PREFIXES: &[(&str, f64)] = &[
    ("p", 1e-12),
    ("n", 1e-9),
    ("uµμ", 1e-6),
    ("m", 1e-3),
    ("c", 1e-2),
    ("d", 1e-1),
    ("kK", 1e3),
    ("M", 1e6),
    ("G", 1e9),
];

/// Units that instruments write in words.
const WORDS: &[(&str, &str)] = &[
    ("metre", "m"),
    ("meter", "m"),
    ("second", "s"),
    ("hertz", "Hz"),
    ("newton", "N"),
    ("pascal", "Pa"),
    ("volt", "V"),
    ("ampere", "A"),
    ("amp", "A"),
];

/// The symbol of a unit that is spelled out: `Newtons` is N, `millivolts` are mV.
pub fn spelled(text: &str) -> Option<String> {
    let lower = text.trim().to_lowercase();
    let word = lower.strip_suffix('s').unwrap_or(&lower);
    let prefixes = [("nano", "n"), ("micro", "µ"), ("milli", "m"), ("kilo", "k"), ("mega", "M"), ("", "")];
    prefixes.iter().find_map(|(prefix, letter)| {
        let (_, symbol) = WORDS.iter().find(|(name, _)| word.strip_prefix(prefix) == Some(name))?;
        Some(format!("{letter}{symbol}"))
    })
}

/// Largest number of brackets and roots in a text, which limits the recursion.
const MAX_BRACKETS: usize = 16;

type Parsed = (Dimension, f64);

/// Dimension and factor to SI of a unit text; `None` if it is not understood.
pub fn parse(text: &str) -> Option<Parsed> {
    let text = text.trim();
    let text = text.strip_prefix('[').and_then(|t| t.strip_suffix(']')).unwrap_or(text).trim();
    if text == "-" {
        return Some((Dimension::NONE, 1.0));
    }
    let whole = spelled(text);
    let mut reader = UnitParser { rest: whole.as_deref().unwrap_or(text), brackets: 0 };
    let unit = reader.product()?;
    (reader.rest.is_empty() && unit.1.is_finite() && unit.1 > 0.0).then_some(unit)
}

/// The text that has not been read yet, and the number of brackets read.
struct UnitParser<'a> {
    rest: &'a str,
    brackets: usize,
}

impl<'a> UnitParser<'a> {
    /// Takes characters as long as they satisfy `fits`.
    fn take(&mut self, fits: impl Fn(char) -> bool) -> &'a str {
        let (taken, rest) = self.rest.split_at(self.rest.find(|c| !fits(c)).unwrap_or(self.rest.len()));
        self.rest = rest;
        taken
    }

    /// Takes one of these characters if it is the next.
    fn one(&mut self, of: &[char]) -> Option<char> {
        let c = self.rest.chars().next().filter(|c| of.contains(c))?;
        self.rest = &self.rest[c.len_utf8()..];
        Some(c)
    }

    fn product(&mut self) -> Option<Parsed> {
        // A number may touch its unit, as in `100mV`; a number alone is no unit.
        let (mut total, mut blank, mut alone) = match self.number() {
            Some(number) => ((Dimension::NONE, number), true, number != 1.0),
            None => (self.factor(false)?, false, false),
        };
        loop {
            blank |= !self.take(char::is_whitespace).is_empty();
            if self.rest.is_empty() || self.rest.starts_with(')') {
                return Some(total).filter(|_| !alone);
            }
            let sign = self.one(&['*', '·', '⋅', '×', '/']);
            if sign.is_none() && !blank {
                return None;
            }
            self.take(char::is_whitespace);
            let divide = sign == Some('/');
            let (dimension, factor) = self.factor(divide)?;
            total = if divide {
                (total.0.times(dimension.inverse()), total.1 / factor)
            } else {
                (total.0.times(dimension), total.1 * factor)
            };
            (blank, alone) = (false, false);
        }
    }

    /// A product up to its closing bracket.
    fn bracketed(&mut self) -> Option<Parsed> {
        self.brackets += 1;
        let inner = (self.brackets <= MAX_BRACKETS).then(|| self.product())??;
        self.one(&[')'])?;
        Some(inner)
    }

    fn number(&mut self) -> Option<f64> {
        let digits = |text: &str| text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let mut end = digits(self.rest);
        if end == 0 {
            return None;
        }
        if self.rest[end..].starts_with('.') {
            end += 1 + digits(&self.rest[end + 1..]);
        }
        // The letter e may also begin a symbol.
        if let Some(power) = self.rest[end..].strip_prefix(['e', 'E']) {
            let unsigned = power.strip_prefix(['-', '+']).unwrap_or(power);
            if digits(unsigned) > 0 {
                end += 1 + power.len() - unsigned.len() + digits(unsigned);
            }
        }
        let (number, rest) = self.rest.split_at(end);
        self.rest = rest;
        number.parse().ok()
    }

    /// A factor; if it is `below` a fraction bar, a negative exponent is refused as ambiguous.
    fn factor(&mut self, below: bool) -> Option<Parsed> {
        let mut name = "";
        let base = if self.one(&['(']).is_some() {
            self.bracketed()?
        } else if self.one(&['√']).is_some() {
            self.brackets += 1;
            return root((self.brackets <= MAX_BRACKETS).then(|| self.factor(below))??);
        } else if self.one(&['1']).is_some() {
            // Digits after the 1 would be part of a number, not an exponent.
            return Some((Dimension::NONE, 1.0));
        } else {
            name = self.take(|c| c.is_alphabetic() || matches!(c, '%' | '°' | '_'));
            if name.eq_ignore_ascii_case("sqrt") || name.eq_ignore_ascii_case("rt") {
                self.one(&['('])?;
                return root(self.bracketed()?);
            }
            symbol(name)?
        };
        match self.power()? {
            2 => Some(base),
            // `ms-2` means metres per square second, since exports do not divide by milliseconds.
            halves if name == "ms" && halves < 0 && !below => {
                Some((symbol("m")?.0.times(symbol("s")?.0.half_power(halves)?), 1.0))
            }
            halves if below && halves < 0 => None,
            halves => Some((base.0.half_power(halves)?, base.1.powf(f64::from(halves) / 2.0))),
        }
    }

    /// Exponent in halves; 2 where none is written.
    fn power(&mut self) -> Option<i8> {
        let text = if self.one(&['^']).is_some() {
            let bracket = self.one(&['(']).is_some();
            let text = self.take(|c| c.is_ascii_digit() || matches!(c, '-' | '.'));
            if bracket {
                self.one(&[')'])?;
            }
            text.to_owned()
        } else {
            // `m/s2` and `m s-2`: a digit after a symbol is its exponent.
            let plain = self.take(|c| c.is_ascii_digit() || c == '-').to_owned();
            let raised = if plain.is_empty() { self.take(|c| c == '⁻' || RAISED.contains(c)) } else { "" };
            let digit = |c| RAISED.chars().zip('0'..='9').find(|(r, _)| *r == c).map_or('-', |(_, d)| d);
            let text = plain + &raised.chars().map(digit).collect::<String>();
            if text.is_empty() {
                return Some(2);
            }
            text
        };
        let doubled = text.parse::<f64>().ok()? * 2.0;
        (doubled.fract() == 0.0 && doubled.abs() <= 12.0).then_some(doubled as i8)
    }
}

fn root(inner: Parsed) -> Option<Parsed> {
    Some((inner.0.half_power(1)?, inner.1.sqrt()))
}

fn symbol(name: &str) -> Option<Parsed> {
    let find = |name: &str| SYMBOLS.iter().find(|s| s.0.split(' ').any(|symbol| symbol == name));
    let prefixed = || {
        // Gs is gauss, MV is millivolts in capitals: a bench has neither gigaseconds nor megavolts.
        let first = name.chars().next().filter(|_| !matches!(name, "Gs" | "MV"))?;
        let (_, scale) = PREFIXES.iter().find(|p| p.0.contains(first))?;
        Some((find(&name[first.len_utf8()..]).filter(|s| s.3)?, *scale))
    };
    let ((_, exponents, factor, _), scale) = find(name).map(|s| (s, 1.0)).or_else(prefixed)?;
    Some((Dimension(exponents.map(|e| 2 * e)), factor * scale))
}

/// Spelling of a dimension without a name: base units with exponents, e.g. `m^2·s^-3`.
pub(crate) fn spell(dimension: Dimension) -> String {
    let names = ["m", "kg", "s", "A", "K", "rad"];
    let power = |e: i8| if e == 2 { String::new() } else { format!("^{}", f64::from(e) / 2.0) };
    let parts = names.into_iter().zip(dimension.0).filter(|(_, e)| *e != 0);
    let parts: Vec<String> = parts.map(|(name, e)| format!("{name}{}", power(e))).collect();
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
        check("ms-1", Quantity::Velocity, 1.0);
        check("ms^-2", Quantity::Acceleration, 1.0);
        check("ms⁻²", Quantity::Acceleration, 1.0);
        check("mph", Quantity::Velocity, 0.44704);
        check("Gal", Quantity::Acceleration, 1e-2);
        check("psi", Quantity::Pressure, 4.448_221_615_260_5 / 0.0254 / 0.0254);
        check("mmHg", Quantity::Pressure, 101_325.0 / 760.0);
        check("µε", Quantity::Ratio, 1e-6);
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

    /// A turn is 2π rad, so an angular velocity is not read as a frequency.
    #[test]
    fn angles_are_not_numbers() {
        check("rad", Quantity::Angle, 1.0);
        check("rad/s", Quantity::AngularVelocity, 1.0);
        check("deg/s", Quantity::AngularVelocity, std::f64::consts::PI / 180.0);
        check("°", Quantity::Angle, std::f64::consts::PI / 180.0);
        check("rad/s²", Quantity::AngularAcceleration, 1.0);
        check("1/s", Quantity::Frequency, 1.0);
        check("cps", Quantity::Frequency, 1.0);
        for text in ["rpm", "RPM", "Rpm", "cpm", "CPM", "Cpm", "1/min"] {
            check(text, Quantity::Frequency, 1.0 / 60.0);
        }
        assert_eq!(Unit::parse("deg/s").unwrap().si().symbol(), "rad/s");
        assert_eq!(Unit::parse("rad/s").unwrap().times_seconds(1), Unit::of(Quantity::Angle));
        assert_eq!(Unit::parse("m/rad").unwrap().si().symbol(), "m·rad^-1");
        // 360°/s is one turn a second; two roundings.
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
