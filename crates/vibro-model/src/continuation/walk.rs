//! Continuation along a branch, by predictor and corrector.

use super::{End, Mark};
use crate::excitation::Sine;
use crate::orbit::Loss;
use crate::parameter::Parameter;
use crate::periodic::PeriodicOrbit;
use crate::periodic::{System, ordered};
use crate::rig::Rig;
use nalgebra::{DMatrix, DVector, Matrix4, Matrix6};
use num_complex::Complex64;
use vibro_record::{Error, Result};

/// Most points of a branch in each direction.
const MOST_POINTS: usize = 20_000;
/// Most Newton steps of a corrector.
const CORRECTOR_STEPS: usize = 12;
/// Largest difference in phase (rad) and relative impulse at which the two halves of a doubled period count
/// as equal, as they are at a flip. Branches cross at a flip, so the equations are nearly singular and the
/// flip is located only roughly.
const EQUAL_HALVES: f64 = 1e-2;

/// Start of a continuation, the varied parameter `over` with its range, and the largest step along the
/// branch.
pub struct Walk<'a> {
    pub start: &'a PeriodicOrbit,
    pub over: Parameter,
    pub low: f64,
    pub high: f64,
    pub step: f64,
}

/// The branch in one direction, with the marks of its changes and the reason of its end.
pub struct BranchPart {
    pub points: Vec<PeriodicOrbit>,
    pub marks: Vec<Mark>,
    pub end: End,
}

/// A point of a branch in the extended space (unknowns, then the coordinate of the varied parameter), with
/// the tangent of the branch.
#[derive(Clone)]
pub struct BranchPoint {
    z: DVector<f64>,
    tangent: DVector<f64>,
}

