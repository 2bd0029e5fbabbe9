//! Texts among the data: notes beside their points, with leaders (lines from text to point), and names of
//! reference lines.

use crate::style::{LEADER, MARKER, SMALL, TICK};
use crate::{Anchor, BLACK, Canvas, Form, GREY, Note, Place, Point, Rect, Rgb, Series, Shape, Text, font};

/// Height of a text's baseline above the lower edge of its box, as a fraction of the size of small text.
const DESCENT: f64 = 0.16;

/// Cost of a place outside the frame: so high that no such place is chosen.
const OUTSIDE: f64 = 1e5;

/// Cost of a leader that crosses a box: more than that of the longest leader, 50 points.
const CROSSING: f64 = 60.0;

/// Cost of 1 point of covered line, in points of leader: covering data is worse than a longer leader.
const COVERING: f64 = 3.0;

/// A candidate place of a text.
#[derive(Debug, Clone, Copy)]
struct Spot {
    area: Rect,
    /// Whether the text reads upwards.
    vertical: bool,
    /// Start and end of the leader; `None` where the text needs none.
    leader: Option<(Point, Point)>,
    /// Cost of the lines and boxes that the text would cover there, and of its distance.
    cost: f64,
}

/// Names reference lines: along the line where that covers nothing, else beside it with a leader.
pub(super) fn name_lines(canvas: &mut Canvas, series: &[Series], place: &Place<'_>, clutter: &mut Clutter) {
    let frame = place.frame;
    for series in series.iter().filter(|s| !s.name.is_empty()) {
        let (vertical, at) = match (series.shape, &series.x[..], &series.y[..]) {
            (Shape::Vertical, [at, ..], _) => (true, (place.across(place.x.at(*at)), frame.y)),
            (Shape::Horizontal, _, [at, ..]) => (false, (frame.x, place.up(place.y.at(*at)))),
            _ => continue,
        };
        if !frame.contains(at) {
            continue;
        }
        let on_line = along_line(&series.name, if vertical { at.0 } else { at.1 }, vertical, frame, clutter);
        let with_leader = || {
            let (right, down) = if vertical { (0.0, frame.h) } else { (frame.w, 0.0) };
            let parts = (0..20).map(|i| 0.05 + 0.045 * f64::from(i));
            let places = parts.map(|part| (at.0 + part * right, at.1 + part * down));
            best(places.filter_map(|at| around_point(&series.name, at, 0.0, frame, clutter)))
        };
        // Below a cost of 1 nothing is covered: a touched line costs 1.
        let spot = on_line.filter(|spot| spot.cost < 1.0).or_else(with_leader);
        write(canvas, &series.name, spot, GREY, clutter);
    }
}

/// Writes notes near their points where they cover least, with a leader to the point from notes that are
/// further away.
pub(super) fn write_notes(canvas: &mut Canvas, notes: &[Note], place: &Place<'_>, clutter: &mut Clutter) {
    let inside = place.frame.grown(0.01);
    let points = notes.iter().map(|note| (note, place.at(note.x, note.y)));
    let points: Vec<(&Note, Point)> = points.filter(|(_, at)| inside.contains(*at)).collect();
    for (_, at) in &points {
        clutter.add_box(Rect::around(*at, MARKER));
    }
    for (note, at) in points {
        let spot = around_point(&note.text, at, MARKER, place.frame, clutter);
        write(canvas, &note.text, spot, BLACK, clutter);
    }
}

/// Writes a text at its place, if it has one.
fn write(canvas: &mut Canvas, text: &str, spot: Option<Spot>, colour: Rgb, clutter: &mut Clutter) {
    let Some(Spot { area, vertical, leader, .. }) = spot else { return };
    clutter.add_box(area);
    if let Some((from, to)) = leader {
        canvas.line(from, to, LEADER);
    }
    let (at, turn) = if vertical {
        ((area.right() - DESCENT * SMALL, area.bottom()), 90.0)
    } else {
        ((area.x, area.bottom() - DESCENT * SMALL), 0.0)
    };
    canvas.text(Text {
        words: text.to_owned(),
        at,
        size: SMALL,
        anchor: Anchor::Start,
        turn,
        colour,
        halo: true,
    });
}

