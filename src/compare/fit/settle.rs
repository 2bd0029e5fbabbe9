//! Motions by history and parameters by least squares, in turn until both stay.

use super::super::prediction::Kind;
use super::super::simulated::Pace;
use super::data::{Data, Step};
use super::edge::{edges, pulled};
use super::held::Held;
use super::motion::{Motions, assigned, without_far};
use super::problem::Problem;
use super::search::{FINE, approached, missed, missed_by, priors};
use super::setting::Setting;
use super::unknown::{Unknown, at};
use crate::error::{Error, Result};
use crate::math::Minimum;
use crate::measure::residuals::{Whiteness, student};

/// Rounds before steps whose motion still changes are left out.
const ROUNDS: usize = 3;
/// Rounds after that.
const MORE: usize = 3;

/// Pace of simulated sweeps on the way.
const BRIEF: Pace = Pace { settle: 60, measure: 36 };

/// Parameters at the least sum of squares, with the motions that belong to them.
#[derive(Debug, Clone)]
pub struct Settled<'a> {
    pub problem: Problem<'a>,
    pub minimum: Minimum,
    /// Sum of squares of the data over points less parameters, before variances were scaled; NaN where there are no more points.
    pub reduced: f64,
    /// Of the residuals along frequency, sweep by sweep.
    pub whiteness: Whiteness,
    /// Amplitudes left out because their motion changed from round to round.
    pub wavering: usize,
    /// Whether the motions stayed the same in the last round.
    pub agreed: bool,
    /// Amplitudes left out because they lie far from the motion that the simulated sweep comes to.
    pub far: usize,
    /// How far all points lie from what a simulated sweep shows, or from the motion they are taken for, and the parameters from their
    /// priors: Σ min (z², 1), the less the better.
    pub missed: f64,
    /// Why the answer cannot be right as it stands: what was known of a parameter, or its bounds, contradict the points.
    pub contradictions: Vec<String>,
    /// Amplitudes of which the compliance of the contact could not be taken out.
    pub lost: usize,
}

/// Part of the amplitudes whose motion is known that may lie far from it before the answer is doubted.
const CONTRADICTED: f64 = 0.1;
/// χ²/ν beyond which residuals say more of the model than of noise: what it lacks moves parameters by more than what is left of it in the
/// residuals, which the parameters take up as far as they can.
const POOR: f64 = 1.25;
/// Normal deviate that χ²/ν exceeds by chance in one of a thousand cases.
const CHANCE: f64 = 3.09;

