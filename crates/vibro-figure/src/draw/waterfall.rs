//! A waterfall on the page, in oblique projection with three axes.

use super::canvas::{Anchor, Canvas, Pen, Text};
use super::frame::{self, Ruler, Side, fitted};
use super::style::{DESCENT, FLOOR, FRAME, GAP, LARGE, LEADING, SMALL, TICK, TICKS};
use crate::axis::Axis;
use crate::colour::{self, BLACK, WHITE};
use crate::font;
use crate::path::{Point, Rect, thinned};
use crate::waterfall::{Cube, Waterfall};

/// Room for numbers and a name at either side, before these are known.
const SIDE: f64 = 34.0;

/// How far a spectrum may be moved to have fewer points: a sixth of a dot at 300 dots per inch.
const TOLERANCE: f64 = 0.04;

/// Draws a waterfall into a cell of the page.
pub(super) fn draw(canvas: &mut Canvas, waterfall: &Waterfall, cell: Rect) {
    let title = if waterfall.title.is_empty() { 0.0 } else { 1.5 * LARGE };
    let (name, size) = fitted(&waterfall.title, LARGE, cell.w);
    canvas.label(&name, (cell.x, cell.y + LARGE), size, Anchor::Start);
    let bottom = 2.0 * GAP + LEADING + 1.3 * LARGE;
    let framed = |left: f64, right: f64| Rect {
        x: cell.x + left,
        y: cell.y + title + SMALL / 2.0,
        w: (cell.w - left - right).max(20.0),
        h: (cell.h - title - bottom - SMALL / 2.0).max(20.0),
    };
    let rough = framed(SIDE, SIDE);
    let Some(cube) = waterfall.cube() else {
        canvas.outline(rough, FRAME);
        return canvas.label("no data", rough.middle(), LARGE, Anchor::Middle);
    };
    // With the numbers known, the room beside them is too, and that of the names beyond them.
    let sheet = Sheet::new(&cube, rough);
    let numbers = |axis: &Axis, length: f64| TICK + 2.0 + frame::widest(&frame::upward(axis, length));
    let left = numbers(&cube.up, sheet.rise) + GAP + DESCENT + LARGE;
    let right = numbers(&cube.depth, sheet.back.1) + 2.0 * GAP + LARGE;
    let sheet = Sheet::new(&cube, framed(left, right));
    sheet.draw_spectra(canvas);
    sheet.draw_axes(canvas);
}

/// A cube in its frame.
struct Sheet<'a> {
    cube: &'a Cube,
    frame: Rect,
    /// Width of a spectrum.
    along: f64,
    /// Way of the back edge to the right and up.
    back: Point,
    /// Height of the amplitude axis.
    rise: f64,
}

