//! Windows, filters and spectra.

pub mod filter;
pub mod window;
