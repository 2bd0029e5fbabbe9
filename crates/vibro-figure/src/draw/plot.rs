//! A plot on its sheet: axes settled, room measured, then drawn.

use super::canvas::{Anchor, Canvas};
use super::clutter::Clutter;
use super::forms::{self, Form};
use super::frame::{self, Insets, Place, fitted, label};
use super::legend::KeyList;
use super::style::{self, FRAME, GAP, LARGE, LEADING, Look, SMALL};
use super::{map, notes};
use crate::axis::{Axis, Extent, Room, Scale};
use crate::figure::{Legend, Plot};
use crate::heatmap::Heatmap;
use crate::path::Rect;
use crate::series::Shape;
use vibro_record::units::notation::labelled;

/// Most room of a legend beside the frame, in parts of the frame's width.
const BESIDE: f64 = 0.55;

/// Where the legend has been put.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Names {
    Nowhere,
    Inside,
    Right,
    Above,
}

/// A plot with everything settled but its place.
#[derive(Debug)]
pub(super) struct Sheet<'a> {
    plot: &'a Plot,
    axes: Option<(Axis, Axis)>,
    looks: Vec<Look>,
    keys: KeyList,
    names: Names,
    named_x: bool,
}

/// Range of a plot's abscissae on their scale.
pub(super) fn x_extent(plot: &Plot) -> Extent {
    let mut extent = Extent::NONE;
    let of = |v: &f64| plot.x.scale.of(*v);
    for series in &plot.series {
        match &series.shape {
            Shape::Line { x, .. } | Shape::Band { x, .. } => extent.include(x.iter().map(of)),
            Shape::Points { x, x_error, .. } => extent.include(spread(x, x_error, plot.x.scale)),
            Shape::Bars { edges, .. } => extent.include(edges.iter().map(of)),
            Shape::Vertical { at } => extent.include([of(at)]),
            Shape::Horizontal { .. } => {}
        }
    }
    if let Some(map) = &plot.heatmap {
        extent.include(map.x_borders(plot.x.scale));
    }
    extent
}

fn y_extent(plot: &Plot) -> Extent {
    let mut extent = Extent::NONE;
    let of = |v: &f64| plot.y.scale.of(*v);
    for series in &plot.series {
        match &series.shape {
            Shape::Line { y, .. } => extent.include(y.iter().map(of)),
            Shape::Points { y, y_error, .. } => extent.include(spread(y, y_error, plot.y.scale)),
            Shape::Band { lower, upper, .. } => extent.include(lower.iter().chain(upper).map(of)),
            Shape::Bars { heights, .. } => extent.include(heights.iter().chain([&0.0]).map(of)),
            Shape::Horizontal { at } => extent.include([of(at)]),
            Shape::Vertical { .. } => {}
        }
    }
    if let Some(map) = &plot.heatmap {
        extent.include(map.y_borders(plot.y.scale));
    }
    extent
}

/// Values with the ends of their error bars; an end that reaches zero on a logarithmic axis says nothing of
/// its limits.
fn spread(values: &[f64], errors: &[f64], scale: Scale) -> Vec<f64> {
    let ends = values.iter().zip(errors).filter(|(_, e)| e.is_finite()).flat_map(|(v, e)| {
        let low = v - e.abs();
        let low = (matches!(scale, Scale::Linear) || low > 0.0).then_some(low);
        [low, Some(v + e.abs())]
    });
    values.iter().copied().chain(ends.flatten()).map(|v| scale.of(v)).collect()
}

