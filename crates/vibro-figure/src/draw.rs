//! From figures to pictures: layout, and the one writer of SVG.

mod canvas;
mod clutter;
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
    images: Vec<Image>,
    body: String,
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
        canvas::document(self.size, &self.name, &self.images, &self.body)
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
        &self.images
    }

    /// The picture without its cell images.
    pub(super) fn lines_and_texts(&self) -> String {
        canvas::document(self.size, &self.name, &[], &self.body)
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
    let mut sheets = settled(figure, columns);
    let mut grid = Grid::new(&sheets, columns, page, figure.square);
    // A legend that finds no place inside makes its frame smaller, which can cost another its place.
    loop {
        let mut moved = false;
        for (i, sheet) in sheets.iter_mut().enumerate() {
            moved |= sheet.make_room(grid.frame(i));
        }
        if !moved {
            break;
        }
        grid = Grid::new(&sheets, columns, page, figure.square);
    }
    for (i, sheet) in sheets.iter().enumerate() {
        match sheet {
            Settled::Plot(sheet) => sheet.draw(&mut canvas, grid.frame(i)),
            Settled::Waterfall(waterfall) => waterfall::draw(&mut canvas, waterfall, grid.cell(i)),
            Settled::Grid(classes) => grid::draw(&mut canvas, classes, grid.cell(i)),
        }
    }
    Drawing { name: figure.title.clone(), size, images: canvas.images, body: canvas.body }
}

enum Settled<'a> {
    Plot(Sheet<'a>),
    Waterfall(&'a super::waterfall::Waterfall),
    Grid(&'a super::grid::Grid),
}

impl Settled<'_> {
    fn make_room(&mut self, frame: Rect) -> bool {
        match self {
            Settled::Plot(sheet) => sheet.make_room(frame),
            Settled::Waterfall(_) | Settled::Grid(_) => false,
        }
    }

    fn insets(&self, size: (f64, f64)) -> Insets {
        match self {
            Settled::Plot(sheet) => sheet.insets(size),
            Settled::Waterfall(_) | Settled::Grid(_) => Insets::default(),
        }
    }
}

/// All panels with their axes; panels over one another have one abscissa where the figure says so.
fn settled(figure: &Figure, columns: usize) -> Vec<Settled<'_>> {
    let extent = |panel: &Panel| match panel {
        Panel::Plot(plot) => plot::x_extent(plot),
        Panel::Waterfall(_) | Panel::Grid(_) => Extent::NONE,
    };
    let extents: Vec<Extent> = figure.panels.iter().map(extent).collect();
    let last_row = figure.panels.len().saturating_sub(columns);
    let mut settled = Vec::new();
    for (i, panel) in figure.panels.iter().enumerate() {
        settled.push(match panel {
            Panel::Plot(plot) if figure.shared_x => {
                let column = extents.iter().skip(i % columns).step_by(columns);
                let shared = column.fold(Extent::NONE, |a, b| a.joined(*b));
                Settled::Plot(Sheet::new(plot, shared, i >= last_row))
            }
            Panel::Plot(plot) => Settled::Plot(Sheet::new(plot, plot::x_extent(plot), true)),
            Panel::Waterfall(waterfall) => Settled::Waterfall(waterfall),
            Panel::Grid(grid) => Settled::Grid(grid),
        });
    }
    settled
}

/// Frames in rows and columns, all of one size, with the room that the neediest panel of a row or column
/// takes. Where they are to be square, what is left of the page lies around them.
struct Grid {
    page: Rect,
    square: bool,
    columns: Vec<Insets>,
    rows: Vec<Insets>,
}

impl Grid {
    fn new(sheets: &[Settled<'_>], columns: usize, page: Rect, square: bool) -> Grid {
        let rows = sheets.len().div_ceil(columns).max(1);
        let empty = || Grid {
            page,
            square,
            columns: vec![Insets::default(); columns],
            rows: vec![Insets::default(); rows],
        };
        let mut grid = empty();
        // Ticks, hence the room for their numbers, and that of a legend depend on the size of the frame: thrice is enough.
        for _ in 0..3 {
            let size = grid.frame_size();
            let mut next = empty();
            for (i, sheet) in sheets.iter().enumerate() {
                let insets = sheet.insets(size);
                next.columns[i % columns] = next.columns[i % columns].wider(insets);
                next.rows[i / columns] = next.rows[i / columns].wider(insets);
            }
            grid = next;
        }
        grid
    }

    /// Distance between neighbouring panels.
    const BETWEEN: f64 = 9.0;

    /// Size of a frame that fills the page.
    fn filling(&self) -> (f64, f64) {
        let share = |whole: f64, taken: f64, n: usize| {
            ((whole - taken - Grid::BETWEEN * (n - 1) as f64) / n as f64).max(10.0)
        };
        let (columns, rows) = (self.columns.len(), self.rows.len());
        (
            share(self.page.w, self.columns.iter().map(|c| c.left + c.right).sum(), columns),
            share(self.page.h, self.rows.iter().map(|r| r.top + r.bottom).sum(), rows),
        )
    }

    fn frame_size(&self) -> (f64, f64) {
        let (w, h) = self.filling();
        if self.square { (w.min(h), w.min(h)) } else { (w, h) }
    }

    fn frame(&self, index: usize) -> Rect {
        let ((w, h), filling) = (self.frame_size(), self.filling());
        let around = |filling: f64, size: f64, n: usize| 0.5 * (filling - size) * n as f64;
        let (column, row) = (index % self.columns.len(), index / self.columns.len());
        let before = |insets: &[Insets], n: usize, sides: fn(&Insets) -> f64, size: f64| {
            insets.iter().take(n).map(|i| sides(i) + size + Grid::BETWEEN).sum::<f64>()
        };
        let own = (self.columns[column], self.rows[row]);
        Rect {
            x: self.page.x
                + around(filling.0, w, self.columns.len())
                + before(&self.columns, column, |i| i.left + i.right, w)
                + own.0.left,
            y: self.page.y
                + around(filling.1, h, self.rows.len())
                + before(&self.rows, row, |i| i.top + i.bottom, h)
                + own.1.top,
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
