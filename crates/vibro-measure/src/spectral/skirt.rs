//! The skirt of a sine: its leakage beyond the main lobe of the window. Noise on a skirt makes local maxima
//! that are no sines of their own.

use crate::line::interpolate;
use vibro_record::{Window, sort_by_number};
use vibro_signal::window::line_shape;

/// Number of the largest peaks whose skirts are counted. Each further peak is checked against all of them,
/// and a spectrum without noise has thousands of peaks.
const SKIRTS: usize = 32;

/// The `peaks` that rise above the skirts of larger ones, in order of frequency. `stands_out` says whether a
/// power at a line exceeds the noise; it is called with the power of a peak less those skirts.
pub(super) fn above_skirts(
    mut peaks: Vec<usize>,
    powers: &[f64],
    window: Window,
    stands_out: impl Fn(usize, f64) -> bool,
) -> Vec<usize> {
    sort_by_number(&mut peaks, |a| -powers[*a]);
    let mut sines = Vec::new();
    peaks.retain(|k| {
        let skirts = sines
            .iter()
            .map(|(position, amplitude)| amplitude * line_shape(window, *k as f64 - position).abs());
        let left = powers[*k].sqrt() - skirts.sum::<f64>();
        let is_own = left > 0.0 && stands_out(*k, left * left);
        if is_own && sines.len() < SKIRTS {
            let near = k.saturating_sub(1)..(k + 2).min(powers.len());
            let near: Vec<f64> = powers[near].iter().map(|power| power.sqrt()).collect();
            let sine = interpolate(&near, 1, Some(window), None);
            sines.extend(sine.map(|sine| (*k as f64 - 1.0 + sine.position, sine.amplitude)));
        }
        is_own
    });
    peaks.sort_unstable();
    peaks
}
