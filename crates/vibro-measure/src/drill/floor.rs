//! Motion against the noise of the instrument: averaged spectra of both, in dB.

use vibro_record::units::{Unit, decibel};
use vibro_record::{Axis, Meta, Scaling, Trace, Traces, Window};
use vibro_signal::segment::Segments;
use vibro_signal::spectrum;
use vibro_signal::welch::Welch;

/// Samples of a segment: lines 12.5 Hz apart at 102.4 kHz.
const SEGMENT: usize = 8192;
/// Lines on each side over which levels are averaged to find the bands; also the least width of a band.
const SMOOTH: usize = 8;

/// Motion and noise over frequency.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct NoiseFloor {
    /// Frequency in Hz.
    pub frequency: Vec<f64>,
    /// Level of the motion in dB: RMS of a line against 1 m/s.
    pub motion: Vec<f64>,
    /// Level of the record without motion, in dB: RMS of a line against 1 m/s.
    pub noise: Vec<f64>,
    /// Margin in dB that the motion must have.
    pub margin: f64,
    /// Bands in Hz, lowest and highest, in which it has that margin.
    pub bands: Vec<[f64; 2]>,
    /// Equivalent noise bandwidth of a line, in Hz.
    pub line_width: f64,
}

/// RMS value of each line, from the line after 0 Hz on, and their equivalent noise bandwidth in lines: Hann
/// window, half overlap. Missing samples are left out. `None` if the signal is shorter than a segment or
/// constant.
fn lines(mut values: Vec<f64>, rate: f64) -> Option<(Vec<f64>, f64)> {
    values.retain(|v| v.is_finite());
    let meta = Meta::new("velocity", Unit::parse_or_opaque("m/s"));
    let axis = Axis::time(0.0, 1.0 / rate, values.len());
    let mut traces = Traces::from_memory(vec![Trace { meta: meta.clone(), axis, values }]).ok()?;
    let segments = Segments { length: SEGMENT, hop: SEGMENT / 2 };
    let welch = Welch { segments, window: Window::Hann, detrend: true };
    let averages = welch.average(&mut traces, false, |_| ()).ok()?;
    let found = spectrum::averaged(&averages, 0, &meta, Window::Hann, Scaling::Rms).ok()?;
    Some((found.values.magnitudes().split_off(1), found.enbw?))
}

impl NoiseFloor {
    /// Motion against noise at `rate` samples a second. `None` if one of them is shorter than a segment.
    pub(super) fn new(motion: Vec<f64>, noise: Vec<f64>, rate: f64, margin: f64) -> Option<NoiseFloor> {
        let ((motion, width), (noise, _)) = (lines(motion, rate)?, lines(noise, rate)?);
        let step = rate / SEGMENT as f64;
        // Single lines scatter, and between the harmonics of the rotation there is no motion. Therefore
        // means over 17 lines are compared.
        let mean = |lines: &[f64], k: usize| {
            let part = &lines[k.saturating_sub(SMOOTH)..(k + SMOOTH + 1).min(lines.len())];
            (part.iter().map(|v| v * v).sum::<f64>() / part.len() as f64).sqrt()
        };
        let above = |k: usize| decibel(mean(&motion, k), mean(&noise, k)) >= margin;
        let lines: Vec<(f64, bool)> = (0..motion.len()).map(|k| ((k + 1) as f64 * step, above(k))).collect();
        let bands = lines.chunk_by(|a, b| a.1 == b.1).filter(|band| band[0].1);
        let bands = bands.map(|band| [band[0].0, band[band.len() - 1].0]);
        let level = |v: &f64| decibel(v.max(f64::MIN_POSITIVE), 1.0);
        Some(NoiseFloor {
            bands: bands.filter(|b| b[1] - b[0] >= SMOOTH as f64 * step).collect(),
            frequency: lines.iter().map(|line| line.0).collect(),
            motion: motion.iter().map(level).collect(),
            noise: noise.iter().map(level).collect(),
            margin,
            line_width: width * step,
        })
    }
}
#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn a_sine_has_its_rms_and_noise_its_density() {
        let rate = 8192.0;
        let mut noise = Noise::new(5);
        let mut uniform = || noise.uniform() - 0.5;
        let noise: Vec<f64> = (0..200_000).map(|_| 0.01 * uniform()).collect();
        let motion: Vec<f64> = noise
            .iter()
            .enumerate()
            .map(|(i, n)| n + 2.0 * (std::f64::consts::TAU * 500.0 * i as f64 / rate).sin())
            .collect();
        let short = motion[..100].to_vec();
        assert!(NoiseFloor::new(short, noise.clone(), rate, 10.0).is_none());
        let floor = NoiseFloor::new(motion, noise, rate, 10.0).unwrap();
        assert_eq!(floor.frequency[499], 500.0);
        // 2/√2 m/s; noise, 40 dB and more below, adds nothing visible.
        assert!((floor.motion[499] - 20.0 * 2f64.sqrt().log10()).abs() < 0.01);
        // Uniform noise has the power 1e-4/12, spread over 4096 lines; a line is 1.5 lines wide (Hann). With
        // 46 segments a line scatters by 0.7 dB, the mean of 3000 lines by 0.02 dB.
        let mean = floor.noise[1000..4000].iter().map(|l| 10f64.powf(l / 10.0)).sum::<f64>() / 3000.0;
        assert!((10.0 * (mean / (1e-4 / 12.0 / 4096.0 * 1.5)).log10()).abs() < 0.1);
        assert_eq!(floor.bands.len(), 1);
        assert!(floor.bands[0][0] >= 490.0 && floor.bands[0][1] <= 510.0, "{:?}", floor.bands);
    }
}
