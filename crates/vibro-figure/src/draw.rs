//! Draws figures: the layout of their panels.

use crate::canvas::Lettering;
use crate::{Canvas, Extent, Figure, Insets, Panel, Rect, Sheet, canvas, plot};

/// A drawn figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// The figure's title.
    pub name: String,
    /// Width and height in mm before the enlargement by `scale`.
    pub size: (f64, f64),
    /// Enlargement of the output: 1, or 1.6 on a slide.
    pub(super) scale: f64,
    pub(super) canvas: Canvas,
}

impl Drawing {
    /// The picture as an SVG document with real text. It refers to nothing outside and has no ids, so that
    /// several can share one page.
    pub fn svg(&self) -> String {
        let elements = (&*self.canvas.elements, Lettering::Words);
        canvas::document(self.size, self.scale, &self.name, &self.canvas.images, elements)
    }
}

/// White edge around the figure, in points.
const EDGE: f64 = 3.0;

impl Figure {
    /// Draws the figure: lays out the panels and draws each of them. It needs nothing outside the figure, so
    /// figures can be drawn in parallel.
    pub fn draw(&self) -> Drawing {
        // A size outside 20 to 1000 mm is set to the nearest limit; NaN to 86 mm.
        let millimetres = |v: f64| if v.is_nan() { 86.0 } else { v.clamp(20.0, 1000.0) };
        let size = (millimetres(self.width), millimetres(self.height));
        let points = 72.0 / 25.4;
        let page = Rect { x: 0.0, y: 0.0, w: size.0 * points, h: size.1 * points }.grown(-EDGE);
        let mut canvas = Canvas::default();
        let columns = self.columns.clamp(1, self.panels.len().max(1));
        let mut sheets = sheets(self, columns);
        // Repeats until no legend moves: a legend moved out shrinks the frames, so another one may no
        // longer fit inside.
        let layout = loop {
            let layout = Layout::new(&sheets, columns, page);
            let plots = sheets.iter_mut().enumerate().filter_map(|(i, sheet)| Some((i, sheet.as_mut()?)));
            if plots.filter_map(|(i, sheet)| sheet.move_legend_out(layout.frame(i)).then_some(())).count()
                == 0
            {
                break layout;
            }
        };
        for (i, (panel, sheet)) in self.panels.iter().zip(&sheets).enumerate() {
            match (panel, sheet) {
                (Panel::Plot(_), Some(sheet)) => sheet.draw(&mut canvas, layout.frame(i)),
                (Panel::Waterfall(waterfall), _) => waterfall.draw(&mut canvas, layout.cell(i)),
                (Panel::Grid(grid), _) => grid.draw(&mut canvas, layout.cell(i)),
                (Panel::Plot(_), None) => {}
            }
        }
        Drawing { name: self.title.clone(), size, scale: 1.0, canvas }
    }
}

/// All plots with their axes; plots of one column share their abscissa if `shared_x` is set.
fn sheets<'a>(figure: &'a Figure, columns: usize) -> Vec<Option<Sheet<'a>>> {
    let x_extent = |panel: &Panel| match panel {
        Panel::Plot(plot) => plot::extents(plot).0,
        Panel::Waterfall(_) | Panel::Grid(_) => Extent::NONE,
    };
    let last_row = figure.panels.len().saturating_sub(columns);
    let sheet = |(i, panel): (usize, &'a Panel)| {
        let Panel::Plot(plot) = panel else { return None };
        let column = figure.panels.iter().skip(i % columns).step_by(columns);
        let shared = column.map(x_extent).fold(Extent::NONE, Extent::joined);
        let (x, named_x) = if figure.shared_x { (shared, i >= last_row) } else { (x_extent(panel), true) };
        Some(Sheet::new(plot, x, named_x))
    };
    figure.panels.iter().enumerate().map(sheet).collect()
}

/// Frames in rows and columns, all of one size. The margin of a row or column is the largest that one of
/// its panels needs.
struct Layout {
    page: Rect,
    columns: Vec<Insets>,
    rows: Vec<Insets>,
    /// Width and height of a frame in points.
    size: (f64, f64),
}

impl Layout {
    /// Distance between neighbouring panels in points.
    const BETWEEN: f64 = 9.0;

    /// The layout of these sheets on a page.
    fn new(sheets: &[Option<Sheet<'_>>], columns: usize, page: Rect) -> Layout {
        let rows = sheets.len().div_ceil(columns).max(1);
        let no_margins = |n: usize| vec![Insets::default(); n];
        let mut layout = Layout::filling(page, no_margins(columns), no_margins(rows));
        // The margins depend on the size of the frames, by their ticks and legends, and the frames on the
        // margins. Three rounds settle both.
        for _ in 0..3 {
            let (mut across, mut down) = (no_margins(columns), no_margins(rows));
            for (i, sheet) in sheets.iter().enumerate() {
                let insets = sheet.as_ref().map_or_else(Insets::default, |sheet| sheet.insets(layout.size));
                across[i % columns] = across[i % columns].wider(insets);
                down[i / columns] = down[i / columns].wider(insets);
            }
            layout = Layout::filling(page, across, down);
        }
        layout
    }

    /// Gives the frames the largest size that fits the page.
    fn filling(page: Rect, columns: Vec<Insets>, rows: Vec<Insets>) -> Layout {
        let frame_length = |whole: f64, margins: f64, n: usize| {
            ((whole - margins - Layout::BETWEEN * (n - 1) as f64) / n as f64).max(10.0)
        };
        let w = frame_length(page.w, columns.iter().map(|c| c.left + c.right).sum(), columns.len());
        let h = frame_length(page.h, rows.iter().map(|r| r.top + r.bottom).sum(), rows.len());
        Layout { page, columns, rows, size: (w, h) }
    }

    /// The frame of a panel with the margins around it.
    fn cell(&self, index: usize) -> Rect {
        let Layout { page, columns, rows, size: (w, h) } = self;
        let (column, row) = (index % columns.len(), index / columns.len());
        let width = |c: &Insets| c.left + w + c.right;
        let height = |r: &Insets| r.top + h + r.bottom;
        Rect {
            x: page.x + columns[..column].iter().map(|c| width(c) + Layout::BETWEEN).sum::<f64>(),
            y: page.y + rows[..row].iter().map(|r| height(r) + Layout::BETWEEN).sum::<f64>(),
            w: width(&columns[column]),
            h: height(&rows[row]),
        }
    }

    /// The frame of a panel.
    fn frame(&self, index: usize) -> Rect {
        let (cell, (w, h)) = (self.cell(index), self.size);
        let (column, row) = (index % self.columns.len(), index / self.columns.len());
        Rect { x: cell.x + self.columns[column].left, y: cell.y + self.rows[row].top, w, h }
    }
}
