//! The noise floor around a spectral line.

/// Median of a set of magnitudes over the standard deviation of each component: √(2 ln 2), since the magnitude of a
/// line that holds only noise is Rayleigh distributed.
const RAYLEIGH_MEDIAN: f64 = 1.177_410_022_515_474_7;

/// Lines on either side that are looked at.
const REACH: usize = 40;

/// Lines next to the peak that are left out: they belong to it.
const GUARD: usize = 4;

/// Standard deviation of the noise in one component (real or imaginary) of a line, from the median magnitude of the
/// lines around `centre`, not nearer than four lines to it and not below line 2.
///
/// The median is not moved by a few further peaks. `None` where fewer than eight lines are left.
pub fn around(magnitudes: &[f64], centre: usize) -> Option<f64> {
    let low = centre.saturating_sub(REACH).max(2);
    let high = centre.saturating_add(REACH + 1).min(magnitudes.len());
    let mut lines: Vec<f64> = (low..high)
        .filter(|k| k.abs_diff(centre) > GUARD)
        .map(|k| magnitudes[k])
        .filter(|m| m.is_finite())
        .collect();
    if lines.len() < 8 {
        return None;
    }
    let middle = lines.len() / 2;
    let (_, median, _) = lines.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median / RAYLEIGH_MEDIAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rayleigh_noise_is_recovered_beside_a_strong_peak() {
        // Quantiles of the Rayleigh distribution with σ = 2 as a sample without randomness, shuffled by a stride.
        let n = 81;
        let mut lines = vec![0.0; n];
        for i in 0..n {
            let p = (i as f64 + 0.5) / n as f64;
            lines[(i * 37) % n] = 2.0 * (-2.0 * (1.0 - p).ln()).sqrt();
        }
        for line in &mut lines[38..=42] {
            *line = 1e3;
        }
        let sigma = around(&lines, 40).unwrap();
        // The median of 70 draws scatters by about 7 %; the stride leaves it within twice that.
        assert!((sigma / 2.0 - 1.0).abs() < 0.15, "{sigma}");
    }

    #[test]
    fn too_few_lines_give_no_floor() {
        assert_eq!(around(&[1.0; 12], 6), None);
    }
}
