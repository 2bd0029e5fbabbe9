//! Displacement and the bandwidth that a motion needs, turn by turn.

use super::crossing;
use super::faults::State;
use super::survey::median;

/// Largest speed, acceleration and jerk, and displacement over whole turns.
#[derive(Debug, Clone, Default)]
pub(super) struct Motion {
    speed: Vec<f64>,
    acceleration: Vec<f64>,
    jerk: Vec<f64>,
    stroke: Vec<f64>,
    drift: Vec<f64>,
}

/// How fast a motion changes, and whether the sampling can follow.
///
/// The frequencies f₁ = a/(2πv) and f₂ = j/(2πa) are those of the sine with the same ratio of largest acceleration to speed
/// and of largest jerk to acceleration: medians over the turns.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Bandwidth {
    /// Acceleration against speed, in Hz.
    pub f1: f64,
    /// Jerk against acceleration, in Hz.
    pub f2: f64,
    /// Half the sampling rate, in Hz.
    pub nyquist: f64,
    /// Largest speed in m/s.
    pub speed: f64,
    /// Largest acceleration in m/s².
    pub acceleration: f64,
    /// Largest jerk in m/s³.
    pub jerk: f64,
    /// Whether f₂ is within a factor of two of a quarter of the sampling rate, the most that differences of samples can
    /// show: then it is the sampling that was measured.
    pub sampling_limited: bool,
}

impl Motion {
    /// Takes the turn from `start` to `end`, in samples of `values` at `rate` samples a second: central differences of measured samples.
    pub fn push(&mut self, values: &[f64], states: &[State], start: f64, end: f64, rate: f64) {
        let (from, to) = (start.ceil() as usize, end.ceil() as usize);
        let mut top = [0.0f64; 3];
        for i in from.max(1)..to {
            let (Some(v), Some(s)) = (values.get(i - 1..i + 2), states.get(i - 1..i + 2)) else { break };
            if s.iter().all(|s| s.measured()) {
                top[0] = top[0].max(v[1].abs());
                top[1] = top[1].max((0.5 * (v[2] - v[0])).abs());
                top[2] = top[2].max((v[2] - 2.0 * v[1] + v[0]).abs());
            }
        }
        self.speed.push(top[0]);
        self.acceleration.push(top[1] * rate);
        self.jerk.push(top[2] * rate * rate);
    }

    /// Integrates the same turn, which may be smoothed here: trapezoids from edge to edge; the mean velocity of the turn is
    /// what drifts.
    pub(crate) fn displace(&mut self, values: &[f64], start: f64, end: f64, rate: f64) {
        let (Some(first), Some(last)) = (crossing::value(values, start), crossing::value(values, end)) else {
            return;
        };
        let inside = start.ceil() as usize..=end.floor() as usize;
        let Some(inner) = values.get(inside.clone()) else { return };
        let (mut at, mut v, mut x) = (start, first, 0.0);
        let mut path = vec![(0.0, 0.0)];
        for (next, w) in inside.map(|i| i as f64).zip(inner.iter().copied()).chain([(end, last)]) {
            x += 0.5 * (v + w) * (next - at) / rate;
            (at, v) = (next, w);
            path.push((at - start, x));
        }
        let slope = x / (end - start);
        let level = path.iter().map(|(t, x)| x - slope * t);
        let (low, high) = level.fold((0.0f64, 0.0f64), |(l, h), x| (l.min(x), h.max(x)));
        self.drift.push(x);
        self.stroke.push(high - low);
    }

    /// Peak-to-peak displacement of each turn, in m.
    pub fn stroke(&self) -> &[f64] {
        &self.stroke
    }

    /// Displacement left over at the end of each turn, in m; it was taken away evenly before the stroke was taken.
    pub fn drift(&self) -> &[f64] {
        &self.drift
    }

