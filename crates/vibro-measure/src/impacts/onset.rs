//! Onset of each burst, to less than a sample: from its flank, or matched to the shape of all pulses.

use crate::mean::average;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use std::ops::Range;
use vibro_record::median;

/// One impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Onset {
    /// Time at which the rising flank passes half its height, in samples.
    pub time: f64,
    /// Standard uncertainty of the time from the noise, in samples; NaN where it is not known.
    pub std: f64,
    /// Height over the background, in the unit of the trace.
    pub height: f64,
}

/// A flank is sharp if the last sample below half height lies within this fraction of the height above the
/// background, and the next sample within this fraction below the top.
const SHARP: f64 = 0.1;
/// Fewest impacts whose average pulse is used.
const ENOUGH: usize = 8;
/// Number of pulses in a first test whether the pulses are like their average: the share of like pulses then
/// has a standard deviation of 3 %.
const TELLING: usize = 256;

/// First lobe of a burst, with the times and the height that its flanks give.
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
    /// One for each burst whose beginning the record shows.
    pub each: Vec<Onset>,
    /// How they were timed.
    pub method: &'static str,
    /// Whether most pulses rise within one sample: their times between samples are then unknown.
    pub sharp: bool,
}

/// Onsets of the bursts of `values`, whose background has the level 0 and the noise `sigma`. If the shape of
/// the pulses is known, each pulse is matched to it. Otherwise eight or more pulses of like shape are
/// matched to their average. Else each rising flank is interpolated at half its height.
pub fn onsets(values: &[f64], bursts: &[Range<usize>], sigma: f64, known: Option<&PulseShape>) -> Onsets {
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

/// Onsets by the average pulse; `None` where there are too few pulses, or most differ from their average.
fn by_average(values: &[f64], lobes: &[Lobe], whole: &[&Lobe], sigma: f64) -> Option<Vec<Onset>> {
    let widths: Vec<f64> = lobes.iter().map(|l| l.width).filter(|w| w.is_finite()).collect();
    if whole.len() < ENOUGH || widths.is_empty() {
        return None;
    }
    let width = median(&widths).max(1.0);
    let span = -2.0 * width.max(1.5)..1.5 * width.max(1.5);
    // If the record begins within an impact, its flank is assumed at the median distance before the peak.
    let rise = median(whole.iter().map(|l| l.peak as f64 - l.onset.time));
    let expected = |l: &Lobe| Onset { time: l.peak as f64 - rise, ..l.onset };
    let flanks: Vec<Onset> =
        lobes.iter().map(|l| if l.onset.time.is_finite() { l.onset } else { expected(l) }).collect();
    let near = |(m, flank): (&Option<Matched>, &Onset)| m.filter(|m| (m.time - flank.time).abs() < width);
    // Residual of a pulse over the limit for likeness, which is the larger of twice the noise and a tenth of
    // its height.
    let residual =
        |m: &Matched| (m.variance.sqrt() / (2.0 * sigma)).min(m.variance.sqrt() / (0.1 * m.height));
    let alike = |flanks: &[Onset]| {
        let matched = averaged(values, flanks, &span)?;
        let own: Vec<Option<Matched>> = matched.iter().zip(flanks).map(near).collect();
        let residuals = own.iter().map(|m| m.as_ref().map_or(f64::MAX, residual));
        (median(residuals) <= 1.0).then_some((matched, own))
    };
    // If the pulses of a subset differ from their average, do not match all pulses.
    if flanks.len() > TELLING {
        let few = (0..TELLING).map(|k| flanks[k * flanks.len() / TELLING]);
        alike(&few.collect::<Vec<Onset>>())?;
    }
    let (matched, own) = alike(&flanks)?;
    // Noise variance from the residuals of all pulses, without a few outliers.
    let mut left: Vec<f64> = matched.iter().flatten().map(|m| m.variance).collect();
    let most = OUTLYING * median(&left);
    left.retain(|v| *v <= most);
    let variance = average(&left);
    let onset = |(lobe, m): (&Lobe, Option<Matched>)| match m {
        Some(m) => Some(Onset { time: m.time, std: (m.cofactor * variance).sqrt(), height: m.height }),
        None => Some(lobe.onset).filter(|o| o.time.is_finite()),
    };
    Some(lobes.iter().zip(own).filter_map(onset).collect())
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
    // Noise of both neighbours and of the level, and the error of linear interpolation. That depends on
    // where the samples lie on a flank of p samples. For a half-sine the chord is off by (π/2p)² sin 30°/8
    // at a slope of 1.36/p, and the highest sample is too low by as much: together 0.05/p (RMS).
    let noise = sigma * (part.powi(2) + (1.0 - part).powi(2) + 0.25).sqrt() / slope;
    let std = noise.hypot(0.05 / (peak as f64 - time).max(0.5));
    let falls = (peak + 1..values.len()).find(under).map_or(f64::NAN, |above| {
        let slope = values[above - 1] - values[above];
        above as f64 - (level - values[above]) / slope
    });
    Some(Lobe { onset: Onset { time, std, height }, peak, width: falls - time, sharp })
}

/// Time and height of a matched pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Matched {
    /// Time of the shape's origin, in samples.
    pub time: f64,
    /// Factor on the shape.
    pub height: f64,
    /// Element of (JᵀJ)⁻¹ for the time: its variance in noise of unit variance.
    pub cofactor: f64,
    /// Mean squared residual.
    pub variance: f64,
}

