//! Frequency response functions from averaged spectra, with coherence and random error.
//!
//! With the averages A = ⟨|X|²⟩, B = ⟨|Y|²⟩ and C = ⟨conj(X) Y⟩ of excitation x and response y: H1 = C/A
//! (noise in the response does not bias it), H2 = B/conj(C) (noise in the excitation does not bias it), Hv =
//! √(B/A) with the phase of C, the geometric mean of both (Rocklin, Crowley & Vold 1985); γ² = |C|²/(AB). A
//! response that lags has a negative phase.

use super::integrate;
use super::welch::Averages;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use vibro_record::units::Unit;
use vibro_record::{Axis, Error, Finding, Frf, Meta, Result, Scaling, Spectrum, Values};

/// At a line below this fraction of the largest power, excitation or response is only rounding.
const NOTHING: f64 = 1e-28;

/// From this many independent averages on, ±1.96 standard deviations hold the truth in 92 to 98 % of all
/// cases. The deviation is itself an estimate with 2(n − 1) degrees of freedom: Student's t gives 81 % for
/// two averages, 88 % for three.
const ENOUGH: f64 = 7.0;
/// With fewer independent averages the coherence is near 1 whatever was measured.
const LEAST: f64 = 2.0;

/// Value of a line that has no function.
const NOWHERE: Complex64 = Complex64::new(f64::NAN, f64::NAN);

/// Estimator of a frequency response function: H1 for noise in the response, H2 for noise in the excitation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Estimator {
    /// Noise in the response averages out.
    H1,
    /// Noise in the excitation averages out.
    H2,
    /// Geometric mean of both.
    Hv,
}

impl Estimator {
    /// Name, as in JSON.
    pub fn name(self) -> &'static str {
        ["h1", "h2", "hv"][self as usize]
    }
}

/// A frequency response function with its uncertainty, line by line from the first above 0 Hz.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    /// The function; NaN where excitation or response is empty.
    pub frf: Frf,
    /// Coherence γ²; NaN where there is no function, and empty for one average, which has none.
    pub coherence: Vec<f64>,
    /// Standard deviation of the magnitude, in its unit; NaN where the coherence is too low for one.
    pub magnitude_std: Vec<f64>,
    /// Standard deviation of the phase in rad; NaN where the coherence is too low for one.
    pub phase_std: Vec<f64>,
    /// Segments averaged.
    pub averages: usize,
    /// Findings that limit the use of the function.
    pub findings: Vec<Finding>,
}

impl Transfer {
    /// Removes the function at the lines that are `silent`, by their index from the first above 0 Hz, and
    /// adds the number of lines and the lowest frequency to the finding.
    pub(super) fn silence(&mut self, silent: impl Fn(usize) -> bool, found: Finding) {
        let (mut removed, mut lowest) = (0, f64::INFINITY);
        for k in (0..self.frf.values.len()).filter(|k| silent(*k)) {
            if self.frf.values[k].is_finite() {
                removed += 1;
                lowest = lowest.min(self.frf.axis.at(k));
            }
            self.frf.values[k] = NOWHERE;
            let beside = [&mut self.magnitude_std, &mut self.phase_std, &mut self.coherence];
            beside.into_iter().filter_map(|of| of.get_mut(k)).for_each(|v| *v = f64::NAN);
        }
        let lines = self.frf.values.len();
        if removed > 0 {
            // Lines without a function have no coherence to be low.
            let left = self.frf.values.iter().filter(|v| v.is_finite()).count();
            self.findings.retain(|found| found.code != LOW);
            self.findings.extend(low(&self.coherence, left));
            let found = found.count("n", removed).count("lines", lines);
            self.findings.push(found.number("from", lowest));
        }
    }

    /// The function of the response integrated `times` times (mobility becomes receptance with 1, accelerance
    /// with 2), from `fmin` Hz on, with its uncertainties and its coherence.
    ///
    /// # Errors
    /// If `times` is not −2 to 2, or no line is left.
    pub fn integrated(mut self, times: i8, fmin: f64) -> Result<Transfer> {
        let spectrum = Spectrum {
            meta: self.frf.meta,
            axis: self.frf.axis,
            values: Values::Complex(self.frf.values),
            scaling: Scaling::Unknown,
            window: None,
            enbw: None,
        };
        let result = integrate::in_frequency(&spectrum, times, fmin)?;
        let gone = spectrum.axis.len() - result.axis.len();
        for column in [&mut self.coherence, &mut self.phase_std, &mut self.magnitude_std] {
            column.drain(..gone.min(column.len()));
        }
        for (k, std) in self.magnitude_std.iter_mut().enumerate() {
            *std *= (TAU * result.axis.at(k)).powi(-i32::from(times));
        }
        let values = match result.values {
            Values::Complex(values) => values,
            Values::Real(values) => values.into_iter().map(Complex64::from).collect(),
        };
        self.frf = Frf { meta: result.meta, axis: result.axis, values };
        Ok(self)
    }
}

/// Code of the finding of a low coherence.
const LOW: &str = "frf-low-coherence";

/// The finding that more than half of `lines`, the number of lines with a function, have a coherence below
/// 0.5.
fn low(coherence: &[f64], lines: usize) -> Option<Finding> {
    let poor = coherence.iter().filter(|c| **c < 0.5).count();
    (2 * poor > lines).then(|| Finding::caution(LOW).count("n", poor).count("lines", lines))
}

