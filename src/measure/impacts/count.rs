//! Missed and doubled impacts: which place in a regular series each impact has.

use super::burst::median;

/// Which impacts count, and their indices in a series without missed ones.
pub struct Counted {
    /// Impacts that count, by their place among all.
    pub kept: Vec<usize>,
    /// Their indices; those of missed impacts are left out.
    pub index: Vec<usize>,
    /// Impacts that should stand in intervals that are a multiple of the others.
    pub missed: usize,
    /// Impacts that follow another within less than half an interval.
    pub doubled: usize,
}

/// Five times the robust spread of intervals is no chance.
const OUTSIDE: f64 = 5.0;

/// Numbers the impacts at `times`, which are `steps` apart.
pub fn count(times: &[f64], steps: &[f64]) -> Counted {
    let typical = median(steps);
    let spread = median(&steps.iter().map(|d| (d - typical).abs()).collect::<Vec<f64>>()) / 0.674_5;
    let short = |d: f64| d < 0.5 * typical && typical - d > OUTSIDE * spread;
    // As many short intervals as a fifth of all are a pattern, no accident.
    let pattern = steps.iter().filter(|d| short(**d)).count() * 5 > steps.len();
    let mut counted = Counted { kept: vec![0], index: vec![0], missed: 0, doubled: 0 };
    for i in 1..times.len() {
        let (last, at) =
            (counted.kept.last().copied().unwrap_or(0), counted.index.last().copied().unwrap_or(0));
        let d = times[i] - times[last];
        if !pattern && short(d) {
            counted.doubled += 1;
            continue;
        }
        let long = d > 1.5 * typical && d - typical > OUTSIDE * spread;
        let step = if long { (d / typical).round().clamp(1.0, 1e9) as usize } else { 1 };
        counted.missed += step - 1;
        counted.kept.push(i);
        counted.index.push(at + step);
    }
    counted
}
