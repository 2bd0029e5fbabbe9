//! Series: the data that a plot shows over its axes.

use serde::{Deserialize, Serialize};

/// One entry of a plot: its data in the unit of the axes, the form in which they are drawn, its name in the
/// legend and its look.
///
/// Lists of different lengths are drawn as far as the shortest reaches. A value that is missing (NaN), or has
/// no place on its axis, breaks a line and leaves out a point.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Name in the legend, or beside a reference line; empty for none.
    pub name: String,
    /// Form in which the data are drawn.
    pub shape: Shape,
    /// Abscissae; the edges of bars, one more than there are bars; the place of a vertical reference line.
    pub x: Vec<f64>,
    /// Ordinates; the heights of bars; the place of a horizontal reference line; empty for a band.
    pub y: Vec<f64>,
    /// Lower ends of error bars, or lower curve of a band.
    pub low: Vec<f64>,
    /// Upper ends of error bars, or upper curve of a band.
    pub high: Vec<f64>,
    /// Colour.
    pub ink: Ink,
    /// Dashes and width of a line; `None` takes those that belong to the colour. Points are joined by a line
    /// only if this is set.
    pub stroke: Option<Stroke>,
    /// Form of markers; `None` takes the one that belongs to the colour.
    pub marker: Option<Marker>,
}

/// Form of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Shape {
    /// Line through points, in their order.
    #[default]
    Line,
    /// Markers with standard uncertainties as bars.
    Points,
    /// Area between two curves.
    Band,
    /// Histogram.
    Bars,
    /// Vertical reference line, named along itself.
    Vertical,
    /// Horizontal reference line, named along itself.
    Horizontal,
    /// No data: a heading in the legend, over the names of the series after it.
    Heading,
}

/// Colour of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Ink {
    /// The next of [`super::colour::SERIES`], with its own dashes and marker.
    #[default]
    Auto,
    /// The colour of this number in [`super::colour::SERIES`], from 0, starting again after the last: for
    /// series that belong together.
    Nth(usize),
    /// Grey, for the background.
    Grey,
    /// Black.
    Black,
    /// White, for lines over a map.
    White,
}

/// Dashes and width of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stroke {
    /// Unbroken.
    Solid,
    /// `– –`
    Dashed,
    /// `· ·`
    Dotted,
    /// `– ·`
    DashDot,
    /// Unbroken, half as wide: for dense data and for lines between points.
    Thin,
}

/// Form of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Marker {
    /// Filled circle.
    Circle,
    /// Open square.
    #[serde(rename = "open-square")]
    Square,
    /// Filled triangle.
    Triangle,
    /// Open diamond.
    #[serde(rename = "open-diamond")]
    Diamond,
    /// Open circle.
    OpenCircle,
    /// Filled square.
    #[serde(rename = "square")]
    FilledSquare,
    /// Upright cross.
    Cross,
    /// Slanting cross.
    Saltire,
    /// Both crosses at once.
    Star,
    /// Open triangle that points down: an upper limit.
    #[serde(rename = "open-limit")]
    Limit,
    /// A letter, to which notes in the frame refer; the legend says what it means.
    #[serde(untagged)]
    Letter(char),
}

impl Series {
    /// A series of any shape, in the next colour.
    pub fn new(
        name: impl Into<String>,
        shape: Shape,
        x: impl Into<Vec<f64>>,
        y: impl Into<Vec<f64>>,
    ) -> Series {
        Series { name: name.into(), shape, x: x.into(), y: y.into(), ..Series::default() }
    }

    /// Line through points, in the next colour and its dashes.
    pub fn line(name: impl Into<String>, x: impl Into<Vec<f64>>, y: impl Into<Vec<f64>>) -> Series {
        Series::new(name, Shape::Line, x, y)
    }

    /// Line of a phase in degrees between −180 and 180: broken where it wraps, rather than drawn across the
    /// frame.
    pub fn phase(name: impl Into<String>, x: &[f64], degrees: &[f64]) -> Series {
        let mut line = Series::line(name, [], []);
        for (x, phase) in x.iter().zip(degrees) {
            if line.y.last().is_some_and(|before| (phase - before).abs() > 180.0) {
                line.x.push(*x);
                line.y.push(f64::NAN);
            }
            line.x.push(*x);
            line.y.push(*phase);
        }
        line
    }

    /// Markers in the next colour and its form, without error bars.
    pub fn points(name: impl Into<String>, x: impl Into<Vec<f64>>, y: impl Into<Vec<f64>>) -> Series {
        Series::new(name, Shape::Points, x, y)
    }

