//! Runs what may panic or never end.

use rayon::prelude::*;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;
use std::sync::mpsc::channel;
use std::time::Duration;

/// Time in s that one answer at a border may take, on a machine that does other things, too: right ones take less than a hundredth of it.
pub(crate) const PATIENCE: f64 = 60.0;

/// How a watched run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Watched<T> {
    /// With an answer.
    Done(T),
    /// With a panic, and its words.
    Crashed(String),
    /// Not within the time it had.
    Stalled,
}

thread_local! {
    /// Whether a panic of this thread is told by the answer alone.
    static SILENT: Cell<bool> = const { Cell::new(false) };
}

/// Panics of watched threads print nothing from now on; those of others do as before.
fn silence() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |panic| {
            if !SILENT.get() {
                before(panic);
            }
        }));
    });
}

/// Runs `f` on a thread of its own for at most `seconds`. One that does not end is left to itself.
pub fn watched<T: Send + 'static>(seconds: f64, f: impl FnOnce() -> T + Send + 'static) -> Watched<T> {
    silence();
    let (send, receive) = channel();
    std::thread::spawn(move || {
        SILENT.set(true);
        // Nobody waits any more where the time is over.
        let _ = send.send(catch_unwind(AssertUnwindSafe(f)));
    });
    match receive.recv_timeout(Duration::from_secs_f64(seconds)) {
        Ok(Ok(answer)) => Watched::Done(answer),
        Ok(Err(panic)) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            Watched::Crashed(
                text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic").to_owned(),
            )
        }
        Err(_) => Watched::Stalled,
    }
}

/// The answers of all tasks, in their order, on as many threads as there are cores. These are not those of rayon's global pool, which what is
/// watched may use itself while they wait for it.
pub(crate) fn side_by_side<T: Send>(tasks: Vec<Box<dyn FnOnce() -> T + Send>>) -> Vec<T> {
    match rayon::ThreadPoolBuilder::new().build() {
        Ok(pool) => pool.install(|| tasks.into_par_iter().map(|task| task()).collect()),
        Err(_) => tasks.into_iter().map(|task| task()).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_panics_and_what_does_not_end_are_told_apart() {
        assert_eq!(watched(10.0, || 7), Watched::Done(7));
        assert_eq!(
            watched(10.0, || -> u8 { panic!("on purpose") }),
            Watched::Crashed("on purpose".to_owned())
        );
        let wait = || std::thread::sleep(Duration::from_secs(1));
        assert_eq!(watched(0.01, wait), Watched::Stalled);
    }

    #[test]
    fn what_is_watched_may_use_the_threads_that_the_tasks_do_not_hold() {
        let sum = || (0..1000_u64).into_par_iter().sum::<u64>();
        let task = |i: u64| -> Box<dyn FnOnce() -> Watched<u64> + Send> {
            Box::new(move || watched(10.0, move || sum() + i))
        };
        let found = side_by_side((0..20).map(task).collect());
        assert_eq!(found, (0..20).map(|i| Watched::Done(499_500 + i)).collect::<Vec<_>>());
    }
}
