//! Clocks of loggers and telephones: finds the even grid behind instants that jitter, and the stretches
//! between lost samples.

mod stretches;

pub use stretches::{Stretch, stretches};

use crate::Finding;
use std::cmp::Ordering;

/// Largest deviation of an instant from the fitted grid by jitter alone, over the sampling interval. Below
/// 1/6: where every third sample is lost, the others lie within 1/6 of a step of another even grid. No other
/// pattern of lost samples lies nearer to an even grid.
const JITTER: f64 = 0.15;
/// Least number of instants of a fitted clock. A line fitted to fewer tilts until it lies near all of them,
/// even where a sample is lost, so jitter and a lost sample cannot be distinguished.
const FEWEST: usize = 16;
/// Number of parts of a record that are fitted separately: the scatter of their steps gives the uncertainty
/// of the step.
const PARTS: usize = 8;
/// Least number of instants of such a part.
const FEWEST_OF_PART: usize = 8;
/// Jump of the residuals of the fitted grid, over the sampling interval, that reveals a lost sample. A lost
/// sample gives 1.
const RESIDUAL_JUMP: f64 = 0.5;
/// Least number of printed digits that a group of rows must span, so that their rounding errors average out.
const DIGITS_SPANNED: f64 = 8.0;
/// From this number of over-long intervals on they are explained by rounding; fewer may be lost samples.
/// Over-long intervals are nearer to the longest than to the shortest one, where the longest is more than 1.5
/// times the shortest.
const ROUNDED_INTERVALS: usize = 3;
/// Largest size of a printed digit, over the sampling interval, that counts as fine: it hides no lost sample
/// and shifts no instant visibly.
const FINE_DIGIT: f64 = 2e-3;
/// Sampling rate divided by the base band (the highest frequency shown), as analysers set it.
pub const RATE_OVER_BASE_BAND: f64 = 2.56;
/// Relative error of a sine's amplitude from which jitter is a caution instead of a note.
const VISIBLE_ERROR: f64 = 0.01;

/// Even clock (start and sampling interval), found from instants that were rounded when printed and may
/// jitter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// First instant of the grid in s.
    pub start: f64,
    /// Sampling interval in s.
    pub step: f64,
    /// Standard uncertainty of `step` in s, from rounding, jitter, wander and drift.
    pub step_std: f64,
    /// Standard deviation of the instants from the grid in s, with the part of rounding subtracted; 0 if
    /// rounding explains all of it.
    pub jitter: f64,
}

impl Clock {
    /// Code of the finding that instants jitter.
    pub const JITTERS: &str = "axis-jitter";

    /// The clock of `instants` in s. `resolution` in s is half a unit in their last printed digit. `None` if
    /// samples were lost or the instants fit no even grid: neither within rounding nor, from 16 instants on,
    /// within rounding and a jitter of 0.15 of a step.
    pub fn of(instants: &[f64], resolution: f64) -> Option<Clock> {
        Clock::rounded(instants, resolution).or_else(|| {
            let resolution = with_binary_rounding(instants, resolution);
            Clock::within(instants, resolution, |step| JITTER * step + resolution)
                .filter(|clock| !may_hide_lost(instants, clock, resolution))
        })
    }

