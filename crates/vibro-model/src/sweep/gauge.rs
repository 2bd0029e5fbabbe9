//! Reads an observable of a motion during a sweep.

use crate::flow::State;
use crate::motion::Path;
use crate::rig::Rig;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Quantity of x₁ and x₂ that a sweep reads, in m.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Observable {
    /// Amplitude at the excitation frequency: what a spectrum shows.
    #[default]
    Fundamental,
    /// Half of the peak-to-peak value: what a displacement trace shows.
    Peak,
    /// Running root mean square: square root of x² after a first-order low-pass of 10 rad/s, as the mean
    /// over the cycles of the point.
    Rms,
}

impl Observable {
    /// `fundamental`, `peak` or `rms`.
    pub fn name(self) -> &'static str {
        ["fundamental", "peak", "rms"][self as usize]
    }
}

/// Corner frequency in rad/s of the low-pass that forms the running mean square.
pub(crate) const LOW_PASS: f64 = 10.0;

/// Samples in a cycle of the excitation, or in a swing of the faster mass if that is shorter. Displacements
/// and velocities are both sampled, so between two samples the motion is a cubic: its peaks err by h⁴/384 of
/// the fourth derivative, 4e-6 of the amplitude for h = 2π/32. Integrals use the trapezoidal rule with end
/// corrections, whose error is h⁴/720 of the third derivative's step at each impact (Euler–Maclaurin): 3e-6
/// of the amplitude.
const SAMPLES: f64 = 32.0;

/// Longest period, in cycles, of a motion that counts as regular.
const LONGEST_PERIOD: usize = 4;

/// Sums over a time, for each mass.
#[derive(Debug, Clone, Copy)]
struct Sums {
    integral: [Complex64; 2],
    range: [(f64, f64); 2],
    root: [f64; 2],
    duration: f64,
}

impl Sums {
    const NONE: Sums = Sums {
        integral: [Complex64::ZERO; 2],
        range: [(f64::INFINITY, f64::NEG_INFINITY); 2],
        root: [0.0; 2],
        duration: 0.0,
    };

    fn value(&self, observable: Observable, mass: usize) -> f64 {
        match observable {
            Observable::Fundamental => 2.0 * self.integral[mass].norm() / self.duration,
            Observable::Peak => (self.range[mass].1 - self.range[mass].0) / 2.0,
            Observable::Rms => self.root[mass] / self.duration,
        }
    }
}

/// Reads one observable of both masses, cycle by cycle.
#[derive(Debug, Clone)]
pub struct Gauge {
    observable: Observable,
    /// Largest undamped natural frequency of the masses in rad/s.
    natural: f64,
    /// Running mean square of each mass in m².
    square: [f64; 2],
    /// Sums of the present cycle.
    cycle: Sums,
    /// Sums of all cycles since the last [`Gauge::clear`].
    total: Sums,
    /// Number of these cycles.
    cycles: f64,
    /// Sum of their values and of the squares, for each mass.
    scatter: [(f64, f64); 2],
    /// Values of the last cycles, the newest first.
    recent: Vec<[f64; 2]>,
    /// For each period: sums of squared changes against the cycle one period before, and their number.
    changes: [([f64; 2], f64); LONGEST_PERIOD],
}

impl Gauge {
    /// A gauge for motions of `rig`.
    pub fn new(observable: Observable, rig: &Rig) -> Gauge {
        let natural = rig.oscillators().map(|o| o.omega2().sqrt());
        let natural = natural.into_iter().filter(|n| n.is_finite()).fold(0.0, f64::max);
        let (cycle, total, scatter) = (Sums::NONE, Sums::NONE, [(0.0, 0.0); 2]);
        let (recent, changes) = (Vec::new(), [([0.0; 2], 0.0); LONGEST_PERIOD]);
        Gauge { observable, natural, square: [0.0; 2], cycle, total, cycles: 0.0, scatter, recent, changes }
    }

    /// Deletes the cycles read, but keeps the running mean square and the values of the last cycles.
    pub fn clear(&mut self) {
        (self.cycle, self.total, self.cycles) = (Sums::NONE, Sums::NONE, 0.0);
        self.scatter = [(0.0, 0.0); 2];
        self.changes = [([0.0; 2], 0.0); LONGEST_PERIOD];
    }

    /// Also deletes the values of the last cycles: the cycles that follow belong to another step.
    pub fn restart(&mut self) {
        self.recent.clear();
        self.clear();
    }

