//! Waterfalls: spectra one behind the other, frequency to the right, excitation frequency to the back,
//! amplitude up.

use crate::style::{DESCENT, FLOOR, FRAME, GAP, LARGE, LEADING, SMALL, TICK, TICKS};
use crate::{
    Anchor, Axis, AxisSpec, BLACK, Canvas, Extent, Pen, Point, Rect, Room, Ruler, Scale, Side, Text, WHITE,
    ascending, fits, fitted, font, frame, thinned,
};
use ndarray::ArrayRef2;
use serde::{Deserialize, Serialize};
use vibro_record::{Result, sort_by_number};

/// Space in points for numbers and a name on either side, before their widths are known.
const SIDE: f64 = 34.0;

/// Largest shift in points of a line that is thinned to fewer points: a sixth of a dot at 300 dots per inch.
const TOLERANCE: f64 = 0.04;

/// A waterfall scaled to the unit cube: frequency to the right, excitation to the back, magnitude up.
#[derive(Debug, Clone)]
struct Cube {
    x: Axis,
    depth: Axis,
    up: Axis,
    /// Depth of each spectrum, from front to back, and its points; NaN where a line is missing.
    spectra: Vec<(f64, Vec<Point>)>,
}

/// Spectra in oblique projection with hidden-line removal, one for each excitation frequency.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Waterfall {
    /// Axis to the right.
    x: AxisSpec,
    /// Axis upwards.
    height: AxisSpec,
    pub(super) frequency: Vec<f64>,
    pub(super) rows: Vec<(f64, Vec<f64>)>,
    /// Name of the record whose spectra are shown: lines of that name in other figures of the page link
    /// here.
    pub(super) record: String,
}

impl Waterfall {
    /// Spectra `magnitude`, one row for each of `excitation` and one column for each of `frequency` (both in
    /// Hz), in the unit of `height`. A missing value is NaN and leaves a gap. Rows are sorted by excitation.
    ///
    /// # Errors
    /// If the shape of `magnitude` is not (excitations, frequencies), or the frequencies do not ascend.
    pub fn new(
        frequency: &[f64],
        excitation: &[f64],
        magnitude: &ArrayRef2<f64>,
        height: AxisSpec,
    ) -> Result<Waterfall> {
        fits("a waterfall", magnitude, excitation, frequency)?;
        ascending(frequency, "line frequencies of a waterfall (Hz)")?;
        let mut rows: Vec<(f64, Vec<f64>)> = excitation
            .iter()
            .zip(magnitude.rows())
            .filter(|(e, _)| e.is_finite())
            .map(|(e, row)| (*e, row.to_vec()))
            .collect();
        sort_by_number(&mut rows, |row| row.0);
        let (frequency, record) = (frequency.to_vec(), String::new());
        Ok(Waterfall { x: AxisSpec::frequency(), height, frequency, rows, record })
    }

    /// Names the record whose spectra are shown; lines of other figures refer to it by this name.
    pub fn of(self, record: impl Into<String>) -> Waterfall {
        Waterfall { record: record.into(), ..self }
    }

    /// Shows only this range of frequencies in Hz.
    pub fn frequencies(self, low: f64, high: f64) -> Waterfall {
        Waterfall { x: self.x.limits(low, high), ..self }
    }

    /// Axes to the right, to the back and upwards; `None` where there is nothing to show.
    pub(super) fn axes(&self) -> Option<[Axis; 3]> {
        let x = Axis::new(&self.x, Extent::of(self.x.scale, self.frequency.iter().copied()), Room::Tight)?;
        let depths = Extent::of(Scale::Linear, self.rows.iter().map(|r| r.0));
        // With a margin at both ends, so that the outer spectra do not coincide with the axes.
        let depth = Axis::new(&AxisSpec::new("Excitation frequency", "Hz"), depths, Room::Margin)?;
        let seen = |axis: &Axis, value: f64| (0.0..=1.0).contains(&axis.at(value));
        let shown = self.rows.iter().filter(|row| seen(&depth, row.0));
        let heights = shown.flat_map(|(_, row)| {
            self.frequency.iter().zip(row).filter(|(f, _)| seen(&x, **f)).map(|(_, v)| *v)
        });
        let up = Axis::new(&self.height, Extent::of(self.height.scale, heights), Room::Floor)?;
        Some([x, depth, up])
    }

