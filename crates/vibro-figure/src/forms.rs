//! Series as drawing primitives on the page.

use crate::style::{MARKER, OUTLINE, SMALL, SeriesLook};
use crate::{
    Anchor, Canvas, Clutter, Marker, Pen, Place, Point, Rect, Rgb, Series, Shape, WHITE, clipped, font,
    thinned,
};

/// A drawing primitive: a part of a series, with all coordinates on the page in points.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Form {
    /// Open lines with one pen.
    Lines(Vec<Vec<Point>>, Pen),
    /// Closed areas with a fill and an outline.
    Areas(Vec<Vec<Point>>, Rgb, Option<Pen>),
    /// Markers of one shape, half width in points and colour.
    Markers(Vec<Point>, Marker, f64, Rgb),
}

/// The drawing primitives of a series, the lowest first.
pub(super) fn forms(series: &Series, look: SeriesLook, place: &Place<'_>) -> Vec<Form> {
    let frame = place.frame;
    let line = |from: Point, to: Point| vec![Form::Lines(clipped(&[from, to], frame), look.pen)];
    match series.shape {
        Shape::Heading => Vec::new(),
        Shape::Line => vec![Form::Lines(curve(series, place), look.pen)],
        Shape::Points => {
            let joined = series.stroke.map(|_| Form::Lines(curve(series, place), look.pen));
            let bars = Form::Lines(error_bars(series, place), Pen::solid(look.colour, OUTLINE));
            let places = series.x.iter().zip(&series.y).map(|(x, y)| place.at(*x, *y));
            let points: Vec<Point> = places.filter(|p| frame.grown(EDGE).contains(*p)).collect();
            // Many markers are drawn smaller, down to half size, so that they stay apart.
            let size = MARKER * (60.0 / points.len().max(1) as f64).sqrt().clamp(0.5, 1.0);
            joined.into_iter().chain([bars, Form::Markers(points, look.marker, size, look.colour)]).collect()
        }
        Shape::Band => vec![Form::Areas(band(series, place), look.fill, None)],
        Shape::Bars => {
            let outline = Pen { width: OUTLINE, ..look.pen };
            vec![Form::Areas(bars(series, place), look.fill, Some(outline))]
        }
        Shape::Vertical => {
            let x = series.x.first().map_or(f64::NAN, |at| place.across(place.x.at(*at)));
            line((x, frame.y), (x, frame.bottom()))
        }
        Shape::Horizontal => {
            let y = series.y.first().map_or(f64::NAN, |at| place.up(place.y.at(*at)));
            line((frame.x, y), (frame.right(), y))
        }
    }
}

/// Distance in points by which rounding may put a point outside its frame.
const EDGE: f64 = 0.01;

impl Form {
    /// Draws the primitive.
    pub fn draw(&self, canvas: &mut Canvas) {
        match self {
            Form::Lines(parts, pen) => canvas.lines(parts, *pen),
            Form::Areas(parts, fill, outline) => canvas.areas(parts, *fill, *outline),
            Form::Markers(points, marker, size, colour) => markers(canvas, points, *marker, *size, *colour),
        }
    }

    /// Adds the lines and boxes of the primitive, which texts must not cover.
    pub fn add_to(&self, clutter: &mut Clutter) {
        match self {
            Form::Lines(parts, _) => clutter.add_lines(parts),
            Form::Areas(parts, ..) => {
                for part in parts {
                    clutter.add_lines(std::slice::from_ref(part));
                    // Chords across the area make texts avoid its inside, too.
                    let half = part.len() / 2;
                    let chords = part.iter().take(half).zip(part.iter().rev()).map(|(a, b)| vec![*a, *b]);
                    clutter.add_lines(&chords.collect::<Vec<_>>());
                }
            }
            Form::Markers(points, _, size, _) => {
                for point in points {
                    clutter.add_box(Rect::around(*point, OPEN * size + 0.5));
                }
            }
        }
    }
}

/// Whether a marker is white inside.
pub(super) fn is_open(marker: Marker) -> bool {
    matches!(marker, Marker::OpenCircle | Marker::Square | Marker::Diamond | Marker::Limit)
}

/// Size ratio of open to filled circles and squares, so that both are visible at the same place.
const OPEN: f64 = 1.3;

