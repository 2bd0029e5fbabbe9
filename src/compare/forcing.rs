//! The force at each point of a sweep.

use crate::error::{Error, Result};
use crate::measure::response::{Response, ResponsePoint};
use crate::record::{Finding, median, sort_by_number};
use crate::units::notation::significant;

/// Force amplitude over excitation frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Forcing {
    /// Frequency in Hz and force amplitude in N of each point, by rising frequency; a single pair where the
    /// force is the same for all points.
    points: Vec<(f64, f64)>,
    /// Whether the force was measured at each point.
    measured: bool,
}

/// Largest ratio between forces of one level that are next to each other by size. A shaker's force drops by
/// less at a resonance, and chosen levels differ by more.
const LEVEL: f64 = 1.2;
/// Relative difference between measured and stated force above which a caution is given: load cells err by
/// 1 or 2 %.
const DIFFERS: f64 = 0.05;

impl Forcing {
    /// One force in N for all points.
    pub fn constant(force: f64) -> Forcing {
        Forcing { points: vec![(0.0, force)], measured: false }
    }

    /// The measured force of a sweep, where it was measured.
    pub fn measured(response: &Response) -> Option<Forcing> {
        let points = response.points.iter().filter_map(|p| Some((p.excitation, p.force?)));
        let mut points: Vec<(f64, f64)> = points.collect();
        sort_by_number(&mut points, |a| a.0);
        (!points.is_empty()).then_some(Forcing { points, measured: true })
    }

    /// The force of each response, with findings: the stated force for all, else the measured force of each.
    /// A sweep without a measured force takes the median of all measured forces.
    ///
    /// # Errors
    /// If no force is stated and none was measured.
    pub(super) fn of_all(
        stated: Option<f64>,
        responses: &[&Response],
    ) -> Result<(Vec<Forcing>, Vec<Finding>)> {
        let all = || responses.iter().flat_map(|r| &r.points).filter_map(|p| p.force);
        let ((low, high), median) = (range(all()), median(all()));
        if let Some(stated) = stated {
            let part = (low / stated - 1.0).abs().max((high / stated - 1.0).abs());
            let differs = (part.is_finite() && part > DIFFERS).then(|| {
                let differs = Finding::caution("stated-force-differs").number("stated", stated);
                differs.number("median", median).number("part", part)
            });
            return Ok((vec![Forcing::constant(stated); responses.len()], differs.into_iter().collect()));
        }
        if median.is_nan() {
            return Err(Error::refused("the force is neither stated nor measured")
                .hint("state `excitation.force` in N in the campaign"));
        }
        let measured = Finding::note("force-as-measured").number("low", low);
        let alike = significant(low, 3) == significant(high, 3);
        let mut findings = vec![if alike { measured } else { measured.number("high", high) }];
        let own = |r: &&Response| {
            Forcing::measured(r).unwrap_or_else(|| {
                findings.push(Finding::caution("force-not-measured").about(&r.name).number("median", median));
                Forcing::constant(median)
            })
        };
        let forcings = responses.iter().map(own).collect();
        Ok((forcings, findings))
    }

    /// Mean of several forcings over frequency; `None` without any.
    pub fn mean(of: &[&Forcing]) -> Option<Forcing> {
        let [first, others @ ..] = of else { return None };
        if others.iter().all(|o| o == first) {
            return Some((*first).clone());
        }
        let mean = |f: f64| of.iter().map(|o| o.at(f)).sum::<f64>() / of.len() as f64;
        let points = of.iter().filter(|o| o.measured).flat_map(|o| &o.points);
        let mut points: Vec<(f64, f64)> = points.map(|p| (p.0, mean(p.0))).collect();
        sort_by_number(&mut points, |a| a.0);
        if points.is_empty() {
            return Some(Forcing::constant(mean(0.0)));
        }
        Some(Forcing { points, measured: true })
    }

