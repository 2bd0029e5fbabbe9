//! Lines on the page: cut to a frame and thinned to what can be seen.

/// A place in points (1/72 inch): x to the right; y downwards on the page, upwards in a projection.
pub(super) type Point = (f64, f64);

/// A rectangle with sides along the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rect {
    pub x: f64,
    pub y: f64,
    pub w: f64,
    pub h: f64,
}

impl Rect {
    pub fn right(self) -> f64 {
        self.x + self.w
    }

    pub fn bottom(self) -> f64 {
        self.y + self.h
    }

    pub fn middle(self) -> Point {
        (self.x + self.w / 2.0, self.y + self.h / 2.0)
    }

    /// A square around a point; `half` is half of its side.
    pub fn around((x, y): Point, half: f64) -> Rect {
        Rect { x: x - half, y: y - half, w: 2.0 * half, h: 2.0 * half }
    }

    /// The rectangle, larger by `by` on each side.
    pub fn grown(self, by: f64) -> Rect {
        Rect { x: self.x - by, y: self.y - by, w: self.w + 2.0 * by, h: self.h + 2.0 * by }
    }

    /// The corners, from the upper left clockwise.
    pub fn corners(self) -> Vec<Point> {
        let (right, bottom) = (self.right(), self.bottom());
        vec![(self.x, self.y), (right, self.y), (right, bottom), (self.x, bottom)]
    }

    /// The nearest point inside.
    pub fn clamp(self, (x, y): Point) -> Point {
        (x.clamp(self.x, self.right()), y.clamp(self.y, self.bottom()))
    }

    /// Whether a point is inside or on the border.
    pub fn contains(self, (x, y): Point) -> bool {
        (self.x..=self.right()).contains(&x) && (self.y..=self.bottom()).contains(&y)
    }

    /// Whether the other rectangle is inside.
    pub fn holds(self, other: Rect) -> bool {
        self.contains((other.x, other.y)) && self.contains((other.right(), other.bottom()))
    }

    /// Area common to both.
    pub fn overlap(self, other: Rect) -> f64 {
        let w = self.right().min(other.right()) - self.x.max(other.x);
        let h = self.bottom().min(other.bottom()) - self.y.max(other.y);
        w.max(0.0) * h.max(0.0)
    }

    /// Part of a segment that lies inside (Liang and Barsky 1984).
    pub fn cut(self, a: Point, b: Point) -> Option<(Point, Point)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut from, mut to) = (0.0f64, 1.0f64);
        let sides =
            [(-dx, a.0 - self.x), (dx, self.right() - a.0), (-dy, a.1 - self.y), (dy, self.bottom() - a.1)];
        for (direction, distance) in sides {
            if direction == 0.0 {
                if distance < 0.0 {
                    return None;
                }
            } else if direction < 0.0 {
                from = from.max(distance / direction);
            } else {
                to = to.min(distance / direction);
            }
        }
        let at = |t: f64| if t == 1.0 { b } else { (a.0 + t * dx, a.1 + t * dy) };
        (from <= to).then(|| (at(from), at(to)))
    }
}

/// The parts of a line that lie in `frame`. A point that is not finite breaks the line.
pub(super) fn clipped(line: &[Point], frame: Rect) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    for pair in line.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        if ![a.0, a.1, b.0, b.1].iter().all(|v| v.is_finite()) {
            continue;
        }
        if let Some((p, q)) = frame.cut(a, b) {
            match parts.last_mut() {
                Some(part) if part.last() == Some(&p) => part.push(q),
                _ => parts.push(vec![p, q]),
            }
        }
    }
    parts
}

/// Thins a line: no removed point is further than `tolerance` from the new line, in points of 1/72 inch
/// (Douglas and Peucker 1973). A dense line is first reduced to the first, lowest, highest and last point of
/// every 0.25 points of width; the tolerance holds for the rest.
pub(super) fn thinned(line: &[Point], tolerance: f64) -> Vec<Point> {
    let line = by_columns(line, 0.25);
    let Some(last) = line.len().checked_sub(1).filter(|last| *last >= 2) else { return line };
    let mut kept = vec![false; line.len()];
    kept[0] = true;
    kept[last] = true;
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let distances = (from + 1..to).map(|i| (i, distance(line[i], line[from], line[to])));
        if let Some((i, d)) = distances.max_by(|a, b| a.1.total_cmp(&b.1))
            && d > tolerance
        {
            kept[i] = true;
            open.push((from, i));
            open.push((i, to));
        }
    }
    line.iter().zip(kept).filter(|(_, kept)| *kept).map(|(p, _)| *p).collect()
}

