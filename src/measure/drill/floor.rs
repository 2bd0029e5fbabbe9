//! Motion against the noise of the instrument: averaged spectra of both, in dB.

use crate::units::decibel;
use realfft::{RealFftPlanner, RealToComplex};
use std::sync::Arc;

/// Samples of a segment.
const SEGMENT: usize = 8192;

/// Averaged power spectrum of a signal that comes in blocks: Hann window, half overlap (P. Welch, IEEE Trans. Audio
/// Electroacoust. 15 (1967) 70).
pub struct Spectrum {
    plan: Arc<dyn RealToComplex<f64>>,
    window: Vec<f64>,
    waiting: Vec<f64>,
    power: Vec<f64>,
    segments: usize,
}

/// Motion and noise over frequency.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct NoiseFloor {
    /// Frequency in Hz.
    pub frequency: Vec<f64>,
    /// Level of the motion in dB: RMS of a line against 1 m/s.
    pub motion: Vec<f64>,
    /// Level of the record without motion.
    pub noise: Vec<f64>,
    /// Margin in dB that the motion must have.
    pub margin: f64,
    /// Bands in Hz, lowest and highest, in which it has that margin.
    pub bands: Vec<[f64; 2]>,
    /// Equivalent noise bandwidth of a line, in Hz.
    pub line_width: f64,
}

impl Default for Spectrum {
    fn default() -> Spectrum {
        let plan = RealFftPlanner::new().plan_fft_forward(SEGMENT);
        let turn = |k: usize| (std::f64::consts::TAU * k as f64 / SEGMENT as f64).cos();
        let window = (0..SEGMENT).map(|k| 0.5 - 0.5 * turn(k)).collect();
        Spectrum { plan, window, waiting: Vec::new(), power: vec![0.0; SEGMENT / 2 + 1], segments: 0 }
    }
}

impl Spectrum {
    /// Takes the next samples.
    pub fn push(&mut self, block: &[f64]) {
        self.waiting.extend(block);
        let mut at = 0;
        let (mut input, mut output) = (self.plan.make_input_vec(), self.plan.make_output_vec());
        let mut scratch = self.plan.make_scratch_vec();
        while let Some(part) = self.waiting.get(at..at + SEGMENT) {
            let mean = part.iter().sum::<f64>() / SEGMENT as f64;
            input.iter_mut().zip(part.iter().zip(&self.window)).for_each(|(i, (v, w))| *i = (v - mean) * w);
            // Lengths are those of the plan; a transform that fails anyway leaves its segment out.
            if self.plan.process_with_scratch(&mut input, &mut output, &mut scratch).is_ok() {
                self.power.iter_mut().zip(&output).for_each(|(p, o)| *p += o.norm_sqr());
                self.segments += 1;
            }
            at += SEGMENT / 2;
        }
        self.waiting.drain(..at);
    }

    /// RMS value of each line, from the line after 0 Hz on; `None` if the signal was shorter than a segment.
    fn lines(&self) -> Option<Vec<f64>> {
        // A sine of amplitude A has a line of A/2 times the sum of the window, n/2.
        let scale = 8f64.sqrt() / SEGMENT as f64 / (self.segments.max(1) as f64).sqrt();
        (self.segments > 0).then(|| self.power.iter().skip(1).map(|p| scale * p.sqrt()).collect())
    }
}

/// Lines over which levels are averaged to tell the bands, on both sides.
const SMOOTH: usize = 8;

impl NoiseFloor {
    /// Motion against noise at `rate` samples a second. `None` if one of them is shorter than a segment.
    pub fn new(motion: &Spectrum, noise: &Spectrum, rate: f64, margin: f64) -> Option<NoiseFloor> {
        let (motion, noise) = (motion.lines()?, noise.lines()?);
        let step = rate / SEGMENT as f64;
        let frequency: Vec<f64> = (1..=motion.len()).map(|k| k as f64 * step).collect();
        // Single lines scatter, and between the harmonics of the speed there is no motion: means over some lines decide.
        let mean = |lines: &[f64], k: usize| {
            let part = &lines[k.saturating_sub(SMOOTH)..(k + SMOOTH + 1).min(lines.len())];
            (part.iter().map(|v| v * v).sum::<f64>() / part.len() as f64).sqrt()
        };
        let above: Vec<bool> =
            (0..motion.len()).map(|k| decibel(mean(&motion, k), mean(&noise, k)) >= margin).collect();
        let mut bands: Vec<[f64; 2]> = Vec::new();
        for (k, f) in frequency.iter().enumerate().filter(|(k, _)| above[*k]) {
            match bands.last_mut().filter(|_| k > 0 && above[k - 1]) {
                Some(band) => band[1] = *f,
                None => bands.push([*f, *f]),
            }
        }
        bands.retain(|b| b[1] - b[0] >= SMOOTH as f64 * step);
        let level =
            |lines: Vec<f64>| lines.into_iter().map(|v| decibel(v.max(f64::MIN_POSITIVE), 1.0)).collect();
        Some(NoiseFloor {
            frequency,
            motion: level(motion),
            noise: level(noise),
            margin,
            bands,
            line_width: 1.5 * step,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_has_its_rms_and_noise_its_density() {
        let rate = 8192.0;
        let mut state = 5u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let noise: Vec<f64> = (0..200_000).map(|_| 0.01 * uniform()).collect();
        let motion: Vec<f64> = noise
            .iter()
            .enumerate()
            .map(|(i, n)| n + 2.0 * (std::f64::consts::TAU * 500.0 * i as f64 / rate).sin())
            .collect();
        let spectrum = |v: &[f64], block| {
            let mut s = Spectrum::default();
            v.chunks(block).for_each(|b| s.push(b));
            s
        };
        let floor = NoiseFloor::new(&spectrum(&motion, 1000), &spectrum(&noise, 70_000), rate, 10.0).unwrap();
        assert_eq!(floor.frequency[499], 500.0);
        // 2/√2 m/s, noise adds nothing that is seen: 40 dB and more below.
        assert!((floor.motion[499] - 20.0 * 2f64.sqrt().log10()).abs() < 0.01);
        // Power of uniform noise, 1e-4/12, over 4096 lines, a line 1.5 wide; 46 segments scatter by 0.7 dB a line, the
        // mean of 3000 lines by 0.02 dB.
        let mean = floor.noise[1000..4000].iter().map(|l| 10f64.powf(l / 10.0)).sum::<f64>() / 3000.0;
        assert!((10.0 * (mean / (1e-4 / 12.0 / 4096.0 * 1.5)).log10()).abs() < 0.1);
        assert_eq!(floor.bands.len(), 1);
        assert!(floor.bands[0][0] >= 490.0 && floor.bands[0][1] <= 510.0, "{:?}", floor.bands);
        assert!(
            NoiseFloor::new(&spectrum(&motion[..100], 100), &spectrum(&noise, 100), rate, 10.0).is_none()
        );
    }
}
