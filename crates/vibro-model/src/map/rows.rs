//! Rows of a map as lines of text, so that a map that was cut short can be taken up again.

use super::{Cell, Plan};
use std::fmt::Write as _;
use vibro_record::{Error, Result};

/// Rows computed so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    rows: Vec<Option<Vec<Cell>>>,
}

impl Rows {
    /// None of the rows of `plan`.
    pub fn none(plan: &Plan) -> Rows {
        Rows { rows: vec![None; plan.y.n] }
    }

    /// A row that has been computed.
    pub fn get(&self, row: usize) -> Option<&[Cell]> {
        self.rows.get(row)?.as_deref()
    }

    /// Enters a row.
    pub fn set(&mut self, row: usize, cells: Vec<Cell>) {
        self.rows[row] = Some(cells);
    }

    /// Number of rows that stand.
    pub fn done(&self) -> usize {
        self.rows.iter().flatten().count()
    }

    /// First lines of the file: what the map is of, and the names of the columns.
    ///
    /// # Errors
    /// If a number of the plan cannot be written.
    pub fn header(plan: &Plan) -> Result<String> {
        let plan_text = serde_json::to_string(plan).map_err(|e| Error::refused(e.to_string()))?;
        let [y, x] = [plan.y, plan.x].map(|axis| axis.key.label().0);
        Ok(format!("# vibro model map {plan_text}\nrow,{y},{x},regime,spectral_radius\n"))
    }

    /// Lines of one row.
    pub fn lines(plan: &Plan, row: usize, cells: &[Cell]) -> String {
        let y = plan.y.value(row);
        let mut text = String::new();
        for (column, cell) in cells.iter().enumerate() {
            let regime = cell.regime.map_or_else(String::new, |r| r.to_string());
            let radius = cell.spectral_radius.map_or_else(String::new, |r| r.to_string());
            // Writing to a string does not fail.
            let _ = writeln!(text, "{row},{y},{},{regime},{radius}", plan.x.value(column));
        }
        text
    }

    /// Rows that stand whole in the `text` of a file of this plan. A row that was cut short is left out.
    ///
    /// # Errors
    /// If the file is of another map.
    pub fn read(plan: &Plan, text: &str) -> Result<Rows> {
        let header = Rows::header(plan)?;
        let Some(body) = text.strip_prefix(&header) else {
            return Err(Error::refused(
                "the rows that are there belong to another map: its first line differs",
            )
            .hint("choose another folder, or remove the file")
            .setting("out"));
        };
        let mut rows = Rows::none(plan);
        // Without its line break the last line may be cut within a number.
        let lines = body.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
        let cells: Vec<(usize, Cell)> = lines.filter_map(parse).filter(|(at, _)| *at < plan.y.n).collect();
        for row in cells.chunk_by(|a, b| a.0 == b.0).filter(|row| row.len() == plan.x.n) {
            rows.set(row[0].0, row.iter().map(|(_, cell)| *cell).collect());
        }
        Ok(rows)
    }
}

fn parse(line: &str) -> Option<(usize, Cell)> {
    let [row, _, _, regime, radius]: [&str; 5] = line.split(',').collect::<Vec<_>>().try_into().ok()?;
    let regime = if regime.is_empty() { None } else { Some(regime.parse().ok()?) };
    let spectral_radius = if radius.is_empty() { None } else { Some(radius.parse().ok()?) };
    Some((row.parse().ok()?, Cell { regime, spectral_radius }))
}