impl Settled<'_> {
    /// How well the points hold each parameter.
    ///
    /// # Errors
    /// As [`Held::new`].
    pub fn held(&self) -> Result<Held> {
        let edges = edges(&self.problem, &self.minimum.parameters);
        let mut jacobian = self.minimum.jacobian.clone();
        for (i, edge) in edges.iter().enumerate() {
            if let Some(edge) = edge {
                jacobian.set_column(i, &edge.column);
            }
        }
        Held::new(&self.problem, &self.minimum.parameters, &jacobian, edges)
    }

    /// What the points ask for beyond the bounds.
    pub fn pulled(&self, held: &Held) -> Vec<String> {
        pulled(&self.problem, &self.minimum.jacobian, &self.minimum.residuals, &held.edges)
    }

    /// Why the answer as a whole may be wrong, and its uncertainties mean nothing.
    pub fn doubt(&self) -> Option<String> {
        if !self.contradictions.is_empty() {
            return Some(self.contradictions.join("; "));
        }
        let n = self.problem.rows().0 + self.lost;
        if self.lost as f64 > CONTRADICTED * n as f64 {
            return Some(format!(
                "at {} of {n} amplitudes the contact lasts too long for the closed form and its correction",
                self.lost
            ));
        }
        let n = self.problem.rows().0 + self.far;
        if self.far as f64 > CONTRADICTED * n as f64 {
            return Some(format!(
                "{} of {n} amplitudes lie far from the motions that this very rig comes to: the answer may be wrong altogether",
                self.far
            ));
        }
        let residuals = self.reduced.sqrt();
        let guessed = self.problem.data.guessed;
        if !guessed && self.reduced > POOR && (self.beyond_chance() || self.whiteness.rejected()) {
            let row = if self.whiteness.rejected() { " and follow each other along frequency" } else { "" };
            return Some(format!(
                "the residuals are {residuals:.1} times as large as the uncertainties of the points{row}, {}: the model lacks something, a motion had not \
                 settled, or the amplitudes stray by more than the noise in their spectra (`scatter` in [fit] says by how much)",
                self.largest()
            ));
        }
        let free = free(&self.problem);
        if (guessed || self.reduced > 1.0) && student(free).is_none() {
            return Some(format!(
                "the residuals have to tell how large the errors of the points are, and there are only {free} amplitudes and priors more than \
                 parameters"
            ));
        }
        if !self.agreed {
            return Some(
                "the motions of some points still changed with the parameters in the last round".to_owned(),
            );
        }
        (!self.minimum.converged)
            .then(|| "the search ended before it found the least sum of squares".to_owned())
    }

    /// The largest residual, for a sentence.
    fn largest(&self) -> String {
        let all = self.problem.used().zip(&self.minimum.residuals);
        let largest = all.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        largest.map_or_else(String::new, |((step, mass), residual)| {
            format!(
                "{:.1} times at {:.4} Hz of mass {}",
                residual.abs() * self.problem.scale.sqrt(),
                self.problem.data.steps[step].frequency,
                mass + 1
            )
        })
    }

    /// Whether χ²/ν is larger than chance makes it (E. B. Wilson & M. M. Hilferty 1931).
    pub fn beyond_chance(&self) -> bool {
        let part = 2.0 / (9.0 * free(&self.problem) as f64);
        self.reduced > (1.0 - part + CHANCE * part.sqrt()).powi(3)
    }

    pub fn setting(&self) -> Setting {
        self.problem.setting(&self.minimum.parameters)
    }
}

/// Settles from the coordinates `start` on.
///
/// At first far points pull little ([`super::search`]), since the motions of wrong parameters are wrong, too; in the end all count as stated.
///
/// # Errors
/// If a round leaves fewer points than parameters.
pub fn settle<'a>(
    data: &'a Data,
    base: &Setting,
    unknowns: &[Unknown],
    start: &[f64],
    pace: Pace,
) -> Result<Settled<'a>> {
    let mut u = start.to_vec();
    let motions = |u: &[f64], pace: Pace| assigned(data, &at(base, unknowns, u), pace);
    // Parameters that are wrong by more than a disturbance leaves need no long wait for it.
    let brief = Pace { settle: pace.settle.min(BRIEF.settle), measure: pace.measure.min(BRIEF.measure) };
    for part in FINE {
        let now = motions(&u, brief)?;
        enough(now.amplitudes(data), unknowns)?;
        u = approached(data, base, unknowns, &now.kinds, part, u);
    }
    let mut now = motions(&u, pace)?;
    let mut out = vec![false; data.steps.len()];
    let left = |now: &Motions, u: &[f64], out: &[bool]| -> Vec<Option<Kind>> {
        let near = without_far(data, &at(base, unknowns, u), now.kinds.clone());
        near.into_iter().zip(out).map(|(kind, out)| kind.filter(|_| !out)).collect()
    };
    let mut kinds = left(&now, &u, &out);
    let mut round = 0;
    loop {
        let (problem, minimum, reduced, whiteness) = least(data, base, unknowns, &kinds, &u)?;
        u.clone_from(&minimum.parameters);
        now = motions(&u, pace)?;
        let next = left(&now, &u, &out);
        let agreed = next == kinds;
        round += 1;
        if agreed || round >= ROUNDS + MORE {
            let of = |(step, out): (&Step, &bool)| if *out { step.clear().count() } else { 0 };
            let wavering = data.steps.iter().zip(&out).map(of).sum();
            let left_out = |i: usize| kinds[i].is_none() && !out[i];
            let far =
                (0..data.steps.len()).filter(|i| left_out(*i)).map(|i| now.amplitudes_at(data, i)).sum();
            let missed = missing(&problem, &u, &now);
            return Ok(Settled {
                problem,
                minimum,
                reduced,
                whiteness,
                wavering,
                agreed,
                far,
                missed,
                contradictions: Vec::new(),
                lost: 0,
            });
        }
        if round >= ROUNDS {
            for ((out, a), b) in out.iter_mut().zip(&kinds).zip(&next) {
                *out |= a != b;
            }
        }
        kinds = next.into_iter().zip(&out).map(|(kind, out)| kind.filter(|_| !out)).collect();
    }
}

