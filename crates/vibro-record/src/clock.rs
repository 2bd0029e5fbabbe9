//! Clocks of loggers and telephones: finds the even grid behind instants that jitter, and the stretches
//! between lost samples.

use crate::{Finding, median};
use std::cmp::Ordering;
use std::ops::Range;

/// Largest jitter of an instant about an even grid, in steps. Below 1/6: where every third sample is lost,
/// the others lie within 1/6 of a step of another even grid. No other pattern of lost samples comes nearer to
/// one.
const JITTER: f64 = 0.15;
/// Largest deviation by jitter and rounding together, in steps, where lost samples show as long steps. Below
/// 1/2: one lost sample that does not show puts instants half a step off the fitted line.
const ROUNDED: f64 = 0.4;
/// Fewest instants that tell jitter from a lost sample: a fitted line through fewer tilts until it lies near
/// all of them, lost sample or not.
const FEWEST: usize = 16;
/// Parts of a record whose steps are compared for the uncertainty of the step.
const PARTS: usize = 8;
/// Fewest instants of a part for a step of its own.
const FEWEST_OF_PART: usize = 8;
/// In steps: a step that deviates further from the usual one ends a stretch; residuals that jump further hide
/// a lost sample.
const BREAK: f64 = 0.5;
/// Printed digits that rows must span for the mean of their rounding errors to be far below one step.
const CYCLES: f64 = 8.0;
/// Fewest steps that are one digit longer for these to be rounding: one or two may be lost samples, where the
/// sampling interval is about one digit.
const FEWEST_SLIPS: usize = 3;
/// Size of a printed digit, in steps, below which every lost sample shows as a long step.
const FINEST_HIDING: f64 = 0.25;
/// Largest printed digit, in steps, that neither hides a lost sample nor shifts an instant visibly.
const FINE: f64 = 2e-3;
/// Sampling rate over the end of the base band, as analysers set it.
const BASE_BAND: f64 = 2.56;
/// Relative error of an amplitude from which jitter is a caution instead of a note.
const VISIBLE: f64 = 0.01;

/// An even clock, found from instants that were rounded when printed and may jitter about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// First instant of the grid in s.
    pub start: f64,
    /// Sampling interval in s.
    pub step: f64,
    /// Its standard uncertainty in s, from rounding and from steps that jitter, wander or drift.
    pub step_std: f64,
    /// Standard deviation in s of the instants about the grid, beyond rounding; 0 where rounding explains all
    /// of it.
    pub jitter: f64,
}

impl Clock {
    /// Code of the finding that instants jitter.
    pub const JITTERS: &str = "axis-jitter";

    /// The clock of `instants` in s, which were printed to within `resolution` in s: half a unit in the last
    /// digit, rounded or cut off. `None` where samples were lost, and where the instants fit no even grid:
    /// neither within rounding nor, for 16 and more, within rounding and 0.15 of a step.
    pub fn of(instants: &[f64], resolution: f64) -> Option<Clock> {
        Clock::rounded(instants, resolution).or_else(|| {
            let resolution = printed(instants, resolution);
            Clock::within(instants, resolution, |step| JITTER * step + resolution)
                .filter(|clock| !hides_lost(instants, clock, resolution))
        })
    }

