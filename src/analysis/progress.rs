//! Progress of a job.

/// Receiver of the progress of a job.
pub trait Progress: Sync {
    /// A part with this many steps begins.
    fn start(&self, what: &str, steps: usize);
    /// One step is done.
    fn step(&self);
    /// `done` of `all` steps are done.
    fn at(&self, done: usize, all: usize);
    /// The step that follows works at `what`.
    fn on(&self, _what: &str) {}
    /// Lets `print` write lines, which the display of progress does not overwrite.
    fn aside(&self, print: &mut dyn FnMut()) {
        print();
    }
}

/// Ignores the progress.
impl Progress for () {
    fn start(&self, _: &str, _: usize) {}
    fn step(&self) {}
    fn at(&self, _: usize, _: usize) {}
}
