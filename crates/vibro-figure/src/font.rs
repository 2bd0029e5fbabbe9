//! The bundled font: its data, and the width of texts in it.

use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};

/// The font, `DejaVu Sans` reduced to the glyphs a figure needs; licence in `assets/LICENSE-DejaVu.txt`.
pub(super) const BYTES: &[u8] = include_bytes!("assets/DejaVuSans.ttf");

/// Name of the font.
pub(super) const NAME: &str = "DejaVu Sans";

/// Font families in the order in which a viewer tries them.
pub(super) const FAMILY: &str = "DejaVu Sans, Helvetica, Arial, sans-serif";

/// Height of the digits in em; half of it centres a line of text on a tick.
pub(super) const DIGIT_HEIGHT: f64 = 0.73;

/// Width of a text in the unit of `size`.
///
/// The bundled font has no kerning, so this is the sum of the advances. A character that it lacks counts as 1
/// em.
pub(super) fn width(text: &str, size: f64) -> f64 {
    size * advances(text).map(|(_, advance)| advance).sum::<f64>()
}

/// The text, cut with an ellipsis where it is wider than `room`.
pub(super) fn fit(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut used = width("…", size);
    let kept = advances(text).take_while(|(_, advance)| {
        used += size * advance;
        used <= room
    });
    let kept: String = kept.map(|(c, _)| c).collect();
    format!("{}…", kept.trim_end())
}

/// Every character with its advance in em.
fn advances(text: &str) -> impl Iterator<Item = (char, f64)> {
    let font = FontRef::new(BYTES).ok();
    let tables =
        font.map(|font| (font.charmap(), font.glyph_metrics(Size::new(1.0), LocationRef::default())));
    text.chars().map(move |c| {
        let advance = tables.as_ref().and_then(|(glyphs, metrics)| metrics.advance_width(glyphs.map(c)?));
        (c, advance.map_or(1.0, f64::from))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use resvg::usvg;

    /// Width of a text by usvg's own shaper, from the distance by which it moves a box that follows.
    fn shaped(text: &str) -> f64 {
        let mut options = usvg::Options::default();
        options.fontdb_mut().load_font_data(BYTES.to_vec());
        let end = |t: &str| {
            let svg = format!(
                "<svg xmlns='http://www.w3.org/2000/svg' width='9999' height='99'><text x='0' y='50' xml:space='preserve' font-family='DejaVu Sans' font-size='100'>{t}H</text></svg>"
            );
            let tree = usvg::Tree::from_str(&svg, &options).unwrap();
            f64::from(tree.root().abs_bounding_box().right())
        };
        end(text) - end("")
    }

    #[test]
    fn widths_are_those_of_the_shaper() {
        for text in
            ["Frequency (Hz)", "−12.5", "10⁻³", "AVAToy", "ζ = 0.021 ± 0.003", "x₁ ≤ √2 × µm", "Größe"]
        {
            let (ours, theirs) = (width(text, 100.0), shaped(text));
            // The shaper uses single precision: a few units in 1e4.
            assert!((ours - theirs).abs() < 0.02, "{text}: {ours} against {theirs}");
        }
    }

    #[test]
    fn every_glyph_a_figure_writes_is_there() {
        let font = FontRef::new(BYTES).unwrap();
        for c in "0123456789−+×±·°≤≥√⁰¹²³⁴⁵⁶⁷⁸⁹⁻₀₁₂₃₄₅₆₇₈₉Ωωφζνµ→…".chars()
        {
            assert!(font.charmap().map(c).is_some(), "{c}");
        }
    }

    #[test]
    fn a_text_too_wide_is_cut() {
        let cut = fit("a long name of a channel", 8.0, 60.0);
        assert!(cut.ends_with('…') && width(&cut, 8.0) <= 60.0, "{cut}");
        assert_eq!(fit("short", 8.0, 60.0), "short");
        assert_eq!(fit("x", 8.0, -1.0), "…");
    }
}
