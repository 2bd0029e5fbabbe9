//! How far a job is.

/// Told how far a job is.
pub trait Progress: Sync {
    /// A part with this many steps begins.
    fn start(&self, what: &str, steps: usize);
    /// One step is done.
    fn step(&self);
    /// So many of all steps are done.
    fn at(&self, done: usize, all: usize);
}

/// Nobody is told.
impl Progress for () {
    fn start(&self, _: &str, _: usize) {}
    fn step(&self) {}
    fn at(&self, _: usize, _: usize) {}
}
