//! The motion over one period of an orbit, stretch by stretch.

use super::response::Response;
use super::stretch::{Signal, Stretch};
use crate::{Green, State};
use num_complex::Complex64;
use vibro_math::Oscillator;

/// The motion of an orbit from just after an impact to just before the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Course {
    /// Under a sine force: one stretch.
    Smooth {
        stretch: Stretch,
        /// T in s.
        period: f64,
    },
    /// Under impulses or pulses: their steady motion less the impact's.
    Broken {
        response: Response,
        greens: [Green; 2],
        impulse: f64,
        /// Time from the beginning of the pulse to the impact, in s.
        delay: f64,
        gap: f64,
    },
}

impl Course {
    /// T in s.
    pub fn period(&self) -> f64 {
        match self {
            Course::Smooth { period, .. } => *period,
            Course::Broken { greens, .. } => greens[0].period(),
        }
    }

    /// State at `t`, 0 ≤ `t` ≤ T; at 0 that after the impact, at T that before the next.
    pub fn state(&self, t: f64) -> State {
        match self {
            Course::Smooth { stretch, .. } => stretch.state(t),
            Course::Broken { response, greens, impulse, delay, .. } => {
                let at = if t == self.period() { *delay } else { (t + delay).rem_euclid(response.cycle) };
                let ([x, v, _], [(c1, d1), (c2, d2)]) = (response.at(at), greens.map(|g| g.at(t)));
                State { x1: x - impulse * c1, v1: v - impulse * d1, x2: impulse * c2, v2: impulse * d2 }
            }
        }
    }

    /// Visits the stretches with their starts and durations, in order.
    pub fn each(&self, mut visit: impl FnMut(f64, f64, &Stretch)) {
        match self {
            Course::Smooth { stretch, period } => visit(0.0, *period, stretch),
            Course::Broken { response, greens, impulse, delay, gap } => {
                let period = self.period();
                let (mut t, (mut piece, mut inside)) = (0.0, response.piece(*delay));
                loop {
                    let left = piece.duration - inside;
                    let duration = left.min(period - t);
                    let oscillators: [Oscillator; 2] = greens.map(|g| *g.oscillator());
                    let (x, v) = oscillators[0].free(piece.free.0, piece.free.1, inside);
                    let [(c1, d1), (c2, d2)] = greens.map(|g| g.at(t));
                    let stretch = Stretch {
                        oscillators,
                        free: [(x - impulse * c1, v - impulse * d1), (impulse * c2, impulse * d2)],
                        forced: Complex64::ZERO,
                        omega: 0.0,
                        rest: piece.rest,
                        gap: *gap,
                    };
                    visit(t, duration, &stretch);
                    t += left;
                    // What remains by rounding only is no stretch.
                    if t >= period * (1.0 - 4.0 * f64::EPSILON) {
                        return;
                    }
                    inside = 0.0;
                    let [on, off] = response.pieces();
                    piece = if piece.start == 0.0 && response.width > 0.0 || on.duration == 0.0 {
                        off
                    } else {
                        on
                    };
                }
            }
        }
    }

    /// Rates of the state just before and just after the impact.
    pub fn rates(&self) -> ([f64; 4], [f64; 4]) {
        match self {
            Course::Smooth { stretch, period } => (stretch.rate(*period), stretch.rate(0.0)),
            Course::Broken { response, greens, impulse, delay, .. } => {
                let [_, v, a] = response.at(*delay);
                let rate = |slopes: [f64; 2]| {
                    let mut all = [v, a, 0.0, 0.0];
                    for (i, green) in greens.iter().enumerate() {
                        let pull = if i == 0 { -impulse } else { *impulse };
                        all[2 * i] += pull * slopes[i];
                        all[2 * i + 1] += pull * green.oscillator().acceleration(green.start, slopes[i]);
                    }
                    all
                };
                (rate(greens.map(|g| g.slope_before)), rate(greens.map(|g| g.slope_after)))
            }
        }
    }

    /// Rounding error of a computed gap in m.
    pub fn noise(&self) -> f64 {
        let mut noise = 0.0_f64;
        self.each(|_, _, stretch| noise = noise.max(stretch.noise()));
        noise
    }

    /// How far both masses move, and every smallest gap inside the period, the impact left out.
    pub fn survey(&self) -> Survey {
        let period = self.period();
        // What lies nearer to the impact than this is the impact itself (without rebound the gap starts at zero rate).
        let margin = 1e-9 * period;
        let mut ends = [(f64::INFINITY, f64::NEG_INFINITY); 2];
        let mut closest = None::<f64>;
        let mut before = None::<f64>;
        self.each(|start, duration, stretch| {
            let mut near = |t: f64, gap: f64| {
                if t > margin && t < period - margin {
                    closest = Some(closest.map_or(gap, |c| c.min(gap)));
                }
            };
            let (first, last) = (stretch.series(0.0), stretch.series(duration));
            // A corner or a smooth least gap on the border of two stretches.
            if before.is_some_and(|before| before < 0.0 && first[1][1] >= first[0][1]) {
                near(start, stretch.gap + first[1][0] - first[0][0]);
            }
            before = Some(last[1][1] - last[0][1]);
            for (i, (low, high)) in ends.iter_mut().enumerate() {
                *low = low.min(first[i][0]).min(last[i][0]);
                *high = high.max(first[i][0]).max(last[i][0]);
            }
            stretch.each_turn(duration, |signal, t, value, bend| match signal {
                Signal::X1 => ends[0] = (ends[0].0.min(value), ends[0].1.max(value)),
                Signal::X2 => ends[1] = (ends[1].0.min(value), ends[1].1.max(value)),
                // Rate rising through zero: a smallest gap.
                Signal::Gap if bend > 0.0 => near(start + t, value),
                Signal::Gap => {}
            });
        });
        Survey { spread: ends.map(|(low, high)| high - low), closest }
    }
}

/// What a course reaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Survey {
    /// Largest minus smallest x₁ and x₂ in m.
    pub spread: [f64; 2],
    /// Smallest gap in m away from the impact; `None` where the masses part and return without one.
    pub closest: Option<f64>,
}
