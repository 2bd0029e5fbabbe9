//! The lines of a frequency response function that may be fitted.

use num_complex::Complex64;
use vibro_record::units::notation::significant;
use vibro_record::{Error, Finding, Frf, FrfKind, Meta, Place, Record, Result, Scaling, Spectrum, Values};

/// A frequency response function as the estimates of modes take it, complex or in magnitude only, with its coherence where known.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Frequencies of the lines in Hz, rising.
    pub frequency: Vec<f64>,
    /// Values in SI; real where only magnitudes are known.
    pub values: Vec<Complex64>,
    /// Whether phases are unknown.
    pub magnitude_only: bool,
    /// What the values are.
    pub kind: FrfKind,
    /// Coherence of each line.
    pub coherence: Option<Vec<f64>>,
}

impl Measured {
    /// All lines of a complex function.
    pub fn complex(frf: &Frf) -> Measured {
        Measured {
            frequency: frf.axis.values(),
            values: frf.values.clone(),
            magnitude_only: false,
            kind: frf.kind,
            coherence: None,
        }
    }

    /// All lines of a spectrum of magnitudes whose unit is that of a response over a force; `None` for any other spectrum.
    pub fn magnitudes(spectrum: &Spectrum) -> Option<Measured> {
        let kind = FrfKind::of(spectrum.meta.quantity);
        match &spectrum.values {
            Values::Real(values) if kind != FrfKind::Other => Some(Measured {
                frequency: spectrum.axis.values(),
                values: values.iter().map(|v| Complex64::new(v.abs(), 0.0)).collect(),
                magnitude_only: true,
                kind,
                coherence: None,
            }),
            _ => None,
        }
    }

    /// All functions among records, or those of one name, each with its record's meta data: complex ones, and magnitudes in the
    /// unit of a response over a force. A coherence of the same lines among them is theirs where there is just one of each.
    ///
    /// # Errors
    /// If there is none.
    pub fn all(records: &[Record], channel: Option<&str>) -> Result<Vec<(Meta, Measured)>> {
        let mut found: Vec<(Meta, Measured)> = Vec::new();
        for record in records {
            let measured = match record {
                Record::Frf(frf) => Some(Measured::complex(frf)),
                Record::Spectrum(s) => match &s.values {
                    Values::Complex(values) => Some(Measured {
                        frequency: s.axis.values(),
                        values: values.clone(),
                        magnitude_only: false,
                        kind: FrfKind::of(s.meta.quantity),
                        coherence: None,
                    }),
                    Values::Real(_) => Measured::magnitudes(s),
                },
                Record::Trace(_) => None,
            };
            found.extend(measured.map(|m| (record.meta().clone(), m)));
        }
        let names: Vec<String> = found.iter().map(|f| f.0.name.clone()).collect();
        if let Some(name) = channel {
            let number = name.parse::<usize>().ok().filter(|n| *n >= 1 && !names.iter().any(|n| n == name));
            let mut at = 0;
            found.retain(|f| {
                at += 1;
                number.map_or(f.0.name == name, |n| n == at)
            });
        }
        if found.is_empty() {
            let what = channel.map_or_else(String::new, |c| format!(" named {c:?}"));
            return Err(Error::refused(format!("no frequency response function{what}"))
                .hint("`vibro info` lists what is in the file"));
        }
        if let [(_, only)] = found.as_mut_slice()
            && records.iter().filter(|r| is_coherence(r)).count() == 1
        {
            *only = only.clone().with_coherence_of(records)?;
        }
        Ok(found)
    }

    /// Adds the coherence among records.
    ///
    /// # Errors
    /// If there is none or several, or one of other lines.
    pub fn with_coherence_of(self, records: &[Record]) -> Result<Measured> {
        let all: Vec<&Record> = records.iter().filter(|r| is_coherence(r)).collect();
        match all.as_slice() {
            [Record::Spectrum(coherence)] => self.with_coherence(coherence),
            _ => Err(Error::input(
                Place::default(),
                format!("{} coherences", all.len()),
                "one: a column `coherence` of real values between 0 and 1 over frequency",
            )
            .hint("name the column coherence, without a unit")),
        }
    }

