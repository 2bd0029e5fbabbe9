//! Whether a line of a spectrum stands out of the noise, at a stated rate of false alarms.
//!
//! The power of a line of noise, averaged over n independent segments, is χ² of 2n degrees of freedom. The
//! mean of the noise at a line is that of the lines around: their median over the ratio of median to mean, (1
//! − 1/9n)³ (E. B. Wilson & M. M. Hilferty, PNAS 17 (1931) 684). The ratio of line and mean is F distributed;
//! for one segment this is the detector of H. M. Finn & R. S. Johnson, RCA Review 29 (1968) 414. Of all lines
//! that are searched, noise alone shows one with a probability of [`FALSE_ALARMS`] at most.

use vibro_record::{Window, upper_median};

/// Largest probability that noise shows a line anywhere in a record.
pub const FALSE_ALARMS: f64 = 1e-3;
/// Lines on either side that estimate the noise at a line where lines are searched.
pub(crate) const REACH: usize = 100;
/// Lines on either side of a peak that belong to it, and not to its noise.
const GUARD: usize = 4;
/// The median of this many lines estimates the mean as well as one independent line does: (1/ln 2)² = 2.08
/// for exponential powers, times the sum of squared correlations of lines, at most 1.3 times the noise
/// bandwidth of the window (1.94 under Hann's).
const MEDIAN: f64 = 2.7;

/// The noise at a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Floor {
    /// Mean power of a line of noise.
    pub power: f64,
    /// Number of independent lines of one spectrum that would estimate the mean as well.
    pub lines: usize,
}

/// Noise at line `k` from the powers of lines up to `reach` away, each an average of `averages` spectra.
/// Lines above are raised as if noise fell as 1/f, and as many below lowered by the same factor. White noise
/// then keeps its median, and 1/f noise is not underestimated towards 0 Hz. `None` where fewer than eight
/// lines are left.
pub(crate) fn floor(
    powers: &[f64],
    k: usize,
    reach: usize,
    averages: f64,
    window: Option<Window>,
) -> Option<Floor> {
    let around = k.saturating_sub(reach).max(2)..k.saturating_add(reach + 1).min(powers.len());
    let mut known: Vec<f64> = around
        .filter(|j| j.abs_diff(k) > GUARD && powers[*j].is_finite())
        .map(|j| {
            let (mirror, rise) = (k + k.abs_diff(j), 1.0 + k.abs_diff(j) as f64 / k.max(1) as f64);
            powers[j]
                * if j > k {
                    rise
                } else if mirror < powers.len() {
                    1.0 / rise
                } else {
                    1.0
                }
        })
        .collect();
    if known.len() < 8 {
        return None;
    }
    let lines = (averages * known.len() as f64 / (MEDIAN * window.map_or(2.0, Window::enbw))) as usize;
    Some(Floor {
        power: upper_median(&mut known) / (1.0 - 1.0 / (9.0 * averages)).powi(3),
        lines: lines.max(1),
    })
}

impl Floor {
    /// Whether a line of this power, averaged over `averages` spectra, exceeds the noise; [`FALSE_ALARMS`]
    /// is for all `searched` lines together.
    pub fn is_below(&self, power: f64, averages: f64, searched: usize) -> bool {
        above(power / self.power, averages, self.lines) * searched as f64 <= FALSE_ALARMS
    }
}

/// Most independent segments, and most lines that estimate the noise, that count: by then the threshold is
/// within 1 dB of the noise.
const MOST: [f64; 2] = [500.0, 1000.0];

