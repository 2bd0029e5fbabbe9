//! From displacement to velocity, in time.

use super::sound::no_gaps;
use std::f64::consts::TAU;
use vibro_record::{Error, Result, Trace};

/// A differentiated trace and the frequency up to which its amplitudes are accurate.
#[derive(Debug, Clone, PartialEq)]
pub struct Differentiated {
    /// The trace, with its new unit.
    pub trace: Trace,
    /// Frequency in Hz up to which amplitudes are right within 1 %; higher ones come out too small.
    pub highest: f64,
}

/// Weights of five neighbouring samples for the derivative at the first, second and middle one, in 1/(12 Δt):
/// the derivative of the polynomial through them (Abramowitz & Stegun, Handbook of Mathematical Functions,
/// 1964, table 25.2).
const WEIGHTS: [[f64; 5]; 3] =
    [[-25.0, 48.0, -36.0, 16.0, -3.0], [-3.0, -10.0, 18.0, -6.0, 1.0], [1.0, -8.0, 0.0, 8.0, -1.0]];

/// Differentiates a trace `times` times by differences of five samples. There is no delay; noise grows with
/// frequency.
///
/// # Errors
/// If `times` is not 1 or 2, the trace has no sampling rate or fewer than five samples, or a sample is
/// missing.
pub fn in_time(trace: &Trace, times: u8) -> Result<Differentiated> {
    if !(1..=2).contains(&times) {
        return Err(Error::usage(format!("{times} differentiations"), "1 or 2"));
    }
    let rate = trace.sampling_rate()?;
    if trace.values.len() < 5 {
        let why =
            format!("{} samples are too few to differentiate: at least 5 are needed", trace.values.len());
        return Err(Error::refused(why));
    }
    no_gaps(&trace.values, &trace.meta.name, 0)?;
    let mut values = trace.values.clone();
    for _ in 0..times {
        values = once(&values, rate / 12.0);
    }
    let mut trace = Trace { values, ..trace.clone() };
    let meta = &mut trace.meta;
    meta.unit = meta.unit.times_seconds(-(times as i8));
    meta.quantity = meta.unit.quantity();
    meta.step("differentiate", &[("times", &times), ("rule", &"differences of five samples")]);
    // Gain of one differentiation over the true one: (8 sin x − sin 2x)/(6x) ≈ 1 − x⁴/30, x = ωΔt.
    let highest = rate / TAU * (30.0 * 0.01 / f64::from(times)).powf(0.25);
    Ok(Differentiated { trace, highest })
}

/// One differentiation; `factor` is 1/(12 Δt).
fn once(values: &[f64], factor: f64) -> Vec<f64> {
    let sum = |part: &[f64], weights: &[f64; 5]| -> f64 {
        factor * part.iter().zip(weights).map(|(v, w)| v * w).sum::<f64>()
    };
    let [first, second, middle] = &WEIGHTS;
    let mut out = vec![sum(&values[..5], first), sum(&values[..5], second)];
    out.extend(values.windows(5).map(|part| sum(part, middle)));
    // The last two samples use the weights of the first two, in reverse order and with opposite sign.
    let tail: Vec<f64> = values.iter().rev().take(5).map(|v| -v).collect();
    out.extend([sum(&tail, second), sum(&tail, first)]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_record::units::Unit;
    use vibro_record::{Axis, Meta};

    fn trace(rate: f64, values: Vec<f64>) -> Trace {
        let meta = Meta::new("laser", Unit::parse("m").unwrap());
        Trace { meta, axis: Axis::time(0.0, 1.0 / rate, values.len()), values }
    }

    #[test]
    fn polynomials_of_fourth_degree_are_exact_to_their_ends() {
        let time = |i: i32| f64::from(i) / 8.0;
        let t = (0..9).map(|i| time(i).powi(4) - 3.0 * time(i).powi(3) + time(i));
        let found = in_time(&trace(8.0, t.collect()), 1).unwrap();
        for (i, v) in (0..).zip(&found.trace.values) {
            let truth = 4.0 * time(i).powi(3) - 9.0 * time(i).powi(2) + 1.0;
            // Tolerance: rounding of five terms of up to 48·8/12 times values of order one.
            assert!((v - truth).abs() < 160.0 * 4.0 * f64::EPSILON, "{i}: {v} {truth}");
        }
        assert_eq!(found.trace.meta.unit.symbol(), "m/s");
    }

    #[test]
    fn amplitudes_are_right_up_to_the_stated_frequency() {
        let rate = 1000.0;
        for times in [1u8, 2] {
            let highest = in_time(&trace(rate, vec![0.0; 5]), times).unwrap().highest;
            for f in [1.0, 0.5 * highest, highest] {
                let omega = TAU * f;
                let values = (0..4000).map(|i| (omega * f64::from(i) / rate).sin()).collect();
                let found = in_time(&trace(rate, values), times).unwrap().trace;
                let largest = found.values[10..3990].iter().fold(0.0, |a: f64, v| a.max(v.abs()));
                let factor = largest / omega.powi(i32::from(times));
                // The next term of the series, x⁶/252 for each differentiation, raises the gain. A crest
                // between two samples is missed by up to x²/8, but not by 4000 samples.
                assert!(factor < 1.0001 && factor > 0.99, "{f} Hz, {times}: {factor}");
                assert!(f < highest || factor < 0.993, "{f} Hz, {times}: {factor}");
            }
        }
    }

    #[test]
    fn what_cannot_be_differentiated_is_refused() {
        let refused = |trace: &Trace, times| in_time(trace, times).unwrap_err().to_string();
        assert!(refused(&trace(1.0, vec![1.0; 4]), 1).contains("4 samples"));
        assert!(refused(&trace(1.0, vec![f64::NAN; 9]), 1).contains("missing"));
        assert!(refused(&trace(1.0, vec![1.0; 9]), 3).contains("3 differentiations"));
    }
}
