//! Hidden lines by a floating horizon: of lines drawn from front to back, what rises over all before it is
//! seen.

use super::path::Point;

/// The upper envelope of the lines so far, exact: pieces of straight lines in ascending order, with gaps
/// where nothing is.
#[derive(Debug, Clone, Default)]
pub(super) struct Horizon {
    pieces: Vec<Piece>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    from: Point,
    to: Point,
}

/// From which line a part of the envelope comes, to join parts of one piece again.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Source {
    Old(usize),
    New(usize),
}

/// Differences in height below this are ties, and seen: lines that start on the horizon do so up to rounding.
const TIE: f64 = 1e-9;

impl Piece {
    fn at(self, x: f64) -> f64 {
        if x == self.to.0 {
            return self.to.1;
        }
        let t = (x - self.from.0) / (self.to.0 - self.from.0);
        self.from.1 + t * (self.to.1 - self.from.1)
    }

    fn cut(self, from: f64, to: f64) -> Piece {
        Piece { from: (from, self.at(from)), to: (to, self.at(to)) }
    }
}

/// A sweep over old envelope and new line: the envelope of both, and what is seen of the line.
#[derive(Default)]
struct Sweep {
    envelope: Vec<Piece>,
    last: Option<Source>,
    seen: Vec<Vec<Point>>,
    seen_last: Option<usize>,
}

impl Horizon {
    /// The parts of a line that are seen, and the line added to the horizon. Its abscissae ascend; a vertical
    /// step in it is no obstacle.
    pub(super) fn raise(&mut self, line: &[Point]) -> Vec<Vec<Point>> {
        let sweep = self.sweep(line);
        self.pieces = sweep.envelope;
        sweep.seen
    }

    /// The parts of a line that are seen, without adding it.
    pub(super) fn seen(&self, line: &[Point]) -> Vec<Vec<Point>> {
        self.sweep(line).seen
    }

    /// Whether a point is seen.
    pub(super) fn shows(&self, (x, y): Point) -> bool {
        let at = self.pieces.partition_point(|p| p.to.0 < x);
        self.pieces.get(at).is_none_or(|p| p.from.0 > x || y >= p.at(x) - TIE)
    }

    fn sweep(&self, line: &[Point]) -> Sweep {
        let new: Vec<Piece> = line
            .windows(2)
            .map(|w| Piece { from: w[0], to: w[1] })
            .filter(|p| p.from.0 < p.to.0 && [p.from.1, p.to.1].iter().all(|y| y.is_finite()))
            .collect();
        let mut sweep = Sweep::default();
        let (mut i, mut j, mut x) = (0, 0, f64::NEG_INFINITY);
        loop {
            let (old, new) = (self.pieces.get(i), new.get(j));
            let begins = |p: Option<&Piece>| p.map_or(f64::INFINITY, |p| p.from.0.max(x));
            let (a_old, a_new) = (begins(old), begins(new));
            let from = a_old.min(a_new);
            let ends = |p: Option<&Piece>, begin: f64| {
                p.map_or(f64::INFINITY, |p| if begin <= from { p.to.0 } else { begin })
            };
            let to = ends(old, a_old).min(ends(new, a_new));
            match (old.filter(|_| a_old <= from), new.filter(|_| a_new <= from)) {
                (None, None) => return sweep,
                (Some(h), None) => sweep.keep(h.cut(from, to), Source::Old(i)),
                (None, Some(l)) => {
                    sweep.keep(l.cut(from, to), Source::New(j));
                    sweep.see(l.cut(from, to), j);
                }
                (Some(h), Some(l)) => sweep.compare((*h, i), (*l, j), from, to),
            }
            x = to;
            i += usize::from(old.is_some_and(|p| p.to.0 <= x));
            j += usize::from(new.is_some_and(|p| p.to.0 <= x));
        }
    }
}

impl Sweep {
    /// Both reach from `from` to `to`: the higher is kept, and the line is seen where it is that.
    fn compare(&mut self, (old, i): (Piece, usize), (new, j): (Piece, usize), from: f64, to: f64) {
        let (a, b) = (new.at(from) - old.at(from), new.at(to) - old.at(to));
        let (up_a, up_b) = (a >= -TIE, b >= -TIE);
        let cross = if up_a == up_b { to } else { (from + (to - from) * (a / (a - b))).clamp(from, to) };
        for (from, to, up) in [(from, cross, up_a), (cross, to, up_b)] {
            if from < to && up {
                self.keep(new.cut(from, to), Source::New(j));
                self.see(new.cut(from, to), j);
            } else if from < to {
                self.keep(old.cut(from, to), Source::Old(i));
            }
        }
    }

