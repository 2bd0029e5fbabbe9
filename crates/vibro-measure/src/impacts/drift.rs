//! Linear drift of the level, from the medians of pieces of the trace.

use super::background::{background, median};

/// Pieces of a trace.
const PIECES: usize = 24;
/// The noise between impacts must fall to this part of what it was.
const WORTH: f64 = 0.8;

/// Removes a straight line from `values` and gives its slope in units a sample, where that lowers the noise between impacts by a fifth.
///
/// The slope is the median of those between the medians of any two pieces (Theil 1950, Sen 1968): impacts that fill less than half of a piece do
/// not move it.
pub fn remove(values: &mut [f64]) -> Option<f64> {
    let length = values.len() / PIECES;
    if length < 8 {
        return None;
    }
    let levels: Vec<f64> = values.chunks_exact(length).map(median).collect();
    let slopes: Vec<f64> = (0..levels.len())
        .flat_map(|i| (i + 1..levels.len()).map(move |j| (i, j)))
        .map(|(i, j)| (levels[j] - levels[i]) / ((j - i) * length) as f64)
        .collect();
    let slope = median(&slopes);
    let middle = 0.5 * values.len() as f64;
    let level: Vec<f64> = values.iter().enumerate().map(|(i, v)| v - slope * (i as f64 - middle)).collect();
    if slope == 0.0 || background(&level).sigma >= WORTH * background(values).sigma {
        return None;
    }
    values.copy_from_slice(&level);
    Some(slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn a_straight_drift_goes_and_impacts_stay() {
        let mut noise = Noise::new(9);
        let clean: Vec<f64> =
            (0..4800).map(|i| 0.02 * noise.normal() + if i % 120 < 30 { 4.0 } else { 0.0 }).collect();
        let mut values: Vec<f64> = clean.iter().enumerate().map(|(i, v)| v + 5e-4 * i as f64).collect();
        let slope = remove(&mut values).unwrap();
        // Medians of 200 samples scatter by 1.25·0.02/√150 = 0.002, and impacts of a quarter of them push all up alike, by a third of σ and what
        // the ramp of 0.1 within a piece adds: all equal to 0.01. Over 4800 samples, 0.01/4800 = 2e-6.
        assert!((slope - 5e-4).abs() < 2e-6, "{slope}");
        assert_eq!(remove(&mut clean.clone()), None);
    }
}
