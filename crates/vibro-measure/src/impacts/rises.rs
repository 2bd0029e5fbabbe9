//! Sudden rises of a sound, as impacts cause: candidates for impacts among echoes, ringing and other sounds.

use std::collections::VecDeque;
use std::ops::Range;

/// Least factor by which a level grows from one span to the next in a sudden rise.
const RISE: f64 = 3.0;
/// Least height of a sound over the noise limit: ringing that falls through the limit rises above it again by
/// chance.
const CLEAR: f64 = 1.5;
/// Duration in s of a sudden rise: longer than the contact of metals and hard plastics (below 1 ms), than
/// half a swing of a plate of 170 Hz or more, and than the loudest part of their sound.
const SPAN: f64 = 3e-3;

/// Stretches of one span, each from where a sound has risen to half of its largest value. That value exceeds
/// the noise limit `reach` by the factor [`CLEAR`]. It also exceeds the largest value of the span before by
/// the factor [`RISE`], unless that is below the noise limit.
pub fn rises(values: &[f64], reach: f64, rate: f64) -> Vec<Range<usize>> {
    let span = ((SPAN * rate) as usize).max(2);
    let ahead = largest_ahead(values, span);
    let mut found: Vec<Range<usize>> = Vec::new();
    let mut i = 0;
    while i < values.len() {
        // A record that begins loud begins within a sound, not with an impact: a quarter of a span counts as
        // before.
        let known = i.max(span / 4).min(values.len());
        let before = if i < span { largest(&values[..known]) } else { ahead[i - span] };
        // A level before that is below the noise limit is noise: the rise above it is not tested.
        if ahead[i] <= CLEAR * reach || before > reach && ahead[i] <= RISE * before {
            i += 1;
            continue;
        }
        let half = (i..values.len()).find(|k| values[*k].abs() >= 0.5 * ahead[i]).unwrap_or(i);
        found.push(half..(half + span).min(values.len()));
        i = half + span;
    }
    found
}

/// Largest absolute value.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |h: f64, v| h.max(v.abs()))
}

/// Largest absolute value of the span that begins at each sample.
fn largest_ahead(values: &[f64], span: usize) -> Vec<f64> {
    let mut all = vec![0.0; values.len()];
    // Indices of the values that exceed all values between sample `i` and them, the largest first.
    let mut kept: VecDeque<usize> = VecDeque::new();
    for i in (0..values.len()).rev() {
        while kept.back().is_some_and(|k| values[*k].abs() <= values[i].abs()) {
            kept.pop_back();
        }
        kept.push_back(i);
        while kept.front().is_some_and(|k| *k >= i + span) {
            kept.pop_front();
        }
        all[i] = kept.front().map_or(0.0, |k| values[*k].abs());
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn a_record_that_begins_in_a_sound_does_not_begin_with_an_impact() {
        // Ringing at 2 kHz that fades within 10 ms, and an impact after 50 ms that rings in the same way;
        // sampled at 20 kHz.
        let ring =
            |t: f64| if t < 0.0 { 0.0 } else { (-t / 2e-3).exp() * (4e3 * std::f64::consts::PI * t).sin() };
        let values: Vec<f64> =
            (0..2000).map(|i| f64::from(i) / 2e4).map(|t| ring(t + 0.1e-3) + ring(t - 0.05)).collect();
        let starts: Vec<usize> = rises(&values, 0.01, 2e4).iter().map(|r| r.start).collect();
        assert!(starts.len() == 1 && (1000..1010).contains(&starts[0]), "{starts:?}");
    }

    #[test]
    fn the_largest_value_ahead_is_that_of_a_plain_search() {
        let mut noise = Noise::new(3);
        let values: Vec<f64> = (0..500).map(|_| noise.normal()).collect();
        for span in [1, 2, 7, 600] {
            let plain = |i: usize| largest(&values[i..(i + span).min(500)]);
            assert_eq!(largest_ahead(&values, span), (0..500).map(plain).collect::<Vec<f64>>());
        }
    }
}
