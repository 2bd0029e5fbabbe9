//! The ladder along a frequency axis: the choice may differ between frequencies.

use super::{Change, Choice, Model, Need, Question, choose, chosen};
use crate::parallel;
use crate::response::axis;
use crate::scene::Scene;
use serde::Serialize;
use vibro_record::Result;

/// Most points of an axis.
pub const MOST_POINTS: usize = 2000;

/// Choices along an axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Survey {
    /// The lowest rung that is good enough at every point; `None` where there is none, or a point has no
    /// choice.
    pub chosen: Option<Model>,
    /// Each rung over the whole axis.
    pub rungs: Vec<Summary>,
    /// Runs of neighbouring points with the same choice and the same needs.
    pub stretches: Vec<Stretch>,
    /// The choice at each point, frequencies rising.
    pub points: Vec<Choice>,
}

/// A rung over the whole axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// The model.
    pub model: Model,
    /// Median time of an answer in ns.
    pub cost_ns: Option<f64>,
    /// Largest change from its answer to those of the rungs above, over the points at which it is valid.
    pub error: Option<f64>,
    /// Whether it is valid at each point.
    pub valid: bool,
    /// Number of points at which it is valid.
    pub valid_at: usize,
    /// Number of points at which it is chosen.
    pub chosen_at: usize,
}

/// Neighbouring points with the same choice and the same needs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stretch {
    /// Frequency in Hz of the first point.
    pub from: f64,
    /// Frequency in Hz of the last point.
    pub to: f64,
    /// Number of points.
    pub points: usize,
    /// The rung chosen.
    pub chosen: Option<Model>,
    /// Parameters that must be known before one can be chosen.
    pub needs: Vec<Need>,
    /// Largest change of the chosen answer to that of the next rung that follows the motion in time.
    pub audit: Option<Change>,
    /// Frequency in Hz of the largest change.
    pub worst_at: Option<f64>,
}

/// [`choose`] at `points` equally spaced frequencies from `from` to `to` (Hz), in parallel.
///
/// # Errors
/// As [`choose`]; if the ends are not finite and above 0 with the lower one first, or there are fewer than 2
/// or more than [`MOST_POINTS`] points.
pub fn choose_over(scene: &Scene, from: f64, to: f64, points: usize, question: &Question) -> Result<Survey> {
    let at = axis(from, to, points, MOST_POINTS)?;
    let mut all: Vec<Choice> = parallel::each(points, |i| chosen(scene, at(i), question, false))
        .into_iter()
        .collect::<Result<_>>()?;
    let probes = probes(&all);
    let bent = parallel::each(probes.len(), |i| choose(scene, all[probes[i]].frequency, question));
    for (i, choice) in probes.into_iter().zip(bent) {
        all[i] = choice?;
    }
    Ok(Survey {
        chosen: Model::ALL
            .into_iter()
            .find(|model| all.iter().all(|choice| choice.chosen.is_some() && choice.rung(*model).sufficient)),
        rungs: Model::ALL.iter().map(|model| summary(*model, &all)).collect(),
        stretches: stretches(&all),
        points: all,
    })
}

/// Points at which a chosen contact of spring and damper, or the correction for one, is compared with curved
/// bodies: the first, the last and the largest answer of each run of points with the same choice.
fn probes(all: &[Choice]) -> Vec<usize> {
    let size = |i: &usize| all[*i].answer().map_or(0.0, |a| a[0].abs().max(a[1].abs()));
    let mut probes = Vec::new();
    let mut first = 0;
    for same in all.chunk_by(|a, b| a.chosen == b.chosen) {
        let last = first + same.len() - 1;
        if matches!(same[0].chosen, Some(Model::KelvinVoigt | Model::SoftCorrected)) {
            let peak = (first..=last).max_by(|a, b| size(a).total_cmp(&size(b)));
            probes.extend([first, peak.unwrap_or(last), last]);
        }
        first = last + 1;
    }
    probes.dedup();
    probes
}

fn summary(model: Model, all: &[Choice]) -> Summary {
    let rungs = || all.iter().map(|c| c.rung(model));
    let mut costs: Vec<f64> = rungs().filter_map(|r| r.cost_ns).collect();
    costs.sort_by(f64::total_cmp);
    let valid_at = rungs().filter(|r| r.valid).count();
    Summary {
        model,
        cost_ns: costs.get(costs.len() / 2).copied(),
        error: rungs().filter(|r| r.valid).filter_map(|r| r.error).reduce(f64::max),
        valid: valid_at == all.len(),
        valid_at,
        chosen_at: all.iter().filter(|c| c.chosen == Some(model)).count(),
    }
}

fn stretches(all: &[Choice]) -> Vec<Stretch> {
    all.chunk_by(|a, b| a.chosen == b.chosen && a.needs == b.needs)
        .map(|same| {
            let size = |c: &&Choice| c.audit.map_or(0.0, |a| a.change.abs());
            let worst = same.iter().filter(|c| c.audit.is_some()).max_by(|a, b| size(a).total_cmp(&size(b)));
            Stretch {
                from: same[0].frequency,
                to: same[same.len() - 1].frequency,
                points: same.len(),
                chosen: same[0].chosen,
                needs: same[0].needs.clone(),
                audit: worst.and_then(|c| c.audit),
                worst_at: worst.map(|c| c.frequency),
            }
        })
        .collect()
}
