//! The sines of a part of a record, the strongest first (Li & Stoica 1996, RELAX).

use super::damped::{Damped, OWN, SineGroup, lines};
use super::result::DecayOptions;
use super::usable::levels;
use crate::mean::average;
use crate::noise;
use num_complex::Complex64;
use std::ops::Range;
use vibro_record::median;

/// Most sines of one record, those that do not decay with them.
pub(super) const MOST: usize = 12;
/// Most lines that stand out and are no mode.
const ODD: usize = 8;
/// How often the largest line of pure noise may pass for a mode.
const BY_CHANCE: f64 = 1e-4;
/// F of four more parameters to be worth them, at a chance of about 1e-4.
const WORTH: f64 = 10.0;
/// Two sines nearer than so many half-widths of the wider one are one that does not decay as a mode does.
const PARTED: f64 = 1.5;
/// Decay over the part, in natural logarithms: later there is nothing to be learnt.
pub(super) const ENOUGH: f64 = 6.0;
/// A part so many times as long as its strongest mode is seen is cut before others are sought: its lines, of
/// which a mode has thousands, say no more.
const LONG: f64 = 4.0;
/// Standard uncertainties by which a decay has to be above nothing.
const SURE: f64 = 3.0;
/// Fall of what is left from block to block where a contact ends.
const FALL: f64 = 6.0;
/// Lines on either side that belong to a broad mode.
const BROAD: usize = 4;

/// Sines of a part.
pub struct Sines {
    pub n: usize,
    pub rate: f64,
    /// Lines at which modes are asked for; sines elsewhere are fitted, so that they do not pass for these.
    band: Range<usize>,
    pub groups: Vec<SineGroup>,
    /// Lines that stand out and are no mode beside those that are known.
    pub odd: Vec<usize>,
}

impl Sines {
    /// Finds the sines of a part, the strongest first; no more than that one where the part is much too long
    /// for it, and more than `least` samples, or where it does not decay.
    pub fn of(part: &[f64], rate: f64, options: &DecayOptions, least: usize) -> Sines {
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
                    if sines.is_steady(rest[top].norm()) {
                        return sines;
                    }
                    sines.add(&spectrum, &rest, top);
                    if sines.is_long() && LONG * (least as f64) < n as f64 {
                        return sines;
                    }
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
            if let Ok(better) = SineGroup::fit(&rest, range(&old.sines, rest.len()), self.n, &starts) {
                self.groups[at] = better;
            }
        }
    }

    fn count(&self) -> usize {
        self.groups.iter().map(|group| group.sines.len()).sum()
    }

    /// The sines within the band.
    pub fn asked(&self) -> impl Iterator<Item = (&SineGroup, usize)> {
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
    pub fn strongest(&self) -> Option<(&SineGroup, usize)> {
        let size = |(group, m): &(&SineGroup, usize)| {
            let sine = &group.sines[*m];
            sine.amplitude.norm() / if decays(group, *m) { sine.decay.max(1.0) } else { ENOUGH }
        };
        self.asked().max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// Whether the strongest mode is over long before the part is.
    pub fn is_long(&self) -> bool {
        self.strongest().is_some_and(|(group, m)| decays(group, m) && group.sines[m].decay > LONG * ENOUGH)
    }

    /// Whether the strongest sine does not decay, and none of a line this high can be stronger: a sine is as
    /// high as its line.
    fn is_steady(&self, line: f64) -> bool {
        let steady = self.strongest().filter(|(group, m)| !decays(group, *m));
        steady.is_some_and(|(group, m)| group.sines[m].amplitude.norm() > 2.0 * ENOUGH * line)
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
            above(k, median(near), noise::REACH.max(k / 2))
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
        let near = |group: &SineGroup| {
            group.sines.iter().any(|s| (s.periods - new.periods).abs() < 0.5 * (s.reach() + new.reach()))
        };
        let (near, others): (Vec<SineGroup>, Vec<SineGroup>) = self.groups.drain(..).partition(near);
        self.groups = others;
        let old: Vec<Damped> = near.iter().flat_map(|group| group.sines.iter().copied()).collect();
        let rest = self.rest(spectrum, None);
        let fit = |sines: &[Damped], lines: Range<usize>| {
            let starts: Vec<(f64, f64)> = sines.iter().map(|s| (s.periods, s.decay)).collect();
            SineGroup::fit(&rest, lines, self.n, &starts)
        };
        let mut best: Option<SineGroup> = None;
        for decay in [0.3 * decay, decay, 0.2] {
            let sines: Vec<Damped> = old.iter().copied().chain([Damped { decay, ..new }]).collect();
            let Ok(group) = fit(&sines, range(&sines, rest.len())) else { continue };
            if best.as_ref().is_none_or(|best| group.fit.variance().sqrt() < best.fit.variance().sqrt()) {
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
            let (left, free) = (group.fit.sum_of_squares(), group.fit.degrees_of_freedom());
            let gained = |less: SineGroup| (less.fit.sum_of_squares() - left) / OWN as f64;
            let worth = without.is_none_or(|less| gained(less) > WORTH * left / free as f64);
            inside && worth && group.sines[..old.len()].iter().all(alone)
        });
        if let Some(group) = good {
            self.groups.push(group);
        } else {
            self.odd.push(top);
            self.groups.extend(near);
        }
    }

    /// Samples at the beginning of a part in which something else acts, as the contact of a blow: what is
    /// left falls at once behind it.
    pub fn contact(&self, part: &[f64], block: usize) -> Option<usize> {
        let left = self.left(part);
        let levels = levels(&left, block);
        let largest = levels.iter().copied().fold(0.0, f64::max);
        let first = self.strongest().map_or(0.0, |(group, m)| group.sines[m].amplitude.norm());
        let clear = |level: f64| level > 5e-3 * first && level > 0.3 * largest;
        let contact = |b: &usize| clear(levels[*b]) && levels[*b] > FALL * levels[b + 1];
        (0..levels.len().saturating_sub(1).min(3)).find(contact).map(|b| (b + 1) * block)
    }

    /// What the sines leave of a part.
    pub fn left(&self, part: &[f64]) -> Vec<f64> {
        let sines: Vec<&Damped> = self.groups.iter().flat_map(|group| &group.sines).collect();
        let sum = |i: usize| sines.iter().map(|sine| sine.sample(i, self.n)).sum::<f64>();
        part.iter().enumerate().map(|(i, v)| v - sum(i)).collect()
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
pub fn decays(group: &SineGroup, m: usize) -> bool {
    group.sines[m].decay > SURE * group.std(m, [0.0, 1.0, 0.0, 0.0])
}
