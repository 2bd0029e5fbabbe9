//! The shape of a pulse, known or averaged from a record, and the time of a pulse matched to it.

use super::background::median;
use super::spline::Spline;
use std::ops::Range;
use vibro_record::{Error, Result, Trace};

/// A pulse of unit height as a cubic spline over time in samples.
///
/// ```
/// use vibro_measure::impacts::Shape;
/// let shape = Shape::known(|x| (-0.5 * x * x).exp(), -4.0..4.0, 0.1).unwrap();
/// assert!((shape.at(0.5) - (-0.125f64).exp()).abs() < 1e-5);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Shape(Spline);

/// Time and height of a matched pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Matched {
    /// Time of the shape's origin, in samples.
    pub time: f64,
    /// Factor on the shape.
    pub height: f64,
    /// Element of (JᵀJ)⁻¹ for the time: its variance in noise of unit variance.
    pub cofactor: f64,
    /// Mean squared residual.
    pub variance: f64,
}

/// A pulse that swings both ways is inverted where it is deeper than high by this factor.
pub(super) const INVERTED: f64 = 1.2;
/// Samples of a recorded pulse: four knots need five, and more than the most are no single pulse.
const SAMPLES: std::ops::RangeInclusive<usize> = 5..=10_000;
/// Most knots of an average pulse.
const KNOTS: usize = 48;
/// Most rounds of averaging and matching.
const ROUNDS: usize = 20;
/// Rounds end where no pulse moves further, in samples.
const CONVERGED: f64 = 1e-3;

impl Shape {
    /// The spline of a pulse given by a formula, over `span` in samples, with a knot every `step` samples.
    ///
    /// `None` where the span holds fewer than four knots or more than ten thousand.
    pub fn known(pulse: impl Fn(f64) -> f64, span: Range<f64>, step: f64) -> Option<Shape> {
        let knots = ((span.end - span.start) / step).ceil() as usize;
        if !(4..=10_000).contains(&knots) {
            return None;
        }
        let points: Vec<(f64, f64)> =
            (0..=2 * knots).map(|i| span.start + 0.5 * step * i as f64).map(|x| (x, pulse(x))).collect();
        Spline::through(&points, span.start, step, knots).map(Shape)
    }

    /// The shape of a recorded pulse, for matching in `trace`.
    ///
    /// Its level before the pulse is subtracted, it is inverted where it is clearly deeper than high, as a trace is, and scaled
    /// to unit height. Its origin is where the first flank passes half of that, as for impacts of unknown shape.
    ///
    /// # Errors
    /// If either has no sampling rate, or the pulse has fewer than 5 or more than 10 000 samples, missing values, or equal ones.
    pub fn of(pulse: &Trace, trace: &Trace) -> Result<Shape> {
        let rate = super::rate_of(trace)?;
        let own = pulse.rate().filter(|r| r.is_finite() && *r > 0.0).ok_or_else(|| {
            Error::refused(format!("the sampling rate of the shape {:?} is not known", pulse.meta.name))
                .hint("state the sampling rate of the shape in Hz")
                .setting("shape_rate")
        })?;
        Shape::recorded(&pulse.values, rate / own).ok_or_else(|| {
            Error::refused(format!(
                "{:?} is no shape of a pulse: {} samples, missing or equal values",
                pulse.meta.name,
                pulse.values.len()
            ))
            .hint(format!(
                "cut the record to one pulse of {} to {} samples",
                SAMPLES.start(),
                SAMPLES.end()
            ))
        })
    }

    /// As [`Shape::of`], of samples that are `spacing` samples of the trace apart.
    fn recorded(values: &[f64], spacing: f64) -> Option<Shape> {
        let n = values.len();
        let sampled = SAMPLES.contains(&n) && spacing.is_finite() && spacing > 0.0;
        if !sampled || values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let (level, noise) = before(values);
        let extreme = |sign: f64| values.iter().map(|v| sign * (v - level)).fold(0.0, f64::max);
        let (high, deep) = (extreme(1.0), extreme(-1.0));
        let height = if deep > INVERTED * high { -deep } else { high };
        if height == 0.0 || values.iter().all(|v| *v == values[0]) {
            return None;
        }
        let unit: Vec<f64> = values.iter().map(|v| (v - level) / height).collect();
        let above = unit.iter().position(|v| *v >= 0.5)?;
        let origin = match above.checked_sub(1) {
            Some(before) => above as f64 - (unit[above] - 0.5) / (unit[above] - unit[before]),
            None => 0.0,
        };
        let at = |i: usize| (i as f64 - origin) * spacing;
        let points: Vec<(f64, f64)> = unit.iter().enumerate().map(|(i, v)| (at(i), *v)).collect();
        let smooth = noise.and_then(|noise| smooth(&points, (noise / height).powi(2)));
        smooth.or_else(|| Spline::through(&points, at(0), spacing, n - 1)).map(Shape)
    }

    /// Value at time `x` in samples from the origin.
    pub fn at(&self, x: f64) -> f64 {
        self.0.at(x).0
    }

