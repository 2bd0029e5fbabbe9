//! Free decays, after a release or a blow: natural frequency and damping of each mode.
//!
//! The motion is a sum of damped sines. Each is fitted to the lines around it; the model contains the leakage
//! from the ends of the record (damped.rs). The strongest line of the residual gives the next sine, and all
//! are fitted again (J. Li, P. Stoica, IEEE Trans. Signal Process. 44 (1996) 281, the method RELAX, for
//! damped sines). The residual of the lines beside a sine is its noise.

mod damped;
mod expected;
mod hum;
mod result;
mod sines;
mod usable;

use super::Estimate;
use super::chance::chi_squared_above;
use super::mains::Hum;
use super::mean::{average, scatter};
use damped::{Damped, LINES, OWN, SineGroup, lines};
pub use expected::{GuessedMode, expected, rehearse};
pub use result::{DecayMode, DecayOptions, DecayResult, Level};
use sines::{ENOUGH, MOST, STEADY, SURE, Sines, decays};
use std::f64::consts::TAU;
use std::ops::Range;
use usable::{Usable, usable};
use vibro_record::{Doubt, Error, Finding, Result, Trace, Uncertain, code, sort_by_number};

/// Least amplitude of a steady line that is reported, over the strongest amplitude.
const SEEN: f64 = 0.01;
/// Largest number of stretches, and the least decay within one (logarithm of the amplitude ratio).
const STRETCHES: (usize, f64) = (5, 1.2);
/// False-alarm probability of the test whether the damping of a mode changes with its amplitude.
const CHANGED: f64 = 1e-3;
/// Largest relative standard uncertainty of ζ with which a stretch counts: ζ is then more than three
/// standard uncertainties above 0.
const KNOWN: f64 = 0.3;

/// Least part of the model's swing back that the record of a mode has. Dry friction takes a part of it.
const SWUNG: f64 = 0.3;
/// Least energy behind the swing back, over all, with which a mode has further swings: ζ is below about 0.25.
const FURTHER: f64 = 0.05;
/// Fewest samples behind the swing back whose scatter is its noise.
const ENOUGH_NOISE: usize = 16;

/// Modes of the free decay that a record holds.
///
/// # Errors
/// If the trace is not evenly sampled, the band is impossible, the record holds too few periods, no mode is
/// above the noise, or the strongest line does not decay: a motion that is driven, grows, or was not seen for
/// long enough.
pub fn decay(trace: &Trace, options: &DecayOptions) -> Result<DecayResult> {
    let rate = trace.sampling_rate()?;
    if let Some((low, high)) = options.band.filter(|(low, high)| !(*low >= 0.0 && low < high)) {
        return Err(Error::usage(format!("a band of {low}:{high} Hz"), "LO:HI with LO below HI")
            .hint("the lower limit first")
            .setting("band"));
    }
    if let Some(count) = options.modes.filter(|n| !(1..=MOST).contains(n)) {
        return Err(Error::usage(format!("{count} modes"), format!("1 to {MOST}")).setting("modes"));
    }
    let Usable { mut part, block, limit, findings } = usable(trace, rate, options.band)?;
    let mut lengths = 2;
    let found = loop {
        let least = if lengths > 0 { 3 * block } else { usize::MAX };
        let found = Sines::of(&trace.values[part.clone()], rate, options, least);
        let (group, m) = found.strongest().ok_or_else(|| {
            Error::refused("no mode is above the noise")
                .hint("the frequencies around the mode")
                .setting("band")
        })?;
        let loss = group.sines[m].decay;
        // The part ends where the strongest mode has decayed by [`ENOUGH`].
        let wanted = (part.start + (part.len() as f64 * ENOUGH / loss.max(0.1)) as usize).min(limit);
        let change = wanted.max(part.start + 3 * block) as f64 - part.end as f64;
        // A change of less than a tenth is not worth another fit.
        if loss > 0.0 && lengths > 0 && change.abs() > 0.1 * part.len() as f64 {
            part.end = (part.end as f64 + change) as usize;
            lengths -= usize::from(!found.is_long());
            continue;
        }
        match found.contact(&trace.values[part.clone()], block) {
            Some(behind) if part.len() > behind + 5 * block => part.start += behind,
            _ => break found,
        }
    };
    found.result(trace, part, options, findings)
}

