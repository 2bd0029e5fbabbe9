//! Branches of periodic motions over frequency or force, followed through folds, with every border of stability marked.

use super::periodic::{System, ordered};
use super::{PeriodicOrbit, Sine};
use crate::error::{Error, Result};
use nalgebra::{DMatrix, DVector, Matrix4, Matrix6};
use serde::{Deserialize, Serialize};

/// What changes along a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Parameter {
    /// Frequency in Hz.
    Frequency,
    /// Force amplitude in N.
    Force,
}

impl Parameter {
    /// Its value in `sine`.
    pub fn of(self, sine: &Sine) -> f64 {
        match self {
            Parameter::Frequency => sine.frequency,
            Parameter::Force => sine.force,
        }
    }

    fn set(self, sine: &Sine, value: f64) -> Sine {
        match self {
            Parameter::Frequency => Sine { frequency: value, ..*sine },
            Parameter::Force => Sine { force: value, ..*sine },
        }
    }
}

/// What happens to a branch at a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MarkKind {
    /// The branch turns back: a multiplier passes +1.
    Fold,
    /// A multiplier passes −1: motions of twice the period branch off.
    Flip,
    /// A pair of complex multipliers leaves or enters the unit circle.
    NeimarkSacker,
    /// A further contact appears inside a flight, or an impact fades to a touch.
    Grazing,
}

/// A marked motion on a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// What happens there.
    pub kind: MarkKind,
    /// The motion there.
    pub orbit: PeriodicOrbit,
    /// It lies behind the point of this index.
    pub after: usize,
}

/// Why a branch ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// The end of the range asked for.
    Range,
    /// An impact fades to a touch: beyond it its impulse would have to pull.
    Grazing,
    /// It came back to where it started.
    Closed,
    /// No more steps could be made: two impacts meet, or the equations are singular.
    Lost,
    /// The number of points allowed.
    Points,
}

/// Motions along a branch, in its order.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// The parameter that changes.
    pub parameter: Parameter,
    /// Points.
    pub points: Vec<PeriodicOrbit>,
    /// Marks, in order.
    pub marks: Vec<Mark>,
    /// Its two ends.
    pub ends: [End; 2],
}

/// Points at most, each way.
const POINTS: usize = 20_000;
/// Newton's steps of a corrector.
const CORRECTOR: usize = 12;

/// Follows the branch of `start` both ways while the parameter lies in `low..=high`.
///
/// Steps along the branch have at most the length `step` (0.05 is fine), measured in phases (rad), impulses (shares of the gap or
/// amplitude times ω) and the logarithm of the parameter together (pseudo-arclength; H. B. Keller 1977).
///
/// # Errors
/// If the range or the step is impossible or does not hold the start.
pub fn follow(start: &PeriodicOrbit, parameter: Parameter, low: f64, high: f64, step: f64) -> Result<Branch> {
    let value = parameter.of(&start.sine);
    if !(low > 0.0 && high.is_finite() && (low..=high).contains(&value) && step > 1e-6 && step <= 1.0) {
        return Err(Error::usage(
            format!("a branch from {value} within {low} to {high} by steps of {step}"),
            "a range above 0 that holds the start, and a step from 1e-6 to 1",
        ));
    }
    let walk = Walk { start, parameter, low, high, step };
    let origin = walk.point(start)?;
    let mut forth = walk.run(&origin, 1.0)?;
    if forth.end == End::Closed {
        return Ok(Branch { parameter, points: forth.points, marks: forth.marks, ends: [End::Closed; 2] });
    }
    let back = walk.run(&origin, -1.0)?;
    let behind = back.points.len() - 1;
    let mut points: Vec<_> = back.points.into_iter().skip(1).rev().collect();
    points.append(&mut forth.points);
    let mut marks: Vec<Mark> = back
        .marks
        .into_iter()
        .rev()
        .map(|m| Mark { after: (behind - m.after).saturating_sub(1), ..m })
        .collect();
    marks.extend(forth.marks.into_iter().map(|m| Mark { after: m.after + behind, ..m }));
    Ok(Branch { parameter, points, marks, ends: [back.end, forth.end] })
}

