//! Work in other threads: Python shows its progress meanwhile, and may interrupt it.

use crate::refused::exception;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::any::Any;
use std::panic::{self, AssertUnwindSafe};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use vibroimpact::Result;
use vibroimpact::analysis::Progress;

/// Time between two looks at the progress, and at Ctrl+C.
const LOOK: Duration = Duration::from_millis(50);
/// Stack of a thread in bytes, as that of a main thread on Linux.
const STACK: usize = 8 << 20;

/// The threads, and the process that they belong to.
static THREADS: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The threads of this process. A process that Python forked has none of those of its parent: it gets its own.
fn threads() -> PyResult<Arc<ThreadPool>> {
    let mut known = THREADS.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some((_, threads)) = known.as_ref().filter(|(of, _)| *of == process) {
        return Ok(threads.clone());
    }
    let threads = ThreadPoolBuilder::new().stack_size(STACK).build();
    let threads = Arc::new(threads.map_err(|error| PyRuntimeError::new_err(error.to_string()))?);
    // Dropping the parent's threads would wait for them.
    std::mem::forget(known.replace((process, threads.clone())));
    Ok(threads)
}

/// Progress of the work, and whether it is to stop.
#[derive(Default)]
struct Watch {
    what: Mutex<String>,
    done: AtomicUsize,
    all: AtomicUsize,
    stop: AtomicBool,
}

/// What ends work that was interrupted.
struct Interrupted;

/// The result of work, or what it panicked with.
type Ended<T> = std::result::Result<Result<T>, Box<dyn Any + Send>>;

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

/// Runs `work` in other threads. `show` is called with what is being done, how much of it is done, and of how
/// much. An exception that Python raises meanwhile, as at Ctrl+C, is returned at once; the work then ends at
/// its next report of progress.
pub fn watched<T: Send + 'static>(
    py: Python<'_>,
    show: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&dyn Progress) -> Result<T> + Send + 'static,
) -> PyResult<T> {
    let watch = Arc::new(Watch::default());
    let (send, receive) = channel::<Ended<T>>();
    let of_work = watch.clone();
    threads()?.spawn(move || {
        let ended = panic::catch_unwind(AssertUnwindSafe(|| work(&*of_work)));
        // An interrupted caller no longer listens.
        let _ = send.send(ended);
    });
    let looked = || -> PyResult<()> {
        py.check_signals()?;
        if let Some(show) = show {
            let what = watch.what.lock().unwrap_or_else(PoisonError::into_inner).clone();
            let [done, all] = [&watch.done, &watch.all].map(|count| count.load(Ordering::Relaxed));
            show.call1((what, done, all))?;
        }
        Ok(())
    };
    // Python's lock is given up for the waiting, which needs what other threads may share.
    let receive = Mutex::new(receive);
    loop {
        match py.detach(|| receive.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK)) {
            Ok(Ok(done)) => return done.map_err(|error| exception(py, &error)),
            Ok(Err(panicked)) => panic::resume_unwind(panicked),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(raised) = looked() {
                    watch.stop.store(true, Ordering::Relaxed);
                    return Err(raised);
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the work ended without a result"));
            }
        }
    }
}