impl Sines {
    fn result(
        &self,
        trace: &Trace,
        part: Range<usize>,
        options: &DecayOptions,
        mut findings: Vec<Finding>,
    ) -> Result<DecayResult> {
        self.swings_back(&trace.values[part.clone()])?;
        let unit = trace.meta.unit.quantity().symbol();
        let (mut modes, largest) = self.modes(trace, unit, &mut findings)?;
        if let Some(count) = options.modes.filter(|count| *count > modes.len()) {
            findings.push(Finding::caution("decay-fewer").count("n", modes.len()).count("count", count));
        }
        let at = |i: usize| trace.axis.at(i);
        let (mut levels, mut decrement) = self.levels(&trace.values[part.clone()], at(part.start), unit);
        if let Some(strongest) = largest {
            let mode = &mut modes[strongest];
            let changes = changed(&levels).map(|doubt| doubt.number("frequency", mode.frequency.value));
            // Levels and decrement are of the strongest mode: without its uncertainty they have none.
            if mode.zeta.std.is_none() {
                levels.doubt();
                decrement.doubt();
            }
            // A mode that changes has its own damping at each level: what is one number for all is wrong.
            let of_all: &mut [&mut dyn Uncertain] = &mut [mode, &mut decrement];
            findings.extend(changes.map(|doubt| doubt.of(of_all)));
        }
        let seen = self.groups.iter().flat_map(|group| &group.hum).filter(|hum| hum.seen);
        let hum = seen.map(|hum| Hum {
            frequency: hum.sine.periods * self.rate / self.n as f64,
            amplitude: hum.sine.amplitude.norm(),
            harmonics: 1,
        });
        findings.extend(hum.map(|hum| hum.removed(unit)));
        sort_by_number(&mut modes, |a| a.frequency.value);
        let left = self.left(&trace.values[part.clone()]);
        let record = trace.values[part.clone()].to_vec();
        let curve = record.iter().zip(&left).map(|(v, left)| v - left).collect();
        let curves = [part.clone().map(at).collect(), record, curve];
        Ok(DecayResult {
            start: at(part.start),
            end: at(part.end - 1),
            last: at(trace.values.len() - 1),
            modes,
            levels,
            decrement,
            findings,
            curves,
        })
    }

    /// The modes within the band, and the index of the strongest. Lines that do not decay are not modes.
    fn modes(
        &self,
        trace: &Trace,
        unit: &'static str,
        findings: &mut Vec<Finding>,
    ) -> Result<(Vec<DecayMode>, Option<usize>)> {
        let (mut modes, mut largest) = (Vec::new(), None);
        let strongest = self.strongest();
        let is_strongest =
            |group, m| strongest.is_some_and(|(other, k)| std::ptr::eq(other, group) && k == m);
        let size = strongest.map_or(0.0, |(group, m)| group.sines[m].amplitude.norm());
        for (group, m) in self.asked() {
            let mut mode = mode(group, m, self.n, self.rate, unit);
            mode.amplitude = mode.amplitude.with_relative(trace.meta.lost(mode.frequency.value));
            mode.frequency = mode.frequency.with_relative(trace.meta.clock);
            if decays(group, m) {
                let near = |k: &usize| (group.sines[m].periods - *k as f64).abs() < group.sines[m].reach();
                if self.odd.iter().any(near) {
                    let doubt = Finding::doubt(code::DECAY_UNEXPLAINED);
                    findings.push(doubt.number("frequency", mode.frequency.value).of(&mut mode));
                }
                largest = largest.or(is_strongest(group, m).then_some(modes.len()));
                modes.push(mode);
            } else if is_strongest(group, m) {
                return Err(self.steady(group, m));
            } else if mode.amplitude.value > SEEN * size && group.sines[m].periods > 3.0 {
                let steady = Finding::note("decay-steady-line").number("frequency", mode.frequency.value);
                findings.push(steady.number("amplitude", mode.amplitude.value).name("unit", unit));
            }
        }
        Ok((modes, largest))
    }

