//! Series as shapes on the page.

use super::canvas::{Anchor, Canvas, Pen};
use super::clutter::Clutter;
use super::frame::{Place, label};
use super::style::{Look, MARKER, OUTLINE, SMALL};
use crate::axis::Axis;
use crate::colour::{Rgb, WHITE};
use crate::font;
use crate::path::{Point, Rect, clipped, clipped_polygon, thinned};
use crate::series::{Marker, Series, Shape};

/// A part of a series, ready to be drawn.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Form {
    Lines(Vec<Vec<Point>>, Pen),
    Areas(Vec<Vec<Point>>, Rgb),
    Markers(Vec<Point>, Marker, f64, Rgb),
}

/// What a series consists of, the lowest first.
pub(super) fn forms(series: &Series, look: Look, place: &Place<'_>) -> Vec<Form> {
    match &series.shape {
        Shape::Line { x, y, .. } => vec![Form::Lines(curve(x, y, place), look.pen)],
        Shape::Points { x, y, x_error, y_error, joined, .. } => {
            let mut forms = Vec::new();
            if joined.is_some() {
                forms.push(Form::Lines(curve(x, y, place), look.pen));
            }
            forms.push(Form::Lines(
                error_bars(x, y, x_error, y_error, place),
                Pen::solid(look.colour, OUTLINE),
            ));
            let inside = place.frame.grown(0.01);
            let points = x.iter().zip(y).map(|(x, y)| place.at(*x, *y)).filter(|p| inside.contains(*p));
            let points: Vec<Point> = points.collect();
            // Many points are smaller, down to half, so that they stay apart.
            let size = MARKER * (60.0 / points.len().max(1) as f64).sqrt().clamp(0.5, 1.0);
            forms.push(Form::Markers(points, look.marker, size, look.colour));
            forms
        }
        Shape::Band { x, lower, upper } => {
            vec![Form::Areas(band(x, lower, upper, place), look.colour.tint(0.72))]
        }
        Shape::Bars { edges, heights, filled } => bars(edges, heights, *filled, look, place),
        Shape::Vertical { at } => {
            let x = place.across(place.x.at(*at));
            vec![Form::Lines(
                clipped(&[(x, place.frame.y), (x, place.frame.bottom())], place.frame),
                look.pen,
            )]
        }
        Shape::Horizontal { at } => {
            let y = place.up(place.y.at(*at));
            vec![Form::Lines(clipped(&[(place.frame.x, y), (place.frame.right(), y)], place.frame), look.pen)]
        }
    }
}

impl Form {
    pub fn draw(&self, canvas: &mut Canvas) {
        match self {
            Form::Lines(parts, pen) => canvas.lines(parts, *pen),
            Form::Areas(parts, fill) => canvas.areas(parts, *fill, None),
            Form::Markers(points, marker, size, colour) => markers(canvas, points, *marker, *size, *colour),
        }
    }

