//! Where the values of a data set go: into vectors, or into a count and a maximum.

use super::layout::Layout;
use super::spacing::{Digits, Spacing};
use crate::Summary;
use num_complex::Complex64;
use vibro_record::Values;

/// Takes the points of a data set in pieces.
pub trait Sink {
    /// A sink for points of this layout; about `room` of them will come, with an abscissa of these digits.
    fn new(layout: Layout, room: usize, digits: Digits) -> Self;

    /// Takes whole points, each with abscissa (where uneven), real part and imaginary part (where complex).
    fn take(&mut self, numbers: &[f64]);
}

/// Keeps everything.
#[derive(Debug)]
pub struct Kept {
    layout: Layout,
    digits: Digits,
    /// Abscissa values; none where they are even.
    pub abscissa: Vec<f64>,
    /// Values as stored.
    pub values: Values,
}

impl Kept {
    /// How the stored abscissa values are spaced.
    pub fn spacing(&self) -> Spacing {
        let mut spacing = Spacing::new(self.digits);
        for value in &self.abscissa {
            spacing.push(*value);
        }
        spacing
    }
}

impl Sink for Kept {
    fn new(layout: Layout, room: usize, digits: Digits) -> Kept {
        let abscissa = Vec::with_capacity(if layout.even { 0 } else { room });
        let values = if layout.complex {
            Values::Complex(Vec::with_capacity(room))
        } else {
            Values::Real(Vec::with_capacity(room))
        };
        Kept { layout, digits, abscissa, values }
    }

    fn take(&mut self, numbers: &[f64]) {
        match (&mut self.values, self.layout.even) {
            (Values::Real(values), true) => values.extend_from_slice(numbers),
            (Values::Real(values), false) => {
                let points = numbers.as_chunks().0.iter();
                self.abscissa.extend(points.clone().map(|[x, _]| *x));
                values.extend(points.map(|[_, y]| *y));
            }
            (Values::Complex(values), true) => {
                values.extend(numbers.as_chunks().0.iter().map(|[re, im]| Complex64::new(*re, *im)));
            }
            (Values::Complex(values), false) => {
                let points = numbers.as_chunks().0.iter();
                self.abscissa.extend(points.clone().map(|[x, _, _]| *x));
                values.extend(points.map(|[_, re, im]| Complex64::new(*re, *im)));
            }
        }
    }
}

/// Keeps count, maximum and the spacing of the abscissa.
#[derive(Debug)]
pub struct Counted {
    layout: Layout,
    /// Count and largest magnitude, as stored.
    pub summary: Summary,
    /// Abscissa of the largest magnitude, where uneven.
    pub max_at: Option<f64>,
    /// Abscissa values, where uneven.
    pub spacing: Spacing,
}

impl Sink for Counted {
    fn new(layout: Layout, _: usize, digits: Digits) -> Counted {
        Counted { layout, summary: Summary::default(), max_at: None, spacing: Spacing::new(digits) }
    }

    fn take(&mut self, numbers: &[f64]) {
        let mut push = |x: Option<f64>, magnitude: f64| {
            let before = self.summary.max;
            self.summary.push(magnitude);
            if let Some(x) = x {
                self.spacing.push(x);
                if self.summary.max != before {
                    self.max_at = Some(x);
                }
            }
        };
        match (self.layout.complex, self.layout.even) {
            (false, true) => numbers.iter().for_each(|y| push(None, y.abs())),
            (false, false) => numbers.as_chunks().0.iter().for_each(|[x, y]| push(Some(*x), y.abs())),
            (true, true) => numbers.as_chunks().0.iter().for_each(|[re, im]| push(None, re.hypot(*im))),
            (true, false) => {
                numbers.as_chunks().0.iter().for_each(|[x, re, im]| push(Some(*x), re.hypot(*im)));
            }
        }
    }
}
