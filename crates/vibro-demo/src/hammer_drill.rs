//! Recordings of the example hammer drill: striker and bit under a laser vibrometer, with a pulse per turn.
//!
//! - `data/drill.wav`: striker, bit and pulse in volts, 20 s at 102.4 kHz (25 MB);
//! - `data/still.wav`: noise of the same vibrometer with the machine at rest;
//! - `drill.toml`: the impact unit as a model, for `vibro model drill`;
//! - `TRUTH.csv`: turn, time, phase and velocities of every impact, without noise and faults.

mod record;
mod stroke;

use super::{Sink, noise};
use std::fmt::Write as _;
use vibro_io::write::{Precision, wav::write};
use vibro_record::units::Unit;
use vibro_record::{Axis, Meta, Record, Result, Trace};

/// Duration of the record in s.
const SECONDS: f64 = 20.0;

/// Writes all files.
pub fn recordings(sink: &mut Sink<'_>) -> Result<()> {
    sink("drill.toml", include_bytes!("hammer_drill/drill.toml"))?;
    let made = record::record(SECONDS);
    let mut wave = |name: &str, channels: Vec<Record>| {
        let mut bytes = Vec::new();
        write(&channels, Precision::Single, &mut bytes)?;
        sink(name, &bytes)
    };
    let channels = [("striker", made.striker), ("bit", made.bit), ("pulse", made.pulse)];
    wave("data/drill.wav", channels.into_iter().map(|(name, values)| volts(name, values)).collect())?;
    wave("data/still.wav", vec![volts("striker", record::still(5.0))])?;
    let mut truth = String::from("turn,time (s),phase (1),before (m/s),after (m/s)\n");
    for i in &made.impacts {
        let _ = writeln!(truth, "{},{:.7},{:.5},{:.4},{:.4}", i.turn, i.time, i.phase, i.before, i.after);
    }
    sink("TRUTH.csv", truth.as_bytes())
}

/// A channel in volts.
fn volts(name: &str, values: Vec<f64>) -> Record {
    let meta = Meta::new(name, Unit::parse_or_opaque("V"));
    Record::Trace(Trace { meta, axis: Axis::time(0.0, 1.0 / record::RATE, values.len()), values })
}
