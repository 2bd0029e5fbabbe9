//! A small synthetic sweep: lines of a sine with a Hann window at each excitation frequency, without noise.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use vibroimpact::record::Window;
use vibroimpact::signal::window::line_shape;

pub const LINES: usize = 200;
pub const BASE_BAND: f64 = 20.0;

/// Amplitude of the synthetic response in m: a resonance at 5.6 Hz.
pub fn amplitude(f: f64) -> f64 {
    let r = f / 5.6;
    1e-3 / (1.0 - r * r).hypot(0.1 * r)
}

/// Spectrum of one sine at `frequency` in Hz, one value a line.
pub fn spectrum(frequency: f64, amplitude: f64) -> String {
    let mut text = String::new();
    for k in 0..=LINES {
        let position = frequency / (BASE_BAND / LINES as f64);
        let _ =
            writeln!(text, "{:e}", amplitude * line_shape(Window::Hann, k as f64 - position).abs() + 1e-12);
    }
    text
}

/// Writes force spectra (0.1 N), velocity spectra and the list file of these frequencies in Hz. Returns the
/// path of the list.
pub fn sweep(folder: &Path, frequencies: &[f64]) -> PathBuf {
    let mut names = String::new();
    for (letter, response) in [('F', false), ('V', true)] {
        for (i, f) in frequencies.iter().enumerate() {
            let name = format!("{letter}UP{:04}.DAT", i + 1);
            let height = if response { amplitude(*f) * std::f64::consts::TAU * f } else { 0.1 };
            fs::write(folder.join(&name), spectrum(*f, height)).expect("a spectrum");
            let _ = writeln!(names, "{name}");
        }
    }
    let list = folder.join("LIST.TXT");
    fs::write(&list, format!("{}\n{LINES}\n{BASE_BAND}\n{names}", frequencies.len())).expect("a list");
    list
}

/// Rising frequencies in Hz that lie between the lines.
pub fn frequencies() -> Vec<f64> {
    (0..12).map(|i| 4.03 + 0.273 * f64::from(i)).collect()
}
