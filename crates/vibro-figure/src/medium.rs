//! Media for which a figure is drawn.

use crate::canvas::Element;
use crate::colour::{Rgb, SERIES};
use crate::{Drawing, Figure, Heatmap};
use resvg::tiny_skia::PremultipliedColorU8;

/// Medium in which a figure is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Medium {
    /// A report or a screen: as wide as the figure asks, in colour.
    #[default]
    Report,
    /// A column of a journal: 86 mm wide, panels one below the other, in grey.
    Paper,
    /// A projected slide: as in a report, enlarged with its text.
    Slide,
}

/// Width of a column of a journal in mm.
const COLUMN: f64 = 86.0;

/// Scale of a figure on a slide: 8 pt become 13 pt.
const LARGER: f64 = 1.6;

impl Figure {
    /// Draws the figure for a medium.
    pub fn draw_for(&self, medium: Medium) -> Drawing {
        match medium {
            Medium::Report => self.draw(),
            Medium::Slide => {
                let drawing = self.draw();
                Drawing { scale: LARGER, ..drawing }
            }
            Medium::Paper => self.in_column().draw().grey(),
        }
    }

    /// The figure in one column, panels one below the other. All have the same ratio of height to width: that
    /// of the figure divided evenly into its panels, limited to 0.75 to 1.1.
    fn in_column(&self) -> Figure {
        if self.width <= COLUMN {
            return self.clone();
        }
        let (columns, panels) = (self.columns.clamp(1, self.panels.len().max(1)), self.panels.len().max(1));
        let ratio = (self.height / panels.div_ceil(columns) as f64) / (self.width / columns as f64);
        let height = panels as f64 * COLUMN * ratio.clamp(0.75, 1.1);
        Figure { width: COLUMN, height, columns: 1, ..self.clone() }
    }
}

impl Drawing {
    /// The drawing in grey. In maps of a quantity the grey follows the brightness of the colours; series
    /// and classes have distinct levels.
    fn grey(mut self) -> Drawing {
        let to_grey = |colour: &mut Rgb| {
            let level = grey([colour.0, colour.1, colour.2]);
            *colour = Rgb(level, level, level);
        };
        for element in &mut self.canvas.elements {
            match element {
                Element::Shape { fill, pen, .. } => {
                    if let Some(fill) = fill {
                        to_grey(fill);
                    }
                    if let Some(pen) = pen {
                        to_grey(&mut pen.colour);
                    }
                }
                Element::Text(text) => to_grey(&mut text.colour),
            }
        }
        for image in &mut self.canvas.images {
            for pixel in image.pixels.pixels_mut() {
                let level = grey([pixel.red(), pixel.green(), pixel.blue()]);
                *pixel =
                    PremultipliedColorU8::from_rgba(level, level, level, pixel.alpha()).unwrap_or(*pixel);
            }
        }
        self
    }
}

/// Grey level of each colour of a series, 0 (black) to 255. Series with neighbouring numbers differ widely.
const LEVELS: [u8; 7] = [50, 135, 95, 170, 200, 225, 0];

/// The grey level of a colour, 0 to 255: a colour of a series or class has the level of its number, others
/// their luma (ITU-R BT.601).
fn grey([r, g, b]: [u8; 3]) -> u8 {
    let places = SERIES.into_iter().zip(LEVELS).chain((0..).map(Heatmap::class_colour).zip(LEVELS));
    if let Some((_, level)) = places.into_iter().find(|(colour, _)| *colour == Rgb(r, g, b)) {
        return level;
    }
    (0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AxisSpec, Plot, Series};

    fn figure() -> Figure {
        let line = Series::line("a # of 00ff00", [0.0, 1.0], [0.0, 1.0]);
        let plot = || Plot::new(AxisSpec::new("x", "s"), AxisSpec::new("y", "m")).with(line.clone());
        Figure::double("two").columns(2).height(60.0).panel(plot()).panel(plot())
    }

    #[test]
    fn a_column_has_its_panels_under_one_another_in_grey() {
        let drawn = figure().draw_for(Medium::Paper);
        assert_eq!(drawn.size, (86.0, 2.0 * 0.75 * 86.0));
        let svg = drawn.svg();
        let colours = svg.split("=\"#").skip(1).map(|part| &part[..6]);
        assert!(
            colours.clone().all(|c| c[..2] == c[2..4] && c[2..4] == c[4..]) && colours.count() > 2,
            "{svg}"
        );
    }

    #[test]
    fn greys_of_series_and_classes_are_apart() {
        for colours in [SERIES.to_vec(), (0..SERIES.len()).map(Heatmap::class_colour).collect()] {
            let mut levels: Vec<u8> = colours.iter().map(|c| grey([c.0, c.1, c.2])).collect();
            levels.sort_unstable();
            assert!(levels.windows(2).all(|pair| pair[1] - pair[0] >= 20), "{levels:?}");
        }
    }

    #[test]
    fn a_slide_is_the_same_picture_larger() {
        let (report, slide) = (figure().draw_for(Medium::Report), figure().draw_for(Medium::Slide));
        assert_eq!(report.canvas, slide.canvas);
        let wide = |drawing: &Drawing| {
            drawing.svg().split("width=\"").nth(1).and_then(|w| w.split("mm").next()?.parse::<f64>().ok())
        };
        assert!((wide(&slide).unwrap() - 1.6 * wide(&report).unwrap()).abs() < 0.011);
    }
}
