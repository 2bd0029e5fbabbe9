//! How long an answer takes on this machine.

use std::time::{Duration, Instant};

/// Work that takes longer than this is done once.
const LONG: Duration = Duration::from_micros(200);
/// Times that shorter work is done.
const TIMES: usize = 5;

/// What `work` gives and the time it takes in ns: the shortest of several, where it is short.
pub fn timed<T>(mut work: impl FnMut() -> T) -> (T, f64) {
    let mut once = || {
        let begun = Instant::now();
        let done = work();
        (done, begun.elapsed())
    };
    let (mut done, mut least) = once();
    if least < LONG {
        for _ in 1..TIMES {
            let (again, took) = once();
            (done, least) = (again, least.min(took));
        }
    }
    (done, least.as_nanos() as f64)
}

/// What `work` gives and how long it took, in ns, done once.
pub fn timed_once<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begun = Instant::now();
    let done = work();
    (done, begun.elapsed().as_nanos() as f64)
}