    /// Enters the form where words must not cover it.
    pub fn enter(&self, clutter: &mut Clutter) {
        match self {
            Form::Lines(parts, _) => clutter.add_lines(parts),
            Form::Areas(parts, _) => {
                for part in parts {
                    clutter.add_lines(std::slice::from_ref(part));
                    // Lines across an area stand for its inside.
                    let half = part.len() / 2;
                    let across = part.iter().take(half).zip(part.iter().rev()).map(|(a, b)| vec![*a, *b]);
                    clutter.add_lines(&across.collect::<Vec<_>>());
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

/// How much larger open circles and squares are than filled ones: at the same place both are seen.
const OPEN: f64 = 1.3;

/// Markers of one form, half width and colour. Open ones are white inside.
pub(super) fn markers(canvas: &mut Canvas, points: &[Point], marker: Marker, size: f64, colour: Rgb) {
    let size = if matches!(marker, Marker::OpenCircle | Marker::Square) { OPEN * size } else { size };
    let polygon = |corners: &[Point]| -> Vec<Vec<Point>> {
        let at = |p: &Point| corners.iter().map(|c| (p.0 + c.0 * size, p.1 + c.1 * size)).collect();
        points.iter().map(at).collect()
    };
    let square = [(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)];
    let pen = Some(Pen::solid(colour, OUTLINE));
    match marker {
        Marker::Auto | Marker::Circle => canvas.circles(points, size, colour, None),
        Marker::OpenCircle => canvas.circles(points, size, WHITE, pen),
        Marker::Square => canvas.areas(&polygon(&square), WHITE, pen),
        Marker::FilledSquare => canvas.areas(&polygon(&square), colour, None),
        Marker::Triangle => canvas.areas(&polygon(&[(0.0, -1.3), (1.2, 0.85), (-1.2, 0.85)]), colour, None),
        Marker::Diamond => {
            canvas.areas(&polygon(&[(0.0, -1.3), (1.2, 0.0), (0.0, 1.3), (-1.2, 0.0)]), WHITE, pen);
        }
        Marker::Limit => {
            canvas.areas(&polygon(&[(0.0, 1.3), (1.2, -0.85), (-1.2, -0.85)]), WHITE, pen);
        }
        Marker::Cross | Marker::Saltire | Marker::Star => {
            let upright = [[(-1.2, 0.0), (1.2, 0.0)], [(0.0, -1.2), (0.0, 1.2)]];
            let slanting = [[(-0.9, -0.9), (0.9, 0.9)], [(-0.9, 0.9), (0.9, -0.9)]];
            let strokes: &[_] = match marker {
                Marker::Cross => &[upright],
                Marker::Saltire => &[slanting],
                _ => &[upright, slanting],
            };
            let parts: Vec<_> = strokes.iter().flatten().flat_map(|stroke| polygon(stroke)).collect();
            canvas.lines(&parts, Pen::solid(colour, OUTLINE));
        }
        Marker::Letter(letter) => {
            for &(x, y) in points {
                let at = (x, y + font::DIGIT_HEIGHT * SMALL / 2.0);
                label(canvas, &letter.to_string(), at, SMALL, Anchor::Middle);
            }
        }
    }
}

/// A curve cut to the frame, with no more points than are seen.
fn curve(x: &[f64], y: &[f64], place: &Place<'_>) -> Vec<Vec<Point>> {
    let points: Vec<Point> = x.iter().zip(y).map(|(x, y)| place.at(*x, *y)).collect();
    clipped(&points, place.frame).iter().map(|part| thinned(part, 0.015)).collect()
}

fn error_bars(x: &[f64], y: &[f64], x_error: &[f64], y_error: &[f64], place: &Place<'_>) -> Vec<Vec<Point>> {
    const CAP: f64 = 1.8;
    let inside = place.frame.grown(0.01);
    let mut lines = Vec::new();
    let none = f64::NAN;
    for (i, (x, y)) in x.iter().zip(y).enumerate() {
        if !inside.contains(place.at(*x, *y)) {
            continue;
        }
        let dx = x_error.get(i).copied().unwrap_or(none).abs();
        let dy = y_error.get(i).copied().unwrap_or(none).abs();
        let span = |axis: &Axis, value: f64, std: f64| {
            // A bar that reaches zero has its end below every limit of a logarithmic axis: it goes to the
            // edge.
            let low = if axis.is_linear() { value - std } else { (value - std).max(0.0) };
            [low, value + std]
        };
        let vertical = span(place.y, *y, dy).map(|v| place.at(*x, v));
        let horizontal = span(place.x, *x, dx).map(|v| place.at(v, *y));
        for (bar, cap) in [(vertical, (CAP, 0.0)), (horizontal, (0.0, CAP))] {
            let length = (bar[0].0 - bar[1].0).hypot(bar[0].1 - bar[1].1);
            if length.is_nan() || length < 0.05 {
                continue;
            }
            lines.extend(clipped(&bar, place.frame));
            let ends = bar.iter().filter(|end| inside.contains(**end));
            lines.extend(ends.map(|e| vec![(e.0 - cap.0, e.1 - cap.1), (e.0 + cap.0, e.1 + cap.1)]));
        }
    }
    lines
}

/// Areas between two curves, one for each run without missing values.
fn band(x: &[f64], lower: &[f64], upper: &[f64], place: &Place<'_>) -> Vec<Vec<Point>> {
    let pairs: Vec<(Point, Point)> = x
        .iter()
        .zip(lower.iter().zip(upper))
        .map(|(x, (l, u))| (place.at(*x, *l), place.at(*x, *u)))
        .collect();
    let finite = |(a, b): &(Point, Point)| [a.0, a.1, b.0, b.1].iter().all(|v| v.is_finite());
    pairs
        .split(|pair| !finite(pair))
        .filter(|run| run.len() >= 2)
        .map(|run| {
            let low = thinned(&run.iter().map(|p| p.0).collect::<Vec<_>>(), 0.02);
            let high = thinned(&run.iter().map(|p| p.1).collect::<Vec<_>>(), 0.02);
            let around: Vec<Point> = high.into_iter().chain(low.into_iter().rev()).collect();
            clipped_polygon(&around, place.frame)
        })
        .collect()
}

/// Bars from zero (from the lower edge where zero has no place) and the outline over them.
fn bars(edges: &[f64], heights: &[f64], filled: bool, look: Look, place: &Place<'_>) -> Vec<Form> {
    let zero = place.up(place.y.at(0.0));
    let tops: Vec<(Point, Point)> = edges
        .windows(2)
        .zip(heights)
        .map(|(pair, height)| (place.at(pair[0], *height), place.at(pair[1], *height)))
        .collect();
    let finite = |(a, b): &(Point, Point)| [a.0, b.0, a.1].iter().all(|v| v.is_finite());
    let mut outlines = Vec::new();
    for run in tops.split(|top| !finite(top)) {
        let mut line = Vec::new();
        for (i, (a, b)) in run.iter().enumerate() {
            // An outline goes down at its ends only, filled bars each.
            line.extend((filled || i == 0).then_some((a.0, zero)));
            line.extend([*a, *b]);
            line.extend((filled || i + 1 == run.len()).then_some((b.0, zero)));
        }
        outlines.extend(clipped(&line, place.frame));
    }
    let mut forms = Vec::new();
    if filled {
        let area = |(a, b): &(Point, Point)| vec![(a.0, zero), *a, *b, (b.0, zero)];
        let areas =
            tops.iter().filter(|t| finite(t)).map(|t| clipped_polygon(&area(t), place.frame)).collect();
        forms.push(Form::Areas(areas, look.colour.tint(0.6)));
    }
    forms.push(Form::Lines(outlines, Pen { width: OUTLINE, ..look.pen }));
    forms
}