/// Draws markers of one shape, half width in points and colour. Open ones are white inside.
pub(super) fn markers(canvas: &mut Canvas, points: &[Point], marker: Marker, size: f64, colour: Rgb) {
    let size = if matches!(marker, Marker::OpenCircle | Marker::Square) { OPEN * size } else { size };
    let polygon = |corners: &[Point]| -> Vec<Vec<Point>> {
        let at = |p: &Point| corners.iter().map(|c| (p.0 + c.0 * size, p.1 + c.1 * size)).collect();
        points.iter().map(at).collect()
    };
    let pen = Pen::solid(colour, OUTLINE);
    let (fill, outline) = if is_open(marker) { (WHITE, Some(pen)) } else { (colour, None) };
    let square = [(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)];
    let plus = [[(-1.2, 0.0), (1.2, 0.0)], [(0.0, -1.2), (0.0, 1.2)]];
    let saltire = [[square[0], square[2]], [square[3], square[1]]];
    let corners: &[Point] = match marker {
        Marker::Circle | Marker::OpenCircle => return canvas.circles(points, size, fill, outline),
        Marker::Square | Marker::FilledSquare => &square,
        Marker::Triangle => &[(0.0, -1.3), (1.2, 0.85), (-1.2, 0.85)],
        Marker::Limit => &[(0.0, 1.3), (1.2, -0.85), (-1.2, -0.85)],
        Marker::Diamond => &[(0.0, -1.3), (1.2, 0.0), (0.0, 1.3), (-1.2, 0.0)],
        Marker::Cross | Marker::Saltire | Marker::Star => {
            let strokes = [plus, saltire].concat();
            let drawn = match marker {
                Marker::Cross => &strokes[..2],
                Marker::Saltire => &strokes[2..],
                _ => &strokes,
            };
            return canvas.lines(&drawn.iter().flat_map(|stroke| polygon(stroke)).collect::<Vec<_>>(), pen);
        }
        Marker::Letter(letter) => {
            for &(x, y) in points {
                let at = (x, y + font::DIGIT_HEIGHT * SMALL / 2.0);
                canvas.label(&letter.to_string(), at, SMALL, Anchor::Middle);
            }
            return;
        }
    };
    canvas.areas(&polygon(corners), fill, outline);
}

/// A curve cut to the frame, thinned to the points that can be seen.
fn curve(series: &Series, place: &Place<'_>) -> Vec<Vec<Point>> {
    let points: Vec<Point> = series.x.iter().zip(&series.y).map(|(x, y)| place.at(*x, *y)).collect();
    clipped(&points, place.frame).iter().map(|part| thinned(part, 0.015)).collect()
}

/// Lower and upper end on the page of each error bar, or of a band at each abscissa.
fn ends(series: &Series, place: &Place<'_>) -> Vec<[Point; 2]> {
    let ends = series.x.iter().zip(series.low.iter().zip(&series.high));
    ends.map(|(x, (low, high))| [(place.at(*x, *low).0, place.up(place.y.at_low(*low))), place.at(*x, *high)])
        .collect()
}

/// Error bars with caps as lines, for the points inside the frame.
fn error_bars(series: &Series, place: &Place<'_>) -> Vec<Vec<Point>> {
    /// Half the width of a cap in points.
    const CAP: f64 = 1.8;
    let inside = place.frame.grown(EDGE);
    let mut lines = Vec::new();
    for ((x, y), bar) in series.x.iter().zip(&series.y).zip(ends(series, place)) {
        let length = bar[0].1 - bar[1].1;
        if !inside.contains(place.at(*x, *y)) || length.is_nan() || length < 0.05 {
            continue;
        }
        lines.extend(clipped(&bar, place.frame));
        let ends = bar.iter().filter(|end| inside.contains(**end));
        lines.extend(ends.map(|e| vec![(e.0 - CAP, e.1), (e.0 + CAP, e.1)]));
    }
    lines
}

/// Whether all points have a place on the page.
fn finite(points: &[Point]) -> bool {
    points.iter().all(|p| p.0.is_finite() && p.1.is_finite())
}

/// Areas of a band, one for each run without missing values.
fn band(series: &Series, place: &Place<'_>) -> Vec<Vec<Point>> {
    let runs = ends(series, place);
    let edge = |run: &[[Point; 2]], end: usize| -> Vec<Point> {
        thinned(&run.iter().map(|ends| place.frame.clamp(ends[end])).collect::<Vec<_>>(), 0.02)
    };
    runs.split(|ends| !finite(ends))
        .filter(|run| run.len() >= 2)
        .map(|run| edge(run, 1).into_iter().chain(edge(run, 0).into_iter().rev()).collect())
        .collect()
}

/// Bars from zero, or from the lower edge where the axis has no zero.
fn bars(series: &Series, place: &Place<'_>) -> Vec<Vec<Point>> {
    let bar = |(edges, height): (&[f64], &f64)| {
        let ends = [(edges[0], 0.0), (edges[0], *height), (edges[1], *height), (edges[1], 0.0)];
        ends.map(|(x, y)| place.at(x, y))
    };
    let bars = series.x.windows(2).zip(&series.y).map(bar).filter(|bar| finite(bar));
    bars.map(|bar| bar.map(|p| place.frame.clamp(p)).to_vec()).collect()
}
