//! Which peaks are modes, and on which lines they are fitted.

use super::Measured;
use super::bands::{Group, Peak};
use super::rational::{Rational, rational};
use vibro_record::{Error, Finding, Result};

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
pub(super) fn chosen(lines: &Measured, group: &mut Group, unsupported: &mut Vec<f64>) -> Result<Rational> {
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
    unsupported.extend(dropped.iter().map(|p| lines.frequency[p.at]));
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

/// Fits the modes that were found around each peak of a band together, to all its lines.
///
/// # Errors
/// If the only peak of the band cannot be fitted.
pub(super) fn together(
    lines: &Measured,
    (low, high): (f64, f64),
    groups: Vec<Group>,
    fits: Vec<Result<Rational>>,
    unsupported: &mut Vec<f64>,
    findings: &mut Vec<Finding>,
) -> Result<(Vec<Group>, Vec<Result<Rational>>)> {
    if let [Err(error)] = fits.as_slice() {
        return Err(Error::refused(error.to_string()));
    }
    let f = &lines.frequency;
    let part = f.partition_point(|f| *f < low)..f.partition_point(|f| *f <= high);
    // What is no mode by itself is not fitted together with the others.
    let (mut found, mut left) = (Vec::new(), Vec::new());
    for (group, fit) in groups.into_iter().zip(fits) {
        match fit {
            Ok(fit) if fit.explains() && fit.sound(lines, &group.peaks).contains(&true) => {
                found.push((group, fit));
            }
            fit => left.push((group, fit)),
        }
    }
    let (mut peaks, mut guess): (Vec<Peak>, Vec<(f64, f64)>) = (Vec::new(), Vec::new());
    for (group, fit) in &found {
        for ((peak, mode), sound) in group.peaks.iter().zip(&fit.modes).zip(fit.sound(lines, &group.peaks)) {
            if sound {
                peaks.push(*peak);
                guess.push((mode.frequency, mode.zeta));
            }
        }
    }
    let alone = found.iter().all(|(group, _)| group.lines == part);
    let all = if alone { None } else { Some(rational(lines, part.clone(), &guess, &[])) };
    match all {
        Some(Ok(fit))
            if fit.whiteness.rejected() && found.iter().any(|(_, fit)| !fit.whiteness.rejected()) =>
        {
            findings.push(Finding::caution("modal-band-unexplained").number("low", low).number("high", high));
        }
        Some(Ok(fit)) => {
            for peak in found.iter().flat_map(|(group, _)| &group.peaks).filter(|p| !peaks.contains(p)) {
                unsupported.push(f[peak.at]);
            }
            let mut all = Group { peaks, lines: part };
            let (fit, dropped) = pruned(lines, &mut all, fit);
            unsupported.extend(dropped.iter().map(|p| f[p.at]));
            found = vec![(all, fit)];
        }
        Some(Err(_)) => {
            findings.push(Finding::caution("modal-band-not-fitted").number("low", low).number("high", high));
        }
        None => {}
    }
    Ok(found.into_iter().map(|(group, fit)| (group, Ok(fit))).chain(left).unzip())
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
