//! Extremes of x₁, x₂ and the gap in a flight without an impact, an impulse or a step of the force inside.

use crate::flow::Flight;
use vibro_math::Oscillator;

/// The signal whose extremes are searched: x₁, x₂, or the gap g = Δ + x₂ − x₁.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    X1,
    X2,
    Gap,
}

impl Signal {
    /// Value of the signal from the values of both masses, without the rest gap.
    #[inline]
    fn of(self, [one, two]: [f64; 2]) -> f64 {
        match self {
            Signal::X1 => one,
            Signal::X2 => two,
            Signal::Gap => two - one,
        }
    }
}

impl Flight {
    /// Value, rate and acceleration of a signal at `t` (s).
    #[inline]
    fn signal(&self, signal: Signal, t: f64) -> [f64; 3] {
        let [one, two] = self.series(t);
        let [value, rate, acceleration] = [0, 1, 2].map(|n| signal.of([one[n], two[n]]));
        [if signal == Signal::Gap { self.gap + value } else { value }, rate, acceleration]
    }

    /// Calls `visit` with every minimum and maximum of x₁, x₂ and the gap inside `0..duration`: its time, its
    /// value, and the signal's acceleration there.
    ///
    /// Zeros of the rate f are searched on a grid that is fine against the motion; matrices carry the free
    /// motion from point to point. Let |f″| ≤ M (`limit`) between two points. Then f has no zero there if it
    /// cannot reach zero even with the curvature M towards zero from both ends. It has exactly one zero if f
    /// changes sign and f′ keeps its sign. Other intervals are halved. Two zeros closer together than a
    /// millionth of the duration may be missed: between them the signal changes by less than
    /// M(1e-6 duration)³.
    pub(crate) fn each_turn(&self, duration: f64, mut visit: impl FnMut(Signal, f64, f64, f64)) {
        let own = self.free.map(|part| part.oscillator.omega2().sqrt());
        let fastest = self.waves.fastest().max(own[0]).max(own[1]);
        // At 0.35 rad a step, the error of the cubic through both ends is 0.35⁴/384 = 4e-5 of the rate.
        let steps = (fastest * duration / 0.35).ceil().max(1.0);
        let step = duration / steps;
        let kernels = self.free.map(|part| StepMatrix::new(&part.oscillator, step));
        let mut free = self.free.map(|part| (part.x, part.v));
        let mut left = self.rates(free, 0.0);
        let mut n = 0.0;
        while n < steps {
            let right_t = (n + 1.0) * step;
            n += 1.0;
            // Computed directly every 64 steps, since the rounding errors of the steps add up.
            free = if n % 64.0 == 0.0 {
                self.free.map(|part| part.oscillator.free(part.x, part.v, right_t))
            } else {
                [kernels[0].on(free[0]), kernels[1].on(free[1])]
            };
            let right = self.rates(free, right_t);
            for signal in [Signal::X1, Signal::X2, Signal::Gap] {
                let limit =
                    if signal == Signal::Gap { left.limit[0] + left.limit[1] } else { signal.of(left.limit) };
                let ends = [&left, &right].map(|r| (signal.of(r.rate), signal.of(r.slope)));
                let part = Subinterval { signal, start: right_t - step, width: step, limit, duration };
                self.turns_between(&part, ends, &mut visit);
            }
            left = right;
        }
    }

    /// Rates of both displacements, slopes of these rates, and bounds on their curvature for all later times.
    fn rates(&self, free: [(f64, f64); 2], t: f64) -> Rates {
        let [_, v, a, ..] = self.waves.at(t);
        let limit = self.waves.limits.jerk;
        let mut rates = Rates { rate: [v, 0.0], slope: [a, 0.0], limit: [limit, 0.0] };
        for (i, (part, (x, v))) in self.free.iter().zip(free).enumerate() {
            let a = part.oscillator.acceleration(x, v);
            let jerk = part.oscillator.acceleration(v, a);
            rates.rate[i] += v;
            rates.slope[i] += a;
            rates.limit[i] += part.oscillator.bound(jerk, part.oscillator.acceleration(a, jerk));
        }
        rates
    }

