//! Frequency, amplitude and phase of sines in noise.
//!
//! Least squares of x(t) = C + Σ aᵢ cos ωᵢt + bᵢ sin ωᵢt over all unknowns: maximum likelihood in white noise
//! (S. M. Kay, Fundamentals of Statistical Signal Processing: Estimation Theory, 1993, section 7.8), for one
//! sine the four-parameter fit of IEEE Std 1057, which reaches the Cramér–Rao bound var(f) ≥ 12/((2πΔt)² η
//! N(N²−1)), η = A²/(2σ²) (Kay, eq. 3.41). Uncertainties come from the inverse of the whole normal matrix,
//! so they include the correlation of close sines. Only the noise around its own line affects a sine: its
//! uncertainties are those in white noise of that density (P. Whittle, Ark. Mat. 2 (1953) 423).

mod left;
mod lines;

use super::Estimate;
use super::clipping::clipped;
use left::Left;
use lines::HannLines;
use nalgebra::{DMatrix, DVector, RowVector3};
use serde::Serialize;
use std::f64::consts::{PI, TAU};
use vibro_record::{Error, Finding, Result, Trace, sort_by_number, uncertain};

/// Most sines of one record.
pub const MOST: usize = 10;
/// Most sines that are fitted beside those that were asked for, since they act on them.
const MOST_BESIDE: usize = 10;
/// Smallest shift of an amplitude by a sine that is not fitted, over its standard uncertainty, that counts.
const ACTS: f64 = 0.2;
/// Smallest distance of two sines in spectral lines (1/T). Nearer sines are so correlated that noise can make
/// a fit find two where there is one.
const NEAREST: f64 = 0.5;
/// Samples at the end of the range count as clipped where their mean lies this many of its standard
/// deviations inside the fitted sines.
const SHORT: f64 = 4.0;
/// Weight below which a clipped sample is left out of the normal equations.
const LEAST: f64 = 1e-9;
/// Most Gauss–Newton steps.
const STEPS: usize = 40;
/// Change of a frequency, over its standard uncertainty, below which the fit ends. Large residuals, as in
/// coloured noise, slow the convergence: a tighter limit costs steps.
const SETTLED: f64 = 1e-4;
/// Largest residual of exact sines, over the largest amplitude: it is rounding only.
const ROUNDING: f64 = 1e-12;
/// Smallest distance from half the sampling rate, in spectral lines. Nearer, a sine and its image are less
/// than half a line apart and correlated as two close sines are.
const IMAGE: f64 = 0.25;
/// Smallest ratio, as amplitudes, of the noise around a line to white noise of the same variance at which the
/// noise is reported as coloured.
const COLOURED: f64 = 1.5;
/// Distance in spectral lines from which the uncertainty for coloured noise covers the effect of another
/// sine.
const FAR: f64 = 3.5;
/// Distance in spectral lines below which a residual line is the sine itself: two sines so near each other
/// are one whose amplitude changes, as far as the record tells.
const SAME: f64 = 0.1;
/// Largest neighbouring line, doubled and over the sine's amplitude, whose effect on the sine is known.
const SMALL: f64 = 0.02;

/// One sine A cos(2πft + φ).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tone {
    /// Frequency in Hz.
    pub frequency: Estimate,
    /// Amplitude A.
    pub amplitude: Estimate,
    /// Phase φ in rad at the first sample.
    pub phase: Estimate,
}

uncertain!(Tone: frequency, phase; scaled: amplitude);

/// Sines of a record, and the residual noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Tones {
    /// The sines, the strongest first.
    pub tones: Vec<Tone>,
    /// Standard deviation of the residuals, in the unit of the trace.
    pub noise: f64,
    /// Why there are fewer sines than requested, and what limits their uncertainties.
    pub findings: Vec<Finding>,
}

/// The sine of the largest line, or of the largest within two lines of `near` Hz. Where the residual has
/// another large line within two lines of the sine, no uncertainty is given: [`tones`] fits both.
///
/// # Errors
/// If the trace has no spectrum ([`vibro_signal::spectrum::plain`]), no line is above the noise, the record
/// has fewer than one and a half periods, or the sine lies within a quarter of a line of half the sampling
/// rate.
pub fn sine(trace: &Trace, near: Option<f64>) -> Result<Tones> {
    Ok(SineFit::new(trace, &[HannLines::of(trace)?.strongest(near)?])?.estimates(trace, 1))
}