impl<'a> Sheet<'a> {
    /// Settles axes and looks; `x` is the range of the abscissa, which panels may share.
    pub fn new(plot: &'a Plot, x: Extent, named_x: bool) -> Sheet<'a> {
        let has = |shape: fn(&Shape) -> bool| plot.series.iter().any(|s| shape(&s.shape));
        let points = has(|s| matches!(s, Shape::Points { .. }));
        let bars = has(|s| matches!(s, Shape::Bars { .. }));
        let curves = has(|s| matches!(s, Shape::Line { .. } | Shape::Band { .. }));
        let (x_room, y_room) = match (plot.heatmap.is_some(), (points || bars) && !curves) {
            (true, _) => (Room::Tight, Room::Tight),
            (false, true) => (Room::Margin, headroom(plot)),
            (false, false) => (Room::Tight, headroom(plot)),
        };
        let axes = Axis::new(&plot.x, x, x_room).zip(Axis::new(&plot.y, y_extent(plot), y_room));
        // Limits without any data are no plot.
        let axes = axes.filter(|_| !x_extent(plot).is_empty() && !y_extent(plot).is_empty());
        let looks = style::looks(&plot.series);
        let keys = KeyList::new(&plot.series, &looks, plot.heatmap.as_ref());
        let names = match plot.legend {
            _ if keys.is_empty() || axes.is_none() => Names::Nowhere,
            Legend::Hidden => Names::Nowhere,
            Legend::Right => Names::Right,
            Legend::Above => Names::Above,
            Legend::Auto if plot.heatmap.is_some() => Names::Above,
            Legend::Auto => Names::Inside,
        };
        Sheet { plot, axes, looks, keys, names, named_x }
    }

    /// Room around a frame of about this size.
    pub(crate) fn insets(&self, size: (f64, f64)) -> Insets {
        let bare = Insets { left: 2.5 * LARGE, bottom: 2.5 * LARGE, top: SMALL, right: GAP };
        let mut insets = self.axes.as_ref().map_or(bare, |(x, y)| {
            let mut insets = frame::insets(x, y, size, self.named_x);
            if let Some(bar) = self.bar() {
                insets = insets.wider(map::insets(&bar, size.1));
            }
            insets
        });
        if self.plot.heatmap.is_some() {
            insets.left += style::TICK;
            insets.bottom += style::TICK;
        }
        match self.names {
            Names::Right => insets.right += GAP + LEADING + self.keys.column(BESIDE * size.0).0,
            Names::Above => insets.top += self.keys.rows(size.0) + 2.0,
            Names::Inside | Names::Nowhere => {}
        }
        if !self.plot.title.is_empty() {
            insets.top += 1.35 * LARGE;
        }
        insets
    }

    /// Moves a legend that has no free place in this frame out of it; says whether it did.
    pub(crate) fn make_room(&mut self, frame: Rect) -> bool {
        let Some(place) = self.place(frame).filter(|_| self.names == Names::Inside) else { return false };
        if self.free_place(&place, &Clutter::of(&self.forms(&place))).is_some() {
            return false;
        }
        let beside = self.keys.column(f64::INFINITY).0 + GAP + LEADING;
        self.names = if frame.w - beside >= 220.0 { Names::Right } else { Names::Above };
        true
    }

    pub fn draw(&self, canvas: &mut Canvas, frame: Rect) {
        self.draw_title(canvas, frame);
        let Some(place) = self.place(frame) else { return self.draw_nothing(canvas, frame) };
        if let Some(map) = &self.plot.heatmap {
            map::draw_cells(canvas, map, &place);
        }
        let forms = self.forms(&place);
        for form in &forms {
            form.draw(canvas);
        }
        frame::draw(canvas, &place, self.named_x, self.plot.heatmap.is_some());
        if let Some(bar) = self.bar() {
            map::draw_bar(canvas, &bar, frame);
        }
        let mut clutter = Clutter::of(&forms);
        match self.names {
            Names::Inside => {
                if let Some(free) = self.free_place(&place, &clutter) {
                    self.keys.draw_column(canvas, free);
                    clutter.add_box(free);
                }
            }
            Names::Right => {
                let (w, h) = self.keys.column(BESIDE * frame.w);
                self.keys.draw_column(canvas, Rect { x: frame.right() + LEADING, y: frame.y, w, h });
            }
            Names::Above => {
                let h = self.keys.rows(frame.w);
                self.keys.draw_rows(canvas, Rect { y: frame.y - h - 2.0, h, ..frame });
            }
            Names::Nowhere => {}
        }
        notes::name_lines(canvas, &self.plot.series, &place, &mut clutter);
        notes::write_notes(canvas, &self.plot.notes, &place, &mut clutter);
    }

    fn place(&self, frame: Rect) -> Option<Place<'_>> {
        self.axes.as_ref().map(|(x, y)| Place { x, y, frame })
    }

    fn bar(&self) -> Option<Axis> {
        self.plot.heatmap.as_ref().and_then(Heatmap::colour_axis)
    }

    /// All series as shapes, areas under lines under markers, open ones under filled ones, which are smaller.
    fn forms(&self, place: &Place<'_>) -> Vec<Form> {
        let layer = |shape: &Shape, look: &Look| match shape {
            Shape::Band { .. } => 0,
            Shape::Bars { .. } => 1,
            Shape::Vertical { .. } | Shape::Horizontal { .. } => 2,
            Shape::Line { .. } => 3,
            Shape::Points { .. } if forms::is_open(look.marker) => 4,
            Shape::Points { .. } => 5,
        };
        let mut order: Vec<_> = self.plot.series.iter().zip(&self.looks).collect();
        order.sort_by_key(|(series, look)| layer(&series.shape, look));
        order.into_iter().flat_map(|(series, look)| forms::forms(series, *look, place)).collect()
    }

    /// Where the legend covers nothing, and leaves notes room beside their points.
    fn free_place(&self, place: &Place<'_>, clutter: &Clutter) -> Option<Rect> {
        let mut clutter = clutter.clone();
        for note in &self.plot.notes {
            clutter.add_box(Rect::around(place.at(note.x, note.y), LEADING));
        }
        self.keys.free_place(place.frame, &clutter)
    }

    fn draw_title(&self, canvas: &mut Canvas, frame: Rect) {
        let names = if self.names == Names::Above { self.keys.rows(frame.w) + 2.0 } else { 0.0 };
        let (title, size) = fitted(&self.plot.title, LARGE, frame.w);
        label(canvas, &title, (frame.x, frame.y - names - 0.45 * LARGE), size, Anchor::Start);
    }

    /// An empty frame that says so.
    fn draw_nothing(&self, canvas: &mut Canvas, frame: Rect) {
        canvas.outline(frame, FRAME);
        let (x, y) = frame.middle();
        label(canvas, "no data", (x, y), LARGE, Anchor::Middle);
        let plot = self.plot;
        if self.named_x {
            let name = labelled(&plot.x.label, &plot.x.unit);
            label(canvas, &name, (x, frame.bottom() + 1.3 * LARGE), LARGE, Anchor::Middle);
        }
        frame::along(canvas, &labelled(&plot.y.label, &plot.y.unit), frame.x - 0.6 * LARGE, frame, GAP);
    }
}

/// More room over data with notes, which mostly name peaks.
fn headroom(plot: &Plot) -> Room {
    Room::Above(if plot.notes.is_empty() { 0.06 } else { 0.2 })
}
