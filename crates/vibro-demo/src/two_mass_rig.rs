//! Recordings of the example two-mass rig: stepped sweeps, up and down, as a dynamic signal analyser would
//! have written them.
//!
//! - `data/FUP0001.DAT` …: force spectra of the upward sweep, `data/FDN0001.DAT` … of the downward one;
//! - `data/V1U0001.DAT`, `data/V1D0001.DAT` …: velocity spectra of the excited mass, `V2U`, `V2D` of the
//!   passive one;
//! - `UP1.TXT`, `UP2.TXT`, `DOWN1.TXT`, `DOWN2.TXT`: list files of the sweeps, one for each mass and
//!   direction;
//! - `TRUTH.csv`: amplitudes without noise and impacts per cycle of every point.

mod analyser;
mod campaign;

use super::{Sink, noise};
use campaign::{Direction, list, simulate, truth_header};
use vibro_record::Result;

/// Writes all files.
pub fn recordings(sink: &mut Sink<'_>) -> Result<()> {
    let mut truth = truth_header();
    for direction in [Direction::Up, Direction::Down] {
        for mass in [1, 2] {
            let (name, text) = list(direction, mass);
            sink(&name, text.as_bytes())?;
        }
        simulate(direction, usize::MAX, |point| {
            truth.push_str(&point.truth());
            point.files(0).iter().try_for_each(|(name, text)| sink(&format!("data/{name}"), text.as_bytes()))
        })?;
    }
    sink("TRUTH.csv", truth.as_bytes())
}
