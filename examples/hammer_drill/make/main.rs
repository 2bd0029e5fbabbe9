//! Makes the record of the example campaign: striker and bit of a hammer drill under a laser, with a pulse once a turn.
//!
//! `cargo run --release --example hammer_drill [FOLDER] [SECONDS]` writes into FOLDER, by default into this example's own:
//! - `data/drill.wav`: striker, bit and pulse in volts, 20 s at 102.4 kHz (25 MB);
//! - `data/still.wav`: the same laser with the machine at rest;
//! - `TRUTH.csv`: every impact, as it would be seen without noise and faults.
//!
//! Then `vibro run examples/hammer_drill/campaign.toml`. The same bytes come out every time.

mod noise;
mod record;
mod stroke;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use vibroimpact::record::{Axis, Meta, Record, Trace};
use vibroimpact::units::Unit;
use vibroimpact::write::{Precision, wav::write};
use vibroimpact::{Error, Result};

fn main() -> Result<()> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/hammer_drill");
    let folder = std::env::args_os().nth(1).map_or(own, PathBuf::from);
    let seconds = std::env::args().nth(2).and_then(|s| s.parse().ok()).unwrap_or(20.0);
    let data = folder.join("data");
    std::fs::create_dir_all(&data).map_err(|e| Error::io("create", &data, e))?;
    let made = record::record(seconds);
    let file = |name: &str, channels: Vec<Record>| {
        let path = data.join(name);
        let file = std::fs::File::create(&path).map_err(|e| Error::io("create", &path, e))?;
        write(&channels, Precision::Single, &mut std::io::BufWriter::new(file))
    };
    file(
        "drill.wav",
        vec![volts("striker", made.striker), volts("bit", made.bit), volts("pulse", made.pulse)],
    )?;
    file("still.wav", vec![volts("striker", record::still(5.0))])?;
    let mut truth = String::from("turn,time (s),phase (1),before (m/s),after (m/s)\n");
    for i in &made.impacts {
        let _ = writeln!(truth, "{},{:.7},{:.5},{:.4},{:.4}", i.turn, i.time, i.phase, i.before, i.after);
    }
    let path = folder.join("TRUTH.csv");
    std::fs::write(&path, truth).map_err(|e| Error::io("write", &path, e))?;
    println!("{} impacts, {} drop-outs in {}", made.impacts.len(), made.dropouts, folder.display());
    Ok(())
}

fn volts(name: &str, values: Vec<f64>) -> Record {
    let meta = Meta::new(name, Unit::parse_or_opaque("V"));
    Record::Trace(Trace { meta, axis: Axis::time(0.0, 1.0 / record::RATE, values.len()), values })
}
