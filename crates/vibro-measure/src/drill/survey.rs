//! Statistics of a channel: extremes, levels, noise.

use crate::converter::step;
use vibro_record::{Error, Result, median};

/// Most groups of samples whose extremes are sorted for the threshold. Extremes keep the levels of pulses
/// shorter than a group.
const GROUPS: usize = 1 << 14;
/// Median of |x| of a normal distribution of unit variance.
const NORMAL_MEDIAN: f64 = 0.674_489_750_196_081_7;

/// Extremes and resolution of a channel.
#[derive(Debug, Clone, Copy)]
pub(super) struct ChannelStatistics {
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
    /// Median.
    pub median: f64,
    /// Smallest step between neighbours that is not 0: the resolution, where the channel was digitised
    /// coarsely.
    pub quantum: f64,
    /// Fewest equal samples in a row that are a drop-out: chance gives them in one of a thousand such
    /// channels. 4 to 64.
    pub longest_by_chance: usize,
}

impl ChannelStatistics {
    /// Statistics of all values; missing ones are NaN.
    pub fn of(values: &[f64]) -> ChannelStatistics {
        let (low, high) = range(values);
        let steps = || values.windows(2).map(|w| (w[1] - w[0]).abs());
        let n = values.len().max(1) as f64;
        let equal = steps().filter(|d| *d == 0.0).count() as f64;
        // One more equal pair than was found: none among a few thousand does not prove a probability of 0.
        let p = ((equal + 1.0) / (n + 1.0)).min(0.999);
        let needed = ((1e-3 / n).ln() / p.ln()).ceil() + 1.0;
        ChannelStatistics {
            low,
            high,
            median: median(values),
            quantum: step(values),
            longest_by_chance: (needed as usize).clamp(4, 64),
        }
    }
}

/// Standard deviation of white noise on a smooth signal. Second differences scatter √6 as much as the noise;
/// the few places where the signal is not smooth do not move their median.
pub(super) fn noise(values: &[f64]) -> f64 {
    median(values.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs())) / (NORMAL_MEDIAN * 6f64.sqrt())
}

/// The two levels of a pulsed signal: medians of the values on both sides of the threshold that Otsu's method
/// finds between its local extremes (N. Otsu, IEEE Trans. Syst. Man Cybern. 9 (1979) 62). `None` where there
/// is only one level.
pub(crate) fn levels(values: &[f64]) -> Option<(f64, f64)> {
    let groups = values.chunks(values.len().div_ceil(GROUPS).max(1)).map(range);
    let mut all: Vec<f64> = groups.flat_map(|(low, high)| [low, high]).filter(|v| v.is_finite()).collect();
    all.sort_by(f64::total_cmp);
    let total: f64 = all.iter().sum();
    let (mut below, mut best) = (0.0, (0.0, None));
    for (i, pair) in all.windows(2).enumerate() {
        below += pair[0];
        let (count, others) = ((i + 1) as f64, (all.len() - i - 1) as f64);
        let (low, high) = (below / count, (total - below) / others);
        let between = count * others * (high - low) * (high - low);
        if pair[1] > pair[0] && between > best.0 {
            best = (between, Some(0.5 * (low + high)));
        }
    }
    let threshold = best.1?;
    let side = |above: bool| median(values.iter().filter(|v| (**v > threshold) == above));
    Some((side(false), side(true)))
}

/// A value is on a level if it is within this fraction of the distance of both levels.
const AT_LEVEL: f64 = 0.1;

/// A pulse is on one of its two levels for more than this fraction of the time; a sine is within
/// [`AT_LEVEL`] of the medians of its halves for a quarter.
const PULSED: f64 = 0.8;
/// Largest median change from one turn of a shaft to the next, over a turn. Edges of a vibration are
/// unevenly spaced.
const UNEVEN: f64 = 0.2;

/// Refuses a reference that is not a pulse signal: the velocity in its place, or a vibration. The
/// `reference` comes with its two levels; `edges` are its edges in samples.
///
/// # Errors
/// If the reference does not rest on two levels, while the velocity does or the edges are uneven.
pub(crate) fn check_pulses(
    velocity: &[f64],
    (reference, stands): (&[f64], (f64, f64)),
    edges: &[f64],
) -> Result<()> {
    let pulsed = |values: &[f64], (low, high): (f64, f64)| {
        let near =
            values.iter().filter(|v| (**v - low).abs().min((**v - high).abs()) < AT_LEVEL * (high - low));
        near.count() as f64 > PULSED * values.len() as f64
    };
    if pulsed(reference, stands) {
        return Ok(());
    }
    let refused = |why: &str, hint| Err(Error::refused(why).hint(hint).setting("reference"));
    if pulsed(velocity, levels(velocity).unwrap_or_default()) {
        let why = "the velocity stands on two levels as a pulse does, the reference does not";
        return refused(why, "are the two channels swapped?").map_err(|error| error.setting("velocity"));
    }
    let steps: Vec<f64> = edges.windows(2).map(|w| w[1] - w[0]).collect();
    let change = median(steps.windows(2).map(|w| (w[1] - w[0]).abs()));
    if change > UNEVEN * median(&steps) {
        let why = "the reference is no pulse of a shaft: its edges come at uneven distances";
        return refused(why, "name the channel of the pulse; `vibro info` lists the channels");
    }
    Ok(())
}

/// Lowest and highest value.
fn range(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().filter(|v| v.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn narrow_pulses_have_two_levels_however_long_the_record() {
        for turns in [400, 4000] {
            let mut values = Vec::new();
            for _ in 0..turns {
                // A pulse of 3 samples in 500: 0.6 % of the time; a glitch of ten times its height in the
                // record.
                let mut turn = vec![0.25; 500];
                turn[100..103].fill(4.75);
                values.extend(turn);
            }
            values.extend([0.25, 40.0, f64::NAN]);
            assert_eq!(levels(&values), Some((0.25, 4.75)), "{turns}");
            let survey = ChannelStatistics::of(&values);
            assert_eq!((survey.low, survey.high), (0.25, 40.0));
        }
        assert_eq!(levels(&[1.0; 100]), None);
    }

    #[test]
    fn noise_and_resolution_of_a_digitised_sine() {
        let mut draw = Noise::new(1);
        let block: Vec<f64> = (0..300_000)
            .map(|i| {
                let v = (f64::from(i) * 0.003).sin() + 0.05 * draw.normal();
                (v / 0.001).round() * 0.001
            })
            .collect();
        let survey = ChannelStatistics::of(&block);
        // A median of 8000 absolute values or more scatters by 1.17/√8000 = 1.3 %; four times that.
        assert!((noise(&block) / 0.05 - 1.0).abs() < 0.052, "{}", noise(&block));
        assert!((survey.quantum - 0.001).abs() < 1e-9);
        assert!((4..12).contains(&survey.longest_by_chance));
    }
}
