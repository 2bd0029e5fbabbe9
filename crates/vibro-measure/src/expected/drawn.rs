//! Noise of planned records, drawn.

use super::Recorder;
use crate::converter::rounding;
use num_complex::Complex64;
use vibro_math::Noise;
use vibro_record::units::Unit;
use vibro_record::{Axis, Meta, Trace};
use vibro_signal::fft::Transform;

/// Draws the noise of a recorder.
///
/// Noise that a low-pass has coloured is drawn by its covariance on a circle of twice the record, whose
/// eigenvalues are the spectrum (Dietrich & Newsam 1997).
pub(crate) struct DrawnNoise {
    recorder: Recorder,
    coloured: Option<(Transform, Vec<f64>)>,
}

impl DrawnNoise {
    /// For records of up to `n` samples.
    pub fn of(recorder: &Recorder, n: usize) -> DrawnNoise {
        let coloured = || {
            let circle = (2 * n).next_power_of_two();
            let apart = |i: usize| i.min(circle - i);
            let covariance =
                |i: usize| recorder.covariance(apart(i)) - recorder.covariance_of_white(apart(i));
            let transform = Transform::new(circle);
            let lines = transform.forward(&(0..circle).map(covariance).collect::<Vec<f64>>());
            let power = |line: &Complex64| (line.re.max(0.0) * circle as f64).sqrt();
            let powers = lines.iter().map(power).collect();
            (transform, powers)
        };
        DrawnNoise { recorder: recorder.clone(), coloured: (!recorder.is_white()).then(coloured) }
    }

    /// A record of these values in a unit, with noise, within the range and in the steps of the converter.
    pub fn record(&self, mut values: Vec<f64>, unit: Unit, noise: &mut Noise) -> Trace {
        let Recorder { rate, step, range, .. } = self.recorder;
        // The white part has the variance of rounding; the steps add it.
        let white = (self.recorder.white() - rounding(step).powi(2)).max(0.0).sqrt();
        for value in &mut values {
            *value += white * noise.normal();
        }
        if let Some((transform, powers)) = &self.coloured {
            let half = 0.5f64.sqrt();
            let last = powers.len() - 1;
            let line = |(k, power): (usize, &f64)| match k {
                0 => Complex64::new(power * noise.normal(), 0.0),
                k if k == last => Complex64::new(power * noise.normal(), 0.0),
                _ => half * power * Complex64::new(noise.normal(), noise.normal()),
            };
            let lines: Vec<Complex64> = powers.iter().enumerate().map(line).collect();
            values.iter_mut().zip(transform.inverse(&lines)).for_each(|(value, added)| *value += added);
        }
        for value in &mut values {
            if let Some(range) = range {
                *value = value.clamp(-range, range);
            }
            if step > 0.0 {
                *value = (*value / step).round() * step;
            }
        }
        let axis = Axis::time(0.0, 1.0 / rate, values.len());
        Trace { meta: Meta::new("drawn", unit), axis, values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pulse::LowPass;

    /// Noise behind a low-pass has its covariance: 400 records of 256 samples know it to some 2 %.
    #[test]
    fn drawn_noise_has_the_covariance_of_the_recorder() {
        let low_pass = Some(LowPass::new(100.0, 2).unwrap());
        let recorder = Recorder { rate: 1000.0, noise: 0.1, density: 0.05, low_pass, ..Recorder::default() };
        let drawn = DrawnNoise::of(&recorder, 256);
        let mut sums = [0.0; 4];
        let draws = 400;
        for seed in 0..draws {
            let unit = Unit::parse("m").unwrap();
            let values = drawn.record(vec![0.0; 256], unit, &mut Noise::new(seed)).values;
            for (apart, sum) in sums.iter_mut().enumerate() {
                let pairs = values.iter().zip(&values[apart..]);
                *sum += pairs.map(|(a, b)| a * b).sum::<f64>() / (256 - apart) as f64;
            }
        }
        for (apart, sum) in sums.into_iter().enumerate() {
            let error = sum / draws as f64 / recorder.covariance(0)
                - recorder.covariance(apart) / recorder.covariance(0);
            assert!(error.abs() < 0.05, "{apart}: {error}");
        }
    }
}
