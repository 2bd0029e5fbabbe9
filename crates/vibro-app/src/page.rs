//! The functions by which a page calls the workbench. The page asks for [`room`], writes the name and the
//! bytes of a file or a request there, and calls a function; then it reads [`answer_bytes`] at
//! [`answer_place`].
#![allow(
    unsafe_code,
    reason = "a name by which a page calls a function is an unsafe attribute; nothing else is unsafe here, but on the page's side the call that reports progress"
)]

use crate::workbench::problem;
use crate::{Reply, Request, Workbench};
use serde_json::json;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use vibroimpact::analysis::Progress;
use vibroimpact::error::Result;

static BENCH: Mutex<Option<Workbench>> = Mutex::new(None);
static INPUT: Mutex<Vec<u8>> = Mutex::new(Vec::new());
static OUTPUT: Mutex<Vec<u8>> = Mutex::new(Vec::new());

#[cfg(target_family = "wasm")]
#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// The page shows that `done` of `all` steps are done of what `len` bytes at `what` name.
    safe fn progress(what: *const u8, len: usize, done: usize, all: usize);
}

/// Elsewhere nobody looks.
#[cfg(not(target_family = "wasm"))]
fn progress(_what: *const u8, _len: usize, _done: usize, _all: usize) {}

/// Progress on the page.
#[derive(Debug, Default)]
struct OnPage {
    /// What is done, and at which file.
    what: Mutex<(String, String)>,
    done: AtomicUsize,
    all: AtomicUsize,
}

impl OnPage {
    fn show(&self) {
        if let Ok(held) = self.what.lock() {
            let (part, file) = &*held;
            let what = if file.is_empty() { part.clone() } else { format!("{part}: {file}") };
            progress(what.as_ptr(), what.len(), self.done.load(Relaxed), self.all.load(Relaxed));
        }
    }
}

impl Progress for OnPage {
    fn start(&self, what: &str, steps: usize) {
        if let Ok(mut held) = self.what.lock() {
            *held = (what.to_owned(), String::new());
        }
        self.at(0, steps);
    }

    fn on(&self, what: &str) {
        if let Ok(mut held) = self.what.lock() {
            what.clone_into(&mut held.1);
        }
        self.show();
    }

    fn step(&self) {
        self.done.fetch_add(1, Relaxed);
        self.show();
    }

    fn at(&self, done: usize, all: usize) {
        self.done.store(done, Relaxed);
        self.all.store(all, Relaxed);
        self.show();
    }
}

/// Makes room for `len` bytes of input, and returns their address; null where memory does not suffice.
#[unsafe(no_mangle)]
pub extern "C" fn room(len: usize) -> *mut u8 {
    let Ok(mut input) = INPUT.lock() else { return std::ptr::null_mut() };
    *input = Vec::new();
    if input.try_reserve_exact(len).is_err() {
        return std::ptr::null_mut();
    }
    input.resize(len, 0);
    input.as_mut_ptr()
}

/// Adds a file: its name in the first `name` bytes of the input, its content behind them. Returns 0 on
/// success, else 1 with an error as the answer.
#[unsafe(no_mangle)]
pub extern "C" fn add(name: usize) -> u32 {
    let mut input = INPUT.lock().map_or_else(|_| Vec::new(), |mut input| std::mem::take(&mut *input));
    let content = input.split_off(name.min(input.len()));
    let name = String::from_utf8_lossy(&input).into_owned();
    with(|bench| bench.add(&name, content).map(|()| Reply::Json(json!({}))))
}

/// Begins anew, for a folder named by the input.
#[unsafe(no_mangle)]
pub extern "C" fn begin() {
    if let (Ok(mut bench), Ok(input)) = (BENCH.lock(), INPUT.lock()) {
        *bench = Some(Workbench::named(&String::from_utf8_lossy(&input)));
    }
}

/// Answers the request in the input. Returns 0 for JSON, 2 for bytes, 1 for an error in JSON.
#[unsafe(no_mangle)]
pub extern "C" fn ask() -> u32 {
    let request = INPUT.lock().map_or_else(|_| Vec::new(), |mut input| std::mem::take(&mut *input));
    let request: serde_json::Result<Request> = serde_json::from_slice(&request);
    with(|bench| {
        let request = request.map_err(|e| vibroimpact::Error::refused(e.to_string()))?;
        bench.answer(&request, &OnPage::default())
    })
}

fn with(work: impl FnOnce(&mut Workbench) -> Result<Reply>) -> u32 {
    let (Ok(mut bench), Ok(mut output)) = (BENCH.lock(), OUTPUT.lock()) else { return 1 };
    let (kind, bytes) = match work(bench.get_or_insert_default()) {
        Ok(Reply::Json(answer)) => (0, answer.to_string().into_bytes()),
        Ok(Reply::Bytes(bytes)) => (2, bytes),
        Err(error) => (1, problem(&error).to_string().into_bytes()),
    };
    *output = bytes;
    kind
}

/// Address of the last answer.
#[unsafe(no_mangle)]
pub extern "C" fn answer_place() -> *const u8 {
    OUTPUT.lock().map_or(std::ptr::null(), |output| output.as_ptr())
}

/// Length of the last answer in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn answer_bytes() -> usize {
    OUTPUT.lock().map_or(0, |output| output.len())
}
