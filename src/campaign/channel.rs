//! Channels in a campaign: by name, or by number from 1.

use serde::{Deserialize, Deserializer};

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a channel by its name between quotes, or by its number from 1")]
enum Channel {
    Name(String),
    Number(u32),
}

impl Channel {
    /// As readers take it.
    fn text(self) -> String {
        match self {
            Channel::Name(name) => name,
            Channel::Number(number) => number.to_string(),
        }
    }
}

/// A channel.
///
/// # Errors
/// If it is neither a name nor a number.
pub fn one<'de, D: Deserializer<'de>>(from: D) -> Result<Option<String>, D::Error> {
    Channel::deserialize(from).map(|channel| Some(channel.text()))
}

/// Channels.
///
/// # Errors
/// If one is neither a name nor a number.
pub fn several<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<String>, D::Error> {
    Vec::<Channel>::deserialize(from).map(|all| all.into_iter().map(Channel::text).collect())
}