/// The `count` strongest sines of a trace; fewer, with a finding, where no further line is above the noise or
/// can be separated. The strongest line of the residual gives the next sine; then all are fitted together.
///
/// ```
/// use vibro_measure::tones::tones;
/// use vibro_record::{Axis, Meta, Trace};
/// use vibro_record::units::Unit;
/// let values = (0..500).map(|i| 2.0 * (0.3 * i as f64).cos() + 0.5 * (0.35 * i as f64).cos()).collect();
/// let meta = Meta::new("laser", Unit::parse("m/s").unwrap());
/// let found = tones(&Trace { meta, axis: Axis::time(0.0, 1e-3, 500), values }, 2)?;
/// assert!((found.tones[1].frequency.value - 350.0 / std::f64::consts::TAU).abs() < 1e-6);
/// assert!((found.tones[1].amplitude.value - 0.5).abs() < 1e-6);
/// # Ok::<(), vibro_record::Error>(())
/// ```
///
/// # Errors
/// If `count` is not 1 to [`MOST`]; as [`sine`] where there is not even one.
pub fn tones(trace: &Trace, count: usize) -> Result<Tones> {
    if !(1..=MOST).contains(&count) {
        return Err(Error::usage(format!("{count} tones"), format!("1 to {MOST}")));
    }
    let lines = HannLines::of(trace)?;
    let mut fitted = SineFit::new(trace, &[lines.strongest(None)?])?;
    let mut fewer = None;
    while fitted.omega.len() < count && fewer.is_none() {
        match fitted.one_more(trace, lines.spacing) {
            Some(more) => fitted = more,
            None => fewer = Some(Finding::caution("tones-fewer")),
        }
    }
    let known = fitted.omega.len();
    while let Some(more) =
        fitted.one_that_acts(trace, known).filter(|_| fitted.omega.len() < known + MOST_BESIDE)
    {
        fitted = more;
    }
    let mut found = fitted.estimates(trace, known);
    found.findings.extend(fewer.map(|f| f.count("known", known).count("count", count)));
    let beside = fitted.omega.len() - known;
    found.findings.extend((beside > 0).then(|| Finding::note("tones-beside").count("n", beside)));
    sort_by_number(&mut found.tones, |a| -a.amplitude.value);
    Ok(found)
}

/// Sines and a mean fitted to a record. The fit's time runs from −1 to 1 over the record: counted from the
/// middle, frequency and phase are almost uncorrelated.
struct SineFit {
    /// Angular frequencies in rad per half record.
    omega: Vec<f64>,
    /// a and b of each sine, then the mean, in the unit of the trace.
    linear: Vec<f64>,
    /// Inverse normal matrix: a, b and A δω of each sine, then the mean.
    inverse: DMatrix<f64>,
    /// Standard deviation of the residuals, in the unit of the trace.
    noise: f64,
    /// Half the duration of the record in s.
    half: f64,
    /// 1 and −1 for samples clipped at the upper and lower end of the range, 0 for all others.
    cut: Vec<f64>,
}

/// Time of sample `i` of `n` in half records, counted from the middle of the record.
fn time(i: usize, n: usize) -> f64 {
    (2 * i + 1) as f64 / n as f64 - 1.0
}

/// Normal equations of a step of the fit: of the cosine, the sine and the frequency of each sine, and of the
/// level.
struct NormalEquations {
    normal: DMatrix<f64>,
    right: DVector<f64>,
    /// Sum of the weighted squares of the values.
    all: f64,
    /// Sum of the squares of the residuals, and the degrees of freedom that they have.
    squares: f64,
    known: f64,
}

impl NormalEquations {
    /// At the frequencies `omega` and the amplitudes `linear`. `cut`: sides of clipped samples and the noise;
    /// `None` in the first step, when no amplitude is known.
    fn of(trace: &Trace, (omega, linear): (&[f64], &[f64]), cut: Option<(&[f64], f64)>) -> NormalEquations {
        let (n, count) = (trace.values.len(), omega.len());
        let size = 3 * count + 1;
        let mut row = DVector::<f64>::zeros(size);
        let (mut normal, mut right) = (DMatrix::<f64>::zeros(size, size), DVector::<f64>::zeros(size));
        let (mut all, mut squares, mut known) = (0.0, 0.0, -(size as f64));
        for (i, v) in trace.values.iter().enumerate() {
            let (t, mut model) = (time(i, n), linear[2 * count]);
            for (k, w) in omega.iter().enumerate() {
                let (sin, cos) = (w * t).sin_cos();
                let (a, b) = (linear[2 * k], linear[2 * k + 1]);
                let slope = if cut.is_none() { 0.0 } else { t * (b * cos - a * sin) / a.hypot(b) };
                row.as_mut_slice()[3 * k..3 * k + 3].copy_from_slice(&[cos, sin, slope]);
                model += a * cos + b * sin;
            }
            row[size - 1] = 1.0;
            let (side, noise) = cut.map_or((0.0, 0.0), |(sides, noise)| (sides[i], noise));
            let residual = Left::of(v - model, side, noise);
            squares += residual.square;
            known += residual.known;
            if residual.weight < LEAST {
                continue;
            }
            let v = model + residual.mean / residual.weight;
            all += residual.weight * v * v;
            normal.syger(residual.weight, &row, &row, 1.0);
            right.axpy(residual.weight * v, &row, 1.0);
        }
        normal.fill_upper_triangle_with_lower_triangle();
        NormalEquations { normal, right, all, squares, known }
    }
}