    /// Scales everything to the axes; `None` where there is nothing to show.
    fn cube(&self) -> Option<Cube> {
        let [x, depth, up] = self.axes()?;
        let shown = |axis: &Axis, value: f64| Some(axis.at(value)).filter(|at| (0.0..=1.0).contains(at));
        // NaN stays NaN: a gap.
        let height = |value: f64| up.at(value).clamp(0.0, 1.0);
        let spectrum = |(excitation, row): &(f64, Vec<f64>)| {
            let values = self.frequency.iter().zip(row);
            let values = values.filter_map(|(f, v)| Some((shown(&x, *f)?, height(*v))));
            Some((shown(&depth, *excitation)?, values.collect()))
        };
        let spectra = self.rows.iter().filter_map(spectrum).collect();
        Some(Cube { x, depth, up, spectra })
    }

    /// Draws the waterfall into a cell of the page.
    pub(super) fn draw(&self, canvas: &mut Canvas, cell: Rect) {
        let bottom = 2.0 * GAP + LEADING + 1.3 * LARGE;
        let framed = |left: f64, right: f64| Rect {
            x: cell.x + left,
            y: cell.y + SMALL / 2.0,
            w: (cell.w - left - right).max(20.0),
            h: (cell.h - bottom - SMALL / 2.0).max(20.0),
        };
        let rough = framed(SIDE, SIDE);
        let Some(cube) = self.cube() else {
            canvas.rect(rough, None, Some(FRAME));
            return canvas.label("no data", rough.middle(), LARGE, Anchor::Middle);
        };
        // A first layout gives the lengths of the axes, and so the widths of their numbers; the second
        // leaves room for these.
        let sheet = Sheet::new(&cube, rough);
        let numbers = |axis: &Axis, length: f64| TICK + 2.0 + frame::widest(&frame::upward(axis, length));
        let left = numbers(&cube.up, sheet.rise) + GAP + DESCENT + LARGE;
        let right = numbers(&cube.depth, sheet.back.1) + 2.0 * GAP + LARGE;
        let sheet = Sheet::new(&cube, framed(left, right));
        sheet.draw_spectra(canvas);
        sheet.draw_axes(canvas);
    }
}

/// A cube in oblique projection on the page, with its lengths in points.
struct Sheet<'a> {
    cube: &'a Cube,
    frame: Rect,
    /// Length of the frequency axis.
    along: f64,
    /// Horizontal and vertical extent of the excitation axis, which is drawn to the back.
    back: Point,
    /// Length of the amplitude axis, which is drawn upwards.
    rise: f64,
}

