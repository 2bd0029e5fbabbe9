//! Limits of the work on a folder: channels of a file, and values held in memory at once.

use super::folder::FileSeries;

/// Most channels of a file that are analysed; further ones are ignored.
pub(super) const CHANNELS: usize = 8;

/// Most values analysed in parallel, at 80 bytes of memory each; larger files are analysed one after the
/// other.
const PARALLEL_VALUES: usize = 1 << 25;

/// Number of files of `values` values each that one core takes as a share of the work: 1 if all cores can
/// work at once, unlimited (one core takes all files) if memory does not suffice for that.
pub(super) fn share(values: usize) -> usize {
    if values.saturating_mul(rayon::current_num_threads()) > PARALLEL_VALUES { usize::MAX } else { 1 }
}

impl FileSeries {
    /// Number of values of a file that are analysed.
    pub(super) fn values(&self) -> usize {
        self.headers.iter().take(CHANNELS).map(|header| header.n).sum()
    }
}
