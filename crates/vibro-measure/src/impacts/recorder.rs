//! What a recorder does to a trace: values repeated from a slower sampling, and clipping.

use std::collections::HashSet;
use std::ops::Range;

/// Words of a trace that show a sample-and-hold. The trace has as many changes at least, which all stand at multiples of two samples
/// by chance in one of 65 000 traces.
const WORDS: usize = 16;

/// Samples for which each value is repeated: the largest number of which all distances between changes of the value are multiples.
///
/// A train that is locked to the sampling clock has such a number, too, as it has few distances. A sample-and-hold shows in words of
/// four values of that length in which none returns after the next: flat pulses return to their level, and a train of stairs repeats
/// its words. A trace of two values counts as not repeated.
pub(crate) fn sample_and_hold(values: &[f64]) -> usize {
    let (mut common, mut changes) = (0, Vec::new());
    for i in (1..values.len()).filter(|i| values[*i] != values[i - 1]) {
        let (mut a, mut b) = (common, i - changes.last().unwrap_or(&i));
        while b > 0 {
            (a, b) = (b, a % b);
        }
        common = a;
        if common == 1 {
            return 1;
        }
        changes.push(i);
    }
    let goes_on = |w: &&[usize]| {
        w.windows(2).all(|w| w[1] - w[0] == common)
            && values[w[0]] != values[w[2]]
            && values[w[1]] != values[w[3]]
    };
    let word = |w: &[usize]| [0, 1, 2, 3].map(|k| values[w[k]].to_bits());
    let words: HashSet<[u64; 4]> = changes.windows(4).filter(goes_on).map(word).collect();
    if words.len() < WORDS { 1 } else { common }
}

/// Bursts with three samples in a row at the largest or smallest value of the trace.
pub fn clipped(values: &[f64], bursts: &[Range<usize>]) -> usize {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let flat = |w: &[f64]| [low, high].iter().any(|rail| w.iter().all(|v| v == rail));
    bursts.iter().filter(|b| values[(*b).clone()].windows(3).any(flat)).count()
}
