//! Which lines belong to which peak, which peaks are modes, and on which lines they are fitted.

use super::peak::Peak;
use super::rational::{Rational, rational, residual_sum};
use super::{Measured, Pole};
use crate::peaks::local_maxima;
use crate::residuals::NO_SUPPORT;
use std::ops::Range;
use vibro_record::units::notation::shortest;
use vibro_record::{Error, Result, Window, median, sort_by_number};

/// Most modes in one group: with more, the parameters outgrow the lines.
const TOGETHER: usize = 6;

/// First guesses of frequency in Hz and damping ratio for `peaks`, from the line and the half-power
/// bandwidth of each.
fn starts(lines: &Measured, peaks: &[Peak]) -> Vec<(f64, f64)> {
    let start = |p: &Peak| (lines.frequency[p.at], p.width / (2.0 * lines.frequency[p.at]));
    peaks.iter().map(start).collect()
}

/// Sets the window of the segments by the leakage at the highest peak: Hann, the default of analysers, or
/// none, as under a periodic excitation. Returns `false` where the lines do not decide.
pub(super) fn averaging(lines: &mut Measured, groups: &[PeakGroup]) -> bool {
    let highest = |group: &PeakGroup| group.peaks.iter().map(|p| p.rise).fold(0.0, f64::max);
    let Some(group) = groups.iter().max_by(|a, b| highest(a).total_cmp(&highest(b))) else { return false };
    let aicc = |window| {
        let lines = Measured { window, ..lines.clone() };
        let fit = rational(&lines, group.lines.clone(), (&starts(&lines, &group.peaks), 0), &[]);
        fit.ok().map(|fit| fit.aicc)
    };
    let (Some(without), Some(with)) = (aicc(None), aicc(Some(Window::Hann))) else { return false };
    lines.window = (with < without - NO_SUPPORT).then_some(Window::Hann);
    (without - with).abs() > NO_SUPPORT
}

/// Fits those peaks of a group that the lines support as modes. The group keeps them; the others are added
/// to `unsupported`.
///
/// The highest peaks are fitted at once: without a strong one the others would bend to explain its lines.
/// Modes that are not determined, or not needed beside the others, are dropped.
pub(super) fn chosen(
    lines: &Measured,
    group: &mut PeakGroup,
    unsupported: &mut Vec<Peak>,
) -> Result<Rational> {
    let mut highest = group.peaks.clone();
    sort_by_number(&mut highest, |a| -a.rise);
    unsupported.extend(highest.split_off(highest.len().min(TOGETHER)));
    let fit = loop {
        group.peaks.clone_from(&highest);
        group.peaks.sort_by_key(|p| p.at);
        match rational(lines, group.lines.clone(), (&starts(lines, &group.peaks), 0), &[]) {
            // Where not all can be fitted at once, the lowest is left out.
            Err(_) if highest.len() > 1 => unsupported.extend(highest.pop()),
            fit => break fit?,
        }
    };
    let mut fit = pruned(lines, group, fit, unsupported);
    if fit.whiteness.rejected() {
        complete(lines, group, &mut fit, &[]);
    }
    if !fit.whiteness.rejected() {
        return Ok(fit);
    }
    let wide = group.clone();
    let narrow = narrowed(lines, group, fit);
    // The modes of the narrow band are good first guesses for the wide one, with a neighbour beside them.
    let more = one_more(lines, &wide, &narrow, &[]).filter(|_| group.lines != wide.lines);
    let Some(more) = more.filter(|more| !more.whiteness.rejected()) else { return Ok(narrow) };
    let (peaks, sound) = more.at_peaks(lines);
    if more.unclear(&sound).is_some() || wide.leaves_out(lines, &more.modes) {
        return Ok(narrow);
    }
    *group = PeakGroup { peaks, lines: wide.lines, ..PeakGroup::default() };
    Ok(more)
}