/// Variance of the residuals of a pulse over the median of all, beyond which the pulse is left out of the
/// noise.
const OUTLYING: f64 = 4.0;

/// Most knots of an average pulse.
const KNOTS: usize = 48;
/// Most knots of a recorded pulse: enough for its features, and its spline is fitted within 0.1 s.
const RECORDED: usize = 400;
/// Most rounds of averaging and matching.
const ROUNDS: usize = 20;
/// Rounds end when no pulse moves by more than this, in samples.
const CONVERGED: f64 = 1e-3;

/// Pulses near `onsets`, each matched to their average shape over `span` in samples around them. Scale and
/// origin are those of the heights and of the median time of the onsets. `None` where the pulses determine no
/// average.
pub fn averaged(values: &[f64], onsets: &[Onset], span: &Range<f64>) -> Option<Vec<Option<Matched>>> {
    // Knots are no closer than samples. A shape with finer knots would follow errors of the times that
    // depend on their position between two samples.
    let knots = ((span.end - span.start).floor() as usize).clamp(4, KNOTS);
    let mut at: Vec<(f64, f64)> = onsets.iter().map(|o| (o.time, o.height)).collect();
    let mut matched = Vec::new();
    for _ in 0..ROUNDS {
        let points: Vec<(f64, f64)> = at
            .iter()
            .flat_map(|(t, h)| samples(values.len(), *t, span).map(move |i| (i as f64 - t, values[i] / h)))
            .collect();
        let shape = PulseShape::through(&points, span, knots)?;
        matched = at.iter().map(|(t, h)| shape.matched(values, *t, *h)).collect::<Vec<_>>();
        // The origin of the shape drifts with each round and is reset.
        let shifts = matched.iter().zip(onsets).filter_map(|(m, o)| Some(m.as_ref()?.time - o.time));
        let drift = median(shifts);
        let mut moved: f64 = 0.0;
        for (place, m) in at.iter_mut().zip(&mut matched) {
            if let Some(m) = m {
                m.time -= drift;
                moved = moved.max((m.time - place.0).abs());
                *place = (m.time, m.height);
            }
        }
        if moved < CONVERGED {
            break;
        }
    }
    Some(matched)
}

/// Samples of a record of `n` within `span` around a time, both in samples.
fn samples(n: usize, time: f64, span: &Range<f64>) -> Range<usize> {
    let first = (time + span.start).ceil().max(0.0) as usize;
    let end = ((time + span.end).floor() + 1.0).clamp(0.0, n as f64) as usize;
    first.min(end)..end
}

/// A pulse of unit height over time in samples: a uniform cubic B-spline (C. de Boor, *A Practical Guide to
/// Splines*, 1978, ch. IX).
#[derive(Debug, Clone, PartialEq)]
pub struct PulseShape {
    start: f64,
    step: f64,
    /// Coefficients of the cubic between each two knots, in rising powers of the part of the way.
    pieces: Vec<[f64; 4]>,
}

