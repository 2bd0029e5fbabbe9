//! A stretch of a periodic motion: no impact, impulse or step of the force inside.

use crate::math::Oscillator;
use crate::math::root::{Bounded, each_root};
use crate::math::swing::passages;
use crate::model::State;
use num_complex::Complex64;

/// What is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// g = Δ + x₂ − x₁.
    Gap,
    /// x₁.
    X1,
    /// x₂.
    X2,
}

/// Both masses in free motion, mass 1 about `rest` and with one forced wave on top; time counts from the stretch's start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    pub oscillators: [Oscillator; 2],
    /// Displacement and velocity of the free parts at the start.
    pub free: [(f64, f64); 2],
    /// Complex forced displacement of mass 1 at the start, in m.
    pub forced: Complex64,
    pub omega: f64,
    /// Where mass 1 would rest under the constant force, in m.
    pub rest: f64,
    pub gap: f64,
}

impl Stretch {
    /// Both displacements with their first two derivatives.
    #[inline]
    pub fn series(&self, t: f64) -> [[f64; 3]; 2] {
        let mut all = [[0.0; 3]; 2];
        for ((series, oscillator), free) in all.iter_mut().zip(&self.oscillators).zip(self.free) {
            let (x, v) = oscillator.free(free.0, free.1, t);
            *series = [x, v, oscillator.acceleration(x, v)];
        }
        all[0][0] += self.rest;
        if self.forced != Complex64::ZERO {
            let wave = self.forced * Complex64::cis(self.omega * t);
            all[0][0] += wave.re;
            all[0][1] -= self.omega * wave.im;
            all[0][2] -= self.omega * self.omega * wave.re;
        }
        all
    }

    /// State at `t`.
    pub fn state(&self, t: f64) -> State {
        let [[x1, v1, _], [x2, v2, _]] = self.series(t);
        State { x1, v1, x2, v2 }
    }

    /// Rate of change of the state at `t`.
    pub fn rate(&self, t: f64) -> [f64; 4] {
        let [[_, v1, a1], [_, v2, a2]] = self.series(t);
        [v1, a1, v2, a2]
    }

    /// Value, slope and acceleration of a signal.
    #[inline]
    pub fn signal(&self, signal: Signal, t: f64) -> [f64; 3] {
        let [one, two] = self.series(t);
        match signal {
            Signal::X1 => one,
            Signal::X2 => two,
            Signal::Gap => [self.gap + two[0] - one[0], two[1] - one[1], two[2] - one[2]],
        }
    }

    /// A bound on the displacements for ever, in m, without `rest` and gap.
    pub fn reach(&self) -> f64 {
        let free: f64 = self.oscillators.iter().zip(self.free).map(|(o, (x, v))| o.bound(x, v)).sum();
        self.forced.norm() + free
    }

    /// Rounding error of a computed gap in m: a few ε of the largest term.
    pub fn noise(&self) -> f64 {
        2.0 * f64::EPSILON * (self.gap.abs() + self.rest.abs() + self.reach())
    }

    /// Rate and acceleration of a signal with a bound on the acceleration's own rate for all later times.
    #[inline]
    fn bounded(&self, signal: Signal, t: f64) -> Bounded {
        let mut sum = Bounded { value: 0.0, slope: 0.0, curvature: 0.0 };
        let mut add = |sign: f64, i: usize| {
            let oscillator = &self.oscillators[i];
            let (x, v) = oscillator.free(self.free[i].0, self.free[i].1, t);
            let a = oscillator.acceleration(x, v);
            let jerk = oscillator.acceleration(v, a);
            sum.value += sign * v;
            sum.slope += sign * a;
            sum.curvature += oscillator.bound(jerk, oscillator.acceleration(a, jerk));
        };
        if signal != Signal::X1 {
            add(1.0, 1);
        }
        if signal != Signal::X2 {
            let sign = if signal == Signal::Gap { -1.0 } else { 1.0 };
            add(sign, 0);
            if self.forced != Complex64::ZERO {
                let wave = self.forced * Complex64::cis(self.omega * t);
                let omega2 = self.omega * self.omega;
                sum.value -= sign * self.omega * wave.im;
                sum.slope -= sign * omega2 * wave.re;
                sum.curvature += self.omega * omega2 * self.forced.norm();
            }
        }
        sum
    }

    /// Visits every time in `0..=duration` at which a signal's rate is zero.
    pub fn each_stationary(&self, signal: Signal, duration: f64, mut visit: impl FnMut(f64)) {
        let alone = match signal {
            Signal::X2 => Some(1),
            Signal::X1 if self.forced == Complex64::ZERO => Some(0),
            _ => None,
        };
        if let Some(i) = alone {
            let (oscillator, (x, v)) = (&self.oscillators[i], self.free[i]);
            passages(oscillator, v, oscillator.acceleration(x, v), duration).for_each(visit);
        } else {
            each_root(0.0, duration, |t| self.bounded(signal, t), &mut visit);
        }
    }
}
