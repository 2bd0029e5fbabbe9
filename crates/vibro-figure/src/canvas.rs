//! The canvas: the only writer of SVG, for paths, texts and images at fixed places.
//!
//! Coordinates are points (1/72 inch) with two decimals, so equal figures give equal bytes. No element refers
//! to another by an id, so any number of pictures can share one page.

use crate::{BLACK, Point, Rect, Rgb, font, png};
use base64::{Engine, engine::general_purpose::STANDARD};
use ndarray::Array2;
use resvg::tiny_skia::{ColorU8, Pixmap};
use std::fmt::Write;
use vibro_record::is_unprintable;

/// Colour, width and dashes of a line; lengths in points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pen {
    pub colour: Rgb,
    pub width: f64,
    /// Lengths of dashes and gaps, in points.
    pub dashes: &'static [f64],
}

impl Pen {
    /// A pen without dashes.
    pub const fn solid(colour: Rgb, width: f64) -> Pen {
        Pen { colour, width, dashes: &[] }
    }
}

/// Which point of a text's baseline lies at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A text with its place and look.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Text {
    pub words: String,
    /// Place of the anchor.
    pub at: Point,
    pub size: f64,
    pub anchor: Anchor,
    /// Rotation in degrees, counter-clockwise.
    pub turn: f64,
    pub colour: Rgb,
    /// Whether a white edge sets it off from the background.
    pub halo: bool,
}

/// A small picture of coloured cells, drawn without smoothing between them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Image {
    pub place: Rect,
    /// Cells row by row from the top, opaque or transparent.
    pub pixels: Pixmap,
}

/// A path or a text, drawn over the images.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Element {
    /// A path.
    Shape { data: String, fill: Option<Rgb>, pen: Option<Pen> },
    /// A text.
    Text(Text),
}

/// Everything drawn so far, in order; images lie under all other elements.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Canvas {
    pub elements: Vec<Element>,
    pub images: Vec<Image>,
}

impl Canvas {
    /// Open lines with one pen.
    pub fn lines(&mut self, parts: &[Vec<Point>], pen: Pen) {
        self.shape(path(parts, false), None, Some(pen));
    }

    /// One straight line.
    pub fn line(&mut self, a: Point, b: Point, pen: Pen) {
        self.lines(&[vec![a, b]], pen);
    }

    /// Closed areas with one fill and, optionally, an outline.
    pub fn areas(&mut self, parts: &[Vec<Point>], fill: Rgb, outline: Option<Pen>) {
        self.shape(path(parts, true), Some(fill), outline);
    }

    /// A rectangle.
    pub fn rect(&mut self, r: Rect, fill: Option<Rgb>, outline: Option<Pen>) {
        self.shape(path(&[r.corners()], true), fill, outline);
    }

    /// Circles of one radius.
    pub fn circles(&mut self, centres: &[Point], radius: f64, fill: Rgb, outline: Option<Pen>) {
        let mut data = String::new();
        for &(x, y) in centres {
            data.push('M');
            pair(&mut data, hundredths(x - radius), hundredths(y));
            let (r, d) = (hundredths(radius), hundredths(2.0 * radius));
            for across in [d, -d] {
                data.push('a');
                pair(&mut data, r, r);
                data.push_str(" 0 1 0 ");
                pair(&mut data, across, 0);
            }
            data.push('z');
        }
        self.shape(data, Some(fill), outline);
    }

    /// Adds a path, unless it is empty.
    fn shape(&mut self, data: String, fill: Option<Rgb>, pen: Option<Pen>) {
        if !data.is_empty() {
            self.elements.push(Element::Shape { data, fill, pen });
        }
    }

    /// An image of cells, row by row from the top; missing cells stay transparent.
    pub fn image(&mut self, place: Rect, cells: &Array2<Option<Rgb>>) {
        let (down, across) = cells.dim();
        let Some(mut pixels) = Pixmap::new(across as u32, down as u32) else { return };
        for (pixel, Rgb(r, g, b)) in
            pixels.pixels_mut().iter_mut().zip(cells).filter_map(|(p, c)| c.map(|c| (p, c)))
        {
            *pixel = ColorU8::from_rgba(r, g, b, 255).premultiply();
        }
        self.images.push(Image { place, pixels });
    }