    /// Adds a piece of `duration` s that begins at `phase` (rad) under `omega` (rad/s).
    pub fn take(&mut self, path: &dyn Path, duration: f64, phase: f64, omega: f64) {
        let n = (duration * omega.max(self.natural) / TAU * SAMPLES).ceil().max(1.0);
        let h = duration / n;
        if h <= 0.0 {
            return;
        }
        let turn = Complex64::cis(-omega * h);
        let fade = (-LOW_PASS * h).exp();
        let cycle = &mut self.cycle;
        let mut before = path.state(0.0);
        let mut wave = Complex64::cis(-phase);
        for i in 1..=n as u64 {
            let after = path.state(if i as f64 == n { duration } else { i as f64 * h });
            let next = wave * turn;
            for mass in 0..2 {
                let [a, b] = [&before, &after].map(|s| coordinate(s, mass));
                // f = x e^{−iωt}, ḟ = (v − iωx) e^{−iωt}.
                let (fa, fb) = (wave * a.0, next * b.0);
                let da = wave * Complex64::new(a.1, -omega * a.0);
                let db = next * Complex64::new(b.1, -omega * b.0);
                cycle.integral[mass] += (fa + fb) * (h / 2.0) + (da - db) * (h * h / 12.0);
                match self.observable {
                    Observable::Fundamental => {}
                    Observable::Peak => extend(&mut cycle.range[mass], a, b, h),
                    Observable::Rms => {
                        let old = self.square[mass].sqrt();
                        // f = Ωx²e^{−Ω(h−t)}, ḟ = (2Ωxv + Ω²x²)e^{−Ω(h−t)}.
                        let f = |x: (f64, f64)| LOW_PASS * x.0 * x.0;
                        let d = |x: (f64, f64)| 2.0 * LOW_PASS * x.0 * x.1 + LOW_PASS * f(x);
                        let added = (f(a) * fade + f(b)) * (h / 2.0) + (d(a) * fade - d(b)) * (h * h / 12.0);
                        self.square[mass] = (self.square[mass] * fade + added).max(0.0);
                        cycle.root[mass] += (old + self.square[mass].sqrt()) * (h / 2.0);
                    }
                }
            }
            (before, wave) = (after, next);
        }
        cycle.duration += duration;
    }

    /// Ends a cycle.
    pub fn close_cycle(&mut self) {
        let Gauge { observable, cycle, total, cycles, scatter, recent, changes, .. } = self;
        let values = [0, 1].map(|mass| cycle.value(*observable, mass));
        for ((sums, count), old) in changes.iter_mut().zip(&*recent) {
            *sums = [0, 1].map(|mass| sums[mass] + (values[mass] - old[mass]).powi(2));
            *count += 1.0;
        }
        recent.truncate(LONGEST_PERIOD - 1);
        recent.insert(0, values);
        for (mass, (sum, squares)) in scatter.iter_mut().enumerate() {
            let value = values[mass];
            *sum += value;
            *squares += value * value;
            total.integral[mass] += cycle.integral[mass];
            let ((low, high), (least, most)) = (cycle.range[mass], total.range[mass]);
            total.range[mass] = (least.min(low), most.max(high));
            total.root[mass] += cycle.root[mass];
        }
        total.duration += cycle.duration;
        *cycle = Sums::NONE;
        *cycles += 1.0;
    }

    /// Value over all cycles since [`Gauge::clear`], and standard deviation from cycle to cycle, for each
    /// mass, in m.
    pub fn read(&self) -> [(f64, f64); 2] {
        let Gauge { observable, total, cycles, scatter, .. } = self;
        [0, 1].map(|mass| {
            let (sum, squares) = scatter[mass];
            let variance = (squares - sum * sum / cycles) / (cycles - 1.0).max(1.0);
            (total.value(*observable, mass), variance.max(0.0).sqrt())
        })
    }

    /// Standard deviation in m between cycles that would be equal if the motion had a period of one to four
    /// cycles, for each mass. A slow change of the amplitude adds next to nothing. 0 without earlier cycles.
    pub fn unrest(&self) -> [f64; 2] {
        [0, 1].map(|mass| {
            let known = self.changes.iter().filter(|(_, count)| *count > 0.0);
            let squares = known.map(|(sums, count)| sums[mass] / (2.0 * count));
            squares.reduce(f64::min).unwrap_or(0.0).sqrt()
        })
    }

    /// Phase in rad of x₂ against x₁ at the excitation frequency; `None` where a mass stands still.
    pub fn relative_phase(&self) -> Option<f64> {
        let [x1, x2] = self.total.integral;
        let moving = x1.norm().min(x2.norm()) > STILL * x1.norm().max(x2.norm());
        moving.then(|| (x2 * x1.conj()).arg())
    }
}

/// Fraction of the largest amplitude below which a mass stands still. Sums of a few thousand terms are
/// rounded to 1e-13 of them.
pub const STILL: f64 = 1e-9;

/// Displacement (m) and velocity (m/s) of a mass.
fn coordinate(state: &State, mass: usize) -> (f64, f64) {
    if mass == 0 { (state.x1, state.v1) } else { (state.x2, state.v2) }
}

/// Extends a range by the cubic through two samples with their slopes, `h` apart.
fn extend(range: &mut (f64, f64), a: (f64, f64), b: (f64, f64), h: f64) {
    let mut take = |x: f64| *range = (range.0.min(x), range.1.max(x));
    take(a.0);
    take(b.0);
    if a.1 * b.1 >= 0.0 {
        return;
    }
    // x(s) = a + hv s + c s² + d s³ on 0..1; its slope changes sign once.
    let (va, vb, rise) = (a.1 * h, b.1 * h, b.0 - a.0);
    let (c, d) = (3.0 * rise - 2.0 * va - vb, va + vb - 2.0 * rise);
    let root = (c * c - 3.0 * d * va).max(0.0).sqrt();
    let q = -(c + root.copysign(c));
    for s in [q / (3.0 * d), va / q] {
        if s > 0.0 && s < 1.0 {
            take(a.0 + s * (va + s * (c + s * d)));
        }
    }
}