/// The best place for a name along a line, on either side of it. `line` is the position of the line in
/// points:
/// the abscissa of a vertical line, the ordinate of a horizontal one.
fn along_line(name: &str, line: f64, vertical: bool, frame: Rect, clutter: &Clutter) -> Option<Spot> {
    let length = font::width(name, SMALL);
    let (start, end) = if vertical { (frame.y, frame.bottom()) } else { (frame.x, frame.right()) };
    // Length in points along which the name can be shifted, with 5 points left free at either end.
    let way = end - start - length - 10.0;
    let steps = (0..=12).flat_map(|i| [(i, true), (i, false)]);
    best(steps.filter(|_| way >= 0.0).map(|(i, first)| {
        // Preferred: the upper end of a vertical line, the right end of a horizontal one. The cost below
        // puts the other end second and the middle last.
        let part = f64::from(i) / 12.0;
        let along = start + 5.0 + way * if vertical { part } else { 1.0 - part };
        // Among equal places the one left of or above the line wins.
        let side = if first { line - 1.5 - SMALL } else { line + 1.5 };
        let area = if vertical {
            Rect { x: side, y: along, w: SMALL, h: length }
        } else {
            Rect { x: along, y: side, w: length, h: SMALL }
        };
        let outside = if frame.holds(area) { 0.0 } else { OUTSIDE };
        let cost = outside + clutter.under(area.grown(0.7)) + 0.1 * part.min(1.1 - part);
        Spot { area, vertical, leader: None, cost }
    }))
}

/// The best place for a text around a point whose marker has the half width `taken` in points.
fn around_point(text: &str, at: Point, taken: f64, frame: Rect, clutter: &Clutter) -> Option<Spot> {
    let (w, h) = (font::width(text, SMALL), SMALL);
    let frame = frame.grown(-TICK);
    let rays = (0..24).flat_map(|i| {
        // Straight above first: it wins among equal places.
        let angle = f64::from(i) * std::f64::consts::TAU / 24.0 - std::f64::consts::FRAC_PI_2;
        [4.5, 8.0, 13.0, 19.0, 27.0, 37.0, 50.0].map(|distance| (angle, distance))
    });
    best(rays.map(|(angle, distance)| {
        let from = |r: f64| (at.0 + r * angle.cos(), at.1 + r * angle.sin());
        // The side or corner of the text that faces the point touches the end of the ray. The text is then
        // shifted sideways into the frame.
        let end = from(distance);
        let facing = |c: f64| match c {
            c if c > 0.3 => 0.0,
            c if c < -0.3 => 1.0,
            _ => 0.5,
        };
        let x = (end.0 - facing(angle.cos()) * w).clamp(frame.x, (frame.right() - w).max(frame.x));
        let area = Rect { x, y: end.1 - facing(angle.sin()) * h, w, h };
        let near = (end.0.clamp(area.x, area.right()), end.1.clamp(area.y, area.bottom()));
        let leader = (distance > 6.0).then(|| (from(if taken > 0.0 { taken + 1.0 } else { 0.0 }), near));
        let crossed = leader.map_or(0, |_| clutter.crossed(from(taken + 1.8), near));
        let outside = if frame.holds(area) { 0.0 } else { OUTSIDE };
        let cost = outside + COVERING * clutter.under(area.grown(1.0)) + CROSSING * crossed as f64 + distance;
        Spot { area, vertical: false, leader, cost }
    }))
}

/// The place of least cost; `None` where all are outside the frame.
fn best(spots: impl Iterator<Item = Spot>) -> Option<Spot> {
    spots.min_by(|a, b| a.cost.total_cmp(&b.cost)).filter(|spot| spot.cost < OUTSIDE)
}

