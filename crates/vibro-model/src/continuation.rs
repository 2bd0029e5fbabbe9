//! Branches of periodic motions over frequency, force, or a value of the rig, followed through folds, with
//! every change of stability marked.

mod walk;

use super::orbit::Loss;
use super::parameter::Parameter;
use super::periodic::PeriodicOrbit;
use super::scales;
use serde::Serialize;
use vibro_record::units::notation::significant;
use vibro_record::{Error, Result};
use walk::Walk;

/// A marked motion on a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// What happens there: at a fold the branch turns back (a multiplier passes +1); at a flip (−1) motions
    /// of twice the period branch off, and their branch turns back; at Neimark–Sacker a pair of complex
    /// multipliers crosses the unit circle; at grazing an impact vanishes or a further contact appears.
    pub kind: Loss,
    /// The motion there.
    pub orbit: PeriodicOrbit,
    /// Index of the point before the mark.
    pub after: usize,
}

/// Why a branch ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// The end of the range is reached.
    Range,
    /// The impulse of an impact falls to zero; beyond this point it would have to be negative (pull).
    Grazing,
    /// The branch is a closed curve: it came back to its start.
    Closed,
    /// No further step succeeds: two impacts meet, or the equations are singular.
    Lost,
    /// The largest number of points is reached.
    Points,
}

/// Motions along a branch, in its order.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Points.
    pub points: Vec<PeriodicOrbit>,
    /// Marks, in order.
    pub marks: Vec<Mark>,
    /// Its two ends.
    pub ends: [End; 2],
}

/// Most swings of a mass in a period for which a branch is followed: each of thousands of steps searches all
/// of them for contacts.
const MOST_SWINGS: f64 = 1000.0;

/// Follows the branch of `start` in both directions while the value of `over` is in `low..=high` (SI units):
/// the frequency, the force, or a value of the rig.
///
/// The length of a step combines (pseudo-arclength; H. B. Keller 1977): phases in rad; impulses over M(1 +
/// R)ω times the gap or amplitude; and the varied value. This value enters as its logarithm, a gap over the
/// gap or amplitude at the start, a restitution unchanged.
///
/// # Errors
/// If the range or the step is impossible or does not hold the start; if a mass swings more than 1000 times
/// in a period.
pub fn follow(start: &PeriodicOrbit, over: Parameter, low: f64, high: f64, step: f64) -> Result<Branch> {
    let value = over.of(&start.rig, &start.sine);
    check_range(over, low, high, value)?;
    if !(step > 1e-6 && step <= 1.0) {
        return Err(Error::usage(format!("a branch by steps of {step}"), "a step from 1e-6 to 1")
            .hint("0.05")
            .setting("step"));
    }
    scales::check_swings(&start.rig, start.sine.frequency / f64::from(start.cycles), MOST_SWINGS)?;
    let walk = Walk { start, over, low, high, step };
    let origin = walk.point(start)?;
    let mut forth = walk.run(&origin, 1.0)?;
    if forth.end == End::Closed {
        return Ok(Branch { points: forth.points, marks: forth.marks, ends: [End::Closed; 2] });
    }
    let back = walk.run(&origin, -1.0)?;
    let behind = back.points.len() - 1;
    let mut points: Vec<_> = back.points.into_iter().skip(1).rev().collect();
    points.append(&mut forth.points);
    let before = |m: Mark| Mark { after: (behind - m.after).saturating_sub(1), ..m };
    let beyond = |m: Mark| Mark { after: m.after + behind, ..m };
    let marks = back.marks.into_iter().rev().map(before).chain(forth.marks.into_iter().map(beyond)).collect();
    Ok(Branch { points, marks, ends: [back.end, forth.end] })
}

/// Checks the range of `over` for a branch with its start at `value`.
///
/// # Errors
/// If an end is impossible, the upper end is not above the lower one, or the start lies outside.
pub fn check_range(over: Parameter, low: f64, high: f64, value: f64) -> Result<()> {
    let (name, unit) = (over.name(), if over.unit() == "1" { "" } else { over.unit() });
    over.check(low).map_err(|e| e.hint("another lower end").setting("from"))?;
    over.check(high).map_err(|e| e.hint("another upper end").setting("to"))?;
    let written = |words: String| words.trim_end().to_owned();
    if low >= high {
        let found = written(format!("{name} from {low} to {high} {unit}"));
        let hint = if low > high { "swap both ends" } else { "a higher upper end" };
        return Err(Error::usage(found, "the lower end first, then a higher one")
            .hint(hint)
            .setting("from")
            .setting("to"));
    }
    if over == Parameter::Force && low == 0.0 {
        let hint = format!("a lower end of {}", significant(high / 100.0, 1));
        return Err(Error::usage("force from 0 N", "a lower end above 0").hint(hint).setting("from"));
    }
    if !(low..=high).contains(&value) {
        let found = written(format!("the start at {name} {value} {unit}")) + " is outside the range";
        let expected = written(format!("a start from {low} to {high} {unit}"));
        let start = match over {
            Parameter::Frequency => "frequency",
            Parameter::Force => "force",
            _ => "set",
        };
        return Err(Error::usage(found, expected).hint("a start within the range").setting(start));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
