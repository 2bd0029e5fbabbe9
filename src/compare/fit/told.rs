//! What is to be said of a fit.

use super::super::forcing::median;
use super::Fit;
use super::data::{self, Data, Seen};
use super::settle::Settled;
use crate::campaign::{FitEntry, Parameter};
use crate::units::notation::significant;

/// A factor by which amplitudes are off that no calibration explains.
const MANY: f64 = 5.0;
/// A force that differs by more than this part is another one.
const OTHER: f64 = 0.05;
/// Correlations beyond this are named.
const TIED: f64 = 0.95;
/// A value within this part of its bounds lies at one.
const AT_BOUND: f64 = 1e-3;

/// Sentences in the order of their weight.
pub fn warnings(fit: &Fit, settled: &Settled<'_>) -> Vec<String> {
    let (mut said, data) = (Vec::new(), settled.problem.data);
    let left = fit.left_out;
    let doubt = settled.doubt();
    if let Some(doubt) = &doubt {
        said.push(format!(
            "No parameter has an uncertainty: {doubt}. A value that is held (force, mass, stiffness of the contact), a unit, the scaling (peak or \
             rms), a calibration (`calibration` in [fit] says how well it is known), which mass is which, or a prior may be wrong; else begin nearer to \
             the rig, or with more `starts`."
        ));
        said.extend(off_by(fit));
    }
    for parameter in &fit.parameters {
        let name = parameter.parameter.name();
        if let Some(reason) = parameter.reason.as_ref().filter(|_| doubt.is_none()) {
            said.push(format!("{name} is not identifiable from these points: {reason}."));
        }
        if parameter.rests_on_prior {
            said.push(format!("{name} rests on its prior: the points say less of it than was known before."));
        }
    }
    for (unknown, u) in settled.problem.unknowns.iter().zip(&settled.minimum.parameters) {
        let c = unknown.coordinate;
        let part = (c.value(*u) - c.low) / (c.high - c.low);
        if c.high.is_finite() && !(AT_BOUND..=1.0 - AT_BOUND).contains(&part) {
            let little = if doubt.is_none() { ": its uncertainty means little" } else { "" };
            let name = unknown.parameter.name();
            said.push(format!("{name} lies at a bound, {} to {}{little}.", c.low, c.high));
        }
    }
    said.extend(simplest(fit));
    if let Some(force) = fit.parameters.iter().find(|p| p.parameter == Parameter::Force && p.prior.is_none())
    {
        let ratio = force.estimate.value / force.start;
        if doubt.is_none() && (ratio - 1.0).abs() > OTHER {
            said.push(format!(
                "The force found is {ratio:.3} times that of the campaign or its files: that one, or the scale of the amplitudes, is wrong."
            ));
        }
    }
    if data.guessed {
        let good = data::GUESS * fit.reduced_chi_squared.sqrt();
        said.push(format!("By the residuals the amplitudes are good to {:.2} %.", 100.0 * good));
    } else if fit.reduced_chi_squared.is_nan() {
        said.push("There are no more amplitudes and priors than parameters: nothing tells whether the model fits them.".to_owned());
    } else if doubt.is_none() && settled.beyond_chance() {
        said.push(format!(
            "The residuals are {:.1} times as large as the uncertainties of the points: these are too small, or the model lacks something. The \
             uncertainties of the parameters are widened as much.",
            fit.reduced_chi_squared.sqrt()
        ));
    }
    if doubt.is_none() && settled.whiteness.rejected() {
        said.push(format!(
            "The residuals follow each other along frequency, which noise does not: the model lacks something. Uncertainties are widened \
             by {:.1} for it.",
            settled.whiteness.inflation
        ));
    }
    said.extend(tied(fit));
    if left.other_motion > 0 {
        said.push(format!(
            "{} of {} amplitudes take no part: the rig comes to other motions there than one impact a cycle or none.",
            left.other_motion,
            fit.n + left.other_motion + left.far + left.wavering
        ));
    }
    if left.soft > 0 {
        said.push(format!(
            "{} amplitude(s) take no part: the contact lasts too long there for the correction of its compliance.",
            left.soft
        ));
    }
    if doubt.is_none() && !data.guessed {
        said.extend(first_order(settled));
    }
    if left.far + left.wavering > 0 {
        said.push(format!(
            "{} amplitude(s) take no part because they lie far from their motion, {} because it changed with the parameters.",
            left.far, left.wavering
        ));
    }
    if fit.agreeing * 2 < fit.starts {
        let rigid =
            if data.corrected() { ", before the compliance of the contact was taken out" } else { "" };
        said.push(format!(
            "{} of {} starting points led to this answer{rigid}: it was found around the best of them, and explains the most points of all that were met.",
            fit.agreeing, fit.starts
        ));
    }
    said.push("The overlay and its scores are of the rig as it was stated, not of the one found.".to_owned());
    said.extend(data.warnings.iter().cloned());
    said
}

