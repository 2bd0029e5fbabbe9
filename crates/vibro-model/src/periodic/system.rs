//! The equations of a motion with p impacts in q cycles, and their exact Jacobian.

use crate::excitation::Sine;
use crate::green::Green;
use crate::rig::Rig;
use crate::steady::Steady;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::Result;

/// Equations of impacts at the phases θᵢ with the impulses Jᵢ, tᵢ = θᵢ/ω, T = 2πq/ω:
///
/// gap Eᵢ = Δ − Re(Xe^{iθᵢ}) + Σⱼ Jⱼχ(tᵢ − tⱼ) = 0 and
///
/// velocity Fᵢ = Jᵢ/(M(1+R)) − ȧ(tᵢ) + Σⱼ Jⱼχ̇(tᵢ − tⱼ) = 0,
///
/// where a = Re(Xe^{iωt}), χ = χ₁ + χ₂ (periodic Green's functions over T; Babitsky 1998), and χ̇ for j = i
/// is taken just before the impulse. For p = 1 these are the two conditions of the closed form. The
/// equations are linear in the impulses and need no simulation, and all derivatives are exact.
pub(crate) struct System {
    pub rig: Rig,
    pub omega: f64,
    pub period: f64,
    pub response: Complex64,
    pub greens: [Green; 2],
    /// 1/(M(1 + R)) in 1/kg.
    pub contact: f64,
    /// Length scale of equations and impulses, in m.
    pub length: f64,
}

impl System {
    pub fn new(rig: &Rig, sine: &Sine, cycles: u32) -> Result<System> {
        let steady = Steady::new(rig, sine)?;
        let period = f64::from(cycles) * TAU / steady.omega;
        let ([first, second], [m1, m2]) = (rig.oscillators(), rig.masses());
        Ok(System {
            rig: *rig,
            omega: steady.omega,
            period,
            response: steady.response,
            greens: [Green::new(m1, first, period)?, Green::new(m2, second, period)?],
            contact: 1.0 / rig.exchange(),
            length: rig.gap.abs().max(steady.amplitude()).max(f64::MIN_POSITIVE),
        })
    }

    /// Unit of the unknown impulses, in N s.
    pub fn impulse(&self) -> f64 {
        self.length * self.omega / self.contact
    }

    /// Unknowns of impacts with these phases (rad) and impulses (N s).
    pub fn unknowns(&self, impacts: &[(f64, f64)]) -> DVector<f64> {
        let (phases, impulses): (Vec<f64>, Vec<f64>) =
            impacts.iter().map(|(phase, impulse)| (phase, impulse / self.impulse())).unzip();
        DVector::from_vec([phases, impulses].concat())
    }

    /// χ, χ̇, χ̈ of both masses together, `t` in 0..T (s).
    fn chi(&self, t: f64) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for green in &self.greens {
            let (x, v) = green.at(t);
            sum[0] += x;
            sum[1] += v;
            sum[2] += green.oscillator.acceleration(x, v);
        }
        sum
    }

    /// Residuals of the 2p equations at `u` = (θ₁ … θₚ, J₁ … Jₚ in units of [`System::impulse`]), and their
    /// Jacobian.
    pub(crate) fn evaluate(&self, u: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let p = u.len() / 2;
        let unit = self.impulse();
        let (far, fast) = (1.0 / self.length, 1.0 / (self.length * self.omega));
        let mut left = DVector::zeros(2 * p);
        let mut jacobian = DMatrix::zeros(2 * p, 2 * p);
        let start: f64 = self.greens.iter().map(|g| g.start).sum();
        let slope: f64 = self.greens.iter().map(|g| g.slope_before).sum();
        for i in 0..p {
            let wave = self.response * Complex64::cis(u[i]);
            let own = u[p + i] * unit;
            // a, ȧ, ä.
            let forced = [wave.re, -self.omega * wave.im, -self.omega.powi(2) * wave.re];
            let (mut gap, mut speed) =
                (self.rig.gap - forced[0] + own * start, own * (self.contact + slope) - forced[1]);
            let (mut gap_turn, mut speed_turn) = (-forced[1], -forced[2]);
            jacobian[(i, p + i)] = start * unit * far;
            jacobian[(p + i, p + i)] = (self.contact + slope) * unit * fast;
            for j in (0..p).filter(|j| *j != i) {
                let t = ((u[i] - u[j]) / self.omega).rem_euclid(self.period);
                let chi = self.chi(t);
                let [x, v, a] = chi.map(|c| c * u[p + j] * unit);
                gap += x;
                speed += v;
                gap_turn += v;
                speed_turn += a;
                jacobian[(i, j)] = -v / self.omega * far;
                jacobian[(p + i, j)] = -a / self.omega * fast;
                jacobian[(i, p + j)] = chi[0] * unit * far;
                jacobian[(p + i, p + j)] = chi[1] * unit * fast;
            }
            left[i] = gap * far;
            left[p + i] = speed * fast;
            jacobian[(i, i)] = gap_turn / self.omega * far;
            jacobian[(p + i, i)] = speed_turn / self.omega * fast;
        }
        (left, jacobian)
    }

    /// Free parts of displacement (m) and velocity (m/s) of both masses just after impact `i`.
    pub(crate) fn free_after(&self, u: &DVector<f64>, i: usize) -> [(f64, f64); 2] {
        let p = u.len() / 2;
        let unit = self.impulse();
        let mut free = [(0.0, 0.0); 2];
        for j in 0..p {
            let impulse = u[p + j] * unit;
            for ((free, green), sign) in free.iter_mut().zip(&self.greens).zip([-1.0, 1.0]) {
                let (x, v) = if i == j {
                    (green.start, green.slope_after)
                } else {
                    green.at(((u[i] - u[j]) / self.omega).rem_euclid(self.period))
                };
                free.0 += sign * impulse * x;
                free.1 += sign * impulse * v;
            }
        }
        free
    }
}
