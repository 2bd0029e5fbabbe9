//! The rig: two masses on springs and dampers, a gap and a restitution.

use super::body::Body;
use super::flow::State;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use vibro_math::Oscillator;
use vibro_record::{Error, Result};

/// Two-mass rig in SI units. Keys that are left out take the values of [`Rig::thesis`].
///
/// ```
/// let rig: vibro_model::Rig = toml::from_str("gap = 0.5e-3\nrestitution = 0.9")?;
/// assert_eq!((rig.gap, rig.m1), (0.5e-3, 0.125));
/// # Ok::<(), toml::de::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rig {
    /// Excited mass in kg.
    pub m1: f64,
    /// Passive mass in kg. Infinite for a wall: the rig is then an impact oscillator, and `k2` and `c2` are
    /// ignored.
    pub m2: f64,
    /// Stiffness of the excited mass' spring in N/m.
    pub k1: f64,
    /// Stiffness of the passive mass' spring in N/m.
    pub k2: f64,
    /// Damping of the excited mass in N s/m.
    pub c1: f64,
    /// Damping of the passive mass in N s/m.
    pub c2: f64,
    /// Gap at rest in m; negative where the masses are pressed together.
    pub gap: f64,
    /// Coefficient of restitution R, 0 to 1.
    pub restitution: f64,
}

impl Default for Rig {
    fn default() -> Rig {
        Rig::thesis()
    }
}

impl Rig {
    /// The rig of the thesis; its damping was estimated, its restitution is that of its closed-form examples.
    pub fn thesis() -> Rig {
        Rig { m1: 0.125, m2: 0.094, k1: 135.0, k2: 128.0, c1: 0.1, c2: 0.1, gap: 1e-3, restitution: 0.7 }
    }

    /// Whether the passive mass is infinite: a wall.
    pub(crate) fn has_wall(&self) -> bool {
        self.m2 == f64::INFINITY
    }

    /// Checks that a motion can start from `state` and `phase` (rad): all finite, and a wall at rest at 0.
    pub(super) fn check_start(&self, state: &State, phase: f64) -> Result<()> {
        let State { x1, v1, x2, v2 } = *state;
        if ![x1, v1, x2, v2, phase].iter().all(|v| v.is_finite()) {
            let found = format!("initial state {x1}, {v1}, {x2}, {v2} with phase {phase}");
            return Err(Error::usage(found, "finite values"));
        }
        if !self.has_wall() || x2 == 0.0 && v2 == 0.0 {
            return Ok(());
        }
        let found = format!("mass 2 is a wall (m2 is infinite) and starts at {x2} m with {v2} m/s");
        Err(Error::usage(found, "0 m and 0 m/s"))
    }

    /// Error for a start at which the masses overlap.
    pub(super) fn overlap(&self, state: &State) -> Error {
        Error::usage(
            format!("the masses overlap by {} m at the start", state.x1 - state.x2 - self.gap),
            "x1 − x2 of at most the gap; give an initial state in which they are apart",
        )
    }

    /// Common velocity in m/s of both masses after joining, with their momentum kept.
    pub(super) fn common_speed(&self, state: &State) -> f64 {
        let [m1, m2] = self.masses();
        let momentum = m1 * state.v1 + m2 * state.v2;
        self.joined().map_or(0.0, |both| momentum / both.mass)
    }

    /// Reduced mass M = m₁m₂/(m₁ + m₂) in kg.
    pub fn reduced_mass(&self) -> f64 {
        let [m1, m2] = self.masses();
        self.joined().map_or(m1, |both| m1 * m2 / both.mass)
    }

    /// Impulse of an impact over its approach speed, M(1 + R) in kg.
    pub fn exchange(&self) -> f64 {
        self.reduced_mass() * (1.0 + self.restitution)
    }

    /// The state just after an impact.
    #[inline]
    pub(crate) fn struck(&self, before: State, impulse: f64) -> State {
        let [m1, m2] = self.masses();
        State { v1: before.v1 - impulse / m1, v2: before.v2 + impulse / m2, ..before }
    }

    /// Natural frequencies in Hz of each mass alone, without its damper.
    pub fn natural_frequencies(&self) -> [f64; 2] {
        self.bodies().map(|body| (body.stiffness / body.mass).sqrt() / std::f64::consts::TAU)
    }

    /// Mass 1 and mass 2, each alone.
    #[inline]
    pub(crate) fn bodies(&self) -> [Body; 2] {
        let [damping, stiffness] = if self.has_wall() { [0.0; 2] } else { [self.c2, self.k2] };
        [
            Body { mass: self.m1, damping: self.c1, stiffness: self.k1 },
            Body { mass: self.m2, damping, stiffness },
        ]
    }

    /// Mass in kg of each body.
    #[inline]
    pub(crate) fn masses(&self) -> [f64; 2] {
        self.bodies().map(|body| body.mass)
    }

    /// Both masses joined to one body; `None` against a wall.
    pub(crate) fn joined(&self) -> Option<Body> {
        let [first, second] = self.bodies();
        (!self.has_wall()).then_some(Body {
            mass: first.mass + second.mass,
            damping: first.damping + second.damping,
            stiffness: first.stiffness + second.stiffness,
        })
    }

    /// Free motion of each mass; a wall stays at rest.
    pub fn oscillators(&self) -> [Oscillator; 2] {
        self.bodies().map(|body| body.oscillator())
    }

    /// Receptances L₁(iω), L₂(iω) of the masses, each alone, in m/N.
    pub fn receptances(&self, omega: f64) -> [Complex64; 2] {
        self.bodies().map(|body| body.receptance(omega))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_impossible_value_is_named() {
        let t = Rig::thesis();
        let cases = [
            (Rig { m1: -0.1, ..t }, "m1 is -0.1 kg"),
            (Rig { m2: 0.0, ..t }, "m2 is 0 kg"),
            (Rig { k1: f64::NAN, ..t }, "k1 is NaN N/m"),
            (Rig { k2: f64::INFINITY, ..t }, "k2 is inf N/m"),
            (Rig { m1: f64::INFINITY, ..t }, "m1 is inf kg"),
            (Rig { m2: f64::NEG_INFINITY, ..t }, "m2 is -inf kg"),
            (Rig { c1: -1e-9, ..t }, "c1 is -0.000000001 N s/m"),
            (Rig { c2: f64::NAN, ..t }, "c2 is NaN N s/m"),
            (Rig { gap: f64::NAN, ..t }, "gap is NaN m"),
            (Rig { restitution: 1.01, ..t }, "restitution is 1.01"),
            (Rig { restitution: f64::NAN, ..t }, "restitution is NaN"),
        ];
        for (rig, start) in cases {
            let text = rig.check().unwrap_err().to_string();
            assert!(text.starts_with(start), "{text}");
        }
        assert!(t.check().is_ok());
        assert!(Rig { m2: f64::INFINITY, k2: 0.0, c2: f64::NAN, ..t }.check().is_ok());
        assert!(Rig { c1: 0.0, c2: 0.0, gap: -5e-4, restitution: 0.0, ..t }.check().is_ok());
    }

    #[test]
    fn an_unknown_key_is_refused() {
        let error = toml::from_str::<Rig>("mass1 = 0.1").unwrap_err().to_string();
        assert!(error.contains("unknown field `mass1`"), "{error}");
    }

    #[test]
    fn natural_frequencies_are_the_measured_ones() {
        // The thesis states 5.23 and 5.87 Hz.
        let [f1, f2] = Rig::thesis().natural_frequencies();
        assert!((f1 - 5.23).abs() < 0.005 && (f2 - 5.87).abs() < 0.005);
    }
}
