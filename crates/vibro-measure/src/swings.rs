//! Decides whether the peaks of a record are contacts or the ringing of a structure, for impacts, bounces and
//! pulses alike.
//!
//! Nothing drives a free decay: the modes fitted after its largest peak predict all later peaks. Each impact
//! begins a new motion, which the decay of an earlier impact does not predict.

use crate::Estimate;
use crate::decay::{DecayMode, DecayOptions, decay};
use std::f64::consts::TAU;
use std::ops::Range;
use vibro_record::units::Unit;
use vibro_record::units::notation::{counted, estimate};
use vibro_record::{Axis, Error, Hint, Meta, Trace};

/// Most modes of the decay: with more, the sum of sines would also fit evenly spaced pulses.
const MODES: usize = 3;
/// Largest residual of the modes at a peak of the decay, over the peak. The same limit holds for the RMS of
/// all samples after the largest peak.
const LEFT: f64 = 0.5;
/// Most samples that are fitted, an eighth of them before the largest value: the fit needs memory for eleven
/// times as many.
const STRETCH: usize = 1 << 20;

/// Smallest undershoot after a pulse and next overshoot, over its height, for ringing: those of damping
/// ratios up to 0.2.
const BACK_AND_FORTH: [f64; 2] = [0.5, 0.25];
/// Largest damping ratio of ringing: there the first undershoot is half of the peak.
const DAMPED: f64 = 0.2;

/// Error where a single peak is ringing: the signal swings back and forth after it as wide as the peak. A
/// blow may leave too few cycles to fit a decay. `height` counts from `baseline`; `flanks` are the positions
/// at half of it, in samples.
pub(crate) fn back_and_forth(
    values: &[f64],
    baseline: f64,
    height: f64,
    flanks: (f64, f64),
) -> Option<Error> {
    // A half sine is above half its height for two thirds of its duration.
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

/// Error for a record that rings.
fn refused(why: &str) -> Error {
    Error::refused(format!("the record rings: {why}")).hint(Hint::OfFile("vibro decay"))
}

/// A free decay that explains the peaks of a record.
#[derive(Debug, Clone)]
pub(crate) struct Swings {
    /// Number of peaks that it explains.
    peaks: usize,
    /// Strongest mode of the decay.
    mode: DecayMode,
}

impl Swings {
    /// The free decay of `values`, whose baseline is 0, if it explains all peaks after the largest value and
    /// these are the majority. Noise peaks reach up to `reach`. `peaks` are ranges of samples; without any,
    /// the largest value is the peak.
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

    /// Error that the record holds no contacts, with the command that measures a decay.
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

/// Smallest share of the time from first to last peak that the peaks of ringing take. A sine is above nine
/// tenths of its height for a quarter of the time; peaks near the noise are shorter.
const TAKEN: f64 = 0.05;

/// Whether the peaks are too close for impacts, between which a record is at rest.
pub(crate) fn are_close(peaks: &[Range<usize>]) -> bool {
    let taken: usize = peaks.iter().map(ExactSizeIterator::len).sum();
    let first = peaks.iter().map(|peak| peak.start).min().unwrap_or_default();
    let last = peaks.iter().map(|peak| peak.end).max().unwrap_or_default();
    taken as f64 >= TAKEN * (last - first) as f64
}

/// Whether the signal swings back by half of the largest value: otherwise a fit of a decay is not worth it.
fn comes_back(values: &[f64], top: usize) -> bool {
    let sign = values[top].signum();
    let back = values[top..].iter().fold(0.0, |most: f64, v| most.max(-sign * v));
    back > BACK_AND_FORTH[0] * values[top].abs()
}

/// Motion of a mode, A e^(−ζω₀t) cos(ω₀√(1−ζ²) t + φ), at `t` in s from the start of the decay.
fn motion(mode: &DecayMode, t: f64) -> f64 {
    let (angular, zeta) = (TAU * mode.frequency.value, mode.zeta.value);
    let phase = angular * (1.0 - zeta * zeta).sqrt() * t + mode.phase.value;
    mode.amplitude.value * (-zeta * angular * t).exp() * phase.cos()
}
