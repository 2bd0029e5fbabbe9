//! Grids of classes on the page.

use super::canvas::{Anchor, Canvas, Pen};
use super::style::{FRAME, GAP, SMALL};
use crate::colour::{GREY, WHITE};
use crate::font;
use crate::grid::{BETWEEN, Grid, KEY, ROW};
use crate::path::Rect;

/// Size of names and letters.
const SIZE: f64 = 7.4;

/// Least size of the names of columns.
const LEAST: f64 = 5.5;

/// Draws names, cells and the key into `cell`.
pub(super) fn draw(canvas: &mut Canvas, grid: &Grid, cell: Rect) {
    let widest = |names: &mut dyn Iterator<Item = &String>| {
        names.map(|name| font::width(name, SIZE)).fold(0.0, f64::max)
    };
    let groups = widest(&mut grid.rows.iter().map(|r| &r.group)) + 2.0 * GAP;
    let names = widest(&mut grid.rows.iter().map(|r| &r.name)) + 2.0 * GAP;
    let heads = grid.heads();
    let (left, top) = (cell.x + groups + names, cell.y + grid.lines() as f64 * ROW + GAP);
    let count = grid.columns.len().max(1) as f64;
    let width = ((cell.right() - left) / count).clamp(4.0, 60.0);
    // All heads as large as the widest word lets them be.
    let word = widest(&mut heads.iter().flatten());
    let size = (SIZE * (width - 1.0) / word.max(1.0)).clamp(LEAST, SIZE);
    for (i, words) in heads.iter().enumerate() {
        let middle = left + (i as f64 + 0.5) * width;
        for (k, word) in words.iter().rev().enumerate() {
            let at = (middle, top - GAP - k as f64 * (ROW - 1.0));
            canvas.label(&font::fit(word, size, width), at, size, Anchor::Middle);
        }
    }
    let base = 0.5 * ROW + font::DIGIT_HEIGHT * SIZE / 2.0;
    let mut y = top;
    for group in grid.rows.chunk_by(|a, b| a.group == b.group) {
        canvas.label(&group[0].group, (cell.x, y + base), SIZE, Anchor::Start);
        canvas.line((cell.x, y), (left + count * width, y), Pen::solid(GREY, 0.4));
        for row in group {
            canvas.label(&row.name, (left - GAP, y + base), SIZE, Anchor::End);
            for (k, kind) in row.cells.iter().enumerate() {
                let Some(kind) = kind.and_then(|kind| grid.kinds.get(kind)) else { continue };
                let area = Rect { x: left + k as f64 * width, y, w: width, h: ROW };
                canvas.rect(area, kind.colour, Some(Pen::solid(WHITE, 0.6)));
                canvas.label(&kind.letter, (area.middle().0, y + base), SIZE, Anchor::Middle);
            }
            y += ROW;
        }
        y += BETWEEN;
    }
    let (mut x, y) = (cell.x + GAP, cell.bottom() - KEY + 4.0);
    for kind in &grid.kinds {
        let area = Rect { x, y, w: 14.0, h: ROW };
        canvas.rect(area, kind.colour, Some(Pen { width: 0.4, ..FRAME }));
        canvas.label(&kind.letter, (area.middle().0, y + base), SIZE, Anchor::Middle);
        canvas.label(&kind.name, (area.right() + GAP, y + base), SMALL, Anchor::Start);
        x = area.right() + 2.0 * GAP + font::width(&kind.name, SMALL) + 10.0;
    }
}