/// Drops the modes that are not determined, the lowest peak first, then those whose removal raises Akaike's
/// criterion by no more than [`NO_SUPPORT`].
fn pruned(
    lines: &Measured,
    group: &mut PeakGroup,
    mut fit: Rational,
    unsupported: &mut Vec<Peak>,
) -> Rational {
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
            let less = rational(lines, group.lines.clone(), (&guess, 0), &[]).ok()?;
            // Where a remaining mode moves to the removed peak, the removed mode was needed.
            let needless =
                less.aicc <= fit.aicc + NO_SUPPORT && less.sound(lines, &fewer).iter().all(|sound| *sound);
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

/// Fits the modes found around the peaks of a band together to all its lines. Keeps the separate fits where
/// only they leave white residuals.
pub(super) fn together(
    lines: &Measured,
    part: Range<usize>,
    fits: &mut Vec<(PeakGroup, Rational)>,
    unsupported: &mut Vec<Peak>,
) {
    let sound = |(group, fit): &(PeakGroup, Rational)| {
        let modes = group.peaks.clone().into_iter().zip(fit.modes.clone());
        let sound = fit.sound(lines, &group.peaks).into_iter();
        modes.zip(sound).filter(|(_, sound)| *sound).map(|(mode, _)| mode).collect::<Vec<_>>()
    };
    let (peaks, modes): (Vec<Peak>, Vec<_>) = fits.iter().flat_map(sound).unzip();
    let guess: Vec<(f64, f64)> = modes.iter().map(|m| (m.frequency, m.zeta)).collect();
    if guess.is_empty() || fits.iter().all(|(group, _)| group.lines == part) {
        return;
    }
    let Ok(fit) = rational(lines, part.clone(), (&guess, 0), &[]) else { return };
    let explained = fits.iter().any(|(_, fit)| !fit.whiteness.rejected());
    if fit.whiteness.rejected() && explained {
        return;
    }
    let mut all = PeakGroup { peaks, lines: part, ..PeakGroup::default() };
    let fit = pruned(lines, &mut all, fit, unsupported);
    *fits = vec![(all, fit)];
}

/// Fewest lines beyond the outer peaks of a narrowed band: fewer determine the modes less, more let other
/// modes in.
const BESIDE: usize = 8;

/// Narrows the band of a fit until its residuals are white: other modes disturb a narrow band less. Keeps
/// the wide band where that does not help.
fn narrowed(lines: &Measured, group: &mut PeakGroup, wide: Rational) -> Rational {
    let (first, last) = (group.peaks[0].at, group.peaks[group.peaks.len() - 1].at);
    let starts = starts(lines, &group.peaks);
    let (mut below, mut above) = (first - group.lines.start, group.lines.end - last - 1);
    while below.max(above) > BESIDE {
        below = below.min((2 * below / 3).max(BESIDE));
        above = above.min((2 * above / 3).max(BESIDE));
        let part = first - below..last + above + 1;
        let fit = rational(lines, part.clone(), (&starts, 0), &[]).ok();
        if let Some(fit) = fit.filter(|fit| !fit.whiteness.rejected()) {
            (group.lines, group.wider, group.ahead, group.pattern) = (part, group.ahead, None, None);
            return fit;
        }
    }
    wide
}

/// Least drop of Akaike's criterion for an additional mode that shows no peak. Its four parameters then
/// lower χ² by 28, which chance does at one of 10⁵ peaks. A drop of ten (Burnham & Anderson 2002, 2.6)
/// occurs by chance at one of a thousand.
const SPLIT: f64 = 20.0;

/// Distances from a mode, in its bandwidths, at which a neighbour without a peak is searched.
const BESIDE_A_MODE: [f64; 6] = [-3.0, -1.5, -0.5, 0.5, 1.5, 3.0];

/// A group without a sound mode counts as noise where its residuals exceed this fraction of the highest line
/// (root mean square).
const NOISE: f64 = 0.2;

/// Fits with a further mode of a function, each of which chance may leave with a pattern: a weak one speaks
/// against no mode.
const CANDIDATES: usize = 100;

/// Two modes closer than this fraction of their mean bandwidth count as one whose shape is not that of the
/// model.
const APART: f64 = 0.25;

/// A neighbour lower than this fraction of the highest peak of a group is left to the residual terms.
const LOW: f64 = 0.05;

/// Number of the best distances of [`BESIDE_A_MODE`] at which a further mode is fitted.
const TRIED: usize = 3;

/// The best fit of a group with one more mode than `fit`, whether it shows a peak or not; `others` are
/// subtracted first.
fn one_more(lines: &Measured, group: &PeakGroup, fit: &Rational, others: &[Pole]) -> Option<Rational> {
    let starts: Vec<(f64, f64)> = fit.modes.iter().map(|m| (m.frequency, m.zeta)).collect();
    let guess = |(m, bandwidths): (usize, f64)| {
        let (frequency, zeta) = starts[m];
        let at = frequency * (1.0 + 2.0 * bandwidths * zeta);
        let mut starts = starts.clone();
        // Where the two are near, both start beside the peak, on opposite sides.
        if bandwidths.abs() < 1.0 {
            starts[m].0 = frequency * (1.0 - bandwidths * zeta);
        }
        starts.push((at, zeta));
        let left = residual_sum(lines, group.lines.clone(), &starts, others)?;
        Some((left, starts))
    };
    let places = (0..starts.len()).flat_map(|m| BESIDE_A_MODE.map(|bandwidths| (m, bandwidths)));
    let mut guesses: Vec<(f64, Vec<(f64, f64)>)> = places.filter_map(guess).collect();
    sort_by_number(&mut guesses, |a| a.0);
    let fitted = |(_, starts): (f64, Vec<(f64, f64)>)| {
        let known = starts.len() - 1;
        rational(lines, group.lines.clone(), (&starts, known), others).ok()
    };
    // A mode that grows is none, but a sign of one where no other fits.
    let grows = |fit: &Rational| fit.modes.iter().any(|m| m.zeta <= 0.0);
    let fits = guesses.into_iter().take(TRIED).filter_map(fitted);
    fits.min_by(|a, b| grows(a).cmp(&grows(b)).then(a.aicc.total_cmp(&b.aicc)))
}

/// Adds modes that the lines need although they show no peak: one beside a higher peak, or two under one.
/// Where another mode is supported but not determined, `group.ahead` records it, and `group.pattern` where
/// the residuals keep a pattern with another mode, too. Where its existence is open, the uncertainties cover
/// both cases (Burnham & Anderson 2002, 4.3.2). Returns which modes are sound.
pub(super) fn complete(
    lines: &Measured,
    group: &mut PeakGroup,
    fit: &mut Rational,
    others: &[Pole],
) -> Vec<bool> {
    (group.ahead, group.pattern) = (group.wider, None);
    let mut sound = fit.sound(lines, &group.peaks);
    // No neighbours are searched without phases, or around a peak of noise.
    if lines.magnitude_only || !sound.contains(&true) && fit.unexplained > NOISE {
        return sound;
    }
    let mut coloured: Option<Rational> = None;
    loop {
        let last = coloured.as_ref().unwrap_or(fit);
        if last.modes.len() >= TOGETHER || last.modes.iter().any(|m| m.zeta <= 0.0) {
            break;
        }
        let Some(more) = one_more(lines, group, last, others) else { break };
        let better = fit.aicc - more.aicc;
        let left_out = group.leaves_out(lines, &more.modes);
        if fit.whiteness.alike_among(1) && more.whiteness.alike_among(CANDIDATES) {
            // Residuals that stay coloured support any further mode a little. One that explains much more may
            // be the first of two that are missing. A third is not tried: each takes longer than all before.
            if left_out || coloured.is_some() || better <= SPLIT {
                break;
            }
            group.pattern = Some(better);
            coloured = Some(more);
            continue;
        }
        if coloured.as_ref().is_some_and(|fewer| left_out || fewer.aicc <= more.aicc) {
            break;
        }
        let (peaks, its) = more.at_peaks(lines);
        if better > SPLIT && !left_out {
            group.ahead = more.unclear(&its).map(|at| (better, at));
            if group.ahead.is_some() {
                break;
            }
            (group.peaks, group.wider, group.pattern, coloured) = (peaks, None, None, None);
            (*fit, sound) = (more, its);
            continue;
        }
        // A further mode that does not lower the criterion does not change the uncertainties.
        if better <= 0.0 {
            break;
        }
        let ahead = widened(fit, &more, &its, better);
        group.ahead = group.ahead.or(ahead);
        break;
    }
    sound
}

impl Rational {
    /// The peaks of the modes, whether they show or not, and which modes are sound.
    fn at_peaks(&self, lines: &Measured) -> (Vec<Peak>, Vec<bool>) {
        let peaks: Vec<Peak> = self.modes.iter().map(|mode| lines.peak(mode)).collect();
        let sound = self.sound(lines, &peaks);
        (peaks, sound)
    }

    /// Frequency in Hz of the first of two modes that count as one, else of the first that is not sound.
    fn unclear(&self, sound: &[bool]) -> Option<f64> {
        let width = |pair: &[Pole]| pair[0].zeta * pair[0].frequency + pair[1].zeta * pair[1].frequency;
        let close = |w: &&[Pole]| w[1].frequency - w[0].frequency <= APART * width(w);
        let one = self.modes.windows(2).find(close).map(|w| w[0].frequency);
        one.or_else(|| sound.iter().position(|sound| !sound).map(|at| self.modes[at].frequency))
    }
}

/// Widens the uncertainties of a fit to cover the fit `more`, which has one more mode, by its Akaike weight;
/// `better` is how much lower its criterion is, `sound` which of its modes are sound. Returns `better` and
/// the frequency in Hz of the first mode that the fit `more` leaves undetermined.
fn widened(fit: &mut Rational, more: &Rational, sound: &[bool], better: f64) -> Option<(f64, f64)> {
    let mut ahead = None;
    let weight = 1.0 / (1.0 + (-0.5 * better).exp());
    for (mode, std) in fit.modes.iter().zip(&mut fit.std) {
        let near = |i: &usize| (more.modes[*i].frequency - mode.frequency).abs();
        let Some(i) = (0..more.modes.len()).min_by(|a, b| near(a).total_cmp(&near(b))) else { continue };
        // An undetermined mode widens no uncertainty, but makes this one doubtful.
        if !sound[i] {
            ahead = ahead.or((better > NO_SUPPORT).then_some((better, mode.frequency)));
            continue;
        }
        let (other, its) = (&more.modes[i], more.std[i]);
        let turned = (other.constant / mode.constant).arg();
        let apart = [
            other.frequency - mode.frequency,
            other.zeta - mode.zeta,
            other.constant.norm() - mode.constant.norm(),
            turned,
        ];
        for ((std, its), apart) in std.iter_mut().zip(its).zip(apart) {
            *std = ((1.0 - weight) * *std * *std + weight * (its * its + apart * apart)).sqrt();
        }
    }
    ahead
}

/// Peaks that are fitted together, and the lines used for the fit.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct PeakGroup {
    pub peaks: Vec<Peak>,
    pub lines: Range<usize>,
    /// Drop of Akaike's criterion with one more mode, and the frequency in Hz, where that mode is not
    /// determined: the modes around it are then doubtful.
    pub ahead: Option<(f64, f64)>,
    /// As `ahead`, of a wider band that these lines were taken from.
    wider: Option<(f64, f64)>,
    /// Drop of Akaike's criterion with one more mode, where the residuals keep a pattern with it, too: all
    /// modes of the group are then doubtful.
    pub pattern: Option<f64>,
}

