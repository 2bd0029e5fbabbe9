//! Predictions for a rig with other parameters, for the report page: the model crate with plain numbers as
//! input and output.
//!
//! ```
//! use vibro_whatif::Scene;
//! let scene = Scene { force: 0.1, ..Scene::default() };
//! let answer = scene.response(5.0, 6.0, 11);
//! assert_eq!(answer.len(), 11 * 8);
//! ```

mod page;

use num_complex::Complex64;
use vibro_model::{
    Compliance, Compliant, Excitation, Law, Motion, Orbits, Rig, Simulation, Sine, State, orbits_of, softened,
};
use vibro_record::Result;

/// A rig under a sine force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scene {
    /// The rig.
    pub rig: Rig,
    /// Force amplitude in N.
    pub force: f64,
    /// Stiffness of the contact in N/m; the contact is rigid unless this is finite and above 0.
    pub stiffness: f64,
}

impl Default for Scene {
    fn default() -> Scene {
        Scene { rig: Rig::thesis(), force: 0.1, stiffness: 0.0 }
    }
}

/// Cycles from rest before a motion is shown: by then a disturbance of the thesis' rig has decayed below
/// e⁻⁸.
const SETTLE: u32 = 300;
/// Cycles shown.
const SHOWN: u32 = 4;
/// Points in each cycle shown.
const POINTS: u32 = 200;

impl Scene {
    /// The motion without impacts and the motions with one impact a cycle, at `points` frequencies from
    /// `from` to `to` in Hz. There are 8 numbers for each frequency, NaN where there is no motion. First the
    /// frequency in Hz and the amplitude in m of mass 1 without impacts. Then for two motions, the larger
    /// first: amplitudes in m of both masses at the excitation frequency, and 2 for stable, 1 for unstable,
    /// 0 for no real motion.
    pub fn response(&self, from: f64, to: f64, points: usize) -> Vec<f64> {
        let step = (to - from) / points.saturating_sub(1).max(1) as f64;
        (0..points).flat_map(|k| self.at(from + step * k as f64)).collect()
    }

    /// The motion from rest at a frequency in Hz, after the transient: 5 numbers a point, which are time in
    /// s, x₁ and x₂ in m, v₁ and v₂ in m/s. Empty if it cannot be computed.
    pub fn motion(&self, frequency: f64) -> Vec<f64> {
        self.followed(frequency).unwrap_or_default()
    }

    fn excitation(&self, frequency: f64) -> Excitation {
        Excitation::Sine(Sine { force: self.force, frequency })
    }

    fn contact(&self) -> Option<f64> {
        Some(self.stiffness).filter(|k| k.is_finite() && *k > 0.0)
    }

    fn at(&self, frequency: f64) -> [f64; 8] {
        let nan = f64::NAN;
        let mut row = [frequency, nan, nan, nan, 0.0, nan, nan, 0.0];
        let excitation = self.excitation(frequency);
        let Ok(found) = orbits_of(&self.rig, &excitation, 1) else { return row };
        if found.no_impact.possible {
            row[1] = found.no_impact.amplitude;
        }
        let amplitudes = self.amplitudes(&excitation, &found);
        for ((orbit, amplitudes), cells) in
            found.orbits.iter().zip(amplitudes).zip(row[2..].chunks_exact_mut(3))
        {
            let real = orbit.validity.exists && orbit.validity.admissible;
            if let (true, Some([one, two])) = (real, amplitudes) {
                let stable = orbit.validity.stable == Some(true);
                cells.copy_from_slice(&[one, two, if stable { 2.0 } else { 1.0 }]);
            }
        }
        row
    }

    /// Amplitudes in m of both masses for each orbit. With a soft contact `None` for an orbit to which the
    /// correction for it does not apply.
    fn amplitudes(&self, excitation: &Excitation, found: &Orbits) -> Vec<Option<[f64; 2]>> {
        let Some(stiffness) = self.contact() else {
            return found.orbits.iter().map(|orbit| Some(orbit.fundamental.map(Complex64::norm))).collect();
        };
        let soft = Compliance::new(&self.rig, stiffness, None);
        let soft = soft.and_then(|contact| softened(&self.rig, excitation, found, &contact));
        soft.map_or_else(
            |_| vec![None; found.orbits.len()],
            |all| all.into_iter().map(|orbit| orbit.map(|orbit| orbit.fundamental)).collect(),
        )
    }

    fn followed(&self, frequency: f64) -> Result<Vec<f64>> {
        let (rig, excitation) = (&self.rig, self.excitation(frequency));
        let start = Simulation::at_rest(rig);
        let mut motion: Box<dyn Motion> = match self.contact() {
            Some(stiffness) => {
                let law = Law::kelvin_voigt(stiffness, rig.restitution, rig.reduced_mass())?;
                Box::new(Compliant::new(rig, &excitation, law, start, 0.0)?)
            }
            None => Box::new(Simulation::new(rig, &excitation)?),
        };
        let settled = f64::from(SETTLE) / frequency;
        motion.advance(settled, &mut |_| ())?;
        let step = 1.0 / frequency / f64::from(POINTS);
        let mut rows = Vec::new();
        let mut next = 0;
        let mut show = |t: f64, state: State| rows.extend([t, state.x1, state.x2, state.v1, state.v2]);
        motion.advance(settled + f64::from(SHOWN) / frequency, &mut |piece| {
            while next < SHOWN * POINTS {
                let t = settled + f64::from(next) * step - piece.start;
                if t > piece.duration {
                    break;
                }
                show(f64::from(next) * step, piece.path.state(t.max(0.0)));
                next += 1;
            }
        })?;
        Ok(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_response_is_that_of_the_model() {
        let scene = Scene::default();
        let row = scene.response(5.2, 5.2, 1);
        let found = vibro_model::orbits(&scene.rig, scene.force, 5.2).unwrap();
        let [x1, x2] = found.orbits[0].fundamental.map(Complex64::norm);
        assert_eq!(row[2..5], [x1, x2, 2.0]);
    }

    /// The motion from rest settles on the stable orbit: the peak-to-peak values agree within the resolution
    /// of 200 points a cycle, which is (π/200)²/2 for a sine.
    #[test]
    fn a_motion_from_rest_comes_to_the_stable_orbit() {
        let scene = Scene::default();
        let rows = scene.motion(5.2);
        assert_eq!(rows.len(), 5 * (SHOWN * POINTS) as usize);
        let x2: Vec<f64> = rows.chunks_exact(5).map(|row| row[2]).collect();
        let (low, high) =
            x2.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
        let found = vibro_model::orbits(&scene.rig, scene.force, 5.2).unwrap();
        let truth = found.orbits[0].peak_to_peak[1];
        assert!(((high - low) / truth - 1.0).abs() < 1e-3, "{} {truth}", high - low);
    }

    #[test]
    fn what_cannot_be_has_no_answer_and_no_panic() {
        for rig in [Rig { m1: -1.0, ..Rig::thesis() }, Rig { k1: f64::NAN, ..Rig::thesis() }] {
            let scene = Scene { rig, ..Scene::default() };
            assert!(scene.response(1.0, 2.0, 3)[1].is_nan());
            assert!(scene.motion(5.0).is_empty());
        }
    }
}
