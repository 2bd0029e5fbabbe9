//! Rows of a map as lines of text, so that a map that was cut short can be taken up again.

use super::{Cell, Plan};
use std::fmt::Write as _;
use vibro_record::{Error, Result};

impl Plan {
    /// First lines of the file: what the map is of, and the names of the columns.
    ///
    /// # Errors
    /// If a number of the plan cannot be written.
    pub fn header(&self) -> Result<String> {
        let plan = serde_json::to_string(self).map_err(|e| Error::refused(e.to_string()))?;
        let [y, x] = [self.y, self.x].map(|axis| axis.key.label().0);
        Ok(format!("# vibro model map {plan}\nrow,{y},{x},regime,spectral_radius\n"))
    }

    /// Lines of one row.
    pub fn lines(&self, row: usize, cells: &[Cell]) -> String {
        let y = self.y.value(row);
        let mut text = String::new();
        for (column, cell) in cells.iter().enumerate() {
            let regime = cell.regime.map_or_else(String::new, |r| r.to_string());
            let radius = cell.spectral_radius.map_or_else(String::new, |r| r.to_string());
            // Writing to a string does not fail.
            let _ = writeln!(text, "{row},{y},{},{regime},{radius}", self.x.value(column));
        }
        text
    }

    /// Rows that stand whole in the `text` of a file of this plan, from the first on. A row that was cut short is left out.
    ///
    /// # Errors
    /// If the file is of another map.
    pub fn rows(&self, text: &str) -> Result<Vec<Vec<Cell>>> {
        let header = self.header()?;
        let Some(body) = text.strip_prefix(&header) else {
            return Err(Error::refused(
                "the rows that are there belong to another map: its first line differs",
            )
            .hint("choose another folder, or remove the file")
            .setting("out"));
        };
        // Without its line break the last line may be cut within a number.
        let lines = body.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
        let cells: Vec<(usize, Cell)> = lines.filter_map(parse).collect();
        let rows = cells.chunk_by(|a, b| a.0 == b.0).filter(|row| row.len() == self.x.n).zip(0..self.y.n);
        let next = rows.take_while(|(row, n)| row[0].0 == *n);
        Ok(next.map(|(row, _)| row.iter().map(|(_, cell)| *cell).collect()).collect())
    }
}

fn parse(line: &str) -> Option<(usize, Cell)> {
    let [row, _, _, regime, radius]: [&str; 5] = line.split(',').collect::<Vec<_>>().try_into().ok()?;
    let regime = if regime.is_empty() { None } else { Some(regime.parse().ok()?) };
    let spectral_radius = if radius.is_empty() { None } else { Some(radius.parse().ok()?) };
    Some((row.parse().ok()?, Cell { regime, spectral_radius }))
}
