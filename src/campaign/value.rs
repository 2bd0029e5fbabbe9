//! Values of the same form in a campaign and on a command line: names, channels, a low-pass or none, two
//! numbers.

use crate::record::{Kind, kind};
use serde::de::value::SeqAccessDeserializer;
use serde::de::{DeserializeOwned, Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize as _, Serializer};
use std::fmt::{self, Formatter};

/// A value by its name, as a campaign writes it between quotes.
///
/// # Errors
/// With the names that are known.
pub fn word<T: DeserializeOwned>(text: &str) -> Result<T, Kind> {
    crate::record::named(text)
}

/// Two numbers with a mark between them: `LO:HI` or `A,B`.
///
/// # Errors
/// If the text is anything else.
pub fn two<const MARK: char>(typed: &str) -> Result<(f64, f64), Kind> {
    kind::pair(typed, MARK)
}

/// Low-pass of the average and the displacement of a drill, or of the instrument that measured a pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LowPass {
    /// Corner in Hz.
    Corner(f64),
    /// `none`.
    Off,
}

/// The values that a low-pass may have.
const LOW_PASS: Kind = Kind::NumberOr("a corner in Hz", "none");

impl LowPass {
    /// The corner in Hz, if there is one.
    pub fn corner(self) -> Option<f64> {
        if let LowPass::Corner(hz) = self { Some(hz) } else { None }
    }

    /// Parses a typed value.
    ///
    /// # Errors
    /// If the text is neither a number nor `none`.
    pub fn typed(text: &str) -> Result<LowPass, Kind> {
        match text {
            "none" => Ok(LowPass::Off),
            _ => kind::number(text).map(LowPass::Corner).map_err(|_| LOW_PASS),
        }
    }
}

impl<'de> Deserialize<'de> for LowPass {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<LowPass, D::Error> {
        of(from, &LOW_PASS.words("\""), |value| match value {
            Scalar::Number(hz) => Some(LowPass::Corner(hz)),
            Scalar::Whole(hz) => Some(LowPass::Corner(hz as f64)),
            Scalar::Text(text) => (text == "none").then_some(LowPass::Off),
        })
    }
}

/// One value as it is read: a text, a whole number or another number.
enum Scalar<'a> {
    Text(&'a str),
    Whole(i64),
    Number(f64),
}

/// Deserializes one value with `make`; `expected` describes it in words.
fn of<'de, D: Deserializer<'de>, T>(
    from: D,
    expected: &str,
    make: impl Fn(Scalar<'_>) -> Option<T>,
) -> Result<T, D::Error> {
    struct One<'e, F>(&'e str, F);
    impl<T, F: Fn(Scalar<'_>) -> Option<T>> Visitor<'_> for One<'_, F> {
        type Value = T;

        fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
            f.write_str(self.0)
        }

        fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
            (self.1)(Scalar::Text(text)).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
        }

        fn visit_i64<E: Error>(self, number: i64) -> Result<T, E> {
            (self.1)(Scalar::Whole(number)).ok_or_else(|| E::invalid_value(Unexpected::Signed(number), &self))
        }

        fn visit_f64<E: Error>(self, number: f64) -> Result<T, E> {
            (self.1)(Scalar::Number(number)).ok_or_else(|| E::invalid_value(Unexpected::Float(number), &self))
        }
    }
    from.deserialize_any(One(expected, make))
}

/// A channel in the form that readers take, a name or a number as text.
struct ChannelKey(String);

impl<'de> Deserialize<'de> for ChannelKey {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<ChannelKey, D::Error> {
        of(from, "a channel by its name between quotes, or by its number from 1", |value| match value {
            Scalar::Text(name) => Some(ChannelKey(name.to_owned())),
            Scalar::Whole(number) => (number >= 0).then(|| ChannelKey(number.to_string())),
            Scalar::Number(_) => None,
        })
    }
}

/// A channel: by name, or by number from 1.
///
/// # Errors
/// If it is neither a name nor a number.
pub fn channel<'de, D: Deserializer<'de>>(from: D) -> Result<Option<String>, D::Error> {
    ChannelKey::deserialize(from).map(|channel| Some(channel.0))
}

/// One name or channel, or a list of them.
///
/// # Errors
/// If one is neither a name nor a number.
pub fn one_or_more<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<String>, D::Error> {
    struct Names;
    impl<'de> Visitor<'de> for Names {
        type Value = Vec<String>;

        fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
            f.write_str("a name between quotes, or a list of them")
        }

        fn visit_str<E: Error>(self, name: &str) -> Result<Vec<String>, E> {
            Ok(vec![name.to_owned()])
        }

        fn visit_i64<E: Error>(self, number: i64) -> Result<Vec<String>, E> {
            Ok(vec![number.to_string()])
        }

        fn visit_seq<A: SeqAccess<'de>>(self, all: A) -> Result<Vec<String>, A::Error> {
            channels(SeqAccessDeserializer::new(all))
        }
    }
    from.deserialize_any(Names)
}

/// Writes one name by itself, several as a list: the counterpart of [`one_or_more`].
///
/// # Errors
/// As the serializer's.
pub fn one_or_list<S: Serializer>(names: &[String], to: S) -> Result<S::Ok, S::Error> {
    match names {
        [name] => name.serialize(to),
        names => names.serialize(to),
    }
}

/// A list of channels.
///
/// # Errors
/// If one is neither a name nor a number.
pub fn channels<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<String>, D::Error> {
    Vec::<ChannelKey>::deserialize(from).map(|all| all.into_iter().map(|channel| channel.0).collect())
}
