//! Maps: a value over two axes, shown by colour.

use crate::style::{FRAME, GAP, LARGE, LEADING, TICK, TICKS};
use crate::{Axis, AxisSpec, Canvas, Extent, Place, Rect, Rgb, Room, Ruler, Scale, Side, colour, frame};
use ndarray::{Array2, ArrayRef2};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use vibro_record::{Error, Result};

/// Values over a grid, row by row, such as magnitudes over excitation level (rows) and frequency (columns).
///
/// The cell of a value reaches half way to its neighbours: rows and columns may be unevenly spaced. A missing
/// value (NaN) stays white.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Heatmap {
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) values: Array2<f64>,
    pub(super) key: Key,
}

/// Distance of a colour bar from the frame, and its width, in points.
const BAR_DISTANCE: f64 = 7.0;
const BAR_WIDTH: f64 = 8.0;
/// Cells of a map per point (1/72 inch): print shows no more than 300 dots per inch.
const CELLS_PER_POINT: f64 = 300.0 / 72.0;

/// Meaning of the colours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) enum Key {
    /// A quantity, on a colour bar.
    Quantity(AxisSpec),
    /// One of these classes, by its index.
    Classes(Vec<String>),
}

impl Heatmap {
    /// Map of a quantity in the unit of `spec`; `x` are the positions of the columns, `y` those of the rows,
    /// each in ascending order.
    ///
    /// # Errors
    /// If the shape of `values` is not (rows, columns), or positions do not ascend.
    pub fn new(x: &[f64], y: &[f64], values: &ArrayRef2<f64>, spec: AxisSpec) -> Result<Heatmap> {
        Heatmap::of(x, y, values, Key::Quantity(spec))
    }

    /// Map of classes: the value k means the k-th name, counted from 0; any other value counts as missing.
    ///
    /// # Errors
    /// As [`Heatmap::new`].
    pub fn classes(x: &[f64], y: &[f64], values: &ArrayRef2<f64>, names: &[&str]) -> Result<Heatmap> {
        Heatmap::of(x, y, values, Key::Classes(names.iter().map(|&n| n.to_owned()).collect()))
    }

    /// A map with this key, after a check of its shape and positions.
    fn of(x: &[f64], y: &[f64], values: &ArrayRef2<f64>, key: Key) -> Result<Heatmap> {
        fits("a map", values, y, x)?;
        ascending(x, "column positions of a map")?;
        ascending(y, "row positions of a map")?;
        Ok(Heatmap { x: x.to_vec(), y: y.to_vec(), values: values.to_owned(), key })
    }

    /// Borders of all columns and of all rows, to find the limits of the axes.
    pub(super) fn borders(&self, x: Scale, y: Scale) -> (Vec<f64>, Vec<f64>) {
        let borders = |positions: &[f64], scale: Scale| {
            let spans = spans(&positions.iter().map(|v| scale.of(*v)).collect::<Vec<_>>());
            spans.into_iter().flat_map(|(from, to)| [from, to]).collect()
        };
        (borders(&self.x, x), borders(&self.y, y))
    }

    /// Axis of the colour bar; `None` for classes, and where no value is finite.
    pub(super) fn colour_axis(&self) -> Option<Axis> {
        let Key::Quantity(spec) = &self.key else { return None };
        Axis::new(spec, Extent::of(spec.scale, self.values.iter().copied()), Room::Tight)
    }

    /// Colour of a class.
    pub(super) fn class_colour(index: usize) -> Rgb {
        colour::SERIES[index % colour::SERIES.len()].tint(0.25)
    }

