//! A plot on its sheet: fixes the axes, measures the space around the frame, then draws.

use crate::style::{self, FRAME, GAP, LARGE, LEADING, SMALL, SeriesLook, TICK};
use crate::{
    Anchor, Axis, Canvas, Clutter, Extent, Form, Heatmap, Insets, KeyList, Legend, Place, Plot, Rect, Room,
    Shape, fitted, forms, frame, heatmap, notes,
};
use vibro_record::units::notation::labelled;

/// Largest width of a legend beside the frame, over the frame's width; longer names are cut.
const WIDEST_BESIDE: f64 = 0.55;
/// Least width in points that a frame keeps with the legend beside it: narrower ones, such as all in one
/// column of a journal, get the legend above.
const LEAST_FRAME: f64 = 220.0;
/// Space in points for the name of an axis without ticks, to the left of and below a frame without data.
const NAME_ROOM: f64 = 2.5 * LARGE;

/// A laid-out plot: axes, styles and legend are decided, the frame's rectangle is not yet.
#[derive(Debug)]
pub(super) struct Sheet<'a> {
    plot: &'a Plot,
    /// The axes; `None` where there is nothing to show.
    pub axes: Option<(Axis, Axis)>,
    /// Axis of the colour bar of a map.
    bar: Option<Axis>,
    /// Colour, pen and marker of each series.
    looks: Vec<SeriesLook>,
    /// Entries of the legend.
    keys: KeyList,
    /// Place of the legend; inside the frame while automatic.
    legend: Legend,
    /// Whether the abscissa has numbers and a name; otherwise the panel below shows them.
    named_x: bool,
}

/// Ranges of a plot's abscissae and ordinates on their scales.
pub(super) fn extents(plot: &Plot) -> (Extent, Extent) {
    let (mut across, mut up) = (Extent::NONE, Extent::NONE);
    let (x, y) = (plot.x.scale, plot.y.scale);
    for series in &plot.series {
        let zero: &[f64] = if series.shape == Shape::Bars { &[0.0] } else { &[] };
        across.include(series.x.iter().map(|v| x.of(*v)));
        up.include(series.y.iter().chain(&series.high).chain(zero).map(|v| y.of(*v)));
        up.include(series.low.iter().map(|v| y.of_low(*v)));
    }
    if let Some(map) = &plot.heatmap {
        let (columns, rows) = map.borders(x, y);
        across.include(columns);
        up.include(rows);
    }
    (across, up)
}