impl SineFit {
    /// Fit by Gauss–Newton from first guesses of the frequencies in Hz, each within half a line. Clipped
    /// samples are found first.
    fn new(trace: &Trace, start: &[f64]) -> Result<SineFit> {
        let (n, rate) = (trace.values.len(), trace.rate().unwrap_or(1.0));
        // Clipping is judged against the slowest sine, which has the flattest crests.
        let slowest = start.iter().copied().fold(f64::INFINITY, f64::min);
        let clipped = clipped(&trace.values, rate / slowest);
        let low = trace.values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = trace.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut cut = vec![0.0; n];
        for i in clipped {
            cut[i] = if trace.values[i] == low { -1.0 } else { 1.0 };
        }
        let fit = SineFit::of(trace, start, cut)?;
        // In a record that is not clipped, noise lifts the highest samples above the fitted sines. Where they
        // lie below, they are clipped.
        let (rest, mut cut) = (fit.rest(trace), fit.cut.clone());
        for (end, side) in [(low, -1.0), (high, 1.0)] {
            let at: Vec<usize> = (0..n).filter(|i| trace.values[*i] == end && fit.cut[*i] == 0.0).collect();
            let short: f64 = at.iter().map(|i| -side * rest.values[*i]).sum();
            if at.len() > 1 && short > SHORT * fit.noise * (at.len() as f64).sqrt() {
                for i in at {
                    cut[i] = side;
                }
            }
        }
        if cut == fit.cut { Ok(fit) } else { SineFit::of(trace, start, cut) }
    }

    /// Fit with known clipped samples `cut`.
    fn of(trace: &Trace, start: &[f64], cut: Vec<f64>) -> Result<SineFit> {
        let (n, count) = (trace.values.len(), start.len());
        let half = 0.5 * n as f64 / trace.rate().unwrap_or(1.0);
        let size = 3 * count + 1;
        let free = cut.iter().filter(|side| **side == 0.0).count().saturating_sub(size);
        if free == 0 {
            return Err(Error::refused(format!("{n} samples do not determine {count} sines")));
        }
        let mut omega: Vec<f64> = start.iter().map(|f| TAU * f * half).collect();
        let mut linear = vec![0.0; 2 * count + 1];
        let mut noise = 0.0;
        for step in 0..STEPS {
            let equations = NormalEquations::of(
                trace,
                (&omega[..], &linear[..]),
                (step > 0).then_some((&cut[..], noise)),
            );
            let NormalEquations { mut normal, right, all, squares, known } = equations;
            if step == 0 {
                // No amplitudes are known yet: the first step keeps the frequencies.
                (0..count).for_each(|k| normal[(3 * k + 2, 3 * k + 2)] = 1.0);
            }
            let unclear = || Error::refused("the samples do not determine these sines");
            let inverse = normal.cholesky().ok_or_else(unclear)?.inverse();
            let p = &inverse * &right;
            // Residual variance to first order: exact enough, since the steps end far below the uncertainty.
            let variance = (all - p.dot(&right)).max(0.0) / free as f64;
            noise = if step == 0 { variance.sqrt() } else { (squares / known).sqrt() };
            let mut settled = step > 0;
            for (k, w) in omega.iter_mut().enumerate() {
                let (a, b) = (p[3 * k], p[3 * k + 1]);
                (linear[2 * k], linear[2 * k + 1]) = (a, b);
                let change = if step == 0 { 0.0 } else { p[3 * k + 2] / a.hypot(b) };
                // At most 0.5 rad per half record, 0.16 lines, so that no sine leaves its line in one step.
                *w += change.clamp(-0.5, 0.5);
                let std = (variance * inverse[(3 * k + 2, 3 * k + 2)]).sqrt() / a.hypot(b);
                settled = settled && change.abs() <= (SETTLED * std).max(1e-12 * *w);
            }
            linear[2 * count] = p[size - 1];
            if omega.iter().any(|w| !w.is_finite()) {
                return Err(unclear());
            }
            if settled {
                let highest = omega.iter().copied().fold(0.0, f64::max);
                let short = 0.5 * n as f64 - highest / TAU * 2.0;
                if short < IMAGE {
                    let why = format!(
                        "the sine stands {short:.2} lines from half the sampling rate, where phase and amplitude cannot be parted"
                    );
                    return Err(Error::refused(why).hint("sample faster"));
                }
                let mut fit = SineFit { omega, linear, inverse, noise, half, cut };
                let (squares, known) = fit
                    .left(trace)
                    .iter()
                    .fold((0.0, 0.0), |(squares, known), left| (squares + left.square, known + left.known));
                fit.noise = (squares / (known - size as f64)).sqrt();
                return Ok(fit);
            }
        }
        Err(Error::refused("the fit does not settle: what is there is no steady sine")
            .hint("look at the spectrum: two close lines, or a frequency that drifts"))
    }