    /// Error for a record whose strongest line does not decay.
    fn steady(&self, group: &SineGroup, m: usize) -> Error {
        let Damped { periods, decay, .. } = group.sines[m];
        let (lost, std) = (-(-decay).exp_m1(), group.std(m, [0.0, 1.0, 0.0, 0.0]));
        let why = format!(
            "the motion does not decay: its strongest line, {:.5} Hz, loses {:.2} ± {:.2} % within {:.4} s; a mode must lose more than {:.1} %",
            periods * self.rate / self.n as f64,
            100.0 * lost,
            100.0 * std * (-decay).exp(),
            self.n as f64 / self.rate,
            -100.0 * (-SURE * std.hypot(STEADY)).exp_m1()
        );
        Error::refused(why)
            .hint("read what follows the release or the blow, or choose the band of the mode")
            .setting("span")
            .setting("band")
    }

    /// Refuses a record whose strongest mode does not swing back. A push and its end, such as the force of a
    /// contact, fit the first half swing of a strongly damped sine; the half swing of the other sign that
    /// follows tells the two apart. Its amplitude in the record is that of the model within its noise for a
    /// mode, and 0 for a push.
    fn swings_back(&self, part: &[f64]) -> Result<()> {
        let Some((group, m)) = self.strongest().filter(|(group, m)| decays(group, *m)) else { return Ok(()) };
        let sine = group.sines[m];
        let (n, left) = (part.len(), self.left(part));
        let model: Vec<f64> = (0..n).map(|i| sine.sample(i, n)).collect();
        let Some(swing) = swing_back(&model) else { return Ok(()) };
        let energy = |samples: &[f64]| samples.iter().map(|v| v * v).sum::<f64>();
        // A mode of more swings is told by all of them.
        if energy(&model[swing.end..]) > FURTHER * energy(&model) {
            return Ok(());
        }
        // What follows shows the noise, and the level about which the motion swings.
        let behind = &left[swing.end..];
        if behind.len() < swing.len().max(ENOUGH_NOISE) {
            return Ok(());
        }
        let (level, noise) = (average(behind), scatter(behind));
        let power = energy(&model[swing.clone()]);
        let product: f64 = swing.map(|i| model[i] * (model[i] + left[i] - level)).sum();
        let (part, std) = (product / power, noise / power.sqrt());
        if part - SURE * std > 0.0 && part > SWUNG {
            return Ok(());
        }
        let zeta = sine.decay / sine.decay.hypot(TAU * sine.periods);
        let why = format!(
            "the motion does not swing back: the record has {part:.2} ± {std:.2} of the half swing that ζ = {zeta:.2} predicts"
        );
        Err(Error::refused(why)
            .hint("`vibro pulse` measures the force of one contact; for a decay choose the band of the mode")
            .setting("band"))
    }

    /// The strongest mode in stretches of equal length, and its damping ratio from the decrement of their
    /// amplitudes.
    fn levels(&self, part: &[f64], start: f64, unit: &'static str) -> (Vec<Level>, Option<Estimate>) {
        // A mode that is fitted together with others is too uncertain to be followed on its own.
        let alone = self.strongest().filter(|(group, _)| group.sines.len() == 1);
        let Some(own) = alone.map(|(group, m)| group.sines[m]) else { return (Vec::new(), None) };
        let stretches =
            ((own.decay / STRETCHES.1) as usize).min(STRETCHES.0).min((own.periods / 4.0) as usize);
        if stretches < 2 {
            return (Vec::new(), None);
        }
        let left = self.left(part);
        let alone: Vec<f64> = left.iter().enumerate().map(|(i, v)| v + own.sample(i, self.n)).collect();
        let n = self.n / stretches;
        let starts = [(own.periods / stretches as f64, own.decay / stretches as f64)];
        let levels = alone.chunks_exact(n).enumerate().filter_map(|(i, stretch)| {
            let spectrum = lines(stretch);
            let centre = starts[0].0 as usize;
            let range = centre.saturating_sub(LINES.0 as usize).max(1)
                ..(centre + LINES.0 as usize + 2).min(spectrum.len() - 1);
            let group = SineGroup::fit(&spectrum, range.clone(), n, &starts, &[]).ok()?;
            let mode = mode(&group, 0, n, self.rate, unit);
            // A fit that has left these lines has found another mode.
            let own = range.contains(&(group.sines[0].periods.max(0.0) as usize));
            let known = own && mode.zeta.std.is_some_and(|std| std < KNOWN * mode.zeta.value);
            known.then(|| Level { start: start + (i * n) as f64 / self.rate, mode })
        });
        let levels: Vec<Level> = levels.collect();
        let decrement =
            levels.first().zip(levels.last()).filter(|_| levels.len() > 1).map(|(first, last)| {
                let (a, b) = (&first.mode.amplitude, &last.mode.amplitude);
                let rate = (a.value / b.value).ln() / (last.start - first.start);
                let angular = TAU * first.mode.frequency.value;
                let std = a.std.zip(b.std).map(|(sa, sb)| (sa / a.value).hypot(sb / b.value));
                let std = std.map(|std| std / (last.start - first.start) / angular);
                Estimate::new(rate / angular, std, "1", levels.len(), "logarithmic decrement")
            });
        (levels, decrement)
    }
}

