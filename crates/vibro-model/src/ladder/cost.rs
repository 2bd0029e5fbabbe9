//! How long an answer takes on this machine.

use std::time::{Duration, Instant};

/// Work that takes longer than this is done once.
const LONG: Duration = Duration::from_millis(300);
/// Times that other work is done after a first time, which also fills caches and may be held up by other work.
const TIMES: u32 = 3;

/// The time of an answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// The shortest, in ns.
    pub ns: f64,
    /// Times that were measured.
    pub runs: u32,
}

/// What `work` gives and the time it takes: the shortest of several after a first one, where that was not long and `again` says so.
pub fn timed<T>(again: bool, mut work: impl FnMut() -> T) -> (T, Cost) {
    let mut once = || {
        let begun = Instant::now();
        let done = work();
        (done, begun.elapsed())
    };
    let (mut done, first) = once();
    if !again || first > LONG {
        return (done, Cost { ns: first.as_nanos() as f64, runs: 1 });
    }
    let mut least = Duration::MAX;
    for _ in 0..TIMES {
        let (next, took) = once();
        (done, least) = (next, least.min(took));
    }
    (done, Cost { ns: least.as_nanos() as f64, runs: TIMES })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Work that takes this many ms the first time and hardly any later.
    fn held_up(first: u64, again: bool) -> (u32, Cost) {
        let mut times = 0;
        timed(again, || {
            times += 1;
            if times == 1 {
                std::thread::sleep(Duration::from_millis(first));
            }
            times
        })
    }

    #[test]
    fn a_first_time_that_was_held_up_does_not_count() {
        let (times, cost) = held_up(50, true);
        assert_eq!((times, cost.runs), (4, 3));
        assert!(cost.ns < 25e6, "{cost:?}");
    }

    #[test]
    fn long_work_is_done_once_and_says_so() {
        for (first, again) in [(310, true), (5, false)] {
            let (times, cost) = held_up(first, again);
            assert_eq!((times, cost.runs), (1, 1));
            assert!(cost.ns >= 1e6 * first as f64, "{cost:?}");
        }
    }
}
