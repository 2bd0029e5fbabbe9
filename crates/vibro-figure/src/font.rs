//! The bundled font: its bytes, and how wide a text is in it.

use std::collections::HashMap;
use std::sync::OnceLock;

/// The font, `DejaVu Sans` reduced to the glyphs a figure needs; licence in `assets/LICENSE-DejaVu.txt`.
pub(super) const BYTES: &[u8] = include_bytes!("assets/DejaVuSans.ttf");

/// Its name.
pub(super) const NAME: &str = "DejaVu Sans";

/// Families in the order in which a viewer shall try them.
pub(super) const FAMILY: &str = "DejaVu Sans, Helvetica, Arial, sans-serif";

/// Height of the digits in em; half of it centres a line of text on a tick.
pub(super) const DIGIT_HEIGHT: f64 = 0.73;

/// Width of a text in the unit of `size`.
///
/// The bundled font has no kerning, so this is the sum of the advances. A character that it lacks counts one
/// em.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let advances = advances();
    size * text.chars().map(|c| advances.get(&c).copied().unwrap_or(1.0)).sum::<f64>()
}

/// The text, cut with an ellipsis where it is wider than `room`.
pub(super) fn fit(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut kept = String::new();
    let mut used = width("…", size);
    for c in text.chars() {
        used += width(c.encode_utf8(&mut [0; 4]), size);
        if used > room {
            break;
        }
        kept.push(c);
    }
    kept.truncate(kept.trim_end().len());
    kept.push('…');
    kept
}

/// Advance in em of every character of the font.
fn advances() -> &'static HashMap<char, f64> {
    static TABLE: OnceLock<HashMap<char, f64>> = OnceLock::new();
    TABLE.get_or_init(|| read_advances(BYTES).unwrap_or_default())
}

/// Reads the tables `head`, `hhea`, `hmtx` and a `cmap` of format 4 (OpenType 1.9, chapters of the same
/// names).
fn read_advances(font: &[u8]) -> Option<HashMap<char, f64>> {
    let units = f64::from(u16_at(table(font, *b"head")?, 18)?);
    let metrics = u16_at(table(font, *b"hhea")?, 34)?;
    let hmtx = table(font, *b"hmtx")?;
    let cmap = table(font, *b"cmap")?;
    let count = usize::from(u16_at(cmap, 2)?);
    let map = (0..count).find_map(|i| {
        let offset = u32::from(u16_at(cmap, 8 + 8 * i)?) << 16 | u32::from(u16_at(cmap, 10 + 8 * i)?);
        cmap.get(offset as usize..).filter(|t| u16_at(t, 0) == Some(4))
    })?;
    let double = usize::from(u16_at(map, 6)?);
    let mut table = HashMap::new();
    for segment in (0..double).step_by(2) {
        let end = u16_at(map, 14 + segment)?;
        let start = u16_at(map, 16 + double + segment)?;
        let delta = u16_at(map, 16 + 2 * double + segment)?;
        let at = 16 + 3 * double + segment;
        let range = usize::from(u16_at(map, at)?);
        for code in start..=end.min(0xFFFE) {
            let glyph = if range == 0 {
                code.wrapping_add(delta)
            } else {
                match u16_at(map, at + range + 2 * usize::from(code - start))? {
                    0 => 0,
                    glyph => glyph.wrapping_add(delta),
                }
            };
            let advance = u16_at(hmtx, 4 * usize::from(glyph.min(metrics.saturating_sub(1))))?;
            if let (Some(c), true) = (char::from_u32(u32::from(code)), glyph != 0) {
                table.insert(c, f64::from(advance) / units);
            }
        }
    }
    Some(table)
}

fn table(font: &[u8], tag: [u8; 4]) -> Option<&[u8]> {
    let count = usize::from(u16_at(font, 4)?);
    let entry = (0..count).map(|i| 12 + 16 * i).find(|&at| font.get(at..at + 4) == Some(&tag[..]))?;
    let word = |at| Some(usize::from(u16_at(font, at)?) << 16 | usize::from(u16_at(font, at + 2)?));
    let start = word(entry + 8)?;
    font.get(start..start + word(entry + 12)?)
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_be_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use resvg::usvg;

    /// The width usvg's own shaper gives a text, from the distance by which it moves a following box.
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
            // The shaper's own floats are single precision: a few units in 1e4.
            assert!((ours - theirs).abs() < 0.02, "{text}: {ours} against {theirs}");
        }
    }

    #[test]
    fn every_glyph_a_figure_writes_is_there() {
        for c in "0123456789−+×±·°≤≥√⁰¹²³⁴⁵⁶⁷⁸⁹⁻₀₁₂₃₄₅₆₇₈₉Ωωφζνµ→…".chars()
        {
            assert!(advances().contains_key(&c), "{c}");
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
