//! Finds the damped sines of a part of a record, the strongest first (Li & Stoica 1996, RELAX).

use super::damped::{Damped, OWN, SineGroup, lines};
use super::result::DecayOptions;
use super::usable::levels;
use crate::mean::average;
use crate::noise;
use num_complex::Complex64;
use std::ops::Range;
use vibro_record::{median, sort_by_number};

/// Most sines of one part, steady ones included.
pub(super) const MOST: usize = 12;
/// Most lines above the noise that no sine fits; then the search ends.
const ODD: usize = 8;
/// Probability with which the largest line of pure noise passes for a mode.
const BY_CHANCE: f64 = 1e-4;
/// Least F ratio of a further sine, which has four parameters: chance exceeds it in about 1e-4 of cases.
const WORTH: f64 = 10.0;
/// Least distance of two sines in half-widths of the wider one. Nearer ones describe one motion that does not
/// decay as a mode does.
const PARTED: f64 = 1.0;
/// Decay of the strongest mode over a part, in natural logarithms, after which further samples add nothing.
pub(super) const ENOUGH: f64 = 6.0;
/// A part that is this many times longer than its strongest mode is visible is cut before other modes are
/// searched. Otherwise a mode would extend over thousands of lines, which add nothing.
const LONG: f64 = 4.0;
/// Standard uncertainties by which a decay must exceed 0.
pub(super) const SURE: f64 = 3.0;
/// Part of its amplitude that steady hum may lose or gain over a record. It adds to the uncertainty of the
/// decay: mains and machines are steady to half a per cent.
pub(super) const STEADY: f64 = 0.005;
/// Least ratio of the residual's RMS values in two successive blocks at the end of a contact.
const FALL: f64 = 6.0;
/// Lines on either side whose median is the height of a broad mode.
const BROAD: usize = 4;

/// Sines of a part.
pub struct Sines {
    pub n: usize,
    pub rate: f64,
    /// Lines in which modes are searched. Sines elsewhere are fitted, too, so that they do not pass for modes
    /// here.
    band: Range<usize>,
    pub groups: Vec<SineGroup>,
    /// Lines above the noise that no further sine fits.
    pub odd: Vec<usize>,
}

