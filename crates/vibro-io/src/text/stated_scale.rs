//! Scale factors, gains and sensitivities that a header states.

use crate::number;

/// A factor of the values that the header states.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedScale {
    /// Value as written, preceded by its key unless the key is a plain scale factor.
    pub said: String,
    /// Whether it is a sensitivity or gain of a sensor's signal. Values in a unit of motion or force
    /// already include it.
    pub of_signal: bool,
}

/// Keys of a scale factor (`SCALE`), and of a sensitivity or gain of a sensor's signal (`OF_SIGNAL`).
const SCALE: &str = "slope|scale factor|scaling factor|multiplier|multiplikator|multiplicator|scale|skalierung|faktor|factor|\
                     conversion factor|umrechnungsfaktor";
const OF_SIGNAL: &str = "sensitivity|sensor sensitivity|transducer sensitivity|empfindlichkeit|sensibilité|sensibilità|sensibilidad|\
                         gain|verstärkung|amplification|amplifier gain|gain factor|voltage divider|spannungsteiler|divider|\
                         calibration factor|kalibrierfaktor|cal factor|sens|calibration|attenuation|dämpfung";

impl StatedScale {
    /// Whether a key is one of a factor, with or without the name of a channel.
    pub fn is_key(key: &str) -> bool {
        let key = of_any_channel(key);
        SCALE.split('|').chain(OF_SIGNAL.split('|')).any(|known| known == key)
    }

    /// The factor in the value of a key, if one of its numbers differs from 1 or it is a quotient of units
    /// such as `1 V/g`.
    pub fn of(key: &str, value: &str) -> Option<StatedScale> {
        let key = of_any_channel(key);
        let words: Vec<&str> =
            value.split([';', ' ']).map(str::trim).filter(|word| !word.is_empty()).collect();
        let first = number::either(words.first()?.trim_matches(['x', 'X', '×', '*']).as_bytes());
        let quotient = first.is_some() && words.iter().any(|word| word.contains('/'));
        let other =
            |word: &&str| number::either(word.as_bytes().trim_ascii()).is_some_and(|factor| factor != 1.0);
        // A gain of 0 is in dB and changes nothing.
        let none = first == Some(0.0);
        let states =
            !none && (quotient || first.is_some_and(|factor| factor != 1.0) || words.iter().any(other));
        let plain = matches!(&*key, "slope" | "scale factor" | "scaling factor");
        let said = if plain { value.to_owned() } else { format!("{key}: {value}") };
        let of_signal = quotient || OF_SIGNAL.split('|').any(|known| known == key);
        states.then_some(StatedScale { said, of_signal })
    }
}

/// A key without its channel: `sensitivity` for `ch1 sensitivity` and `sensitivity channel 2`.
fn of_any_channel(key: &str) -> String {
    let channel = |word: &&str| {
        let name = word.trim_end_matches(|c: char| c.is_ascii_digit());
        !matches!(name, "" | "ch" | "channel" | "kanal" | "canal" | "voie" | "ai")
    };
    key.split_whitespace().filter(channel).collect::<Vec<_>>().join(" ")
}
