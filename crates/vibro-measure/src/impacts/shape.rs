//! The shape of a pulse, known or averaged from a record, and the time of a pulse matched to it.

use super::burst::median;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;
use vibro_record::{Error, Result, Trace};

/// A pulse of unit height as a cubic spline over time in samples.
///
/// ```
/// use vibro_measure::impacts::Shape;
/// let shape = Shape::known(|x| (-0.5 * x * x).exp(), -4.0..4.0, 0.1).unwrap();
/// assert!((shape.at(0.5).0 - (-0.125f64).exp()).abs() < 1e-5);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    start: f64,
    step: f64,
    coefficients: Vec<f64>,
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

/// Pulses that swing both ways begin upwards unless they are deeper than high by this factor.
pub(super) const TURNED: f64 = 1.2;
/// Most knots of a spline.
const KNOTS: usize = 48;
/// Most rounds of averaging and matching.
const ROUNDS: usize = 20;
/// Rounds end where no pulse moves further, in samples.
const SETTLED: f64 = 1e-3;

impl Shape {
    /// The spline of a pulse that is known, over `span` in samples, with a knot every `step` samples.
    ///
    /// `None` where the span holds fewer than four knots or more than ten thousand.
    pub fn known(pulse: impl Fn(f64) -> f64, span: Range<f64>, step: f64) -> Option<Shape> {
        let knots = ((span.end - span.start) / step).ceil() as usize;
        if !(4..=10_000).contains(&knots) {
            return None;
        }
        let points: Vec<(f64, f64)> =
            (0..=2 * knots).map(|i| span.start + 0.5 * step * i as f64).map(|x| (x, pulse(x))).collect();
        Shape::through(&points, span.start, step, knots)
    }

    /// The spline of a recorded pulse, for matching in `trace`.
    ///
    /// # Errors
    /// If either has no sampling rate, or the pulse is too short, too long (10 000 samples), constant, or has gaps.
    pub fn of(pulse: &Trace, trace: &Trace) -> Result<Shape> {
        let rate = super::rate_of(trace)?;
        let own = pulse.rate().filter(|r| r.is_finite() && *r > 0.0).ok_or_else(|| {
            Error::refused(format!("the file of the shape {:?} does not say at which rate", pulse.meta.name))
                .hint("state the rate of the shape: --shape-rate HZ, or shape_rate in a campaign")
        })?;
        Shape::recorded(&pulse.values, rate / own).ok_or_else(|| {
            Error::refused(format!(
                "{:?} is no shape of a pulse: {} samples, missing or equal values",
                pulse.meta.name,
                pulse.values.len()
            ))
            .hint("cut a record to one pulse, 5 to 10000 samples without gaps")
        })
    }

    /// The spline of a recorded pulse whose samples are `spacing` samples of the trace apart. Its level before the pulse is taken off, it is
    /// turned around where it is clearly deeper than high, as a trace is, and scaled to unit height; its origin is where the first flank
    /// passes half of that, as with impacts of which no shape is known.
    ///
    /// Noise of the record is no shape: the spline has the fewest knots that leave no more than the noise before the pulse (V. A. Morozov,
    /// Soviet Math. Dokl. 7 (1966) 414).
    ///
    /// `None` where it has fewer than five samples or more than ten thousand, missing or equal ones.
    pub fn recorded(values: &[f64], spacing: f64) -> Option<Shape> {
        let n = values.len();
        let sampled = (5..=10_000).contains(&n) && spacing.is_finite() && spacing > 0.0;
        if !sampled || values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let (level, noise) = before(values);
        let extreme = |sign: f64| values.iter().map(|v| sign * (v - level)).fold(0.0, f64::max);
        let (high, deep) = (extreme(1.0), extreme(-1.0));
        let height = if deep > TURNED * high { -deep } else { high };
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
        let smooth = noise.and_then(|noise| Shape::smooth(&points, (noise / height).powi(2)));
        smooth.or_else(|| Shape::through(&points, at(0), spacing, n - 1))
    }