impl PeakGroup {
    /// Whether one of `modes` lies beyond the lines or is much lower than the highest: it does not belong to
    /// the group, and only widens the uncertainties.
    fn leaves_out(&self, lines: &Measured, modes: &[Pole]) -> bool {
        let height = |mode: &Pole| mode.constant.norm() / (mode.zeta.abs() * mode.frequency.powi(2));
        let highest = modes.iter().map(height).fold(0.0, f64::max);
        let part = lines.frequency[self.lines.start]..lines.frequency[self.lines.end - 1];
        modes.iter().any(|m| height(m) < LOW * highest || !part.contains(&m.frequency))
    }
}

impl Measured {
    /// The peak of a mode, whether it shows or not: the higher of the two lines beside it, and the
    /// bandwidth.
    fn peak(&self, mode: &Pole) -> Peak {
        let last = self.frequency.len() - 2;
        let above = self.frequency.partition_point(|f| *f < mode.frequency).clamp(1, last);
        let higher = self.values[above].norm() >= self.values[above - 1].norm();
        let at = if higher { above } else { (above - 1).max(1) };
        Peak { at, width: 2.0 * mode.zeta * mode.frequency, rise: 0.0 }
    }
}

/// Least ratio of a peak to the higher of its valleys: a smaller one lists ripples, a larger one misses
/// peaks beside others.
const PROMINENCE: f64 = 2.0;