/// At most four points in each column of this width: the first, lowest, highest and last. Lines whose points
/// do not ascend in x, or with fewer than five points a column on average, stay unchanged.
fn by_columns(line: &[Point], width: f64) -> Vec<Point> {
    let ascending = line.windows(2).all(|w| w[0].0 <= w[1].0);
    let (Some(first), Some(last)) = (line.first(), line.last()) else { return Vec::new() };
    if !ascending || (line.len() as f64) < 5.0 * (last.0 - first.0) / width {
        return line.to_vec();
    }
    let column = |p: &Point| ((p.0 - first.0) / width).floor();
    let mut kept = Vec::new();
    for run in line.chunk_by(|a, b| column(a) == column(b)) {
        let mut order: Vec<usize> = (0..run.len()).collect();
        order.sort_by(|&a, &b| run[a].1.total_cmp(&run[b].1));
        order = vec![0, order[0], order[run.len() - 1], run.len() - 1];
        order.sort_unstable();
        order.dedup();
        kept.extend(order.into_iter().map(|i| run[i]));
    }
    kept
}

/// Distance of a point from the segment between `a` and `b`.
fn distance(p: Point, a: Point, b: Point) -> f64 {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = dx * dx + dy * dy;
    let t = if length > 0.0 { (((p.0 - a.0) * dx + (p.1 - a.1) * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
    (p.0 - a.0 - t * dx).hypot(p.1 - a.1 - t * dy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FRAME: Rect = Rect { x: 0.0, y: 0.0, w: 10.0, h: 5.0 };

    fn points() -> impl Strategy<Value = Vec<Point>> {
        prop::collection::vec((-20.0..20.0f64, -20.0..20.0f64), 0..40)
    }

    #[test]
    fn a_line_that_leaves_and_returns_has_two_parts() {
        let parts = clipped(&[(1.0, 1.0), (1.0, -5.0), (3.0, -5.0), (3.0, 1.0)], FRAME);
        assert_eq!(parts, [vec![(1.0, 1.0), (1.0, 0.0)], vec![(3.0, 0.0), (3.0, 1.0)]]);
        let broken = clipped(&[(1.0, 1.0), (2.0, 2.0), (f64::NAN, 2.0), (3.0, 1.0), (4.0, 1.0)], FRAME);
        assert_eq!(broken.len(), 2);
    }

    proptest! {
        #[test]
        fn what_is_clipped_lies_in_the_frame(line in points()) {
            let frame = FRAME.grown(1e-9);
            prop_assert!(clipped(&line, FRAME).iter().flatten().all(|p| frame.contains(*p)));
        }

        #[test]
        fn thinning_moves_no_point_further_than_the_tolerance(line in points()) {
            let thin = thinned(&line, 0.5);
            for p in &line {
                let near = thin.windows(2).map(|w| distance(*p, w[0], w[1])).fold(f64::INFINITY, f64::min);
                prop_assert!(near <= 0.5 || line.len() < 2, "{p:?} {thin:?}");
            }
        }

        #[test]
        fn dense_noise_keeps_its_peaks(noise in prop::collection::vec(-9.0..9.0f64, 2000)) {
            let line: Vec<Point> = noise.iter().enumerate().map(|(i, y)| (i as f64 * 0.01, *y)).collect();
            let thin = thinned(&line, 0.0);
            let top = |l: &[Point]| l.iter().map(|p| p.1).fold(f64::NEG_INFINITY, f64::max);
            prop_assert_eq!(top(&line), top(&thin));
            // 20 points of width in columns of 0.25, four points in each, and one partial column.
            prop_assert!(thin.len() <= 4 * 81);
        }
    }
}
