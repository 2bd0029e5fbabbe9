//! Free decays, behind a release or a blow: natural frequency and damping of each mode.
//!
//! The motion is a sum of damped sines. Each is fitted to the lines around it, with what the ends of the record do to these in the model
//! (damped.rs); the strongest line of what is left gives the next sine, and all are fitted again (J. Li, P. Stoica, IEEE Trans.
//! Signal Process. 44 (1996) 281, the method RELAX, for damped sines). Noise is that which is left of the lines beside a sine.

mod damped;
mod result;
mod usable;

use super::mean::{average, upper_median};
use super::residuals::chi_squared_above;
use super::{Estimate, noise};
use damped::{Damped, Group, LINES, OWN, lines};
use num_complex::Complex64;
pub use result::{DecayMode, DecayOptions, DecayResult, Level};
use std::f64::consts::TAU;
use std::ops::Range;
use usable::{Usable, levels, usable};
use vibro_record::{Error, Finding, Result, Trace};

/// Most sines of one record, those that do not decay with them.
const MOST: usize = 12;
/// Most lines that stand out and are no mode.
const ODD: usize = 8;
/// How often the largest line of pure noise may pass for a mode.
const BY_CHANCE: f64 = 1e-4;
/// F of four more parameters to be worth them, at a chance of about 1e-4.
const WORTH: f64 = 10.0;
/// Two sines nearer than so many half-widths of the wider one are one that does not decay as a mode does.
const PARTED: f64 = 1.5;
/// Decay over the part, in natural logarithms: later there is nothing to be learnt.
const ENOUGH: f64 = 6.0;
/// Standard uncertainties by which a decay has to be above nothing.
const SURE: f64 = 3.0;
/// Part of the strongest amplitude from which on a steady line is named.
const SEEN: f64 = 0.01;
/// Largest number of stretches, and the decay of one.
const STRETCHES: (usize, f64) = (5, 1.2);
/// Fall of what is left from block to block where a contact ends.
const FALL: f64 = 6.0;
/// Lines on either side that belong to a broad mode.
const BROAD: usize = 4;
/// How often the levels of a steady mode may seem to change.
const CHANGED: f64 = 1e-3;

/// Modes of the free decay that a record holds.
///
/// # Errors
/// If the trace is not evenly sampled, its band is none, it holds too few periods, no mode stands out of the noise, or the strongest line does
/// not decay: a motion that is driven, grows, or was not seen for long enough.
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
        let found = Sines::of(&trace.values[part.clone()], rate, options);
        let (group, m) = found.strongest().ok_or_else(|| {
            Error::refused("no mode stands out of the noise").hint("choose a band around it").setting("band")
        })?;
        let loss = group.sines[m].decay;
        // As long as the strongest mode is seen, and no longer.
        let wanted = (part.start + (part.len() as f64 * ENOUGH / loss.max(0.1)) as usize).min(limit);
        let change = wanted.max(part.start + 3 * block) as f64 - part.end as f64;
        if loss > 0.0 && lengths > 0 && change.abs() > 0.1 * part.len() as f64 {
            part.end = (part.end as f64 + change) as usize;
            lengths -= 1;
            continue;
        }
        match found.contact(&trace.values[part.clone()], block) {
            Some(behind) if part.len() > behind + 5 * block => part.start += behind,
            _ => break found,
        }
    };
    found.result(trace, part, options, findings)
}

/// Sines of a part.
struct Sines {
    n: usize,
    rate: f64,
    /// Lines at which modes are asked for; sines elsewhere are fitted, so that they do not pass for these.
    band: Range<usize>,
    groups: Vec<Group>,
    /// Lines that stand out and are no mode beside those that are known.
    odd: Vec<usize>,
}