/// Least rise of a peak above its higher valley, in standard deviations of the noise of one component of a
/// line: fewer than one of 3000 lines of noise passes.
const ABOVE_NOISE: f64 = 4.0;

/// Fewest lines, and fewest bandwidths, fitted on either side of a peak.
const LINES: usize = 16;
const BANDWIDTHS: f64 = 6.0;

/// Finds the peaks, only those of `band` in Hz where there is one. Peaks too close to be fitted alone share
/// a group; each group has the lines around it.
pub(super) fn groups(measured: &Measured, band: Option<(f64, f64)>) -> Result<Vec<PeakGroup>> {
    let f = &measured.frequency;
    let magnitude: Vec<f64> = measured.values.iter().map(|v| v.norm()).collect();
    let mut peaks: Vec<Peak> = local_maxima(&magnitude, PROMINENCE)
        .into_iter()
        .map(|m| Peak {
            at: m.at,
            width: width(f, &magnitude, m.at, m.valleys),
            rise: magnitude[m.at] - magnitude[m.valleys[0]].max(magnitude[m.valleys[1]]),
        })
        .filter(|p| p.rise > ABOVE_NOISE * noise(measured, p.at))
        .collect();
    let mut within = 0..f.len();
    if let Some((low, high)) = band {
        if !(low >= 0.0 && high > low && high.is_finite()) {
            return Err(Error::usage(format!("a band from {low} to {high} Hz"), "LO:HI in Hz, LO below HI")
                .setting("band"));
        }
        within = measured.within((low, high));
        peaks.retain(|p| within.contains(&p.at));
    }
    if peaks.is_empty() {
        let [first, last] = [f[0], f[f.len() - 1]].map(|f| shortest(format!("{f:.4e}").parse().unwrap_or(f)));
        let between = band.map_or_else(String::new, |(low, high)| format!(" between {low} and {high} Hz"));
        let why = format!(
            "no peak{between} stands a factor of {PROMINENCE} above its valleys and clear of the noise; the function runs from {first} to {last} Hz"
        );
        return Err(Error::refused(why).hint("choose a band around a peak").setting("band"));
    }
    let mut groups: Vec<Vec<Peak>> = Vec::new();
    for peak in peaks {
        match groups.last_mut() {
            Some(group) if group.last().is_some_and(|last| near(f, last, &peak)) => group.push(peak),
            _ => groups.push(vec![peak]),
        }
    }
    let reach = |p: &Peak| {
        let wide = BANDWIDTHS * p.width;
        let low = f.partition_point(|v| *v < f[p.at] - wide).min(p.at.saturating_sub(LINES));
        let high = f.partition_point(|v| *v <= f[p.at] + wide).max(p.at + LINES + 1).min(f.len());
        low..high
    };
    let spans: Vec<(usize, usize)> = groups.iter().map(|g| (g[0].at, g[g.len() - 1].at)).collect();
    let group = |(i, peaks): (usize, Vec<Peak>)| {
        let low = peaks.iter().map(|p| reach(p).start).min().unwrap_or(0);
        let high = peaks.iter().map(|p| reach(p).end).max().unwrap_or(f.len());
        // No further than half-way to the groups beside it.
        let below = i.checked_sub(1).map_or(0, |before| usize::midpoint(spans[before].1, spans[i].0));
        let above = spans.get(i + 1).map_or(f.len(), |after| usize::midpoint(after.0, spans[i].1) + 1);
        let lines = low.max(below).max(within.start)..high.min(above).min(within.end);
        PeakGroup { peaks, lines, ..PeakGroup::default() }
    };
    Ok(groups.into_iter().enumerate().map(group).collect())
}