impl PulseShape {
    /// Least-squares spline through points (x, y) with `knots` intervals in `span`; a slight penalty on
    /// curvature bridges stretches without points. `None` where the points do not determine it.
    pub fn through(points: &[(f64, f64)], span: &Range<f64>, knots: usize) -> Option<PulseShape> {
        let (start, step, n) = (span.start, (span.end - span.start) / knots as f64, knots + 3);
        let (mut normal, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for (x, y) in points {
            let Some((first, weights)) = basis((x - start) / step, knots) else { continue };
            for (i, a) in weights.iter().enumerate() {
                right[first + i] += a * y;
                for (j, b) in weights.iter().enumerate() {
                    normal[(first + i, first + j)] += a * b;
                }
            }
        }
        let bend = DVector::from_vec(vec![1.0, -2.0, 1.0]);
        let penalty = &bend * bend.transpose() * (1e-6 * points.len() as f64 / n as f64);
        for first in 0..n - 2 {
            let mut part = normal.view_mut((first, first), (3, 3));
            part += &penalty;
        }
        let coefficients = normal.cholesky()?.solve(&right);
        // The sum of the four basis functions of an interval, as one polynomial.
        let piece = |c: &[f64]| {
            let (even, odd) = (c[0] + c[2], c[2] - c[0]);
            let cubic = c[3] - c[0] + 3.0 * (c[1] - c[2]);
            [(even + 4.0 * c[1]) / 6.0, 0.5 * odd, 0.5 * even - c[1], cubic / 6.0]
        };
        Some(PulseShape { start, step, pieces: coefficients.as_slice().windows(4).map(piece).collect() })
    }

    /// The shape of a recorded pulse whose samples lie `spacing` samples of the trace apart, scaled to unit
    /// height. Its first sample is its level; its origin is where the first flank passes half its height.
    /// `None` where there is no such flank.
    pub fn recorded(values: &[f64], spacing: f64) -> Option<PulseShape> {
        let level = *values.first()?;
        let higher =
            |highest: f64, v: &f64| if (v - level).abs() > highest.abs() { v - level } else { highest };
        let height = values.iter().fold(0.0, higher);
        let unit: Vec<f64> = values.iter().map(|v| (v - level) / height).collect();
        let above = unit.iter().position(|v| *v >= 0.5).filter(|_| unit.iter().all(|v| v.is_finite()))?;
        let origin = above as f64 - (unit[above] - 0.5) / (unit[above] - unit[above - 1]);
        let points: Vec<(f64, f64)> =
            unit.iter().enumerate().map(|(i, v)| ((i as f64 - origin) * spacing, *v)).collect();
        let span = points.first()?.0..points.last()?.0;
        PulseShape::through(&points, &span, (unit.len() - 1).clamp(4, RECORDED))
    }

    /// Value and slope at `x`. Beyond its ends the shape continues straight, since a break would keep a match
    /// from converging.
    pub fn at(&self, x: f64) -> (f64, f64) {
        let u = (x - self.start) / self.step;
        let inside = u.clamp(0.0, self.pieces.len() as f64);
        let piece = (inside as usize).min(self.pieces.len() - 1);
        let (x, [a, b, c, d]) = (inside - piece as f64, self.pieces[piece]);
        let slope = b + x * (2.0 * c + x * 3.0 * d);
        (a + x * (b + x * (c + x * d)) + slope * (u - inside), slope / self.step)
    }

    /// Time and height of the pulse near time `t` in samples, by Gauss-Newton on the samples that the shape
    /// covers.
    ///
    /// In white noise of variance σ² the time has the variance σ² × `cofactor`, which is the Cramér–Rao
    /// bound. `None` where fewer than three samples are covered or the steps do not converge.
    pub fn matched(&self, values: &[f64], t: f64, height: f64) -> Option<Matched> {
        let span = self.start..self.start + self.step * self.pieces.len() as f64;
        let (mut time, mut height) = (t, height);
        let window = samples(values.len(), t, &span);
        if window.len() < 3 {
            return None;
        }
        for _ in 0..50 {
            // Normal equations of (time, height): J = (−h s', s).
            let (mut slopes, mut both, mut squares) = (0.0, 0.0, 0.0);
            let (mut right, mut rr) = (Vector2::zeros(), 0.0);
            for i in window.clone() {
                let (s, slope) = self.at(i as f64 - time);
                let (j, r) = (-height * slope, values[i] - height * s);
                (slopes, both, squares) = (slopes + j * j, both + j * s, squares + s * s);
                right += Vector2::new(j * r, s * r);
                rr += r * r;
            }
            let normal = Matrix2::new(slopes, both, both, squares);
            let det = normal.determinant();
            if det <= 1e-12 * normal[(0, 0)] * normal[(1, 1)] || !det.is_finite() {
                return None;
            }
            let inverse = normal.try_inverse()?;
            let step = inverse * right;
            if step[0].abs() < 1e-7 {
                let variance = rr / (window.len() - 2) as f64;
                return Some(Matched { time, height, cofactor: inverse[(0, 0)], variance });
            }
            time += step[0].clamp(-0.5, 0.5);
            height = (height + step[1]).max(0.1 * height);
            if (time - t).abs() > span.end - span.start {
                return None;
            }
        }
        None
    }
}

/// First coefficient, and values of the four basis functions, at `u` knots from the start; `None` outside.
fn basis(u: f64, knots: usize) -> Option<(usize, [f64; 4])> {
    if !(0.0..=knots as f64).contains(&u) {
        return None;
    }
    let first = (u as usize).min(knots - 1);
    let x = u - first as f64;
    let y = 1.0 - x;
    let inner = |x: f64| (3.0 * x - 6.0) * x * x / 6.0 + 2.0 / 3.0;
    Some((first, [y * y * y / 6.0, inner(x), inner(y), x * x * x / 6.0]))
}

#[cfg(test)]
mod shapes {
    use super::*;

