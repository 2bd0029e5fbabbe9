//! A peak of a frequency response function, which a mode may explain.

/// A peak: its line, its bandwidth in Hz as far as the lines show it, and its height above the higher of its
/// valleys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    pub at: usize,
    pub width: f64,
    pub rise: f64,
}