/// Standard deviation of the noise of one component of the lines around `at`: as stated, else from the
/// median of their second differences, in which a smooth response vanishes. 0 where there are too few lines.
fn noise(measured: &Measured, at: usize) -> f64 {
    if let Some(std) = &measured.std {
        return std[at];
    }
    let around = at.saturating_sub(LINES)..(at + LINES + 1).min(measured.values.len());
    let differences = measured.values[around].windows(3).map(|v| (v[0] - 2.0 * v[1] + v[2]).norm());
    // A second difference of lines with noise σ has the variance 6σ² a component. The median of a Rayleigh
    // variable is √(2 ln 2) of its scale, that of the absolute value of a normal one 0.6745; magnitudes of
    // noise alone scatter by 0.655σ.
    let scale = if measured.magnitude_only { 0.6745 * 0.655 } else { (2.0 * f64::ln(2.0)).sqrt() };
    (median(differences) / (scale * f64::sqrt(6.0))).max(0.0)
}

/// Whether two peaks are too close to be fitted alone: their own lines would overlap by more than eight, or
/// by half of the bandwidths that each needs.
fn near(f: &[f64], a: &Peak, b: &Peak) -> bool {
    b.at - a.at < 2 * LINES - 8 || f[b.at] - f[a.at] < BANDWIDTHS * f64::midpoint(a.width, b.width)
}

