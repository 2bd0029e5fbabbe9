//! Clocks of loggers and telephones: the even grid that jittering instants mean, and the stretches between lost samples.

use crate::Finding;
use std::ops::Range;

/// Largest jitter, as a part of a step, of an instant on an even grid. Below 1/6: where every third sample is lost, all that are left lie within
/// 1/6 of a step of another even grid. No other pattern of lost samples has them nearer.
const JITTER: f64 = 0.15;
/// The same with the rounding of what is printed. Behind a lost sample instants are half a step from the line through all of them.
const ROUNDED: f64 = 0.4;
/// Fewest instants that tell jitter from a lost sample: it bends the line through fewer so far that it lies near all of them.
const FEWEST: usize = 16;
/// Parts of a record whose steps are compared for the uncertainty of the step.
const PARTS: usize = 8;
/// Instants that a part must have for a step of its own.
const FEWEST_OF_PART: usize = 8;
/// Steps further from the median step than this part of it end a stretch.
const BREAK: f64 = 0.5;
/// Samples a period at which analysers end their base band.
const BASE_BAND: f64 = 2.56;
/// Error of an amplitude, as a part of it, that a person must know of.
const VISIBLE: f64 = 0.01;

/// An even clock, found from instants that jitter about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// First instant of the grid in s.
    pub start: f64,
    /// Sampling interval in s, by least squares.
    pub step: f64,
    /// Its standard uncertainty in s: of steps that jitter, wander or drift.
    pub step_std: f64,
    /// Standard deviation in s of the instants from the grid.
    pub jitter: f64,
}

impl Clock {
    /// Code of the finding that instants jitter.
    pub const JITTERS: &str = "axis-jitter";

    /// The clock of `instants` in s, which were printed to within `resolution`; `None` where they do not lie on an even grid within 0.15 of
    /// a step, or are fewer than 16.
    pub fn of(instants: &[f64], resolution: f64) -> Option<Clock> {
        Clock::within(instants, |step| (JITTER * step + resolution).min(ROUNDED * step))
    }

    /// The clock of instants that lie within `tolerance` of an even grid with that step.
    fn within(instants: &[f64], tolerance: impl Fn(f64) -> f64) -> Option<Clock> {
        let n = instants.len();
        if n < FEWEST {
            return None;
        }
        let line = Line::through(instants);
        let tolerance = tolerance(line.step);
        let near = |(i, t): (usize, &f64)| (t - line.at(i)).abs() <= tolerance;
        let risen = line.step > 0.0 && line.step.is_finite();
        if !risen || !instants.iter().enumerate().all(near) {
            return None;
        }
        let squares: f64 = instants.iter().enumerate().map(|(i, t)| (t - line.at(i)).powi(2)).sum();
        let jitter = (squares / (n - 2) as f64).sqrt();
        Some(Clock { start: line.at(0), step: line.step, step_std: step_std(instants, jitter), jitter })
    }

    /// Sampling rate in Hz and its standard uncertainty.
    pub fn rate(&self) -> (f64, f64) {
        (1.0 / self.step, self.step_std / self.step.powi(2))
    }

    /// The finding that a column is used as even: the rate, the jitter, and what it does to the amplitude of a sine at the end of the base band,
    /// 2πf·σ of it at most.
    pub fn finding(&self, column: &str) -> Finding {
        let (rate, std) = self.rate();
        let frequency = rate / BASE_BAND;
        let error = std::f64::consts::TAU * frequency * self.jitter;
        let found =
            if error > VISIBLE { Finding::caution(Clock::JITTERS) } else { Finding::note(Clock::JITTERS) };
        let found = found.name("column", column).number("rate", rate).number("std", std);
        found
            .number("jitter", self.jitter)
            .number("relative", std / rate)
            .number("frequency", frequency)
            .number("error", error)
    }
}