    /// The clock of instants that deviate by rounding only. Its step is the middle of all steps whose grid
    /// lies within `resolution` of every instant: the true step is equally likely anywhere among these.
    pub fn rounded(instants: &[f64], resolution: f64) -> Option<Clock> {
        let (n, resolution) = (instants.len(), printed(instants, resolution));
        let (low, high) = steps_within(instants, resolution)?;
        let step = f64::midpoint(low, high);
        if step <= 0.0 || !step.is_finite() || !slips(instants).is_empty() {
            return None;
        }
        // One or two lost samples shorter than a digit look like a drift of the clock. Each makes the step
        // too long by 3/(2n) of itself.
        let hidden = if step < 2.0 * resolution { 1.5 * step / (n - 1) as f64 } else { 0.0 };
        // Clocks jitter below a digit, too. So the uncertainty is at least that of least squares with
        // independent errors of the size of rounding.
        let least = independent(resolution / 3f64.sqrt(), n);
        let step_std = ((high - low) / 12f64.sqrt()).hypot(hidden).hypot(least);
        let residuals = instants.iter().enumerate().map(|(i, t)| t - i as f64 * step);
        let ends = residuals.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), e| (a.min(e), b.max(e)));
        Some(Clock { start: f64::midpoint(ends.0, ends.1), step, step_std, jitter: 0.0 })
    }

    /// The clock by least squares, where all instants lie within `tolerance` in s (of the step) of its grid.
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

    /// Relative standard uncertainty of step and rate.
    pub fn relative(&self) -> f64 {
        self.step_std / self.step
    }

    /// The finding that a column is used as even: either that it is rounded, or its rate, its jitter and the
    /// largest relative error of a sine's amplitude, 2πfσ, at the end of the base band.
    pub fn finding(&self, column: &str) -> Finding {
        let (rate, std) = self.rate();
        if self.jitter == 0.0 {
            let found = Finding::note("axis-rounded").name("column", column);
            return found.number("step", self.step).number("std", self.step_std);
        }
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

/// Standard uncertainty of a step from the first and the last of `n` instants, each off by at most
/// `resolution`, with all errors up to it equally likely.
pub fn uniform_std(resolution: f64, n: usize) -> f64 {
    2.0 * resolution / (3f64.sqrt() * n.saturating_sub(1).max(1) as f64)
}

/// Whether printed digits are so fine that rounding shifts no instant visibly from a grid of that step;
/// `resolution` is half a digit.
pub fn is_fine(resolution: f64, step: f64) -> bool {
    2.0 * resolution <= FINE * step
}

/// The resolution of instants in s, with the rounding of binary numbers of their size.
fn printed(instants: &[f64], resolution: f64) -> f64 {
    let largest = instants.iter().fold(0.0, |largest: f64, t| largest.max(t.abs()));
    resolution * (1.0 + 1e-6) + 4.0 * f64::EPSILON * largest
}

/// The smallest and the largest step of an even grid within `resolution` of all instants; `None` where there
/// is none, and for fewer than three instants.
fn steps_within(instants: &[f64], resolution: f64) -> Option<(f64, f64)> {
    if instants.len() < 3 {
        return None;
    }
    let (low, high) = (-largest_step(instants, -1.0, resolution), largest_step(instants, 1.0, resolution));
    (low <= high).then_some((low, high))
}

/// The largest such step: the least (tⱼ − tᵢ + 2·resolution)/(j − i) over all i < j, of instants times
/// `sign`; with the sign −1, minus the smallest step. By Dinkelbach's iteration: the pair that violates the
/// present step most gives the next one.
fn largest_step(instants: &[f64], sign: f64, resolution: f64) -> f64 {
    let n = instants.len();
    let (first, last) = (sign * instants[0], sign * instants[n - 1]);
    let mut step = (last - first + 2.0 * resolution) / (n - 1) as f64;
    loop {
        // The highest deviation from the grid so far, and the deepest fall below it with the step to which
        // this pair limits the grid.
        let (mut top, mut worst) = ((0, first), (0.0, step));
        for (j, t) in instants.iter().map(|t| sign * t).enumerate() {
            let behind = (j - top.0) as f64;
            let fall = top.1 - t + behind * step;
            if fall < 0.0 {
                top = (j, t);
            } else if fall > worst.0 {
                worst = (fall, (t - top.1 + 2.0 * resolution) / behind);
            }
        }
        // A missing instant (NaN) compares as not less and ends the search.
        if worst.1.partial_cmp(&step) != Some(Ordering::Less) {
            return step;
        }
        step = worst.1;
    }
}

/// Indices of the one or two steps that are much longer, as where a sample was lost and the sampling interval
/// is about one printed digit; empty where three or more are, which is rounding.
fn slips(instants: &[f64]) -> Vec<usize> {
    let steps = || instants.windows(2).map(|w| w[1] - w[0]);
    let (low, high) = steps().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(d), b.max(d)));
    if low <= 0.0 || high <= 1.5 * low {
        return Vec::new();
    }
    let long = steps().enumerate().filter(|(_, d)| *d > f64::midpoint(low, high)).map(|(i, _)| i);
    let long: Vec<usize> = long.take(FEWEST_SLIPS).collect();
    if long.len() < FEWEST_SLIPS { long } else { Vec::new() }
}