    fn keep(&mut self, piece: Piece, source: Source) {
        match self.envelope.last_mut() {
            Some(last) if self.last == Some(source) && last.to.0 == piece.from.0 => last.to = piece.to,
            _ => self.envelope.push(piece),
        }
        self.last = Some(source);
    }

    fn see(&mut self, piece: Piece, source: usize) {
        let joins = |part: &Vec<Point>| {
            part.last().is_some_and(|p| p.0 == piece.from.0 && (p.1 - piece.from.1).abs() <= TIE)
        };
        match self.seen.last_mut().filter(|part| joins(part)) {
            Some(part) => {
                if self.seen_last == Some(source) {
                    part.pop();
                }
                part.push(piece.to);
            }
            None => self.seen.push(vec![piece.from, piece.to]),
        }
        self.seen_last = Some(source);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Height of a line at x; minus infinity beside it.
    fn height(line: &[Point], x: f64) -> f64 {
        line.windows(2)
            .filter(|w| w[0].0 < w[1].0 && (w[0].0..=w[1].0).contains(&x))
            .map(|w| w[0].1 + (x - w[0].0) / (w[1].0 - w[0].0) * (w[1].1 - w[0].1))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    fn lines() -> impl Strategy<Value = Vec<Vec<Point>>> {
        let line = (0.0..9.0f64, prop::collection::vec((0.01..2.0f64, 0.0..5.0f64), 2..25));
        prop::collection::vec(line, 1..12).prop_map(|lines| {
            lines
                .into_iter()
                .map(|(start, steps)| {
                    let mut x = start;
                    steps.into_iter().map(|(dx, y)| ((x, y), x += dx).0).collect()
                })
                .collect()
        })
    }

    proptest! {
        /// Against the definition: a place of a line is seen exactly where no line before it is higher.
        #[test]
        fn a_line_is_seen_where_nothing_before_it_is_higher(lines in lines()) {
            let mut horizon = Horizon::default();
            for (n, line) in lines.iter().enumerate() {
                let front = |x: f64| lines[..n].iter().map(|l| height(l, x)).fold(f64::NEG_INFINITY, f64::max);
                let seen = horizon.raise(line);
                let (first, last) = (line[0].0, line[line.len() - 1].0);
                for i in 0..=400 {
                    let x = first + (last - first) * f64::from(i) / 400.0;
                    let (own, before) = (height(line, x), front(x));
                    // Next to a crossing rounding decides; slopes reach 5/0.01, times the rounding of x near
                    // 60. The last place may lie beyond the line by rounding.
                    if own == f64::NEG_INFINITY || (own - before).abs() < 1e-8 {
                        continue;
                    }
                    let shown = seen.iter().map(|part| height(part, x)).fold(f64::NEG_INFINITY, f64::max);
                    if own > before {
                        prop_assert!((shown - own).abs() < 1e-8, "line {n} hidden at {x}: {own} over {before}");
                    } else {
                        prop_assert!(shown == f64::NEG_INFINITY, "line {n} seen at {x}: {own} under {before}");
                    }
                    prop_assert_eq!(horizon.shows((x, own)), own > before, "{} {}", x, own);
                }
            }
        }
    }

    #[test]
    fn parts_are_joined_and_not_split_at_the_corners_of_others() {
        let mut horizon = Horizon::default();
        horizon.raise(&[(0.0, 0.0), (1.0, 0.5), (2.0, 0.0), (3.0, 0.5), (4.0, 0.0)]);
        assert_eq!(horizon.raise(&[(0.0, 1.0), (4.0, 1.0)]), [vec![(0.0, 1.0), (4.0, 1.0)]]);
        assert_eq!(horizon.pieces.len(), 1);
    }

    #[test]
    fn a_gap_hides_nothing() {
        let mut horizon = Horizon::default();
        horizon.raise(&[(0.0, 5.0), (1.0, 5.0)]);
        horizon.raise(&[(2.0, 5.0), (3.0, 5.0)]);
        let seen = horizon.raise(&[(0.0, 1.0), (3.0, 1.0)]);
        assert_eq!(seen, [vec![(1.0, 1.0), (2.0, 1.0)]]);
        assert!(horizon.seen(&[(f64::NAN, 1.0), (2.0, f64::NAN)]).is_empty());
    }
}
