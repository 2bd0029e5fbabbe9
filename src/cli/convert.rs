//! `vibro convert`: any readable file to UFF-58, CSV, WAV or NPY, with optional filters and integration.

use super::{CommandArgs, complain, print, stdout};
use crate::analysis::Answer;
use crate::campaign::{Channel, Reading};
use crate::error::{Error, Result};
use crate::read::{Folder, Owner};
use crate::record::kind::whole;
use crate::record::{Finding, Record, Trace};
use crate::report::layout::headed;
use crate::report::words::{Voice, graded};
use crate::signal::filter::Filter;
use crate::signal::{differentiate, integrate};
use crate::units::Quantity;
use crate::write::{Precision, Storage, Target};
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Convert {
    /// File to read
    #[arg(index = 1)]
    input: PathBuf,
    /// File to write: .uff .unv (UFF-58), .csv .tsv, .wav, .npy; or - for CSV on standard output
    #[arg(index = 2)]
    output: PathBuf,
    /// Write UFF-58 as binary (58b)
    binary: bool,
    /// Write single instead of double precision, where the format has both
    single: bool,
    #[command(flatten)]
    change: TraceProcessing,
    #[command(flatten)]
    channel: Channel,
    #[command(flatten)]
    reading: Reading,
}

/// Peak memory while a file is written, as a multiple of the memory of its values. Measured with ten million
/// samples of twenty digits.
const PEAK_MEMORY: [(Target, f64); 5] =
    [(Target::Uff, 3.0), (Target::Csv, 4.5), (Target::Tsv, 4.5), (Target::Npy, 2.2), (Target::Wav, 1.2)];

impl CommandArgs for Convert {
    /// Converts the file and prints what was written.
    fn run(&self, json: bool) -> Result<u8> {
        let piped = self.output == Path::new("-");
        let target = if piped { Target::Csv } else { Target::of(&self.output)? };
        if piped && json {
            return Err(Error::usage(
                "the CSV and the JSON object would both go to standard output",
                "a file to write",
            ));
        }
        if self.binary && matches!(target, Target::Csv | Target::Tsv) {
            let found = format!("binary {}", target.name());
            return Err(Error::usage(found, "UFF-58, NAME.uff").setting("binary"));
        }
        let folder = Folder::default();
        folder.reads(&self.input);
        let file = (!piped).then(|| print::File::of(&folder, &self.output, Owner::Recordings)).transpose()?;
        let one = self.channel.channel.is_some() || self.channel.calibration.is_some();
        let reader = self.reading.reader()?.within(&folder);
        let reader = if one || self.change.wanted() { reader.rate_of_base_band() } else { reader };
        let multiple = PEAK_MEMORY.iter().find(|row| row.0 == target).map_or(1.0, |row| row.1);
        let reader = reader.beside(multiple).only(self.channel.channel.clone());
        let mut recording = reader.from_path(&self.input)?;
        if one {
            let trace = recording.take_trace(self.channel.channel.as_deref(), self.channel.calibration)?;
            recording.records = vec![Record::Trace(trace)];
        }
        let changes = self.change.apply(&mut recording.records)?;
        let mut bytes = Vec::new();
        let precision = if self.single { Precision::Single } else { Precision::Double };
        target.write(&recording.records, Storage { binary: self.binary, precision }, &mut bytes)?;
        let Some(file) = file else {
            let about = recording.all_findings().into_iter().chain(changes).map(|f| (String::new(), f));
            complain::warn_all(&graded(&about.collect::<Vec<_>>(), Voice::Command));
            stdout::text(&String::from_utf8_lossy(&bytes))?;
            return Ok(0);
        };
        let existed = self.output.exists();
        let written = file.write(&bytes)?;
        let (format, records) = (target.name(), recording.records.len());
        let mut answer = Answer::of(&json!({ "written": written, "format": format, "records": records }))?;
        answer.add("", recording.all_findings());
        answer.add("", changes);
        answer.add("", (target == Target::Npy).then(|| Finding::caution("values-only")));
        answer.add("", existed.then(|| Finding::caution("file-replaced").name("file", &*written)));
        let done = headed("", &[("written", ""), ("records", ""), ("format", "")]);
        answer.tables.push(done.row([written.into(), records.into(), format.into()]));
        print::answer(answer, None, json)
    }
}

/// Filters and integrations applied to time traces before they are written.
#[derive(Debug, clap::Args)]
struct TraceProcessing {
    /// Corner in Hz of a zero-phase Butterworth low-pass of order 4
    low_pass: Option<f64>,
    /// Time constant in s of exponential smoothing (delays the signal), instead of the zero-phase low-pass
    #[arg(conflicts_with = "low_pass")]
    smoothing: Option<f64>,
    /// Corner in Hz of a zero-phase Butterworth high-pass of order 4
    high_pass: Option<f64>,
    /// Integrations in time: 1 takes velocity to displacement, −1 to acceleration
    #[arg(default_value_t = 0, value_parser = whole::<i8, -2, 2>)]
    integrate: i8,
    /// Cut-off in Hz: corner of the zero-phase high-pass of order 4 after each integration, or before a
    /// differentiation
    #[arg(requires = "integrate")]
    fmin: Option<f64>,
    /// Excitation frequency in Hz: the mean over whole periods is removed
    #[arg(requires = "integrate")]
    excitation: Option<f64>,
}

