//! Sizes and pens of all figures, in points at print size.

use crate::{BLACK, GREY, Ink, Marker, PALE, Pen, Rgb, Series, Shape, Stroke, WHITE, colour};

/// Size of numbers at ticks, names in legends, notes.
pub(super) const SMALL: f64 = 8.0;
/// Size of the names of axes and panels.
pub(super) const LARGE: f64 = 9.0;
/// Distance from one line of small text to the next.
pub(super) const LEADING: f64 = 11.0;
/// Length of long ticks; short ones are half as long.
pub(super) const TICK: f64 = 3.6;
/// Smallest distance between elements that must not touch.
pub(super) const GAP: f64 = 3.0;
/// Depth of letters such as g, and of brackets, below the baseline of a large text.
pub(super) const DESCENT: f64 = 2.2;

/// Pens of frames, ticks, leaders of notes, and the floor of a waterfall.
pub(super) const FRAME: Pen = Pen::solid(BLACK, 0.75);
pub(super) const TICKS: Pen = Pen::solid(BLACK, 0.6);
pub(super) const LEADER: Pen = Pen::solid(GREY, 0.5);
pub(super) const FLOOR: Pen = Pen::solid(PALE, 0.4);
/// Widths of data lines, of thin lines, and of outlines and error bars.
pub(super) const LINE: f64 = 1.1;
pub(super) const THIN: f64 = 0.55;
pub(super) const OUTLINE: f64 = 0.8;
/// Half the width of a marker.
pub(super) const MARKER: f64 = 2.1;

/// The look of a series, with every choice made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SeriesLook {
    pub colour: Rgb,
    /// Colour of its areas.
    pub fill: Rgb,
    /// Pen of its line, or of its outline.
    pub pen: Pen,
    pub marker: Marker,
}

/// Completes the looks: each series without a colour of its own takes the next colour, with its dashes and
/// marker.
pub(super) fn looks(series: &[Series]) -> Vec<SeriesLook> {
    use Marker::{Circle, Cross, Diamond, FilledSquare, OpenCircle, Square, Triangle};
    // Line styles and markers by the number of the series' colour, so that series differ without colour, too.
    const STROKES: [Stroke; 4] = [Stroke::Solid, Stroke::Dashed, Stroke::DashDot, Stroke::Dotted];
    const MARKERS: [Marker; 7] = [Circle, Square, Triangle, Diamond, OpenCircle, FilledSquare, Cross];
    let mut next = 0;
    let look = |series: &Series| {
        let palette = |n: usize| (n, colour::SERIES[n % colour::SERIES.len()]);
        let (number, colour) = match series.ink {
            Ink::Auto => palette(next),
            Ink::Nth(n) => palette(n),
            Ink::Grey => (0, GREY),
            Ink::Black => (0, BLACK),
            Ink::White => (0, WHITE),
        };
        next += usize::from(series.ink == Ink::Auto);
        let (stroke, tint) = match series.shape {
            Shape::Line => (STROKES[number % STROKES.len()], 0.0),
            Shape::Points | Shape::Vertical | Shape::Horizontal | Shape::Heading => (Stroke::Thin, 0.0),
            Shape::Band => (Stroke::Solid, 0.72),
            Shape::Bars => (Stroke::Solid, 0.6),
        };
        SeriesLook {
            colour,
            fill: colour.tint(tint),
            pen: pen(colour, series.stroke.unwrap_or(stroke)),
            marker: series.marker.unwrap_or(MARKERS[number % MARKERS.len()]),
        }
    };
    series.iter().map(look).collect()
}

/// The pen of a stroke in a colour.
fn pen(colour: Rgb, stroke: Stroke) -> Pen {
    let dashes: &[f64] = match stroke {
        Stroke::Solid | Stroke::Thin => &[],
        Stroke::Dashed => &[4.5, 2.2],
        Stroke::DashDot => &[6.0, 2.0, 1.2, 2.0],
        Stroke::Dotted => &[1.2, 1.8],
    };
    Pen { colour, width: if stroke == Stroke::Thin { THIN } else { LINE }, dashes }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_series_differ_without_their_colour() {
        let lines: Vec<Series> = (0..4).map(|_| Series::line("", [], [])).collect();
        let points: Vec<Series> = (0..7).map(|_| Series::points("", [], [])).collect();
        let (lines, points) = (looks(&lines), looks(&points));
        for (i, a) in lines.iter().enumerate() {
            assert!(lines[i + 1..].iter().all(|b| a.pen.dashes != b.pen.dashes && a.colour != b.colour));
        }
        for (i, a) in points.iter().enumerate() {
            assert!(points[i + 1..].iter().all(|b| a.marker != b.marker && a.colour != b.colour));
        }
    }

    #[test]
    fn series_that_belong_together_do_not_take_the_next_colour() {
        let series = [
            Series::band("", [], [], []).ink(Ink::Nth(0)),
            Series::line("", [], []),
            Series::vertical("", 0.0),
            Series::line("", [], []),
        ];
        let colours: Vec<Rgb> = looks(&series).iter().map(|l| l.colour).collect();
        assert_eq!(colours, [colour::SERIES[0], colour::SERIES[0], GREY, colour::SERIES[1]]);
    }
}