    /// The clock of instants that deviate by rounding only. A range of steps gives grids that lie within
    /// `resolution` of every instant. The true step is equally likely anywhere in that range; its middle is
    /// taken.
    pub fn rounded(instants: &[f64], resolution: f64) -> Option<Clock> {
        let (n, resolution) = (instants.len(), with_binary_rounding(instants, resolution));
        let (low, high) = steps_within(instants, resolution)?;
        let step = f64::midpoint(low, high);
        if step <= 0.0 || !step.is_finite() || !over_long(instants).is_empty() {
            return None;
        }
        // One or two lost samples shorter than a digit look like a drift of the clock. Each makes the fitted
        // step too long by at most 3/(2n) of itself.
        let hidden = if step < 2.0 * resolution { 1.5 * step / (n - 1) as f64 } else { 0.0 };
        // Jitter smaller than a digit does not show. So the uncertainty is at least that of a line fitted
        // with independent errors as large as those of rounding.
        let least = line_step_std(resolution / 3f64.sqrt(), n);
        let step_std = ((high - low) / 12f64.sqrt()).hypot(hidden).hypot(least);
        let residuals = instants.iter().enumerate().map(|(i, t)| t - i as f64 * step);
        let ends = residuals.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), e| (a.min(e), b.max(e)));
        Some(Clock { start: f64::midpoint(ends.0, ends.1), step, step_std, jitter: 0.0 })
    }

    /// The clock by least squares; `None` unless all instants lie within `tolerance(step)` in s of its grid.
    fn within(instants: &[f64], resolution: f64, tolerance: impl Fn(f64) -> f64) -> Option<Clock> {
        let n = instants.len();
        if n < FEWEST {
            return None;
        }
        let line = FittedLine::through(instants);
        let tolerance = tolerance(line.step);
        let near = |(i, t): (usize, &f64)| (t - line.at(i)).abs() <= tolerance;
        let risen = line.step > 0.0 && line.step.is_finite();
        if !risen || !instants.iter().enumerate().all(near) {
            return None;
        }
        let squares: f64 = instants.iter().enumerate().map(|(i, t)| (t - line.at(i)).powi(2)).sum();
        let scatter = squares / (n - 2) as f64;
        let step_std = step_std(instants, scatter.sqrt()).hypot(uniform_std(resolution, n));
        let jitter = (scatter - resolution * resolution / 3.0).max(0.0).sqrt();
        Some(Clock { start: line.at(0), step: line.step, step_std, jitter })
    }

    /// Sampling rate in Hz and its standard uncertainty.
    pub fn rate(&self) -> (f64, f64) {
        (1.0 / self.step, self.step_std / self.step.powi(2))
    }

    /// Relative standard uncertainty, the same for step and rate.
    pub fn relative(&self) -> f64 {
        self.step_std / self.step
    }

    /// Finding that a column is replaced by an even grid. Without jitter it states the rounding. Else it
    /// states rate, jitter σ and the largest relative error of a sine's amplitude, 2πfσ, at the end of the
    /// base band.
    pub fn finding(&self, column: &str) -> Finding {
        let (rate, std) = self.rate();
        if self.jitter == 0.0 {
            let found = Finding::note("axis-rounded").name("column", column);
            return found.number("step", self.step).number("std", self.step_std);
        }
        let frequency = rate / RATE_OVER_BASE_BAND;
        let error = std::f64::consts::TAU * frequency * self.jitter;
        let found = if error > VISIBLE_ERROR {
            Finding::caution(Clock::JITTERS)
        } else {
            Finding::note(Clock::JITTERS)
        };
        let found = found.name("column", column).number("rate", rate).number("std", std);
        found
            .number("jitter", self.jitter)
            .number("relative", std / rate)
            .number("frequency", frequency)
            .number("error", error)
    }
}

/// Standard uncertainty of the mean step between the first and the last of `n` instants, each rounded to
/// within ±`resolution`. The difference of both is taken as uniform within ±2·resolution (conservative:
/// independent rounding errors would give 1/√2 of it).
pub fn uniform_std(resolution: f64, n: usize) -> f64 {
    2.0 * resolution / (3f64.sqrt() * n.saturating_sub(1).max(1) as f64)
}

/// Whether printed digits are so fine that rounding hides no lost sample and shifts no instant visibly from a
/// grid of that step; `resolution` is half a unit in the last digit.
pub fn is_fine(resolution: f64, step: f64) -> bool {
    2.0 * resolution <= FINE_DIGIT * step
}

/// Resolution in s of instants as doubles: that of their printed digits, with the rounding of binary numbers
/// of their size added.
fn with_binary_rounding(instants: &[f64], resolution: f64) -> f64 {
    let largest = instants.iter().fold(0.0, |largest: f64, t| largest.max(t.abs()));
    resolution * (1.0 + 1e-6) + 4.0 * f64::EPSILON * largest
}

/// Smallest and largest step of an even grid that lies within `resolution` of all instants; `None` if there
/// is no such grid, and for fewer than three instants.
fn steps_within(instants: &[f64], resolution: f64) -> Option<(f64, f64)> {
    if instants.len() < 3 {
        return None;
    }
    let (low, high) = (-largest_step(instants, -1.0, resolution), largest_step(instants, 1.0, resolution));
    (low <= high).then_some((low, high))
}

