//! Work on all cores.

use rayon::prelude::*;

/// What `work` gives for each of `0..n`, in order.
pub(super) fn each<T: Send>(n: usize, work: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    // Many short pieces of work are handed out in parts.
    (0..n).into_par_iter().with_min_len((n / 256).clamp(1, 64)).map(work).collect()
}
