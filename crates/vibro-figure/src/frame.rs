//! The frame of a plot: axes, ticks, their numbers and names.

use crate::style::{DESCENT, FRAME, GAP, LARGE, LEADING, SMALL, TICK, TICKS};
use crate::{Anchor, Axis, BLACK, Canvas, Point, Rect, Text, Ticks, font};

/// Space around a frame on each side, in points.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Insets {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

impl Insets {
    /// The larger of both on each side.
    pub fn wider(self, other: Insets) -> Insets {
        Insets {
            left: self.left.max(other.left),
            right: self.right.max(other.right),
            top: self.top.max(other.top),
            bottom: self.bottom.max(other.bottom),
        }
    }
}

/// Two axes with a frame on the page.
#[derive(Debug, Clone)]
pub(super) struct Place<'a> {
    pub x: &'a Axis,
    pub y: &'a Axis,
    pub frame: Rect,
}

impl Place<'_> {
    /// Place on the page of a pair of values; not finite where a value has no place on its axis.
    pub fn at(&self, x: f64, y: f64) -> Point {
        (self.across(self.x.at(x)), self.up(self.y.at(y)))
    }

    /// Abscissa on the page of a fraction of the horizontal axis.
    pub fn across(&self, fraction: f64) -> f64 {
        self.frame.x + fraction * self.frame.w
    }

    /// Ordinate on the page of a fraction of the vertical axis.
    pub fn up(&self, fraction: f64) -> f64 {
        self.frame.bottom() - fraction * self.frame.h
    }
}

/// Ticks along `length` points of a horizontal axis, as many as their numbers allow.
pub(super) fn across(axis: &Axis, length: f64) -> Ticks {
    spread(axis, length, length / 28.0, 6.0, |label| font::width(label, SMALL))
}

/// Ticks along `length` points of a vertical axis, as many as their numbers allow.
pub(super) fn upward(axis: &Axis, length: f64) -> Ticks {
    spread(axis, length, length / 17.0, 2.0, |_| SMALL)
}

/// The most ticks, two to eight and at most `most`, whose numbers do not touch. `size` is the extent of a
/// number along the axis, and `gap` the least distance between two, in points.
fn spread(axis: &Axis, length: f64, most: f64, gap: f64, size: impl Fn(&str) -> f64) -> Ticks {
    let most = (most as usize).clamp(2, 8);
    let touch = |ticks: &Ticks| {
        ticks.major.windows(2).any(|w| {
            let distance = (axis.at_scaled(w[1].at) - axis.at_scaled(w[0].at)) * length;
            distance < f64::midpoint(size(&w[0].label), size(&w[1].label)) + gap
        })
    };
    let mut candidates = (2..=most).rev().map(|most| axis.ticks(most));
    let mut ticks = candidates.find(|ticks| !touch(ticks)).unwrap_or_else(|| axis.ticks(2));
    if touch(&ticks) {
        // Not even two numbers fit: all ticks stay, but only the first tick keeps its label.
        ticks.major.iter_mut().skip(1).for_each(|t| t.label.clear());
    }
    ticks
}

/// Width of the widest number in points.
pub(super) fn widest(ticks: &Ticks) -> f64 {
    ticks.major.iter().map(|t| font::width(&t.label, SMALL)).fold(0.0, f64::max)
}

/// Space that axes need around a frame of about this size, in points.
pub(super) fn insets(x: &Axis, y: &Axis, size: (f64, f64), named_x: bool) -> Insets {
    let (tx, ty) = (across(x, size.0), upward(y, size.1));
    // Length in points by which the number of an outer tick of the abscissa extends beyond the end of the
    // axis.
    let overhang = |at: Option<&crate::ticks::Tick>, end: f64, axis: &Axis| {
        at.map_or(0.0, |t| font::width(&t.label, SMALL) / 2.0 - (axis.at_scaled(t.at) - end).abs() * size.0)
    };
    let (first, last) = (overhang(tx.major.first(), 0.0, x), overhang(tx.major.last(), 1.0, x));
    let name = if y.title.is_empty() { 0.0 } else { LARGE + DESCENT + GAP };
    let bottom = match (named_x, x.title.is_empty()) {
        (false, _) => SMALL / 2.0,
        (true, true) => GAP + SMALL + GAP,
        (true, false) => GAP + LEADING + 1.25 * LARGE,
    };
    Insets {
        left: (name + widest(&ty) + GAP + 1.0).max(first),
        right: last.max(GAP),
        top: SMALL / 2.0 + 1.0,
        bottom,
    }
}

/// An axis along a line on the page.
pub(super) struct Ruler<'a> {
    pub axis: &'a Axis,
    pub ticks: &'a Ticks,
    pub from: Point,
    pub to: Point,
}

/// Side of the axis on which its numbers are written.
#[derive(Clone, Copy)]
pub(super) enum Side {
    Below,
    Left,
    Right,
}