/// Whether the residuals of the fitted line jump by more than half a step, which a lost sample causes. Where
/// a printed digit is about as long as a sample, no single step or residual shows it; cumulated residuals do:
/// `jump` is the least-squares jump after instant i. True, too, where there are too few instants to tell.
fn hides_lost(instants: &[f64], clock: &Clock, resolution: f64) -> bool {
    if 2.0 * resolution < BREAK * clock.step {
        return false;
    }
    let n = instants.len();
    let rows = (CYCLES * 2.0 * resolution / clock.step).ceil().max(CYCLES) as usize;
    if n / 4 < rows {
        return true;
    }
    let (whole, mut cumulated) = (n as f64, 0.0);
    instants.iter().enumerate().take(n - rows).any(|(i, t)| {
        cumulated += t - (clock.start + i as f64 * clock.step);
        let part = (i + 1) as f64;
        let both = part * (whole - part);
        let jump = cumulated / (both / whole * (1.0 - 3.0 * both / (whole * whole - 1.0)));
        i + 1 >= rows && jump.abs() > BREAK * clock.step
    })
}

/// Standard uncertainty of the step of a line through `n` instants with independent errors of standard
/// deviation `std`.
fn independent(std: f64, n: usize) -> f64 {
    std * (12.0 / (n as f64).powi(3)).sqrt()
}

/// Standard uncertainty of the step. Independent jitter of size σ gives σ·√(12/n³). Wander and drift of the
/// clock are added from the scatter of the steps of eight parts. Their mean is as certain as the line through
/// all instants where deviations add up from step to step, and else less certain.
fn step_std(instants: &[f64], jitter: f64) -> f64 {
    let n = instants.len();
    let independent = independent(jitter, n);
    if n < PARTS * FEWEST_OF_PART {
        return independent;
    }
    let of = |part: usize| FittedLine::through(&instants[part * n / PARTS..(part + 1) * n / PARTS]).step;
    let steps: Vec<f64> = (0..PARTS).map(of).collect();
    let mean = steps.iter().sum::<f64>() / PARTS as f64;
    let squares: f64 = steps.iter().map(|step| (step - mean).powi(2)).sum();
    independent.hypot((squares / ((PARTS - 1) * PARTS) as f64).sqrt())
}

/// The least-squares line through instants over their numbers.
struct FittedLine {
    centre: f64,
    mean: f64,
    step: f64,
}

