//! Windows, filters, spectra, integration and frequency response functions.

pub mod differentiate;
pub mod fft;
pub mod filter;
pub mod impact;
pub mod integrate;
pub mod segment;
mod sound;
pub mod spectrum;
pub mod transfer;
pub mod welch;
pub mod window;
