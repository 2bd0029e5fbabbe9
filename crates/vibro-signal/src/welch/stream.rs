//! Averages of a signal that somebody else reads.

use super::{Averages, Kernel, Sums, Welch};
use crate::fft::Workspace;

/// Averages of one channel that comes in blocks of any length. Less than a segment and the block waits in memory.
pub struct Stream {
    welch: Welch,
    kernel: Kernel,
    work: [Workspace; 1],
    waiting: Vec<f64>,
    sums: Sums,
}

impl Welch {
    /// Averages that are fed block by block.
    ///
    /// ```
    /// use vibro_record::Window;
    /// use vibro_signal::segment::Segments;
    /// use vibro_signal::welch::Welch;
    /// let welch = Welch { segments: Segments::new(8, 0.5)?, window: Window::Hann, detrend: true };
    /// let mut stream = welch.stream();
    /// (0..3).for_each(|_| stream.push(&[1.0, 0.0, -1.0, 0.0]));
    /// assert_eq!(stream.averages(4.0).map(|a| a.count), Some(2));
    /// # Ok::<(), vibro_record::Error>(())
    /// ```
    pub fn stream(self) -> Stream {
        let kernel = Kernel::new(self);
        Stream {
            welch: self,
            work: [kernel.transform.workspace()],
            waiting: Vec::new(),
            sums: Sums::new(1, false, kernel.transform.lines()),
            kernel,
        }
    }
}

impl Stream {
    /// Takes the next samples, all of them numbers.
    pub fn push(&mut self, block: &[f64]) {
        self.waiting.extend_from_slice(block);
        let mut at = 0;
        while let Some(segment) = self.waiting.get(at..at + self.welch.segments.length) {
            self.kernel.one(segment, &mut self.work[0]);
            self.sums.add(&self.work);
            at += self.welch.segments.hop;
        }
        self.waiting.drain(..at.min(self.waiting.len()));
    }

    /// The averages so far of samples at `rate` Hz; `None` if not one segment has come.
    pub fn averages(&self, rate: f64) -> Option<Averages> {
        let whole = self.sums.count > 0;
        whole.then(|| {
            self.sums.clone().mean(&self.kernel.weights, self.welch.segments, rate, self.welch.detrend)
        })
    }
}
