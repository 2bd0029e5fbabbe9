//! Windows and spectra.

pub mod window;