/// Which model was chosen, and whether the parameters found are those of it.
fn simplest(fit: &Fit) -> Option<String> {
    let (rung, own) = (fit.rungs.iter().find(|r| r.chosen)?, fit.rungs.last()?);
    let said = format!(
        "Of the models that were judged by points held out, the simplest within one standard error of the best is: {}.",
        rung.model
    );
    if rung.model == own.model {
        return Some(said);
    }
    let criterion = match (own.aicc, rung.aicc) {
        (Some(a), Some(b)) => format!(
            ", for which Akaike's criterion, of all points together, is {} by {:.0}",
            if a < b { "lower" } else { "higher" },
            (a - b).abs()
        ),
        _ => String::new(),
    };
    Some(format!(
        "{said} The parameters found are those of another, the {}{criterion}; `rungs` has the values of each.",
        own.model
    ))
}

/// That for most amplitudes of impacts the correction of the compliance may be off by more than their noise.
fn first_order(settled: &Settled<'_>) -> Option<String> {
    let steps = &settled.problem.data.steps;
    let seen = settled.problem.used().filter_map(|(step, mass)| steps[step].seen[mass].as_ref());
    let corrected: Vec<&Seen> = seen.filter(|s| s.left > 0.0).collect();
    // `std` is the root of the sum of both squares.
    let coarse = corrected.iter().filter(|s| s.left * s.amplitude > s.std / f64::sqrt(2.0)).count();
    let most = corrected.iter().map(|s| s.left).fold(0.0, f64::max);
    (2 * coarse > corrected.len()).then(|| {
        format!(
            "The compliance of the contact is taken out to first order, which may still be off by up to {} % of an amplitude: more than the noise at {coarse} of \
             {} amplitudes of impacts. Uncertainties hold it, so residuals can lie far below 1.",
            significant(100.0 * most, 2),
            corrected.len()
        )
    })
}

/// That a doubted fit had little to go by: at the rig as stated so many of all amplitudes are of motions that a fit can use.
pub fn scarce(data: &Data, usable: usize) -> Option<String> {
    let all = data.steps.iter().flat_map(data::Step::clear).count();
    (2 * usable < all).then(|| {
        format!(
            "The rig as it is stated shows one impact a cycle, or none, at {usable} of {all} amplitudes only, and a fit can use no other motions: sweep \
             where it does, or begin nearer to the rig."
        )
    })
}

/// Where the amplitudes are many times what the answer shows: most likely a mistake of units.
fn off_by(fit: &Fit) -> Option<String> {
    let mut ratios: Vec<f64> =
        fit.points.iter().map(|p| p.measured / p.fitted).filter(|r| r.is_finite()).collect();
    ratios.sort_by(f64::total_cmp);
    let middle = median(&ratios)?;
    (middle.ln().abs() > MANY.ln()).then(|| {
        let bound = if middle > 1.0 { "more" } else { "less" };
        format!("Half of the amplitudes are {middle:.3} times what the answer shows, or {bound}: the unit or the scaling may be wrong.")
    })
}

/// What is taken for the calibration where nothing is stated.
pub fn assumed(calibration: f64, entry: &FitEntry) -> String {
    let force = if entry.parameters.contains(&Parameter::Force) { "" } else { " and for the force" };
    format!(
        "How well the sensors are calibrated is not stated: {} % is assumed for each mass{force}, and is in all uncertainties. A better known one makes \
         them smaller (`calibration` in [fit]).",
        100.0 * calibration
    )
}

/// Sentences about what was given and has no use.
pub fn unused(entry: &FitEntry) -> Vec<String> {
    let stray = |what: &str, names: Vec<&str>| {
        (!names.is_empty()).then(|| {
            format!(
                "The {what} of {} is not used: {} not fitted.",
                names.join(", "),
                if names.len() == 1 { "it is" } else { "they are" }
            )
        })
    };
    let idle = |p: &&Parameter| !entry.parameters.contains(p);
    let priors = entry.prior.keys().filter(idle).map(|p| p.name()).collect();
    let bounds = entry.bounds.keys().filter(idle).map(|p| p.name()).collect();
    [stray("prior", priors), stray("bound", bounds)].into_iter().flatten().collect()
}

/// Pairs of parameters that are known better together than each alone.
fn tied(fit: &Fit) -> Vec<String> {
    let mut said = Vec::new();
    for (i, row) in fit.correlations.iter().enumerate() {
        for (j, r) in row.iter().enumerate().skip(i + 1).filter(|(_, r)| r.abs() > TIED) {
            let (a, b) = (&fit.parameters[i], &fit.parameters[j]);
            if a.identifiable && b.identifiable {
                said.push(format!(
                    "{} and {} are known better together than each alone: their correlation is {r:.3}.",
                    a.parameter.name(),
                    b.parameter.name()
                ));
            }
        }
    }
    said
}
