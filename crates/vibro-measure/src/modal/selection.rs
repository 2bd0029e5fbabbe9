//! Which peaks are modes, and on which lines they are fitted.

use super::bands::{Group, Peak};
use super::rational::{Rational, rational};
use super::{Fitted, Measured, Pole};
use vibro_record::{Finding, Result};

/// Modes of one group at most: beyond, parameters outgrow the lines.
const TOGETHER: usize = 6;

/// An additional mode must lower Akaike's criterion by this much (Burnham & Anderson 2002, 2.6).
const NEEDED: f64 = 10.0;

/// First guesses for `peaks`: what a fit gave where that lies at its peak, else the peak.
fn starts(lines: &Measured, peaks: &[Peak], known: Option<(&Rational, &[Peak])>) -> Vec<(f64, f64)> {
    let of = |peak: &Peak| {
        let (fit, fitted) = known?;
        let at = fitted.iter().position(|p| p.at == peak.at)?;
        let mode = &fit.modes[at];
        fit.sound(lines, fitted)[at].then_some((mode.frequency, mode.zeta))
    };
    peaks.iter().map(|p| of(p).unwrap_or_else(|| p.start(lines))).collect()
}

/// Finds the peaks of a group that the lines need. The group keeps those; the others are added to `unsupported`.
///
/// The highest peaks are fitted all at once: with a strong one left out the others explain its lines. Those that are not known, or
/// not needed beside the others, are dropped; then the rest is added in the order of height as long as the lines need it.
pub(super) fn chosen(lines: &Measured, group: &mut Group, unsupported: &mut Vec<Peak>) -> Result<Rational> {
    let mut waiting = std::mem::take(&mut group.peaks);
    waiting.sort_by(|a, b| b.rise.total_cmp(&a.rise));
    let mut later = waiting.split_off(waiting.len().min(TOGETHER));
    // Where not all can be fitted at once, the lowest waits.
    let mut best = loop {
        group.peaks.clone_from(&waiting);
        group.peaks.sort_by_key(|p| p.at);
        match rational(lines, group.lines.clone(), &starts(lines, &group.peaks, None), &[]) {
            Err(_) if waiting.len() > 1 => later.extend(waiting.pop()),
            fit => break fit?,
        }
    };
    let mut dropped;
    (best, dropped) = pruned(lines, group, best);
    later.sort_by(|a, b| b.rise.total_cmp(&a.rise));
    for peak in later {
        let mut with = group.peaks.clone();
        with.push(peak);
        with.sort_by_key(|p| p.at);
        let guess = starts(lines, &with, Some((&best, &group.peaks)));
        match rational(lines, group.lines.clone(), &guess, &[]) {
            Ok(fit)
                if with.len() <= TOGETHER
                    && fit.aicc < best.aicc - NEEDED
                    && fit.sound(lines, &with).iter().all(|s| *s) =>
            {
                (best, group.peaks) = (fit, with);
            }
            _ => dropped.push(peak),
        }
    }
    unsupported.extend(dropped);
    Ok(if best.whiteness.rejected() { narrowed(lines, group, best) } else { best })
}

/// Drops the modes that are not known, the lowest peak first, then those that the lines do not need beside the others.
fn pruned(lines: &Measured, group: &mut Group, mut fit: Rational) -> (Rational, Vec<Peak>) {
    let mut dropped = Vec::new();
    let without = |group: &Group, fit: &Rational, at: usize| {
        let mut fewer = group.peaks.clone();
        fewer.remove(at);
        let guess = starts(lines, &fewer, Some((fit, &group.peaks)));
        rational(lines, group.lines.clone(), &guess, &[]).ok().map(|less| (less, fewer))
    };
    while group.peaks.len() > 1 {
        let sound = fit.sound(lines, &group.peaks);
        let weakest = (0..sound.len())
            .filter(|at| !sound[*at])
            .min_by(|a, b| group.peaks[*a].rise.total_cmp(&group.peaks[*b].rise));
        let less = match weakest {
            Some(at) => without(group, &fit, at).map(|less| (at, less)),
            None => (0..group.peaks.len())
                .filter_map(|at| without(group, &fit, at).map(|less| (at, less)))
                .filter(|(_, (less, _))| less.aicc <= fit.aicc + NEEDED)
                // A mode that leaves its peak for the one taken away is not the other's.
                .filter(|(_, (less, fewer))| less.sound(lines, fewer).iter().all(|s| *s))
                .min_by(|a, b| a.1.0.aicc.total_cmp(&b.1.0.aicc)),
        };
        let Some((at, (less, fewer))) = less else { break };
        dropped.push(group.peaks[at]);
        (fit, group.peaks) = (less, fewer);
    }
    (fit, dropped)
}

