//! A waterfall on the page: its scene, turned to y down, with three axes.

use super::canvas::{Anchor, Canvas, Pen, Text};
use super::frame::{self, fitted, label};
use super::style::{DESCENT, FLOOR, FRAME, GAP, LARGE, LEADING, SMALL, TICK, TICKS};
use crate::axis::Axis;
use crate::colour::{self, BLACK};
use crate::font;
use crate::path::{Point, Rect};
use crate::projection::{Cube, View};
use crate::ticks::Ticks;
use crate::waterfall::Waterfall;

/// Draws a waterfall into a cell of the page.
pub(super) fn draw(canvas: &mut Canvas, waterfall: &Waterfall, cell: Rect) {
    let title = if waterfall.title.is_empty() { 0.0 } else { 1.5 * LARGE };
    let room = Rect { y: cell.y + title, h: cell.h - title, ..cell };
    let (name, size) = fitted(&waterfall.title, LARGE, cell.w);
    label(canvas, &name, (cell.x, cell.y + LARGE), size, Anchor::Start);
    let bottom = 2.0 * GAP + LEADING + 1.3 * LARGE;
    let framed = |left: f64, right: f64| Rect {
        x: room.x + left,
        y: room.y + SMALL / 2.0,
        w: (room.w - left - right).max(20.0),
        h: (room.h - bottom - SMALL / 2.0).max(20.0),
    };
    let rough = framed(SIDE, SIDE);
    let Some(cube) = waterfall.cube() else {
        canvas.outline(rough, FRAME);
        return label(canvas, "no data", rough.middle(), LARGE, Anchor::Middle);
    };
    // With the numbers known, the room beside them is too.
    let view = cube.view(rough.w, rough.h);
    let numbers = |axis: &Axis, length: f64| TICK + 2.0 + frame::widest(&frame::upward(axis, length));
    let left = numbers(&cube.up, view.rise) + GAP + DESCENT + LARGE;
    let beside = numbers(&cube.depth, view.back.1);
    let frame = framed(left, beside.max(Slope::of(view, beside).overhang(&cube.depth.title)));
    let sheet = Sheet { cube: &cube, view: cube.view(frame.w, frame.h), frame };
    sheet.draw_spectra(canvas);
    sheet.draw_frequencies(canvas);
    sheet.draw_excitations(canvas);
    sheet.draw_heights(canvas);
}

/// Room for numbers and a name at either side, before these are known.
const SIDE: f64 = 34.0;

/// The direction of the axis to the back, with a name along it.
struct Slope {
    length: f64,
    /// Parts of a step along the axis that lead to the right and up.
    right: f64,
    up: f64,
    /// Distance of the name's baseline from the axis.
    off: f64,
}

impl Slope {
    /// With numbers that take this much room beside the axis.
    fn of(view: View, numbers: f64) -> Slope {
        let (dx, dy) = view.back;
        let length = dx.hypot(dy).max(1.0);
        let (right, up) = (dx / length, dy / length);
        // The lower right corner of a number is what comes nearest to the name.
        let corner = numbers * up + font::DIGIT_HEIGHT * SMALL / 2.0 * right;
        Slope { length, right, up, off: corner + 2.0 * GAP + 0.75 * LARGE }
    }

    /// How far the name reaches to the right of the back end of the axis.
    fn overhang(&self, name: &str) -> f64 {
        let half = font::width(name, LARGE).min(self.length + LEADING) / 2.0;
        self.off * self.up + (half - self.length / 2.0) * self.right + 1.0
    }
}

struct Sheet<'a> {
    cube: &'a Cube,
    view: View,
    frame: Rect,
}

