//! The order of the steps of a sweep, and steps at one frequency.

use crate::analysis::named_file::few;
use crate::analysis::source::file_name;
use crate::measure::response::Response;
use crate::record::{Direction, Finding, Sweep, sort_by_number};
use crate::units::notation::significant;
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Relative difference in frequency up to which two steps have the same setting of the generator: twice the
/// 50 ppm of a quartz.
const SAME_SETTING: f64 = 1e-4;

/// Whether two frequencies are one setting of the generator.
pub(crate) fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME_SETTING * a.abs().max(b.abs())
}

/// Least number of steps per reversal of direction for the order of the file names to be that of the sweep.
/// A random order reverses at two steps of three; a sweep that goes up and down several times has branches
/// of many steps.
const LEAST_STEPS_PER_REVERSAL: usize = 4;

/// The files by frequency in the direction of the sweep, where the order of their names reverses at more
/// than one step of four; else `None`.
pub(super) fn sorted(sweep: &Sweep, response: &Response, files: &[PathBuf]) -> Option<Vec<PathBuf>> {
    let frequency = |k: usize| response.points[k].excitation;
    let mut order: Vec<usize> = (0..response.points.len()).collect();
    let steps = order.windows(2).map(|w| (frequency(w[0]), frequency(w[1])));
    let rises: Vec<bool> = steps.filter(|(a, b)| !same(*a, *b)).map(|(a, b)| b > a).collect();
    let reversals = rises.windows(2).filter(|w| w[0] != w[1]).count();
    if reversals < 2 || LEAST_STEPS_PER_REVERSAL * reversals <= rises.len() {
        return None;
    }
    sort_by_number(&mut order, |a| frequency(*a));
    if sweep.direction == Some(Direction::Down) {
        order.reverse();
    }
    let mut sorted: Vec<PathBuf> = order.iter().map(|k| sweep.points[*k].response_path.clone()).collect();
    // Steps left out of the response have no frequency.
    let in_response: BTreeSet<&PathBuf> = sorted.iter().collect();
    let rest: Vec<PathBuf> = files.iter().filter(|file| !in_response.contains(file)).cloned().collect();
    sorted.extend(rest);
    Some(sorted)
}

/// Finding on steps at the frequency of the step before them.
pub(super) fn repeated(sweep: &Sweep, response: &Response) -> Option<Finding> {
    let at = |k: usize| response.points[k].excitation;
    let file = |k: usize| file_name(&sweep.points[k].response_path);
    let repeats = (1..response.points.len()).filter(|k| same(at(k - 1), at(*k)));
    let name = |k: usize| format!("{} as {} ({} Hz)", file(k), file(k - 1), significant(at(k), 5));
    let names: Vec<String> = repeats.map(name).collect();
    let n = names.len();
    let found = Finding::note("sweep-frequency-repeated").count("n", n);
    (n > 0).then(|| found.name("files", few(&names)))
}