    /// Plain black text.
    pub fn label(&mut self, words: &str, at: Point, size: f64, anchor: Anchor) {
        self.text(Text { words: words.to_owned(), at, size, anchor, turn: 0.0, colour: BLACK, halo: false });
    }

    /// A text.
    pub fn text(&mut self, text: Text) {
        if !text.words.is_empty() {
            self.elements.push(Element::Text(text));
        }
    }
}

/// How the texts of a document are stored in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Lettering {
    /// As words, shown in a font of the viewer.
    Words,
    /// As outlines of the bundled font.
    Outlines,
}

impl Element {
    /// The element as SVG.
    fn to_svg(&self, lettering: Lettering) -> String {
        match (self, lettering) {
            (Element::Shape { data, fill, pen }, _) => shape(data, *fill, *pen),
            (Element::Text(text), Lettering::Words) => text.words(),
            (Element::Text(text), Lettering::Outlines) => text.outlines(),
        }
    }
}

/// A path as SVG. Lines thinner than 0.7 points have bevelled corners: rounding would not be visible,
/// and long noisy lines have many corners.
fn shape(data: &str, fill: Option<Rgb>, pen: Option<Pen>) -> String {
    let mut look = fill.map(|fill| format!(" fill=\"{fill}\"")).unwrap_or_default();
    if let Some(Pen { colour, width, dashes }) = pen {
        let _ = write!(look, " stroke=\"{colour}\" stroke-width=\"{}\"", decimal(width));
        if !dashes.is_empty() {
            let lengths: Vec<String> = dashes.iter().map(|d| decimal(*d)).collect();
            let _ = write!(look, " stroke-dasharray=\"{}\"", lengths.join(" "));
        }
        look.push_str(if width < 0.7 { " stroke-linejoin=\"bevel\"" } else { "" });
    }
    format!("<path d=\"{data}\"{look}/>\n")
}

/// Width of the white edge of a text in points.
const HALO: f64 = 2.0;

impl Text {
    /// The text as a `text` element.
    fn words(&self) -> String {
        let (x, y) = (decimal(self.at.0), decimal(self.at.1));
        let place = match self.turn {
            0.0 => format!("x=\"{x}\" y=\"{y}\""),
            turn => format!("transform=\"translate({x} {y}) rotate({})\"", decimal(-turn)),
        };
        let anchor = match self.anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let halo = if self.halo {
            format!(" stroke=\"#ffffff\" stroke-width=\"{}\" paint-order=\"stroke\"", decimal(HALO))
        } else {
            String::new()
        };
        let (size, colour, words) = (decimal(self.size), self.colour, escaped(&self.words));
        format!("<text {place} font-size=\"{size}\"{anchor} fill=\"{colour}\"{halo}>{words}</text>\n")
    }

    /// The text as one path in em; the element moves, turns and enlarges it to its place.
    fn outlines(&self) -> String {
        let before = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        };
        let Text { at: (x, y), size, turn, colour, .. } = self;
        let left = -before * font::width(&self.words, *size);
        let place = format!("translate({x} {y}) rotate({}) translate({left} 0) scale({size})", -turn);
        let halo = if self.halo {
            format!(" stroke=\"#ffffff\" stroke-width=\"{}\" paint-order=\"stroke\"", HALO / size)
        } else {
            String::new()
        };
        let data = font::outlines(&self.words);
        format!("<path transform=\"{place}\" d=\"{data}\" fill=\"{colour}\"{halo}/>\n")
    }
}

