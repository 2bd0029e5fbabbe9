//! Makes the records of the example drop test: a ball that falls down a tube onto a plate, an accelerometer on the plate, and a contact
//! trace of the shaken rig.
//!
//! `cargo run --release --example drop_test [FOLDER]` writes into FOLDER, by default into this example's own. The same bytes come out every
//! time: the noise has fixed seeds, and nothing depends on the clock.
//!
//! - `DROP01.CSV` … `DROP05.CSV`: drops from 0.57 m, recorded until after the second impact;
//! - `BOUNCE.CSV`: one longer record with a train of bounces;
//! - `CONTACT.DAT`: a contact trace of 2.56 × 50 Hz, one impact in two cycles of 11.2 Hz, with mains hum;
//! - `TRUTH.csv`: what a perfect instrument would have found.

mod records;

use std::path::{Path, PathBuf};
use vibroimpact::{Error, Result};

fn main() -> Result<()> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/drop_test");
    let folder = std::env::args_os().nth(1).map_or(own, PathBuf::from);
    std::fs::create_dir_all(&folder).map_err(|e| Error::io("create", &folder, e))?;
    for (name, text) in records::all() {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|e| Error::io("write", &path, e))?;
    }
    Ok(())
}