/// Order of a Butterworth filter in one of its two passes, forward and backward.
const ORDER: usize = 4;

impl TraceProcessing {
    /// Whether any processing is requested.
    fn wanted(&self) -> bool {
        self.integrate != 0 || self.smoothing.is_some() || self.low_pass.is_some() || self.high_pass.is_some()
    }

    /// Processes all records in place; returns a finding for each step.
    ///
    /// # Errors
    /// If options contradict each other, a record is no time trace, or it cannot be filtered or integrated.
    fn apply(&self, records: &mut [Record]) -> Result<Vec<Finding>> {
        if self.integrate > 0 && self.fmin.is_none() {
            let expected = "a cut-off in Hz: below it noise and drift would be all that is seen";
            return Err(Error::usage("an integration in time without a cut-off", expected)
                .setting("fmin")
                .hint("half the lowest frequency that matters; the answer says from where on amplitudes are right"));
        }
        let idle = [
            ("fmin", self.fmin.is_some() && self.integrate == 0),
            ("excitation", self.excitation.is_some() && self.integrate < 1),
        ];
        if let Some((name, _)) = idle.iter().find(|(_, idle)| *idle) {
            let found = format!("{name} with {} integrations", self.integrate);
            return Err(Error::usage(found, "an integration").setting(name).setting("integrate"));
        }
        let mut done = Vec::new();
        for record in records.iter_mut().filter(|_| self.wanted()) {
            let (kind, name) = (record.kind(), record.meta().name.clone());
            let Record::Trace(trace) = record else {
                return Err(Error::refused(format!("{name:?} is a {kind}, no time trace"))
                    .hint("choose a trace; `vibro spectrum` integrates in frequency")
                    .setting("channel"));
            };
            self.trace(trace, &mut done).map_err(|e| e.of_record(&name))?;
        }
        Ok(done)
    }

    fn trace(&self, trace: &mut Trace, done: &mut Vec<Finding>) -> Result<()> {
        let rate =
            trace.rate().ok_or_else(|| Error::refused("the sampling rate is not known").setting("rate"))?;
        let name = trace.meta.name.clone();
        let was = |code: Finding| code.about(name.as_str());
        if let Some(time) = self.smoothing {
            let corner = 1.0 / (std::f64::consts::TAU * time);
            let filter = Filter::smoothing(corner, rate)?;
            if let Some(i) = trace.values.iter().position(|v| !v.is_finite()) {
                let found = format!("sample {i} is missing: smoothing would lose all behind it");
                return Err(Error::refused(found).hint("read the part before the gap").setting("span"));
            }
            if let Some(first) = trace.values.first().copied() {
                filter.causal(&mut trace.values, first);
            }
            trace.meta.step("filter", &[("filter", &filter), ("passes", &1)]);
            done.push(was(Finding::caution("smoothed")).number("time", time).number("corner", corner));
        }
        let low = self.low_pass.map(|corner| Filter::low_pass(corner, ORDER, rate));
        let high = [self.high_pass, self.fmin.filter(|_| self.integrate < 0)].into_iter().flatten();
        for filter in low.into_iter().chain(high.map(|corner| Filter::high_pass(corner, ORDER, rate))) {
            let filter = filter?;
            trace.values = filter.zero_phase(&trace.values)?;
            trace.meta.step("filter", &[("filter", &filter), ("passes", &2)]);
            done.push(was(Finding::caution("filtered")).name("filter", filter.to_string()));
        }
        if let (1.., Some(corner)) = (self.integrate, self.fmin) {
            let (times, period) = (self.integrate, self.excitation.map(f64::recip));
            let how = integrate::InTime { times, corner, order: ORDER, period };
            let found = integrate::in_time(trace, &how)?;
            let [low, high] = found.band;
            let facts = was(Finding::caution("integrated")).name("times", often(times));
            let facts = facts.count("order", ORDER).number("corner", corner).number("low", low);
            let facts = facts.number("high", high).number("edge", found.edge).number("drift", found.drift);
            done.push(facts.name("unit", found.trace.meta.unit.symbol()));
            if let Some(f) = self.excitation {
                let facts = was(Finding::caution("integration-gain")).number("frequency", f);
                let facts = facts.number("gain", how.gain(f, rate)?);
                let inside = (low..=high).contains(&f);
                done.push(if inside { facts } else { facts.number("outside", f) });
            }
            *trace = renamed(found.trace, trace);
        }
        if self.integrate < 0 {
            let found = differentiate::in_time(trace, self.integrate.unsigned_abs())?;
            let facts = was(Finding::caution("differentiated")).name("times", often(self.integrate));
            done.push(facts.number("highest", found.highest));
            *trace = renamed(found.trace, trace);
        }
        Ok(())
    }
}

/// Renames a channel that bears the name of its quantity: a velocity integrated to displacement must not
/// stay "velocity".
fn renamed(mut made: Trace, from: &Trace) -> Trace {
    let (before, after) = (from.meta.quantity, made.meta.quantity);
    if Quantity::from_name(&made.meta.name) == Some(before) && after != Quantity::Other {
        after.name().clone_into(&mut made.meta.name);
    }
    made
}

fn often(times: i8) -> &'static str {
    if times.abs() == 1 { "once" } else { "twice" }
}
