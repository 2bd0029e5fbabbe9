//! Work on all cores.

use rayon::prelude::*;

/// Results of `work` for each index in `0..n`, in order; computed on all cores.
pub(super) fn each<T: Send>(n: usize, work: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    // Short tasks are handed out in batches of up to 64.
    (0..n).into_par_iter().with_min_len((n / 256).clamp(1, 64)).map(work).collect()
}
