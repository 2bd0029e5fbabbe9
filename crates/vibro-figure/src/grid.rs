//! Grids of classes: rows with names in groups, columns with names, and a colour and a letter in each cell.

use crate::style::{FRAME, GAP, SMALL};
use crate::{Anchor, Canvas, GREY, Pen, Rect, Rgb, WHITE, font};
use serde::{Deserialize, Serialize};

/// A class that a cell can have.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Class {
    /// Name in the key.
    pub name: String,
    /// Letter in the cell, to tell classes apart without colour.
    pub letter: String,
    /// Colour of the cell.
    pub colour: Rgb,
}

/// A row with its name and cells.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Row {
    group: String,
    name: String,
    /// Index of the class of each cell; `None` for an empty cell.
    cells: Vec<Option<usize>>,
}

/// A grid of classes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Grid {
    columns: Vec<String>,
    kinds: Vec<Class>,
    rows: Vec<Row>,
}

/// Size of names and letters in points.
const TEXT_SIZE: f64 = 7.4;

/// Smallest size of the names of columns in points.
const LEAST_TEXT_SIZE: f64 = 5.5;

/// Height of a row, distance between groups, and height of the key, in points.
const ROW_HEIGHT: f64 = 9.6;
const GROUP_DISTANCE: f64 = 4.0;
const KEY_HEIGHT: f64 = 16.0;

impl Grid {
    /// A grid without rows: the names of its columns, and the classes of its cells.
    pub fn new(columns: Vec<String>, kinds: Vec<Class>) -> Grid {
        Grid { columns, kinds, rows: Vec::new() }
    }

    /// Adds a row at the bottom: the group that it shares with its neighbours, its name, and the index of the
    /// class of each cell.
    pub fn row(mut self, group: &str, name: &str, cells: Vec<Option<usize>>) -> Grid {
        self.rows.push(Row { group: group.to_owned(), name: name.to_owned(), cells });
        self
    }

    /// Names of the columns, split into words that are written one below the other.
    fn heads(&self) -> Vec<Vec<String>> {
        self.columns
            .iter()
            .map(|name| name.split_inclusive([' ', '-', '–']).map(|w| w.trim().to_owned()).collect())
            .collect()
    }

    /// Number of lines that the names of the columns need.
    fn lines(&self) -> usize {
        self.heads().iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Height in mm of a figure that contains only this grid.
    pub fn height(&self) -> f64 {
        let groups = self.rows.chunk_by(|a, b| a.group == b.group).count();
        let rows = (self.lines() + self.rows.len()) as f64 * ROW_HEIGHT;
        (rows + groups.saturating_sub(1) as f64 * GROUP_DISTANCE + KEY_HEIGHT + 12.0) * 25.4 / 72.0
    }

    /// Draws names, cells and the key into `cell`.
    pub(super) fn draw(&self, canvas: &mut Canvas, cell: Rect) {
        let widest = |names: &mut dyn Iterator<Item = &String>| {
            names.map(|name| font::width(name, TEXT_SIZE)).fold(0.0, f64::max)
        };
        let groups = widest(&mut self.rows.iter().map(|r| &r.group)) + 2.0 * GAP;
        let names = widest(&mut self.rows.iter().map(|r| &r.name)) + 2.0 * GAP;
        let heads = self.heads();
        let (left, top) = (cell.x + groups + names, cell.y + self.lines() as f64 * ROW_HEIGHT + GAP);
        let count = self.columns.len().max(1) as f64;
        let width = ((cell.right() - left) / count).clamp(4.0, 60.0);
        // One size for the names of all columns: the largest at which the widest word fits its column.
        let word = widest(&mut heads.iter().flatten());
        let size = (TEXT_SIZE * (width - 1.0) / word.max(1.0)).clamp(LEAST_TEXT_SIZE, TEXT_SIZE);
        for (i, words) in heads.iter().enumerate() {
            let middle = left + (i as f64 + 0.5) * width;
            for (k, word) in words.iter().rev().enumerate() {
                let at = (middle, top - GAP - k as f64 * (ROW_HEIGHT - 1.0));
                canvas.label(&font::fit(word, size, width), at, size, Anchor::Middle);
            }
        }
        // Distance in points from the upper edge of a row to the baseline of its texts.
        let base = 0.5 * ROW_HEIGHT + font::DIGIT_HEIGHT * TEXT_SIZE / 2.0;
        let mut y = top;
        for group in self.rows.chunk_by(|a, b| a.group == b.group) {
            canvas.label(&group[0].group, (cell.x, y + base), TEXT_SIZE, Anchor::Start);
            canvas.line((cell.x, y), (left + count * width, y), Pen::solid(GREY, 0.4));
            for row in group {
                canvas.label(&row.name, (left - GAP, y + base), TEXT_SIZE, Anchor::End);
                for (k, kind) in row.cells.iter().enumerate() {
                    let Some(kind) = kind.and_then(|kind| self.kinds.get(kind)) else { continue };
                    let area = Rect { x: left + k as f64 * width, y, w: width, h: ROW_HEIGHT };
                    canvas.rect(area, Some(kind.colour), Some(Pen::solid(WHITE, 0.6)));
                    canvas.label(&kind.letter, (area.middle().0, y + base), TEXT_SIZE, Anchor::Middle);
                }
                y += ROW_HEIGHT;
            }
            y += GROUP_DISTANCE;
        }
        let (mut x, y) = (cell.x + GAP, cell.bottom() - KEY_HEIGHT + 4.0);
        for kind in &self.kinds {
            let area = Rect { x, y, w: 14.0, h: ROW_HEIGHT };
            canvas.rect(area, Some(kind.colour), Some(Pen { width: 0.4, ..FRAME }));
            canvas.label(&kind.letter, (area.middle().0, y + base), TEXT_SIZE, Anchor::Middle);
            canvas.label(&kind.name, (area.right() + GAP, y + base), SMALL, Anchor::Start);
            x = area.right() + 2.0 * GAP + font::width(&kind.name, SMALL) + 10.0;
        }
    }
}
