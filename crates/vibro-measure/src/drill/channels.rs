//! Where the samples come from: velocity, reference, and up to three axes of a handle.

use vibro_record::Result;

/// Channels of one record that can be read several times, block by block.
pub trait Channels {
    /// Sampling rate in Hz.
    fn rate(&self) -> f64;

    /// Hands out all blocks from the beginning: velocity, reference, then the axes of the handle, all of one length.
    ///
    /// # Errors
    /// If they cannot be read, or `each` fails.
    fn play(&mut self, each: &mut dyn FnMut(&[&[f64]]) -> Result<()>) -> Result<()>;
}

/// Channels in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Slices<'a> {
    /// Sampling rate in Hz.
    pub rate: f64,
    /// Velocity, reference, axes of the handle.
    pub channels: Vec<&'a [f64]>,
}

/// Samples of a block.
const BLOCK: usize = 1 << 16;

impl Channels for Slices<'_> {
    fn rate(&self) -> f64 {
        self.rate
    }

    fn play(&mut self, each: &mut dyn FnMut(&[&[f64]]) -> Result<()>) -> Result<()> {
        let n = self.channels.iter().map(|c| c.len()).min().unwrap_or(0);
        for from in (0..n).step_by(BLOCK) {
            let to = (from + BLOCK).min(n);
            let block: Vec<&[f64]> = self.channels.iter().map(|c| &c[from..to]).collect();
            each(&block)?;
        }
        Ok(())
    }
}
