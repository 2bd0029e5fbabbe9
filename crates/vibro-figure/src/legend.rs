//! Legends: the names of series, and a place for them.

use crate::style::{LEADING, MARKER, OUTLINE, SMALL, SeriesLook};
use crate::{Anchor, Canvas, Clutter, Form, Heatmap, Key, Marker, Pen, Point, Rect, Series, Shape, font};

/// Lengths in points of a sample with a line, of one without, and the distance from sample to name.
const SAMPLE: f64 = 18.0;
const SHORT: f64 = 11.0;
const BESIDE: f64 = 4.0;
/// Distances in points between entries in a row, and of a legend from the frame.
const BETWEEN: f64 = 12.0;
const INSET: f64 = 6.0;

/// Entries of a legend: names of series with samples of their look.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct KeyList {
    entries: Vec<LegendEntry>,
}

/// A line of a legend.
#[derive(Debug, Clone, PartialEq)]
struct LegendEntry {
    name: String,
    shape: Shape,
    /// Whether its sample has a line.
    lined: bool,
    look: SeriesLook,
}

impl KeyList {
    /// Entries of all named series and classes. Reference lines carry their names themselves; headings have
    /// no sample.
    pub fn new(series: &[Series], looks: &[SeriesLook], map: Option<&Heatmap>) -> KeyList {
        let mut entries: Vec<LegendEntry> = Vec::new();
        for (series, look) in series.iter().zip(looks) {
            let Series { name, shape, stroke, .. } = series;
            let lined = *shape == Shape::Line || *shape == Shape::Points && stroke.is_some();
            let entry = LegendEntry { name: name.clone(), shape: *shape, lined, look: *look };
            let is_reference = matches!(shape, Shape::Vertical | Shape::Horizontal);
            // A branch in several pieces gets one entry.
            if !name.is_empty() && !is_reference && !entries.contains(&entry) {
                entries.push(entry);
            }
        }
        if let Some(Key::Classes(names)) = map.map(|map| &map.key) {
            entries.extend(names.iter().enumerate().map(|(i, name)| {
                let colour = Heatmap::class_colour(i);
                let pen = Pen::solid(colour, OUTLINE);
                let look = SeriesLook { colour, fill: colour, pen, marker: Marker::Circle };
                LegendEntry { name: name.clone(), shape: Shape::Band, lined: false, look }
            }));
        }
        KeyList { entries }
    }

    /// Whether there are no entries.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Width and height in points as one column, no wider than `room`.
    pub fn column(&self, room: f64) -> (f64, f64) {
        let widest = self.entries.iter().map(|e| self.width(e)).fold(0.0, f64::max);
        (widest.min(room), self.entries.len() as f64 * LEADING)
    }

    /// Height in points, in rows of the width `room`.
    pub fn rows(&self, room: f64) -> f64 {
        self.flow(room).last().map_or(0.0, |(_, row)| (row + 1) as f64 * LEADING)
    }

    /// The first place in a frame where a column covers nothing: corners first, then edges; `None` where
    /// there is none.
    pub fn free_place(&self, frame: Rect, clutter: &Clutter) -> Option<Rect> {
        let (w, h) = self.column(f64::INFINITY);
        let room = frame.grown(-INSET);
        if w > room.w || h > room.h {
            return None;
        }
        // Fractions of the free width and height: upper and lower edge first, then the sides.
        let along_edges = [0.0, 1.0].map(|y| [1.0, 0.0, 0.5, 0.25, 0.75].map(|x| (x, y)));
        let along_sides = [1.0, 0.0].map(|x| [0.5, 0.25, 0.75].map(|y| (x, y)));
        let at = |(x, y)| Rect { x: room.x + x * (room.w - w), y: room.y + y * (room.h - h), w, h };
        let places = along_edges.into_iter().flatten().chain(along_sides.into_iter().flatten()).map(at);
        places.into_iter().find(|place| clutter.under(place.grown(INSET / 2.0)) == 0.0)
    }

    /// Draws the entries from the upper left in rows of the width `room`; one below the other where `room` is
    /// 0.
    pub fn draw(&self, canvas: &mut Canvas, place: Rect, room: f64) {
        for (entry, (x, row)) in self.entries.iter().zip(self.flow(room)) {
            entry.draw(canvas, (place.x + x, place.y + (row as f64 + 0.5) * LEADING), self.sample(), place.w);
        }
    }

    /// Length of all samples in points: one length, so that the names are aligned.
    fn sample(&self) -> f64 {
        if self.entries.iter().any(|e| e.lined) { SAMPLE } else { SHORT }
    }

    /// Width of an entry in points.
    fn width(&self, entry: &LegendEntry) -> f64 {
        let before = if entry.shape == Shape::Heading { 0.0 } else { self.sample() + BESIDE };
        before + font::width(&entry.name, SMALL)
    }

    /// Abscissa in points and row of each entry, in rows of the width `room`.
    fn flow(&self, room: f64) -> Vec<(f64, usize)> {
        let (mut x, mut row) = (0.0, 0);
        let step = |entry: &LegendEntry| {
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

impl LegendEntry {
    /// Draws sample and name from `(x, y)`, the left end of their middle line. `sample` is the length of
    /// the sample, `room` that of the whole entry.
    fn draw(&self, canvas: &mut Canvas, (x, y): Point, sample: f64, room: f64) {
        let SeriesLook { colour, fill, pen, marker } = self.look;
        let middle = (x + sample / 2.0, y);
        let swatch = || vec![Rect { x: middle.0 - 5.0, y: y - 3.2, w: 10.0, h: 6.4 }.corners()];
        if self.lined {
            canvas.line((x, y), (x + sample, y), pen);
        }
        match self.shape {
            Shape::Points => Form::Markers(vec![middle], marker, MARKER, colour).draw(canvas),
            Shape::Band => canvas.areas(&swatch(), fill, None),
            Shape::Bars => canvas.areas(&swatch(), fill, Some(Pen { width: OUTLINE, ..pen })),
            Shape::Line | Shape::Vertical | Shape::Horizontal | Shape::Heading => {}
        }
        let before = if self.shape == Shape::Heading { 0.0 } else { sample + BESIDE };
        let name = font::fit(&self.name, SMALL, room - before + 0.01);
        let at = (x + before, y + font::DIGIT_HEIGHT * SMALL / 2.0);
        canvas.label(&name, at, SMALL, Anchor::Start);
    }
}
