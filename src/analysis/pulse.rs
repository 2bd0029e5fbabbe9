//! Contact pulses: `[[pulse]]`, `vibro pulse`.

pub mod figures;

use super::answer::Answer;
use super::headline::headline;
use super::job::Job;
use super::kind::Analysis;
use super::source::Source;
use crate::campaign::{Entry, KeyRange, LowPass};
use crate::error::{Error, Result};
use crate::measure::Estimate;
use crate::measure::pulse::{Instrument, PulseOptions, PulseResult, pulse, two_times};
use crate::record::doubt_with_record;
use crate::report::files::Names;
use crate::report::layout::{capital, headed, pair, table, titled};
use crate::report::{Cell, Table};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Known properties of a pulse and its instrument, or two times in place of a record.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// Time from the onset to the largest force in s, instead of a file
    #[cfg_attr(
        feature = "cli",
        arg(value_name = "S",
            conflicts_with_all = crate::campaign::Channel::KEYS.into_iter().chain(crate::campaign::Reading::KEYS)
        )
    )]
    pub time_to_peak: Option<f64>,
    /// Time from the onset to the end of the contact, in s
    pub duration: Option<f64>,
    /// Standard uncertainty of each of the two times, in s
    pub std: Option<f64>,
    /// Decelerated mass in kg, for stiffness and damping, of an acceleration also for force and impulse
    pub mass: Option<f64>,
    /// Corner (-3 dB) of the instrument's Butterworth low-pass, in Hz, or none [default: not known, and no
    /// uncertainty]
    #[cfg_attr(feature = "cli", arg(value_name = "HZ", value_parser = LowPass::typed))]
    pub low_pass: Option<LowPass>,
    /// Order of that low-pass, 1 to 10
    pub order: Option<usize>,
}