    /// The spline of the fewest knots, by steps of √2, whose residuals have no more than this variance; `None` where only one through
    /// all points does.
    fn smooth(points: &[(f64, f64)], variance: f64) -> Option<Shape> {
        let n = points.len();
        let (start, end) = (points.first()?.0, points.last()?.0);
        let mut knots = 4.0;
        while knots <= (n / 2) as f64 {
            let whole = knots as usize;
            let shape = Shape::through(points, start, (end - start) / knots.floor(), whole)?;
            let left: f64 = points.iter().map(|(x, y)| (y - shape.at(*x).0).powi(2)).sum();
            // A variance of n values scatters by √(2/n).
            let free = n.saturating_sub(whole + 3) as f64;
            if left <= variance * free * (1.0 + (2.0 / free).sqrt()) {
                return Some(shape);
            }
            knots *= std::f64::consts::SQRT_2;
        }
        None
    }

    /// The spline nearest to points (time in samples, value) over `span`, with knots no closer than samples: a shape that may bend from
    /// sample to sample follows any error of the times that depends on their fraction of a sample alone.
    fn fitted(points: &[(f64, f64)], span: &Range<f64>) -> Option<Shape> {
        let length = span.end - span.start;
        // Whole knots fill the span: none reaches beyond the points.
        let knots = (length.floor() as usize).clamp(4, KNOTS);
        let step = length / knots as f64;
        Shape::through(points, span.start, step, knots)
    }

    /// Least squares with a slight penalty on curvature, which decides where there are no points.
    fn through(points: &[(f64, f64)], start: f64, step: f64, knots: usize) -> Option<Shape> {
        let n = knots + 3;
        let mut normal = DMatrix::<f64>::zeros(n, n);
        let mut right = DVector::<f64>::zeros(n);
        for (x, y) in points {
            let Some((first, weights)) = basis((x - start) / step, knots) else { continue };
            for (i, a) in weights.iter().enumerate() {
                right[first + i] += a.0 * y;
                for (j, b) in weights.iter().enumerate() {
                    normal[(first + i, first + j)] += a.0 * b.0;
                }
            }
        }
        let penalty = 1e-6 * points.len() as f64 / n as f64;
        for i in 2..n {
            for (j, a) in [(i - 2, 1.0), (i - 1, -2.0), (i, 1.0)] {
                for (k, b) in [(i - 2, 1.0), (i - 1, -2.0), (i, 1.0)] {
                    normal[(j, k)] += penalty * a * b;
                }
            }
        }
        let coefficients = normal.cholesky()?.solve(&right).as_slice().to_vec();
        Some(Shape { start, step, coefficients })
    }

    /// Value and slope at time `x` in samples; beyond its ends the shape goes on straight, since a break there would keep a match
    /// from settling.
    pub fn at(&self, x: f64) -> (f64, f64) {
        let knots = self.coefficients.len() - 3;
        let u = (x - self.start) / self.step;
        let inside = u.clamp(0.0, knots as f64);
        let Some((first, weights)) = basis(inside, knots) else { return (0.0, 0.0) };
        let c = self.coefficients.get(first..first + 4).unwrap_or(&[0.0; 4]);
        let sum = |f: &dyn Fn(&(f64, f64)) -> f64| weights.iter().zip(c).map(|(w, c)| f(w) * c).sum::<f64>();
        let slope = sum(&|w| w.1);
        (sum(&|w| w.0) + slope * (u - inside), slope / self.step)
    }

    fn span(&self) -> Range<f64> {
        self.start..self.start + self.step * (self.coefficients.len() - 3) as f64
    }

