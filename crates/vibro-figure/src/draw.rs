//! From figures to pictures: layout, and the one writer of SVG.

mod canvas;
mod forms;
mod frame;
mod grid;
mod legend;
mod map;
mod notes;
mod plot;
mod style;
mod waterfall;

pub(super) use canvas::Image;
pub use canvas::escaped;

use super::axis::Extent;
use super::figure::{Figure, Panel};
use super::path::Rect;
use super::png;
use canvas::Canvas;
use frame::Insets;
use plot::Sheet;
use vibro_record::Result;

/// A drawn figure, at its size in print.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    name: String,
    size: (f64, f64),
    canvas: Canvas,
}

impl Drawing {
    /// The figure's title.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Width and height in mm.
    pub fn size(&self) -> (f64, f64) {
        self.size
    }

    /// The picture as an SVG document with real text; it refers to nothing outside and has no ids, so that
    /// several can stand in one page.
    pub fn svg(&self) -> String {
        canvas::document(self.size, &self.name, &self.canvas.images, &self.canvas.body)
    }

    /// The picture as PNG of `dpi` dots per inch (30 to 1200; 300 is usual in print), on white, in the
    /// bundled font.
    ///
    /// # Errors
    /// If the picture is too large to be held in memory as pixels.
    pub fn png(&self, dpi: f64) -> Result<Vec<u8>> {
        png::rasterised(self, dpi)
    }

    /// Cell images, which lie under everything else.
    pub(super) fn images(&self) -> &[Image] {
        &self.canvas.images
    }

    /// The picture without its cell images.
    pub(super) fn lines_and_texts(&self) -> String {
        canvas::document(self.size, &self.name, &[], &self.canvas.body)
    }
}

/// White edge around everything.
const EDGE: f64 = 3.0;

/// Lays out the panels and draws them.
pub(super) fn draw(figure: &Figure) -> Drawing {
    // A size that is no size becomes the nearest that is.
    let millimetres = |v: f64| if v.is_nan() { 86.0 } else { v.clamp(20.0, 1000.0) };
    let size = (millimetres(figure.width), millimetres(figure.height));
    let points = 72.0 / 25.4;
    let page = Rect { x: 0.0, y: 0.0, w: size.0 * points, h: size.1 * points }.grown(-EDGE);
    let mut canvas = Canvas::default();
    let columns = figure.columns.clamp(1, figure.panels.len().max(1));
    let mut sheets = sheets(figure, columns);
    let mut layout = Layout::new(&sheets, columns, page, figure.square);
    // A legend that finds no place inside makes its frame smaller, which can cost another its place.
    let mut moved = true;
    while moved {
        moved = false;
        for (i, sheet) in sheets.iter_mut().enumerate() {
            moved |= sheet.as_mut().is_some_and(|sheet| sheet.make_room(layout.frame(i)));
        }
        layout = Layout::new(&sheets, columns, page, figure.square);
    }
    for (i, (panel, sheet)) in figure.panels.iter().zip(&sheets).enumerate() {
        match (panel, sheet) {
            (Panel::Plot(_), Some(sheet)) => sheet.draw(&mut canvas, layout.frame(i)),
            (Panel::Waterfall(waterfall), _) => waterfall::draw(&mut canvas, waterfall, layout.cell(i)),
            (Panel::Grid(classes), _) => grid::draw(&mut canvas, classes, layout.cell(i)),
            (Panel::Plot(_), None) => {}
        }
    }
    Drawing { name: figure.title.clone(), size, canvas }
}

/// All plots with their axes; those over one another have one abscissa where the figure says so.
fn sheets<'a>(figure: &'a Figure, columns: usize) -> Vec<Option<Sheet<'a>>> {
    let across = |panel: &Panel| match panel {
        Panel::Plot(plot) => plot::extents(plot).0,
        Panel::Waterfall(_) | Panel::Grid(_) => Extent::NONE,
    };
    let last_row = figure.panels.len().saturating_sub(columns);
    let sheet = |(i, panel): (usize, &'a Panel)| {
        let Panel::Plot(plot) = panel else { return None };
        let column = figure.panels.iter().skip(i % columns).step_by(columns);
        let shared = column.map(across).fold(Extent::NONE, Extent::joined);
        let (x, named) = if figure.shared_x { (shared, i >= last_row) } else { (across(panel), true) };
        Some(Sheet::new(plot, x, named))
    };
    figure.panels.iter().enumerate().map(sheet).collect()
}

/// Frames in rows and columns, all of one size, with the room that the neediest panel of a row or column
/// takes. Where they are to be square, what is left of the page lies around them.
struct Layout {
    page: Rect,
    columns: Vec<Insets>,
    rows: Vec<Insets>,
    /// Size of a frame.
    size: (f64, f64),
}

impl Layout {
    /// Distance between neighbouring panels.
    const BETWEEN: f64 = 9.0;

    fn new(sheets: &[Option<Sheet<'_>>], columns: usize, page: Rect, square: bool) -> Layout {
        let rows = sheets.len().div_ceil(columns).max(1);
        let empty = || Layout {
            page,
            columns: vec![Insets::default(); columns],
            rows: vec![Insets::default(); rows],
            size: (0.0, 0.0),
        };
        let mut layout = empty();
        layout.fill(square);
        // Ticks, hence the room for their numbers, and that of a legend depend on the size of the frame: thrice is enough.
        for _ in 0..3 {
            let mut next = empty();
            for (i, sheet) in sheets.iter().enumerate() {
                let insets = sheet.as_ref().map_or_else(Insets::default, |sheet| sheet.insets(layout.size));
                let (column, row) = (&mut next.columns[i % columns], &mut next.rows[i / columns]);
                *column = column.wider(insets);
                *row = row.wider(insets);
            }
            next.fill(square);
            layout = next;
        }
        layout
    }

    /// Makes the frames fill the page, or as large as squares can be in its middle.
    fn fill(&mut self, square: bool) {
        let share = |whole: f64, taken: f64, n: usize| {
            ((whole - taken - Layout::BETWEEN * (n - 1) as f64) / n as f64).max(10.0)
        };
        let (columns, rows) = (self.columns.len(), self.rows.len());
        let w = share(self.page.w, self.columns.iter().map(|c| c.left + c.right).sum(), columns);
        let h = share(self.page.h, self.rows.iter().map(|r| r.top + r.bottom).sum(), rows);
        self.size = (w, h);
        if square {
            let side = w.min(h);
            self.size = (side, side);
            self.page.x += 0.5 * (w - side) * columns as f64;
            self.page.y += 0.5 * (h - side) * rows as f64;
        }
    }

    fn frame(&self, index: usize) -> Rect {
        let (column, row) = (index % self.columns.len(), index / self.columns.len());
        let ((w, h), between) = (self.size, Layout::BETWEEN);
        let left: f64 = self.columns[..column].iter().map(|c| c.left + c.right + w + between).sum();
        let above: f64 = self.rows[..row].iter().map(|r| r.top + r.bottom + h + between).sum();
        Rect {
            x: self.page.x + left + self.columns[column].left,
            y: self.page.y + above + self.rows[row].top,
            w,
            h,
        }
    }

    /// Frame with the room around it.
    fn cell(&self, index: usize) -> Rect {
        let frame = self.frame(index);
        let (c, r) = (self.columns[index % self.columns.len()], self.rows[index / self.columns.len()]);
        Rect {
            x: frame.x - c.left,
            y: frame.y - r.top,
            w: frame.w + c.left + c.right,
            h: frame.h + r.top + r.bottom,
        }
    }
}
