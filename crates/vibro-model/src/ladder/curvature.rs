//! Effect of a spring's curvature on the answer. No rung has a curved spring: each curved spring is
//! replaced by the straight one that harmonic linearisation gives for the motion found, and the answers
//! are compared.

use super::driven_scene::DrivenScene;
use super::{Change, Choice, Model, Question, elsewhere};
use crate::duffing::limit;
use crate::motion::Motion;
use crate::rig::Rig;
use crate::simulate::Simulation;
use serde::Serialize;
use vibro_record::{Finding, Result};

/// Cycles over which the motion is averaged: whole patterns of 1 to 6 cycles.
const CYCLES: usize = 60;
/// Samples in a cycle, or in a swing of the faster mass if that is shorter: a peak is up to 0.03 % too
/// low.
const SAMPLES: f64 = 128.0;

/// Largest square of the mean displacement over its mean square. The force at rest is then off by up to
/// 2√0.01, a fifth of what the curvature changes.
const CENTRED: f64 = 0.01;

/// Effect of the curvature of a spring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Curvature {
    /// Number of the spring, 1 or 2.
    pub spring: u8,
    /// Half the peak-to-peak displacement of its mass in m.
    pub amplitude: f64,
    /// Relative shift of its natural frequency by harmonic balance, to first order 3k₃A²/8k for a sine
    /// of amplitude A. `None` where a softening spring goes beyond its largest force.
    pub shift: Option<f64>,
    /// Change of the answer with the equivalent straight spring, of the mass that it changes most; `None`
    /// where there is no answer, or the spring is deflected at rest.
    pub change: Option<MassChange>,
}

/// Change of an answer, with the mass that changes most over its allowance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MassChange {
    /// The change.
    #[serde(flatten)]
    pub change: Change,
    /// Number of the mass; `None` for an observable of both masses.
    pub mass: Option<u8>,
}

/// Effects of the curved springs on an answer.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Effects {
    /// Of each curved spring.
    pub each: Vec<Curvature>,
    /// Change of the answer with both; `None` where only one is curved, or one has no change of its own.
    pub together: Option<MassChange>,
}

/// Displacement of a mass, sampled: extremes in m, and sums over time of x, x², x³ and x⁴.
#[derive(Clone, Copy)]
struct Displacement {
    low: f64,
    high: f64,
    sums: [f64; 4],
    time: f64,
}

impl Displacement {
    const NONE: Displacement =
        Displacement { low: f64::INFINITY, high: f64::NEG_INFINITY, sums: [0.0; 4], time: 0.0 };

    fn add(&mut self, x: f64, time: f64) {
        (self.low, self.high, self.time) = (self.low.min(x), self.high.max(x), self.time + time);
        let mut power = 1.0;
        for sum in &mut self.sums {
            power *= x;
            *sum += power * time;
        }
    }

    /// Whether the motion is about the rest of a straight spring: beside a mean deflection the straight
    /// spring that takes the place of the curved one has another force at rest.
    fn is_centred(&self) -> bool {
        let [x, xx, ..] = self.sums.map(|sum| sum / self.time);
        x * x <= CENTRED * xx
    }

    /// Slope of the line that fits x³ best over the motion, cov(x³, x)/var(x): ¾A² for a sine of
    /// amplitude A.
    fn slope(&self) -> f64 {
        let [x, xx, xxx, xxxx] = self.sums.map(|sum| sum / self.time);
        let variance = xx - x * x;
        // A mass at rest has the tangent 3x².
        if variance > 1e-12 * xx { (xxxx - xxx * x) / variance } else { 3.0 * x * x }
    }
}

