//! Contact pulses: `[[pulse]]`, `vibro pulse`.

pub mod figures;
pub mod tables;

use super::job::Marks;
use super::{Analysis, Answer, Job, Source};
use crate::campaign::{Entry, LowPass, above_zero};
use crate::error::{Error, Result};
use crate::measure::pulse::{Instrument, PulseOptions, PulseResult, pulse, two_times};
use serde::Deserialize;

/// What is known of a pulse and of its instrument, or two times without a record.
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
    /// Decelerated mass in kg, for stiffness and damping
    pub mass: Option<f64>,
    /// Corner (-3 dB) of the instrument's Butterworth low-pass, in Hz, or none [default: not known, and no uncertainty]
    #[cfg_attr(feature = "cli", arg(value_name = "HZ", value_parser = LowPass::typed))]
    pub low_pass: Option<LowPass>,
    /// Order of that low-pass, 1 to 10
    pub order: Option<usize>,
}

impl Keys {
    /// Whether the keys go together, beside a file or without one.
    ///
    /// # Errors
    /// With the key that does not.
    pub fn usable(&self, file: bool) -> Result<()> {
        above_zero("mass", self.mass)?;
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
        let clash = if file { (first(&times), "a file") } else { (first(&low_pass), "two times") };
        if let (Some(key), beside) = clash {
            return Err(Error::usage(format!("{key} beside {beside}"), "one of them").setting(key));
        }
        self.instrument().map(drop).map_err(|e| e.setting(first(&low_pass).unwrap_or("order")))
    }

    fn instrument(&self) -> Result<Instrument> {
        Instrument::stated(self.low_pass.map(LowPass::corner), self.order)
    }

    /// The contact of two times.
    ///
    /// # Errors
    /// If the times cannot be.
    pub fn times(&self, name: &str) -> Result<Answer> {
        let (peak, duration) = self.time_to_peak.zip(self.duration).unwrap_or((f64::NAN, f64::NAN));
        shown(name, &two_times(peak, duration, self.std, self.mass)?)
    }

    /// The contact of a record.
    ///
    /// # Errors
    /// If the file cannot be read, or its trace allows no answer.
    pub fn measure(&self, source: &Source<'_>) -> Result<Answer> {
        let recording = source.recording()?;
        let trace = source.trace(&recording)?;
        let found = pulse(&trace, &PulseOptions { instrument: self.instrument()?, mass: self.mass })?;
        let mut answer = shown(source.name, &found)?;
        answer.tell("", &recording.findings);
        answer.tell("", &trace.meta.findings);
        Ok(answer)
    }
}

fn shown(name: &str, found: &PulseResult) -> Result<Answer> {
    let mut answer = Answer::of(found)?;
    answer.tell("", &found.findings);
    answer.figures.extend(figures::pulse(name, found).map(|figure| ("pulse".to_owned(), figure)));
    answer.table("pulse", tables::pulse(name, found));
    if !found.fits.is_empty() {
        answer.table("pulse_fits", tables::pulse_fits(name, found));
    }
    Ok(answer)
}

impl Analysis for Keys {
    const SECTION: &'static str = "pulse";

    fn check(entry: &Entry<Keys>, _: &[Entry<Keys>]) -> Result<()> {
        entry.keys.usable(entry.file.is_some())
    }

    fn run(entries: &[Entry<Keys>], job: &mut Job<'_>) -> Result<()> {
        job.each("pulses", entries, Marks::Numbers, |entry, source| {
            let of_file = entry.file.is_some();
            let answer = if of_file { entry.keys.measure(source) } else { entry.keys.times(source.name) };
            Ok(vec![answer?])
        })
    }
}
