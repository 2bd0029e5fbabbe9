//! What was known of parameters beside what the points say.

use super::super::simulated::Pace;
use super::identify;
use super::settle::Settled;
use super::unknown::Unknown;
use crate::units::notation::{quantity, with_std};

/// A prior and the points contradict each other where they differ by more than so many standard uncertainties of both: chance does so in one
/// of 1.7 million cases.
const APART: f64 = 5.0;

/// A sentence for each prior that the points alone contradict, by a fit without any but those of masses, and for each mass that does
/// not agree with its own: without the force, motion does not tell masses.
pub fn contradictions(settled: &Settled<'_>, starts: usize, pace: Pace) -> Vec<String> {
    let problem = &settled.problem;
    let mut said: Vec<String> = problem.unknowns.iter().filter_map(|k| weighed(settled, k)).collect();
    if problem.unknowns.iter().any(told) {
        said.extend(contradicted(settled, starts, pace));
    }
    said
}

/// Whether it has a prior that the points can contradict.
fn told(unknown: &Unknown) -> bool {
    unknown.prior.is_some() && !unknown.parameter.is_mass()
}

/// That a mass lies far from what it weighs.
fn weighed(settled: &Settled<'_>, unknown: &Unknown) -> Option<String> {
    let [known, std] = unknown.prior.filter(|_| unknown.parameter.is_mass())?;
    let (value, parameter) = (settled.setting().get(unknown.parameter), unknown.parameter);
    let apart = (value - known).abs() / std;
    (apart > APART).then(|| {
        format!(
            "{} of {} lies {apart:.1} standard uncertainties from its prior, {}",
            parameter.name(),
            quantity(value, parameter.unit(), 4),
            with_std(known, Some(std), parameter.unit())
        )
    })
}

/// As [`contradictions`], of the parameters that are no masses.
fn contradicted(settled: &Settled<'_>, starts: usize, pace: Pace) -> Vec<String> {
    let problem = &settled.problem;
    let without = |k: &Unknown| Unknown { prior: k.prior.filter(|_| !told(k)), ..*k };
    let free: Vec<Unknown> = problem.unknowns.iter().map(without).collect();
    // Where the points alone do not determine the parameters, they contradict nothing.
    let Ok((alone, _)) = identify(problem.data, &problem.base, &free, starts, pace) else {
        return Vec::new();
    };
    let minimum = &alone.minimum;
    let Ok(held) = alone.held() else {
        return Vec::new();
    };
    if alone.doubt().is_some() {
        return Vec::new();
    }
    let one = |(i, unknown): (usize, &Unknown)| {
        let [known, known_std] = unknown.prior.filter(|_| told(unknown))?;
        let value = alone.setting().get(unknown.parameter);
        let std = held.covariance[(i, i)].sqrt() * unknown.coordinate.slope(minimum.parameters[i]).abs();
        let apart = (value - known).abs() / known_std.hypot(std);
        (held.loose[i].is_none() && apart > APART).then(|| {
            let (name, unit) = (unknown.parameter.name(), unknown.parameter.unit());
            format!(
                "the prior of {name}, {}, contradicts the points, which say {} without priors",
                with_std(known, Some(known_std), unit),
                with_std(value, Some(std), unit)
            )
        })
    };
    problem.unknowns.iter().enumerate().filter_map(one).collect()
}
