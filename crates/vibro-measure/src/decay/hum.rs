//! Mains hum near a mode, too weak to be found as a line of its own.
//!
//! Its frequency is known but for a few tenths of a hertz, and it does not decay: so it is told from chance
//! at a lower level than a mode, and fitted beside one whether it is seen or not.

use super::damped::{Damped, SineGroup, Steady, quadratures};
use super::sines::{Sines, decays};
use crate::mains::harmonics;
use nalgebra::{DMatrix, Matrix2, Vector2};
use num_complex::Complex64;

/// Probability with which noise alone passes for hum near a mode.
const BY_CHANCE: f64 = 1e-3;
/// Largest standard uncertainty of the frequency of hum, in lines, that is fitted whether it is seen or not.
const KNOWN: f64 = 0.3;
/// Largest distance of such hum to a mode, in lines that are fitted on either side of that.
const NEAR: f64 = 0.5;
/// Frequencies that are tried in a line.
const FINE: f64 = 4.0;
/// Least distance in lines of two steady lines.
const APART: f64 = 1.0;

impl Sines {
    /// Adds to each group the line of hum nearest to a mode where its frequency is known before, since it
    /// moves the mode long before it is seen, and all further ones that are seen. Whether there is any.
    pub(super) fn add_hum(&mut self, spectrum: &[Complex64]) -> bool {
        for at in 0..self.groups.len() {
            let rest = self.rest(spectrum, Some(at));
            let group = &self.groups[at];
            if let Some(near) = self.nearest(group).and_then(|hum| self.with_hum(group, &rest, hum, 1)) {
                self.groups[at] = near;
            }
            while let Some(more) = self.with_strongest(&self.groups[at], &rest) {
                self.groups[at] = more;
            }
        }
        self.groups.iter().any(|group| !group.hum.is_empty())
    }

    /// The hum nearest to a mode of a group.
    fn nearest(&self, group: &SineGroup) -> Option<Steady> {
        let from = |hum: &Steady| {
            let modes = (0..group.sines.len()).filter(|m| decays(group, *m)).map(|m| &group.sines[m]);
            modes.map(|mode| (mode.periods - hum.nominal).abs() / mode.reach()).fold(f64::INFINITY, f64::min)
        };
        let known = |hum: &Steady| hum.spread < KNOWN && hum.sine.periods == hum.nominal && from(hum) < NEAR;
        self.tried(group).into_iter().filter(known).min_by(|a, b| from(a).total_cmp(&from(b)))
    }

    /// A group fitted again with the strongest further line of hum, if it is seen.
    fn with_strongest(&self, group: &SineGroup, rest: &[Complex64]) -> Option<SineGroup> {
        let tried = self.tried(group);
        let gain = |hum: &Steady| group.gain(hum.sine.periods, self.n);
        let best = tried.iter().copied().max_by(|a, b| gain(a).total_cmp(&gain(b)))?;
        let is_seen = |group: &SineGroup| group.hum.last().is_some_and(|hum| hum.seen);
        self.with_hum(group, rest, best, tried.len()).filter(is_seen)
    }

    /// A group fitted again with `hum`, one line of so many `tried`.
    fn with_hum(
        &self,
        group: &SineGroup,
        rest: &[Complex64],
        hum: Steady,
        tried: usize,
    ) -> Option<SineGroup> {
        let starts: Vec<(f64, f64)> = group.sines.iter().map(|s| (s.periods, s.decay)).collect();
        let hum: Vec<Steady> = group.hum.iter().copied().chain([hum]).collect();
        let mut better = SineGroup::fit(rest, group.lines.clone(), self.n, &starts, &hum).ok()?;
        // The tail of Fisher's distribution of 2 and ν degrees of freedom is (1 + 2F/ν)^(−ν/2).
        let left = better.fit.sum_of_squares() / group.fit.sum_of_squares();
        let chance = left.powf(0.5 * better.fit.degrees_of_freedom() as f64) * tried as f64;
        better.hum.last_mut()?.seen = chance < BY_CHANCE;
        Some(better)
    }

    /// Hum that may be among a group's lines.
    fn tried(&self, group: &SineGroup) -> Vec<Steady> {
        let (duration, noise) = (self.n as f64 / self.rate, group.fit.variance().sqrt());
        let around = |(nominal, tolerance): (f64, f64)| {
            let (nominal, spread) = (nominal * duration, tolerance * duration / f64::sqrt(3.0));
            let steps = (tolerance * duration * FINE).round() as i32;
            let step = tolerance * duration / f64::from(steps.max(1));
            (-steps..=steps).map(move |k| {
                let periods = nominal + f64::from(k) * step;
                let sine = Damped { periods, decay: 0.0, amplitude: Complex64::ZERO };
                Steady { sine, nominal, spread, noise, seen: false }
            })
        };
        // A line that the search has found may be hum, too.
        let found: Vec<f64> = (0..group.sines.len())
            .filter(|m| !decays(group, *m))
            .map(|m| group.sines[m].periods)
            .chain(group.hum.iter().map(|hum| hum.sine.periods))
            .collect();
        let new = |hum: &Steady| found.iter().all(|found| (found - hum.sine.periods).abs() > APART);
        let within = |hum: &Steady| group.lines.contains(&(hum.sine.periods.round() as usize));
        harmonics().flat_map(around).filter(|hum| within(hum) && new(hum)).collect()
    }
}

impl SineGroup {
    /// What a steady sine of these periods takes of the sum of squares, where all other parameters follow to
    /// first order (C. R. Rao's score test).
    fn gain(&self, periods: f64, n: usize) -> f64 {
        let columns = self.lines.clone().map(|k| quadratures(periods, 0.0, k, n));
        let parts = columns.flat_map(|[a, b]| [a.re, b.re, a.im, b.im]);
        let columns = DMatrix::from_row_iterator(2 * self.lines.len(), 2, parts);
        let jacobian = self.fit.jacobian.rows(0, 2 * self.lines.len());
        let own = &columns - jacobian * (&self.fit.cofactor * jacobian.tr_mul(&columns));
        let along = Vector2::from_fn(|i, _| {
            own.column(i).iter().zip(&self.fit.residuals).map(|(own, left)| own * left).sum::<f64>()
        });
        let normal: Matrix2<f64> = (own.transpose() * &own).fixed_view::<2, 2>(0, 0).into_owned();
        normal.try_inverse().map_or(0.0, |inverse| along.dot(&(inverse * along)))
    }
}