/// Fits the modes that were found around each peak of a band together, to all its lines; keeps each fitted around its peak where they
/// do not explain all lines as well.
pub(super) fn together(
    lines: &Measured,
    band: (f64, f64),
    fits: Vec<Fitted>,
    unsupported: &mut Vec<Peak>,
    findings: &mut Vec<Finding>,
) -> Vec<Fitted> {
    // What is no mode by itself is not fitted together with the others.
    let is_mode = |(group, fit): &Fitted| fit.explains() && fit.sound(lines, &group.peaks).contains(&true);
    let (mut found, left): (Vec<Fitted>, Vec<Fitted>) = fits.into_iter().partition(is_mode);
    let part = lines.within(band);
    if found.iter().any(|(group, _)| group.lines != part) {
        let (mut peaks, mut guess, mut weak) = (Vec::new(), Vec::new(), Vec::new());
        for (group, fit) in &found {
            let sound = fit.sound(lines, &group.peaks);
            for ((peak, mode), sound) in group.peaks.iter().zip(&fit.modes).zip(sound) {
                if sound {
                    peaks.push(*peak);
                    guess.push((mode.frequency, mode.zeta));
                } else {
                    weak.push(*peak);
                }
            }
        }
        let one_explains = found.iter().any(|(_, fit)| !fit.whiteness.rejected());
        let all = rational(lines, part.clone(), &guess, &[]).ok();
        if let Some(fit) = all.filter(|fit| !(fit.whiteness.rejected() && one_explains)) {
            let mut group = Group { peaks, lines: part };
            let (fit, dropped) = pruned(lines, &mut group, fit);
            unsupported.extend(weak.into_iter().chain(dropped));
            found = vec![(group, fit)];
        } else {
            let unexplained = Finding::caution("modal-band-unexplained");
            findings.push(unexplained.number("low", band.0).number("high", band.1));
        }
    }
    found.extend(left);
    found
}

/// Fewest lines on either side of the outer peaks of a band that is made narrower.
const BESIDE: usize = 8;

/// Makes the band of a fit whose residuals are not white narrower, as long as they are not: what else is in a band matters the
/// less the narrower it is. Keeps the wide band where that does not help.
fn narrowed(lines: &Measured, group: &mut Group, wide: Rational) -> Rational {
    let (Some(first), Some(last)) = (group.peaks.first().map(|p| p.at), group.peaks.last().map(|p| p.at))
    else {
        return wide;
    };
    let starts: Vec<(f64, f64)> = group.peaks.iter().map(|p| p.start(lines)).collect();
    let (mut below, mut above) = (first - group.lines.start, group.lines.end - last - 1);
    while below.max(above) > BESIDE {
        below = below.min((2 * below / 3).max(BESIDE));
        above = above.min((2 * above / 3).max(BESIDE));
        let part = first - below..last + above + 1;
        match rational(lines, part.clone(), &starts, &[]) {
            Ok(fit) if !fit.whiteness.rejected() => {
                group.lines = part;
                return fit;
            }
            _ => {}
        }
    }
    wide
}

/// An additional mode under one peak must lower Akaike's criterion by this much: its four numbers then explain 28 of χ², as chance does
/// in one of 10⁵ peaks; ten (Burnham & Anderson 2002, 2.6) would be chance in one of a thousand.
const SPLIT: f64 = 20.0;

/// How much lower Akaike's criterion is with mode `m` of a fit split in two, where the lines support that: its frequency and damping
/// are then those of neither. `others` are the modes of other groups, which were subtracted before the fit.
pub(super) fn support_for_two(
    lines: &Measured,
    (group, fit): (&Group, &Rational),
    m: usize,
    others: &[Pole],
) -> Option<f64> {
    // Anything would explain residuals better that are not white.
    if lines.magnitude_only || fit.whiteness.rejected() {
        return None;
    }
    let mut starts: Vec<(f64, f64)> = fit.modes.iter().map(|o| (o.frequency, o.zeta)).collect();
    let (frequency, zeta) = starts[m];
    let half = 0.5 * zeta * frequency;
    starts.splice(m..=m, [(frequency - half, zeta), (frequency + half, zeta)]);
    let both = rational(lines, group.lines.clone(), &starts, others).ok()?;
    let better = fit.aicc - both.aicc;
    (better > SPLIT && both.modes.iter().all(|m| m.zeta > 0.0)).then_some(better)
}
