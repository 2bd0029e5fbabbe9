//! The names of series, and the place for them.

use super::canvas::{Anchor, Canvas, Pen};
use super::clutter::Clutter;
use super::forms::markers;
use super::frame::label;
use super::style::{LEADING, Look, MARKER, OUTLINE, SMALL};
use crate::colour::WHITE;
use crate::font;
use crate::heatmap::{Heatmap, Key};
use crate::path::{Point, Rect};
use crate::series::{Series, Shape};

/// Length of a sample with a line and of one without, and its distance from the name.
const SAMPLE: f64 = 18.0;
const SHORT: f64 = 11.0;
const BESIDE: f64 = 4.0;
/// Distance between entries in a row, and of a legend from the frame.
const BETWEEN: f64 = 12.0;
const INSET: f64 = 6.0;

/// Places in a frame to try, as fractions of the free way across and down: corners, then along the edges.
const PLACES: [(f64, f64); 15] = [
    (1.0, 0.0),
    (0.0, 0.0),
    (1.0, 1.0),
    (0.0, 1.0),
    (0.5, 0.0),
    (0.5, 1.0),
    (0.25, 0.0),
    (0.75, 0.0),
    (0.25, 1.0),
    (0.75, 1.0),
    (1.0, 0.5),
    (0.0, 0.5),
    (1.0, 0.25),
    (0.0, 0.25),
    (1.0, 0.75),
];

/// Names with samples.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct KeyList {
    entries: Vec<Entry>,
}

#[derive(Debug, Clone, PartialEq)]
struct Entry {
    name: String,
    sample: Sample,
    look: Look,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Sample {
    Line,
    Points { joined: bool },
    Area,
    Outline,
    Bar,
    Cell,
}

impl KeyList {
    /// Entries of all named series and classes; reference lines carry their names themselves.
    pub fn new(series: &[Series], looks: &[Look], map: Option<&Heatmap>) -> KeyList {
        let mut entries: Vec<Entry> = Vec::new();
        for (series, look) in series.iter().zip(looks).filter(|(s, _)| !s.name.is_empty()) {
            let sample = match &series.shape {
                Shape::Line { .. } => Sample::Line,
                Shape::Points { joined, .. } => Sample::Points { joined: joined.is_some() },
                Shape::Band { .. } => Sample::Area,
                Shape::Bars { filled: true, .. } => Sample::Bar,
                Shape::Bars { filled: false, .. } => Sample::Outline,
                Shape::Vertical { .. } | Shape::Horizontal { .. } => continue,
            };
            let entry = Entry { name: series.name.clone(), sample, look: *look };
            // A branch in several pieces has one entry.
            if !entries.contains(&entry) {
                entries.push(entry);
            }
        }
        if let Some(Key::Classes(names)) = map.map(Heatmap::key) {
            entries.extend(names.iter().enumerate().map(|(i, name)| {
                let colour = Heatmap::class_colour(i);
                let marker = crate::series::Marker::Circle;
                let look = Look { colour, pen: Pen::solid(colour, OUTLINE), marker };
                Entry { name: name.clone(), sample: Sample::Cell, look }
            }));
        }
        KeyList { entries }
    }

    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Width and height as a column no wider than `room`.
    pub fn column(&self, room: f64) -> (f64, f64) {
        let widest = self.entries.iter().map(|e| self.width(e)).fold(0.0, f64::max);
        (widest.min(room), self.entries.len() as f64 * LEADING)
    }

    /// Height in rows of this width.
    pub fn rows(&self, room: f64) -> f64 {
        self.flow(room).last().map_or(0.0, |(_, row)| (row + 1) as f64 * LEADING)
    }

    /// The place in a frame where a column covers nothing: corners first, then edges; `None` where there is
    /// none.
    pub(crate) fn free_place(&self, frame: Rect, clutter: &Clutter) -> Option<Rect> {
        let (w, h) = self.column(f64::INFINITY);
        let room = frame.grown(-INSET);
        if w > room.w || h > room.h {
            return None;
        }
        let at =
            |(x, y): (f64, f64)| Rect { x: room.x + x * (room.w - w), y: room.y + y * (room.h - h), w, h };
        PLACES.into_iter().map(at).find(|place| clutter.under(place.grown(INSET / 2.0)) == 0.0)
    }

    /// Draws the entries under each other.
    pub(crate) fn draw_column(&self, canvas: &mut Canvas, place: Rect) {
        for (i, entry) in self.entries.iter().enumerate() {
            entry.draw(canvas, (place.x, place.y + (i as f64 + 0.5) * LEADING), self.sample(), place.w);
        }
    }

    /// Draws the entries in rows from the upper left.
    pub(crate) fn draw_rows(&self, canvas: &mut Canvas, place: Rect) {
        for (entry, (x, row)) in self.entries.iter().zip(self.flow(place.w)) {
            entry.draw(canvas, (place.x + x, place.y + (row as f64 + 0.5) * LEADING), self.sample(), place.w);
        }
    }

    /// Length of the samples, all alike so that names stand under each other.
    fn sample(&self) -> f64 {
        let line = |e: &Entry| matches!(e.sample, Sample::Line | Sample::Points { joined: true });
        if self.entries.iter().any(line) { SAMPLE } else { SHORT }
    }

    fn width(&self, entry: &Entry) -> f64 {
        self.sample() + BESIDE + font::width(&entry.name, SMALL)
    }

    /// Where each entry begins, and in which row.
    fn flow(&self, room: f64) -> Vec<(f64, usize)> {
        let (mut x, mut row) = (0.0, 0);
        let step = |entry: &Entry| {
            let width = self.width(entry);
            if x > 0.0 && x + width > room {
                (x, row) = (0.0, row + 1);
            }
            let place = (x, row);
            x += width + BETWEEN;
            place
        };
        self.entries.iter().map(step).collect()
    }
}

impl Entry {
    fn draw(&self, canvas: &mut Canvas, (x, y): Point, sample: f64, room: f64) {
        let swatch = Rect { x: x + sample / 2.0 - 5.0, y: y - 3.2, w: 10.0, h: 6.4 };
        let line = ((x, y), (x + sample, y));
        let outline = Pen { width: OUTLINE, ..self.look.pen };
        match self.sample {
            Sample::Line => canvas.line(line.0, line.1, self.look.pen),
            Sample::Points { joined } => {
                if joined {
                    canvas.line(line.0, line.1, self.look.pen);
                }
                markers(canvas, &[(x + sample / 2.0, y)], self.look.marker, MARKER, self.look.colour);
            }
            Sample::Area => canvas.rect(swatch, self.look.colour.tint(0.72), None),
            Sample::Bar => canvas.rect(swatch, self.look.colour.tint(0.6), Some(outline)),
            Sample::Cell => canvas.rect(swatch, self.look.colour, None),
            Sample::Outline => canvas.rect(swatch, WHITE, Some(outline)),
        }
        let name = font::fit(&self.name, SMALL, room - sample - BESIDE + 0.01);
        let at = (x + sample + BESIDE, y + font::DIGIT_HEIGHT * SMALL / 2.0);
        label(canvas, &name, at, SMALL, Anchor::Start);
    }
}