impl Sines {
    /// Finds the sines of a part, the strongest first.
    fn of(part: &[f64], rate: f64, options: &DecayOptions) -> Sines {
        let n = part.len();
        let mean = average(part);
        let spectrum = lines(&part.iter().map(|v| v - mean).collect::<Vec<f64>>());
        let line = |f: f64| (f * n as f64 / rate) as usize;
        let all = 1..spectrum.len() - 1;
        let band =
            options.band.map_or(all.clone(), |(low, high)| line(low).max(1)..(line(high) + 1).min(all.end));
        let mut sines = Sines { n, rate, band: band.clone(), groups: Vec::new(), odd: Vec::new() };
        let beside = [1..band.start, band.end..all.end];
        let ranges = [(&band, options.modes), (&beside[0], None), (&beside[1], None)];
        // What stood out beside a sine while another one was not known yet is looked at again.
        for _ in 0..2 {
            sines.odd.clear();
            for (range, wanted) in ranges.iter().filter(|(range, _)| !range.is_empty()) {
                while sines.count() < MOST
                    && sines.odd.len() < ODD
                    && wanted.is_none_or(|count| sines.decaying() < count)
                {
                    let rest = sines.rest(&spectrum, None);
                    let Some(top) = sines.next(&rest, (*range).clone()) else { break };
                    sines.add(&spectrum, &rest, top);
                }
            }
            sines.settle(&spectrum);
        }
        // What still stands out beside a sine was not asked for, or is none.
        let rest = sines.rest(&spectrum, None);
        let beside = |k: &usize| sines.groups.iter().any(|group| group.lines.contains(k));
        let left: Vec<usize> = sines.next(&rest, band.clone()).into_iter().filter(beside).collect();
        sines.odd.extend(left);
        sines
    }

    /// Fits each group again without the sines of all others.
    fn settle(&mut self, spectrum: &[Complex64]) {
        for at in (0..self.groups.len()).cycle().take(2 * self.groups.len()) {
            let rest = self.rest(spectrum, Some(at));
            let old = &self.groups[at];
            let starts: Vec<(f64, f64)> = old.sines.iter().map(|s| (s.periods, s.decay)).collect();
            if let Ok(better) = Group::fit(&rest, range(&old.sines, rest.len()), self.n, &starts) {
                self.groups[at] = better;
            }
        }
    }

    fn count(&self) -> usize {
        self.groups.iter().map(|group| group.sines.len()).sum()
    }

    /// The sines within the band.
    fn asked(&self) -> impl Iterator<Item = (&Group, usize)> {
        let all = self.groups.iter().flat_map(|group| (0..group.sines.len()).map(move |m| (group, m)));
        // A mode whose largest line is in the band lies within a line of it.
        let within =
            |periods: f64| [0.0, 1.0].iter().any(|by| self.band.contains(&((periods + by) as usize)));
        all.filter(move |(group, m)| within(group.sines[*m].periods))
    }

    fn decaying(&self) -> usize {
        self.asked().filter(|(group, m)| decays(group, *m)).count()
    }

