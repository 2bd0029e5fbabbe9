//! What an unknown contact stiffness would do to an answer.

use super::change::{Answer, Change};
use super::motions::Motions;
use super::stage::Stage;
use super::{Model, laws};
use crate::Law;
use crate::contact::conversion;
use serde::Serialize;

/// Parts of the cycle in contact between which stiffnesses are tried: in half of the softest the masses would hardly part, and the
/// stiffest is no different from none.
const SHARES: (f64, f64) = (0.1, 1e-4);
/// Decades tried at most.
const DECADES: i32 = 7;

/// The answer with one stiffness of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sensitivity {
    /// k₃ in N/m.
    pub stiffness: f64,
    /// Part of the cycle in contact.
    pub share: f64,
    /// The answer: of x₁ and x₂; of impacts the same number twice.
    pub answer: [f64; 2],
    /// Its change, from impacts without duration.
    pub change: f64,
    /// Whether that is allowed, and the motion had settled.
    pub enough: bool,
}

/// Answers over the stiffnesses, in decades, that keep the masses in contact for 10 % to 0.01 % of the cycle, and the stiffnesses (N/m) whose
/// answer cannot be computed; both empty where none rebounds with the scene's restitution.
pub fn sensitivity(
    stage: &Stage<'_>,
    motions: Option<&Motions>,
    base: &Answer,
) -> (Vec<Sensitivity>, Vec<f64>) {
    let (mut rows, mut failed) = (Vec::new(), Vec::new());
    if laws::is_curved(stage.scene) {
        return (rows, failed);
    }
    let mass = stage.scene.rig.reduced_mass();
    // ω₀t_c at the damping that the law has at 1 N/m: it depends on the damping ratio only, if that is not stated.
    let Ok(Law::KelvinVoigt { damping, .. }) = stage.scene.spring(1.0) else {
        return (rows, failed);
    };
    let stated = laws::keys(stage.scene).damping.is_some();
    let share = |k: f64| {
        let c = if stated { damping } else { damping * k.sqrt() };
        conversion::duration(c / (2.0 * (k * mass).sqrt()), k, mass) * stage.excitation.frequency()
    };
    // π√(M/k) of the cycle, without losses.
    let half = std::f64::consts::PI * mass.sqrt() * stage.excitation.frequency();
    let [low, high] = [SHARES.0, SHARES.1].map(|s| 2.0 * (half / s).log10());
    let low = low.ceil() as i32;
    for decade in low..=(high.floor() as i32).min(low + DECADES - 1) {
        let stiffness = 10_f64.powi(decade);
        let answer = match motions {
            Some(motions) => stage.with_spring(motions, stiffness).ok(),
            None => stage.loose_mass(Some(stiffness)).answer,
        };
        let Some(answer) = answer else {
            failed.push(stiffness);
            continue;
        };
        let Change { change, enough, .. } = base.change(&answer, Model::KelvinVoigt, stage.question);
        rows.push(Sensitivity { stiffness, share: share(stiffness), answer: answer.value, change, enough });
    }
    (rows, failed)
}
