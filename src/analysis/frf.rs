//! Frequency response functions and their modes: `[[frf]]`, `vibro modal`.

pub mod figures;
mod function;
pub mod tables;

pub use function::Function;

use super::answer::Answer;
use super::answer::left_out;
use super::headline::headline;
use super::job::Job;
use super::kind::{Analysis, no_file};
use super::source::Source;
use super::spectrum::{self, Detrend};
use super::sweep;
use super::tone::Strongest;
use crate::campaign::{Campaign, Entry, KeyRange, channel};
use crate::error::{Error, Result};
use crate::measure::modal::{Measured, ModalOptions, ModalResult, modal, stabilisation};
use crate::record::code;
use crate::record::{Axis, Finding, Meta, Record, Trace, Traces, Uncertain, Window, shown};
use crate::report::Cell;
use crate::report::files;
use crate::report::files::Names;
use crate::report::words::About;
use crate::signal::transfer::Estimator;
use crate::units::notation::significant;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Share of its power in its strongest sine from which a reference counts as a pure sine: 20 dB above the
/// rest. Noise and blows spread their power over all lines.
const ALONE: f64 = 0.99;
/// Samples at the beginning of a reference that are tested first.
const HEAD: usize = 1 << 16;

/// Code of the finding that a sweep jumps.
const JUMPS: &str = "modal-sweep-jumps";

/// How modes are found, and how the function is taken where a file has two channels.
// Keys from `reference` on repeat those of `spectrum::Keys`. In a shared, flattened struct serde would not
// refuse unknown keys, which a campaign must.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// Band in Hz whose peaks are fitted together [default: a band around each peak]
    #[cfg_attr(feature = "cli", arg(value_name = "LO:HI", value_parser = crate::campaign::two::<':'>))]
    pub band: Option<(f64, f64)>,
    /// Mass in kg, for the stiffness k = m(2 pi f)^2
    pub mass: Option<f64>,
    /// Sweep whose receptance is the function, instead of a file
    #[cfg_attr(feature = "cli", arg(skip))]
    pub sweep: Option<String>,
    /// File with the coherence of the same lines [default: a coherence in the file]
    pub coherence: Option<PathBuf>,
    /// Lines with a lower coherence are left out [default: 0.5]
    pub least_coherence: Option<f64>,
    /// Channel of the excitation in a time record, or FILE#CHANNEL: the frequency response function is
    /// computed first
    #[serde(deserialize_with = "channel")]
    pub reference: Option<String>,
    /// FRF estimator: h1 for noise in the response, h2 for noise in the excitation, hv for noise in both
    /// [default: h1]
    #[cfg_attr(feature = "cli", arg(value_name = "NAME", value_parser = crate::campaign::word::<Estimator>))]
    pub estimator: Option<Estimator>,
    /// Samples of a segment [default: 8192, or the whole of a shorter record; for blows, set by their
    /// ringing and spacing]
    pub segment: Option<usize>,
    /// Overlap of the segments, 0 to below 1 [default: 0.5]
    pub overlap: Option<f64>,
    /// Removed from a segment before the window: mean or none [default: mean]
    #[cfg_attr(feature = "cli", arg(value_name = "WHAT", value_parser = crate::campaign::word::<Detrend>))]
    pub detrend: Option<Detrend>,
    /// Window of a segment [default: hann]
    #[cfg_attr(feature = "cli", arg(value_name = "NAME", value_parser = crate::campaign::word::<Window>))]
    pub window: Option<Window>,
    /// Integrations in frequency [default: 0]
    #[cfg_attr(feature = "cli", arg(value_parser = crate::record::kind::whole::<i8, -2, 2>))]
    pub integrate: Option<i8>,
    /// Lowest frequency in Hz [default: two lines where integrated, else 0]
    pub fmin: Option<f64>,
    /// Hammer test: one segment for each blow
    pub hammer: bool,
    /// Width of the force window in s [default: ten contact times, 64 samples at least]
    pub force_window: Option<f64>,
    /// Value of the exponential window at the end of a segment
    pub left_at_end: Option<f64>,
    /// Channel delay to remove, in s
    pub delay: Option<f64>,
}

/// A frequency response function and its modes.
#[derive(Serialize)]
struct FunctionModes<'a> {
    quantity: &'static str,
    unit: &'a str,
    #[serde(flatten)]
    modal: &'a ModalResult,
}

impl Keys {
    /// Keys for the function of two channels.
    fn spectral_keys(&self) -> spectrum::Keys {
        spectrum::Keys {
            reference: self.reference.clone(),
            estimator: self.estimator,
            segment: self.segment,
            overlap: self.overlap,
            detrend: self.detrend,
            window: self.window,
            integrate: self.integrate,
            fmin: self.fmin,
            hammer: self.hammer,
            force_window: self.force_window,
            left_at_end: self.left_at_end,
            delay: self.delay,
            ..spectrum::Keys::default()
        }
    }

