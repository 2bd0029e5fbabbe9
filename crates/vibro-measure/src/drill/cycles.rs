//! Turns over their phase: time-synchronous average, displacement, and bandwidth of the motion.

use super::faults::State;
use super::turns;
use super::turns::Turn;
use crate::mean::average;
use serde::Serialize;
use vibro_record::median;

/// The velocity of one turn at the phases of the average.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle<'a> {
    /// Turn, counted from 0 among the whole turns.
    pub number: usize,
    /// Time of its first edge from the first sample, in s.
    pub time: f64,
    /// Turns a second.
    pub speed: f64,
    /// Velocity in m/s at equal steps of the phase from 0 on, smoothed as the average is; NaN where it was
    /// not measured.
    pub velocity: &'a [f64],
}

/// The time-synchronous average.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Phases {
    /// Phase in turns after the edge.
    pub phase: Vec<f64>,
    /// Mean velocity in m/s.
    pub mean: Vec<f64>,
    /// Standard deviation from turn to turn, in m/s.
    pub std: Vec<f64>,
}

/// How fast a motion changes, and whether the sampling can follow.
///
/// The frequencies f₁ = a/(2πv) and f₂ = j/(2πa) are those of the sine with the same ratio of largest
/// acceleration to speed and of largest jerk to acceleration: medians over the turns.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bandwidth {
    /// Frequency from acceleration and speed, in Hz.
    pub f1: f64,
    /// Frequency from jerk and acceleration, in Hz.
    pub f2: f64,
    /// Half the sampling rate, in Hz.
    pub nyquist: f64,
    /// Largest speed in m/s.
    pub speed: f64,
    /// Largest acceleration in m/s².
    pub acceleration: f64,
    /// Largest jerk in m/s³.
    pub jerk: f64,
    /// Whether f₂ is within a factor of two of a quarter of the sampling rate, the most that differences of
    /// samples can show: then it describes the sampling, not the motion.
    pub sampling_limited: bool,
}

/// Count, mean and sum of squared deviations (B. Welford, Technometrics 4 (1962) 419).
#[derive(Debug, Clone, Copy, Default)]
struct RunningMoments {
    n: usize,
    mean: f64,
    squares: f64,
}

impl RunningMoments {
    fn push(&mut self, value: f64) {
        self.n += 1;
        let step = value - self.mean;
        self.mean += step / self.n as f64;
        self.squares += step * (value - self.mean);
    }

    /// Standard deviation; NaN for fewer than two values.
    fn std(&self) -> f64 {
        if self.n < 2 { f64::NAN } else { (self.squares / (self.n - 1) as f64).sqrt() }
    }
}

/// Sums over the turns of a record, added one by one.
#[derive(Debug, Default)]
pub(super) struct Cycles {
    /// Samples a second.
    rate: f64,
    points: Vec<RunningMoments>,
    row: Vec<f64>,
    /// Largest speed, acceleration and jerk of each turn, with the sample as the unit of time.
    tops: [Vec<f64>; 3],
    /// Peak-to-peak displacement of each turn, in m.
    pub stroke: Vec<f64>,
    /// Loss of stroke of each turn by the smoothing of the velocity, in m.
    pub blunted: Vec<f64>,
    /// Displacement at the end of each turn, in m; it is removed evenly over the turn before the stroke is
    /// taken.
    pub drift: Vec<f64>,
}

impl Cycles {
    /// Empty sums at `points` phases of a turn, the first at the edge that begins it; `rate` in Hz.
    pub fn new(rate: f64, points: usize) -> Cycles {
        Cycles { rate, points: vec![RunningMoments::default(); points], ..Cycles::default() }
    }

