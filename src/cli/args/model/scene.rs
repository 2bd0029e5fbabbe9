//! The scene that a model is asked about, as typed.

use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Scene {
    /// Rig as a TOML file: m1 m2 k1 k2 c1 c2 gap restitution, [excitation], [contact], [buffer] [default: the thesis' rig]
    pub rig: Option<PathBuf>,
    /// Set a key of the rig, tables with a dot: gap=0.5e-3, contact.stiffness=1e5
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Force in N: amplitude of a sine, height of a pulse
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub force: Option<f64>,
    /// Impulse in N s, once a cycle, instead of a sine force
    #[arg(long, value_name = "NS", allow_negative_numbers = true, conflicts_with_all = ["force", "width"])]
    pub impulse: Option<f64>,
    /// Width in s of a rectangular pulse, once a cycle, instead of a sine force
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub width: Option<f64>,
}