impl Keys {
    /// Checks that the keys go together, with or without a file.
    ///
    /// # Errors
    /// The key that does not.
    pub fn usable(&self, file: bool) -> Result<()> {
        let times = [
            ("time_to_peak", self.time_to_peak.is_some()),
            ("duration", self.duration.is_some()),
            ("std", self.std.is_some()),
        ];
        let low_pass = [("low_pass", self.low_pass.is_some()), ("order", self.order.is_some())];
        let first = |keys: &[(&'static str, bool)]| keys.iter().find(|k| k.1).map(|k| k.0);
        let both = times[0].1 && times[1].1;
        if !file && !both {
            let expected = "a file, or time_to_peak and duration";
            return Err(match first(&times) {
                Some(key) => Error::usage("only one of time_to_peak and duration", expected).setting(key),
                None => Error::usage("neither a file nor two times", expected),
            });
        }
        if let (Some(key), true) = (first(&times), file) {
            return Err(Error::usage(format!("{key} beside a file"), "one of them").setting(key));
        }
        self.instrument().map(drop).map_err(|e| e.setting(first(&low_pass).unwrap_or("order")))
    }

    fn instrument(&self) -> Result<Instrument> {
        Instrument::stated(self.low_pass.map(LowPass::corner), self.order)
    }

    fn options(&self) -> Result<PulseOptions> {
        Ok(PulseOptions { instrument: self.instrument()?, mass: self.mass })
    }

    /// The contact from two times.
    ///
    /// # Errors
    /// If the times are impossible.
    pub fn times(&self, name: &str) -> Result<Answer> {
        let (peak, duration) = self.time_to_peak.zip(self.duration).unwrap_or((f64::NAN, f64::NAN));
        shown(name, &two_times(peak, duration, self.std, &self.options()?)?)
    }

    /// The contact of a record.
    ///
    /// # Errors
    /// If the file cannot be read, or its trace allows no answer.
    pub fn measure(&self, source: &Source<'_>) -> Result<Answer> {
        let recording = source.recording()?;
        let trace = source.trace(&recording)?;
        let mut found = pulse(&trace, &self.options()?)?;
        doubt_with_record(recording.findings.iter().chain(&trace.meta.findings), &mut found);
        let mut answer = shown(source.name, &found)?;
        answer.add("", &recording.findings);
        answer.add("", &trace.meta.findings);
        Ok(answer)
    }
}

fn shown(name: &str, found: &PulseResult) -> Result<Answer> {
    let mut answer = Answer::of(found)?;
    answer.add("", &found.findings);
    answer.figure("pulse", figures::pulse(name, found));
    answer.evidence.push(found.into());
    answer.headlines.push(headline(
        "Contact pulses",
        [found],
        &[
            ("damping ratio ξ", "", &|f| Cell::from(&f.xi)),
            ("restitution", "", &|f| Cell::from(&f.restitution)),
            ("duration", "s", &|f| Cell::from(&f.duration)),
            ("peak force", "N", &|f| f.peak.as_ref().into()),
            ("impulse", "N s", &|f| known_impulse(f).into()),
            ("stiffness", "N/m", &|f| f.stiffness.as_ref().into()),
        ],
    ));
    answer.table("pulse", contact(name, found));
    if !found.fits.is_empty() {
        let models = models(name, found);
        answer.csv("pulse_fits", &models);
        // Parameters stand in the file: most models have none of those of another.
        answer.tables.push(models.leading(QUALITY.len()));
    }
    Ok(answer)
}

/// The impulse of the contact; where that has no uncertainty, the one that the samples show.
fn known_impulse(found: &PulseResult) -> Option<&Estimate> {
    found.impulse.as_ref().filter(|impulse| impulse.std.is_some()).or(found.impulse_read.as_ref())
}

/// Quantities of a contact from its pulse, one column each, in SI units.
fn contact(title: &str, result: &PulseResult) -> Table {
    table(
        titled("Contact", title),
        [result],
        &[
            ("damping ratio ξ", "1", &|r| Cell::from(&r.xi)),
            ("frequency", "Hz", &|r| Cell::from(&r.frequency)),
            ("duration", "s", &|r| Cell::from(&r.duration)),
            ("restitution", "1", &|r| Cell::from(&r.restitution)),
            ("initial velocity", "m/s", &|r| r.initial_velocity.as_ref().into()),
            ("peak force", "N", &|r| r.peak.as_ref().into()),
            ("peak force as read", "N", &|r| r.peak_read.as_ref().into()),
            ("impulse", "N s", &|r| r.impulse.as_ref().into()),
            ("impulse as read", "N s", &|r| r.impulse_read.as_ref().into()),
            ("stiffness", "N/m", &|r| r.stiffness.as_ref().into()),
            ("damping", "N s/m", &|r| r.damping.as_ref().into()),
        ],
    )
}

/// Columns that tell how well a model fits, such as the probability that its residual is noise.
const QUALITY: [&str; 5] = ["model", "RMS residual", "AICc", "p of a white residual", "samples"];

/// The models that were fitted to the pulse, with their parameters.
fn models(title: &str, result: &PulseResult) -> Table {
    let all = result.fits.iter().flat_map(|f| &f.parameters);
    let parameters: BTreeMap<&str, &str> = all.map(|(name, e)| (*name, e.unit)).collect();
    let unit = parameters.get("baseline").copied().unwrap_or_default();
    let columns = QUALITY.map(|name| (name, if name == "RMS residual" { unit } else { "" }));
    let head = |name: &str| name.replace('_', " ").replace("xi", "damping ratio ξ");
    let own = |table: Table, (name, unit): (&&str, &&str)| table.column(head(name), *unit);
    let mut table = parameters.iter().fold(headed(titled("Models", title), &columns), own);
    for fit in &result.fits {
        let whiteness = match fit.whiteness {
            Some(p) if p < 1e-6 => Cell::from("< 1e-6"),
            p => p.map_or(Cell::Missing, |p| pair(p, None)),
        };
        let known = [
            Cell::from(fit.model.words()),
            pair(fit.residual, None),
            pair(fit.aicc, None),
            whiteness,
            Cell::from(fit.n),
        ];
        let own = parameters.keys().map(|name| fit.parameters.get(name).map_or(Cell::Missing, Cell::from));
        table.push(known.into_iter().chain(own));
    }
    let unfitted = result.unfitted.iter().map(|u| format!(" {}: {}.", capital(u.model.words()), u.reason));
    table.note(format!(
        "The lowest AICc fits best. p below 0.01: the residual is not noise, so the model does not describe the pulse.{}",
        unfitted.collect::<String>()
    ))
}

impl Analysis for Keys {
    const SECTION: &'static str = "pulse";
    const TITLE: &'static str = "Contact pulses";
    const FILES: Names = Names::Numbered(&["pulse", "pulse_fits"]);
    const RANGES: &'static [KeyRange] = &[
        KeyRange::above_zero("s", &["time_to_peak", "duration"]).times(),
        KeyRange::from_zero("s", &["std"]).times(),
    ];

    fn check(entry: &Entry<Keys>, _: &[Entry<Keys>]) -> Result<()> {
        entry.keys.usable(entry.file.is_some())
    }

    fn run(entries: &[Entry<Keys>], job: &mut Job<'_>) -> Result<()> {
        job.each("pulses", entries, |entry, source| {
            let of_file = entry.file.is_some();
            let answer = if of_file { entry.keys.measure(source) } else { entry.keys.times(source.name) };
            Ok(vec![answer?])
        })
    }
}
