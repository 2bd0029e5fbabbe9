//! The bundled font: its bytes, how wide a text is in it, and the outlines of its glyphs.

use std::fmt::Write as _;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// The font, `DejaVu Sans` reduced to the glyphs a figure needs; licence in `assets/LICENSE-DejaVu.txt`.
pub(super) const BYTES: &[u8] = include_bytes!("assets/DejaVuSans.ttf");

/// Families in the order in which a viewer shall try them.
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

/// The text; where it is wider than `room`, cut and ended by an ellipsis.
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
    let face = face();
    text.chars().map(move |c| {
        let advance = face.as_ref().and_then(|face| {
            let units = face.glyph_hor_advance(face.glyph_index(c)?)?;
            Some(f64::from(units) / f64::from(face.units_per_em()))
        });
        (c, advance.unwrap_or(1.0))
    })
}

/// The glyphs of a text beside each other as path data of SVG, in em, y downwards. A character that the font
/// lacks is the box that the font has for it.
pub(super) fn outlines(text: &str) -> String {
    let Some(face) = face() else { return String::new() };
    let mut path = Outline { data: String::new(), left: 0.0, em: f64::from(face.units_per_em()) };
    for (c, advance) in advances(text) {
        face.outline_glyph(face.glyph_index(c).unwrap_or(GlyphId(0)), &mut path);
        path.left += advance;
    }
    path.data
}

/// The parsed font.
fn face() -> Option<Face<'static>> {
    Face::parse(BYTES, 0).ok()
}

/// Path data of glyphs.
struct Outline {
    data: String,
    /// Where the glyph begins, in em.
    left: f64,
    /// Units of the font in an em.
    em: f64,
}

impl Outline {
    /// Adds a command of a path with its points.
    fn step(&mut self, letter: char, points: &[(f32, f32)]) {
        self.data.push(letter);
        for (x, y) in points {
            let (x, y) = (self.left + f64::from(*x) / self.em, -f64::from(*y) / self.em);
            let _ = write!(self.data, "{x:.5} {y:.5} ");
        }
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.step('M', &[(x, y)]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.step('L', &[(x, y)]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.step('Q', &[(x1, y1), (x, y)]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.step('C', &[(x1, y1), (x2, y2), (x, y)]);
    }

    fn close(&mut self) {
        self.step('Z', &[]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use resvg::usvg;

    /// Advances in 1/2048 em as fontTools reads them from the table `hmtx` of the font.
    #[test]
    fn widths_are_sums_of_the_advances_in_the_font() {
        for (text, units) in [("H", 1540), ("0", 1303), ("−", 1716), ("₁", 821), ("ζ", 1114), ("−H0ζ₁", 6494)]
        {
            assert_eq!(width(text, 2048.0), f64::from(units), "{text}");
        }
    }

    /// The box of the glyph H in 1/2048 em, as fontTools reads it from the table `glyf`: 201 to 1339 across,
    /// 0 to 1493 upwards; the zero before it reaches 1520.
    #[test]
    fn outlines_stand_behind_one_another() {
        let svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><path transform='translate(0 2)' d='{}'/></svg>",
            outlines("0H")
        );
        let tree = usvg::Tree::from_str(&svg, &usvg::Options::default()).unwrap();
        let around = tree.root().abs_bounding_box();
        let em = |units: f32| units / 2048.0;
        assert!((around.right() - em(1303.0 + 1339.0)).abs() < 1e-4, "{around:?}");
        assert!((2.0 - around.top() - em(1520.0)).abs() < 1e-4, "{around:?}");
    }

    #[test]
    fn every_glyph_a_figure_writes_is_there() {
        let face = face().unwrap();
        for c in "0123456789−+×±·°≤≥√⁰¹²³⁴⁵⁶⁷⁸⁹⁻₀₁₂₃₄₅₆₇₈₉Ωωφζνµ→…".chars()
        {
            assert!(face.glyph_index(c).is_some(), "{c}");
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
