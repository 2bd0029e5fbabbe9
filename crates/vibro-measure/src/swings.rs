//! Whether the peaks of a record are contacts, or swings of a structure that rings: one judgement for
//! impacts, bounces and pulses.
//!
//! A free decay swings between its peaks as it does at them, and nothing drives it: the modes that are fitted
//! behind its largest peak hold for all that follow. Of impacts each begins a motion of its own, which no
//! decay of an earlier one explains.

use crate::Estimate;
use crate::decay::{DecayMode, DecayOptions, decay};
use std::f64::consts::TAU;
use std::ops::Range;
use vibro_record::units::Unit;
use vibro_record::units::notation::{counted, estimate};
use vibro_record::{Axis, Error, Hint, Meta, Trace};

/// Most modes: with more, a sum of sines follows even evenly spaced pulses.
const MODES: usize = 3;
/// A peak is a swing where the modes leave less than this part of it, or noise; so it is with the root of the
/// mean square of all behind the largest.
const LEFT: f64 = 0.5;
/// Samples in which a decay is judged, an eighth of them before its largest value: memory for eleven times as
/// many.
const STRETCH: usize = 1 << 20;

/// Parts of a pulse that a structure swings back and forth behind it at least, of damping ratios up to a
/// fifth.
const BACK_AND_FORTH: [f64; 2] = [0.5, 0.25];
/// Largest damping ratio of what swings: it comes back by a half of its height.
const DAMPED: f64 = 0.2;

/// Why one peak of this height over a baseline, with flanks at half of it in samples, is no contact: where
/// what follows swings back and forth as wide as the peak is. A decay of so few swings as a blow may leave
/// cannot be fitted.
pub(crate) fn back_and_forth(
    values: &[f64],
    baseline: f64,
    height: f64,
    flanks: (f64, f64),
) -> Option<Error> {
    // Half the height of half a sine lasts two thirds of it.
    let half = 1.5 * (flanks.1 - flanks.0);
    let behind = |swings: f64| (flanks.1 + swings * half) as usize;
    let largest = |from: usize, to: usize, sign: f64| {
        let swing = values.get(from..to.min(values.len()))?.iter();
        Some(swing.map(|v| sign * (v - baseline) / height).fold(0.0, f64::max))
    };
    let (back, forth) = (largest(behind(0.0), behind(1.5), -1.0)?, largest(behind(1.0), behind(2.5), 1.0)?);
    let (rings, [back, forth]) =
        (back > BACK_AND_FORTH[0] && forth > BACK_AND_FORTH[1], [100.0 * back, 100.0 * forth]);
    let why = format!(
        "its largest peak is followed by peaks of −{back:.0} % and {forth:.0} %; a contact pulse has one sign"
    );
    rings.then(|| refused(&why))
}

/// Refuses a record that rings.
fn refused(why: &str) -> Error {
    Error::refused(format!("the record rings: {why}")).hint(Hint::OfFile("vibro decay"))
}

/// A free decay that explains the peaks of a record.
#[derive(Debug, Clone)]
pub(crate) struct Swings {
    /// Peaks that are its swings.
    peaks: usize,
    /// Its strongest mode.
    mode: DecayMode,
}

impl Swings {
    /// The free decay of `values`, whose level is 0, if it explains all peaks behind the largest value, and
    /// these are most; noise reaches up to `reach`. `peaks` are stretches of samples; where there is
    /// none, the largest value is one.
    pub fn of(values: &[f64], rate: f64, peaks: &[Range<usize>], reach: f64) -> Option<Swings> {
        let top = (0..values.len()).max_by(|a, b| values[*a].abs().total_cmp(&values[*b].abs()))?;
        let from = top.saturating_sub(STRETCH / 8);
        let values = &values[from..values.len().min(from + STRETCH)];
        let within = peaks.iter().filter(|peak| peak.start >= from && peak.end <= from + values.len());
        let mut peaks: Vec<Range<usize>> = within.map(|peak| peak.start - from..peak.end - from).collect();
        if peaks.is_empty() {
            peaks.push(top - from..top - from + 1);
        }
        if !comes_back(values, top - from) {
            return None;
        }
        let axis = Axis::time(0.0, 1.0 / rate, values.len());
        let trace = Trace { meta: Meta::new("", Unit::none()), axis, values: values.to_vec() };
        let found = decay(&trace, &DecayOptions { modes: Some(MODES), ..DecayOptions::default() }).ok()?;
        let start = ((found.start * rate).round() as usize).min(top - from);
        let left = |i: usize| {
            let t = i as f64 / rate - found.start;
            values[i] - found.modes.iter().map(|mode| motion(mode, t)).sum::<f64>()
        };
        let largest =
            |part: Range<usize>, of: &dyn Fn(usize) -> f64| part.map(|i| of(i).abs()).fold(0.0, f64::max);
        let behind =
            || peaks.iter().filter(|peak| peak.end > start).map(|peak| peak.start.max(start)..peak.end);
        let swings = |peak: Range<usize>| {
            largest(peak.clone(), &left) < reach.max(LEFT * largest(peak, &|i| values[i]))
        };
        let n = behind().count();
        let by_size = |a: &&DecayMode, b: &&DecayMode| a.amplitude.value.total_cmp(&b.amplitude.value);
        let mode = found.modes.iter().max_by(by_size)?.clone();
        let power = |of: &dyn Fn(usize) -> f64| (start..values.len()).map(|i| of(i).powi(2)).sum::<f64>();
        let explained = power(&left) < LEFT * LEFT * power(&|i| values[i]);
        let rings = mode.zeta.value < DAMPED && 2 * n > peaks.len() && explained;
        (rings && behind().all(swings)).then_some(Swings { peaks: n, mode })
    }

    /// Why the record holds no contacts, and what measures it.
    pub fn refusal(&self) -> Error {
        let [frequency, zeta] =
            [&self.mode.frequency, &self.mode.zeta].map(|of: &Estimate| estimate(of.value, of.std));
        let peaks = counted(self.peaks, "peak");
        let why = format!(
            "a free decay of {frequency} Hz, damping ratio {zeta}, explains {peaks}, and no contact is seen"
        );
        refused(&why)
    }
}

/// Part of the time from the first peak to the last that the peaks of a swing take: above nine tenths
/// of its height a sine is a quarter of the time, and those that fall into the noise are shorter.
const TAKEN: f64 = 0.05;

/// Whether a record does not rest between its peaks as it does between impacts.
pub(crate) fn are_close(peaks: &[Range<usize>]) -> bool {
    let taken: usize = peaks.iter().map(ExactSizeIterator::len).sum();
    let first = peaks.iter().map(|peak| peak.start).min().unwrap_or_default();
    let last = peaks.iter().map(|peak| peak.end).max().unwrap_or_default();
    taken as f64 >= TAKEN * (last - first) as f64
}

/// Whether the largest value is followed by half of it on the other side: else no decay is worth fitting.
fn comes_back(values: &[f64], top: usize) -> bool {
    let sign = values[top].signum();
    let back = values[top..].iter().fold(0.0, |most: f64, v| most.max(-sign * v));
    back > BACK_AND_FORTH[0] * values[top].abs()
}

/// A e^(−ζω₀t) cos(ω₀√(1−ζ²) t + φ) at `t` in s from the start of the decay.
fn motion(mode: &DecayMode, t: f64) -> f64 {
    let (angular, zeta) = (TAU * mode.frequency.value, mode.zeta.value);
    let phase = angular * (1.0 - zeta * zeta).sqrt() * t + mode.phase.value;
    mode.amplitude.value * (-zeta * angular * t).exp() * phase.cos()
}