impl Sines {
    /// Finds the sines of a part, the strongest first. It stops after the strongest if that does not decay,
    /// or if the part is much too long for it and longer than [`LONG`] times `least` samples.
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
        // The second pass tries lines again that no sine fitted while another sine was still unknown.
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
            sines.part(&spectrum);
        }
        if sines.add_hum(&spectrum) {
            sines.settle(&spectrum);
            sines.part(&spectrum);
        }
        // A line near a sine that is still above the noise is a mode beyond the requested number, or not a
        // sine.
        let rest = sines.rest(&spectrum, None);
        let beside = |k: &usize| sines.groups.iter().any(|group| group.lines.contains(k));
        let left: Vec<usize> = sines.next(&rest, band.clone()).into_iter().filter(beside).collect();
        sines.odd.extend(left);
        sines
    }

    /// Fits each group again, twice, with the sines of all others subtracted.
    fn settle(&mut self, spectrum: &[Complex64]) {
        for at in (0..self.groups.len()).cycle().take(2 * self.groups.len()) {
            let rest = self.rest(spectrum, Some(at));
            let old = &self.groups[at];
            let starts: Vec<(f64, f64)> = old.sines.iter().map(|s| (s.periods, s.decay)).collect();
            let lines = range(&old.sines, rest.len());
            if let Ok(better) = SineGroup::fit(&rest, lines, self.n, &starts, &old.hum) {
                self.groups[at] = better;
            }
        }
    }

    /// Removes the weaker of two sines that came too near each other when all were fitted again: the two
    /// describe one motion that does not decay as a mode does. Its line is noted as odd.
    fn part(&mut self, spectrum: &[Complex64]) {
        while let Some((at, m)) = self.one_of_two() {
            let group = &mut self.groups[at];
            let odd = group.sines.remove(m);
            self.odd.push(odd.periods.max(0.0) as usize);
            if group.sines.is_empty() {
                self.groups.remove(at);
            }
            self.settle(spectrum);
        }
    }

    /// Group and index of the weaker of two sines that are too near each other.
    fn one_of_two(&self) -> Option<(usize, usize)> {
        let all = || {
            let groups = self.groups.iter().enumerate();
            groups.flat_map(|(at, group)| group.sines.iter().enumerate().map(move |(m, s)| ((at, m), s)))
        };
        let stronger = |place: (usize, usize), s: &Damped| {
            all().any(|(other, t)| other != place && is_one(s, t) && t.amplitude.norm() > s.amplitude.norm())
        };
        all().find(|(place, s)| stronger(*place, s)).map(|(place, _)| place)
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

    /// The sine with the largest amplitude over decay, thus the most motion over the part. A steady sine
    /// counts with the decay [`ENOUGH`].
    pub fn strongest(&self) -> Option<(&SineGroup, usize)> {
        let size = |(group, m): &(&SineGroup, usize)| {
            let sine = &group.sines[*m];
            sine.amplitude.norm() / if decays(group, *m) { sine.decay.max(1.0) } else { ENOUGH }
        };
        self.asked().max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// Whether the strongest mode has decayed long before the part ends.
    pub fn is_long(&self) -> bool {
        self.strongest().is_some_and(|(group, m)| decays(group, m) && group.sines[m].decay > LONG * ENOUGH)
    }

    /// Whether the strongest sine does not decay, and is so much larger than a `line` of this height that no
    /// further sine can be stronger.
    fn is_steady(&self, line: f64) -> bool {
        let steady = self.strongest().filter(|(group, m)| !decays(group, *m));
        steady.is_some_and(|(group, m)| group.sines[m].amplitude.norm() > 2.0 * ENOUGH * line)
    }

    /// The lines after subtraction of the sines of all groups but one.
    pub(super) fn rest(&self, spectrum: &[Complex64], but: Option<usize>) -> Vec<Complex64> {
        let others = self.groups.iter().enumerate().filter(|(i, _)| Some(*i) != but);
        let sines: Vec<&Damped> = others.flat_map(|(_, group)| group.all()).collect();
        let left = |(k, line): (usize, &Complex64)| {
            line - sines.iter().map(|s| s.line(k, self.n)).sum::<Complex64>()
        };
        spectrum.iter().enumerate().map(left).collect()
    }

    /// The largest line in `band` that stands out from those around it.
    fn next(&self, rest: &[Complex64], band: Range<usize>) -> Option<usize> {
        let sizes: Vec<f64> = rest.iter().map(|line| line.norm()).collect();
        let mut tops: Vec<usize> =
            band.clone().filter(|k| sizes[*k] >= sizes[k - 1] && sizes[*k] >= sizes[k + 1]).collect();
        sort_by_number(&mut tops, |a| -sizes[*a]);
        // Rayleigh: the largest of n lines of noise exceeds t standard deviations with a probability of n
        // e^(−t²/2).
        let visible = (2.0 * (band.len().max(1) as f64 / BY_CHANCE).ln()).sqrt();
        let above = |k: usize, size: f64, reach: usize| {
            noise::around(&sizes, k, reach, None).is_none_or(|floor| size > visible * floor)
        };
        // A mode that decays long before the others is broad: the lines near its largest are its own, and as
        // high. Their median is compared with lines farther away.
        let wide = |k: usize| {
            let near = &sizes[k.saturating_sub(BROAD)..(k + BROAD + 1).min(sizes.len())];
            above(k, median(near), noise::REACH.max(k / 2))
        };
        let seen = |k: &usize| above(*k, sizes[*k], noise::REACH) || wide(*k);
        let known = |k: &usize| self.odd.iter().any(|odd| odd.abs_diff(*k) < 2);
        tops.into_iter().filter(|k| !known(k)).take(MOST).find(seen)
    }

    /// Adds the sine of line `top`, fitted together with those near it; a line that no sine fits is noted as
    /// odd.
    fn add(&mut self, spectrum: &[Complex64], rest: &[Complex64], top: usize) {
        let power = |k: usize| rest[k].norm_sqr();
        let half = |k: &usize| power(*k) > 0.5 * power(top);
        let wide = (top..rest.len() - 1).take_while(half).count() + (1..top).rev().take_while(half).count();
        let decay = std::f64::consts::PI * wide as f64;
        let new = Damped { periods: top as f64, decay, amplitude: Complex64::ZERO };
        let near = |group: &SineGroup| group.sines.iter().any(|s| SineGroup::near(s, &new));
        let (near, others): (Vec<SineGroup>, Vec<SineGroup>) = self.groups.drain(..).partition(near);
        self.groups = others;
        let old: Vec<Damped> = near.iter().flat_map(|group| group.sines.iter().copied()).collect();
        let rest = self.rest(spectrum, None);
        let fit = |sines: &[Damped], lines: Range<usize>| {
            let starts: Vec<(f64, f64)> = sines.iter().map(|s| (s.periods, s.decay)).collect();
            SineGroup::fit(&rest, lines, self.n, &starts, &[])
        };
        let mut best: Option<SineGroup> = None;
        for decay in [0.3 * decay, decay, 0.2] {
            let sines: Vec<Damped> = old.iter().copied().chain([Damped { decay, ..new }]).collect();
            let Ok(group) = fit(&sines, range(&sines, rest.len())) else { continue };
            if best.as_ref().is_none_or(|best| group.fit.variance().sqrt() < best.fit.variance().sqrt()) {
                best = Some(group);
            }
        }
        // A mode that turns out broader is fitted again, to all of its lines.
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
            let alone = |s: &Damped| !is_one(s, &added);
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

    /// Number of samples at the beginning of a part in which another force acts, such as the contact of a
    /// blow. The residual is large in them and falls abruptly afterwards.
    pub fn contact(&self, part: &[f64], block: usize) -> Option<usize> {
        let left = self.left(part);
        let levels = levels(&left, block);
        let largest = levels.iter().copied().fold(0.0, f64::max);
        let first = self.strongest().map_or(0.0, |(group, m)| group.sines[m].amplitude.norm());
        let clear = |level: f64| level > 5e-3 * first && level > 0.3 * largest;
        let contact = |b: &usize| clear(levels[*b]) && levels[*b] > FALL * levels[b + 1];
        (0..levels.len().saturating_sub(1).min(3)).find(contact).map(|b| (b + 1) * block)
    }

    /// Residual of a part: its samples less all sines.
    pub fn left(&self, part: &[f64]) -> Vec<f64> {
        let sines: Vec<&Damped> = self.groups.iter().flat_map(SineGroup::all).collect();
        let sum = |i: usize| sines.iter().map(|sine| sine.sample(i, self.n)).sum::<f64>();
        part.iter().enumerate().map(|(i, v)| v - sum(i)).collect()
    }
}

/// Whether two sines are too near each other to be two modes.
fn is_one(a: &Damped, b: &Damped) -> bool {
    (a.periods - b.periods).abs() < PARTED * a.width().max(b.width())
}

/// Range of lines, among `all`, to which these sines are fitted together.
pub(super) fn range(sines: &[Damped], all: usize) -> Range<usize> {
    let ends = |sign: f64| sines.iter().map(move |s| s.periods + sign * s.reach());
    let low = ends(-1.0).fold(f64::INFINITY, f64::min).max(1.0) as usize;
    let high = ends(1.0).fold(0.0, f64::max) as usize + 1;
    low..high.max(low + 2 * OWN * (sines.len() + 1)).min(all - 1)
}

/// Whether the decay of a sine exceeds 0 by more than [`SURE`] standard uncertainties, of which hum that is
/// not quite steady is a part.
pub fn decays(group: &SineGroup, m: usize) -> bool {
    group.sines[m].decay > SURE * group.std(m, [0.0, 1.0, 0.0, 0.0]).hypot(STEADY)
}
