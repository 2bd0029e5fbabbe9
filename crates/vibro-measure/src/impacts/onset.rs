//! When each burst begins, below a sample.

use super::background::median;
use super::shape::{Matched, Shape};
use std::ops::Range;

/// One impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Onset {
    /// Time at which the rising flank passes half its height, in samples.
    pub time: f64,
    /// Its standard uncertainty from the noise, in samples; NaN where it is not known.
    pub std: f64,
    /// Height over the background.
    pub height: f64,
}

/// How onsets were timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Timing {
    /// Each rising flank interpolated at half its height.
    Flank,
    /// Each pulse matched to the average pulse of the record.
    Average,
    /// Each pulse matched to a known shape.
    Known,
}

/// A flank rises within one sample where both samples are within this part of the height of background and top.
const SHARP: f64 = 0.1;

/// Fewer impacts than this are not averaged.
const ENOUGH: usize = 8;

/// A burst as its flanks show it, in samples.
struct Lobe {
    onset: f64,
    std: f64,
    height: f64,
    width: f64,
    peak: usize,
    /// Whether no sample lies on the flank.
    sharp: bool,
}

impl Lobe {
    /// The onset by the flank; `None` where that lies before the record.
    fn flank(&self) -> Option<Onset> {
        self.onset.is_finite().then_some(Onset { time: self.onset, std: self.std, height: self.height })
    }
}

/// Onsets of all bursts.
pub struct Onsets {
    /// One a burst; `None` where no rising flank shows it.
    pub each: Vec<Option<Onset>>,
    /// How they were timed.
    pub timing: Timing,
    /// Whether most pulses rise within one sample: nothing is known of their times between samples.
    pub sharp: bool,
}

/// Onsets of the bursts of `values`, whose background has the level 0 and the noise `sigma`, by the best method that the record allows.
pub fn onsets(values: &[f64], bursts: &[Range<usize>], sigma: f64, known: Option<&Shape>) -> Onsets {
    let lobes: Vec<Lobe> = bursts.iter().filter_map(|b| lobe(values, b, sigma)).collect();
    let whole: Vec<&Lobe> = lobes.iter().filter(|l| l.onset.is_finite()).collect();
    let sharp = 2 * lobes.iter().filter(|l| l.sharp).count() > whole.len();
    let (each, timing) = if let Some(shape) = known {
        (by_shape(values, &lobes, sigma, shape), Timing::Known)
    } else if let Some(onsets) = by_average(values, &lobes, &whole, sigma) {
        (onsets, Timing::Average)
    } else {
        (lobes.iter().map(Lobe::flank).collect(), Timing::Flank)
    };
    Onsets { each, timing, sharp }
}

fn by_shape(values: &[f64], lobes: &[Lobe], sigma: f64, shape: &Shape) -> Vec<Option<Onset>> {
    let start = |l: &Lobe| if l.onset.is_finite() { l.onset } else { l.peak as f64 - 1.0 };
    let matched: Vec<Option<Matched>> =
        lobes.iter().map(|l| shape.matched(values, start(l), l.height)).collect();
    matched.iter().map(|m| Some(timed((*m)?, &matched, sigma))).collect()
}

/// By the average pulse; `None` where there are too few pulses, or most differ from their average.
fn by_average(values: &[f64], lobes: &[Lobe], whole: &[&Lobe], sigma: f64) -> Option<Vec<Option<Onset>>> {
    let widths: Vec<f64> = lobes.iter().map(|l| l.width).filter(|w| w.is_finite()).collect();
    if whole.len() < ENOUGH || widths.is_empty() {
        return None;
    }
    let width = median(&widths).max(1.0);
    let span = -2.0 * width.max(1.5)..1.5 * width.max(1.5);
    // A flank before the record is expected where the others have theirs.
    let rise = median(&whole.iter().map(|l| l.peak as f64 - l.onset).collect::<Vec<f64>>());
    let times: Vec<f64> =
        lobes.iter().map(|l| if l.onset.is_finite() { l.onset } else { l.peak as f64 - rise }).collect();
    let heights: Vec<f64> = lobes.iter().map(|l| l.height).collect();
    let matched = Shape::averaged(values, &times, &heights, &span)?;
    // A pulse is alike where its residual is noise, or little beside its height.
    let residual =
        |m: &Matched| (m.variance.sqrt() / (2.0 * sigma)).min(m.variance.sqrt() / (0.1 * m.height));
    let residuals: Vec<f64> = matched
        .iter()
        .zip(&times)
        .map(|(m, t)| m.filter(|m| (m.time - t).abs() < width).map_or(f64::INFINITY, |m| residual(&m)))
        .collect();
    if median(&residuals) > 1.0 {
        return None;
    }
    let all = matched.iter().zip(residuals).zip(lobes.iter().zip(&times));
    let onsets = all.map(|((m, residual), (lobe, t))| match m {
        Some(m) if residual.is_finite() => Some(timed(*m, &matched, sigma)),
        // A cut pulse without a match stands where its highest sample says, half a sample more or less; where the record begins with
        // that sample it may be the ringing of an impact before.
        _ => lobe
            .flank()
            .or_else(|| (lobe.peak > 0).then_some(Onset { time: *t, std: 0.5, height: lobe.height })),
    });
    Some(onsets.collect())
}

/// An onset with the uncertainty that follows from the residuals of all pulses, but for a few outliers.
fn timed(m: Matched, all: &[Option<Matched>], sigma: f64) -> Onset {
    let mut left: Vec<f64> = all.iter().flatten().map(|m| m.variance).collect();
    let most = 4.0 * median(&left);
    left.retain(|v| *v <= most);
    let left = if left.is_empty() { sigma * sigma } else { left.iter().sum::<f64>() / left.len() as f64 };
    Onset { time: m.time, std: (m.cofactor * left).sqrt(), height: m.height }
}

/// First lobe of a burst: the first maximum that reaches half of the largest value.
fn lobe(values: &[f64], burst: &Range<usize>, sigma: f64) -> Option<Lobe> {
    let height = values.get(burst.clone())?.iter().copied().fold(0.0, f64::max);
    let mut peak = burst.clone().find(|i| values[*i] >= 0.5 * height)?;
    while peak + 1 < burst.end && values[peak + 1] > values[peak] {
        peak += 1;
    }
    let height = values[peak];
    let level = 0.5 * height;
    let under = |i: &usize| values[*i] < level;
    let (mut onset, mut std, mut sharp) = (f64::NAN, f64::NAN, false);
    let whole = peak + 1 < values.len();
    if let Some(below) = (0..peak).rev().find(under).filter(|_| whole) {
        let slope = values[below + 1] - values[below];
        let part = (level - values[below]) / slope;
        onset = below as f64 + part;
        let near = SHARP * height;
        sharp = values[below] < near && values[below + 1] > height - near;
        // Noise of both neighbours and of the level; and what the place of the samples on a flank of p samples does: for half a
        // sine the chord is off by (π/2p)² sin 30°/8 over a slope of 1.36/p, the highest sample by as much: 0.05/p, root mean square.
        let noise = sigma * (part.powi(2) + (1.0 - part).powi(2) + 0.25).sqrt() / slope;
        std = noise.hypot(0.05 / (peak as f64 - onset).max(0.5));
    }
    let falls = (peak + 1..values.len()).find(under).map_or(f64::NAN, |above| {
        let slope = values[above - 1] - values[above];
        above as f64 - (level - values[above]) / slope
    });
    Some(Lobe { onset, std, height, width: falls - onset, peak, sharp })
}