/// P(F > `ratio`) of 2`n` and 2`m` degrees of freedom: an incomplete beta function, for whole m a finite sum
/// (Abramowitz & Stegun 26.6.5).
fn above(ratio: f64, n: f64, m: usize) -> f64 {
    if ratio <= 1.0 {
        return 1.0;
    }
    let (n, m) = (n.min(MOST[0]), m.min(MOST[1] as usize));
    let x = m as f64 / (m as f64 + n * ratio);
    let (mut term, mut sum) = (1.0, 1.0);
    for j in 1..m {
        term *= (n + j as f64 - 1.0) / j as f64 * x;
        sum += term;
    }
    // For one segment x^m, without rounding.
    if n == 1.0 { x.powi(m as i32) } else { (1.0 - (n * (-x).ln_1p()).exp() * sum).max(0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectral::{SpectralOptions, spectral};
    use crate::synthetic::{pink, trace};
    use crate::tones::tones;
    use rayon::prelude::*;
    use std::f64::consts::TAU;
    use std::ops::Range;
    use vibro_math::Noise;
    use vibro_record::{Scaling, Traces};

    #[test]
    fn probabilities_are_those_of_tables() {
        // Abramowitz & Stegun, table 26.9: F of 2 and 10 degrees, of 8 and 20.
        assert!((above(7.56, 1.0, 5) - 0.01).abs() < 1e-5, "{}", above(7.56, 1.0, 5));
        assert!((above(3.56, 4.0, 10) - 0.01).abs() < 1e-4, "{}", above(3.56, 4.0, 10));
        // The sum for one segment is x^m, to its rounding.
        assert!((above(30.0, 1.0 + 1e-12, 40) / above(30.0, 1.0, 40) - 1.0).abs() < 1e-5);
    }

    /// Number of records of noise that show a tone, and of those that show a peak of averages; `colour` is
    /// the share of 1/f noise.
    fn false_alarms(records: Range<u64>, colour: f64) -> [u32; 2] {
        let of = |seed: u64| {
            let mut noise = Noise::new(seed);
            let slow = pink(&mut noise, 2000);
            let values = slow.into_iter().map(|v| colour * v + (1.0 - colour) * noise.normal()).collect();
            let trace = trace(values);
            let options =
                SpectralOptions { segment: Some(256), scaling: Some(Scaling::Psd), ..Default::default() };
            let tone = u32::from(tones(&trace, 3).is_ok());
            let found = spectral(&mut Traces::from_memory(vec![trace]).unwrap(), &options, |_| ()).unwrap();
            [tone, u32::from(!found.peaks(8).is_empty())]
        };
        records.into_par_iter().map(of).reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
    }

    #[test]
    fn noise_shows_no_line() {
        for colour in [0.0, 0.5, 1.0] {
            // Of 100 records at 0.1 %: three or more in one of 6000 runs.
            assert!(false_alarms(0..100, colour).iter().all(|seen| *seen < 3), "{colour}");
        }
    }

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn noise_shows_lines_no_more_often_than_stated() {
        let of = |(records, colour)| {
            let seen = false_alarms(records, colour);
            println!("{colour}: {seen:?}");
            seen
        };
        let of_each = [(0..1300, 0.0), (1300..2600, 0.5), (2600..4000, 1.0)].map(of);
        // Expected are 4 of 4000 records at 0.1 %; 8 more are four standard deviations of √4.
        assert!((0..2).all(|way| of_each.iter().map(|seen| seen[way]).sum::<u32>() <= 12), "{of_each:?}");
    }

    /// The tone has twice the power of a line at the threshold.
    #[test]
    fn a_tone_3_db_above_the_threshold_is_found() {
        let known = (2.0 * REACH as f64 - 8.0) / (MEDIAN * Window::Hann.enbw());
        let ratio = vibro_math::border(1.0, 1e3, |r| above(r, 1.0, known as usize) * 999.0 > FALSE_ALARMS);
        // Power of a line of noise of standard deviation 1 is 4 · 1.5/n as A²; between lines Hann takes up to
        // 1.4 dB.
        let amplitude = (2.0 * ratio * 6.0 / 2000.0).sqrt();
        let mut found = 0;
        for seed in 0..200 {
            let mut noise = Noise::new(seed);
            let (f, p) = (noise.between(100.0, 400.0).round() / 2.0, noise.between(0.0, TAU));
            let value = |i: u32| amplitude * (TAU * f * f64::from(i) * 1e-3 + p).cos();
            let values = (0..2000).map(|i| value(i) + noise.normal()).collect();
            let tones = tones(&trace(values), 1).map_or(Vec::new(), |t| t.tones);
            found += u32::from(tones.iter().any(|t| (t.frequency.value - f).abs() < 0.5));
        }
        // √2 − 1 = 0.41 of a height of √2 · 4.3 standard deviations above the threshold: 96 %, less four
        // times 1.4 %.
        assert!(found >= 180, "{found} of 200");
    }
}
