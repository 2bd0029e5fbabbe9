//! Makes the measured data of the example campaign: stepped sweeps of the two-mass rig, up and down, as the dynamic
//! signal analyser would have written them.
//!
//! `cargo run --release --example two_mass_rig [FOLDER]` writes into FOLDER, by default into this example's own.
//! The same bytes come out every time: the noise has fixed seeds, and nothing depends on the clock.
//!
//! - `data/FUP0001.DAT` …: force spectra of the upward sweep, `data/FDN0001.DAT` … of the downward one;
//! - `data/V1U0001.DAT`, `data/V1D0001.DAT` …: velocity spectra of the excited mass, `V2U`, `V2D` of the passive one;
//! - `UP1.TXT`, `UP2.TXT`, `DOWN1.TXT`, `DOWN2.TXT`: list files of the sweeps, one a mass and direction;
//! - `TRUTH.csv`: what a perfect instrument would have found.

mod analyser;
mod campaign;
mod noise;

use campaign::{Direction, list, measure, truth_header};
use std::path::{Path, PathBuf};
use vibroimpact::{Error, Result};

fn main() -> Result<()> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/two_mass_rig");
    let folder = std::env::args_os().nth(1).map_or(own, PathBuf::from);
    let data = folder.join("data");
    std::fs::create_dir_all(&data).map_err(|e| Error::io("create", &data, e))?;
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|e| Error::io("write", &path, e))
    };
    let mut truth = truth_header();
    for direction in [Direction::Up, Direction::Down] {
        for mass in [1, 2] {
            let (name, text) = list(direction, mass);
            write(&name, &text)?;
        }
        measure(direction, usize::MAX, |point| {
            truth.push_str(&point.truth());
            point.files(0).iter().try_for_each(|(name, text)| write(&format!("data/{name}"), text))
        })?;
    }
    write("TRUTH.csv", &truth)
}
