//! Grids of classes: named rows in groups, named columns, a colour and a letter a cell.

use super::colour::Rgb;

/// What a cell can be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kind {
    /// Name in the key.
    pub name: String,
    /// Letter in the cell: told apart without colour.
    pub letter: String,
    /// Colour of the cell.
    pub colour: Rgb,
}

/// One row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// Group that it belongs to; rows of one group stand together.
    pub group: String,
    /// Name.
    pub name: String,
    /// Kind of each cell by its index; empty for none.
    pub cells: Vec<Option<usize>>,
}

/// A grid of classes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Grid {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// What cells can be.
    pub kinds: Vec<Kind>,
    /// Rows from the top.
    pub rows: Vec<Row>,
}

/// Height of a row, distance between groups, room for names of columns and the key, in points.
pub(super) const ROW: f64 = 9.6;
pub(super) const BETWEEN: f64 = 4.0;
pub(super) const KEY: f64 = 16.0;

impl Grid {
    /// A grid without rows.
    pub fn new(columns: Vec<String>, kinds: Vec<Kind>) -> Grid {
        Grid { columns, kinds, rows: Vec::new() }
    }

    /// Adds a row.
    pub fn row(
        mut self,
        group: impl Into<String>,
        name: impl Into<String>,
        cells: Vec<Option<usize>>,
    ) -> Grid {
        self.rows.push(Row { group: group.into(), name: name.into(), cells });
        self
    }

    /// Names of the columns, cut into words that stand under each other.
    pub(super) fn heads(&self) -> Vec<Vec<String>> {
        self.columns
            .iter()
            .map(|name| name.split_inclusive([' ', '-', '–']).map(|w| w.trim().to_owned()).collect())
            .collect()
    }

    /// Lines that the names of the columns take.
    pub(super) fn lines(&self) -> usize {
        self.heads().iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Height in mm of a figure that it fills.
    pub fn height(&self) -> f64 {
        let groups = self.rows.chunk_by(|a, b| a.group == b.group).count();
        let rows = (self.lines() + self.rows.len()) as f64 * ROW;
        (rows + groups.saturating_sub(1) as f64 * BETWEEN + KEY + 12.0) * 25.4 / 72.0
    }
}
