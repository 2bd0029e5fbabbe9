//! A frequency response function before its modes are known.

use super::sweep;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::modal::Measured;
use crate::measure::response::{Response, ResponseOptions};
use crate::record::{Finding, Meta, Record, sort_by_number, upper_median};
use crate::units::{Quantity, Unit};
use num_complex::Complex64;

/// A frequency response function, ready for the search for modes.
#[derive(Debug, Clone)]
pub struct Function {
    /// Its name, unit and history.
    pub meta: Meta,
    /// Its lines.
    pub measured: Measured,
    /// Records of its lines and their coherence, where it was computed.
    pub(super) records: Vec<Record>,
    /// Cautions on points left out.
    pub(super) findings: Vec<Finding>,
    /// Whether a doubt is about its lines, and so about modes fitted to them.
    pub(super) in_doubt: bool,
}

impl Function {
    pub(super) fn new(meta: Meta, measured: Measured) -> Function {
        Function { meta, measured, records: Vec::new(), findings: Vec::new(), in_doubt: false }
    }

    /// The receptance of a sweep of a campaign; of its only sweep where `name` is `None`.
    ///
    /// # Errors
    /// If there is no such sweep, it cannot be read, or has no receptance.
    pub fn of_sweep(campaign: &Campaign, name: Option<&str>) -> Result<Function> {
        let compute = &campaign.compute;
        let options = ResponseOptions { band: compute.peak_lines, integrate: None, fmin: compute.fmin };
        let (_, response) = sweep::named(campaign, name)?.sweep_and_response(&options)?;
        Function::of_response(&response)
    }

    /// The receptance of a response, by rising frequency; without phases, its magnitude. Left out are
    /// points on both sides of a jump, and points of a complex receptance without an uncertainty.
    ///
    /// # Errors
    /// If the response is no displacement, or the force is not known.
    pub fn of_response(response: &Response) -> Result<Function> {
        let beside = |f: f64| response.jumps.iter().any(|jump| f == jump.from || f == jump.to);
        let phased = response.points.iter().any(|p| p.receptance.is_some());
        let displacement = response.unit == Quantity::Displacement.symbol();
        let mut points: Vec<(f64, Complex64, f64)> = Vec::new();
        let (mut at_jumps, mut doubted) = (Vec::new(), Vec::new());
        for point in &response.points {
            let f = point.excitation;
            if beside(f) {
                at_jumps.push(f);
            } else if let Some(ratio) = point.receptance {
                match ratio.std.filter(|std| *std > 0.0) {
                    Some(std) => points.push((f, Complex64::new(ratio.re, ratio.im), std)),
                    None => doubted.push(f),
                }
            } else if let Some(force) = point.force.filter(|_| displacement && !phased) {
                points.push((f, Complex64::from(point.amplitude.value / force), f64::NAN));
            }
        }
        points.retain(|(_, value, _)| value.is_finite());
        if points.is_empty() {
            let why = format!("the sweep {:?} has no receptance", response.name);
            return Err(Error::refused(why)
                .hint("a receptance needs the force of each step, and a displacement as response"));
        }
        sort_by_number(&mut points, |a| a.0);
        points.dedup_by(|a, b| a.0 == b.0);
        let frequency = points.iter().map(|p| p.0).collect();
        let values = points.iter().map(|p| p.1).collect();
        let std = phased.then(|| pooled(&points.iter().map(|p| p.2).collect::<Vec<f64>>()));
        let mut meta = Meta::new(response.name.clone(), Unit::parse_or_opaque("m/N"));
        meta.history.clone_from(&response.history);
        meta.quantity = meta.unit.quantity();
        let measured = Measured::new(frequency, values, Quantity::Receptance);
        let measured = Measured { magnitude_only: !phased, std, ..measured };
        let left_out = [("modal-sweep-jumps", at_jumps), ("modal-sweep-doubted", doubted)];
        let left_out = left_out.into_iter().filter(|(_, at)| !at.is_empty());
        let found = |(code, at): (_, Vec<f64>)| {
            Finding::caution(code).count("n", at.len()).numbers("frequencies", at)
        };
        let findings = left_out.map(found).collect();
        Ok(Function { findings, ..Function::new(meta, measured) })
    }
}

/// Raises each uncertainty to at least the median of the five around it: each comes from a few blocks, and
/// one that is small by chance would dominate the fit.
fn pooled(std: &[f64]) -> Vec<f64> {
    let around = |i: usize| upper_median(&mut std[i.saturating_sub(2)..(i + 3).min(std.len())].to_vec());
    (0..std.len()).map(|i| std[i].max(around(i))).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn an_uncertainty_that_is_small_by_chance_is_that_of_its_neighbours() {
        assert_eq!(super::pooled(&[1.0, 0.01, 2.0, 1.0, 9.0]), [1.0, 1.0, 2.0, 2.0, 9.0]);
        assert!(super::pooled(&[]).is_empty());
    }
}
