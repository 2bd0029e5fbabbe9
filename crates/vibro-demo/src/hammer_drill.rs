//! Recordings of the example hammer drill: striker, intermediate piston and bit under a laser vibrometer in
//! three runs, with a pulse per turn. The motion is that of the model in `drill.toml` with other values of a
//! few keys, which vary from turn to turn.
//!
//! - `data/drill.wav`: striker and pulse in volts, 20 s at 102.4 kHz (16 MB);
//! - `data/piston.wav`, `data/bit.wav`: runs of the other bodies, 4 s each (3 MB);
//! - `data/still.wav`: noise of the same vibrometer with the machine at rest;
//! - `drill.toml`: the impact unit as a model, for `vibro model drill` and the campaign;
//! - `TRUTH.toml`: the keys of the machine that `drill.toml` does not state as they are;
//! - `TRUTH.csv`: turn, time, phase and velocities of every impact of the striker, without noise and faults.

mod record;

use super::{Sink, noise};
use std::fmt::Write as _;
use vibro_io::write::{Precision, wav::write};
use vibro_record::units::Unit;
use vibro_record::{Axis, Meta, Record, Result, Trace};

/// Duration of the record in s.
const SECONDS: f64 = 20.0;
/// Duration of the runs of intermediate piston and bit in s.
const OTHERS: f64 = 4.0;

/// Writes all files.
pub fn recordings(sink: &mut Sink<'_>) -> Result<()> {
    sink("drill.toml", include_bytes!("hammer_drill/drill.toml"))?;
    sink("TRUTH.toml", include_bytes!("hammer_drill/TRUTH.toml"))?;
    let runs = [("drill", "striker", SECONDS), ("piston", "piston", OTHERS), ("bit", "bit", OTHERS)];
    let mut impacts = Vec::new();
    for (body, (file, name, seconds)) in runs.into_iter().enumerate() {
        let made = record::run(body, seconds)?;
        wave(sink, file, &[volts(name, made.velocity), volts("pulse", made.pulse)])?;
        if body == 0 {
            impacts = made.impacts;
        }
    }
    wave(sink, "still", &[volts("striker", record::still(5.0))])?;
    let mut truth = String::from("turn,time (s),phase (1),before (m/s),after (m/s)\n");
    for i in &impacts {
        let _ = writeln!(truth, "{},{:.7},{:.5},{:.4},{:.4}", i.turn, i.time, i.phase, i.before, i.after);
    }
    sink("TRUTH.csv", truth.as_bytes())
}

/// Writes a recording.
fn wave(sink: &mut Sink<'_>, name: &str, channels: &[Record]) -> Result<()> {
    let mut bytes = Vec::new();
    write(channels, Precision::Single, &mut bytes)?;
    sink(&format!("data/{name}.wav"), &bytes)
}

/// A channel in volts.
fn volts(name: &str, values: Vec<f64>) -> Record {
    let meta = Meta::new(name, Unit::parse_or_opaque("V"));
    Record::Trace(Trace { meta, axis: Axis::time(0.0, 1.0 / record::RATE, values.len()), values })
}