/// Half-power bandwidth in Hz, interpolated between lines; at least half a line spacing.
fn width(f: &[f64], magnitude: &[f64], at: usize, valleys: [usize; 2]) -> f64 {
    let half = magnitude[at] / f64::sqrt(2.0);
    let cross = |a: usize, b: usize| {
        let share = (magnitude[a] - half) / (magnitude[a] - magnitude[b]);
        f[a] + share * (f[b] - f[a])
    };
    let left =
        (valleys[0]..at).rev().find(|i| magnitude[*i] < half).map_or(f[valleys[0]], |i| cross(i + 1, i));
    let right =
        (at + 1..=valleys[1]).find(|i| magnitude[*i] < half).map_or(f[valleys[1]], |i| cross(i - 1, i));
    (right - left).max((f[at + 1] - f[at - 1]) / 4.0)
}

#[cfg(test)]
mod bands {
    use super::*;
    use num_complex::Complex64;
    use vibro_math::Noise;
    use vibro_record::units::Quantity;

    /// Lines of noise with a standard deviation of 0.3 a component, and one line of height 3.
    fn measured(magnitude_only: bool) -> Measured {
        let mut noise = Noise::new(3);
        let mut values: Vec<Complex64> =
            (0..2000).map(|_| Complex64::new(0.3 * noise.normal(), 0.3 * noise.normal())).collect();
        values[1000] = Complex64::new(3.0, 0.0);
        if magnitude_only {
            for v in &mut values {
                *v = Complex64::new(v.norm(), 0.0);
            }
        }
        let frequency = (0..2000).map(f64::from).collect();
        Measured { magnitude_only, ..Measured::new(frequency, values, Quantity::Receptance) }
    }

    #[test]
    fn noise_has_few_peaks_and_what_stands_out_of_it_is_one() {
        let found = measured(false);
        // The median of 31 correlated values scatters by a fifth or so; their mean over many places is good
        // to a few per cent.
        let mean = (0..100).map(|k| noise(&found, 30 + 9 * k)).sum::<f64>() / 100.0;
        assert!((mean / 0.3 - 1.0).abs() < 0.1, "{mean}");
        let all = groups(&found, None).unwrap();
        let peaks: Vec<usize> = all.iter().flat_map(|g| g.peaks.iter().map(|p| p.at)).collect();
        // A third of 2000 lines are local maxima. Fewer than one line of noise in 3000 passes four
        // deviations; with a standard deviation that is too small by a quarter, one in 90 does.
        assert!(peaks.contains(&1000) && peaks.len() < 22, "{peaks:?}");
        let sizes = measured(true);
        assert!(groups(&sizes, None).unwrap().iter().any(|g| g.peaks.iter().any(|p| p.at == 1000)));
    }
}