    /// Extremes of a signal within a part, given its rates and slopes at both ends.
    fn turns_between(
        &self,
        part: &Subinterval,
        [left, right]: [(f64, f64); 2],
        visit: &mut impl FnMut(Signal, f64, f64, f64),
    ) {
        let Subinterval { signal, start, width, limit, duration } = *part;
        let change = left.0 * right.0 <= 0.0;
        if !change {
            // The rate deviates from its chord by at most M width²/8.
            if left.0.abs().min(right.0.abs()) > limit * width * width / 8.0 {
                return;
            }
            let sign = left.0.signum();
            let from = reach(sign * left.0, sign * left.1, limit);
            if from + reach(sign * right.0, -sign * right.1, limit) > width {
                return;
            }
        } else if left.0 == 0.0 && right.0 == 0.0 && left.1 == 0.0 {
            // The signal is at rest.
            return;
        }
        let steady = left.1 * right.1 > 0.0 && left.1.abs() + right.1.abs() > limit * width;
        let small = width <= 1e-6 * duration;
        if change && (steady || small) {
            // A zero at the right end belongs to the next piece.
            if right.0 != 0.0 || start + width >= duration {
                let t = start + cubic_zero(left, right, width);
                let [value, rate, acceleration] = self.signal(signal, t);
                // The rate is not exactly zero there: a Newton step to its zero corrects time and value.
                let ahead = if acceleration == 0.0 { 0.0 } else { -rate / acceleration };
                let ahead = if ahead.abs() <= width { ahead } else { 0.0 };
                visit(signal, t + ahead, value + rate * ahead / 2.0, acceleration);
            }
            return;
        }
        if small {
            return;
        }
        let half = width / 2.0;
        let [_, rate, slope] = self.signal(signal, start + half);
        self.turns_between(&Subinterval { width: half, ..*part }, [left, (rate, slope)], visit);
        let second = Subinterval { start: start + half, width: half, ..*part };
        self.turns_between(&second, [(rate, slope), right], visit);
    }
}

/// A part of a flight of `duration` s, in which the curvature of a signal's rate is at most `limit`.
#[derive(Clone, Copy)]
struct Subinterval {
    signal: Signal,
    start: f64,
    width: f64,
    limit: f64,
    duration: f64,
}

/// Rates of both displacements and slopes of these rates at a point of the grid, with bounds on the curvature
/// of the rates for all later times.
#[derive(Clone, Copy)]
struct Rates {
    rate: [f64; 2],
    slope: [f64; 2],
    limit: [f64; 2],
}

/// Matrix, row by row, that carries displacement and velocity of a free oscillator over one step.
#[derive(Clone, Copy)]
struct StepMatrix([f64; 4]);

impl StepMatrix {
    fn new(oscillator: &Oscillator, step: f64) -> StepMatrix {
        let ((a, c), (b, d)) = (oscillator.free(1.0, 0.0, step), oscillator.free(0.0, 1.0, step));
        StepMatrix([a, b, c, d])
    }

    #[inline]
    fn on(&self, (x, v): (f64, f64)) -> (f64, f64) {
        let [a, b, c, d] = self.0;
        (a * x + b * v, c * x + d * v)
    }
}

/// Time for which a rate with this value > 0 and this slope certainly stays above zero, if its curvature is
/// at most `limit`.
#[inline]
fn reach(value: f64, slope: f64, limit: f64) -> f64 {
    let root = (slope * slope + 2.0 * limit * value).sqrt();
    if slope < 0.0 { 2.0 * value / (root - slope) } else { (slope + root) / limit }
}

/// Zero of the cubic with these values and slopes at 0 and `width`, where the values have opposite signs.
fn cubic_zero((f0, s0): (f64, f64), (f1, s1): (f64, f64), width: f64) -> f64 {
    let (s0, s1) = (s0 * width, s1 * width);
    let (c2, c3) = (3.0 * (f1 - f0) - 2.0 * s0 - s1, s0 + s1 - 2.0 * (f1 - f0));
    let mut u = if f0 == f1 { 0.5 } else { f0 / (f0 - f1) };
    for _ in 0..3 {
        let value = f0 + u * (s0 + u * (c2 + u * c3));
        let slope = s0 + u * (2.0 * c2 + 3.0 * u * c3);
        if slope == 0.0 {
            break;
        }
        u = (u - value / slope).clamp(0.0, 1.0);
    }
    u * width
}