struct Walk<'a> {
    start: &'a PeriodicOrbit,
    parameter: Parameter,
    low: f64,
    high: f64,
    step: f64,
}

/// One way along a branch.
struct Way {
    points: Vec<PeriodicOrbit>,
    marks: Vec<Mark>,
    end: End,
}

/// A point of the extended space: unknowns and the logarithm of the parameter; with its tangent.
#[derive(Clone)]
struct Spot {
    z: DVector<f64>,
    tangent: DVector<f64>,
}

impl Walk<'_> {
    fn sine(&self, z: &DVector<f64>) -> Sine {
        self.parameter.set(&self.start.sine, z[z.len() - 1].exp())
    }

    fn system(&self, z: &DVector<f64>) -> Result<System> {
        let mut system = System::new(&self.start.rig, &self.sine(z), self.start.cycles)?;
        // One unit of impulse along the whole branch: that of the gap and the start's frequency.
        system.length = self.length();
        Ok(system)
    }

    /// Length that the branch is measured with.
    fn length(&self) -> f64 {
        let range = self.start.peak_to_peak[0] / 2.0;
        self.start.rig.gap.abs().max(range)
    }

    /// Unknowns without the parameter.
    fn inner(z: &DVector<f64>) -> DVector<f64> {
        z.rows(0, z.len() - 1).into_owned()
    }

    /// What is left of the equations, and the Jacobian with the derivative by the logarithm of the parameter as last column.
    fn evaluate(&self, z: &DVector<f64>) -> Result<(DVector<f64>, DMatrix<f64>)> {
        let n = z.len() - 1;
        let (left, jacobian) = self.system(z)?.evaluate(&Self::inner(z));
        let mut all = DMatrix::zeros(n + 1, n + 1);
        all.view_mut((0, 0), (n, n)).copy_from(&jacobian);
        // Central difference; the corrector's answer does not depend on it.
        let h = 1e-6;
        let at = |shift: f64| -> Result<DVector<f64>> {
            let mut moved = z.clone();
            moved[n] += shift;
            Ok(self.system(&moved)?.evaluate(&Self::inner(z)).0)
        };
        all.view_mut((0, n), (n, 1)).copy_from(&((at(h)? - at(-h)?) / (2.0 * h)));
        Ok((left, all))
    }

    /// Direction of the branch at `z`, forward as seen along `along`.
    fn tangent(&self, z: &DVector<f64>, along: &DVector<f64>) -> Result<Option<DVector<f64>>> {
        let n = z.len() - 1;
        let (_, mut all) = self.evaluate(z)?;
        all.row_mut(n).copy_from(&along.transpose());
        let mut right = DVector::zeros(n + 1);
        right[n] = 1.0;
        let found = all.lu().solve(&right).map(|t| t.normalize());
        Ok(found.filter(|t| t.iter().all(|v| v.is_finite())))
    }

    fn point(&self, orbit: &PeriodicOrbit) -> Result<Spot> {
        let mut z = DVector::zeros(2 * orbit.beats.len() + 1);
        let n = z.len() - 1;
        z[n] = self.parameter.of(&orbit.sine).ln();
        let system = self.system(&z)?;
        z.rows_mut(0, n).copy_from(&orbit.unknowns(&system));
        let mut along = DVector::zeros(n + 1);
        along[n] = 1.0;
        let tangent = self.tangent(&z, &along)?.ok_or_else(|| {
            Error::refused("the branch has no direction at its start: it folds there")
                .hint("start from a motion at another frequency or force")
        })?;
        Ok(Spot { z, tangent })
    }

    /// The point of the branch at the distance `s` along the tangent; `None` where Newton's method does not settle there.
    fn ahead(&self, from: &Spot, s: f64) -> Option<(Spot, usize)> {
        let mut z = &from.z + &from.tangent * s;
        let n = z.len() - 1;
        for k in 0..CORRECTOR {
            let (left, mut all) = self.evaluate(&z).ok()?;
            all.row_mut(n).copy_from(&from.tangent.transpose());
            let mut right = DVector::zeros(n + 1);
            right.rows_mut(0, n).copy_from(&left);
            right[n] = from.tangent.dot(&(&z - &from.z)) - s;
            let step = all.lu().solve(&right)?;
            z -= &step;
            if !z.iter().all(|v| v.is_finite()) {
                return None;
            }
            if step.amax() < 1e-10 {
                // One more step would double the digits; this one has done so.
                let tangent = self.tangent(&z, &from.tangent).ok()??;
                return Some((Spot { z, tangent }, k + 1));
            }
        }
        None
    }

    fn orbit(&self, z: &DVector<f64>) -> Result<PeriodicOrbit> {
        let system = self.system(z)?;
        Ok(PeriodicOrbit::build(&system, self.sine(z), self.start.cycles, &Self::inner(z)))
    }

    fn run(&self, origin: &Spot, sign: f64) -> Result<Way> {
        let mut here = Spot { z: origin.z.clone(), tangent: &origin.tangent * sign };
        let mut way = Way { points: vec![self.orbit(&here.z)?], marks: Vec::new(), end: End::Points };
        let mut s = self.step / 4.0;
        let n = here.z.len() - 1;
        while way.points.len() < POINTS {
            let Some((next, effort)) = self.ahead(&here, s).filter(|(next, _)| {
                // A sharp bend: the step may have landed on another branch.
                next.tangent.dot(&here.tangent) > 0.8
            }) else {
                s /= 2.0;
                if s < 1e-7 {
                    way.end = End::Lost;
                    return Ok(way);
                }
                continue;
            };
            let value = next.z[n].exp();
            let faded = (n / 2..n).any(|k| next.z[k] <= 0.0);
            let outside = value < self.low || value > self.high;
            if faded || outside {
                // The end is where the impulse is zero or the parameter at its bound.
                let bound = if value < self.low { self.low.ln() } else { self.high.ln() };
                let distance = |spot: &Spot| {
                    if faded {
                        spot.z.rows(n / 2, n / 2).min()
                    } else if value < self.low {
                        spot.z[n] - bound
                    } else {
                        bound - spot.z[n]
                    }
                };
                if let Some(last) = self.locate(&here, s, &distance) {
                    let orbit = self.orbit(&last.z)?;
                    if faded {
                        let after = way.points.len() - 1;
                        way.marks.push(Mark { kind: MarkKind::Grazing, orbit: orbit.clone(), after });
                    }
                    way.points.push(orbit);
                }
                way.end = if faded { End::Grazing } else { End::Range };
                return Ok(way);
            }
            if !ordered(&self.system(&next.z)?, &Self::inner(&next.z)) {
                way.end = End::Lost;
                return Ok(way);
            }
            let orbit = self.orbit(&next.z)?;
            self.mark(&here, &next, s, &mut way, &orbit)?;
            way.points.push(orbit);
            let round = (&next.z - &origin.z).norm();
            if way.points.len() > 8 && round < s && next.tangent.dot(&origin.tangent) * sign > 0.9 {
                way.end = End::Closed;
                return Ok(way);
            }
            here = next;
            s = match effort {
                0..=4 => (s * 1.4).min(self.step),
                5..=6 => s,
                _ => s / 2.0,
            };
        }
        Ok(way)
    }

    /// Enters what changed between two points, in their order.
    fn mark(&self, here: &Spot, next: &Spot, s: f64, way: &mut Way, orbit: &PeriodicOrbit) -> Result<()> {
        let n = here.z.len() - 1;
        let last = &way.points[way.points.len() - 1];
        let after = way.points.len() - 1;
        let mut found: Vec<(MarkKind, Spot)> = Vec::new();
        if here.tangent[n] * next.tangent[n] < 0.0
            && let Some(spot) = self.locate(here, s, &|spot: &Spot| spot.tangent[n])
        {
            found.push((MarkKind::Fold, spot));
        }
        let of = |test: fn(&PeriodicOrbit) -> Option<f64>| {
            move |spot: &Spot| self.orbit(&spot.z).ok().and_then(|o| test(&o)).unwrap_or(f64::NAN)
        };
        let tests: [(MarkKind, fn(&PeriodicOrbit) -> Option<f64>); 3] =
            [(MarkKind::Flip, flip), (MarkKind::NeimarkSacker, pair), (MarkKind::Grazing, clearance)];
        for (kind, test) in tests {
            let (Some(a), Some(b)) = (test(last), test(orbit)) else { continue };
            if a * b < 0.0
                && let Some(spot) = self.locate(here, s, &of(test))
            {
                found.push((kind, spot));
            }
        }
        found.sort_by(|a, b| {
            let along = |spot: &Spot| here.tangent.dot(&(&spot.z - &here.z));
            along(&a.1).total_cmp(&along(&b.1))
        });
        for (kind, spot) in found {
            let orbit = self.orbit(&spot.z)?;
            if confirmed(kind, &orbit) {
                way.marks.push(Mark { kind, orbit, after });
            }
        }
        Ok(())
    }

    /// The point within `s` ahead of `here` where `test` changes its sign, by bisection with false position.
    fn locate(&self, here: &Spot, s: f64, test: &dyn Fn(&Spot) -> f64) -> Option<Spot> {
        let (mut low, mut high) = (0.0, s);
        let (mut at_low, mut at_high) = (test(here), test(&self.ahead(here, s)?.0));
        let mut best = None;
        for k in 0..60 {
            // False position, every third time the middle.
            let share = at_low / (at_low - at_high);
            let share = if k % 3 == 2 || !share.is_finite() { 0.5 } else { share.clamp(0.01, 0.99) };
            let middle = low + share * (high - low);
            let spot = self.ahead(here, middle)?.0;
            let value = test(&spot);
            if !value.is_finite() {
                return best;
            }
            best = Some(spot);
            if (value < 0.0) == (at_low < 0.0) {
                (low, at_low) = (middle, value);
            } else {
                (high, at_high) = (middle, value);
            }
            if value == 0.0 || high - low < 1e-11 {
                break;
            }
        }
        best
    }
}