/// Samples of the half swing that follows the largest one; `None` where the part holds no such swing.
fn swing_back(model: &[f64]) -> Option<Range<usize>> {
    let largest = (0..model.len()).max_by(|a, b| model[*a].abs().total_cmp(&model[*b].abs()))?;
    let crossing = |from: usize| (from + 1..model.len()).find(|i| model[*i] * model[i - 1] <= 0.0);
    let start = crossing(largest)?;
    Some(start..crossing(start)?)
}

/// The mode of sine `m` in a part of `n` samples.
fn mode(group: &SineGroup, m: usize, n: usize, rate: f64, unit: &'static str) -> DecayMode {
    let sine = group.sines[m];
    let duration = n as f64 / rate;
    let (sigma, damped) = (sine.decay / duration, TAU * sine.periods / duration);
    let natural = sigma.hypot(damped);
    let (c, size) = (sine.amplitude, sine.amplitude.norm());
    let estimate = |value: f64, gradient: [f64; OWN], unit| {
        Estimate::new(
            value,
            Some(group.std(m, gradient)),
            unit,
            group.lines.len(),
            "damped sine, fitted to its lines",
        )
    };
    let (by_periods, by_decay) = (TAU / duration, 1.0 / duration);
    let cube = natural.powi(3);
    DecayMode {
        frequency: estimate(
            natural / TAU,
            [damped / natural * by_periods / TAU, sigma / natural * by_decay / TAU, 0.0, 0.0],
            "Hz",
        ),
        zeta: estimate(
            sigma / natural,
            [-sigma * damped / cube * by_periods, damped * damped / cube * by_decay, 0.0, 0.0],
            "1",
        ),
        amplitude: estimate(size, [0.0, 0.0, c.re / size, c.im / size], unit),
        phase: estimate(c.arg(), [0.0, 0.0, -c.im / (size * size), c.re / (size * size)], "rad"),
    }
}

/// A doubt if frequency or damping depend on the amplitude: χ² of both about their weighted means.
fn changed(levels: &[Level]) -> Option<Doubt> {
    let spread = |of: &dyn Fn(&DecayMode) -> &Estimate| {
        let known =
            levels.iter().map(|level| of(&level.mode)).filter_map(|e| Some((e.value, e.std?.powi(-2))));
        let known: Vec<(f64, f64)> = known.collect();
        let weights: f64 = known.iter().map(|(_, w)| w).sum();
        let mean = known.iter().map(|(v, w)| v * w).sum::<f64>() / weights;
        known.iter().map(|(v, w)| w * (v - mean).powi(2)).sum::<f64>()
    };
    let (first, last) = levels.first().zip(levels.last())?;
    let sum = spread(&|mode| &mode.zeta) + spread(&|mode| &mode.frequency);
    let free = 2 * levels.len().checked_sub(1).filter(|free| *free > 0)?;
    (chi_squared_above(sum, free) < CHANGED).then(|| {
        let found = Finding::doubt(code::DECAY_CHANGES).number("from", first.mode.zeta.value);
        found
            .number("to", last.mode.zeta.value)
            .number("high", first.mode.amplitude.value)
            .number("low", last.mode.amplitude.value)
    })
}

#[cfg(test)]
mod tests;
