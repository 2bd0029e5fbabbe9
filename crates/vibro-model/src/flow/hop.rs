//! Short flights from contact to contact, as in a chatter. One Taylor series about the start proves that the
//! masses land, and gives time and state of the landing.

use super::{Flight, Free, Landing, State};

/// Longest flight, times the fastest rate, for a series of 20 terms: the remainder is (1.3)²⁰/20! = 8e-17 of
/// a displacement. Each flight is also checked against its own rounding.
const LONGEST: f64 = 1.3;
/// The same for 11 terms: the remainder is (0.2)¹¹/11! = 5e-16 of a displacement.
const SHORT: f64 = 0.2;
/// The same for 6 terms: the remainder is (0.003)⁶/6! = 1e-18 of a displacement, and 2e-15 of a speed.
const SHORTEST: f64 = 0.003;

/// Weights 1/n! of a Taylor series.
const fn weights<const N: usize>() -> [f64; N] {
    let mut weights = [1.0; N];
    let mut n = 1;
    while n < N {
        weights[n] = weights[n - 1] / n as f64;
        n += 1;
    }
    weights
}

impl Free {
    /// Displacement and its derivatives at the start, each over n!, and a bound on the next derivative for
    /// all later times.
    #[inline]
    fn terms<const N: usize>(&self) -> ([f64; N], f64) {
        let mut last = [self.x, self.v];
        let mut terms = [0.0; N];
        terms[..2].copy_from_slice(&last);
        for (term, weight) in terms[2..].iter_mut().zip(&const { weights::<N>() }[2..]) {
            let next = self.oscillator.acceleration(last[0], last[1]);
            *term = next * weight;
            last = [last[1], next];
        }
        let gain = self.oscillator.gain();
        (terms, self.oscillator.bound(last[0], last[1]) * gain * gain)
    }
}

/// Σ termsₙ tⁿ and its rate.
#[inline]
fn at<const N: usize>(terms: &[f64; N], t: f64) -> (f64, f64) {
    let (mut value, mut rate) = (0.0, 0.0);
    for term in terms.iter().rev() {
        rate = rate * t + value;
        value = value * t + term;
    }
    (value, rate)
}

impl Flight {
    /// The landing of a short flight that begins at contact; `None` where the series proves none within
    /// `duration` (s).
    ///
    /// Write the gap as g = g₀ + t q(t), where g₀ is only rounding. q falls while −g̈/2 is larger than the
    /// sum of |gₙ|(n − 1)tⁿ⁻²/n! from n = 3 on, with the n-th derivative gₙ at the start. If q falls up to
    /// 1.25 times the flight time 2w/(−g̈) of a constant g̈, and is below 0 there, q has one root before, and
    /// g is positive up to it. The truncation Mtᴺ/N! of N terms must be below `rounding` (m).
    #[inline]
    pub(super) fn hop(&self, duration: f64, rounding: f64) -> Option<Landing> {
        let [first, second] = &self.free;
        let [x, v, a, ..] = self.waves.at(0.0);
        let w = second.v - first.v - v;
        let pressed = first.oscillator.acceleration(first.x, first.v) + a
            - second.oscillator.acceleration(second.x, second.v);
        let longest = 2.5 * w / pressed;
        let fastest = self.waves.fastest().max(first.oscillator.gain()).max(second.oscillator.gain());
        let touches = (self.gap + second.x - first.x - x - self.rest).abs() <= 32.0 * rounding;
        if !(touches && w > 0.0 && pressed > 0.0 && longest * fastest < LONGEST) {
            return None;
        }
        let landing = match longest * fastest {
            span if span < SHORTEST => self.summed::<6>(longest, [w, pressed], rounding),
            span if span < SHORT => self.summed::<11>(longest, [w, pressed], rounding),
            _ => self.summed::<20>(longest, [w, pressed], rounding),
        };
        landing.filter(|l| l.time <= duration)
    }

    /// The landing within `longest` (s) by a series of `N` terms, after a separation at `w` (m/s) against an
    /// acceleration `pressed` (m/s²).
    #[inline]
    fn summed<const N: usize>(&self, longest: f64, [w, pressed]: [f64; 2], rounding: f64) -> Option<Landing> {
        let [(mut one, first), (two, second)] = [self.free[0].terms::<N>(), self.free[1].terms::<N>()];
        let forced = self.waves.terms(&const { weights::<N>() }, &mut one);
        one[0] += self.rest;
        let left = (first + second + forced) * const { weights::<N>()[N - 1] / N as f64 };
        let mut gap: [f64; N] = std::array::from_fn(|n| two[n] - one[n]);
        gap[0] += self.gap;
        // Powers of the time from the third term on, and the bound on what these terms add to the rate of q.
        let (mut power, mut bends) = (1.0, 0.0);
        for (n, term) in gap.iter().enumerate().skip(3) {
            power *= longest;
            bends += term.abs() * (n - 1) as f64 * power;
        }
        bends += left * N as f64 * power * longest;
        if !(left * power * longest * longest * longest <= rounding && bends < -gap[2])
            || at(&gap, longest).0 >= -rounding
        {
            return None;
        }
        // Newton's method from the flight time of a constant jerk: after a step of 1e-8 the error is 1e-16.
        let mut time = 2.0 * w / pressed * (1.0 + 4.0 * gap[3] * w / (pressed * pressed));
        for _ in 0..6 {
            let (value, rate) = at(&gap, time);
            let step = value / rate;
            time -= step;
            if step.abs() <= 1e-8 * time {
                let [(x1, v1), (x2, v2)] = [at(&one, time), at(&two, time)];
                return (v1 > v2).then_some(Landing { time, state: State { x1, v1, x2, v2 } });
            }
        }
        None
    }
}