/// The function from the first channel of `averages` to another.
///
/// Random errors as in Bendat & Piersol, Random Data (4th ed. 2010), table 9.6: ε(|H|) = √(1−γ²)/(|γ|√(2n)),
/// and arcsin ε for the phase in rad. The magnitude of Hv is a root of B/A without C, and with the variances
/// of A and B (1/n) and their covariance (γ²/n) from the same table ε(|Hv|) = √(1−γ²)/√(2n). Here n is the
/// number of independent segments less one, which H itself uses up. Fewer than 7 averages keep their standard
/// deviations, with a finding: these are valid, but themselves uncertain. One average alone has neither a
/// coherence, which would always be 1, nor a standard deviation.
///
/// # Errors
/// For fewer than two independent averages of segments that overlap, and if there are no products with that
/// channel or the excitation is empty.
pub fn transfer(
    averages: &Averages,
    channel: usize,
    metas: &[Meta],
    estimator: Estimator,
) -> Result<Transfer> {
    let alone = averages.count == 1;
    enough(averages)?;
    let (Some(reference), Some(response)) = (metas.first(), metas.get(channel)) else {
        return Err(Error::usage(format!("channel {}", channel + 1), "a channel of the record"));
    };
    let (xx, yy, xy) = products(averages, channel)?;
    let (most, loudest) = (largest(xx), largest(yy));
    if most == 0.0 {
        return Err(Error::refused(format!("the excitation {:?} is empty", reference.name)));
    }
    let degrees = averages.effective - 1.0;
    let lines = xx.len().saturating_sub(1);
    let empty = |xx: &f64, yy: &f64| *xx <= NOTHING * most || *yy <= NOTHING * loudest;
    let line = |((xx, yy), xy): ((&f64, &f64), &Complex64)| {
        let h = match estimator {
            Estimator::H1 => xy / xx,
            Estimator::H2 => yy / xy.conj(),
            Estimator::Hv => xy / xy.norm() * (yy / xx).sqrt(),
        };
        // Rounding may put the coherence slightly above 1.
        let coherence = if alone { f64::NAN } else { (xy.norm_sqr() / (xx * yy)).min(1.0) };
        if empty(xx, yy) || !h.is_finite() { (NOWHERE, f64::NAN) } else { (h, coherence) }
    };
    let (values, coherence): (Vec<Complex64>, Vec<f64>) = xx.iter().zip(yy).zip(xy).skip(1).map(line).unzip();
    let error =
        |c: &f64| Some(((1.0 - c) / (2.0 * degrees * c)).sqrt()).filter(|e| *e < 1.0).unwrap_or(f64::NAN);
    let of_magnitude = |c: &f64| if estimator == Estimator::Hv { error(c) * c.sqrt() } else { error(c) };
    let silent = xx.iter().zip(yy).skip(1).filter(|(xx, yy)| empty(xx, yy)).count();
    let few = Finding::caution("frf-few-averages").count("averages", averages.count);
    let findings = [
        (silent > 0, Finding::caution("frf-lines-empty").count("n", silent).count("lines", lines)),
        (averages.effective < ENOUGH && !alone, few.number("independent", averages.effective)),
    ];
    let mut meta = named(reference, response);
    meta.step(
        "transfer",
        &[
            ("estimator", &estimator.name()),
            ("reference", &reference.name),
            ("averages", &averages.count),
            ("segment", &averages.length),
        ],
    );
    let axis = Axis::frequency(averages.step(), averages.step(), lines);
    Ok(Transfer {
        magnitude_std: values.iter().zip(&coherence).map(|(h, c)| h.norm() * of_magnitude(c)).collect(),
        phase_std: coherence.iter().map(|c| error(c).asin()).collect(),
        averages: averages.count,
        findings: findings.into_iter().filter(|f| f.0).map(|f| f.1).chain(low(&coherence, lines)).collect(),
        frf: Frf { meta, axis, values },
        coherence: if alone { Vec::new() } else { coherence },
    })
}

/// Refuses fewer than two independent averages of segments that overlap.
fn enough(averages: &Averages) -> Result<()> {
    // Rounding may put the effective number of two segments without overlap slightly below 2.
    if averages.count == 1 || averages.effective >= LEAST - 1e-9 {
        return Ok(());
    }
    let (n, effective) = (averages.count, averages.effective);
    let why = format!("{n} segments count as {effective:.2}; coherence needs two or more");
    let hint = "take a longer record or shorter segments, for ten averages or more";
    Err(Error::refused(why).hint(hint).setting("segment"))
}

/// Power of the first channel and of another, and their cross power, line by line.
fn products(averages: &Averages, channel: usize) -> Result<(&[f64], &[f64], &[Complex64])> {
    let cross = channel.checked_sub(1).and_then(|i| averages.cross.get(i));
    let (Some(xx), Some(yy), Some(xy)) = (averages.auto.first(), averages.auto.get(channel), cross) else {
        return Err(Error::usage("averages without products", "products with the first channel"));
    };
    Ok((xx, yy, xy))
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// Name, unit and history of a response over an excitation.
fn named(reference: &Meta, response: &Meta) -> Meta {
    let (x, y) = (&reference.unit, &response.unit);
    let unit = if x == y {
        Unit::parse("1").unwrap_or_else(|| Unit::opaque("1"))
    } else {
        Unit::parse_or_opaque(&format!("({y})/({x})")).si()
    };
    let mut meta = Meta::new(format!("{} / {}", response.name, reference.name), unit);
    meta.findings.clone_from(&response.findings);
    reference.findings.iter().for_each(|f| meta.found(f.clone()));
    meta.history.clone_from(&response.history);
    meta.clock = response.clock.max(reference.clock);
    meta
}

#[cfg(test)]
mod tests;
