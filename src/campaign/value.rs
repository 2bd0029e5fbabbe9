//! Values that a campaign and a command line write alike: names, channels, a low-pass or none, two numbers.

use serde::de::value::{Error, StrDeserializer};
use serde::{Deserialize, Deserializer};

/// A value by its name, as a campaign writes it between quotes.
///
/// # Errors
/// With the names that are known.
pub fn word<T: for<'a> Deserialize<'a>>(text: &str) -> Result<T, String> {
    T::deserialize(StrDeserializer::<Error>::new(text)).map_err(|e| e.to_string())
}

/// Two numbers with a mark between them: `LO:HI` or `A,B`.
///
/// # Errors
/// With what stands there.
pub fn two<const MARK: char>(typed: &str) -> Result<(f64, f64), String> {
    let expected = || format!("two numbers with {MARK:?} between them");
    let number = |part: &str| part.trim().parse::<f64>().map_err(|_| expected());
    let (a, b) = typed.split_once(MARK).ok_or_else(expected)?;
    Ok((number(a)?, number(b)?))
}

/// A part of a record between two times in s, `FROM:TO`; without one of them to its end or from its
/// beginning.
///
/// # Errors
/// With what stands there.
pub fn part(typed: &str) -> Result<(f64, f64), String> {
    let whole = |text: &str, end: &str| if text.trim().is_empty() { end.to_owned() } else { text.to_owned() };
    match typed.split_once(':') {
        Some((from, to)) if !(from.trim().is_empty() && to.trim().is_empty()) => {
            two::<':'>(&format!("{}:{}", whole(from, "-inf"), whole(to, "inf")))
        }
        _ => Err("two times in s with ':' between them, or one of them and ':'".to_owned()),
    }
}

/// Units that keys of a campaign have, and parts of them as powers of ten.
const UNITS: [(&str, i32); 17] = [
    ("k", 3),
    ("Hz", 0),
    ("kHz", 3),
    ("s", 0),
    ("ms", -3),
    ("us", -6),
    ("µs", -6),
    ("m", 0),
    ("cm", -2),
    ("mm", -3),
    ("N", 0),
    ("kN", 3),
    ("kg", 0),
    ("°", 0),
    ("deg", 0),
    ("%", -2),
    ("m/s", 0),
];

/// The number that is meant by one with its unit, as the value of a key.
pub fn without_unit(key: &str, text: &str) -> Option<f64> {
    let meant = |(unit, decimals): &(&str, i32)| {
        // By its text, so that no digit is lost.
        format!("{}e{decimals}", text.trim().strip_suffix(unit)?.trim_end()).parse().ok()
    };
    // Of other keys a g may be that of an acceleration.
    let grams = key.trim_start_matches('-').contains("mass") || ["m1", "m2"].contains(&key);
    UNITS.iter().find_map(meant).or_else(|| meant(&("g", -3)).filter(|_| grams))
}

/// Low-pass of average and displacement of a drill, or of the instrument of a pulse.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(untagged, expecting = "expected a corner in Hz, or \"none\"")]
pub enum LowPass {
    /// Corner in Hz.
    Corner(f64),
    /// `none`.
    Off(Word),
}

impl LowPass {
    /// The corner in Hz, if there is one.
    pub fn corner(self) -> Option<f64> {
        if let LowPass::Corner(hz) = self { Some(hz) } else { None }
    }

    /// As it is typed.
    ///
    /// # Errors
    /// If it is neither.
    pub fn typed(text: &str) -> Result<LowPass, String> {
        match text {
            "none" => Ok(LowPass::Off(Word::None)),
            _ => text.parse().map(LowPass::Corner).map_err(|_| "a corner in Hz, or none".to_owned()),
        }
    }
}

/// The word for no low-pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Word {
    /// `none`.
    None,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a channel by its name between quotes, or by its number from 1")]
enum ChannelKey {
    Name(String),
    Number(u32),
}

impl ChannelKey {
    /// As readers take it.
    fn text(self) -> String {
        match self {
            ChannelKey::Name(name) => name,
            ChannelKey::Number(number) => number.to_string(),
        }
    }
}

/// A channel: by name, or by number from 1.
///
/// # Errors
/// If it is neither a name nor a number.
pub fn channel<'de, D: Deserializer<'de>>(from: D) -> Result<Option<String>, D::Error> {
    ChannelKey::deserialize(from).map(|channel| Some(channel.text()))
}

/// One name or channel, or a list of them.
///
/// # Errors
/// If one is neither a name nor a number.
pub fn one_or_more<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<String>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged, expecting = "expected a name between quotes, or a list of them")]
    enum Names {
        One(ChannelKey),
        More(Vec<ChannelKey>),
    }
    Ok(match Names::deserialize(from)? {
        Names::One(name) => vec![name.text()],
        Names::More(names) => names.into_iter().map(ChannelKey::text).collect(),
    })
}

/// Channels, likewise.
///
/// # Errors
/// If one is neither a name nor a number.
pub fn channels<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<String>, D::Error> {
    Vec::<ChannelKey>::deserialize(from).map(|all| all.into_iter().map(ChannelKey::text).collect())
}