impl Walk<'_> {
    /// Coordinate of a value of the varied parameter: its logarithm; the gap divided by the length scale of
    /// the branch; or the restitution itself.
    fn coordinate(&self, value: f64) -> f64 {
        match self.over {
            Parameter::Gap => value / self.length(),
            Parameter::Restitution => value,
            _ => value.ln(),
        }
    }

    /// The value at a coordinate.
    fn value(&self, coordinate: f64) -> f64 {
        match self.over {
            Parameter::Gap => coordinate * self.length(),
            Parameter::Restitution => coordinate,
            _ => coordinate.exp(),
        }
    }

    /// Rig and force at `z`.
    fn scene(&self, z: &DVector<f64>) -> (Rig, Sine) {
        let (mut rig, mut sine) = (self.start.rig, self.start.sine);
        let (least, most) = self.over.limits();
        // A Newton step may leave the allowed range; the value in the rig is kept within it.
        let value = self.value(z[z.len() - 1]).clamp(least, most);
        match self.over {
            Parameter::Frequency => sine.frequency = value,
            Parameter::Force => sine.force = value,
            other => {
                if let Some(place) = other.place(&mut rig) {
                    *place = value;
                }
            }
        }
        (rig, sine)
    }

    fn system(&self, z: &DVector<f64>) -> Result<System> {
        let (rig, sine) = self.scene(z);
        let mut system = System::new(&rig, &sine, self.start.cycles)?;
        if self.over == Parameter::Restitution {
            // The equations also hold for restitutions outside 0 to 1.
            system.contact = 1.0 / Rig { restitution: z[z.len() - 1], ..rig }.exchange();
        }
        // The length scale of the start, constant along the branch.
        system.length = self.length();
        Ok(system)
    }

    /// Length scale of the branch in m: the gap or the amplitude of x₁, whichever is larger.
    fn length(&self) -> f64 {
        let range = self.start.peak_to_peak[0] / 2.0;
        self.start.rig.gap.abs().max(range)
    }

    /// Unknowns without the coordinate of the varied parameter.
    fn inner(z: &DVector<f64>) -> DVector<f64> {
        z.rows(0, z.len() - 1).into_owned()
    }

    /// Residuals of the equations, and their Jacobian. Its last column is the derivative with respect to the
    /// coordinate of the varied parameter.
    fn evaluate(&self, z: &DVector<f64>) -> Result<(DVector<f64>, DMatrix<f64>)> {
        let n = z.len() - 1;
        let (left, jacobian) = self.system(z)?.evaluate(&Self::inner(z));
        let mut all = DMatrix::zeros(n + 1, n + 1);
        all.view_mut((0, 0), (n, n)).copy_from(&jacobian);
        // Central difference. Its error slows the corrector's convergence, but does not change the result.
        let h = 1e-6;
        let at = |place: f64| -> Result<DVector<f64>> {
            let mut moved = z.clone();
            moved[n] = place;
            Ok(self.system(&moved)?.evaluate(&Self::inner(z)).0)
        };
        all.view_mut((0, n), (n, 1)).copy_from(&((at(z[n] + h)? - at(z[n] - h)?) / (2.0 * h)));
        Ok((left, all))
    }

    /// Unit tangent of the branch at `z`, in the direction of `along`.
    fn tangent(&self, z: &DVector<f64>, along: &DVector<f64>) -> Result<Option<DVector<f64>>> {
        let n = z.len() - 1;
        let (_, mut all) = self.evaluate(z)?;
        all.row_mut(n).copy_from(&along.transpose());
        let mut right = DVector::zeros(n + 1);
        right[n] = 1.0;
        let found = all.lu().solve(&right).map(|t| t.normalize());
        Ok(found.filter(|t| t.iter().all(|v| v.is_finite())))
    }

    /// The point of `orbit` on the branch, with the direction in which the varied parameter grows.
    ///
    /// # Errors
    /// If the branch folds there.
    pub fn point(&self, orbit: &PeriodicOrbit) -> Result<BranchPoint> {
        let mut z = DVector::zeros(2 * orbit.beats.len() + 1);
        let n = z.len() - 1;
        z[n] = self.coordinate(self.over.of(&orbit.rig, &orbit.sine));
        let system = self.system(&z)?;
        z.rows_mut(0, n).copy_from(&system.unknowns(&orbit.pairs()));
        let mut along = DVector::zeros(n + 1);
        along[n] = 1.0;
        let tangent = self.tangent(&z, &along)?.ok_or_else(|| {
            Error::refused("the branch has no direction at its start: it folds there")
                .hint("start from another value")
        })?;
        Ok(BranchPoint { z, tangent })
    }

    /// The point of the branch at the distance `s` along the tangent, and the number of Newton steps; `None`
    /// where Newton's method does not converge.
    fn ahead(&self, from: &BranchPoint, s: f64) -> Option<(BranchPoint, usize)> {
        let mut z = &from.z + &from.tangent * s;
        let n = z.len() - 1;
        for k in 0..CORRECTOR_STEPS {
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
                // Newton's method doubles the digits with each step: this one is exact to rounding.
                let tangent = self.tangent(&z, &from.tangent).ok()??;
                return Some((BranchPoint { z, tangent }, k + 1));
            }
        }
        None
    }

    fn orbit(&self, z: &DVector<f64>) -> Result<PeriodicOrbit> {
        let system = self.system(z)?;
        Ok(PeriodicOrbit::build(&system, self.scene(z).1, self.start.cycles, &Self::inner(z)))
    }

    /// Follows the branch from `origin`, forward (1) or backward (−1), to its end.
    ///
    /// # Errors
    /// If a motion on the branch cannot be computed.
    pub fn run(&self, origin: &BranchPoint, sign: f64) -> Result<BranchPart> {
        let mut here = BranchPoint { z: origin.z.clone(), tangent: &origin.tangent * sign };
        let mut branch =
            BranchPart { points: vec![self.orbit(&here.z)?], marks: Vec::new(), end: End::Points };
        let mut s = self.step / 4.0;
        let n = here.z.len() - 1;
        while branch.points.len() < MOST_POINTS {
            let Some((next, effort)) = self.ahead(&here, s).filter(|(next, _)| {
                // Rejects a sharp bend: the step may have jumped to another branch.
                next.tangent.dot(&here.tangent) > 0.8
            }) else {
                s /= 2.0;
                if s < 1e-7 {
                    return Ok(BranchPart { end: End::Lost, ..branch });
                }
                continue;
            };
            let value = self.value(next.z[n]);
            let impulse_vanished = (n / 2..n).any(|k| next.z[k] <= 0.0);
            if impulse_vanished || value < self.low || value > self.high {
                // The branch ends where an impulse is zero or the parameter is at its bound.
                let bound = if value < self.low { self.low } else { self.high };
                let distance = |point: &BranchPoint| {
                    if impulse_vanished {
                        point.z.rows(n / 2, n / 2).min()
                    } else {
                        point.z[n] - self.coordinate(bound)
                    }
                };
                branch.end = if impulse_vanished { End::Grazing } else { End::Range };
                if let Some(last) = self.locate(&here, s, &distance) {
                    let orbit = self.orbit(&last.z)?;
                    if impulse_vanished {
                        let after = branch.points.len() - 1;
                        branch.marks.push(Mark { kind: Loss::Grazing, orbit: orbit.clone(), after });
                    }
                    branch.points.push(orbit);
                }
                return Ok(branch);
            }
            if !ordered(&self.system(&next.z)?, &Self::inner(&next.z)) {
                return Ok(BranchPart { end: End::Lost, ..branch });
            }
            let orbit = self.orbit(&next.z)?;
            self.mark(&here, &next, s, &mut branch, &orbit)?;
            branch.points.push(orbit);
            let distance_from_origin = (&next.z - &origin.z).norm();
            if branch.points.len() > 8
                && distance_from_origin < s
                && next.tangent.dot(&origin.tangent) * sign > 0.9
            {
                return Ok(BranchPart { end: End::Closed, ..branch });
            }
            here = next;
            s = match effort {
                0..=4 => (s * 1.4).min(self.step),
                5..=6 => s,
                _ => s / 2.0,
            };
        }
        Ok(branch)
    }

    /// Adds marks for the changes between two points, in their order along the branch.
    fn mark(
        &self,
        here: &BranchPoint,
        next: &BranchPoint,
        s: f64,
        branch: &mut BranchPart,
        orbit: &PeriodicOrbit,
    ) -> Result<()> {
        let n = here.z.len() - 1;
        let last = &branch.points[branch.points.len() - 1];
        let after = branch.points.len() - 1;
        let mut found: Vec<(Loss, BranchPoint)> = Vec::new();
        if here.tangent[n] * next.tangent[n] < 0.0
            && let Some(point) = self.locate(here, s, &|point: &BranchPoint| point.tangent[n])
        {
            found.push((Loss::Fold, point));
        }
        let of = |test: fn(&PeriodicOrbit) -> Option<f64>| {
            move |point: &BranchPoint| self.orbit(&point.z).ok().and_then(|o| test(&o)).unwrap_or(f64::NAN)
        };
        let clearance: fn(&PeriodicOrbit) -> Option<f64> = |orbit| orbit.validity.clearance;
        let tests = [
            (Loss::Flip, flip as fn(&PeriodicOrbit) -> _),
            (Loss::NeimarkSacker, pair),
            (Loss::Grazing, clearance),
        ];
        for (kind, test) in tests {
            let (Some(a), Some(b)) = (test(last), test(orbit)) else { continue };
            if a * b < 0.0
                && let Some(point) = self.locate(here, s, &of(test))
            {
                found.push((kind, point));
            }
        }
        found.sort_by(|a, b| {
            let along = |point: &BranchPoint| here.tangent.dot(&(&point.z - &here.z));
            along(&a.1).total_cmp(&along(&b.1))
        });
        for (kind, point) in found {
            let orbit = self.orbit(&point.z)?;
            if confirmed(kind, &orbit) {
                // A branch of doubled period turns back at a flip, too: it continues with the halves of its
                // period exchanged.
                let is_flip = kind == Loss::Fold && orbit.repeats_within(EQUAL_HALVES);
                let kind = if is_flip { Loss::Flip } else { kind };
                branch.marks.push(Mark { kind, orbit, after });
            }
        }
        Ok(())
    }

    /// The point within `s` ahead of `here` where `test` changes its sign, by false position and bisection.
    fn locate(&self, here: &BranchPoint, s: f64, test: &dyn Fn(&BranchPoint) -> f64) -> Option<BranchPoint> {
        let (mut low, mut high) = (0.0, s);
        let (mut at_low, mut at_high) = (test(here), test(&self.ahead(here, s)?.0));
        let mut best = None;
        for k in 0..60 {
            // False position; every third step bisection.
            let share = at_low / (at_low - at_high);
            let share = if k % 3 == 2 || !share.is_finite() { 0.5 } else { share.clamp(0.01, 0.99) };
            // The equations are singular where branches cross: then other points of the interval are tried.
            let places = [share, 0.45, 0.6].map(|part| low + part * (high - low));
            let near = places.into_iter().find_map(|place| Some((place, self.ahead(here, place)?.0)));
            let Some((middle, point)) = near else { return best };
            let value = test(&point);
            if !value.is_finite() {
                return best;
            }
            best = Some(point);
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

/// det(M ∧ M − I), the product of λᵢλⱼ − 1 over all pairs of multipliers: changes its sign where a complex
/// pair passes the unit circle (bialternate product; J. Guckenheimer, M. Myers, B. Sturmfels 1997), and where
/// two real multipliers become each other's inverse.
fn pair(orbit: &PeriodicOrbit) -> Option<f64> {
    const PAIRS: [(usize, usize); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    let m = orbit.monodromy?;
    let wedge = Matrix6::from_fn(|r, c| {
        let ((i, j), (k, l)) = (PAIRS[r], PAIRS[c]);
        m[(i, k)] * m[(j, l)] - m[(i, l)] * m[(j, k)]
    });
    Some((wedge - Matrix6::identity()).determinant())
}

/// Whether the orbit has the property of a mark of this `kind`. If not, the test function changed its sign by
/// a jump.
fn confirmed(kind: Loss, orbit: &PeriodicOrbit) -> bool {
    let near = |distance: &dyn Fn(&Complex64) -> f64| {
        orbit.multipliers.is_some_and(|m| m.iter().any(|z| distance(z) < 1e-5))
    };
    match kind {
        Loss::Fold => true,
        Loss::Flip => near(&|z| (z + 1.0).norm()),
        Loss::NeimarkSacker => {
            near(&|z| if z.im.abs() > 1e-6 { (z.norm() - 1.0).abs() } else { f64::INFINITY })
        }
        Loss::Grazing => orbit.validity.clearance.is_some_and(|c| c.abs() < 1e-6 * orbit.peak_to_peak[0]),
    }
}