/// How far all points lie from what was simulated, or from the motion they are taken for; errors that points of the fit share are allowed
/// for there.
fn missing(problem: &Problem<'_>, u: &[f64], motions: &Motions) -> f64 {
    let (data, setting) = (problem.data, problem.setting(u));
    let plain = Problem { scale: 1.0, ..problem.clone() };
    let mut own = vec![[None; 2]; data.steps.len()];
    for ((step, mass), r) in plain.used().zip(plain.at(u)) {
        own[step][mass] = data.steps[step].seen[mass].as_ref().map(|seen| missed_by(seen, r));
    }
    let one = |i: usize| {
        let simulated = missed(data, &data.steps[i], motions.came[i].unwrap_or([0.0; 2]));
        let used: f64 = own[i].iter().flatten().sum();
        if own[i].iter().any(Option::is_some) { used.min(simulated) } else { simulated }
    };
    let points: f64 = (0..data.steps.len()).map(one).sum();
    points + FINE.len() as f64 * priors(&problem.unknowns, &setting)
}

/// Whether `n` amplitudes and the priors can determine the unknowns.
fn enough(n: usize, unknowns: &[Unknown]) -> Result<()> {
    let priors = unknowns.iter().filter(|u| u.prior.is_some()).count();
    if n + priors < unknowns.len() || n == 0 {
        return Err(Error::refused(format!(
            "{n} amplitude(s) of motions with one impact a cycle or none do not determine {} parameters",
            unknowns.len()
        ))
        .hint("check units and which mass is which, begin nearer to the rig, or fit fewer parameters"));
    }
    Ok(())
}

/// The least sum of squares with these motions; weights and scale from the parameters found, twice.
pub fn least<'a>(
    data: &'a Data,
    base: &Setting,
    unknowns: &[Unknown],
    kinds: &[Option<Kind>],
    start: &[f64],
) -> Result<(Problem<'a>, Minimum, f64, Whiteness)> {
    let mut problem = Problem::new(data, base, unknowns, kinds);
    enough(problem.rows().0, unknowns)?;
    let mut u = start.to_vec();
    let mut turn = 0;
    loop {
        problem.weigh(&u);
        let minimum = problem.solve(&u)?;
        u.clone_from(&minimum.parameters);
        let (reduced, whiteness) = left(&problem, &minimum.residuals);
        turn += 1;
        if turn == 3 {
            return Ok((problem, minimum, reduced, whiteness));
        }
        let least = if data.guessed && free(&problem) > 0 { f64::MIN_POSITIVE } else { 1.0 };
        // A scale that the residuals had to tell is itself uncertain.
        let told = if reduced > least { student(free(&problem)).unwrap_or(1.0) } else { 1.0 };
        problem.scale = reduced.max(least) * (told * whiteness.inflation).powi(2);
    }
}

/// Amplitudes and priors less parameters.
fn free(problem: &Problem<'_>) -> usize {
    let (n, priors) = problem.rows();
    (n + priors).saturating_sub(problem.unknowns.len())
}

/// χ²/ν of the data as their stated uncertainties have it, priors counted among them, NaN where ν is 0, and whether the data's residuals are noise.
pub fn left(problem: &Problem<'_>, residuals: &[f64]) -> (f64, Whiteness) {
    let (n, _) = problem.rows();
    let (data, known) = residuals.split_at(n.min(residuals.len()));
    let free = free(problem);
    let sum = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
    let all = if free == 0 { f64::NAN } else { problem.scale * sum(data) + sum(known) };
    let reduced = all / free as f64;
    let mut rows: Vec<Vec<f64>> = vec![Vec::new(); problem.data.sweeps.len()];
    for ((step, mass), r) in problem.used().zip(data) {
        if let Some(seen) = &problem.data.steps[step].seen[mass] {
            rows[seen.sweep].push(*r);
        }
    }
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    (reduced, Whiteness::of(&rows))
}