/// Largest step of an even grid that lies within `resolution` of all instants: the least
/// (tⱼ − tᵢ + 2·resolution)/(j − i) among all pairs i < j. The instants are multiplied by `sign`: with −1 the
/// result is minus the smallest step. Dinkelbach's iteration: the pair that violates the present step most
/// gives the next step.
fn largest_step(instants: &[f64], sign: f64, resolution: f64) -> f64 {
    let n = instants.len();
    let (first, last) = (sign * instants[0], sign * instants[n - 1]);
    let mut step = (last - first + 2.0 * resolution) / (n - 1) as f64;
    loop {
        // `latest`: (index, time) of the instant that is latest relative to the grid so far. `worst`: the
        // largest amount by which a later instant is early relative to it, and the largest step that this
        // pair of instants allows.
        let (mut latest, mut worst) = ((0, first), (0.0, step));
        for (j, t) in instants.iter().map(|t| sign * t).enumerate() {
            let count = (j - latest.0) as f64;
            let early = latest.1 - t + count * step;
            if early < 0.0 {
                latest = (j, t);
            } else if early > worst.0 {
                worst = (early, (t - latest.1 + 2.0 * resolution) / count);
            }
        }
        // Stops, too, at a missing instant (NaN), which compares as not less.
        if worst.1.partial_cmp(&step) != Some(Ordering::Less) {
            return step;
        }
        step = worst.1;
    }
}

/// Indices of the over-long intervals (nearer to the longest than to the shortest), if there are one or two:
/// samples were probably lost there, while the sampling interval is about one printed digit. Empty if no
/// interval exceeds the shortest by more than half, and for three or more, which rounding explains.
fn over_long(instants: &[f64]) -> Vec<usize> {
    let steps = || instants.windows(2).map(|w| w[1] - w[0]);
    let (low, high) = steps().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(d), b.max(d)));
    if low <= 0.0 || high <= 1.5 * low {
        return Vec::new();
    }
    let long = steps().enumerate().filter(|(_, d)| *d > f64::midpoint(low, high)).map(|(i, _)| i);
    let long: Vec<usize> = long.take(ROUNDED_INTERVALS).collect();
    if long.len() < ROUNDED_INTERVALS { long } else { Vec::new() }
}

/// Whether a lost sample may be hidden by rounding: the residuals of the fitted line jump by more than half a
/// step at some instant. With a printed digit of about one sampling interval no single interval or residual
/// shows a lost sample; their cumulated sum does. Returns true also if there are too few instants to decide.
fn may_hide_lost(instants: &[f64], clock: &Clock, resolution: f64) -> bool {
    // Finer digits show every lost sample as a large residual, which `Clock::within` refuses.
    let digit = 2.0 * resolution;
    if digit < 0.5 * clock.step {
        return false;
    }
    let n = instants.len();
    let rows = (DIGITS_SPANNED * digit / clock.step).ceil().max(DIGITS_SPANNED) as usize;
    if n / 4 < rows {
        return true;
    }
    let (whole, mut cumulated) = (n as f64, 0.0);
    instants.iter().enumerate().take(n - rows).any(|(i, t)| {
        cumulated += t - (clock.start + i as f64 * clock.step);
        let part = (i + 1) as f64;
        let both = part * (whole - part);
        // Height of a step after instant i, fitted by least squares together with a line.
        let jump = cumulated / (both / whole * (1.0 - 3.0 * both / (whole * whole - 1.0)));
        i + 1 >= rows && jump.abs() > RESIDUAL_JUMP * clock.step
    })
}

/// Standard uncertainty of the step of a line fitted to `n` instants with independent errors of standard
/// deviation `std`.
fn line_step_std(std: f64, n: usize) -> f64 {
    std * (12.0 / (n as f64).powi(3)).sqrt()
}

/// Standard uncertainty of the step. Independent jitter of standard deviation σ gives σ·√(12/n³). Wander and
/// drift of the clock are added, as the standard uncertainty of the mean of the steps of eight parts. That
/// mean is as certain as the line through all instants if deviations add up from step to step, else less
/// certain.
fn step_std(instants: &[f64], jitter: f64) -> f64 {
    let n = instants.len();
    let independent = line_step_std(jitter, n);
    if n < PARTS * FEWEST_OF_PART {
        return independent;
    }
    let step_of = |part: usize| FittedLine::through(&instants[part * n / PARTS..(part + 1) * n / PARTS]).step;
    let steps: Vec<f64> = (0..PARTS).map(step_of).collect();
    let mean = steps.iter().sum::<f64>() / PARTS as f64;
    let squares: f64 = steps.iter().map(|step| (step - mean).powi(2)).sum();
    independent.hypot((squares / ((PARTS - 1) * PARTS) as f64).sqrt())
}

