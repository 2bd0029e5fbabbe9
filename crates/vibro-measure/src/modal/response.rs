//! The lines of a frequency response function that may be fitted.

use super::BlowRecords;
use num_complex::Complex64;
use vibro_record::units::Quantity;
use vibro_record::{
    Axis, AxisKind, Error, Finding, Frf, Meta, Place, Record, Result, Scaling, Spectrum, Values, Window,
};

/// A frequency response function for modal analysis, complex or in magnitude only, with its coherence where
/// known.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Frequencies of the lines in Hz, rising.
    pub frequency: Vec<f64>,
    /// Values in SI; real where only magnitudes are known.
    pub values: Vec<Complex64>,
    /// Whether phases are unknown.
    pub magnitude_only: bool,
    /// Kind of the values, such as receptance or mobility.
    pub kind: Quantity,
    /// Coherence of each line.
    pub coherence: Option<Vec<f64>>,
    /// Window of the segments that the function was averaged over, each as long as the inverse of the line
    /// spacing. `None` where it was not averaged so, or that is not known.
    pub window: Option<Window>,
    /// Records of the blows of a hammer, where the function was averaged over them.
    pub blows: Option<BlowRecords>,
    /// Standard uncertainty of one component of each value, above 0, where it is known.
    pub std: Option<Vec<f64>>,
}

impl Measured {
    /// Complex values of one kind over frequencies in Hz, without coherence, window or uncertainty.
    pub fn new(frequency: Vec<f64>, values: Vec<Complex64>, kind: Quantity) -> Measured {
        Measured {
            frequency,
            values,
            magnitude_only: false,
            kind,
            coherence: None,
            window: None,
            blows: None,
            std: None,
        }
    }

    /// All lines of a complex function.
    pub fn complex(frf: &Frf) -> Measured {
        let window = frf.meta.averaged_with();
        let all = Measured::of(&frf.axis, frf.values.clone(), frf.meta.quantity);
        Measured { window, blows: BlowRecords::of(frf), ..all }
    }

    fn of(axis: &Axis, values: Vec<Complex64>, kind: Quantity) -> Measured {
        Measured::new(axis.values(), values, kind)
    }

    /// The function in a record: a response over a force, complex or in magnitude, or complex values of a
    /// kind that the file does not state. `None` for traces and other real values. Complex lines without
    /// frequencies, or with the unit or scaling of a spectrum, are refused.
    fn record(record: &Record) -> Result<Option<Measured>> {
        let spectrum = match record {
            Record::Frf(frf) => return Ok(Some(Measured::complex(frf))),
            Record::Spectrum(spectrum) => spectrum,
            Record::Trace(_) => return Ok(None),
        };
        let Spectrum { meta, axis, scaling, .. } = spectrum;
        let kind = meta.quantity;
        let values = match &spectrum.values {
            Values::Complex(values) => values,
            Values::Real(values) if kind.is_function() && axis.kind == AxisKind::Frequency => {
                let values = values.iter().map(|v| Complex64::new(v.abs(), 0.0)).collect();
                let measured = Measured::of(axis, values, kind);
                return Ok(Some(Measured { magnitude_only: true, ..measured }));
            }
            Values::Real(_) => return Ok(None),
        };
        if axis.kind != AxisKind::Frequency {
            return Err(Error::refused("the file does not say the frequencies of these lines")
                .hint("state the base band: the frequency of the last line")
                .setting("base_band"));
        }
        let one_signal = !matches!(meta.quantity, Quantity::Ratio | Quantity::Other);
        if !kind.is_function() && (one_signal || *scaling != Scaling::Unknown) {
            let of = format!(" of {} [{}]", meta.quantity.name(), meta.unit.symbol());
            let of = if one_signal { of } else { String::new() };
            let why = format!("a spectrum{of}, which is no response over a force");
            return Err(Error::refused(why)
                .hint("take the function from the two channels over time, or state its unit, e.g. m/N")
                .setting("reference")
                .setting("unit"));
        }
        Ok(Some(Measured::of(axis, values.clone(), kind)))
    }

    /// All functions among records, or those of one name or number, each with its record's meta data. One
    /// function and one coherence belong together.
    ///
    /// # Errors
    /// If there is none.
    pub fn all(records: &[Record], channel: Option<&str>) -> Result<Vec<(Meta, Measured)>> {
        let (mut found, mut refused) = (Vec::new(), None);
        for record in records {
            match Measured::record(record) {
                Ok(function) => found.extend(function.map(|function| (record.meta().clone(), function))),
                Err(error) => refused = Some(error),
            }
        }
        if let Some(name) = channel {
            let named = found.iter().any(|(meta, _)| meta.name == name);
            let number = name.parse::<usize>().ok().filter(|_| !named);
            let chosen = found.into_iter().enumerate();
            let chosen = chosen.filter(|(i, f)| number.map_or(f.0.name == name, |n| n == i + 1));
            found = chosen.map(|f| f.1).collect();
        }
        if found.is_empty() {
            let what = channel.map_or_else(String::new, |c| format!(" named {c:?}"));
            return Err(refused.unwrap_or_else(|| {
                let error = Error::refused(format!("no frequency response function{what}"));
                let traces = records.iter().filter(|record| matches!(record, Record::Trace(_))).count();
                let spectra = records.iter().any(|record| matches!(record, Record::Spectrum(_)));
                match traces {
                    0 if spectra && channel.is_none() => error.hint(
                        "write amplitudes divided by the force in one column, headed with a unit such as \
                         Receptance (µm/N), and the phase in the next",
                    ),
                    0 => error.hint("`vibro info` lists what is in the file"),
                    1 => error
                        .hint("`vibro decay` finds the modes of a free decay; a function needs two channels"),
                    _ => error.hint("name the channel of the force").setting("reference"),
                }
            }));
        }
        if let [(_, only)] = found.as_mut_slice()
            && records.iter().filter_map(coherence).count() == 1
        {
            *only = only.clone().with_coherence_of(records)?;
        }
        Ok(found)
    }