    /// The fit with one more sine; `None` where no other line is above the noise, or the sine cannot be
    /// separated from the others.
    fn one_more(&self, trace: &Trace, spacing: f64) -> Option<SineFit> {
        // The rounding errors of exact sines have spectral lines too.
        if self.is_exact() {
            return None;
        }
        self.with(trace, HannLines::of(&self.rest(trace)).ok()?.strongest(None).ok()?, spacing)
    }

    /// The fit with one more sine, that which acts most on the first `known`; `None` where no other acts on
    /// them, or it cannot be separated from the others.
    fn one_that_acts(&self, trace: &Trace, known: usize) -> Option<SineFit> {
        if self.is_exact() {
            return None;
        }
        let left = HannLines::of(&self.rest(trace)).ok()?;
        let std = self.noise * (2.0 / trace.values.len() as f64).sqrt();
        let acting = left.acting(&self.frequencies()[..known], ACTS * std)?;
        self.with(trace, acting, left.spacing)
    }

    /// The fit with one more sine near a frequency, if it can be separated from the others.
    fn with(&self, trace: &Trace, frequency: f64, spacing: f64) -> Option<SineFit> {
        let mut start = self.frequencies();
        start.push(frequency);
        let more = SineFit::new(trace, &start).ok()?;
        let mut f = more.frequencies();
        f.sort_by(f64::total_cmp);
        let parted = f.windows(2).all(|w| w[1] - w[0] >= NEAREST * spacing) && more.noise < self.noise;
        parted.then_some(more)
    }

    /// Frequencies in Hz.
    fn frequencies(&self) -> Vec<f64> {
        self.omega.iter().map(|w| w / (TAU * self.half)).collect()
    }

    /// Whether the residual is rounding only.
    fn is_exact(&self) -> bool {
        let largest = self.linear.chunks_exact(2).map(|p| p[0].hypot(p[1])).fold(0.0, f64::max);
        self.noise <= ROUNDING * largest
    }

    /// Residual of each sample, with its weight in the fit.
    fn left(&self, trace: &Trace) -> Vec<Left> {
        let n = trace.values.len();
        let mean = self.linear.last().copied().unwrap_or(0.0);
        let sum = |t: f64| -> f64 {
            let each = self.omega.iter().zip(self.linear.chunks_exact(2));
            each.map(|(w, p)| p[0] * (w * t).cos() + p[1] * (w * t).sin()).sum()
        };
        let each = trace.values.iter().zip(&self.cut).enumerate();
        each.map(|(i, (v, cut))| Left::of(v - mean - sum(time(i, n)), *cut, self.noise)).collect()
    }

    /// The residual record; a clipped sample has its expected residual.
    fn rest(&self, trace: &Trace) -> Trace {
        let values = self.left(trace).iter().map(|left| left.mean).collect();
        Trace { meta: trace.meta.clone(), axis: trace.axis.clone(), values }
    }