impl Sheet<'_> {
    fn page(&self, (x, y): Point) -> Point {
        (self.frame.x + x, self.frame.bottom() - y)
    }

    fn at(&self, x: f64, depth: f64, up: f64) -> Point {
        self.page(self.view.at(x, depth, up))
    }

    fn draw_spectra(&self, canvas: &mut Canvas) {
        let down = |parts: &[Vec<Point>]| -> Vec<Vec<Point>> {
            parts.iter().map(|part| part.iter().map(|p| self.page(*p)).collect()).collect()
        };
        let scene = self.cube.seen(self.view, &self.ticks());
        canvas.lines(&down(&scene.floor), FLOOR);
        // The denser the spectra stand, the thinner they are.
        let width = (0.25 * self.view.back.1 / scene.spectra.len() as f64).clamp(0.3, 0.6);
        for parts in &scene.spectra {
            canvas.lines(&down(parts), Pen::solid(BLACK, width));
        }
        let peaks: Vec<Point> = scene.peaks.iter().map(|p| self.page(*p)).collect();
        canvas.circles(&peaks, 1.3, colour::SERIES[1], None);
    }

    fn ticks(&self) -> Ticks {
        frame::across(&self.cube.x, self.view.along)
    }

    fn draw_frequencies(&self, canvas: &mut Canvas) {
        let (x, view, ticks) = (&self.cube.x, self.view, self.ticks());
        canvas.line(self.at(0.0, 0.0, 0.0), self.at(1.0, 0.0, 0.0), FRAME);
        let mut lines = Vec::new();
        for tick in &ticks.major {
            let (px, py) = self.at(x.at_scaled(tick.at), 0.0, 0.0);
            lines.push(vec![(px, py), (px, py + TICK)]);
            label(canvas, &tick.label, (px, py + TICK + 1.5 + 0.8 * SMALL), SMALL, Anchor::Middle);
        }
        for u in &ticks.minor {
            let (px, py) = self.at(x.at_scaled(*u), 0.0, 0.0);
            lines.push(vec![(px, py), (px, py + TICK / 2.0)]);
        }
        canvas.lines(&lines, TICKS);
        let (name, size) = fitted(&x.title, LARGE, view.along + 2.0 * LEADING);
        let at = (self.frame.x + view.along / 2.0, self.frame.bottom() + TICK + 1.5 + LEADING + 0.8 * LARGE);
        label(canvas, &name, at, size, Anchor::Middle);
    }

    /// The axis to the back, along the right edge of the floor.
    fn draw_excitations(&self, canvas: &mut Canvas) {
        let (depth, view) = (&self.cube.depth, self.view);
        let (near, far) = (self.at(1.0, 0.0, 0.0), self.at(1.0, 1.0, 0.0));
        canvas.line(near, far, FRAME);
        let ticks = frame::upward(depth, view.back.1);
        let mut lines = Vec::new();
        for tick in &ticks.major {
            let (px, py) = self.at(1.0, depth.at_scaled(tick.at), 0.0);
            lines.push(vec![(px, py), (px + TICK, py)]);
            let at = (px + TICK + 2.0, py + font::DIGIT_HEIGHT * SMALL / 2.0);
            label(canvas, &tick.label, at, SMALL, Anchor::Start);
        }
        for u in &ticks.minor {
            let (px, py) = self.at(1.0, depth.at_scaled(*u), 0.0);
            lines.push(vec![(px, py), (px + TICK / 2.0, py)]);
        }
        canvas.lines(&lines, TICKS);
        let slope = Slope::of(view, TICK + 2.0 + frame::widest(&ticks));
        let (name, size) = fitted(&depth.title, LARGE, slope.length + LEADING);
        let middle = (f64::midpoint(near.0, far.0), f64::midpoint(near.1, far.1));
        canvas.text(Text {
            words: &name,
            at: (middle.0 + slope.off * slope.up, middle.1 + slope.off * slope.right),
            size,
            anchor: Anchor::Middle,
            turn: slope.up.atan2(slope.right).to_degrees(),
            colour: BLACK,
            halo: false,
        });
    }

    fn draw_heights(&self, canvas: &mut Canvas) {
        let (up, view) = (&self.cube.up, self.view);
        canvas.line(self.at(0.0, 0.0, 0.0), self.at(0.0, 0.0, 1.0), FRAME);
        let ticks = frame::upward(up, view.rise);
        let mut lines = Vec::new();
        for tick in &ticks.major {
            let (px, py) = self.at(0.0, 0.0, up.at_scaled(tick.at));
            lines.push(vec![(px, py), (px - TICK, py)]);
            let at = (px - TICK - 2.0, py + font::DIGIT_HEIGHT * SMALL / 2.0);
            label(canvas, &tick.label, at, SMALL, Anchor::End);
        }
        for u in &ticks.minor {
            let (px, py) = self.at(0.0, 0.0, up.at_scaled(*u));
            lines.push(vec![(px, py), (px - TICK / 2.0, py)]);
        }
        canvas.lines(&lines, TICKS);
        let x = self.frame.x - TICK - 2.0 - frame::widest(&ticks) - GAP - DESCENT;
        // The name may be longer than its axis: it then goes on upwards.
        let name = font::width(&up.title, LARGE).clamp(view.rise, self.frame.h);
        let beside = Rect { y: self.frame.bottom() - name, h: name, ..self.frame };
        frame::along(canvas, &up.title, x, beside, 0.0);
    }
}