/// Least-squares line of the instants as a function of their index.
struct FittedLine {
    /// Mean index.
    centre: f64,
    /// Mean instant in s.
    mean: f64,
    /// Slope in s per index.
    step: f64,
}

impl FittedLine {
    fn through(instants: &[f64]) -> FittedLine {
        // Differences from the first instant: seconds since 1970 leave few digits of a double for a step.
        let (n, first) = (instants.len() as f64, instants[0]);
        let centre = (n - 1.0) / 2.0;
        let mean = first + instants.iter().map(|t| t - first).sum::<f64>() / n;
        let moment: f64 = instants.iter().enumerate().map(|(i, t)| (i as f64 - centre) * (t - first)).sum();
        FittedLine { centre, mean, step: moment / (n * (n * n - 1.0) / 12.0) }
    }

    fn at(&self, i: usize) -> f64 {
        self.mean + (i as f64 - self.centre) * self.step
    }
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

    /// Share of draws whose true step lies within 2 standard uncertainties, and the rms uncertainty over the
    /// rms error.
    fn coverage(instants: impl Fn(u64) -> Vec<f64>, step: f64) -> (f64, f64) {
        const DRAWS: u64 = 400;
        let found: Vec<Clock> =
            (1..=DRAWS).map(|seed| Clock::of(&instants(seed), 0.0).expect("even")).collect();
        let covered = found.iter().filter(|c| (c.step - step).abs() <= 2.0 * c.step_std).count();
        let rms = |of: &dyn Fn(&Clock) -> f64| {
            (found.iter().map(|c| of(c).powi(2)).sum::<f64>() / DRAWS as f64).sqrt()
        };
        (covered as f64 / DRAWS as f64, rms(&|c| c.step_std) / rms(&|c| c.step - step))
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
        // A Student distribution with 7 degrees of freedom has 91.4 % within 2. For 400 draws this scatters
        // by 1.4 %; three times that is allowed.
        let (covered, ratio) = coverage(wandering, 0.01);
        assert!((0.87..=0.96).contains(&covered), "{covered}");
        // For deviations that add up, the variances of eight parts and of the line are equal, 6σ²/5n. 400
        // draws of 7 degrees of freedom scatter by 4 %.
        assert!((0.85..=1.2).contains(&ratio), "{ratio}");
        // For independent jitter the mean of eight parts is eight times less certain than the line, so the
        // stated uncertainty is on the safe side.
        let (covered, ratio) = coverage(independent, 0.01);
        assert!(covered > 0.97, "{covered}");
        assert!((6.5..=9.5).contains(&ratio), "{ratio}");
    }

    #[test]
    fn no_lost_sample_passes_for_jitter() {
        for seed in 1..=200 {
            let mut draw = uniform(seed);
            let n = 20 + (draw() * 300.0) as usize;
            let lost = 1 + (draw() * (n - 2) as f64) as usize;
            // A line fitted to few instants is itself off by a tenth of their jitter.
            let size = 1.8 * JITTER * draw();
            let mut instants: Vec<f64> = (0..n).map(|i| i as f64 + size * (draw() - 0.5)).collect();
            assert!(Clock::of(&instants, 0.0).is_some(), "{seed}");
            instants.remove(lost);
            assert_eq!(Clock::of(&instants, 0.0), None, "{seed}: {lost} of {n}, jitter {size}");
            let found = stretches(&instants, 0.0);
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
        let found = stretches(&instants, 0.0);
        assert_eq!(found.iter().map(|s| s.samples.clone()).collect::<Vec<_>>(), [0..40, 40..70, 70..100]);
        assert!((found[2].clock.start - 37.0).abs() < 1e-12);
        assert!((found[2].duration() - 30.0).abs() < 1e-12);
        for odd in [vec![], vec![1.0; 50], (0..50).rev().map(f64::from).collect(), vec![f64::NAN; 50]] {
            assert_eq!(stretches(&odd, 0.0), []);
            assert_eq!(Clock::of(&odd, 0.0), None);
        }
    }
}