/// Effects of the curved springs on the chosen answer, or on that with rigid impacts where none is
/// chosen. `settled` is the motion with rigid impacts after its transients; without it nothing is
/// computed.
///
/// # Errors
/// If the motion cannot be followed.
pub fn effects(choice: &Choice, stage: &DrivenScene<'_>, settled: Option<Simulation>) -> Result<Effects> {
    let (Some(mut motion), Some(springs)) = (settled, stage.scene.springs) else {
        return Ok(Effects::default());
    };
    let mut displacements = [Displacement::NONE; 2];
    let rig = stage.scene.rig;
    let fastest =
        rig.natural_frequencies().into_iter().filter(|f| f.is_finite()).fold(choice.frequency, f64::max);
    for _ in 0..CYCLES {
        motion.run(motion.time() + 1.0 / choice.frequency, |leg| {
            let n = (leg.duration * fastest * SAMPLES).ceil();
            let time = leg.duration / n;
            for i in 0..n as u32 {
                let state = leg.state((f64::from(i) + 0.5) * time);
                displacements[0].add(state.x1, time);
                displacements[1].add(state.x2, time);
            }
        })?;
    }
    let model = choice.chosen.unwrap_or(Model::Restitution);
    let added = [0, 1].map(|i| springs.cubic()[i] * displacements[i].slope());
    let change = |added: [f64; 2]| -> Option<MassChange> {
        let changed = Rig { k1: rig.k1 + added[0], k2: rig.k2 + added[1], ..rig };
        let change = elsewhere(choice, model, stage, changed)?;
        Some(MassChange { change, mass: (!stage.question.observable.is_of_impacts()).then_some(change.mass) })
    };
    let effect = |i: usize| {
        let (x, cubic, stiffness) = (&displacements[i], springs.cubic()[i], [rig.k1, rig.k2][i]);
        let (added, alone) = (added[i], [0, 1].map(|k| if k == i { added[k] } else { 0.0 }));
        let within = x.high.max(-x.low) <= limit(stiffness, cubic) && added > -stiffness;
        Curvature {
            spring: i as u8 + 1,
            amplitude: (x.high - x.low) / 2.0,
            shift: within.then(|| (1.0 + added / stiffness).sqrt() - 1.0),
            change: (within && x.is_centred()).then(|| change(alone)).flatten(),
        }
    };
    let counts = |i: &usize| springs.cubic()[*i] != 0.0 && (*i == 0 || !rig.has_wall());
    let each: Vec<Curvature> = (0..2).filter(counts).map(effect).collect();
    let both = each.len() == 2 && each.iter().all(|spring| spring.change.is_some());
    let together = both.then(|| change(added)).flatten();
    Ok(Effects { each, together })
}

/// The findings on the spring with the largest effect, and on both together.
pub fn findings(choice: &Choice, question: &Question) -> Vec<Finding> {
    let together = choice.springs_together.map(|MassChange { change, mass }| {
        let found = if change.enough {
            Finding::note("springs-together-hold")
        } else {
            Finding::doubt("springs-together-matter").without_estimate()
        };
        of_mass(found.number("change", change.change), mass).number("tolerance", question.tolerance)
    });
    [finding(choice, question)].into_iter().chain(together).collect()
}

/// Names the mass whose answer changes, if the observable is of one.
fn of_mass(found: Finding, mass: Option<u8>) -> Finding {
    mass.into_iter().fold(found, |found, mass| found.count("mass", mass.into()))
}

/// The finding on the spring with the largest effect.
fn finding(choice: &Choice, question: &Question) -> Finding {
    let size = |c: &Curvature| c.change.map_or(f64::INFINITY, |c| c.change.change.abs());
    let Some(worst) = choice.springs.iter().max_by(|a, b| size(a).total_cmp(&size(b))) else {
        return Finding::caution("springs-unchecked");
    };
    let Curvature { spring, amplitude, shift, change } = *worst;
    let told = |found: Finding| found.count("spring", spring.into()).number("amplitude", amplitude);
    let Some(shift) = shift else { return told(Finding::doubt("spring-beyond-force").without_estimate()) };
    let enough = change.is_some_and(|c| c.change.enough);
    let found = if enough {
        Finding::note("spring-curvature-holds")
    } else {
        Finding::doubt("spring-curvature-matters").without_estimate()
    };
    let found = told(found).number("shift", shift).number("tolerance", question.tolerance);
    let found = change.into_iter().fold(found, |found, MassChange { change, mass }| {
        of_mass(found.number("change", change.change), mass)
    });
    let impacts = choice
        .rung(Model::Linear)
        .error
        .filter(|impacts| !enough && change.is_some() && size(worst) > *impacts);
    impacts.into_iter().fold(found, |found, impacts| found.number("impacts", impacts))
}
