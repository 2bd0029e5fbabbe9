//! `vibro modal`, as typed.

use super::{Channel, Reading};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Modal {
    /// File with a frequency response function
    pub file: PathBuf,
    /// Band in Hz whose peaks are fitted together [default: a band around each peak]
    #[arg(long, value_name = "LO:HI", value_parser = band)]
    pub band: Option<(f64, f64)>,
    /// Mass in kg, for the stiffness k = m(2 pi f)^2
    #[arg(long, value_name = "KG", allow_negative_numbers = true)]
    pub mass: Option<f64>,
    /// File with the coherence of the same lines [default: a coherence in FILE]
    #[arg(long, value_name = "FILE")]
    pub coherence: Option<PathBuf>,
    /// Lines of a lower coherence are left out
    #[arg(long, value_name = "C", default_value_t = 0.5)]
    pub least_coherence: f64,
    #[command(flatten)]
    pub channel: Channel,
    #[command(flatten)]
    pub reading: Reading,
    /// Folder for the figures as SVG and PNG, and the modes as CSV
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

fn band(text: &str) -> Result<(f64, f64), String> {
    let number = |t: &str| t.trim().parse::<f64>().map_err(|_| format!("{t:?} is no number of hertz"));
    match text.split_once(':') {
        Some((low, high)) => Ok((number(low)?, number(high)?)),
        None => Err("a band is LO:HI in Hz".to_owned()),
    }
}
