//! What already stands on the page, so that words can stay clear of it.

use super::forms::Form;
use crate::path::{Point, Rect};

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

    pub(crate) fn add_lines(&mut self, parts: &[Vec<Point>]) {
        self.segments.extend(parts.iter().flat_map(|p| p.windows(2).map(|w| (w[0], w[1]))));
    }

    pub(crate) fn add_box(&mut self, rect: Rect) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_covers_what_crosses_it_and_nothing_else() {
        let mut clutter = Clutter::default();
        clutter.add_lines(&[vec![(0.0, 5.0), (10.0, 5.0)]]);
        clutter.add_box(Rect { x: 20.0, y: 0.0, w: 4.0, h: 4.0 });
        let at = |x, y| Rect { x, y, w: 2.0, h: 2.0 };
        assert_eq!(clutter.under(at(4.0, 6.0)), 0.0);
        assert_eq!(clutter.under(at(4.0, 4.0)), 3.0);
        assert_eq!(clutter.under(at(23.0, 3.0)), 4.0);
        assert_eq!(clutter.crossed((15.0, 2.0), (30.0, 2.0)), 1);
        assert_eq!(clutter.crossed((15.0, 9.0), (30.0, 9.0)), 0);
    }
}