impl<'a> Sheet<'a> {
    /// Fills the frame: where no spectrum reaches its top, all is drawn that much higher.
    fn new(cube: &'a Cube, frame: Rect) -> Sheet<'a> {
        let (w, h) = (frame.w, frame.h);
        let tops =
            cube.spectra.iter().flat_map(|(depth, line)| line.iter().map(move |p| 0.58 * depth + 0.42 * p.1));
        let stretch = (1.0 / tops.fold(0.58, f64::max)).clamp(1.0, 1.6);
        let back = (0.22 * w, 0.58 * h * stretch);
        Sheet { cube, frame, along: 0.78 * w, back, rise: 0.42 * h * stretch }
    }

    fn at(&self, x: f64, depth: f64, up: f64) -> Point {
        let right = x * self.along + depth * self.back.0;
        (self.frame.x + right, self.frame.bottom() - depth * self.back.1 - up * self.rise)
    }

    /// Draws from back to front: each spectrum is white below its line and hides what stands behind it.
    fn draw_spectra(&self, canvas: &mut Canvas) {
        let ticks = frame::across(&self.cube.x, self.along);
        let across = ticks.major.iter().map(|tick| self.cube.x.at_scaled(tick.at)).chain([0.0, 1.0]);
        let floor = across.map(|x| vec![self.at(x, 0.0, 0.0), self.at(x, 1.0, 0.0)]);
        let back = vec![self.at(0.0, 1.0, 0.0), self.at(1.0, 1.0, 0.0)];
        canvas.lines(&floor.chain([back]).collect::<Vec<_>>(), FLOOR);
        // The denser the spectra stand, the thinner they are.
        let width = (0.25 * self.back.1 / self.cube.spectra.len() as f64).clamp(0.3, 0.6);
        for (depth, line) in self.cube.spectra.iter().rev() {
            for run in line.split(|p| p.1.is_nan()).filter(|run| run.len() > 1) {
                let seen: Vec<Point> = run.iter().map(|p| self.at(p.0, *depth, p.1)).collect();
                let seen = thinned(&seen, TOLERANCE);
                let ends = [run[run.len() - 1], run[0]].map(|p| self.at(p.0, *depth, 0.0));
                canvas.areas(&[[&seen[..], &ends].concat()], WHITE, None);
                canvas.lines(&[seen], Pen::solid(BLACK, width));
            }
            let here = self.cube.peaks.iter().filter(|peak| (peak.0 - depth).abs() < 1e-9);
            let peaks: Vec<Point> = here.map(|(_, (x, up))| self.at(*x, *depth, *up)).collect();
            canvas.circles(&peaks, 1.3, colour::SERIES[1], None);
        }
    }

    fn draw_axes(&self, canvas: &mut Canvas) {
        let Cube { x, depth, up, .. } = self.cube;
        let (tx, ty) = (frame::across(x, self.along), frame::upward(up, self.rise));
        let tz = frame::upward(depth, self.back.1);
        let origin = self.at(0.0, 0.0, 0.0);
        let [front, far, top] = [self.at(1.0, 0.0, 0.0), self.at(1.0, 1.0, 0.0), self.at(0.0, 0.0, 1.0)];
        let axes = [
            (Ruler { axis: x, ticks: &tx, from: origin, to: front }, (0.0, 1.0), Side::Below),
            (Ruler { axis: depth, ticks: &tz, from: front, to: far }, (1.0, 0.0), Side::Right),
            (Ruler { axis: up, ticks: &ty, from: origin, to: top }, (-1.0, 0.0), Side::Left),
        ];
        for (ruler, way, side) in axes {
            canvas.line(ruler.from, ruler.to, FRAME);
            canvas.lines(&ruler.marks(way), TICKS);
            ruler.numbers(canvas, side, TICK + 2.0);
        }
        let (name, size) = fitted(&x.title, LARGE, self.along + 2.0 * LEADING);
        let below = self.frame.bottom() + TICK + 2.0 + LEADING + 0.8 * LARGE;
        canvas.label(&name, (self.frame.x + self.along / 2.0, below), size, Anchor::Middle);
        // Along the axis to the back, clear of the lower right corners of its numbers.
        let length = self.back.0.hypot(self.back.1).max(1.0);
        let (right, rise) = (self.back.0 / length, self.back.1 / length);
        let corner = (TICK + 2.0 + frame::widest(&tz)) * rise + font::DIGIT_HEIGHT * SMALL / 2.0 * right;
        let off = corner + 2.0 * GAP + 0.75 * LARGE;
        let (name, size) = fitted(&depth.title, LARGE, length + LEADING);
        let middle = (f64::midpoint(front.0, far.0), f64::midpoint(front.1, far.1));
        canvas.text(Text {
            words: &name,
            at: (middle.0 + off * rise, middle.1 + off * right),
            size,
            anchor: Anchor::Middle,
            turn: rise.atan2(right).to_degrees(),
            colour: BLACK,
            halo: false,
        });
        // The name of the heights may be longer than their axis: it then goes on upwards.
        let left = self.frame.x - TICK - 2.0 - frame::widest(&ty) - GAP - DESCENT;
        let length = font::width(&up.title, LARGE).clamp(self.rise, self.frame.h.max(self.rise));
        let beside = Rect { y: self.frame.bottom() - length, h: length, ..self.frame };
        frame::along(canvas, &up.title, left, beside, 0.0);
    }
}
