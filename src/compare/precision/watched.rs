//! Runs what may panic or never end.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::channel;
use std::time::Duration;

/// Time in s that one answer at a border may take, on a machine that does other things, too: right ones take less than a hundredth of it.
pub const PATIENCE: f64 = 60.0;

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

/// Runs `f` on a thread of its own for at most `seconds`. One that does not end is left to itself.
pub fn watched<T: Send + 'static>(seconds: f64, f: impl FnOnce() -> T + Send + 'static) -> Watched<T> {
    let (send, receive) = channel();
    std::thread::spawn(move || {
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
}
