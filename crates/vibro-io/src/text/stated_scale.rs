//! Factors of the values that a header states: scale factors, gains, sensitivities.

use crate::number;

/// A factor of the values, as the header states it.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedScale {
    /// As written, with its key unless that is a plain scale factor.
    pub said: String,
    /// Whether it is a sensitivity or gain of a sensor's signal: values in a unit of motion or force include
    /// it already.
    pub of_signal: bool,
}

/// Keys of a factor of the values (`SCALE`), and of one of a sensor's signal (`OF_SIGNAL`).
const SCALE: &str = "slope|scale factor|scaling factor|multiplier|multiplikator|multiplicator|scale|skalierung|faktor|factor|\
                     conversion factor|umrechnungsfaktor";
const OF_SIGNAL: &str = "sensitivity|sensor sensitivity|transducer sensitivity|empfindlichkeit|sensibilité|sensibilità|sensibilidad|\
                         gain|verstärkung|amplification|amplifier gain|gain factor|voltage divider|spannungsteiler|divider|\
                         calibration factor|kalibrierfaktor|cal factor|sens|calibration|attenuation|dämpfung";

impl StatedScale {
    /// Whether a key is that of a factor, with or without the name of a channel.
    pub fn is_key(key: &str) -> bool {
        let key = of_any_channel(key);
        SCALE.split('|').chain(OF_SIGNAL.split('|')).any(|known| known == key)
    }

    /// The factor in the value of a key, if one of its numbers is not 1 or it is a quotient of units,
    /// such as `1 V/g`.
    pub fn of(key: &str, value: &str) -> Option<StatedScale> {
        let key = of_any_channel(key);
        let words: Vec<&str> =
            value.split([';', ' ']).map(str::trim).filter(|word| !word.is_empty()).collect();
        let first = number::either(words.first()?.trim_matches(['x', 'X', '×', '*']).as_bytes());
        let quotient = first.is_some() && words.iter().any(|word| word.contains('/'));
        let other =
            |word: &&str| number::either(word.as_bytes().trim_ascii()).is_some_and(|factor| factor != 1.0);
        // A gain of 0 (dB) changes nothing.
        let none = first == Some(0.0);
        let states =
            !none && (quotient || first.is_some_and(|factor| factor != 1.0) || words.iter().any(other));
        let plain = matches!(&*key, "slope" | "scale factor" | "scaling factor");
        let said = if plain { value.to_owned() } else { format!("{key}: {value}") };
        let of_signal = quotient || OF_SIGNAL.split('|').any(|known| known == key);
        states.then_some(StatedScale { said, of_signal })
    }
}

/// A key without its channel: `ch1 sensitivity`, `sensitivity channel 2`.
fn of_any_channel(key: &str) -> String {
    let channel = |word: &&str| {
        let name = word.trim_end_matches(|c: char| c.is_ascii_digit());
        !matches!(name, "" | "ch" | "channel" | "kanal" | "canal" | "voie" | "ai")
    };
    key.split_whitespace().filter(channel).collect::<Vec<_>>().join(" ")
}
