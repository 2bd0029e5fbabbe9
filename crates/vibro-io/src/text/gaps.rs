//! Rows without a first value, where the first column is an abscissa.

use vibro_record::{Axis, AxisKind, Finding, Values};

/// Fills gaps in a rising first column: by what lies between its neighbours where that makes it even, as lost samples do;
/// else the rows are left out, as a blank line between two blocks is no sample. Gives a finding where it did.
pub fn bridge(columns: &mut [Values]) -> Option<Finding> {
    let [Values::Real(first), rest @ ..] = columns else { return None };
    let known: Vec<usize> = (0..first.len()).filter(|i| !first[*i].is_nan()).collect();
    let rises = known.len() > 2 && known.windows(2).all(|w| first[w[1]] > first[w[0]]);
    let ends = (known.first(), known.last()) == (Some(&0), Some(&first.len().saturating_sub(1)));
    if rest.is_empty() || !rises || !ends || known.len() == first.len() {
        return None;
    }
    let mut filled = first.clone();
    for pair in known.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let step = (first[to] - first[from]) / (to - from) as f64;
        for (i, value) in filled[from..to].iter_mut().enumerate().skip(1) {
            *value = first[from] + step * i as f64;
        }
    }
    let gaps = first.len() - known.len();
    // Even to a hundredth of a step: what is printed may be rounded.
    let hundredth = (first[first.len() - 1] - first[0]) / first.len() as f64 / 100.0;
    if Axis::from_values(AxisKind::Time, filled.clone(), hundredth).step().is_some() {
        *first = filled;
        return Some(Finding::note("abscissa-filled").count("n", gaps));
    }
    for column in columns {
        match column {
            Values::Real(values) => *values = known.iter().map(|i| values[*i]).collect(),
            Values::Complex(values) => *values = known.iter().map(|i| values[*i]).collect(),
        }
    }
    Some(Finding::caution("rows-left-out").count("n", gaps))
}
