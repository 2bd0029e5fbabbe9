//! Which peaks are modes, and on which lines they are fitted.

use super::bands::{Group, Peak};
use super::rational::{Rational, rational};
use super::{Measured, Pole};
use std::ops::Range;
use vibro_record::Result;

/// Modes of one group at most: beyond, parameters outgrow the lines.
const TOGETHER: usize = 6;

/// An additional mode must lower Akaike's criterion by this much (Burnham & Anderson 2002, 2.6).
const NEEDED: f64 = 10.0;

/// First guesses for `peaks`.
fn starts(lines: &Measured, peaks: &[Peak]) -> Vec<(f64, f64)> {
    peaks.iter().map(|p| p.start(lines)).collect()
}

/// Finds the peaks of a group that the lines need. The group keeps those; the others are added to `unsupported`.
///
/// The highest peaks are fitted all at once: with a strong one left out the others explain its lines. Those that are not known, or
/// not needed beside the others, are dropped.
pub(super) fn chosen(lines: &Measured, group: &mut Group, unsupported: &mut Vec<Peak>) -> Result<Rational> {
    let mut highest = group.peaks.clone();
    highest.sort_by(|a, b| b.rise.total_cmp(&a.rise));
    unsupported.extend(highest.split_off(highest.len().min(TOGETHER)));
    let fit = loop {
        group.peaks.clone_from(&highest);
        group.peaks.sort_by_key(|p| p.at);
        match rational(lines, group.lines.clone(), &starts(lines, &group.peaks), &[]) {
            // Where not all can be fitted at once, the lowest is left out.
            Err(_) if highest.len() > 1 => unsupported.extend(highest.pop()),
            fit => break fit?,
        }
    };
    let fit = pruned(lines, group, fit, unsupported);
    Ok(if fit.whiteness.rejected() { narrowed(lines, group, fit) } else { fit })
}

/// Drops the modes that are not known, the lowest peak first, then those that the lines do not need beside the others.
fn pruned(lines: &Measured, group: &mut Group, mut fit: Rational, unsupported: &mut Vec<Peak>) -> Rational {
    while group.peaks.len() > 1 {
        let sound = fit.sound(lines, &group.peaks);
        let unknown = (0..sound.len()).filter(|at| !sound[*at]);
        let lowest = unknown.min_by(|a, b| group.peaks[*a].rise.total_cmp(&group.peaks[*b].rise));
        let without = |at: usize| {
            let (mut fewer, mut guess) = (group.peaks.clone(), starts(lines, &group.peaks));
            let known = guess.iter_mut().zip(&fit.modes).zip(&sound).filter(|(_, sound)| **sound);
            known.for_each(|((guess, mode), _)| *guess = (mode.frequency, mode.zeta));
            fewer.remove(at);
            guess.remove(at);
            let less = rational(lines, group.lines.clone(), &guess, &[]).ok()?;
            // A mode that leaves its peak for the one taken away is not the other's.
            let needless =
                less.aicc <= fit.aicc + NEEDED && less.sound(lines, &fewer).iter().all(|sound| *sound);
            (lowest.is_some() || needless).then_some((less, fewer, at))
        };
        let less = match lowest {
            Some(at) => without(at),
            None => (0..sound.len()).filter_map(without).min_by(|a, b| a.0.aicc.total_cmp(&b.0.aicc)),
        };
        let Some((less, fewer, at)) = less else { break };
        unsupported.push(group.peaks[at]);
        (fit, group.peaks) = (less, fewer);
    }
    fit
}

/// Fits the modes that were found around each peak of a band together, to all its lines, where that explains them.
pub(super) fn together(
    lines: &Measured,
    part: Range<usize>,
    fits: &mut Vec<(Group, Rational)>,
    unsupported: &mut Vec<Peak>,
) {
    let sound = |(group, fit): &(Group, Rational)| {
        let modes = group.peaks.clone().into_iter().zip(fit.modes.clone());
        let sound = fit.sound(lines, &group.peaks).into_iter();
        modes.zip(sound).filter(|(_, sound)| *sound).map(|(mode, _)| mode).collect::<Vec<_>>()
    };
    let (peaks, modes): (Vec<Peak>, Vec<_>) = fits.iter().flat_map(sound).unzip();
    let guess: Vec<(f64, f64)> = modes.iter().map(|m| (m.frequency, m.zeta)).collect();
    if guess.is_empty() || fits.iter().all(|(group, _)| group.lines == part) {
        return;
    }
    let Ok(fit) = rational(lines, part.clone(), &guess, &[]) else { return };
    let explained = fits.iter().any(|(_, fit)| !fit.whiteness.rejected());
    if fit.whiteness.rejected() && explained {
        return;
    }
    let mut all = Group { peaks, lines: part };
    let fit = pruned(lines, &mut all, fit, unsupported);
    *fits = vec![(all, fit)];
}

/// Fewest lines on either side of the outer peaks of a band that is made narrower.
const BESIDE: usize = 8;

/// Makes the band of a fit whose residuals are not white narrower, as long as they are not: what else is in a band matters the
/// less the narrower it is. Keeps the wide band where that does not help.
fn narrowed(lines: &Measured, group: &mut Group, wide: Rational) -> Rational {
    let (first, last) = (group.peaks[0].at, group.peaks[group.peaks.len() - 1].at);
    let starts = starts(lines, &group.peaks);
    let (mut below, mut above) = (first - group.lines.start, group.lines.end - last - 1);
    while below.max(above) > BESIDE {
        below = below.min((2 * below / 3).max(BESIDE));
        above = above.min((2 * above / 3).max(BESIDE));
        let part = first - below..last + above + 1;
        let fit = rational(lines, part.clone(), &starts, &[]).ok();
        if let Some(fit) = fit.filter(|fit| !fit.whiteness.rejected()) {
            group.lines = part;
            return fit;
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
