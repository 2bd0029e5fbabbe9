//! Striker, intermediate piston and bit as rigid bodies in a row: gaps, impulses and held contacts.
//!
//! A blow passes several contacts at once. By restitution it is a sequence of impacts of two bodies: striker
//! on intermediate piston, intermediate piston on bit, bit on damper, intermediate piston on buffer, and
//! again from the first, until no touching bodies approach. Another order gives other velocities; where it
//! matters a compliant law decides.

use super::machine::Machine;

/// Number of constraints: the four interfaces, and the striker that sticks in its seal.
pub(super) const CONSTRAINTS: usize = 5;
/// Constraint of the striker that sticks.
pub(super) const STUCK: usize = 4;
/// Rate of each gap from the velocities of striker, intermediate piston and bit; the last row is the
/// velocity of a striker that must not move.
pub(super) const ROWS: [[f64; 3]; CONSTRAINTS] =
    [[-1.0, 1.0, 0.0], [0.0, -1.0, 1.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
/// Bodies of each interface, in the direction of a blow; `None` is the housing or the damper.
pub(super) const BODIES: [[Option<usize>; 2]; 4] =
    [[Some(0), Some(1)], [Some(1), Some(2)], [Some(2), None], [None, Some(1)]];

/// Masses in kg, and the gaps in m with all positions 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chain {
    pub masses: [f64; 3],
    pub offsets: [f64; 4],
}

/// Response of the chain with some constraints kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Restraint {
    /// Accelerations per force: a = P f.
    pub response: [[f64; 3]; 3],
    /// Force of each constraint in its direction per force on the bodies; 0 for those not kept.
    pub forces: [[f64; 3]; CONSTRAINTS],
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Chain {
    pub fn new(machine: &Machine) -> Chain {
        let masses = [machine.striker.mass, machine.intermediate.mass, machine.bit.mass];
        let strike = machine.striker.strike;
        let offsets = [0.0, 0.0, strike + machine.bit.clearance, machine.intermediate.travel - strike];
        Chain { masses, offsets }
    }

    /// Gap in m of an interface.
    pub fn gap(&self, k: usize, positions: &[f64; 3]) -> f64 {
        self.offsets[k] + dot(&ROWS[k], positions)
    }

    /// Approach speed in m/s of an interface.
    pub fn approach(k: usize, velocities: &[f64; 3]) -> f64 {
        -dot(&ROWS[k], velocities)
    }

    /// Velocities in m/s of both bodies of an interface, in the direction of a blow.
    pub fn both(k: usize, velocities: &[f64; 3]) -> [f64; 2] {
        BODIES[k].map(|body| body.map_or(0.0, |j| velocities[j]))
    }

    /// Reciprocal of the reduced mass of an interface, in 1/kg.
    pub fn compliance(&self, k: usize) -> f64 {
        ROWS[k].iter().zip(&self.masses).map(|(row, mass)| row * row / mass).sum()
    }

    /// Applies an impact with a restitution to the velocities; returns the lost energy in J.
    pub fn strike(&self, k: usize, restitution: f64, velocities: &mut [f64; 3]) -> f64 {
        let approach = Chain::approach(k, velocities);
        let reduced = 1.0 / self.compliance(k);
        for ((velocity, row), mass) in velocities.iter_mut().zip(&ROWS[k]).zip(&self.masses) {
            *velocity += row * (1.0 + restitution) * reduced * approach / mass;
        }
        0.5 * reduced * (1.0 - restitution * restitution) * approach * approach
    }

    /// Kinetic energy in J.
    pub fn kinetic(&self, velocities: &[f64; 3]) -> f64 {
        0.5 * velocities.iter().zip(&self.masses).map(|(v, m)| m * v * v).sum::<f64>()
    }

    /// Velocities with the relative velocities of the constraints taken away by plastic impacts, and the
    /// impulse of each constraint in N s.
    pub fn projected(&self, restraint: &Restraint, velocities: &[f64; 3]) -> ([f64; 3], [f64; CONSTRAINTS]) {
        let momenta = std::array::from_fn(|j| self.masses[j] * velocities[j]);
        (restraint.response.map(|row| dot(&row, &momenta)), restraint.forces.map(|row| dot(&row, &momenta)))
    }

    /// Response with the constraints `kept`; `None` where they depend on each other.
    ///
    /// With the rows W of the constraints the forces N keep `Wa = 0` in `Ma = f + WᵀN`:
    /// `N = −(WM⁻¹Wᵀ)⁻¹WM⁻¹f`.
    pub fn restraint(&self, kept: [bool; CONSTRAINTS]) -> Option<Restraint> {
        let mut forces = [[0.0; 3]; CONSTRAINTS];
        // Rows of (WM⁻¹Wᵀ | −WM⁻¹), with a row of the unit matrix for a constraint that is not kept.
        let mut system = [[0.0; CONSTRAINTS + 3]; CONSTRAINTS];
        for i in 0..CONSTRAINTS {
            if !kept[i] {
                system[i][i] = 1.0;
                continue;
            }
            let mobile: [f64; 3] = std::array::from_fn(|j| ROWS[i][j] / self.masses[j]);
            for j in (0..CONSTRAINTS).filter(|j| kept[*j]) {
                system[i][j] = dot(&mobile, &ROWS[j]);
            }
            for j in 0..3 {
                system[i][CONSTRAINTS + j] = -mobile[j];
            }
        }
        // Gauss–Jordan; the matrix is positive definite where the rows are independent.
        for i in 0..CONSTRAINTS {
            if kept[i] && system[i][i] <= 1e-10 * self.compliance(i) {
                return None;
            }
            let pivot = system[i].map(|term| term / system[i][i]);
            system[i] = pivot;
            for (j, row) in system.iter_mut().enumerate() {
                let factor = row[i];
                if j != i && factor != 0.0 {
                    row.iter_mut().zip(&pivot).for_each(|(term, p)| *term -= factor * p);
                }
            }
        }
        for (force, row) in forces.iter_mut().zip(&system) {
            force.copy_from_slice(&row[CONSTRAINTS..]);
        }
        let response = std::array::from_fn(|body| {
            std::array::from_fn(|j| {
                let own = if body == j { 1.0 } else { 0.0 };
                let held: f64 = (0..CONSTRAINTS).map(|k| ROWS[k][body] * forces[k][j]).sum();
                (own + held) / self.masses[body]
            })
        });
        Some(Restraint { response, forces })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHAIN: Chain = Chain { masses: [0.14, 0.28, 0.43], offsets: [0.0; 4] };

    #[test]
    fn impacts_conserve_momentum_and_lose_the_energy_that_they_report() {
        for k in 0..2 {
            let mut v = [7.5, -0.3, -1.2];
            let before = v;
            let lost = CHAIN.strike(k, 0.7, &mut v);
            let momentum = |v: &[f64; 3]| v.iter().zip(CHAIN.masses).map(|(v, m)| v * m).sum::<f64>();
            assert!((momentum(&v) - momentum(&before)).abs() < 4.0 * f64::EPSILON);
            assert!((CHAIN.kinetic(&before) - CHAIN.kinetic(&v) - lost).abs() < 8.0 * f64::EPSILON * 4.0);
            assert!((Chain::approach(k, &v) + 0.7 * Chain::approach(k, &before)).abs() < 1e-14);
        }
    }

    #[test]
    fn held_bodies_move_as_one_and_redundant_constraints_are_found() {
        // Intermediate piston and bit together under 3 N and 1 N: a = 4/0.71.
        let held = CHAIN.restraint([false, true, false, false, false]).unwrap();
        let a = held.response.map(|row| dot(&row, &[2.0, 3.0, 1.0]));
        assert!((a[1] - 4.0 / 0.71).abs() < 1e-14 && (a[2] - a[1]).abs() < 1e-14 && a[0] == 2.0 / 0.14);
        // The force that the bit takes from the piston is what it needs beyond its own 1 N.
        assert!((dot(&held.forces[1], &[2.0, 3.0, 1.0]) - (0.43 * a[2] - 1.0)).abs() < 1e-14);
        // All at rest on the damper: weights add up.
        let rest = CHAIN.restraint([true, true, true, false, false]).unwrap();
        let forces = rest.forces.map(|row| dot(&row, &[1.0, 2.0, 4.0]));
        for (force, expected) in forces.iter().zip([1.0, 3.0, 7.0, 0.0, 0.0]) {
            assert!((force - expected).abs() < 1e-13);
        }
        assert!(CHAIN.restraint([true, true, true, false, true]).is_none());
        assert!(CHAIN.restraint([false, true, true, true, false]).is_none());
    }
}
