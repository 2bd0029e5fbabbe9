//! Work in a thread of its own: Python shows its progress meanwhile, and may interrupt it.

use crate::refused::exception;
use pyo3::prelude::*;
use std::panic;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use vibroimpact::Result;
use vibroimpact::analysis::Progress;

/// Time between two looks at the progress, and at Ctrl+C.
const LOOK: Duration = Duration::from_millis(50);
/// Stack of the thread in bytes, as that of a main thread on Linux.
const STACK: usize = 8 << 20;

/// Progress of the work, and whether it is to stop.
#[derive(Default)]
struct Watch {
    what: Mutex<String>,
    done: AtomicUsize,
    all: AtomicUsize,
    stop: AtomicBool,
}

/// What ends the thread of work that was interrupted.
struct Interrupted;

impl Watch {
    /// Ends the work if it was interrupted.
    fn check(&self) {
        if self.stop.load(Ordering::Relaxed) {
            panic::resume_unwind(Box::new(Interrupted));
        }
    }
}

impl Progress for Watch {
    fn start(&self, what: &str, steps: usize) {
        what.clone_into(&mut self.what.lock().unwrap_or_else(PoisonError::into_inner));
        self.at(0, steps);
    }

    fn step(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
        self.check();
    }

    fn at(&self, done: usize, all: usize) {
        self.done.store(done, Ordering::Relaxed);
        self.all.store(all, Ordering::Relaxed);
        self.check();
    }
}

/// Runs `work` in a thread. `show` is called with what is being done, how much of it is done, and of how
/// much. An exception that Python raises meanwhile, as at Ctrl+C, is returned at once; the thread then ends
/// at its next report of progress.
pub fn watched<T: Send + 'static>(
    py: Python<'_>,
    show: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&dyn Progress) -> Result<T> + Send + 'static,
) -> PyResult<T> {
    let watch = Arc::new(Watch::default());
    let (send, receive) = channel();
    let of_thread = watch.clone();
    let thread =
        std::thread::Builder::new().name("vibroimpact".to_owned()).stack_size(STACK).spawn(move || {
            // An interrupted caller no longer listens.
            let _ = send.send(work(&*of_thread));
        })?;
    let looked = || -> PyResult<()> {
        py.check_signals()?;
        if let Some(show) = show {
            let what = watch.what.lock().unwrap_or_else(PoisonError::into_inner).clone();
            let [done, all] = [&watch.done, &watch.all].map(|count| count.load(Ordering::Relaxed));
            show.call1((what, done, all))?;
        }
        Ok(())
    };
    // The receiver is only ever used by this thread.
    let receive = Mutex::new(receive);
    loop {
        let next = py.detach(|| receive.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK));
        match next {
            Ok(done) => return done.map_err(|error| exception(py, &error)),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(raised) = looked() {
                    watch.stop.store(true, Ordering::Relaxed);
                    return Err(raised);
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                let why = thread.join().err().unwrap_or_else(|| Box::new("the work ended without a result"));
                panic::resume_unwind(why);
            }
        }
    }
}