    /// Adds the coherence of the same lines.
    ///
    /// # Errors
    /// If it has another number of lines, or lines elsewhere.
    pub fn with_coherence(mut self, coherence: &Spectrum) -> Result<Measured> {
        let Values::Real(values) = &coherence.values else {
            return Err(Error::refused("the coherence is complex: it is no coherence"));
        };
        if 2 * values.iter().filter(|c| is_impossible(**c)).count() > values.len() {
            let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            return Err(Error::input(
                Place::default(),
                format!("a coherence up to {}", significant(largest, 4)),
                "values between 0 and 1",
            )
            .hint("divide a coherence in per cent by 100, or leave it out")
            .setting("coherence"));
        }
        let width = self.frequency.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
        let same = values.len() == self.frequency.len()
            && self
                .frequency
                .iter()
                .enumerate()
                .all(|(i, f)| (coherence.axis.at(i) - f).abs() <= 1e-3 * width);
        if !same {
            return Err(Error::refused(format!(
                "the coherence has other lines ({}) than the function ({})",
                values.len(),
                self.frequency.len()
            )));
        }
        self.coherence = Some(values.clone());
        Ok(self)
    }

    /// How often iω multiplies a receptance to give the values.
    pub(super) fn power(&self) -> i32 {
        match self.kind {
            FrfKind::Mobility => 1,
            FrfKind::Accelerance => 2,
            FrfKind::Receptance | FrfKind::Other => 0,
        }
    }

    /// Without the lines that cannot be used, each kind of which is a finding.
    ///
    /// # Errors
    /// If fewer than five lines are left.
    pub(super) fn usable(mut self, least: f64, findings: &mut Vec<Finding>) -> Result<Measured> {
        let coherence = self.coherence.take();
        let n = self.frequency.len();
        let of = |i: usize| coherence.as_ref().and_then(|c| c.get(i)).copied();
        let missing = |i: usize| !self.values[i].is_finite() || of(i).is_some_and(f64::is_nan);
        let impossible = |i: usize| !missing(i) && of(i).is_some_and(is_impossible);
        let low = |i: usize| !missing(i) && !impossible(i) && of(i).is_some_and(|c| c < least);
        let left_out: [(Finding, &dyn Fn(usize) -> bool); 3] = [
            (Finding::caution("frf-lines-missing"), &missing),
            (Finding::caution("frf-lines-impossible-coherence"), &impossible),
            (Finding::caution("frf-lines-low-coherence").number("least", least), &low),
        ];
        let mut good: Vec<bool> = self.frequency.iter().map(|f| *f > 0.0).collect();
        for (finding, is_left_out) in left_out {
            let lines: Vec<usize> = (0..n).filter(|i| is_left_out(*i)).collect();
            for i in &lines {
                good[*i] = false;
            }
            if !lines.is_empty() {
                let first: Vec<f64> = lines.iter().take(NAMED).map(|i| self.frequency[*i]).collect();
                findings.push(finding.count("n", lines.len()).numbers("lines", first));
            }
        }
        let kept: Vec<usize> = (0..n).filter(|i| good[*i]).collect();
        if kept.len() < 5 {
            return Err(Error::refused(format!(
                "{} of {n} lines can be used: there is nothing to fit",
                kept.len()
            )));
        }
        let take = |all: &[f64]| kept.iter().map(|i| all[*i]).collect::<Vec<f64>>();
        Ok(Measured {
            frequency: take(&self.frequency),
            values: kept.iter().map(|i| self.values[*i]).collect(),
            coherence: coherence.as_deref().map(take),
            ..self
        })
    }
}

/// Most lines that a finding names.
const NAMED: usize = 6;

/// Whether no measurement has this coherence. Rounding takes one of 1 a little beyond.
fn is_impossible(coherence: f64) -> bool {
    !coherence.is_nan() && !(-1e-6..=1.0 + 1e-6).contains(&coherence)
}

/// Whether a record says that it is a coherence, or is named so and has no unit.
fn is_coherence(record: &Record) -> bool {
    let Record::Spectrum(s) = record else { return false };
    let named = s.meta.name.to_lowercase().contains("coherence") && matches!(s.meta.unit.symbol(), "" | "1");
    let real = matches!(s.values, Values::Real(_));
    s.scaling == Scaling::Coherence || (s.scaling == Scaling::Unknown && named && real)
}