    /// Colours of `across` × `down` cells between the limits of two axes, the top row first; `None` where
    /// nothing was measured. A cell with several values shows the largest, so that no narrow line is lost;
    /// for classes it shows the value in its middle.
    pub(super) fn cells(&self, x: &Axis, y: &Axis, across: usize, down: usize) -> Array2<Option<Rgb>> {
        let (columns, rows) = (cover(&self.x, x, across), cover(&self.y, y, down));
        let bar = self.colour_axis();
        let cell = |rows: &Range<usize>, columns: &Range<usize>| match (&self.key, &bar) {
            (Key::Quantity(_), Some(bar)) => {
                let block = rows.clone().flat_map(|r| columns.clone().map(move |c| (r, c)));
                let shade = block.map(|at| bar.at(self.values[at])).fold(f64::NAN, f64::max);
                (!shade.is_nan()).then(|| colour::viridis(shade))
            }
            (Key::Classes(names), _) => {
                let middle = |range: &Range<usize>| range.clone().nth(range.len() / 2);
                let class = self.values.get((middle(rows)?, middle(columns)?))?;
                (0.0..names.len() as f64).contains(class).then(|| Heatmap::class_colour(*class as usize))
            }
            _ => None,
        };
        let (mut line, mut cells) = (Vec::new(), Vec::with_capacity(across * down));
        for row in (0..down).rev() {
            // A coarse map has many lines of cells over the same positions, which look alike.
            if line.is_empty() || rows[row] != rows[row + 1] {
                line = columns.iter().map(|columns| cell(&rows[row], columns)).collect();
            }
            cells.extend_from_slice(&line);
        }
        Array2::from_shape_vec((down, across), cells).expect("a colour for each cell")
    }

    /// Draws the cells that fill the frame.
    pub(super) fn draw(&self, canvas: &mut Canvas, place: &Place<'_>) {
        let count = |points: f64| (points * CELLS_PER_POINT).ceil().max(1.0) as usize;
        let cells = self.cells(place.x, place.y, count(place.frame.w), count(place.frame.h));
        canvas.image(place.frame, &cells);
    }
}

/// Width for the colour bar, in points, to the right of a frame of about this height.
pub(super) fn bar_room(bar: &Axis, height: f64) -> f64 {
    let numbers = frame::widest(&frame::upward(bar, height));
    let name = if bar.title.is_empty() { 0.0 } else { GAP + 1.15 * LARGE };
    BAR_DISTANCE + BAR_WIDTH + TICK + 2.0 + numbers + name
}

/// Draws the colour bar beside the frame.
pub(super) fn draw_bar(canvas: &mut Canvas, bar: &Axis, frame: Rect) {
    let place = Rect { x: frame.right() + BAR_DISTANCE, w: BAR_WIDTH, ..frame };
    let shades = Array2::from_shape_fn((256, 1), |(i, _)| Some(colour::viridis(1.0 - i as f64 / 255.0)));
    canvas.image(place, &shades);
    let ticks = frame::upward(bar, frame.h);
    let (from, to) = ((place.right(), place.bottom()), (place.right(), place.y));
    let ruler = Ruler { axis: bar, ticks: &ticks, from, to };
    canvas.lines(&ruler.marks((1.0, 0.0)), TICKS);
    ruler.numbers(canvas, Side::Right, TICK + 1.5);
    canvas.rect(place, None, Some(FRAME));
    let x = place.right() + TICK + 1.0 + frame::widest(&ticks) + GAP + 0.85 * LARGE;
    frame::along(canvas, &bar.title, x, frame, 2.0 * LEADING);
}

/// Checks that `values` has one row for each of `rows` and one column for each of `columns`; `what` names
/// the figure in the error.
///
/// # Errors
/// If the shape differs.
pub(super) fn fits(what: &str, values: &ArrayRef2<f64>, rows: &[f64], columns: &[f64]) -> Result<()> {
    let ((down, across), expected) = (values.dim(), (rows.len(), columns.len()));
    if (down, across) == expected {
        return Ok(());
    }
    let expected = format!("{} × {}, one for each row and column", expected.0, expected.1);
    Err(Error::usage(format!("{what} of {down} × {across} values"), expected))
}

/// Checks that positions ascend; `of` names them in the error.
///
/// # Errors
/// If they do not.
pub(super) fn ascending(positions: &[f64], of: &str) -> Result<()> {
    match positions.windows(2).find(|w| w[0] >= w[1] || w[0].is_nan() || w[1].is_nan()) {
        Some(w) => Err(Error::usage(format!("{of}: {} and {}", w[0], w[1]), "an ascending order")),
        None => Ok(()),
    }
}

