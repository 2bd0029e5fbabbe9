//! Reads columns of a long text a second time, block by block, so that memory is needed for one block only.

use super::fast::{Blocks, RowShape, parsed};
use crate::source::Source;
use std::path::PathBuf;
use vibro_record::{Error, Meta, Place, Result, Stream, units};

/// Columns of a text that are read again block by block and scaled to SI units.
pub(crate) struct Columns {
    path: PathBuf,
    shape: RowShape,
    blocks: Blocks,
    /// Column index from 0 and factor to SI of each channel that is returned.
    handed: Vec<(usize, f64)>,
    /// Values of all columns in one block.
    values: Vec<Vec<f64>>,
}

impl Columns {
    /// Opens the columns of a clean text up to the byte `end`.
    ///
    /// # Errors
    /// If the file cannot be opened.
    pub fn open(source: &Source, shape: RowShape, end: u64, handed: Vec<(usize, f64)>) -> Result<Columns> {
        let blocks = Blocks::of(source, &shape, end)?;
        let values = vec![Vec::new(); shape.columns];
        Ok(Columns { path: source.path().to_owned(), shape, blocks, handed, values })
    }
}

impl Stream for Columns {
    fn append(&mut self, block: &mut Vec<Vec<f64>>) -> Result<usize> {
        let bytes = self.blocks.next().map_err(|e| Error::io("read", &self.path, e))?;
        let Some(n) = bytes.and_then(|bytes| parsed(bytes, &self.shape, &mut self.values)) else {
            let found = "its rows changed while it was read";
            return Err(Error::input(Place::file(&self.path), found, "a file that is written no more"));
        };
        block.resize_with(self.handed.len(), Vec::new);
        for (out, (column, factor)) in block.iter_mut().zip(&self.handed) {
            let from = out.len();
            out.extend_from_slice(&self.values[*column][..n]);
            units::scale(&mut out[from..], *factor).map_err(|e| e.in_file(&self.path))?;
        }
        Ok(n)
    }

    fn keep(&mut self, channels: &[usize]) {
        self.handed = channels.iter().filter_map(|i| self.handed.get(*i).copied()).collect();
    }

    fn finish(&self, _: &mut [Meta]) {}
}
