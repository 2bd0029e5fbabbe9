//! Cells that people read as numbers but programs do not: digits followed by a unit, a unit prefix or a
//! printed power of ten.

use crate::number;
use vibro_record::units::Unit;

/// Unit prefixes that instruments print as factors after a number: `839.06m` is 0.83906.
const PREFIXES: [(&str, i32); 9] =
    [("p", -12), ("n", -9), ("u", -6), ("µ", -6), ("μ", -6), ("m", -3), ("k", 3), ("M", 6), ("G", 9)];

/// The number at the start of a cell, and the text after it.
fn behind(cell: &str) -> Option<(&str, &str)> {
    let used =
        [b'.', b','].iter().filter_map(|mark| Some(number::prefix(cell.as_bytes(), *mark)?.1)).max()?;
    Some((cell.get(..used)?, cell.get(used..)?.trim_start()))
}

/// The unit after the number in a cell, if it is a known one.
pub fn unit_of(cell: &str) -> Option<&str> {
    let (_, unit) = behind(cell)?;
    Unit::parse(unit).filter(|_| unit.starts_with(|c: char| c.is_alphabetic() || c == '%')).map(|_| unit)
}

/// Hint on how to export a cell whose digits are followed by a unit prefix or a power of ten.
pub fn plain_form(cell: &str) -> Option<String> {
    let (digits, text) = behind(cell)?;
    let prefix = || PREFIXES.iter().find(|(prefix, _)| *prefix == text).map(|(_, power)| power.to_string());
    let power = || {
        let power = text.trim_start_matches(['·', '×', 'x', '*', '⋅']).trim_start();
        power.strip_prefix("10^").filter(|power| power.parse::<i32>().is_ok()).map(str::to_owned)
    };
    let power = prefix().or_else(power)?;
    Some(format!("export plain or scientific numbers, such as {digits}e{power} for {cell}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_behind_digits_are_named_as_numbers_can_be_written() {
        let form = |cell: &str| plain_form(cell).unwrap_or_default();
        assert!(form("839.06m").contains("839.06e-3 for 839.06m"), "{}", form("839.06m"));
        assert!(form("1,6928·10^-1").contains("1,6928e-1"), "{}", form("1,6928·10^-1"));
        assert!(form("2 x 10^3").contains("2e3"));
        for other in ["abc", "1.5", "1.5V", "3 mV", "2·10^a"] {
            assert_eq!(plain_form(other), None, "{other}");
        }
        assert_eq!((unit_of("839.06 mV"), unit_of("1.5"), unit_of("x")), (Some("mV"), None, None));
    }
}
