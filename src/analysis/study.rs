//! Work in independent cells, such as those of a map: done at once, or in parts on several machines.
//!
//! Cells are numbered from 0. The bytes of a cell depend on the study, on its number and on the functions of
//! the machine's library of mathematics, so that parts of any size give the answer of one run, byte for byte.

mod computed;
mod head;
mod part;
mod parts;
mod shard;

pub use computed::Computed;
pub use head::{PLACE, PartHead};
pub use part::{WrittenPart, part_in_memory, write_part};
pub use parts::Parts;
pub use shard::Shard;

use super::answer::Answer;
use super::progress::Progress;
use crate::error::Result;

/// The bytes of cells, in the order of their numbers.
pub type Cells<'a> = dyn Iterator<Item = Result<Vec<u8>>> + 'a;

/// Work in independent cells.
pub trait Study: Sync {
    /// What is computed, in a word or two for the display of progress.
    fn what(&self) -> &'static str;

    /// Number of cells.
    fn cells(&self) -> u64;

    /// Whether several cells are computed at once. Default: yes.
    fn parallel(&self) -> bool {
        true
    }

    /// Whether a cell that is there needs not be computed again. Default: yes.
    fn keeps(&self) -> bool {
        true
    }

    /// What a cell without an answer says; `None` for a cell that has one, as all have by default.
    fn complaint(&self, _cell: &[u8]) -> Option<String> {
        None
    }

    /// Computes a cell: what [`Study::answer`] needs of it.
    ///
    /// # Errors
    /// If nothing can be said of the cell; the part then ends there. A cell that has no answer says so in
    /// its bytes.
    fn cell(&self, number: u64) -> Result<Vec<u8>>;

    /// The answer of all cells, in the order of their numbers.
    ///
    /// # Errors
    /// Those of the cells; if their bytes are not those of this study.
    fn answer(&self, cells: &mut Cells<'_>) -> Result<Answer>;
}

/// The answer of a study, all cells computed here.
///
/// # Errors
/// As [`Study::cell`] and [`Study::answer`].
pub fn whole(study: &dyn Study, progress: &dyn Progress) -> Result<Answer> {
    let all = study.cells();
    study.answer(&mut Computed::new(study, 0..all, all, progress).map(|(_, cell)| cell))
}

#[cfg(test)]
mod tests;