    /// Pulses near `times` in samples, each matched to their average shape over `span` around them. Scale and origin are those of the
    /// `heights` and of the median of `times`. `None` where no average follows.
    pub(super) fn averaged(
        values: &[f64],
        times: &[f64],
        heights: &[f64],
        span: &Range<f64>,
    ) -> Option<Vec<Option<Matched>>> {
        let mut at: Vec<(f64, f64)> = times.iter().copied().zip(heights.iter().copied()).collect();
        let mut matched = Vec::new();
        for _ in 0..ROUNDS {
            let mut points = Vec::new();
            for (t, h) in at.iter().filter(|(t, h)| t.is_finite() && *h > 0.0) {
                let window = samples(values.len(), t + span.start, t + span.end);
                points.extend(window.map(|i| (i as f64 - t, values[i] / h)));
            }
            let shape = average(&points, span)?;
            matched = at.iter().map(|(t, h)| shape.matched(values, *t, *h)).collect::<Vec<_>>();
            // The origin of the shape drifts with each round and is reset.
            let shifts = matched.iter().zip(times).filter_map(|(m, t)| Some(m.as_ref()?.time - t));
            let drift = median(&shifts.filter(|s| s.is_finite()).collect::<Vec<f64>>());
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

    /// Time and height of the pulse near time `t` in samples, by Gauss-Newton on the samples that the shape covers.
    ///
    /// In white noise of variance σ² the time has the variance σ² × `cofactor`, which is the Cramér–Rao bound. `None` where fewer than
    /// three samples are covered or the steps do not converge.
    pub(super) fn matched(&self, values: &[f64], t: f64, height: f64) -> Option<Matched> {
        let span = self.0.span();
        let (mut time, mut height) = (t, height);
        let window = samples(values.len(), t + span.start, t + span.end);
        if window.len() < 3 {
            return None;
        }
        for _ in 0..50 {
            // Normal equations of (time, height): J = (−h s', s).
            let (mut tt, mut th, mut hh, mut tr, mut hr, mut rr) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
            for i in window.clone() {
                let (s, slope) = self.0.at(i as f64 - time);
                let (jt, r) = (-height * slope, values[i] - height * s);
                tt += jt * jt;
                th += jt * s;
                hh += s * s;
                tr += jt * r;
                hr += s * r;
                rr += r * r;
            }
            let det = tt * hh - th * th;
            if det <= 1e-12 * tt * hh || !det.is_finite() {
                return None;
            }
            let step = (hh * tr - th * hr) / det;
            if step.abs() < 1e-7 {
                let variance = rr / (window.len() - 2) as f64;
                return Some(Matched { time, height, cofactor: hh / det, variance });
            }
            time += step.clamp(-0.5, 0.5);
            height = (height + (tt * hr - th * tr) / det).max(0.1 * height);
            if (time - t).abs() > span.end - span.start {
                return None;
            }
        }
        None
    }
}

/// The spline of the fewest knots, by steps of √2, whose residuals have no more than this variance: noise of a record is no shape
/// (V. A. Morozov, Soviet Math. Dokl. 7 (1966) 414). `None` where only one through all points does.
fn smooth(points: &[(f64, f64)], variance: f64) -> Option<Spline> {
    let n = points.len();
    let (start, end) = (points.first()?.0, points.last()?.0);
    let mut knots = 4.0;
    while knots <= (n / 2) as f64 {
        let whole = knots as usize;
        let spline = Spline::through(points, start, (end - start) / knots.floor(), whole)?;
        let left: f64 = points.iter().map(|(x, y)| (y - spline.at(*x).0).powi(2)).sum();
        // A variance of n values scatters by √(2/n).
        let free = n.saturating_sub(whole + 3) as f64;
        if left <= variance * free * (1.0 + (2.0 / free).sqrt()) {
            return Some(spline);
        }
        knots *= std::f64::consts::SQRT_2;
    }
    None
}

/// The spline nearest to the points of all pulses over `span`, with knots no closer than samples: a shape that may bend from sample
/// to sample follows any error of the times that depends on their fraction of a sample.
fn average(points: &[(f64, f64)], span: &Range<f64>) -> Option<Shape> {
    let length = span.end - span.start;
    // Whole knots fill the span: none reaches beyond the points.
    let knots = (length.floor() as usize).clamp(4, KNOTS);
    Spline::through(points, span.start, length / knots as f64, knots).map(Shape)
}

/// Level of a recorded pulse before its first flank, and the standard deviation of the noise there where eight samples or more show it.
///
/// What precedes the flank stays within a tenth of the range from the first value; its first half is used, where no flank begins
/// yet. A record that does not come back at least half-way begins inside its pulse: its level is 0.
fn before(values: &[f64]) -> (f64, Option<f64>) {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let (Some(first), Some(last)) = (values.first(), values.last()) else { return (0.0, None) };
    let quiet = values.iter().take_while(|v| (*v - first).abs() <= 0.1 * (high - low)).count();
    let rest =
        values.get(..quiet / 2).filter(|r| !r.is_empty() && (last - first).abs() <= 0.5 * (high - low));
    let Some(rest) = rest else { return (0.0, None) };
    let level = rest.iter().sum::<f64>() / rest.len() as f64;
    // From differences of neighbours, which know nothing of a slow rise.
    let squares: f64 = rest.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
    let noise = (rest.len() >= 8).then(|| (squares / 2.0 / (rest.len() - 1) as f64).sqrt());
    (level, noise)
}

/// Samples between two times.
fn samples(n: usize, from: f64, to: f64) -> Range<usize> {
    let first = from.ceil().max(0.0) as usize;
    let end = (to.floor() + 1.0).clamp(0.0, n as f64) as usize;
    first.min(end)..end
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gauss(x: f64) -> f64 {
        (-0.5 * (x / 1.2).powi(2)).exp()
    }

    #[test]
    fn a_clean_pulse_of_known_shape_is_found_where_it_is() {
        let shape = Shape::known(gauss, -6.0..6.0, 0.25).unwrap();
        let values: Vec<f64> = (0..40).map(|i| 0.7 * gauss(f64::from(i) - 17.37)).collect();
        let found = shape.matched(&values, 16.9, 1.0).unwrap();
        // Cubic splines err by (h⁴/384) |s⁗| = 0.25⁴/384 · 3/1.2⁴ = 1.5e-5 of the height; slopes are about 0.5.
        assert!((found.time - 17.37).abs() < 3e-5, "{found:?}");
        assert!((found.height - 0.7).abs() < 3e-5, "{found:?}");
    }

    #[test]
    fn level_sign_and_noise_of_a_recorded_pulse_are_no_shape() {
        let mut noise = vibro_math::Noise::new(0x5a9e);
        // A pulse and a shallower swing after it; five samples of the record to one of the trace.
        let swing = |x: f64| gauss(x) - 0.9 * gauss(x - 4.0);
        let plain: Vec<f64> = (0..150).map(|i| swing((f64::from(i) - 75.0) / 5.0)).collect();
        let times = |shape: &Shape| -> Vec<f64> {
            (0..20)
                .map(|k| {
                    let at = 20.0 + 0.05 * f64::from(k);
                    let values: Vec<f64> = (0..50).map(|i| swing(f64::from(i) - at)).collect();
                    shape.matched(&values, at - 1.4, 1.0).unwrap().time - at
                })
                .collect()
        };
        let spread = |t: &[f64]| {
            let mean = t.iter().sum::<f64>() / t.len() as f64;
            (t.iter().map(|t| (t - mean).powi(2)).sum::<f64>() / t.len() as f64).sqrt()
        };
        let clean = times(&Shape::recorded(&plain, 0.2).unwrap());
        // Gain, level and sign change nothing: the swing is 0.9 of the height, and turned around 1.11, less than 1.2.
        for (gain, level) in [(3.0, 0.3), (-1.0, 5.0)] {
            let moved: Vec<f64> = plain.iter().map(|v| gain * v + level).collect();
            let shape = Shape::recorded(&moved, 0.2).unwrap();
            if gain > 0.0 {
                let off = times(&shape);
                assert!(off.iter().zip(&clean).all(|(a, b)| (a - b).abs() < 1e-3), "{off:?} {clean:?}");
            } else {
                // The first swing is now down, and deeper by 1.11: the pulse stays, and the flank to its second swing, whose top lies
                // 1.41 samples behind half its height, is the first that rises.
                assert!((shape.at(1.41) - 1.0).abs() < 0.05 && shape.at(-2.59) < -1.0);
            }
        }
        let noisy: Vec<f64> = plain.iter().map(|v| v + 0.05 * noise.normal() + 0.1).collect();
        let off = times(&Shape::recorded(&noisy, 0.2).unwrap());
        // Common to all is that the noise moves half the height; what differs is a matching through noise of 0.05/√5 a sample of
        // the trace over Σ(slope)² of 1.5: 0.018 samples.
        assert!(spread(&off) < 0.018, "{off:?}");
    }

    #[test]
    fn the_average_of_pulses_at_odd_times_gives_their_distances() {
        let times: Vec<f64> = (0..20).map(|k| 20.0 + 30.37 * f64::from(k)).collect();
        let values: Vec<f64> =
            (0..640).map(|i| times.iter().map(|t| gauss(f64::from(i) - t)).sum::<f64>()).collect();
        // Starts that are off by up to 0.3 samples, as flanks of coarse samples are.
        let rough: Vec<f64> =
            times.iter().enumerate().map(|(k, t)| t + 0.3 * (k as f64 * 2.4).sin()).collect();
        let matched = Shape::averaged(&values, &rough, &[1.0; 20], &(-4.0..4.0)).unwrap();
        let off: Vec<f64> = matched.iter().zip(&times).map(|(m, t)| m.unwrap().time - t).collect();
        let mean = off.iter().sum::<f64>() / 20.0;
        // Rounds end at moves of 1e-3 and each takes off about half of what is left; a spline of
        // knots a sample apart errs by |s⁗|/384 = 3.8e-3 of the height, over slopes of 0.5, and pulses share most of that.
        assert!(off.iter().all(|o| (o - mean).abs() < 5e-3), "{off:?}");
    }
}
