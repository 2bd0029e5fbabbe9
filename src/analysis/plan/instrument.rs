//! The instrument of a plan: the table `[instrument]`.

use super::knob::Knob;
use crate::campaign::{Campaign, KeyRange, LowPass};
use crate::error::{Error, Result};
use crate::measure::expected::{Expected, Recorder};
use crate::measure::pulse;
use serde::Deserialize;

/// Keys of the instrument, in the unit of the record.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Instrument {
    /// Sampling rate in Hz.
    pub rate: Option<f64>,
    /// Length of a record in s.
    pub duration: Option<f64>,
    /// Bits of the converter.
    pub bits: Option<f64>,
    /// Largest value of the converter, which goes from −range to range.
    pub range: Option<f64>,
    /// Standard deviation of the noise of a sample, behind the low-pass.
    pub noise: Option<f64>,
    /// Spectral density of the sensor's noise before the low-pass, per √Hz.
    pub noise_density: Option<f64>,
    /// Corner of the low-pass in Hz, or none.
    pub low_pass: Option<LowPass>,
    /// Its order.
    pub order: Option<usize>,
    /// Number of records; their answers are averaged.
    pub averages: Option<f64>,
    /// Number of drawn records that the estimator measures.
    pub rehearsals: Option<usize>,
}

/// Records that are drawn unless their number is stated: some second of work, and root mean square errors
/// that are known to 16 %.
const REHEARSALS: usize = 20;

/// Most samples of a planned record, which is drawn for each rehearsal.
const MOST_SAMPLES: f64 = 1e7;

impl Instrument {
    /// Name of the table.
    pub const SECTION: &'static str = "instrument";

    const RANGES: &'static [KeyRange] = &[
        KeyRange::above_zero("s", &["duration"]).times(),
        KeyRange::above_zero("", &["bits"]).within(1.0, 64.0),
        KeyRange::above_zero("", &["range"]),
        KeyRange::from_zero("", &["noise", "noise_density"]),
        KeyRange::above_zero("", &["averages"]).within(1.0, 1e4),
        KeyRange::count(1e4, &["rehearsals"]),
    ];

    /// The instrument of a plan; without a table it has no keys.
    ///
    /// # Errors
    /// If a key is unknown, impossible, or lacks another.
    pub fn of(plan: &Campaign) -> Result<Instrument> {
        let Some((entry, checked)) = plan.single::<Instrument>(Instrument::SECTION, Instrument::RANGES)?
        else {
            return Ok(Instrument::default());
        };
        let checked = checked.and_then(|()| entry.keys.check());
        checked.map_err(|error| plan.fault(&entry, error)).map(|()| entry.keys)
    }

    fn check(&self) -> Result<()> {
        self.filter()?;
        match (self.bits, self.range) {
            (Some(_), None) => {
                Err(Error::usage("bits without a range", "the largest value of the converter, range = …")
                    .setting("bits"))
            }
            (None, Some(_)) => {
                Err(Error::usage("a range without bits", "the bits of the converter, bits = 16")
                    .setting("range"))
            }
            _ => Ok(()),
        }
    }

    fn filter(&self) -> Result<Option<pulse::LowPass>> {
        let stated = self.low_pass.map(LowPass::corner);
        let stated = pulse::Instrument::stated(stated, self.order);
        let stated =
            stated.map_err(|e| e.setting(if self.order.is_some() { "order" } else { "low_pass" }))?;
        Ok(stated.low_pass().cloned())
    }

    /// The recorder, with a length of the record in s where none is stated.
    ///
    /// # Errors
    /// If a key is missing, or no noise is stated.
    pub fn recorder(&self, duration: Option<f64>) -> Result<Recorder> {
        let missing = |key: &'static str, such: &str| {
            let found = format!("[instrument] without {key}");
            Error::usage(found, format!("add {key} = …")).hint(format!("such as {key} = {such}"))
        };
        let rate = self.rate.ok_or_else(|| missing("rate", "51200, in Hz"))?;
        let duration = self.duration.or(duration).ok_or_else(|| missing("duration", "2, in s"))?;
        if rate * duration > MOST_SAMPLES {
            let found = format!("a record of {:.3e} samples, {rate} Hz times {duration} s", rate * duration);
            let expected = format!("{MOST_SAMPLES:e} at most");
            return Err(Error::usage(found, expected)
                .hint("plan a shorter duration with averages = N")
                .setting("duration"));
        }
        let step = self.range.zip(self.bits).map_or(0.0, |(range, bits)| 2.0 * range / 2f64.powf(bits));
        let (noise, density) = (self.noise.unwrap_or(0.0), self.noise_density.unwrap_or(0.0));
        if step + noise + density == 0.0 {
            return Err(missing(
                "noise",
                "0.01, in the unit of the record; or noise_density, or bits and range",
            ));
        }
        let (range, low_pass) = (self.range, self.filter()?);
        Ok(Recorder { rate, duration, step, range, noise, density, low_pass })
    }

    /// What of an instrument can be changed to know more.
    pub fn knobs<G: Clone>() -> Vec<Knob<G>> {
        vec![
            Knob::new("noise", "half the noise", 0.5, |instrument, _, by| {
                let Instrument { noise, noise_density, .. } = instrument;
                [&mut *noise, &mut *noise_density].into_iter().flatten().for_each(|noise| *noise *= by);
                noise.or(*noise_density).is_some()
            }),
            Knob::new("converter step", "two more bits", 0.25, |instrument, _, by| {
                instrument.bits.as_mut().map(|bits| *bits -= by.log2()).is_some()
            }),
            Knob::new("sampling rate", "twice the sampling rate", 2.0, |instrument, _, by| {
                instrument.rate.as_mut().map(|rate| *rate *= by).is_some()
            }),
            Knob::new("low-pass corner", "twice the low-pass corner", 2.0, |instrument, _, by| {
                let corner = instrument.low_pass.and_then(LowPass::corner);
                corner.map(|corner| instrument.low_pass = Some(LowPass::Corner(by * corner))).is_some()
            }),
            Knob::new("record length", "twice the record length", 2.0, |instrument, _, by| {
                instrument.duration.as_mut().map(|duration| *duration *= by).is_some()
            }),
            Knob::new("number of records", "twice the records", 2.0, |instrument, _, by| {
                instrument.averages = Some(instrument.averages.unwrap_or(1.0) * by);
                true
            }),
        ]
    }

    /// Number of records to draw.
    pub fn rehearsals(&self) -> usize {
        self.rehearsals.unwrap_or(REHEARSALS)
    }

    /// Number of records.
    pub fn records(&self) -> f64 {
        self.averages.unwrap_or(1.0)
    }

    /// Averages what one record tells over all records.
    pub fn averaged(&self, mut one: Expected) -> Expected {
        let n = self.records();
        for (_, answer) in &mut one.answers {
            answer.std = answer.std.map(|std| std / n.sqrt());
            answer.n = (answer.n as f64 * n) as usize;
        }
        one
    }
}