    /// The `known` strongest sines with first-order uncertainties, widened for coloured noise and for
    /// neighbouring lines of the residual.
    fn estimates(&self, trace: &Trace, known: usize) -> Tones {
        let n = trace.values.len();
        let (rest, unit) = (self.rest(trace), trace.meta.unit.quantity().symbol());
        let lines = if self.is_exact() { None } else { HannLines::of(&rest).ok() };
        let other = lines.as_ref().and_then(|lines| lines.strongest(None).ok());
        // Clipped samples have less noise in the residual: its lines are compared with white noise of the
        // residual's own RMS.
        let rms = (rest.values.iter().map(|v| v * v).sum::<f64>() / n as f64).sqrt();
        // The first sample, in the time of the fit.
        let first = time(0, n);
        let clipped = self.cut.iter().filter(|side| **side != 0.0).count();
        let lost = Finding::caution("sine-clipped").count("n", clipped).count("all", n);
        let mut findings: Vec<Finding> = (clipped > 0).then_some(lost).into_iter().collect();
        let tone = |(k, (omega, p)): (usize, (&f64, &[f64]))| {
            let (a, b) = (p[0], p[1]);
            let (amplitude, frequency) = (a.hypot(b), omega / (TAU * self.half));
            let widening = lines.as_ref().map_or(1.0, |lines| lines.colour(frequency, rms, other.is_none()));
            let estimate = |value, gradient: [f64; 3], unit| {
                let gradient = RowVector3::from(gradient);
                let part = self.inverse.fixed_view::<3, 3>(3 * k, 3 * k);
                let square = (gradient * part * gradient.transpose())[0];
                let std = widening * self.noise * square.max(0.0).sqrt();
                Estimate::new(value, Some(std), unit, n, "least-squares sine fit")
            };
            let phase = (-b.atan2(a) + omega * first + PI).rem_euclid(TAU) - PI;
            let square = amplitude * amplitude;
            let mut tone = Tone {
                frequency: estimate(frequency, [0.0, 0.0, 1.0 / (amplitude * TAU * self.half)], "Hz"),
                amplitude: estimate(amplitude, [a / amplitude, b / amplitude, 0.0], unit),
                phase: estimate(phase, [b / square, -a / square, first / amplitude], "rad"),
            };
            if let Some(lines) = &lines {
                let coloured = Finding::caution("sine-noise-coloured").number("frequency", frequency);
                let beside = tone.widened(lines, other);
                // Where a doubt has taken the uncertainty, none is enlarged.
                let enlarged = widening > COLOURED && tone.frequency.std.is_some();
                findings.extend(enlarged.then(|| coloured.number("factor", widening)));
                findings.extend(beside);
            }
            tone.frequency = tone.frequency.with_relative(trace.meta.clock);
            tone.amplitude = tone.amplitude.with_relative(trace.meta.lost(frequency));
            tone
        };
        let mut sines: Vec<_> = self.omega.iter().zip(self.linear.chunks_exact(2)).enumerate().collect();
        if known < sines.len() {
            sort_by_number(&mut sines, |(_, (_, p))| -p[0].hypot(p[1]));
        }
        let tones = sines.into_iter().take(known).map(tone).collect();
        Tones { tones, noise: self.noise, findings }
    }
}

impl Tone {
    /// Widens the uncertainties where the residual has another line beside this sine, which shifts the sine
    /// more than noise does. Beside a large line the shift is unknown, and the uncertainties are removed.
    ///
    /// A neighbouring sine of r times the amplitude shifts the frequency of a least-squares fit over T by up
    /// to 12r/T³ ∫t sin Δt dt/2π = 0.42 r/T. It shifts the relative amplitude and the phase in the middle by
    /// up to r, so the phase at the first sample by 2.3 r. The fit may have absorbed half of the neighbour:
    /// r is taken as twice the residual line. A line nearer than [`SAME`] is the sine itself, which is not
    /// steady.
    fn widened(&mut self, left: &HannLines, strongest: Option<f64>) -> Option<Finding> {
        let at = self.frequency.value;
        let other = left.strongest(Some(at)).ok()?;
        let strongest = strongest.unwrap_or(other);
        // A sine at this distance that was not fitted leaves a line here of up to its height over the
        // distance in lines. The noise around this sine already includes it.
        let away = (strongest - at).abs() / left.spacing;
        if away >= FAR && left.height(other) * away < left.height(strongest) {
            return None;
        }
        let part = 2.0 * left.height(other) / self.amplitude.value;
        let small = part <= SMALL;
        let moved = [0.42 * part * left.spacing, part * self.amplitude.value, 2.4 * part];
        let own = [&mut self.frequency, &mut self.amplitude, &mut self.phase];
        for (estimate, moved) in own.into_iter().zip(moved) {
            estimate.std = estimate.std.map(|s| s.hypot(moved));
        }
        let apart = (other - at).abs() / left.spacing;
        let beside = || Finding::caution("sine-line-beside");
        let found = match () {
            () if small => beside(),
            () if apart < SAME => Finding::doubt("sine-unsteady").of(self),
            () => Finding::doubt("sine-not-alone").of(self),
        };
        let found = found.number("frequency", at).number("line", other);
        Some(found.number("apart", apart).number("part", 0.5 * part))
    }
}

#[cfg(test)]
mod tests;