    /// What bandwidth the motion needs, sampled at `rate`.
    pub fn bandwidth(&self, rate: f64) -> Bandwidth {
        let [speed, acceleration, jerk] =
            [&self.speed, &self.acceleration, &self.jerk].map(|v| median(v.iter().copied()));
        let ratio = |a: f64, b: f64| if b > 0.0 { a / b / std::f64::consts::TAU } else { f64::NAN };
        let f2 = ratio(jerk, acceleration);
        let sampling_limited = f2 >= 0.125 * rate;
        Bandwidth {
            f1: ratio(acceleration, speed),
            f2,
            nyquist: 0.5 * rate,
            speed,
            acceleration,
            jerk,
            sampling_limited,
        }
    }
}

/// Displacement over the phase of a turn of `period` seconds, from velocities at equal phases: its mean is 0, and so is what
/// it gains over a turn.
pub(super) fn displacement(velocity: &[f64], period: f64) -> Vec<f64> {
    let n = velocity.len();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len().max(1) as f64;
    let drift = mean(velocity);
    let step = period / n.max(1) as f64;
    let mut x = 0.0;
    let mut path: Vec<f64> = Vec::with_capacity(n);
    for (k, v) in velocity.iter().enumerate() {
        path.push(x);
        let next = velocity.get(k + 1).or(velocity.first()).unwrap_or(v);
        x += (0.5 * (v + next) - drift) * step;
    }
    let middle = mean(&path);
    path.iter().map(|x| x - middle).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_sine_with_an_offset() {
        let (rate, f, amplitude) = (10_000.0, 47.3, 3.0);
        let values: Vec<f64> =
            (0..2000).map(|i| amplitude * (TAU * f * f64::from(i) / rate).cos() + 0.02).collect();
        let mut motion = Motion::default();
        let period = rate / f;
        for k in 0..8 {
            let start = 3.7 + f64::from(k) * period;
            motion.push(&values, &vec![State::Good; 2000], start, start + period, rate);
            motion.displace(&values, start, start + period, rate);
        }
        // Trapezoids of a sine fall short by (2πf/rate)²/12 = 7e-5; the top lies between samples, by (2πf/rate)²/8.
        let stroke = 2.0 * amplitude / (TAU * f);
        assert!(motion.stroke().iter().all(|s| (s / stroke - 1.0).abs() < 2e-4), "{:?}", motion.stroke());
        assert!(motion.drift().iter().all(|d| (d * f / 0.02 - 1.0).abs() < 1e-3), "{:?}", motion.drift());
        let bandwidth = motion.bandwidth(rate);
        // An offset of 0.02 in 3, and the differences short by (2πf/rate)²/6.
        assert!(
            (bandwidth.f1 / f - 3.0 / 3.02).abs() < 1e-3 && (bandwidth.f2 / f - 1.0).abs() < 1e-3,
            "{bandwidth:?}"
        );
        assert!(!bandwidth.sampling_limited);
    }

    #[test]
    fn a_step_is_limited_by_the_sampling() {
        let values: Vec<f64> = (0..1000).map(|i| if i % 100 < 50 { 1.0 } else { -1.0 }).collect();
        let mut motion = Motion::default();
        motion.push(&values, &vec![State::Good; 1000], 100.0, 900.0, 1e4);
        assert!(motion.bandwidth(1e4).sampling_limited);
    }

    #[test]
    fn an_averaged_velocity_integrates_to_its_displacement() {
        let n = 720;
        let velocity: Vec<f64> = (0..n).map(|k| 2.0 * (TAU * f64::from(k) / 720.0).cos() + 0.3).collect();
        let x = displacement(&velocity, 0.02);
        for (k, x) in x.iter().enumerate() {
            let truth = 2.0 * 0.02 / TAU * (TAU * k as f64 / 720.0).sin();
            // Trapezoids: (2π/720)²/12 of the amplitude.
            assert!((x - truth).abs() < 1e-5 * 0.0064, "{k}");
        }
    }
}