impl Ruler<'_> {
    /// Place on the page of a value on the axis' scale.
    fn at(&self, u: f64) -> Point {
        let t = self.axis.at_scaled(u);
        (self.from.0 + t * (self.to.0 - self.from.0), self.from.1 + t * (self.to.1 - self.from.1))
    }

    /// Tick marks in the direction `way`.
    pub fn marks(&self, way: Point) -> Vec<Vec<Point>> {
        let long = self.ticks.major.iter().map(|tick| (tick.at, TICK));
        let short = self.ticks.minor.iter().map(|at| (*at, TICK / 2.0));
        let mark = |(at, length): (f64, f64)| {
            let (x, y) = self.at(at);
            vec![(x, y), (x + length * way.0, y + length * way.1)]
        };
        long.chain(short).map(mark).collect()
    }

    /// Writes the numbers, `away` points from the axis.
    pub fn numbers(&self, canvas: &mut Canvas, side: Side, away: f64) {
        let beside = font::DIGIT_HEIGHT * SMALL / 2.0;
        let (dx, dy, anchor) = match side {
            Side::Below => (0.0, away + 0.8 * SMALL, Anchor::Middle),
            Side::Left => (-away, beside, Anchor::End),
            Side::Right => (away, beside, Anchor::Start),
        };
        for tick in &self.ticks.major {
            let (x, y) = self.at(tick.at);
            canvas.label(&tick.label, (x + dx, y + dy), SMALL, anchor);
        }
    }
}

/// Draws frame, ticks on all four sides, numbers and names. Over a map the ticks point outwards, below and on
/// the left only.
pub(super) fn draw(canvas: &mut Canvas, place: &Place<'_>, named_x: bool, outside: bool) {
    let frame = place.frame;
    let (tx, ty) = (across(place.x, frame.w), upward(place.y, frame.h));
    let corners = frame.corners();
    let ruler =
        |axis, ticks, from: usize, to: usize| Ruler { axis, ticks, from: corners[from], to: corners[to] };
    let (below, left) = (ruler(place.x, &tx, 3, 2), ruler(place.y, &ty, 3, 0));
    let marks = if outside {
        [below.marks((0.0, 1.0)), left.marks((-1.0, 0.0))].concat()
    } else {
        let (above, right) = (ruler(place.x, &tx, 0, 1), ruler(place.y, &ty, 2, 1));
        let opposite = [above.marks((0.0, 1.0)), right.marks((-1.0, 0.0))].concat();
        [below.marks((0.0, -1.0)), left.marks((1.0, 0.0)), opposite].concat()
    };
    canvas.lines(&marks, TICKS);
    canvas.rect(frame, None, Some(FRAME));
    let away = GAP + if outside { TICK - 1.0 } else { 0.0 };
    left.numbers(canvas, Side::Left, away);
    let beside = frame.x - away - widest(&ty) - GAP - DESCENT;
    along(canvas, &place.y.title, beside, frame, if named_x { 2.0 * LEADING } else { GAP });
    if named_x {
        below.numbers(canvas, Side::Below, away);
        let y = frame.bottom() + away + LEADING + 0.8 * LARGE;
        let (name, size) = fitted(&place.x.title, LARGE, frame.w + 2.0 * LEADING);
        canvas.label(&name, (frame.x + frame.w / 2.0, y), size, Anchor::Middle);
    }
}

/// A name that reads upwards, with its baseline at `x`, beside the middle of `frame`. It extends at most from
/// 4 points above the frame to `below` points under its lower edge.
pub(super) fn along(canvas: &mut Canvas, name: &str, x: f64, frame: Rect, below: f64) {
    /// How far the name may extend above the frame, in points.
    const ABOVE: f64 = 4.0;
    let (name, size) = fitted(name, LARGE, frame.h + ABOVE + below);
    let half = font::width(&name, size) / 2.0;
    let at = (x, frame.middle().1.max(frame.y - ABOVE + half));
    let anchor = Anchor::Middle;
    canvas.text(Text { words: name, at, size, anchor, turn: 90.0, colour: BLACK, halo: false });
}

/// A text and its size, made to fit: at most a quarter smaller, then cut.
pub(super) fn fitted(text: &str, size: f64, room: f64) -> (String, f64) {
    let size = (size * room / font::width(text, size).max(1.0)).clamp(0.75 * size, size);
    (font::fit(text, size, room + 0.01), size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::{AxisSpec, Extent, Room};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_do_not_touch(
            lo in -1e5..1e5f64, span in 1e-3..1e6f64, log: bool, length in 40.0..500.0f64,
        ) {
            let spec = if log { AxisSpec::new("x", "m").log() } else { AxisSpec::new("x", "m") };
            let lo = if log { lo.abs() + 1e-3 } else { lo };
            let axis = Axis::new(&spec.limits(lo, lo + span), Extent::NONE, Room::Tight).unwrap();
            let ticks = across(&axis, length);
            let ends: Vec<(f64, f64)> = ticks
                .major
                .iter()
                .filter(|t| !t.label.is_empty())
                .map(|t| (axis.at_scaled(t.at) * length, font::width(&t.label, SMALL) / 2.0))
                .map(|(at, half)| (at - half, at + half))
                .collect();
            prop_assert!(!ends.is_empty());
            prop_assert!(ends.windows(2).all(|w| w[0].1 < w[1].0), "{ticks:?}");
        }
    }

    #[test]
    fn a_name_too_long_is_made_smaller_and_then_cut() {
        let name = "Displacement amplitude of the passive mass (mm)";
        let whole = font::width(name, LARGE);
        assert_eq!(fitted(name, LARGE, whole), (name.to_owned(), LARGE));
        let (same, smaller) = fitted(name, LARGE, 0.8 * whole);
        assert!(same == name && smaller < LARGE && font::width(&same, smaller) <= 0.8 * whole + 0.02);
        let (cut, size) = fitted(name, LARGE, 0.5 * whole);
        assert!(cut.ends_with('…') && font::width(&cut, size) <= 0.5 * whole + 0.02);
    }
}