    /// Averages a turn. Phases next to a sample that was not measured are left out.
    pub fn average(&mut self, values: &[f64], states: &[State], number: usize, turn: Turn) -> Cycle<'_> {
        let Turn { start, end } = turn;
        self.row.clear();
        let step = (end - start) / self.points.len().max(1) as f64;
        for (k, point) in self.points.iter_mut().enumerate() {
            let at = start + k as f64 * step;
            let i = at as usize;
            let good = states.get(i..i + 2).is_some_and(|s| s.iter().all(|s| s.measured()));
            let value = turns::value(values, at).filter(|_| good);
            if let Some(v) = value {
                point.push(v);
            }
            self.row.push(value.unwrap_or(f64::NAN));
        }
        let (time, speed) = (start / self.rate, self.rate / (end - start));
        Cycle { number, time, speed, velocity: &self.row }
    }

    /// Takes the largest speed, acceleration and jerk of the same turn, from central differences of measured
    /// samples.
    pub fn differentiate(&mut self, values: &[f64], states: &[State], turn: Turn) {
        let mut top = [0.0f64; 3];
        for i in (turn.start.ceil() as usize).max(1)..turn.end.ceil() as usize {
            let (Some(v), Some(s)) = (values.get(i - 1..i + 2), states.get(i - 1..i + 2)) else { break };
            if s.iter().all(|s| s.measured()) {
                let changes = [v[1], 0.5 * (v[2] - v[0]), v[2] - 2.0 * v[1] + v[0]];
                top = [0, 1, 2].map(|k| top[k].max(changes[k].abs()));
            }
        }
        self.tops.iter_mut().zip(top).for_each(|(all, top)| all.push(top));
    }

    /// Integrates the same turn, from the smoothed and from the measured velocity.
    pub fn integrate(&mut self, smooth: &[f64], values: &[f64], turn: Turn) {
        if let Some((stroke, drift)) = self.path(smooth, turn) {
            self.stroke.push(stroke);
            self.drift.push(drift);
            self.blunted.extend(self.path(values, turn).map(|whole| whole.0 - stroke));
        }
    }

    /// Stroke and drift of a turn in m, by trapezoids from edge to edge. The drift is removed as a constant
    /// velocity before the stroke is taken.
    fn path(&self, values: &[f64], turn: Turn) -> Option<(f64, f64)> {
        let Turn { start, end } = turn;
        let (first, last) = (turns::value(values, start)?, turns::value(values, end)?);
        let inside = (start.ceil() as usize..=end.floor() as usize).map(|i| (i as f64, values[i]));
        let (mut at, mut v, mut x) = (start, first, 0.0);
        let mut path = vec![(0.0, 0.0)];
        for (next, w) in inside.chain([(end, last)]) {
            x += 0.5 * (v + w) * (next - at) / self.rate;
            (at, v) = (next, w);
            path.push((at - start, x));
        }
        let slope = x / (end - start);
        let level = path.iter().map(|(t, x)| x - slope * t);
        let (low, high) = level.fold((0.0f64, 0.0f64), |(l, h), x| (l.min(x), h.max(x)));
        Some((high - low, x))
    }

    /// The average over the turns; NaN where a phase has no value.
    pub fn phases(&self) -> Phases {
        let n = self.points.len() as f64;
        let mean = |p: &RunningMoments| if p.n == 0 { f64::NAN } else { p.mean };
        Phases {
            phase: (0..self.points.len()).map(|k| k as f64 / n).collect(),
            mean: self.points.iter().map(mean).collect(),
            std: self.points.iter().map(RunningMoments::std).collect(),
        }
    }

    /// Bandwidth that the motion needs.
    pub fn bandwidth(&self) -> Bandwidth {
        let rate = self.rate;
        let [speed, acceleration, jerk] = self.tops.each_ref().map(median);
        let (acceleration, jerk) = (acceleration * rate, jerk * rate * rate);
        let ratio = |a: f64, b: f64| if b > 0.0 { a / b / std::f64::consts::TAU } else { f64::NAN };
        let (f1, f2) = (ratio(acceleration, speed), ratio(jerk, acceleration));
        let sampling_limited = f2 >= LIMITED * rate;
        Bandwidth { f1, f2, nyquist: 0.5 * rate, speed, acceleration, jerk, sampling_limited }
    }
}

/// Least f₂ over the sampling rate at which the sampling limits f₂. For a sine of eight samples a period,
/// the first difference over two samples is 10 % below the derivative, the second difference 5 %.
const LIMITED: f64 = 0.125;

