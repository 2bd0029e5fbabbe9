//! Level and noise of a trace between its impacts.

/// Level and noise between impacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Background {
    /// Its level.
    pub level: f64,
    /// Standard deviation of its noise.
    pub sigma: f64,
    /// Noise limit: the distance from the level that noise alone reaches in fewer than one of a thousand such records.
    pub reach: f64,
}

/// Lower quartile of |N(0, 1)|.
const QUARTILE: f64 = 0.318_639_363_964_375;
/// Median of |N(0, 1)|.
const MEDIAN: f64 = 0.674_489_750_196_081_7;

/// Level and noise of the samples between impacts.
///
/// Starts from the median and the lower quartile of the distances from it, so that impacts may fill half of the record; then
/// leaves out the samples beyond the noise limit with their neighbours, and repeats.
pub fn background(values: &[f64]) -> Background {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    // P(|x| > zσ) < exp(−z²/2), for each of n samples.
    let z = (2.0 * (values.len().max(1) as f64 / 1e-3).ln()).sqrt();
    let of = |quiet: &[f64], part: f64, normal: f64| {
        let level = median(quiet);
        let sigma = quantile(quiet.iter().map(|v| (v - level).abs()).collect(), part) / normal;
        // A digital trace has σ = 0: the limit is at least a thousandth of the range.
        Background { level, sigma, reach: (z * sigma).max(1e-3 * (high - low)) }
    };
    let mut found = of(values, 0.25, QUARTILE);
    for _ in 0..4 {
        let out = |i: usize| (values[i] - found.level).abs() > found.reach;
        let beside = |i: usize| i.saturating_sub(1)..(i + 2).min(values.len());
        let quiet: Vec<f64> = (0..values.len()).filter(|i| !beside(*i).any(out)).map(|i| values[i]).collect();
        if quiet.len() < 8 {
            break;
        }
        found = of(&quiet, 0.5, MEDIAN);
    }
    found
}

/// Quantile `q` of values in any order; NaN of none.
fn quantile(mut values: Vec<f64>, q: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let place = q * (values.len() - 1) as f64;
    let (_, low, above) = values.select_nth_unstable_by(place.floor() as usize, f64::total_cmp);
    let low = *low;
    let next = above.iter().copied().fold(f64::INFINITY, f64::min);
    if place.fract() > 0.0 { low + place.fract() * (next - low) } else { low }
}

/// The median of values in any order; NaN of none.
pub fn median(values: &[f64]) -> f64 {
    quantile(values.to_vec(), 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn impacts_that_fill_two_fifths_of_a_record_do_not_move_its_background() {
        let mut noise = Noise::new(7);
        let values: Vec<f64> =
            (0..4000).map(|i| 3.0 + 0.1 * noise.normal() + if i % 10 < 4 { 5.0 } else { 0.0 }).collect();
        let found = background(&values);
        // 1200 quiet samples with quiet neighbours: the median scatters by 1.25·0.1/√1200 = 0.004, its deviation by 3 %.
        assert!((found.level - 3.0).abs() < 0.02, "{found:?}");
        assert!((found.sigma / 0.1 - 1.0).abs() < 0.15, "{found:?}");
    }

    #[test]
    fn quantiles_interpolate() {
        assert_eq!(quantile(vec![4.0, 1.0, 3.0, 2.0], 0.5), 2.5);
        assert_eq!(quantile(vec![4.0, 1.0, 3.0], 1.0), 4.0);
        assert!(quantile(Vec::new(), 0.5).is_nan());
    }
}