impl<'a> Sheet<'a> {
    /// Fills the frame: where no spectrum reaches its top, heights and depth are stretched by up to 1.6.
    fn new(cube: &'a Cube, frame: Rect) -> Sheet<'a> {
        let (w, h) = (frame.w, frame.h);
        let tops =
            cube.spectra.iter().flat_map(|(depth, line)| line.iter().map(move |p| 0.58 * depth + 0.42 * p.1));
        let stretch = (1.0 / tops.fold(0.58, f64::max)).clamp(1.0, 1.6);
        let back = (0.22 * w, 0.58 * h * stretch);
        Sheet { cube, frame, along: 0.78 * w, back, rise: 0.42 * h * stretch }
    }

    /// Place on the page of a point of the unit cube.
    fn at(&self, x: f64, depth: f64, up: f64) -> Point {
        let right = x * self.along + depth * self.back.0;
        (self.frame.x + right, self.frame.bottom() - depth * self.back.1 - up * self.rise)
    }

    /// Draws from back to front: each spectrum is white below its line and hides those behind it.
    fn draw_spectra(&self, canvas: &mut Canvas) {
        let ticks = frame::across(&self.cube.x, self.along);
        let across = ticks.major.iter().map(|tick| self.cube.x.at_scaled(tick.at)).chain([0.0, 1.0]);
        let floor = across.map(|x| vec![self.at(x, 0.0, 0.0), self.at(x, 1.0, 0.0)]);
        let back = vec![self.at(0.0, 1.0, 0.0), self.at(1.0, 1.0, 0.0)];
        canvas.lines(&floor.chain([back]).collect::<Vec<_>>(), FLOOR);
        // The more spectra, the thinner their lines.
        let width = (0.25 * self.back.1 / self.cube.spectra.len() as f64).clamp(0.3, 0.6);
        for (depth, line) in self.cube.spectra.iter().rev() {
            for run in line.split(|p| p.1.is_nan()).filter(|run| run.len() > 1) {
                let seen: Vec<Point> = run.iter().map(|p| self.at(p.0, *depth, p.1)).collect();
                let seen = thinned(&seen, TOLERANCE);
                let ends = [run[run.len() - 1], run[0]].map(|p| self.at(p.0, *depth, 0.0));
                canvas.areas(&[[&seen[..], &ends].concat()], WHITE, None);
                canvas.lines(&[seen], Pen::solid(BLACK, width));
            }
        }
    }

    /// Draws the three axes with their ticks, numbers and names.
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
        // Beside the axis to the back, clear of the lower right corners of its numbers.
        let length = self.back.0.hypot(self.back.1).max(1.0);
        let (right, rise) = (self.back.0 / length, self.back.1 / length);
        let corner = (TICK + 2.0 + frame::widest(&tz)) * rise + font::DIGIT_HEIGHT * SMALL / 2.0 * right;
        let off = corner + 2.0 * GAP + 0.75 * LARGE;
        let (name, size) = fitted(&depth.title, LARGE, length + LEADING);
        let middle = (f64::midpoint(front.0, far.0), f64::midpoint(front.1, far.1));
        let (at, turn) = ((middle.0 + off * rise, middle.1 + off * right), rise.atan2(right).to_degrees());
        let anchor = Anchor::Middle;
        canvas.text(Text { words: name, at, size, anchor, turn, colour: BLACK, halo: false });
        // The name of the heights may be longer than their axis: it then goes on upwards.
        let left = self.frame.x - TICK - 2.0 - frame::widest(&ty) - GAP - DESCENT;
        let length = font::width(&up.title, LARGE).clamp(self.rise, self.frame.h.max(self.rise));
        let beside = Rect { y: self.frame.bottom() - length, h: length, ..self.frame };
        frame::along(canvas, &up.title, left, beside, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    #[test]
    fn rows_stand_in_the_order_of_their_excitation() {
        let (a, b) = (vec![0.0, 5.0, 0.0], vec![0.0, 1.0, 0.0]);
        let rows =
            |first: &[f64], second: &[f64]| Array2::from_shape_vec((2, 3), [first, second].concat()).unwrap();
        let spec = || AxisSpec::new("a", "m");
        let up = Waterfall::new(&[1.0, 2.0, 3.0], &[4.0, 5.0], &rows(&a, &b), spec()).unwrap();
        let down = Waterfall::new(&[1.0, 2.0, 3.0], &[5.0, 4.0], &rows(&b, &a), spec()).unwrap();
        assert_eq!(up, down);
    }

    #[test]
    fn nothing_to_show_is_no_cube() {
        let of = |frequency: &[f64], excitation: &[f64], magnitude: &Array2<f64>| {
            Waterfall::new(frequency, excitation, magnitude, AxisSpec::new("a", "m")).unwrap().cube()
        };
        assert!(of(&[], &[], &Array2::zeros((0, 0))).is_none());
        assert!(of(&[1.0, 2.0], &[4.0], &Array2::from_elem((1, 2), f64::NAN)).is_none());
        assert!(of(&[1.0, 2.0], &[f64::NAN], &Array2::zeros((1, 2))).is_none());
        assert!(of(&[1.0], &[4.0], &Array2::zeros((1, 1))).is_some());
    }

    #[test]
    fn shapes_and_orders_that_do_not_fit_are_refused() {
        let spec = || AxisSpec::new("a", "m");
        let values = Array2::zeros((2, 3));
        assert!(Waterfall::new(&[1.0, 2.0], &[1.0, 2.0], &values, spec()).is_err());
        assert!(Waterfall::new(&[1.0, 1.0, 2.0], &[1.0, 2.0], &values, spec()).is_err());
        assert!(Waterfall::new(&[1.0, 2.0, 3.0], &[1.0, f64::NAN], &values, spec()).is_ok());
    }
}