    /// The sine that moves most over the whole part; what does not decay counts as if it did.
    fn strongest(&self) -> Option<(&Group, usize)> {
        let size = |(group, m): &(&Group, usize)| {
            let sine = &group.sines[*m];
            sine.amplitude.norm() / if decays(group, *m) { sine.decay.max(1.0) } else { ENOUGH }
        };
        self.asked().max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// What is left of the lines without the sines of all groups but one.
    fn rest(&self, spectrum: &[Complex64], but: Option<usize>) -> Vec<Complex64> {
        let others = self.groups.iter().enumerate().filter(|(i, _)| Some(*i) != but);
        let sines: Vec<&Damped> = others.flat_map(|(_, group)| &group.sines).collect();
        let left = |(k, line): (usize, &Complex64)| {
            line - sines.iter().map(|s| s.line(k, self.n)).sum::<Complex64>()
        };
        spectrum.iter().enumerate().map(left).collect()
    }

    /// The largest line that stands out of those around it.
    fn next(&self, rest: &[Complex64], band: Range<usize>) -> Option<usize> {
        let sizes: Vec<f64> = rest.iter().map(|line| line.norm()).collect();
        let mut tops: Vec<usize> =
            band.clone().filter(|k| sizes[*k] >= sizes[k - 1] && sizes[*k] >= sizes[k + 1]).collect();
        tops.sort_by(|a, b| sizes[*b].total_cmp(&sizes[*a]));
        // Rayleigh: one of so many lines of noise passes t standard deviations with a chance of n e^(−t²/2).
        let visible = (2.0 * (band.len().max(1) as f64 / BY_CHANCE).ln()).sqrt();
        let above = |k: usize, size: f64, reach: usize| {
            noise::around(&sizes, k, reach, None).is_none_or(|floor| size > visible * floor)
        };
        // Of a mode that is over long before the others the lines nearby are its own, and as high as it.
        let wide = |k: usize| {
            let near = &sizes[k.saturating_sub(BROAD)..(k + BROAD + 1).min(sizes.len())];
            upper_median(near.iter().copied()).is_some_and(|size| above(k, size, noise::REACH.max(k / 2)))
        };
        let seen = |k: &usize| above(*k, sizes[*k], noise::REACH) || wide(*k);
        let known = |k: &usize| self.odd.iter().any(|odd| odd.abs_diff(*k) < 2);
        tops.into_iter().filter(|k| !known(k)).take(MOST).find(seen)
    }

    /// Adds the sine of a line, fitted together with those near it.
    fn add(&mut self, spectrum: &[Complex64], rest: &[Complex64], top: usize) {
        let power = |k: usize| rest[k].norm_sqr();
        let half = |k: &usize| power(*k) > 0.5 * power(top);
        let wide = (top..rest.len() - 1).take_while(half).count() + (1..top).rev().take_while(half).count();
        let decay = std::f64::consts::PI * wide as f64;
        let new = Damped { periods: top as f64, decay, amplitude: Complex64::ZERO };
        let near = |group: &Group| {
            group.sines.iter().any(|s| (s.periods - new.periods).abs() < 0.5 * (s.reach() + new.reach()))
        };
        let (near, others): (Vec<Group>, Vec<Group>) = self.groups.drain(..).partition(near);
        self.groups = others;
        let old: Vec<Damped> = near.iter().flat_map(|group| group.sines.iter().copied()).collect();
        let rest = self.rest(spectrum, None);
        let fit = |sines: &[Damped], lines: Range<usize>| {
            let starts: Vec<(f64, f64)> = sines.iter().map(|s| (s.periods, s.decay)).collect();
            Group::fit(&rest, lines, self.n, &starts)
        };
        let mut best: Option<Group> = None;
        for decay in [0.3 * decay, decay, 0.2] {
            let sines: Vec<Damped> = old.iter().copied().chain([Damped { decay, ..new }]).collect();
            let Ok(group) = fit(&sines, range(&sines, rest.len())) else { continue };
            if best.as_ref().is_none_or(|best| group.noise() < best.noise()) {
                best = Some(group);
            }
        }
        // A mode that turns out broader is fitted to all of its lines.
        let best = best.map(|group| {
            let wider = range(&group.sines, rest.len());
            if wider.len() > 2 * group.lines.len() {
                fit(&group.sines, wider).unwrap_or(group)
            } else {
                group
            }
        });
        let good = best.filter(|group| {
            let added = group.sines[old.len()];
            let alone =
                |s: &Damped| (s.periods - added.periods).abs() >= PARTED * s.width().max(added.width());
            let inside = group.lines.contains(&(added.periods.max(0.0) as usize));
            let without = if old.is_empty() { None } else { fit(&old, group.lines.clone()).ok() };
            let (left, free) = group.left();
            let worth = without.is_none_or(|w| (w.left().0 - left) / OWN as f64 > WORTH * left / free as f64);
            inside && worth && group.sines[..old.len()].iter().all(alone)
        });
        if let Some(group) = good {
            self.groups.push(group);
        } else {
            self.odd.push(top);
            self.groups.extend(near);
        }
    }

    /// Samples at the beginning of a part in which something else acts, as the contact of a blow: what is left falls at once behind it.
    fn contact(&self, part: &[f64], block: usize) -> Option<usize> {
        let left = self.left(part);
        let levels = levels(&left, block);
        let largest = levels.iter().copied().fold(0.0, f64::max);
        let first = self.strongest().map_or(0.0, |(group, m)| group.sines[m].amplitude.norm());
        let clear = |level: f64| level > 5e-3 * first && level > 0.3 * largest;
        let contact = |b: &usize| clear(levels[*b]) && levels[*b] > FALL * levels[b + 1];
        (0..levels.len().saturating_sub(1).min(3)).find(contact).map(|b| (b + 1) * block)
    }

    /// What the sines leave of a part.
    fn left(&self, part: &[f64]) -> Vec<f64> {
        let sines: Vec<&Damped> = self.groups.iter().flat_map(|group| &group.sines).collect();
        let sum = |i: usize| sines.iter().map(|sine| sine.sample(i, self.n)).sum::<f64>();
        part.iter().enumerate().map(|(i, v)| v - sum(i)).collect()
    }

    fn result(
        &self,
        trace: &Trace,
        part: Range<usize>,
        options: &DecayOptions,
        mut findings: Vec<Finding>,
    ) -> Result<DecayResult> {
        let unit = trace.meta.unit.quantity().symbol();
        let (mut modes, mut decaying) = (Vec::new(), Vec::new());
        let size = self.strongest().map_or(0.0, |(group, m)| group.sines[m].amplitude.norm());
        for (group, m) in self.asked() {
            let mode = mode(group, m, self.n, self.rate, unit);
            if decays(group, m) {
                let doubted = self
                    .odd
                    .iter()
                    .any(|k| (group.sines[m].periods - *k as f64).abs() < group.sines[m].reach());
                modes.push(if doubted { mode.without_uncertainty() } else { mode });
                decaying.push((group, m));
                if doubted {
                    findings.push(
                        Finding::doubt("decay-unexplained")
                            .number("frequency", modes[modes.len() - 1].frequency.value),
                    );
                }
            } else if self.strongest().is_some_and(|(strongest, s)| std::ptr::eq(strongest, group) && s == m)
            {
                let Damped { periods, decay, .. } = group.sines[m];
                let lost = -(-decay).exp_m1();
                let why = format!(
                    "the motion does not decay: its strongest line, {:.5} Hz, loses {:.2} ± {:.2} % within {:.4} s",
                    periods * self.rate / self.n as f64,
                    100.0 * lost,
                    100.0 * group.std(m, [0.0, 1.0, 0.0, 0.0]) * (-decay).exp(),
                    self.n as f64 / self.rate
                );
                return Err(Error::refused(why)
                    .hint("cut the record to what follows the release or the blow, or choose the band of the mode")
                    .setting("band"));
            } else if mode.amplitude.value > SEEN * size && group.sines[m].periods > 3.0 {
                let steady = Finding::note("decay-steady-line").number("frequency", mode.frequency.value);
                findings.push(steady.number("amplitude", mode.amplitude.value).name("unit", unit));
            }
        }
        if let Some(count) = options.modes.filter(|count| *count > modes.len()) {
            findings.push(Finding::caution("decay-fewer").count("n", modes.len()).count("count", count));
        }
        let at = |i: usize| trace.axis.at(i);
        let (levels, mut decrement) = self.levels(&trace.values[part.clone()], at(part.start), unit);
        let same = |(group, m): (&Group, usize)| {
            decaying.iter().position(|(other, k)| std::ptr::eq(*other, group) && *k == m)
        };
        if let Some(strongest) = self.strongest().and_then(same) {
            if let Some(found) = changed(&levels) {
                modes[strongest] = modes[strongest].clone().without_uncertainty();
                findings.push(found.number("frequency", modes[strongest].frequency.value));
            }
            // What is not known of a mode is not known of its decrement.
            if let (None, Some(decrement)) = (modes[strongest].zeta.std, &mut decrement) {
                decrement.std = None;
            }
        }
        modes.sort_by(|a, b| a.frequency.value.total_cmp(&b.frequency.value));
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

    /// The strongest mode in stretches of equal length, and what their amplitudes say of its damping.
    fn levels(&self, part: &[f64], start: f64, unit: &'static str) -> (Vec<Level>, Option<Estimate>) {
        let Some((group, m)) = self.strongest() else { return (Vec::new(), None) };
        let own = group.sines[m];
        // Beside others it is not known so well as to be followed alone.
        if group.sines.len() > 1 {
            return (Vec::new(), None);
        }
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
            let group = Group::fit(&spectrum, range.clone(), n, &starts).ok()?;
            let mode = mode(&group, 0, n, self.rate, unit);
            // Another mode that is there when this is over is not this one.
            let own = range.contains(&(group.sines[0].periods.max(0.0) as usize));
            let known = own && mode.zeta.std.is_some_and(|std| std < 0.3 * mode.zeta.value);
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

/// Lines to which sines are fitted together, of so many.
fn range(sines: &[Damped], all: usize) -> Range<usize> {
    let ends = |sign: f64| sines.iter().map(move |s| s.periods + sign * s.reach());
    let low = ends(-1.0).fold(f64::INFINITY, f64::min).max(1.0) as usize;
    let high = ends(1.0).fold(0.0, f64::max) as usize + 1;
    low..high.max(low + 2 * OWN * (sines.len() + 1)).min(all - 1)
}

/// Whether a sine surely decays.
fn decays(group: &Group, m: usize) -> bool {
    group.sines[m].decay > SURE * group.std(m, [0.0, 1.0, 0.0, 0.0])
}

/// A sine of a part of `n` samples as a mode.
fn mode(group: &Group, m: usize, n: usize, rate: f64, unit: &'static str) -> DecayMode {
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

/// Whether frequency and damping depend on the amplitude: χ² of both about their weighted means.
fn changed(levels: &[Level]) -> Option<Finding> {
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
        let found = Finding::doubt("decay-changes").number("from", first.mode.zeta.value);
        found
            .number("to", last.mode.zeta.value)
            .number("high", first.mode.amplitude.value)
            .number("low", last.mode.amplitude.value)
    })
}

#[cfg(test)]
mod tests;