/// Start and end of each position's cell: half way to its neighbours; the outer cells are symmetrical.
fn spans(positions: &[f64]) -> Vec<(f64, f64)> {
    let steps: Vec<f64> = positions.windows(2).map(|w| w[1] - w[0]).collect();
    if steps.is_empty() {
        let half = |at: f64| if at == 0.0 { 0.5 } else { at.abs() * 0.05 };
        return positions.iter().map(|at| (at - half(*at), at + half(*at))).collect();
    }
    let below = steps.first().into_iter().chain(&steps);
    let above = steps.iter().chain(steps.last());
    positions.iter().zip(below.zip(above)).map(|(at, (b, a))| (at - b / 2.0, at + a / 2.0)).collect()
}

/// For each of `count` cells along an axis, the positions it shows.
fn cover(positions: &[f64], axis: &Axis, count: usize) -> Vec<Range<usize>> {
    let places: Vec<f64> = positions.iter().map(|p| axis.at(*p)).collect();
    let spans = spans(&places);
    let shown = |i: usize| {
        let [from, to] = [i as f64 / count as f64, (i + 1) as f64 / count as f64];
        let inside = places.partition_point(|p| *p < from)..places.partition_point(|p| *p < to);
        if !inside.is_empty() {
            return inside;
        }
        // Between two positions: the one whose cell contains the middle.
        let middle = f64::midpoint(from, to);
        let at = spans.partition_point(|s| s.1 <= middle);
        if spans.get(at).is_some_and(|s| s.0 <= middle) { at..at + 1 } else { 0..0 }
    };
    (0..count).map(shown).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    fn axis(lo: f64, hi: f64) -> Axis {
        Axis::new(&AxisSpec::new("x", "1").limits(lo, hi), Extent::NONE, Room::Tight).unwrap()
    }

    #[test]
    fn uneven_positions_meet_half_way() {
        // Steps of 1, 2 and 5: borders at 0.5, 1.5, 3 and 6.5; a hundred cells over 0 to 10.
        let cells = cover(&[1.0, 2.0, 4.0, 9.0], &axis(0.0, 10.0), 100);
        let shown: Vec<_> = [2, 6, 14, 16, 29, 31, 64, 66, 99].iter().map(|&i| cells[i].clone()).collect();
        assert_eq!(shown, [0..0, 0..1, 0..1, 1..2, 1..2, 2..3, 2..3, 3..4, 3..4]);
    }

    #[test]
    fn a_narrow_line_survives_coarse_cells() {
        let x: Vec<f64> = (0..1000).map(f64::from).collect();
        let values = Array2::from_shape_fn((1, 1000), |(_, c)| if c == 617 { 1.0 } else { 0.0 });
        let map = Heatmap::new(&x, &[1.0], &values, AxisSpec::new("a", "m")).unwrap();
        let cells = map.cells(&axis(0.0, 999.0), &axis(0.9, 1.1), 50, 1);
        let marked: Vec<usize> = cells
            .iter()
            .enumerate()
            .filter(|(_, c)| **c == Some(colour::viridis(1.0)))
            .map(|(i, _)| i)
            .collect();
        // 617 of 0 to 999 lies in the 31st of 50 cells.
        assert_eq!(marked, [30]);
    }

    #[test]
    fn the_first_row_is_at_the_bottom_and_missing_values_are_transparent() {
        let map = Heatmap::classes(
            &[0.0, 1.0],
            &[0.0, 1.0],
            &array![[0.0, 1.0], [f64::NAN, 7.0]].view(),
            &["a", "b"],
        );
        let cells = map.unwrap().cells(&axis(-0.5, 1.5), &axis(-0.5, 1.5), 2, 2);
        let class = |i| Some(Heatmap::class_colour(i));
        assert_eq!(cells, array![[None, None], [class(0), class(1)]]);
    }

    #[test]
    fn shapes_and_orders_that_do_not_fit_are_refused() {
        let values = Array2::zeros((2, 3));
        let spec = || AxisSpec::new("a", "m");
        assert!(Heatmap::new(&[1.0, 2.0, 3.0], &[1.0], &values, spec()).is_err());
        assert!(Heatmap::new(&[1.0, 3.0, 2.0], &[1.0, 2.0], &values, spec()).is_err());
        assert!(Heatmap::new(&[1.0, 2.0, 3.0], &[1.0, f64::NAN], &values, spec()).is_err());
        assert!(Heatmap::new(&[1.0, 2.0, 3.0], &[1.0, 2.0], &values, spec()).is_ok());
    }
}