/// Standard uncertainty of the step. Independent jitter of size σ gives σ·√(12/n³). The steps of eight parts differ by jitter, too, and as far
/// as the clock wanders or drifts; their mean is as good as the line through all where deviations add up from step to step, and never better.
fn step_std(instants: &[f64], jitter: f64) -> f64 {
    let n = instants.len();
    let independent = jitter * (12.0 / (n as f64).powi(3)).sqrt();
    if n < PARTS * FEWEST_OF_PART {
        return independent;
    }
    let of = |part: usize| Line::through(&instants[part * n / PARTS..(part + 1) * n / PARTS]).step;
    let steps: Vec<f64> = (0..PARTS).map(of).collect();
    let mean = steps.iter().sum::<f64>() / PARTS as f64;
    let squares: f64 = steps.iter().map(|step| (step - mean).powi(2)).sum();
    independent.hypot((squares / ((PARTS - 1) * PARTS) as f64).sqrt())
}

/// The line through instants by least squares.
struct Line {
    centre: f64,
    mean: f64,
    step: f64,
}

impl Line {
    fn through(instants: &[f64]) -> Line {
        // Differences from the first: seconds since 1970 have few digits left for a step.
        let (n, first) = (instants.len() as f64, instants[0]);
        let centre = (n - 1.0) / 2.0;
        let mean = first + instants.iter().map(|t| t - first).sum::<f64>() / n;
        let moment: f64 = instants.iter().enumerate().map(|(i, t)| (i as f64 - centre) * (t - first)).sum();
        Line { centre, mean, step: moment / (n * (n * n - 1.0) / 12.0) }
    }

    fn at(&self, i: usize) -> f64 {
        self.mean + (i as f64 - self.centre) * self.step
    }
}

/// What lies between lost samples, pauses and restarts of a clock.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Its samples.
    pub samples: Range<usize>,
    /// Its clock.
    pub clock: Clock,
}

impl Stretch {
    /// The longest of several, with its number from 1.
    pub fn longest(all: &[Stretch]) -> Option<(usize, &Stretch)> {
        (1..).zip(all).max_by(|a, b| a.1.duration().total_cmp(&b.1.duration()))
    }

    /// Its duration in s.
    pub fn duration(&self) -> f64 {
        self.clock.step * self.samples.len() as f64
    }
}

/// The stretches of `instants` in s that have an even clock, in order; empty where they hold less than half of the instants. No step of them is near two: that of
/// a lost sample, so instants may be off as far as jitter and rounding together put them.
pub fn stretches(instants: &[f64]) -> Vec<Stretch> {
    let steps: Vec<f64> = instants.windows(2).map(|w| w[1] - w[0]).collect();
    let Some(median) = median(&steps) else { return Vec::new() };
    let breaks = |(_, step): &(usize, &f64)| step.is_nan() || (*step - median).abs() > BREAK * median;
    let ends = steps.iter().enumerate().filter(breaks).map(|(i, _)| i + 1).chain([instants.len()]);
    let mut first = 0;
    let runs = ends.map(|end| std::mem::replace(&mut first, end)..end);
    let stretch = |samples: Range<usize>| {
        let clock = Clock::within(&instants[samples.clone()], |step| ROUNDED * step)?;
        Some(Stretch { samples, clock })
    };
    let all: Vec<Stretch> = runs.filter_map(stretch).collect();
    let held: usize = all.iter().map(|stretch| stretch.samples.len()).sum();
    // Steps of any size have even stretches, too, by chance.
    if 2 * held < instants.len() { Vec::new() } else { all }
}

