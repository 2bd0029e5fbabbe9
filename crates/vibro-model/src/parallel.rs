//! Work on all cores where the feature `parallel` is on, else one after the other.

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// What `work` gives for each of `0..n`, in order.
pub(super) fn each<T: Send>(n: usize, work: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    #[cfg(feature = "parallel")]
    // Many short pieces of work are handed out in parts.
    return (0..n).into_par_iter().with_min_len((n / 256).clamp(1, 64)).map(work).collect();
    #[cfg(not(feature = "parallel"))]
    return (0..n).map(work).collect();
}

/// What two pieces of work give.
pub(super) fn both<A: Send, B: Send>(
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    #[cfg(feature = "parallel")]
    return rayon::join(first, second);
    #[cfg(not(feature = "parallel"))]
    return (first(), second());
}