/// det(M + I): changes its sign where a multiplier passes −1.
fn flip(orbit: &PeriodicOrbit) -> Option<f64> {
    orbit.monodromy.map(|m| (m + Matrix4::identity()).determinant())
}

/// det(M ∧ M − I), the product of λᵢλⱼ − 1 over all pairs of multipliers: changes its sign where a complex pair passes the unit circle
/// (bialternate product; J. Guckenheimer, M. Myers, B. Sturmfels 1997), and where two real multipliers become each other's inverse.
fn pair(orbit: &PeriodicOrbit) -> Option<f64> {
    const PAIRS: [(usize, usize); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    let m = orbit.monodromy?;
    let wedge = Matrix6::from_fn(|r, c| {
        let ((i, j), (k, l)) = (PAIRS[r], PAIRS[c]);
        m[(i, k)] * m[(j, l)] - m[(i, l)] * m[(j, k)]
    });
    Some((wedge - Matrix6::identity()).determinant())
}

/// Whether the motion found is what the mark says, not a step of a test.
fn confirmed(kind: MarkKind, orbit: &PeriodicOrbit) -> bool {
    let near = |distance: &dyn Fn(&num_complex::Complex64) -> f64| {
        orbit.multipliers.is_some_and(|m| m.iter().any(|z| distance(z) < 1e-5))
    };
    match kind {
        MarkKind::Fold => true,
        MarkKind::Flip => near(&|z| (z + 1.0).norm()),
        MarkKind::NeimarkSacker => {
            near(&|z| if z.im.abs() > 1e-6 { (z.norm() - 1.0).abs() } else { f64::INFINITY })
        }
        MarkKind::Grazing => clearance(orbit).is_some_and(|c| c.abs() < 1e-6 * orbit.peak_to_peak[0]),
    }
}

/// Smallest gap inside the flights.
fn clearance(orbit: &PeriodicOrbit) -> Option<f64> {
    orbit.validity.clearance
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Orbit, Rig, Validity, orbits};
    use std::f64::consts::TAU;

    fn one(rig: &Rig, force: f64, frequency: f64) -> PeriodicOrbit {
        let orbit = orbits(rig, force, frequency).unwrap().orbits[0];
        PeriodicOrbit::near(rig, &Sine { force, frequency }, 1, &[(orbit.force_phase, orbit.impulse)])
            .unwrap()
    }

    #[test]
    fn the_branch_of_one_impact_a_cycle_is_the_closed_form_through_its_folds() {
        let mut folds = 0;
        for (force, frequency, restitution) in [(0.5, 11.0, 0.7), (0.05, 6.8, 1.0), (0.1, 6.0, 0.9)] {
            let rig = Rig { restitution, ..Rig::thesis() };
            let branch = follow(&one(&rig, force, frequency), Parameter::Frequency, 3.0, 20.0, 0.05).unwrap();
            for point in &branch.points {
                let beat = point.beats[0];
                if beat.impulse < 1e-9 {
                    continue;
                }
                let closed = orbits(&rig, force, point.sine.frequency).unwrap().orbits;
                let off = |o: &Orbit| (o.impulse / beat.impulse - 1.0).abs();
                let off = closed.iter().map(off).fold(f64::INFINITY, f64::min);
                // Newton's last step is below 1e-10 and squares; near a fold roundings are enlarged by the sensitivity.
                let amplified = 1.0 + point.peak_to_peak[0] / point.validity.grazing_distance.max(1e-12);
                assert!(off < 1e-12 * amplified, "{off} {beat:?} at {}", point.sine.frequency);
            }
            // Folds are where the closed form gains or loses both roots.
            for fold in branch.marks.iter().filter(|m| m.kind == MarkKind::Fold) {
                let f = fold.orbit.sine.frequency;
                let roots = |f: f64| orbits(&rig, force, f).unwrap().orbits.len();
                assert_ne!(roots(f * (1.0 - 1e-9)), roots(f * (1.0 + 1e-9)), "{f}");
                folds += 1;
            }
        }
        assert!(folds > 1, "{folds}");
    }

    #[test]
    fn losses_of_stability_are_marked_where_multipliers_pass_the_circle() {
        // Golden: F₀ 0.9 N, R 1, ν 1.2 has the multiplier −1.326; F₀ 0.05 N, R 1, ν 1.3 the pair 0.389 ± 1.047i.
        let rig = Rig { restitution: 1.0, ..Rig::thesis() };
        let at = |nu: f64| nu * (rig.k1 / rig.m1).sqrt() / TAU;
        for (force, nu, kind) in [(0.9, 1.2, MarkKind::Flip), (0.05, 1.3, MarkKind::NeimarkSacker)] {
            let branch =
                follow(&one(&rig, force, at(nu)), Parameter::Frequency, at(1.02), at(2.6), 0.03).unwrap();
            let marks: Vec<_> = branch.marks.iter().filter(|m| m.kind == kind).collect();
            assert!(!marks.is_empty());
            for mark in marks {
                let multipliers = mark.orbit.multipliers.unwrap();
                let near = multipliers.iter().map(|m| match kind {
                    MarkKind::Flip => (m + 1.0).norm(),
                    _ => (m.norm() - 1.0).abs(),
                });
                assert!(near.fold(1.0, f64::min) < 1e-6, "{multipliers:?}");
            }
        }
    }

    #[test]
    fn branches_over_the_force_and_bad_requests() {
        let rig = Rig::thesis();
        let start = one(&rig, 0.5, 11.0);
        let branch = follow(&start, Parameter::Force, 0.01, 2.0, 0.05).unwrap();
        for point in &branch.points {
            let real = |v: &Validity| v.exists;
            assert!(real(&point.validity) || point.beats[0].impulse < 1e-9, "{point:?}");
        }
        assert!(branch.points.len() > 10);
        for (low, high, step) in [(0.6, 2.0, 0.05), (0.0, 2.0, 0.05), (0.1, f64::NAN, 0.05), (0.1, 2.0, 0.0)]
        {
            assert!(follow(&start, Parameter::Force, low, high, step).is_err());
        }
    }
}
