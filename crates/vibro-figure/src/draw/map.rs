//! A map under a plot, and its colour bar.

use super::canvas::{Anchor, Canvas, Image};
use super::frame::{self, Insets, Place, label};
use super::style::{FRAME, GAP, LARGE, LEADING, SMALL, TICK, TICKS};
use crate::axis::Axis;
use crate::font;
use crate::heatmap::{self, Heatmap};
use crate::path::Rect;

/// Distance of the bar from the frame, and its width.
const AWAY: f64 = 7.0;
const WIDTH: f64 = 8.0;
/// Cells a point of the page: 300 dots per inch are all that print shows.
const CELLS: f64 = 300.0 / 72.0;

/// Room for the colour bar to the right of a frame of about this height.
pub(super) fn insets(bar: &Axis, height: f64) -> Insets {
    let numbers = frame::widest(&frame::upward(bar, height));
    let name = if bar.title.is_empty() { 0.0 } else { GAP + 1.15 * LARGE };
    Insets { right: AWAY + WIDTH + TICK + 2.0 + numbers + name, ..Insets::default() }
}

/// Draws the cells that fill the frame.
pub(super) fn draw_cells(canvas: &mut Canvas, map: &Heatmap, place: &Place<'_>) {
    let most = |points: f64| (points * CELLS) as usize;
    let (cells, width, palette) = map.cells(place.x, place.y, (most(place.frame.w), most(place.frame.h)));
    if width > 0 && !cells.is_empty() {
        canvas.images.push(Image { place: place.frame, width, cells, palette });
    }
}

/// Draws the colour bar beside the frame.
pub(super) fn draw_bar(canvas: &mut Canvas, bar: &Axis, frame: Rect) {
    let place = Rect { x: frame.right() + AWAY, w: WIDTH, ..frame };
    let cells = (1..=255).rev().collect();
    canvas.images.push(Image { place, width: 1, cells, palette: heatmap::bar_palette() });
    let ticks = frame::upward(bar, frame.h);
    let height = |u: f64| place.bottom() - bar.at_scaled(u) * place.h;
    let mut lines = Vec::new();
    for tick in &ticks.major {
        let y = height(tick.at);
        lines.push(vec![(place.right(), y), (place.right() + TICK - 1.0, y)]);
        let at = (place.right() + TICK + 1.0, y + font::DIGIT_HEIGHT * SMALL / 2.0);
        label(canvas, &tick.label, at, SMALL, Anchor::Start);
    }
    canvas.lines(&lines, TICKS);
    canvas.outline(place, FRAME);
    let x = place.right() + TICK + 1.0 + frame::widest(&ticks) + GAP + 0.85 * LARGE;
    frame::along(canvas, &bar.title, x, frame, 2.0 * LEADING);
}