/// Lines and boxes on the page that texts shall not cover.
#[derive(Debug, Clone, Default)]
pub(super) struct Clutter {
    segments: Vec<(Point, Point)>,
    boxes: Vec<Rect>,
}

impl Clutter {
    /// The lines and boxes of these drawing primitives.
    pub fn of(forms: &[Form]) -> Clutter {
        let mut clutter = Clutter::default();
        for form in forms {
            form.add_to(&mut clutter);
        }
        clutter
    }

    /// Adds lines, each as its segments.
    pub fn add_lines(&mut self, parts: &[Vec<Point>]) {
        self.segments.extend(parts.iter().flat_map(|p| p.windows(2).map(|w| (w[0], w[1]))));
    }

    /// Adds a box.
    pub fn add_box(&mut self, rect: Rect) {
        self.boxes.push(rect);
    }

    /// Cost of covering lines and boxes by `rect`; 0 if it covers none. A line costs 1 plus its covered
    /// length in points, a box four times the covered area in square points.
    pub fn under(&self, rect: Rect) -> f64 {
        let lines: f64 = self
            .segments
            .iter()
            .filter_map(|&(a, b)| rect.cut(a, b))
            // The 1 counts a line that only touches the box, too.
            .map(|(a, b)| 1.0 + (a.0 - b.0).hypot(a.1 - b.1))
            .sum();
        lines + self.boxes.iter().map(|b| 4.0 * rect.overlap(*b)).sum::<f64>()
    }

    /// Number of boxes that a line from `a` to `b` would cross.
    pub fn crossed(&self, a: Point, b: Point) -> usize {
        self.boxes.iter().filter(|r| r.cut(a, b).is_some()).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FRAME: Rect = Rect { x: 0.0, y: 0.0, w: 300.0, h: 200.0 };

    proptest! {
        /// Four notes always have room in a frame of this size: none may cover another or leave the frame.
        #[test]
        fn notes_stand_clear_of_each_other(points in prop::collection::vec((0.0..300.0f64, 0.0..200.0f64), 1..=4)) {
            let mut clutter = Clutter::default();
            for at in &points {
                clutter.add_box(Rect::around(*at, MARKER));
            }
            let mut areas: Vec<Rect> = Vec::new();
            for at in points {
                let spot = around_point("a note of words", at, MARKER, FRAME, &clutter).unwrap();
                prop_assert!(FRAME.holds(spot.area), "{spot:?}");
                prop_assert!(areas.iter().all(|a| a.overlap(spot.area) == 0.0), "{areas:?} {spot:?}");
                clutter.add_box(spot.area);
                areas.push(spot.area);
            }
        }
    }

    #[test]
    fn a_note_without_neighbours_stands_right_above_its_point() {
        let spot = around_point("peak", (150.0, 100.0), MARKER, FRAME, &Clutter::default()).unwrap();
        assert!(spot.leader.is_none());
        assert!((spot.area.middle().0 - 150.0).abs() < 1e-9 && spot.area.bottom() < 100.0 - MARKER);
    }

    #[test]
    fn a_note_that_cannot_stand_inside_is_left_out() {
        let narrow = Rect { w: 12.0, ..FRAME };
        assert!(around_point("a note of words", (6.0, 100.0), MARKER, narrow, &Clutter::default()).is_none());
    }

    #[test]
    fn a_line_is_named_along_its_free_end() {
        let mut clutter = Clutter::default();
        clutter.add_box(Rect { x: 100.0, y: 0.0, w: 200.0, h: 200.0 });
        let spot = along_line("mean", 100.0, false, FRAME, &clutter).unwrap();
        assert!(spot.cost < 1.0 && spot.area.right() < 100.0, "{spot:?}");
        let spot = along_line("mean", 100.0, true, FRAME, &clutter).unwrap();
        assert!(spot.cost < 1.0 && spot.area.right() < 100.0 && spot.area.y < 20.0, "{spot:?}");
    }

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