    fn gauss(x: f64) -> f64 {
        (-0.5 * (x / 1.2).powi(2)).exp()
    }

    #[test]
    fn a_clean_pulse_of_known_shape_is_found_where_it_is() {
        let points: Vec<(f64, f64)> =
            (0..=96).map(|i| -6.0 + 0.125 * f64::from(i)).map(|x| (x, gauss(x))).collect();
        let shape = PulseShape::through(&points, &(-6.0..6.0), 48).unwrap();
        let values: Vec<f64> = (0..40).map(|i| 0.7 * gauss(f64::from(i) - 17.37)).collect();
        let found = shape.matched(&values, 16.9, 1.0).unwrap();
        // Cubic splines err by (h⁴/384) |s⁗| = 0.25⁴/384 · 3/1.2⁴ = 1.5e-5 of the height; slopes are about
        // 0.5.
        assert!((found.time - 17.37).abs() < 3e-5, "{found:?}");
        assert!((found.height - 0.7).abs() < 3e-5, "{found:?}");
    }

    #[test]
    fn the_average_of_pulses_at_odd_times_gives_their_distances() {
        let times: Vec<f64> = (0..20).map(|k| 20.0 + 30.37 * f64::from(k)).collect();
        let values: Vec<f64> =
            (0..640).map(|i| times.iter().map(|t| gauss(f64::from(i) - t)).sum::<f64>()).collect();
        // Starting times are off by up to 0.3 samples, like those from coarsely sampled flanks.
        let rough: Vec<f64> =
            times.iter().enumerate().map(|(k, t)| t + 0.3 * (k as f64 * 2.4).sin()).collect();
        let onsets: Vec<Onset> = rough.iter().map(|t| Onset { time: *t, std: 0.0, height: 1.0 }).collect();
        let matched = averaged(&values, &onsets, &(-4.0..4.0)).unwrap();
        let off: Vec<f64> = matched.iter().zip(&times).map(|(m, t)| m.unwrap().time - t).collect();
        let mean = off.iter().sum::<f64>() / 20.0;
        // Rounds end at moves of 1e-3, and each halves the remaining error; a spline of knots a sample apart
        // errs by |s⁗|/384 = 3.8e-3 of the height, over slopes of 0.5, and pulses share most of that.
        assert!(off.iter().all(|o| (o - mean).abs() < 5e-3), "{off:?}");
    }
}