    /// Checks that the keys go together.
    ///
    /// # Errors
    /// The key that does not.
    pub fn usable(&self) -> Result<()> {
        let taken = self.spectral_keys();
        if self.reference.is_some() {
            if self.coherence.is_some() {
                let found = "coherence beside a reference, from which it follows";
                return Err(Error::usage(found, "one of them").setting("coherence"));
            }
            return taken.options().map(drop);
        }
        let estimator = self.estimator.map(|_| "estimator");
        let Some(key) = estimator.or_else(|| taken.unchecked().first()) else { return Ok(()) };
        let expected = "the channel of the force as reference";
        Err(Error::usage(format!("{key} without a reference"), expected).setting(key).set("reference", "1"))
    }

    /// The frequency response functions of a file, with their modes, figures, tables and files. With a
    /// reference, the function is computed from two channels.
    ///
    /// # Errors
    /// If a file cannot be read, or no function is there.
    pub fn measure(&self, source: &Source<'_>) -> Result<Vec<Answer>> {
        self.usable()?;
        let mut of_file = Answer::default();
        let functions = self.functions(source, &mut of_file)?;
        let answers = functions.into_iter().map(|function| {
            let mut answer = self.modes(source.name, &function)?;
            // A response that is cut off after a blow is reported once.
            let of_modes = answer.findings.iter().any(|(_, found)| found.code == code::MODAL_BLOW_CUT_OFF);
            let said = |(_, found): &&About| !(of_modes && found.code == code::RESPONSE_CUT_OFF);
            answer.findings.splice(0..0, of_file.findings.iter().filter(said).cloned());
            Ok(answer)
        });
        answers.collect()
    }

    fn functions(&self, source: &Source<'_>, of_file: &mut Answer) -> Result<Vec<Function>> {
        if self.reference.is_some() {
            let keys = self.spectral_keys();
            let mut traces = keys.traces(source)?;
            refuse_sine(&mut traces, source)?;
            let found = keys.lines_of(traces, source)?;
            of_file.add("", &found.findings);
            let records = found.records();
            let Some(Record::Frf(frf)) = records.first() else { return Ok(Vec::new()) };
            let measured = Measured::complex(frf);
            // A single blow has no coherence.
            let measured = if records.len() > 1 { measured.with_coherence_of(&records)? } else { measured };
            return Ok(vec![Function {
                in_doubt: found.findings.iter().any(Finding::is_doubt),
                records: records.clone(),
                ..Function::new(frf.meta.clone(), measured)
            }]);
        }
        let recording = source.reader()?.from_path(source.path)?;
        of_file.add("", &recording.findings);
        let coherence = source.further("coherence", self.coherence.as_ref())?;
        let coherence = coherence.map(|path| source.reader()?.from_path(path)).transpose()?;
        let all = Measured::all(&recording.records, source.channel.channel.as_deref())
            .map_err(|e| e.of_record(&recording.path.display().to_string()).in_file(&recording.path))?;
        let function = |(mut meta, mut measured): (Meta, Measured)| {
            if let Some(coherence) = &coherence {
                let joined = measured.with_coherence_of(&coherence.records);
                measured = joined.map_err(|e| e.in_file(&coherence.path))?;
            }
            if let Some(factor) = source.channel.calibration {
                meta.step("calibrate", &[("factor", &factor)]);
                measured.values.iter_mut().for_each(|v| *v *= factor);
            }
            let mut all = recording.findings.iter().chain(&meta.findings);
            let in_doubt = all.any(Finding::is_doubt);
            Ok(Function { in_doubt, ..Function::new(meta, measured) })
        };
        all.into_iter().map(function).collect()
    }

    /// The modes of a function, with figures, tables and files.
    ///
    /// # Errors
    /// If it cannot be searched for modes. A function without modes is shown, with the reason.
    pub fn modes(&self, name: &str, function: &Function) -> Result<Answer> {
        let Function { meta, measured, records, findings, in_doubt } = function;
        let options = ModalOptions {
            band: self.band,
            mass: self.mass,
            least_coherence: self.least_coherence,
            decay: meta.added_decay(),
            clock: meta.clock,
        };
        // A function without modes is shown.
        let (mut found, refused) = match modal(measured, &options) {
            Err(error) if error.exit_code() == 1 => {
                (ModalResult { modes: Vec::new(), findings: Vec::new() }, Some(error))
            }
            found => (found?, None),
        };
        if *in_doubt {
            found.doubt();
        }
        let (quantity, unit) = (meta.quantity.name(), meta.unit.symbol());
        let mut answer = Answer::of(&FunctionModes { quantity, unit, modal: &found })?;
        answer.result.insert("channel".to_owned(), meta.name.clone().into());
        answer.channel.clone_from(&meta.name);
        answer.add("", &meta.findings);
        answer.add("", findings);
        answer.add("", &found.findings);
        answer.refused = refused;
        answer.headlines.push(headline(
            "Modes",
            &found.modes,
            &[
                ("frequency", "Hz", &|mode| Cell::from(&mode.frequency)),
                ("damping ratio", "", &|mode| Cell::from(&mode.zeta)),
            ],
        ));
        answer.table("modes", tables::modes(name, &found));
        let methods = tables::modal_methods(&found);
        answer.csv("methods", &methods);
        answer.details.push(methods);
        answer.figure("frf", figures::frf(name, meta, measured, &found.modes));
        answer.figure("argand", figures::argand(name, meta, measured, &found.modes));
        let poles = stabilisation(measured, self.band);
        if !poles.is_empty() {
            answer.csv("stability", &tables::poles(&poles));
        }
        answer.figure("stability", figures::stabilisation(name, meta, measured, &poles, &found.modes));
        if !records.is_empty() {
            let (files, unwritten) = files::records("frf", records)?;
            answer.files.extend(files);
            answer.add("", unwritten);
        }
        Ok(answer)
    }
}

