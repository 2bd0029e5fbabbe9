//! `vibro model map`, as typed.

use super::Scene;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Map {
    #[command(flatten)]
    pub scene: Scene,
    /// Parameter across: one of m1 m2 k1 k2 c1 c2 gap restitution frequency force impulse width, e.g. frequency:3:14:120
    #[arg(long, value_name = "NAME:LOW:HIGH:N")]
    pub x: String,
    /// Parameter upwards, as --x
    #[arg(long, value_name = "NAME:LOW:HIGH:N")]
    pub y: String,
    /// Excitation frequency in Hz, where it is not varied
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub frequency: Option<f64>,
    /// Cycles a cell, from rest; a cell that has settled ends before
    #[arg(long, value_name = "N", default_value_t = 200)]
    pub cycles: u32,
    /// Write figures and CSV into this folder; a map that was cut short there is taken up again
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
}
