//! The comment in wave files that this crate writes: exact sampling rate, start time and full scales, for
//! which the format has no fields.

use crate::number;
use std::fmt;

/// First line of the comment.
const MARK: &str = "vibroimpact";

/// Exact sampling rate, start time and full scale of each channel.
///
/// ```text
/// vibroimpact
/// rate 65535.98 Hz
/// start 0.5 s
/// full scale 16 m/s of velocity        one line per channel: factor, unit, name
/// ```
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scales {
    /// Sampling rate in Hz; the format itself stores a whole number.
    pub rate: f64,
    /// Time of the first sample in s.
    pub start: f64,
    /// Full scale of each channel.
    pub channels: Vec<Scale>,
}

/// Full scale of a channel: the physical value of a stored sample of 1.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scale {
    /// Physical value in `unit`, above 0.
    pub factor: f64,
    /// The unit.
    pub unit: String,
    /// Name of the channel.
    pub name: String,
}

impl Scales {
    /// Reads the comment; `None` for any other text.
    pub fn parse(text: &str) -> Option<Scales> {
        let mut lines = text.lines();
        if lines.next()?.trim() != MARK {
            return None;
        }
        let rate = lines.next()?.strip_prefix("rate ")?.strip_suffix(" Hz")?;
        let start = lines.next()?.strip_prefix("start ")?.strip_suffix(" s")?;
        let channels = lines.map(scale).collect::<Option<Vec<Scale>>>()?;
        let rate = number::parse(rate.as_bytes()).filter(|r| *r > 0.0)?;
        Some(Scales { rate, start: number::parse(start.as_bytes())?, channels })
    }
}

/// Reads the line of one channel.
fn scale(line: &str) -> Option<Scale> {
    let (factor, rest) = line.strip_prefix("full scale ")?.split_once(' ')?;
    let (unit, name) = rest.split_once(" of ")?;
    let factor = number::parse(factor.as_bytes()).filter(|f| *f > 0.0)?;
    Some(Scale { factor, unit: unit.to_owned(), name: name.to_owned() })
}

impl fmt::Display for Scales {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{MARK}\nrate {} Hz\nstart {} s", self.rate, self.start)?;
        for Scale { factor, unit, name } in &self.channels {
            // Control characters would end the line or the comment.
            let [unit, name] = [unit, name].map(|text| text.replace(char::is_control, " "));
            write!(f, "\nfull scale {factor} {unit} of {name}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_written_is_read(
            rate in 1e-3..1e9, start in -1e3..1e3, factor in 1e-300..1e300, name in "[ -~µ²]{0,20}", n in 1usize..4,
        ) {
            let scale = Scale { factor, unit: "(m/s²)/N".into(), name };
            let scales = Scales { rate, start, channels: vec![scale; n] };
            prop_assert_eq!(Scales::parse(&scales.to_string()), Some(scales));
        }

        #[test]
        fn never_panics(text in any::<String>()) {
            let _ = Scales::parse(&format!("{MARK}\n{text}"));
        }
    }

    #[test]
    fn other_comments_are_not_taken() {
        for text in [
            "",
            "recorded by hand",
            "vibroimpact\nrate 0 Hz\nstart 0 s",
            "vibroimpact\nrate 1 Hz\nstart 0 s\nx",
        ] {
            assert_eq!(Scales::parse(text), None, "{text:?}");
        }
    }
}