/// Median of steps; `None` where there are none or it is not above 0.
pub(crate) fn median(steps: &[f64]) -> Option<f64> {
    let mut sorted = steps.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().filter(|median| *median > 0.0 && median.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in [0, 1) by a linear congruence, good enough for jitter.
    fn uniform(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    /// How often the true step lies within 2 of its standard uncertainties, and how large the uncertainty is beside the actual scatter.
    fn coverage(instants: impl Fn(u64) -> Vec<f64>, step: f64) -> (f64, f64) {
        const DRAWS: u64 = 400;
        let found: Vec<Clock> =
            (1..=DRAWS).map(|seed| Clock::of(&instants(seed), 0.0).expect("even")).collect();
        let held = found.iter().filter(|c| (c.step - step).abs() <= 2.0 * c.step_std).count();
        let rms = |of: &dyn Fn(&Clock) -> f64| {
            (found.iter().map(|c| of(c).powi(2)).sum::<f64>() / DRAWS as f64).sqrt()
        };
        (held as f64 / DRAWS as f64, rms(&|c| c.step_std) / rms(&|c| c.step - step))
    }

    #[test]
    fn the_uncertainty_of_the_step_holds_for_jitter_that_is_independent_and_that_adds_up() {
        let independent = |seed| {
            let mut draw = uniform(seed);
            (0..1000).map(|i| 0.01 * f64::from(i) + 2e-4 * (draw() - 0.5)).collect::<Vec<_>>()
        };
        let wandering = |seed| {
            let (mut draw, mut t) = (uniform(seed), 0.0);
            let mut next = || {
                t += 0.01 + 2e-5 * (draw() - 0.5);
                t
            };
            (0..1000).map(|_| next()).collect::<Vec<_>>()
        };
        // Student with 7 degrees of freedom has 91.4 % within 2; 400 draws scatter by 1.4 %, three times that is allowed.
        let (held, ratio) = coverage(wandering, 0.01);
        assert!((0.87..=0.96).contains(&held), "{held}");
        // Both are the same for deviations that add up: 6σ²/5n. 400 draws of 7 degrees of freedom scatter by 4 %.
        assert!((0.85..=1.2).contains(&ratio), "{ratio}");
        // Of independent jitter the mean of eight parts is eight times less certain than the line; that is not too sure.
        let (held, ratio) = coverage(independent, 0.01);
        assert!(held > 0.97, "{held}");
        assert!((6.5..=9.5).contains(&ratio), "{ratio}");
    }

    #[test]
    fn no_lost_sample_passes_for_jitter() {
        for seed in 1..=200 {
            let mut draw = uniform(seed);
            let n = 20 + (draw() * 300.0) as usize;
            let lost = 1 + (draw() * (n - 2) as f64) as usize;
            // The line through few is off by a tenth of their jitter, too.
            let size = 1.8 * JITTER * draw();
            let mut instants: Vec<f64> = (0..n).map(|i| i as f64 + size * (draw() - 0.5)).collect();
            assert!(Clock::of(&instants, 0.0).is_some(), "{seed}");
            instants.remove(lost);
            assert_eq!(Clock::of(&instants, 0.0), None, "{seed}: {lost} of {n}, jitter {size}");
            let found = stretches(&instants);
            let long = [0..lost, lost..n - 1].into_iter().filter(|part| part.len() >= FEWEST);
            assert!(found.iter().map(|s| s.samples.clone()).eq(long), "{seed}: {found:?}");
        }
        // Every third sample lost: 1, 2, 1, 2, …
        let thirds: Vec<f64> = (0..300).filter(|i| i % 3 != 2).map(f64::from).collect();
        assert_eq!(Clock::of(&thirds, 0.0), None);
    }

    #[test]
    fn a_restart_and_a_pause_end_stretches() {
        let instants: Vec<f64> =
            (0..100).map(|i| f64::from(if i < 40 { i } else { i - 40 + 7 * i32::from(i >= 70) })).collect();
        let found = stretches(&instants);
        assert_eq!(found.iter().map(|s| s.samples.clone()).collect::<Vec<_>>(), [0..40, 40..70, 70..100]);
        assert!((found[2].clock.start - 37.0).abs() < 1e-12);
        assert!((found[2].duration() - 30.0).abs() < 1e-12);
        for odd in [vec![], vec![1.0; 50], (0..50).rev().map(f64::from).collect(), vec![f64::NAN; 50]] {
            assert_eq!(stretches(&odd), []);
            assert_eq!(Clock::of(&odd, 0.0), None);
        }
    }
}
