//! Traces in which no impacts can be looked for, and where.

use super::burst::median;
use vibro_record::units::notation::shortest;
use vibro_record::{AxisKind, Error, Grid, Result, Trace};

/// Where times are first apart by another step than most; `None` for even ones.
pub fn uneven(trace: &Trace) -> Option<Error> {
    let (AxisKind::Time, Grid::Uneven(times)) = (&trace.axis.kind, &trace.axis.grid) else { return None };
    let steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    let usual = median(&steps);
    let off = |i: &usize| (steps[*i] - usual).abs();
    let first = (0..steps.len()).find(|i| off(i) > 0.5 * usual.abs());
    let odd = first.or_else(|| (0..steps.len()).max_by(|a, b| off(a).total_cmp(&off(b))))?;
    let seconds = |v: f64| format!("{} s", shortest(v));
    let error = Error::refused(format!(
        "the trace is sampled unevenly: from {} to {} is a step of {}, most are {}",
        seconds(times[odd]),
        seconds(times[odd + 1]),
        seconds(steps[odd]),
        seconds(usual)
    ))
    .hint("cut the file there, or write the lost samples");
    Some(error)
}

/// Refuses missing values, and says where they are.
pub fn lost(trace: &Trace, values: &[f64], what: &str, why: &str) -> Result<()> {
    let odd: Vec<usize> = (0..values.len()).filter(|i| !values[*i].is_finite()).collect();
    let (Some(first), Some(last)) = (odd.first(), odd.last()) else { return Ok(()) };
    let at = |i: usize| format!("{} s", shortest(trace.axis.at(i)));
    Err(Error::refused(format!(
        "{} values of {what} are missing or infinite, from {} to {}: {why}",
        odd.len(),
        at(*first),
        at(*last)
    ))
    .hint("cut the file before or behind them"))
}
