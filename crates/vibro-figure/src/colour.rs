//! Colours that remain distinct for colour-blind readers and on a grey printer.

use serde::{Deserialize, Serialize};

/// A colour in sRGB, 8 bits a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Rgb(pub u8, pub u8, pub u8);

/// Colours of series in their order: the palette of Okabe and Ito (2008), *Color Universal Design*, without
/// its yellow, which is too light for lines on white.
pub const SERIES: [Rgb; 7] = [
    Rgb(0, 114, 178),
    Rgb(213, 94, 0),
    Rgb(0, 158, 115),
    Rgb(204, 121, 167),
    Rgb(230, 159, 0),
    Rgb(86, 180, 233),
    Rgb(0, 0, 0),
];

/// Colour of frames, ticks and text.
pub const BLACK: Rgb = Rgb(0, 0, 0);
/// Colour of reference lines and leaders.
pub(crate) const GREY: Rgb = Rgb(110, 110, 110);
/// Colour of lines that only guide the eye.
pub(crate) const PALE: Rgb = Rgb(205, 205, 205);
/// Colour of the paper.
pub const WHITE: Rgb = Rgb(255, 255, 255);

/// Every sixteenth colour of the map *viridis* (Smith, van der Walt and Firing 2015, released under CC0),
/// in the spelling of colour tables.
#[allow(clippy::unreadable_literal)]
const VIRIDIS: [u32; 17] = [
    0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26818e, 0x21908c, 0x1f9f88,
    0x28ae80, 0x3ebc74, 0x5dc963, 0x82d34c, 0xabdc32, 0xd5e21a, 0xfde725,
];

/// Perceptually uniform map from 0 (dark violet) to 1 (yellow); linear between the tabulated colours, within
/// 8/255 of the original 256. Values outside are clamped, NaN counts as 0.
pub(crate) fn viridis(fraction: f64) -> Rgb {
    let fraction = if fraction.is_nan() { 0.0 } else { fraction.clamp(0.0, 1.0) };
    let at = fraction * (VIRIDIS.len() - 1) as f64;
    let low = (at as usize).min(VIRIDIS.len() - 2);
    let [from, to] = [VIRIDIS[low], VIRIDIS[low + 1]].map(u32::to_be_bytes);
    let mix = |i: usize| mixed(from[i], to[i], at - low as f64);
    Rgb(mix(1), mix(2), mix(3))
}

impl Rgb {
    /// The colour mixed with white: 0 leaves it, 1 gives white.
    pub fn tint(self, white: f64) -> Rgb {
        let mix = |c| mixed(c, 255, white);
        Rgb(mix(self.0), mix(self.1), mix(self.2))
    }
}

impl std::fmt::Display for Rgb {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// A channel between two colours, at a fraction from 0 to 1.
fn mixed(from: u8, to: u8, fraction: f64) -> u8 {
    let (from, to) = (f64::from(from), f64::from(to));
    (from + (to - from) * fraction.clamp(0.0, 1.0)).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance from 0 to 1 (WCAG 2.1, from IEC 61966-2-1).
    fn luminance(colour: Rgb) -> f64 {
        let linear = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(colour.0) + 0.7152 * linear(colour.1) + 0.0722 * linear(colour.2)
    }

    #[test]
    fn the_map_grows_lighter_throughout_and_clamps() {
        let steps: Vec<f64> = (0..=400).map(|i| luminance(viridis(f64::from(i) / 400.0))).collect();
        // Neighbours may round to the same 8-bit colour, or fall back by the rounding of one channel (at most
        // 1/255 of its slope).
        assert!(steps.windows(2).all(|w| w[1] > w[0] - 0.004), "{steps:?}");
        assert!(steps.windows(40).all(|w| w[39] > w[0]), "{steps:?}");
        assert_eq!(viridis(-3.0), viridis(0.0));
        assert_eq!(viridis(f64::INFINITY), Rgb(253, 231, 37));
        assert_eq!(viridis(f64::NAN), viridis(0.0));
    }

    #[test]
    fn series_stand_out_from_paper_and_from_each_other() {
        for (i, a) in SERIES.iter().enumerate() {
            // 3:1 is the least contrast of graphical objects in WCAG 2.1, 1.4.11; for the three lighter
            // colours of the palette, which come last before black, 2:1 is allowed.
            let contrast = 1.05 / (luminance(*a) + 0.05);
            assert!(contrast > if (3..6).contains(&i) { 2.0 } else { 3.0 }, "{a} {contrast}");
            assert!(SERIES[i + 1..].iter().all(|b| a != b));
        }
    }

    #[test]
    fn tints_end_in_white() {
        assert_eq!(Rgb(10, 20, 30).tint(1.0), WHITE);
        assert_eq!(Rgb(10, 20, 30).tint(0.0).to_string(), "#0a141e");
    }
}