/// The whole document, laid out for `width` by `height` mm and enlarged by `scale`, with a name for screen
/// readers.
pub(super) fn document(
    (width, height): (f64, f64),
    scale: f64,
    name: &str,
    images: &[Image],
    (elements, lettering): (&[Element], Lettering),
) -> String {
    /// Points in a mm.
    const POINTS: f64 = 72.0 / 25.4;
    let [across, down, w, h] = [width * scale, height * scale, width * POINTS, height * POINTS].map(decimal);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{across}mm\" height=\"{down}mm\" \
         viewBox=\"0 0 {w} {h}\" role=\"img\" aria-label=\"{}\" style=\"background:#ffffff\">\n",
        escaped(name)
    );
    for Image { place, pixels } in images {
        let [x, y, w, h] = [place.x, place.y, place.w, place.h].map(decimal);
        let data = STANDARD.encode(png::encoded(pixels, None));
        let _ = writeln!(
            svg,
            "<image x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" preserveAspectRatio=\"none\" \
             style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{data}\"/>"
        );
    }
    let family = font::FAMILY;
    let body: String = elements.iter().map(|element| element.to_svg(lettering)).collect();
    let _ = writeln!(
        svg,
        "<g fill=\"none\" stroke-linejoin=\"round\" font-family=\"{family}\">\n{body}</g>\n</svg>"
    );
    svg
}

/// Text for use between tags and in attributes. Characters that XML 1.0 forbids (2.2) and control characters
/// become `\u{FFFD}`.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(' '),
            '\u{FFFE}' | '\u{FFFF}' => out.push('\u{FFFD}'),
            c if is_unprintable(c) => out.push('\u{FFFD}'),
            c => out.push(c),
        }
    }
    out
}

/// Path data. After the first point, steps from point to point in whole hundredths of a point, so that
/// rounding does not accumulate.
fn path(parts: &[Vec<Point>], closed: bool) -> String {
    let mut data = String::new();
    for part in parts.iter().filter(|p| p.len() >= 2) {
        let mut before = None;
        for now in part.iter().map(|&(x, y)| (hundredths(x), hundredths(y))) {
            let (step, (x, y)) = before.map_or(('M', (0, 0)), |at| ('l', at));
            if before != Some(now) {
                data.push(step);
                pair(&mut data, now.0 - x, now.1 - y);
            }
            before = Some(now);
        }
        if closed {
            data.push('z');
        }
    }
    data
}

/// A value in whole hundredths.
fn hundredths(value: f64) -> i64 {
    (value * 100.0).round() as i64
}

/// Adds two counts of hundredths, with a blank between where a sign does not separate them.
fn pair(out: &mut String, x: i64, y: i64) {
    number(out, x);
    if y >= 0 {
        out.push(' ');
    }
    number(out, y);
}

/// A value to two decimals.
fn decimal(value: f64) -> String {
    let mut text = String::new();
    number(&mut text, hundredths(value));
    text
}

/// A count of hundredths as a decimal, without leading or trailing zeros.
fn number(out: &mut String, hundredths: i64) {
    let text = (hundredths as f64 / 100.0).to_string();
    let (sign, size) = text.split_at(usize::from(hundredths < 0));
    out.push_str(sign);
    out.push_str(if size.starts_with("0.") { &size[1..] } else { size });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases = [
            (0.0, "0"),
            (1.0, "1"),
            (-0.5, "-.5"),
            (0.04, ".04"),
            (12.345, "12.35"),
            (-3.1, "-3.1"),
            (-0.001, "0"),
        ];
        for (value, text) in cases {
            assert_eq!(decimal(value), text);
        }
        assert_eq!(decimal(f64::NAN), "0");
    }

    #[test]
    fn relative_steps_end_where_the_line_ends() {
        // Steps are a third of a hundredth: rounded one by one, all of them would vanish.
        let line: Vec<Point> = (0..=300).map(|i| (f64::from(i) / 300.0, 0.0)).collect();
        let data = path(&[line], false);
        let sum: f64 =
            data.split('l').skip(1).map(|s| s.split(' ').next().unwrap().parse::<f64>().unwrap()).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{data}");
    }

    #[test]
    fn markup_in_texts_is_only_text() {
        assert_eq!(
            escaped("<a href='x'>&\"\u{1}\u{202e}\n"),
            "&lt;a href=&#39;x&#39;&gt;&amp;&quot;\u{FFFD}\u{FFFD} "
        );
    }
}
