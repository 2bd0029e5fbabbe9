//! Estimators of what is measured, on records with a known truth.
//!
//! What people write by hand ([`rivals`]) stands beside the toolkit's own methods, over the same random records of fixed seeds. Errors are root mean
//! squares, so that they compare with the Cramér–Rao bound of the standard deviation.

mod bound;
mod damping;
mod impacts;
mod integration;
mod pulse;
mod rate;
pub mod rivals;
mod sine;
mod trial;

pub use bound::bounds;
pub use rate::Rate;

use super::measured::front;
use super::watched::side_by_side;
use super::{FailureMap, Family, Scene};
use trial::{Task, Tried};
use vibro_record::Result;

/// Every scene of the estimators, each method measured; `quick` takes fewer records.
///
/// # Errors
/// None today: every scene can be built.
pub fn scenes(quick: bool, progress: &mut dyn FnMut(&str)) -> Result<Vec<Scene>> {
    type Part = (&'static str, fn(bool) -> Vec<Scene>);
    let parts: [Part; 5] = [
        ("sines", sine::scenes),
        ("integration", integration::scenes),
        ("damping", damping::scenes),
        ("impacts", impacts::scenes),
        ("pulses", pulse::scenes),
    ];
    let mut all = Vec::new();
    for (name, scenes) in parts {
        progress(name);
        all.extend(scenes(quick));
    }
    for scene in &mut all {
        front(scene.family, &mut scene.methods);
    }
    Ok(all)
}

/// What the estimators do at their borders; `quick` takes fewer records.
///
/// An answer is right within three of its standard uncertainties; one without an uncertainty within what is the same for all methods of a
/// border: half a line for a frequency, 5 % for an amplitude, 10 % for a damping ratio, 1 % for an impact frequency, 0.02 for ξ. It is
/// refused where it is withheld, where it states no uncertainty and says so, and where its uncertainty is more than what is allowed. No doubt excuses
/// an uncertainty that is stated. A method is wrong where more answers are off than chance allows, or one by more than 5.2 standard uncertainties: limits that methods
/// whose errors are as they state them pass in fewer than one of a hundred full maps.
///
/// # Errors
/// None today: every scene can be built.
pub fn failures(quick: bool) -> Result<FailureMap> {
    Ok(failures_and_rates(quick)?.0)
}

/// As [`failures`], and how often each method's answers are further off than they state, at all borders together.
///
/// # Errors
/// None today: every scene can be built.
pub fn failures_and_rates(quick: bool) -> Result<(FailureMap, Vec<Rate>)> {
    let tried = side_by_side(tasks(quick));
    let mut rates: Vec<Rate> = Vec::new();
    for Tried { cell, judged, beyond } in &tried {
        match rates.iter_mut().find(|r| r.method == cell.method && r.ours == cell.ours) {
            Some(rate) => {
                rate.judged += judged;
                rate.beyond += beyond;
            }
            None => rates.push(Rate {
                method: cell.method.clone(),
                ours: cell.ours,
                judged: *judged,
                beyond: *beyond,
            }),
        }
    }
    let cells = tried.into_iter().map(|t| t.cell).collect();
    Ok((FailureMap { family: Family::Estimators, cells }, rates))
}

fn tasks(quick: bool) -> Vec<Task> {
    let parts: [fn(bool) -> Vec<Task>; 5] = [
        sine::cells_of_sines,
        integration::cells_of_integration,
        damping::cells_of_damping,
        impacts::cells_of_impacts,
        pulse::cells_of_pulses,
    ];
    parts.iter().flat_map(|part| part(quick)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Outcome;
    use super::*;

    #[test]
    fn the_limits_of_the_map_are_made_for_as_many_cells_as_it_has() {
        let cells = tasks(false).len();
        assert!(cells <= trial::CELLS && 2 * cells > trial::CELLS, "{cells}");
    }

    /// The whole map takes long: here the borders of one quantity stand for it.
    #[test]
    fn displacements_are_right_or_refused_at_their_borders() {
        let tried = side_by_side(integration::cells_of_integration(true));
        let ours: Vec<_> = tried.iter().map(|t| &t.cell).filter(|c| c.ours).collect();
        let kept = |c: &super::super::Cell| {
            matches!(c.outcome, Outcome::Right | Outcome::Refused | Outcome::NotAsked)
        };
        assert!(ours.iter().all(|c| kept(c)), "{ours:?}");
        let right = |ours: bool| {
            tried.iter().filter(|t| t.cell.ours == ours && t.cell.outcome == Outcome::Right).count()
        };
        // Neither a map of refusals nor a check that all methods pass.
        assert!(right(true) > 10, "{ours:?}");
        assert!(tried.iter().any(|t| !t.cell.ours && t.cell.outcome == Outcome::Wrong));
    }

    #[test]
    fn a_scene_is_measured_with_its_bound() {
        for scene in integration::scenes(true) {
            assert!(scene.bound.is_some_and(|b| b > 0.0), "{}", scene.name);
            assert!(scene.methods.iter().all(|m| m.time_ns > 0.0 && m.error.is_some() != m.failed));
            assert!(scene.methods.iter().any(|m| m.ours && !m.failed));
        }
    }
}