    /// A heading in the legend, over the names of the series after it.
    pub fn heading(words: impl Into<String>) -> Series {
        Series::new(words, Shape::Heading, [], []).ink(Ink::Black)
    }

    /// Area between two curves.
    pub fn band(
        name: impl Into<String>,
        x: impl Into<Vec<f64>>,
        low: impl Into<Vec<f64>>,
        high: impl Into<Vec<f64>>,
    ) -> Series {
        Series { low: low.into(), high: high.into(), ..Series::new(name, Shape::Band, x, []) }
    }

    /// Histogram of the finite values. The bar width is that of Freedman and Diaconis (1981), twice the
    /// interquartile range over the cube root of the count, limited to 5 to 60 bars. 20 bars if the
    /// interquartile range is 0; one bar if all values are equal.
    pub fn histogram(name: impl Into<String>, values: &[f64]) -> Series {
        let (edges, heights) = histogram_of(values);
        Series::new(name, Shape::Bars, edges, heights)
    }

    /// Grey vertical reference line with its name along it.
    pub fn vertical(name: impl Into<String>, at: f64) -> Series {
        Series::new(name, Shape::Vertical, [at], []).ink(Ink::Grey)
    }

    /// Grey horizontal reference line with its name along it.
    pub fn horizontal(name: impl Into<String>, at: f64) -> Series {
        Series::new(name, Shape::Horizontal, [], [at]).ink(Ink::Grey)
    }

    /// Sets the colour.
    pub fn ink(self, ink: Ink) -> Series {
        Series { ink, ..self }
    }

    /// Sets the dashes of a line, or joins points by a line.
    pub fn stroke(self, stroke: Stroke) -> Series {
        Series { stroke: Some(stroke), ..self }
    }

    /// Sets the form of markers.
    pub fn marker(self, marker: Marker) -> Series {
        Series { marker: Some(marker), ..self }
    }

    /// Gives points vertical error bars of these half lengths, in the unit of the ordinate.
    pub fn y_error(mut self, std: impl Into<Vec<f64>>) -> Series {
        let std = std.into();
        let ends = |way: f64| self.y.iter().zip(&std).map(|(y, std)| y + way * std.abs()).collect();
        (self.low, self.high) = (ends(-1.0), ends(1.0));
        self
    }
}

/// Edges of the bars of a histogram, and the number of values in each.
fn histogram_of(values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.abs() <= 1e300).collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(&first), Some(&last)) = (sorted.first(), sorted.last()) else {
        return (Vec::new(), Vec::new());
    };
    let span = last - first;
    if span <= 1e-12 * first.abs().max(last.abs()) {
        let half = if first == 0.0 { 0.5 } else { first.abs() * 0.05 };
        return (vec![first - half, last + half], vec![sorted.len() as f64]);
    }
    let quantile = |q: f64| sorted[(q * (sorted.len() - 1) as f64).round() as usize];
    let width = 2.0 * (quantile(0.75) - quantile(0.25)) / (sorted.len() as f64).cbrt();
    let bars = if width > 0.0 { (span / width).ceil().clamp(5.0, 60.0) } else { 20.0 };
    let mut heights = vec![0.0; bars as usize];
    for value in &sorted {
        let bar = (((value - first) / span * bars) as usize).min(heights.len() - 1);
        heights[bar] += 1.0;
    }
    let edges = (0..=heights.len()).map(|i| first + span * (i as f64 / bars)).collect();
    (edges, heights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_histogram_counts_every_finite_value_once(values in prop::collection::vec(any::<f64>(), 0..200)) {
            let (edges, heights) = histogram_of(&values);
            let finite = values.iter().filter(|v| v.abs() <= 1e300).count();
            prop_assert_eq!(heights.iter().sum::<f64>() as usize, finite);
            prop_assert!(edges.windows(2).all(|w| w[0] < w[1]), "{:?}", edges);
            prop_assert!(finite == 0 || edges.len() == heights.len() + 1);
        }
    }

    #[test]
    fn a_phase_is_broken_where_it_goes_round() {
        let series = Series::phase("", &[1.0, 2.0, 3.0], &[170.0, -170.0, -160.0]);
        assert_eq!(series.x, [1.0, 2.0, 2.0, 3.0]);
        assert!(series.y[1].is_nan() && series.y[2] == -170.0);
    }

    #[test]
    fn equal_values_make_one_bar() {
        assert_eq!(histogram_of(&[2.0; 7]).1, [7.0]);
        assert_eq!(histogram_of(&[0.0; 3]).0, [-0.5, 0.5]);
    }
}
