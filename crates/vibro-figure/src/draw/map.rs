//! A map under a plot, and its colour bar.

use super::canvas::Canvas;
use super::frame::{self, Place, Ruler, Side};
use super::style::{FRAME, GAP, LARGE, LEADING, TICK, TICKS};
use crate::axis::Axis;
use crate::colour;
use crate::heatmap::Heatmap;
use crate::path::Rect;
use ndarray::Array2;

/// Distance of a colour bar from the frame, and its width.
const AWAY: f64 = 7.0;
const WIDTH: f64 = 8.0;
/// Cells of a map in a point of the page: 300 dots per inch are all that print shows.
const CELLS: f64 = 300.0 / 72.0;

/// Room for the colour bar to the right of a frame of about this height.
pub(super) fn room(bar: &Axis, height: f64) -> f64 {
    let numbers = frame::widest(&frame::upward(bar, height));
    let name = if bar.title.is_empty() { 0.0 } else { GAP + 1.15 * LARGE };
    AWAY + WIDTH + TICK + 2.0 + numbers + name
}

/// Draws the cells that fill the frame.
pub(super) fn draw_cells(canvas: &mut Canvas, map: &Heatmap, place: &Place<'_>) {
    let count = |points: f64| (points * CELLS).ceil().max(1.0) as usize;
    let cells = map.cells(place.x, place.y, count(place.frame.w), count(place.frame.h));
    canvas.image(place.frame, &cells);
}

/// Draws the colour bar beside the frame.
pub(super) fn draw_bar(canvas: &mut Canvas, bar: &Axis, frame: Rect) {
    let place = Rect { x: frame.right() + AWAY, w: WIDTH, ..frame };
    let shades = Array2::from_shape_fn((256, 1), |(i, _)| Some(colour::viridis(1.0 - i as f64 / 255.0)));
    canvas.image(place, &shades);
    let ticks = frame::upward(bar, frame.h);
    let ruler = Ruler {
        axis: bar,
        ticks: &ticks,
        from: (place.right(), place.bottom()),
        to: (place.right(), place.y),
    };
    canvas.lines(&ruler.marks((1.0, 0.0)), TICKS);
    ruler.numbers(canvas, Side::Right, TICK + 1.5);
    canvas.outline(place, FRAME);
    let x = place.right() + TICK + 1.0 + frame::widest(&ticks) + GAP + 0.85 * LARGE;
    frame::along(canvas, &bar.title, x, frame, 2.0 * LEADING);
}