    /// Adds the coherence among records.
    ///
    /// # Errors
    /// If there is no coherence or more than one, or its lines are not those of the function.
    pub fn with_coherence_of(mut self, records: &[Record]) -> Result<Measured> {
        let all: Vec<&Spectrum> = records.iter().filter_map(coherence).collect();
        let [Spectrum { axis, values, .. }] = all.as_slice() else {
            let found = format!("{} coherences", all.len());
            let expected = "one: a column `coherence` of real values between 0 and 1 over frequency";
            let error = Error::input(Place::default(), found, expected);
            return Err(error.hint("name the column coherence, without a unit"));
        };
        let Values::Real(values) = values else {
            return Err(Error::refused("the coherence is complex: it is no coherence"));
        };
        let width = self.spacing();
        let near = |(i, f): (usize, &f64)| (axis.at(i) - f).abs() <= 1e-3 * width;
        let (own, other) = (self.frequency.len(), values.len());
        if own != other || !self.frequency.iter().enumerate().all(near) {
            let why = format!("the coherence has other lines ({other}) than the function ({own})");
            return Err(Error::refused(why));
        }
        self.coherence = Some(values.clone());
        Ok(self)
    }

    /// Distance of the lines in Hz.
    pub(super) fn spacing(&self) -> f64 {
        self.frequency.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min)
    }

    /// The lines of a band in Hz.
    pub(super) fn within(&self, (low, high): (f64, f64)) -> std::ops::Range<usize> {
        self.frequency.partition_point(|f| *f < low)..self.frequency.partition_point(|f| *f <= high)
    }

    /// Power of iω that takes a receptance to the values: 1 for a mobility, 2 for an accelerance.
    pub fn power(&self) -> i32 {
        match self.kind {
            Quantity::Mobility => 1,
            Quantity::Accelerance => 2,
            _ => 0,
        }
    }

    /// Unit of a modal constant, that of a receptance over s²: 1/kg for a response over a force, empty where
    /// the unit of the function is not known.
    pub fn unit_of_constants(&self) -> &'static str {
        match self.kind {
            Quantity::Receptance | Quantity::Mobility | Quantity::Accelerance => "1/kg",
            Quantity::Ratio => "1/s²",
            _ => "",
        }
    }

    /// Leaves out the lines that cannot be used, with a finding for each kind; `least` is the lowest
    /// coherence allowed.
    ///
    /// # Errors
    /// If fewer than five lines are left.
    pub(super) fn usable(mut self, least: f64, findings: &mut Vec<Finding>) -> Result<Measured> {
        let coherence = self.coherence.take();
        let n = self.frequency.len();
        let of = |i: usize| coherence.as_ref().and_then(|c| c.get(i)).copied();
        // Rounding may take a coherence a little beyond 0 or 1.
        let possible = -1e-6..=1.0 + 1e-6;
        let wrong = |i: usize| match of(i) {
            _ if !self.values[i].is_finite() => Some("frf-lines-missing"),
            Some(c) if c.is_nan() => Some("frf-lines-missing"),
            Some(c) if !possible.contains(&c) => Some("frf-lines-impossible-coherence"),
            Some(c) if c < least => Some("frf-lines-low-coherence"),
            _ => None,
        };
        for finding in [
            Finding::caution("frf-lines-missing"),
            Finding::caution("frf-lines-impossible-coherence"),
            Finding::caution("frf-lines-low-coherence").number("least", least),
        ] {
            let lines: Vec<usize> = (0..n).filter(|i| wrong(*i) == Some(finding.code.as_ref())).collect();
            if let [from, more @ ..] = lines.as_slice() {
                let first: Vec<f64> = lines.iter().take(NAMED).map(|i| self.frequency[*i]).collect();
                let found = finding.count("n", lines.len()).numbers("lines", first);
                let found = found.number("from", self.frequency[*from]);
                let to = more.last().map(|to| self.frequency[*to]);
                findings.push(to.map_or(found.clone(), |to| found.number("to", to)));
            }
        }
        let kept: Vec<usize> = (0..n).filter(|i| self.frequency[*i] > 0.0 && wrong(*i).is_none()).collect();
        if kept.len() < 5 {
            let why = format!("{} of {n} lines can be used: there is nothing to fit", kept.len());
            return Err(Error::refused(why));
        }
        let take = |all: &[f64]| kept.iter().map(|i| all[*i]).collect::<Vec<f64>>();
        Ok(Measured {
            frequency: take(&self.frequency),
            values: kept.iter().map(|i| self.values[*i]).collect(),
            coherence: coherence.as_deref().map(take),
            std: self.std.as_deref().map(take),
            ..self
        })
    }
}

/// Most lines that a finding names.
const NAMED: usize = 6;

/// The spectrum of a record that is a coherence by its scaling, or by its name where it has no unit.
fn coherence(record: &Record) -> Option<&Spectrum> {
    let Record::Spectrum(s) = record else { return None };
    let named = s.meta.name.to_lowercase().contains("coherence") && matches!(s.meta.unit.symbol(), "" | "1");
    let real = matches!(s.values, Values::Real(_));
    Some(s).filter(|s| s.scaling == Scaling::Coherence || (s.scaling == Scaling::Unknown && named && real))
}
