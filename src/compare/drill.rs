//! The model of a hammer drill over its joined bodies, through the same measurement.
//!
//! [`turn`] (the model at measured phases) → [`fit`] (keys of the drill and the angle of the pulse) →
//! [`difference`] (numbers of the blows).

mod difference;
mod fit;
mod turn;

pub use difference::Difference;
pub use fit::{DrillFit, FittedKey};

use crate::campaign::DrillModelEntry;
use crate::error::{Error, Result};
use crate::measure::Estimate;
use crate::measure::chain::{Body, Chain};
use crate::model::drill::{Course, MachineDraft, Regime, Rung, climb};
use crate::record::Finding;
use difference::differences;
use fit::fitted;
use serde::Serialize;
use turn::{JUDGED, TurnModel};

#[cfg(test)]
mod tests;

/// Turns from rest that are discarded, where the campaign states no number.
const SETTLE: usize = 60;
/// Relative change of energies and rate that does not matter to the choice of the model.
const TOLERANCE: f64 = 0.02;
/// Difference of model and measurement in standard uncertainties that is a finding: by chance, one of 370.
const APART: f64 = 3.0;

/// Names of the bodies of the model, in the direction of a blow.
const BODIES: [&str; 3] = ["striker", "intermediate piston", "bit"];

/// The model over the measured bodies of a drill.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrillComparison {
    /// Model.
    pub rung: Rung,
    /// Pattern of its blows.
    pub regime: Regime,
    /// Angle of the crank in ° after top dead centre at its pulse.
    pub pulse_angle: Estimate,
    /// Fitted keys; the rest of the comparison is with them.
    pub fit: Option<DrillFit>,
    /// The model's turn of each measured body.
    pub bodies: Vec<ShownBody>,
    /// Numbers of the blows.
    pub differences: Vec<Difference>,
    /// Findings.
    #[serde(skip)]
    pub findings: Vec<Finding>,
}

/// The model's turn of a measured body.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShownBody {
    /// Name of the body.
    pub name: String,
    /// Velocity in m/s, positive in the direction of a blow, at the phases of the average: sampled,
    /// smoothed and averaged like the record.
    pub velocity: Vec<f64>,
    /// Root mean square of measured less model over the turn in m/s.
    pub rms: f64,
    /// The same, each phase in standard deviations from turn to turn.
    pub scatters: f64,
}

/// Compares the joined bodies of a drill with the model in `draft`, which runs at the measured speed.
///
/// # Errors
/// If no body has the name of one of the model's, a number of the model is impossible, it cannot be
/// followed, or the fit fails.
pub fn drill_comparison(
    draft: &MachineDraft,
    entry: &DrillModelEntry,
    bodies: &[&Body],
    chain: &Chain,
) -> Result<DrillComparison> {
    let place = |body: &Body| BODIES.iter().position(|name| body.name.eq_ignore_ascii_case(name));
    let known: Vec<(&Body, usize)> = bodies.iter().filter_map(|body| Some((*body, place(body)?))).collect();
    if known.is_empty() {
        let found = format!("no body of the model among {}", chain.bodies.join(", "));
        return Err(Error::usage(found, BODIES.join(", ")).set("body", BODIES[0]));
    }
    let mut draft = draft.clone();
    draft.put("crank.frequency", chain.speed)?;
    let machine = draft.machine()?;
    let settle = entry.settle.unwrap_or(SETTLE);
    let course = Course { judged: JUDGED, ..Course::turns(settle + JUDGED) };
    let rung = match entry.rung {
        Some(rung) => rung,
        None => climb(&machine, &course, TOLERANCE)?.chosen,
    };
    let turns = TurnModel { rung, course, bodies: known, direction: chain.direction };
    let mut findings = Vec::new();
    let (mut fit, machine) = fitted(&turns, &draft, entry, &mut findings)?;
    let invented = draft.left_out().join(", ");
    if !invented.is_empty() {
        let doubt = Finding::doubt("drill-left-out").name("keys", invented);
        findings.push(doubt.of(&mut fit));
    }
    let pulse = match (entry.pulse_angle, &fit) {
        (None, Some(DrillFit { keys, .. })) if !keys.is_empty() => keys[keys.len() - 1].estimate.clone(),
        (stated, _) => Estimate::new(stated.unwrap_or(0.0), None, "°", 0, "stated"),
    };
    let turn = turns.run(&machine)?;
    let ahead = pulse.value / 360.0;
    let shown = turns.bodies.iter().zip(turns.shown(&turn, ahead)?).map(|((body, _), velocity)| {
        let [rms, scatters] = turns.off(body, &velocity);
        ShownBody { name: body.name.clone(), velocity, rms, scatters }
    });
    let differences = differences(&machine, &turn, &turns, chain, entry.pulse_angle);
    let apart = differences.iter().filter_map(|d| Some((&d.quantity, d.deviations?.abs())));
    let worst = apart.filter(|(_, by)| *by > APART).max_by(|a, b| a.1.total_cmp(&b.1));
    findings.extend(worst.map(|(quantity, by)| {
        Finding::caution("drill-model-differs").name("quantity", quantity).number("deviations", by)
    }));
    let regime = turn.run.regime;
    Ok(DrillComparison {
        rung,
        regime,
        pulse_angle: pulse,
        fit,
        bodies: shown.collect(),
        differences,
        findings,
    })
}