impl FittedLine {
    fn through(instants: &[f64]) -> FittedLine {
        // Differences from the first: in seconds since 1970 few digits are left for a step.
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

/// Samples between lost samples, pauses and restarts of a clock.
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

/// The stretches of `instants` in s, printed to within `resolution` in s, that have an even clock, in order;
/// empty where they hold less than half of the instants. A step near two usual ones, as of a lost sample,
/// ends a stretch; so within it instants may deviate by jitter and rounding together. Where a printed digit
/// hides lost samples, a stretch ends before the place where one may be, and the next begins after it.
pub fn stretches(instants: &[f64], resolution: f64) -> Vec<Stretch> {
    let resolution = printed(instants, resolution);
    let Some(usual) = usual_step(instants, resolution) else { return Vec::new() };
    let shows = 2.0 * resolution < FINEST_HIDING * usual;
    let margin = if shows { 0.0 } else { 2.0 * resolution };
    let breaks = |(_, w): &(usize, &[f64])| {
        let off = w[1] - w[0] - usual;
        off.is_nan() || off.abs() > BREAK * usual + margin
    };
    let long: Vec<usize> = instants.windows(2).enumerate().filter(breaks).map(|(i, _)| i).collect();
    let mut left = cut_behind(0..instants.len(), &long);
    left.reverse();
    let mut runs = Vec::new();
    while let Some(run) = left.pop() {
        let found = slips(&instants[run.clone()]);
        if found.is_empty() {
            runs.push(run);
        } else {
            left.extend(cut_behind(run, &found).into_iter().rev());
        }
    }
    let of = |samples: Range<usize>| {
        let part = &instants[samples.clone()];
        let clock = if part.len() < FEWEST { None } else { Clock::of(part, resolution) };
        let near = || Clock::within(part, resolution, |step| ROUNDED * step).filter(|_| shows);
        Some(Stretch { clock: clock.or_else(near)?, samples })
    };
    let enough =
        |all: &Vec<Stretch>| 2 * all.iter().map(|s| s.samples.len()).sum::<usize>() >= instants.len();
    let whole: Vec<Stretch> = runs.iter().cloned().filter_map(of).collect();
    if shows {
        // At least half of the instants must be even: irregular steps contain some even stretches by chance.
        return Some(whole).filter(enough).unwrap_or_default();
    }
    let cut = |tolerance: f64| -> Vec<Stretch> {
        let within = |run: &Range<usize>| {
            let pieces = pieces(&instants[run.clone()], tolerance).into_iter();
            pieces.map(|piece| run.start + piece.start..run.start + piece.end).collect::<Vec<_>>()
        };
        let parts =
            runs.iter().flat_map(|run| of(run.clone()).map_or_else(|| within(run), |s| vec![s.samples]));
        parts.filter_map(of).collect()
    };
    let tolerances = [resolution, resolution + JITTER * usual];
    tolerances.into_iter().map(cut).find(enough).unwrap_or_default()
}

/// Cuts a range after each of the indices `last`, which count from its start.
fn cut_behind(range: Range<usize>, last: &[usize]) -> Vec<Range<usize>> {
    let mut first = range.start;
    let ends = last.iter().map(|i| range.start + i + 1).chain([range.end]);
    ends.map(|end| std::mem::replace(&mut first, end)..end).collect()
}

/// Pieces of `instants` that surely lie between lost samples. The instants are cut into the longest pieces
/// within `tolerance` of an even grid, once from the first on and once from the last back. A piece begins
/// where the first cut begins it and ends where the second ends it: any other cut into as few pieces lies
/// between.
fn pieces(instants: &[f64], tolerance: f64) -> Vec<Range<usize>> {
    let n = instants.len();
    let back: Vec<f64> = instants.iter().rev().map(|t| -t).collect();
    let ends = |instants: &[f64]| {
        let mut ends = vec![0];
        while ends[ends.len() - 1] < n {
            let start = ends[ends.len() - 1];
            ends.push(start + longest_even(&instants[start..], tolerance));
        }
        ends
    };
    let (forth, back) = (ends(instants), ends(&back));
    let starts = forth.iter();
    starts.zip(back.iter().rev().skip(1)).map(|(start, end)| *start..(n - end).max(*start)).collect()
}

/// Number of first instants that lie within `tolerance` of an even grid.
fn longest_even(instants: &[f64], tolerance: f64) -> usize {
    let even = |n: usize| n < 3 || steps_within(&instants[..n], tolerance).is_some();
    let n = instants.len();
    let mut known = n.min(2);
    let mut odd = known;
    while known < n && odd == known {
        odd = (2 * known).min(n);
        if even(odd) {
            known = odd;
        }
    }
    while odd > known + 1 {
        let middle = usize::midpoint(known, odd);
        if even(middle) { known = middle } else { odd = middle }
    }
    known
}

/// The usual step in s: the median over a number of steps that is doubled until they span eight printed
/// digits; `None` where it is not above 0.
fn usual_step(instants: &[f64], resolution: f64) -> Option<f64> {
    let mut lag = 1;
    loop {
        let usual = median(instants.windows(lag + 1).map(|w| w[lag] - w[0]));
        if usual >= CYCLES * 2.0 * resolution || 8 * lag >= instants.len() {
            return Some(usual / lag as f64).filter(|step| *step > 0.0 && step.is_finite());
        }
        lag *= 2;
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
        // A Student distribution with 7 degrees of freedom has 91.4 % within 2. For 400 draws this scatters
        // by 1.4 %; three times that is allowed.
        let (held, ratio) = coverage(wandering, 0.01);
        assert!((0.87..=0.96).contains(&held), "{held}");
        // For deviations that add up, the variances of eight parts and of the line are equal, 6σ²/5n. 400
        // draws of 7 degrees of freedom scatter by 4 %.
        assert!((0.85..=1.2).contains(&ratio), "{ratio}");
        // For independent jitter the mean of eight parts is eight times less certain than the line, so the
        // stated uncertainty is on the safe side.
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
