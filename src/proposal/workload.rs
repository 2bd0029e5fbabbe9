//! How much of a file is analysed, and how much at once.

use super::folder::FileSeries;

/// Channels of a file that are analysed.
pub(super) const CHANNELS: usize = 8;

/// Most values analysed in parallel, at 80 bytes of memory each; larger files are analysed one after the
/// other.
const TOGETHER: usize = 1 << 25;

/// Files of this many values that one core analyses before another core starts.
pub(super) fn share(values: usize) -> usize {
    if values.saturating_mul(rayon::current_num_threads()) > TOGETHER { usize::MAX } else { 1 }
}

impl FileSeries {
    /// Number of values of a file that are analysed.
    pub(super) fn values(&self) -> usize {
        self.headers.iter().take(CHANNELS).map(|header| header.n).sum()
    }
}
