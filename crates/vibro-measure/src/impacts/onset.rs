//! When each burst begins, below a sample.

use super::background::median;
use super::shape::{Matched, Shape, averaged};
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

/// A flank rises within one sample where both samples are within this part of the height of background and top.
const SHARP: f64 = 0.1;
/// Fewer impacts than this are not averaged.
const ENOUGH: usize = 8;

/// First lobe of a burst, as its flanks show it.
struct Lobe {
    /// Its time is NaN where the record cuts the rising flank.
    onset: Onset,
    /// Sample of its top.
    peak: usize,
    /// From half height to half height, in samples; NaN where the record ends before.
    width: f64,
    /// Whether no sample lies on the rising flank.
    sharp: bool,
}

/// Onsets of all bursts.
pub struct Onsets {
    /// One a burst that shows where it begins.
    pub each: Vec<Onset>,
    /// How they were timed.
    pub method: &'static str,
    /// Whether most pulses rise within one sample: nothing is known of their times between samples.
    pub sharp: bool,
}

/// Onsets of the bursts of `values`, whose background has the level 0 and the noise `sigma`: from eight like pulses on each is matched to their
/// average, or all to the shape that is known; otherwise each rising flank is interpolated at half its height.
pub fn onsets(values: &[f64], bursts: &[Range<usize>], sigma: f64, known: Option<&Shape>) -> Onsets {
    let lobes: Vec<Lobe> = bursts.iter().filter_map(|b| lobe(values, b, sigma)).collect();
    let whole: Vec<&Lobe> = lobes.iter().filter(|l| l.onset.time.is_finite()).collect();
    let sharp = 2 * whole.iter().filter(|l| l.sharp).count() > whole.len();
    if let Some(shape) = known {
        let matched = |lobe: &&Lobe| {
            let m = shape.matched(values, lobe.onset.time, lobe.onset.height)?;
            Some(Onset { time: m.time, std: (m.cofactor * m.variance).sqrt(), height: m.height })
        };
        let each = whole.iter().filter_map(matched).collect();
        return Onsets { each, method: "onsets by matching each pulse to the known shape", sharp };
    }
    let (each, method) = match by_average(values, &lobes, &whole, sigma) {
        Some(each) => (each, "onsets by matching each pulse to the average pulse"),
        None => (whole.iter().map(|l| l.onset).collect(), "onsets at half height of the rising flanks"),
    };
    Onsets { each, method, sharp }
}

/// By the average pulse; `None` where there are too few pulses, or most differ from their average.
fn by_average(values: &[f64], lobes: &[Lobe], whole: &[&Lobe], sigma: f64) -> Option<Vec<Onset>> {
    let widths: Vec<f64> = lobes.iter().map(|l| l.width).filter(|w| w.is_finite()).collect();
    if whole.len() < ENOUGH || widths.is_empty() {
        return None;
    }
    let width = median(&widths).max(1.0);
    let span = -2.0 * width.max(1.5)..1.5 * width.max(1.5);
    // A flank before the record is expected where the others have theirs: a record may begin within an impact.
    let rise = median(&whole.iter().map(|l| l.peak as f64 - l.onset.time).collect::<Vec<f64>>());
    let expected = |l: &Lobe| Onset { time: l.peak as f64 - rise, ..l.onset };
    let flanks: Vec<Onset> =
        lobes.iter().map(|l| if l.onset.time.is_finite() { l.onset } else { expected(l) }).collect();
    let matched = averaged(values, &flanks, &span)?;
    // A pulse is alike where its residual is noise, or little beside its height.
    let residual =
        |m: &Matched| (m.variance.sqrt() / (2.0 * sigma)).min(m.variance.sqrt() / (0.1 * m.height));
    let near = |m: &Option<Matched>, flank: &Onset| m.filter(|m| (m.time - flank.time).abs() < width);
    let pairs: Vec<(Onset, Option<Matched>)> =
        flanks.iter().zip(&matched).map(|(flank, m)| (*flank, near(m, flank))).collect();
    let residuals: Vec<f64> = pairs.iter().map(|(_, m)| m.as_ref().map_or(f64::INFINITY, residual)).collect();
    if median(&residuals) > 1.0 {
        return None;
    }
    // The noise from the residuals of all pulses, but for a few outliers.
    let mut left: Vec<f64> = matched.iter().flatten().map(|m| m.variance).collect();
    let most = 4.0 * median(&left);
    left.retain(|v| *v <= most);
    let variance = left.iter().sum::<f64>() / left.len() as f64;
    let onset = |(lobe, (_, m)): (&Lobe, (Onset, Option<Matched>))| match m {
        Some(m) => Some(Onset { time: m.time, std: (m.cofactor * variance).sqrt(), height: m.height }),
        None => Some(lobe.onset).filter(|o| o.time.is_finite()),
    };
    Some(lobes.iter().zip(pairs).filter_map(onset).collect())
}

/// First lobe of a burst, up to the first maximum that reaches half of the largest value.
fn lobe(values: &[f64], burst: &Range<usize>, sigma: f64) -> Option<Lobe> {
    let largest = values.get(burst.clone())?.iter().copied().fold(0.0, f64::max);
    let mut peak = burst.clone().find(|i| values[*i] >= 0.5 * largest)?;
    while peak + 1 < burst.end && values[peak + 1] > values[peak] {
        peak += 1;
    }
    let height = values[peak];
    let level = 0.5 * height;
    let under = |i: &usize| values[*i] < level;
    let cut = Onset { time: f64::NAN, std: f64::NAN, height };
    let Some(below) = (0..peak).rev().find(under).filter(|_| peak + 1 < values.len()) else {
        return Some(Lobe { onset: cut, peak, width: f64::NAN, sharp: false });
    };
    let slope = values[below + 1] - values[below];
    let part = (level - values[below]) / slope;
    let time = below as f64 + part;
    let near = SHARP * height;
    let sharp = values[below] < near && values[below + 1] > height - near;
    // Noise of both neighbours and of the level; and what the place of the samples on a flank of p samples does: for half a
    // sine the chord is off by (π/2p)² sin 30°/8 over a slope of 1.36/p, the highest sample by as much: 0.05/p, root mean square.
    let noise = sigma * (part.powi(2) + (1.0 - part).powi(2) + 0.25).sqrt() / slope;
    let std = noise.hypot(0.05 / (peak as f64 - time).max(0.5));
    let falls = (peak + 1..values.len()).find(under).map_or(f64::NAN, |above| {
        let slope = values[above - 1] - values[above];
        above as f64 - (level - values[above]) / slope
    });
    Some(Lobe { onset: Onset { time, std, height }, peak, width: falls - time, sharp })
}