/// Refuses a reference that is a single sine: the function would be known at one line, and be noise
/// over noise at all others.
fn refuse_sine(traces: &mut Traces, source: &Source<'_>) -> Result<()> {
    let names: Vec<String> = traces.channels().iter().map(|meta| meta.name.clone()).collect();
    let mut alone = None;
    // Most references that are no sine show it at their beginning.
    for enough in [HEAD, usize::MAX] {
        let Some(values) = traces.peek(enough)?.first().cloned() else { return Ok(()) };
        let meta = traces.channels()[0].clone();
        let axis = Axis::time(traces.start(), 1.0 / traces.rate(), values.len());
        alone = Strongest::of(&Trace { meta, axis, values }).filter(|tone| tone.share >= ALONE);
        if alone.is_none() {
            return Ok(());
        }
    }
    let Some((tone, [name, response])) = alone.zip(names.first_chunk()) else { return Ok(()) };
    let folder = source.path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let frequency = significant(tone.frequency, 5);
    let why = format!("{name} is a sine of {frequency} Hz alone, and a function needs power at all lines");
    let (folder, file) = (shown(folder), shown(source.path));
    Err(Error::refused(format!(
        "{why}; `vibro response` takes the folder {folder}, where it holds the steps of a sweep"
    ))
    .hint(format!("vibro spectrum {file:?} --channel {response:?} --tones 1")))
}

/// Why the modes of a sweep differ from its resonances.
const OF_SWEEP: &str =
    "Modes of a sweep use all its points and their phase; its resonances are by the points around each peak.";

impl Analysis for Keys {
    const SECTION: &'static str = "frf";
    const TITLE: &'static str = "Frequency response functions";
    const FILES: Names = Names::Numbered(&["modes", "methods", "frf", "argand", "stability"]);
    const RANGES: &'static [KeyRange] = &[KeyRange::from_zero("", &["least_coherence"]).within(1e-9, 1.0)];
    const RESTS_ON: &'static [&'static str] = &["sweep"];

    fn check(entry: &Entry<Keys>, _: &[Entry<Keys>]) -> Result<()> {
        match (&entry.file, &entry.keys.sweep) {
            (Some(_), Some(_)) => {
                Err(Error::usage("a file beside a sweep", "one of them: the function is that of one")
                    .setting("sweep"))
            }
            (None, None) => Err(no_file()),
            (None, Some(_)) if entry.keys.reference.is_some() || entry.keys.coherence.is_some() => {
                let found = "reference or coherence beside a sweep";
                Err(Error::usage(found, "the sweep alone").setting("reference").setting("coherence"))
            }
            _ => entry.keys.usable(),
        }
    }

    fn files(campaign: &Campaign, entry: &Entry<Keys>) -> Result<Vec<PathBuf>> {
        if let Some(name) = &entry.keys.sweep {
            let known = sweep::named(campaign, Some(name));
            known.map_err(|e| campaign.fault(entry, e.hint("the name of a [[sweep]]").setting("sweep")))?;
        }
        spectrum::with_reference(campaign, entry, entry.keys.reference.as_ref())
    }

    fn channels(&self) -> Vec<(&'static str, &String)> {
        spectrum::own_reference(self.reference.as_ref())
    }

    fn beside(&self) -> Option<(&'static str, &PathBuf)> {
        Some(("coherence", self.coherence.as_ref()?))
    }

    fn run(entries: &[Entry<Keys>], job: &mut Job<'_>) -> Result<()> {
        let campaign = job.campaign;
        job.each("frf", entries, |entry, source| {
            let mut answers = match &entry.keys.sweep {
                Some(name) => {
                    let function = Function::of_sweep(campaign, Some(name))?;
                    let mut answer = entry.keys.modes(&function.meta.name, &function)?;
                    answer.headlines.iter_mut().for_each(|table| OF_SWEEP.clone_into(&mut table.note));
                    vec![answer]
                }
                None => entry.keys.measure(source)?,
            };
            for answer in &mut answers {
                let jumps = answer.findings.iter().any(|(_, found)| found.code == JUMPS);
                if let Some(error) = answer.refused.take() {
                    let of_jumps =
                        || Error::refused("the sweep jumps, so its motion is not that of linear modes");
                    answer.add("", [left_out("no-modes", &if jumps { of_jumps() } else { error })]);
                }
            }
            Ok(answers)
        })
    }
}