    /// Force in N at a frequency in Hz, linear between points and constant beyond the last.
    pub fn at(&self, frequency: f64) -> f64 {
        let below = self.points.partition_point(|p| p.0 < frequency);
        match self.points.split_at(below) {
            ([.., a], [b, ..]) => a.1 + (b.1 - a.1) * (frequency - a.0) / (b.0 - a.0),
            ([.., only], []) | ([], [only, ..]) => only.1,
            ([], []) => f64::NAN,
        }
    }

    /// Force in N of a point of the sweep, and its standard uncertainty in N: 0 where the force is stated or
    /// taken from other points, or its uncertainty is not known.
    pub(super) fn of(&self, point: &ResponsePoint) -> (f64, f64) {
        match point.force {
            Some(force) if self.measured => (force, point.force_std.unwrap_or(0.0)),
            _ => (self.at(point.excitation), 0.0),
        }
    }

    /// Median of the force in N.
    pub fn median(&self) -> f64 {
        median(self.points.iter().map(|p| p.1))
    }
}

/// Smallest and largest value; (∞, −∞) without values.
pub(super) fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// Levels of force in the order of their first sweep, as indices into `forces`, the median force of each
/// sweep where it is known.
///
/// The forces are sorted by size and split where one is more than 1.2 times the one before, so the order of
/// the sweeps does not matter. A sweep of unknown force belongs to the first level.
pub fn levels(forces: &[Option<f64>]) -> Vec<Vec<usize>> {
    let mut known: Vec<(f64, usize)> =
        forces.iter().enumerate().filter_map(|(i, force)| Some(((*force)?, i))).collect();
    sort_by_number(&mut known, |a| a.0);
    let split = known.chunk_by(|a, b| b.0 <= LEVEL * a.0);
    let mut levels: Vec<Vec<usize>> = split.map(|level| level.iter().map(|(_, i)| *i).collect()).collect();
    for level in &mut levels {
        level.sort_unstable();
    }
    levels.sort_unstable();
    if levels.is_empty() && !forces.is_empty() {
        levels.push(Vec::new());
    }
    if let Some(first) = levels.first_mut() {
        first.extend((0..forces.len()).filter(|i| forces[*i].is_none()));
        first.sort_unstable();
    }
    levels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measured_force_is_linear_between_its_points() {
        let forcing =
            Forcing { points: vec![(4.0, 0.1), (6.0, 0.2), (6.0, 0.3), (8.0, 0.3)], measured: true };
        let at: Vec<f64> = [3.0, 4.0, 5.0, 6.0, 7.0, 9.0].map(|f| forcing.at(f)).to_vec();
        // 0.1 + 0.1/2 is rounded once more than 0.15.
        assert!((at[2] - 0.15).abs() < 1e-16, "{at:?}");
        assert_eq!((at[0], at[1], at[3], at[4], at[5]), (0.1, 0.1, 0.2, 0.3, 0.3));
        let mean = Forcing::mean(&[&forcing, &Forcing::constant(0.5)]).unwrap();
        assert!((mean.at(5.0) - 0.325).abs() < 1e-15);
        assert_eq!(Forcing::mean(&[&forcing, &forcing]), Some(forcing));
    }

    #[test]
    fn levels_are_told_apart_by_a_fifth() {
        let forces = [Some(0.1), Some(0.2), Some(0.105), None, Some(0.19)];
        assert_eq!(levels(&forces), [vec![0, 2, 3], vec![1, 4]]);
        assert_eq!(levels(&[None, Some(2.0), Some(3.0)]), [vec![0, 1], vec![2]]);
        assert!(levels(&[]).is_empty());
        assert_eq!(levels(&[None, None]), [vec![0, 1]]);
    }

    #[test]
    fn levels_do_not_depend_on_the_order_of_sweeps() {
        for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let forces = |all: [f64; 3]| order.map(|i: usize| Some(all[i]));
            assert_eq!(levels(&forces([1.0, 1.15, 1.3])).len(), 1, "{order:?}");
            let split = levels(&forces([1.0, 1.15, 1.5]));
            let alone = order.iter().position(|i| *i == 2).unwrap();
            assert_eq!(split.len(), 2, "{order:?}");
            assert!(split.contains(&vec![alone]), "{order:?}: {split:?}");
        }
    }
}
