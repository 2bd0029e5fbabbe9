//! What already stands on the page, so that words can stay clear of it.

use super::forms::Form;
use crate::report::path::{Point, Rect};

/// Lines and boxes that words must not cover.
#[derive(Debug, Clone, Default)]
pub(super) struct Clutter {
    segments: Vec<(Point, Point)>,
    boxes: Vec<Rect>,
}

impl Clutter {
    /// What these forms cover.
    pub fn of(forms: &[Form]) -> Clutter {
        let mut clutter = Clutter::default();
        for form in forms {
            form.enter(&mut clutter);
        }
        clutter
    }

    pub fn add_lines(&mut self, parts: &[Vec<Point>]) {
        self.segments.extend(parts.iter().flat_map(|p| p.windows(2).map(|w| (w[0], w[1]))));
    }

    pub fn add_box(&mut self, rect: Rect) {
        self.boxes.push(rect);
    }

    /// How much a box there would cover: nothing at all gives 0.
    pub fn under(&self, rect: Rect) -> f64 {
        let lines: f64 = self
            .segments
            .iter()
            .filter_map(|&(a, b)| rect.cut(a, b))
            // A line that only touches has no length but is touched.
            .map(|(a, b)| 1.0 + (a.0 - b.0).hypot(a.1 - b.1))
            .sum();
        lines + self.boxes.iter().map(|b| 4.0 * rect.overlap(*b)).sum::<f64>()
    }

    /// How many boxes a line from `a` to `b` would cross.
    pub fn crossed(&self, a: Point, b: Point) -> usize {
        self.boxes.iter().filter(|r| r.cut(a, b).is_some()).count()
    }
}