    /// The average shape of pulses at `times` (in samples, NaN for those to leave out) over `span` around them, with the
    /// pulses matched to it. Scale and origin are those of the medians of `heights` and `times`.
    pub(super) fn averaged(
        values: &[f64],
        times: &[f64],
        heights: &[f64],
        span: &Range<f64>,
    ) -> Option<(Shape, Vec<Option<Matched>>)> {
        let mut at: Vec<(f64, f64)> = times.iter().copied().zip(heights.iter().copied()).collect();
        let mut result = None;
        for _ in 0..ROUNDS {
            let mut points = Vec::new();
            for (t, h) in at.iter().filter(|(t, h)| t.is_finite() && *h > 0.0) {
                let window = samples(values.len(), t + span.start, t + span.end);
                points.extend(window.map(|i| (i as f64 - t, values[i] / h)));
            }
            let shape = Shape::fitted(&points, span)?;
            let matched: Vec<Option<Matched>> =
                at.iter().map(|(t, h)| shape.matched(values, *t, *h)).collect();
            // The origin of the shape drifts with each round: it is put back.
            let shift = |i: usize, m: &Matched| m.time - times[i];
            let shifts: Vec<f64> =
                matched.iter().enumerate().filter_map(|(i, m)| Some(shift(i, m.as_ref()?))).collect();
            let drift = median(&shifts.into_iter().filter(|s| s.is_finite()).collect::<Vec<f64>>());
            let mut moved: f64 = 0.0;
            for (place, m) in at.iter_mut().zip(&matched) {
                if let Some(m) = m {
                    moved = moved.max((m.time - drift - place.0).abs());
                    *place = (m.time - drift, m.height);
                }
            }
            result = Some((shape, matched, drift));
            if moved < SETTLED {
                break;
            }
        }
        let (shape, mut matched, drift) = result?;
        matched.iter_mut().flatten().for_each(|m| m.time -= drift);
        Some((shape, matched))
    }

    /// Time and height of the pulse near time `t` (in samples), by Gauss-Newton on the samples that the shape covers.
    ///
    /// In white noise of variance σ² the time has the variance σ² × `cofactor`, which is the Cramér–Rao bound. `None` where fewer than
    /// three samples are covered or the steps do not end.
    pub fn matched(&self, values: &[f64], t: f64, height: f64) -> Option<Matched> {
        let span = self.span();
        let (mut time, mut height) = (t, height);
        let window = samples(values.len(), t + span.start, t + span.end);
        if window.len() < 3 {
            return None;
        }
        for _ in 0..50 {
            // Normal equations of (time, height): J = (−h s', s).
            let (mut tt, mut th, mut hh, mut tr, mut hr, mut rr) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
            for i in window.clone() {
                let (s, slope) = self.at(i as f64 - time);
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

/// Level of a recorded pulse before its first flank, and the standard deviation of noise there where there are enough samples for one.
///
/// What precedes the flank is what stays within a tenth of the range of values from the first one; of that the first half, where no
/// flank begins yet. A record that does not come back at least half-way begins inside its pulse: its level is 0.
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

/// First coefficient, and values and slopes of the four cubic B-splines, at `u` knots from the start.
fn basis(u: f64, knots: usize) -> Option<(usize, [(f64, f64); 4])> {
    if !(0.0..=knots as f64).contains(&u) {
        return None;
    }
    let first = (u as usize).min(knots - 1);
    let x = u - first as f64;
    let y = 1.0 - x;
    Some((
        first,
        [
            (y * y * y / 6.0, -0.5 * y * y),
            ((3.0 * x - 6.0) * x * x / 6.0 + 2.0 / 3.0, (1.5 * x - 2.0) * x),
            ((3.0 * y - 6.0) * y * y / 6.0 + 2.0 / 3.0, -(1.5 * y - 2.0) * y),
            (x * x * x / 6.0, 0.5 * x * x),
        ],
    ))
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
        let mut normal = crate::synthetic::Normal(0x5a9e);
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
                assert!((shape.at(1.41).0 - 1.0).abs() < 0.05 && shape.at(-2.59).0 < -1.0);
            }
        }
        let noisy: Vec<f64> = plain.iter().map(|v| v + 0.05 * normal.next() + 0.1).collect();
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
        let (_, matched) = Shape::averaged(&values, &rough, &[1.0; 20], &(-4.0..4.0)).unwrap();
        let off: Vec<f64> = matched.iter().zip(&times).map(|(m, t)| m.unwrap().time - t).collect();
        let mean = off.iter().sum::<f64>() / 20.0;
        // Rounds end at moves of 1e-3 and each takes off about half of what is left; a spline of
        // knots a sample apart errs by |s⁗|/384 = 3.8e-3 of the height, over slopes of 0.5, and pulses share most of that.
        assert!(off.iter().all(|o| (o - mean).abs() < 5e-3), "{off:?}");
    }
}