impl<'a> Sheet<'a> {
    /// Fixes axes and looks. `shared` is the range of the abscissa, common to the panels of a column if the
    /// figure shares it.
    pub fn new(plot: &'a Plot, shared: Extent, named_x: bool) -> Sheet<'a> {
        let has = |shapes: [Shape; 2]| plot.series.iter().any(|s| shapes.contains(&s.shape));
        // Plots of points or bars without a curve get a margin left and right, so that no marker is cut.
        let needs_margin = has([Shape::Points, Shape::Bars]) && !has([Shape::Line, Shape::Band]);
        // More space above data with notes, which mostly label peaks.
        let above = Room::Above(if plot.notes.is_empty() { 0.06 } else { 0.2 });
        let (x_room, y_room) = match (&plot.heatmap, needs_margin) {
            (Some(_), _) => (Room::Tight, Room::Tight),
            (None, _) if plot.square => (Room::Margin, Room::Margin),
            (None, true) => (Room::Margin, above),
            (None, false) => (Room::Tight, above),
        };
        let (x, y) = extents(plot);
        let axes = Axis::new(&plot.x, shared, x_room).zip(Axis::new(&plot.y, y, y_room));
        // Stated limits alone make no plot: without data there are no axes.
        let axes = axes.filter(|_| !x.is_empty() && !y.is_empty());
        let axes = axes.map(|axes| if plot.square { Axis::alike(axes, (&plot.x, &plot.y)) } else { axes });
        let looks = style::looks(&plot.series);
        let keys = KeyList::new(&plot.series, &looks, plot.heatmap.as_ref());
        let legend = match plot.legend {
            _ if keys.is_empty() || axes.is_none() => Legend::Hidden,
            Legend::Auto if plot.heatmap.is_some() => Legend::Above,
            stated => stated,
        };
        let bar = plot.heatmap.as_ref().and_then(Heatmap::colour_axis);
        Sheet { plot, axes, bar, looks, keys, legend, named_x }
    }

    /// Space around a frame of about this size, in points.
    pub fn insets(&self, (w, h): (f64, f64)) -> Insets {
        let Rect { w, h, .. } = self.within(Rect { x: 0.0, y: 0.0, w, h });
        let size = (w, h);
        let without_axes = Insets { left: NAME_ROOM, bottom: NAME_ROOM, top: SMALL, right: GAP };
        let mut insets =
            self.axes.as_ref().map_or(without_axes, |(x, y)| frame::insets(x, y, size, self.named_x));
        if let Some(bar) = &self.bar {
            insets.right = insets.right.max(heatmap::bar_room(bar, size.1));
        }
        if self.plot.heatmap.is_some() {
            insets.left += TICK;
            insets.bottom += TICK;
        }
        match self.legend {
            Legend::Right => insets.right += GAP + LEADING + self.keys.column(WIDEST_BESIDE * size.0).0,
            Legend::Above => insets.top += self.keys.rows(size.0) + 2.0,
            Legend::Auto | Legend::Hidden => {}
        }
        if !self.plot.title.is_empty() {
            insets.top += 1.35 * LARGE;
        }
        insets
    }

    /// If no free place for the legend exists inside the frame, puts it beside or above; returns whether it
    /// did.
    pub fn move_legend_out(&mut self, frame: Rect) -> bool {
        let frame = self.within(frame);
        let Some(place) = self.place(frame).filter(|_| self.legend == Legend::Auto) else { return false };
        if self.free_place(&place, &Clutter::of(&self.forms(&place))).is_some() {
            return false;
        }
        let beside = self.keys.column(f64::INFINITY).0 + GAP + LEADING;
        self.legend = if frame.w - beside >= LEAST_FRAME { Legend::Right } else { Legend::Above };
        true
    }

    /// Draws the plot with this frame.
    pub fn draw(&self, canvas: &mut Canvas, frame: Rect) {
        let frame = self.within(frame);
        self.draw_title(canvas, frame);
        let Some(place) = self.place(frame) else { return self.draw_nothing(canvas, frame) };
        if let Some(map) = &self.plot.heatmap {
            map.draw(canvas, &place);
        }
        let forms = self.forms(&place);
        for form in &forms {
            form.draw(canvas);
        }
        frame::draw(canvas, &place, self.named_x, self.plot.heatmap.is_some());
        if let Some(bar) = &self.bar {
            heatmap::draw_bar(canvas, bar, frame);
        }
        let mut clutter = Clutter::of(&forms);
        // Area of the legend, and the width of its rows; 0 for a single column.
        let legend_area = match self.legend {
            Legend::Auto => self.free_place(&place, &clutter).map(|free| (free, 0.0)),
            Legend::Right => {
                let (w, h) = self.keys.column(WIDEST_BESIDE * frame.w);
                Some((Rect { x: frame.right() + LEADING, y: frame.y, w, h }, 0.0))
            }
            Legend::Above => {
                let h = self.keys.rows(frame.w);
                Some((Rect { y: frame.y - h - 2.0, h, ..frame }, frame.w))
            }
            Legend::Hidden => None,
        };
        if let Some((area, row)) = legend_area {
            self.keys.draw(canvas, area, row);
            clutter.add_box(area);
        }
        notes::name_lines(canvas, &self.plot.series, &place, &mut clutter);
        notes::write_notes(canvas, &self.plot.notes, &place, &mut clutter);
    }

    /// The frame in this rectangle: for a square plot, the largest square in its middle.
    fn within(&self, room: Rect) -> Rect {
        let side = room.w.min(room.h);
        let inset = |length: f64| (length - side) / 2.0;
        let square = Rect { x: room.x + inset(room.w), y: room.y + inset(room.h), w: side, h: side };
        if self.plot.square && self.axes.is_some() { square } else { room }
    }

    /// The axes in this frame; `None` without data.
    fn place(&self, frame: Rect) -> Option<Place<'_>> {
        self.axes.as_ref().map(|(x, y)| Place { x, y, frame })
    }

    /// All series as drawing primitives in the order of drawing: areas, reference lines, curves, markers.
    /// Filled markers come last, since they are smaller than open ones.
    fn forms(&self, place: &Place<'_>) -> Vec<Form> {
        let layer = |shape: Shape, look: &SeriesLook| match shape {
            Shape::Band => 0,
            Shape::Bars => 1,
            Shape::Vertical | Shape::Horizontal | Shape::Heading => 2,
            Shape::Line => 3,
            Shape::Points if forms::is_open(look.marker) => 4,
            Shape::Points => 5,
        };
        let mut order: Vec<_> = self.plot.series.iter().zip(&self.looks).collect();
        order.sort_by_key(|(series, look)| layer(series.shape, look));
        order.into_iter().flat_map(|(series, look)| forms::forms(series, *look, place)).collect()
    }

    /// A place where the legend covers nothing and leaves notes space beside their points.
    fn free_place(&self, place: &Place<'_>, clutter: &Clutter) -> Option<Rect> {
        let mut clutter = clutter.clone();
        for note in &self.plot.notes {
            clutter.add_box(Rect::around(place.at(note.x, note.y), LEADING));
        }
        self.keys.free_place(place.frame, &clutter)
    }

    /// Draws the title over the frame and the legend.
    fn draw_title(&self, canvas: &mut Canvas, frame: Rect) {
        let legend_height = if self.legend == Legend::Above { self.keys.rows(frame.w) + 2.0 } else { 0.0 };
        let (title, size) = fitted(&self.plot.title, LARGE, frame.w);
        canvas.label(&title, (frame.x, frame.y - legend_height - 0.45 * LARGE), size, Anchor::Start);
    }

    /// An empty frame with the words "no data".
    fn draw_nothing(&self, canvas: &mut Canvas, frame: Rect) {
        canvas.rect(frame, None, Some(FRAME));
        let (x, y) = frame.middle();
        canvas.label("no data", (x, y), LARGE, Anchor::Middle);
        let plot = self.plot;
        if self.named_x {
            let name = labelled(&plot.x.label, &plot.x.unit);
            canvas.label(&name, (x, frame.bottom() + 1.3 * LARGE), LARGE, Anchor::Middle);
        }
        frame::along(canvas, &labelled(&plot.y.label, &plot.y.unit), frame.x - 0.6 * LARGE, frame, GAP);
    }
}