/// Displacement in m over the phase of a turn of `period` seconds, from velocities in m/s at equal phases.
/// Its mean is 0, and so is its gain over a turn.
pub(super) fn displacement(velocity: &[f64], period: f64) -> Vec<f64> {
    let (drift, step) = (average(velocity), period / velocity.len().max(1) as f64);
    let (mut x, mut path) = (0.0, Vec::with_capacity(velocity.len()));
    for (v, next) in velocity.iter().zip(velocity.iter().cycle().skip(1)) {
        path.push(x);
        x += (0.5 * (v + next) - drift) * step;
    }
    let middle = average(&path);
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
        let mut motion = Cycles::new(rate, 1);
        let period = rate / f;
        for k in 0..8 {
            let start = 3.7 + f64::from(k) * period;
            let turn = Turn { start, end: start + period };
            motion.differentiate(&values, &vec![State::Good; 2000], turn);
            motion.integrate(&values, &values, turn);
        }
        // Trapezoids under a sine are too small by (2πf/rate)²/12 = 7e-5; the crest lies between samples, up
        // to (2πf/rate)²/8 above them.
        let stroke = 2.0 * amplitude / (TAU * f);
        assert!(motion.stroke.iter().all(|s| (s / stroke - 1.0).abs() < 2e-4), "{:?}", motion.stroke);
        assert!(motion.drift.iter().all(|d| (d * f / 0.02 - 1.0).abs() < 1e-3), "{:?}", motion.drift);
        let bandwidth = motion.bandwidth();
        // The offset adds 0.02 to 3 m/s; the differences are too small by (2πf/rate)²/6.
        assert!(
            (bandwidth.f1 / f - 3.0 / 3.02).abs() < 1e-3 && (bandwidth.f2 / f - 1.0).abs() < 1e-3,
            "{bandwidth:?}"
        );
        assert!(!bandwidth.sampling_limited);
    }

    #[test]
    fn a_step_is_limited_by_the_sampling() {
        let values: Vec<f64> = (0..1000).map(|i| if i % 100 < 50 { 1.0 } else { -1.0 }).collect();
        let mut motion = Cycles::new(1e4, 1);
        motion.differentiate(&values, &vec![State::Good; 1000], Turn { start: 100.0, end: 900.0 });
        assert!(motion.bandwidth().sampling_limited);
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

    #[test]
    fn as_two_passes_have_it() {
        let values = [1e6 + 1.0, 1e6 + 2.0, 1e6 + 4.0];
        let mut running = RunningMoments::default();
        for v in values {
            running.push(v);
        }
        let mean = values.iter().sum::<f64>() / 3.0;
        let squares = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        // Roundings of 1e6 are 1e-10.
        assert!((running.mean - mean).abs() < 1e-9 && (running.squares - squares).abs() < 1e-8);
    }

    #[test]
    fn turns_of_changing_length_fall_on_each_other() {
        let mut average = Cycles::new(1.0, 90);
        let edges = [3.3, 1003.9, 1903.1, 3010.0];
        let amplitude = [1.0, 1.1, 1.2];
        let turn = |t: f64| edges.iter().rposition(|e| *e <= t).unwrap_or(0).min(2);
        let values: Vec<f64> = (0..3100)
            .map(|i| {
                let k = turn(f64::from(i));
                let phase = (f64::from(i) - edges[k]) / (edges[k + 1] - edges[k]);
                amplitude[k] * (TAU * phase).sin()
            })
            .collect();
        let mut states = vec![State::Good; values.len()];
        states[1100..1110].fill(State::Bridged);
        for w in edges.windows(2) {
            average.average(&values, &states, 0, Turn { start: w[0], end: w[1] });
        }
        let counts: Vec<usize> = average.points.iter().map(|p| p.n).collect();
        let found = average.phases();
        for (k, (phase, (mean, std))) in found.phase.iter().zip(found.mean.iter().zip(&found.std)).enumerate()
        {
            let sine = (TAU * phase).sin();
            let gap =
                (1002.0..1112.0).contains(&(edges[1] + phase * (edges[2] - edges[1]))) && counts[k] == 2;
            let (truth, scatter) =
                if gap { (1.1 * sine, 0.02f64.sqrt() * sine) } else { (1.1 * sine, 0.1 * sine) };
            // Cubic interpolation between samples 2π/900 rad apart is off by 1e-9; at the kinks of the
            // slope, where turns meet, by 0.4·2π/900/8.
            let near = if k == 0 { 4e-4 } else { 1e-8 };
            assert!((mean - truth).abs() < near, "{phase}: {mean} {truth}");
            assert!((std - scatter.abs()).abs() < near, "{phase}: {std} {scatter}");
        }
        assert!(counts.contains(&2));
    }
}
