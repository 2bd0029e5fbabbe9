//! Response to a stepped sine from traces of force and response, one pair a step.
//!
//! The frequency is that of the force ([`sine`]). Both traces are cut into blocks of whole periods, in each
//! of which a sine of that frequency and a mean are fitted by least squares (IEEE Std 1057, three
//! parameters). The phasors of the response, relative to the phase of the force in the same block, do not
//! drift with the force. They are averaged from the first settled block on, and their scatter gives the
//! uncertainty of amplitude, phase and receptance.

use super::answered::answered;
use super::clipping::clipped;
use super::excitation::Excitation;
use super::noise::upper_limit;
use super::residuals::{Whiteness, student};
use super::response::{Receptance, Response, ResponseOptions, ResponsePoint, read};
use super::tones::sine;
use super::{Estimate, mean};
use growth::{growth, without_growth};
use nalgebra::{Matrix3, Vector3};
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::path::PathBuf;
use vibro_record::units::Quantity;
use vibro_record::{
    Axis, Doubt, Error, Finding, Place, Result, Scaling, Spectrum, StepTraces, Sweep, SweepPoint, Trace,
    Uncertain, Window, uncertain,
};
use vibro_signal::spectrum;

mod growth;
mod hum;

/// Fewest periods of a step: as blocks of one period, they leave four in its second half, the fewest with an
/// uncertainty.
const PERIODS: f64 = 8.0;
/// Periods of a block, the first that gives enough blocks: 12 hold whole periods of subharmonics up to the
/// fourth.
const BLOCK: [usize; 4] = [12, 6, 4, 2];
/// Fewest blocks of a step with several periods a block, and most blocks of a step.
const BLOCKS: (usize, usize) = (12, 48);
/// 99 % quantile of χ² with two degrees of freedom.
const CHANCE: f64 = 9.21;
/// Least growth of a force over its standard uncertainty with which the blocks are fitted again.
const CLEAR: f64 = 4.0;
/// A response that still changes by less than this fraction of its amplitude counts as settled.
const SETTLED: f64 = 1e-3;
/// An amplitude below this many of its standard uncertainties counts as noise: it gets an upper limit.
const FAINT: f64 = 3.0;

/// Makes a sweep of the traces of its steps. Amplitude, phase and receptance come from the traces; harmonics
/// and the rest from the spectra of the settled parts, which are in the sweep returned. `named` has name,
/// direction and mass. A step is left out, with a finding, where it was not read, its force and response are
/// not sampled together and evenly, it has no sine of force, or fewer than eight periods.
///
/// # Errors
/// If no step is left, or two are not sampled at the same rate.
pub fn stepped(
    named: Sweep,
    steps: Vec<(PathBuf, Result<StepTraces>)>,
    options: &ResponseOptions,
) -> Result<(Sweep, Response)> {
    let taken = steps.into_iter().map(|(path, step)| {
        let taken = step.and_then(|step| Ok((Sine::of(&step)?, step))).map_err(|e| e.in_file(&path));
        (path, taken)
    });
    let (taken, left_out) = answered(taken)?;
    let (sines, mut steps): (Vec<Sine>, Vec<StepTraces>) = taken.into_iter().unzip();
    let hums = without_hum(&sines, &mut steps)?;
    let read_one = |(sine, step)| StepReading::of(sine, step);
    let mut taken: Vec<StepReading> = sines.into_iter().zip(&steps).map(read_one).collect();
    without_growth(&mut taken);
    let rate = taken.first().map_or(0.0, |step| step.rate);
    if let Some((step, at)) = taken.iter().zip(&steps).find(|(step, _)| (step.rate / rate - 1.0).abs() > 1e-6)
    {
        let found = format!("the step is sampled at {} Hz", step.rate);
        return Err(Error::input(Place::file(&at.path), found, format!("{rate} Hz, as the steps before")));
    }
    // All spectra have the same number of lines, by the shortest settled part.
    let n = taken.iter().map(|step| step.samples - step.begins).min().unwrap_or(0);
    let points =
        steps.iter().zip(&taken).map(|(step, taken)| taken.spectra(step, n)).collect::<Result<Vec<_>>>()?;
    let axis = points.first().map_or_else(|| Axis::index(0), |p| p.response.axis.clone());
    let mut sweep = Sweep { axis, points, ..named };
    sweep.findings.extend(left_out);
    for found in steps.iter().flat_map(|s| s.force.meta.findings.iter().chain(&s.response.meta.findings)) {
        if !sweep.findings.contains(found) {
            sweep.findings.push(found.clone());
        }
    }
    let excitations: Vec<Excitation> =
        taken.iter().zip(&steps).map(|(taken, step)| taken.excitation(step)).collect();
    let (mut found, beside) = read(&sweep, options, &excitations)?;
    let unit = steps.first().map_or("", |step| step.response.meta.unit.symbol());
    found.findings.extend(hums.iter().map(|line| line.hum.removed(unit)));
    for (k, ((point, step), beside)) in found.points.iter_mut().zip(&mut taken).zip(beside).enumerate() {
        let beside = hums.iter().map(|line| line.left[k]).fold(beside, f64::hypot);
        step.response.allow(beside);
        step.ratio.allow(beside / step.force.0);
        step.overrule(point, options.times(&sweep), found.unit);
        found.findings.extend(step.doubts.drain(..).map(|doubt| doubt.of(&mut point.of_response())));
    }
    let restless = taken
        .iter()
        .filter(|step| step.whiteness.is_some_and(|w| w.rejected_among(steps.len())))
        .map(|step| step.frequency.value);
    let restless: Vec<f64> = restless.collect();
    if !restless.is_empty() {
        let found_there = Finding::caution("step-wanders").count("n", restless.len());
        found.findings.push(found_there.numbers("frequencies", &restless[..restless.len().min(NAMED)]));
    }
    let direction = sweep.direction;
    Ok((sweep, found.curve(direction)))
}

/// Rounds in which a common variance settles.
const ROUNDS: usize = 20;

/// Hint where a force has no sine.
const SHAKER: &str = "check the channel of the force, and that the shaker ran";
/// Most steps that a finding names.
const NAMED: usize = 4;

/// Frequency, amplitudes and ratio of a step, from its traces.
struct StepReading {
    rate: f64,
    samples: usize,
    /// First sample of the settled part.
    begins: usize,
    /// Frequency of the excitation in Hz.
    frequency: Estimate,
    /// Amplitude of the force in N, and its standard uncertainty.
    force: (f64, Option<f64>),
    /// Relative rate in 1/s at which the force grows, and its standard uncertainty.
    growth: (f64, f64),
    /// Phasor of the response relative to the phase of the force.
    response: Phasor,
    /// Phasor of response over force.
    ratio: Phasor,
    /// Test of whether the response varies from block to block as independent noise does; `None` without an
    /// uncertainty of the response.
    whiteness: Option<Whiteness>,
    /// Doubts about the response.
    doubts: Vec<Doubt>,
}

/// Sampling rate in Hz of a force and its response.
///
/// # Errors
/// If they are not sampled together, or samples are missing.
fn rate_of(force: &Trace, response: &Trace) -> Result<f64> {
    let rate = force.sampling_rate()?;
    if response.rate() != Some(rate) || response.values.len() != force.values.len() {
        let error = Error::refused("force and response are not sampled together");
        return Err(error.hint("export both with one clock"));
    }
    if force.values.iter().chain(&response.values).any(|v| !v.is_finite()) {
        let error = Error::refused("samples are missing");
        return Err(error.hint("read the part before them").setting("span"));
    }
    Ok(rate)
}

/// Frequency of the sine of a force in Hz, and its number of periods.
///
/// # Errors
/// If there is no sine, or fewer periods than a response needs.
fn excitation(force: &Trace, rate: f64) -> Result<(Estimate, f64)> {
    let found = sine(force, None).map_err(|error| error.hint(SHAKER))?;
    let Some(tone) = found.tones.into_iter().next() else {
        return Err(Error::refused("the force holds no sine").hint(SHAKER));
    };
    let frequency = tone.frequency;
    let periods = force.values.len() as f64 / rate * frequency.value;
    if periods < PERIODS {
        let why = format!(
            "the step holds {periods:.1} periods of {:.4} Hz, and at least {PERIODS} are needed",
            frequency.value
        );
        return Err(Error::refused(why).hint("record longer"));
    }
    Ok((frequency, periods))
}

/// The excitation of a step, as its force has it.
struct Sine {
    rate: f64,
    frequency: Estimate,
    periods: f64,
    /// Number of clipped samples of the force and of the response.
    cut: [usize; 2],
}

impl Sine {
    fn of(StepTraces { force, response, .. }: &StepTraces) -> Result<Sine> {
        let rate = rate_of(force, response)?;
        let (frequency, periods) = excitation(force, rate)?;
        let cut = [force, response].map(|trace| clipped(&trace.values, rate / frequency.value).len());
        Ok(Sine { rate, frequency, periods, cut })
    }

    fn blocks(&self, step: &StepTraces) -> Blocks {
        Blocks::of(self.periods, self.rate / self.frequency.value, step.force.values.len())
    }
}

/// Removes hum from the responses.
///
/// # Errors
/// If a response has no spectrum.
fn without_hum(sines: &[Sine], steps: &mut [StepTraces]) -> Result<Vec<hum::Removed>> {
    let parts = sines.iter().zip(steps).map(|(sine, step)| {
        let blocks = sine.blocks(step);
        let (growth, _, ratio) = blocks.growing(&step.force, &step.response);
        hum::Settled {
            rate: sine.rate,
            begins: blocks.start(settled(&ratio).0),
            frequency: sine.frequency.value,
            growth,
            response: &mut step.response,
        }
    });
    hum::remove(parts.collect())
}

impl StepReading {
    fn of(sine: Sine, step: &StepTraces) -> StepReading {
        let StepTraces { force, response, .. } = step;
        let metas = [&force.meta, &response.meta];
        let samples = force.values.len();
        let blocks = sine.blocks(step);
        let Sine { rate, frequency, cut: [cut_force, cut], .. } = sine;
        let about = |code| Finding::doubt(code).number("frequency", frequency.value);
        let mut doubts = Vec::new();
        let (growth, f, ratio) = blocks.growing(force, response);
        let (begins, left, stays) = settled(&ratio);
        // While the force still rises, the ratio is right already but amplitudes are not: each has its own
        // first block.
        let sizes: Vec<Complex64> = f.iter().map(|f| f.norm().into()).collect();
        let (steady, drift, _) = settled(&sizes);
        let first = begins.max(steady);
        let turned: Vec<Complex64> = ratio.iter().zip(&f).map(|(r, f)| r * f.norm()).collect();
        let (mut response, mut ratio) = (Phasor::of(&turned[first..]), Phasor::of(&ratio[begins..]));
        let force: Vec<f64> = f[first..].iter().map(|f| f.norm()).collect();
        let mut force = (mean::average(&force), scatter_of_mean(&force));
        // The remaining drift of the force is in its uncertainty, and in that of the response.
        force.1 = force.1.map(|std| std.hypot(drift));
        response.allow(drift * ratio.value.norm());
        response.allow(left * force.0);
        ratio.allow(left);
        // Interpolation lowers both amplitudes by the same factor, so the ratio is not affected.
        let [of_force, of_response] = metas.map(|meta| meta.lost(frequency.value));
        force.1 = force.1.map(|std| std.hypot(of_force * force.0));
        response.allow(of_response * response.value.norm());
        if !stays {
            let part = left / ratio.value.norm();
            doubts.push(about("step-not-settled").number("left", part));
            [&mut response, &mut ratio].doubt();
        }
        let whiteness = response.std.map(|_| response.whiteness);
        if cut + cut_force > 0 {
            doubts.push(about("step-clipped").count("n", cut + cut_force));
            [&mut response, &mut ratio].doubt();
            force.1 = force.1.filter(|_| cut_force == 0);
        }
        let growth = (growth.0 * rate, growth.1 * rate);
        let begins = blocks.start(begins);
        StepReading { rate, samples, begins, frequency, force, growth, response, ratio, whiteness, doubts }
    }

    fn excitation(&self, step: &StepTraces) -> Excitation {
        Excitation {
            file: step.path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned()),
            frequency: self.frequency.value,
            std: self.frequency.std,
            force: Some(self.force.0),
            force_std: self.force.1,
        }
    }

    /// Spectra of the last `n` samples, all of them settled.
    fn spectra(&self, step: &StepTraces, n: usize) -> Result<SweepPoint> {
        let tail = |trace: &Trace| -> Result<Spectrum> {
            let values = trace.values[self.samples - n..].to_vec();
            let axis = Axis::time(0.0, 1.0 / self.rate, n);
            spectrum::plain(
                &Trace { meta: trace.meta.clone(), axis, values },
                Window::Hann,
                Scaling::Peak,
                true,
            )
        };
        let response = tail(&step.response)?;
        Ok(SweepPoint {
            force_path: None,
            response_path: step.path.clone(),
            force: tail(&step.force)?.values,
            given: None,
            response,
        })
    }

    /// Replaces the values of a point from spectra by those from the traces; `integrate` counts
    /// integrations, `unit` is that of the amplitude.
    fn overrule(&self, point: &mut ResponsePoint, integrate: i8, unit: &'static str) {
        let omega = Complex64::new(0.0, TAU * self.frequency.value).powi(integrate.into());
        let method = "least-squares sine fit to blocks of the settled part";
        let Phasor { value, std, across, n, .. } = self.response;
        let (size, scale) = (value.norm(), omega.norm());
        let faint = std.filter(|std| size < FAINT * std);
        (point.frequency, point.frequency_std) = (self.frequency.value, self.frequency.std);
        point.amplitude = Estimate::new(size / scale, std.map(|s| s / scale), unit, n, method);
        point.upper_limit = faint.and_then(|std| upper_limit(size, std)).map(|limit| limit / scale);
        let angle = (value / omega).arg();
        let turned = across.filter(|_| faint.is_none()).map(|a| a / size);
        point.phase = Some(Estimate::new(angle, turned, "rad", n, method));
        let ratio = self.ratio.value / omega;
        let each =
            self.ratio.std.zip(self.ratio.across).map(|(a, b)| f64::midpoint(a * a, b * b).sqrt() / scale);
        let displacement = unit == Quantity::Displacement.symbol();
        point.receptance = displacement.then_some(Receptance { re: ratio.re, im: ratio.im, std: each });
    }
}

/// Mean of the phasors of blocks.
#[derive(Clone, Copy)]
struct Phasor {
    value: Complex64,
    /// Standard uncertainty along the mean, for the amplitude; `across` it, for the phase.
    std: Option<f64>,
    across: Option<f64>,
    /// Number of blocks.
    n: usize,
    /// Test of whether the blocks are independent.
    whiteness: Whiteness,
}

uncertain!(Phasor: ; scaled: std, across);

impl Phasor {
    fn of(all: &[Complex64]) -> Phasor {
        let n = all.len();
        let value = all.iter().sum::<Complex64>() / n as f64;
        let unit = if value.norm() > 0.0 { value / value.norm() } else { Complex64::ONE };
        let turned: Vec<Complex64> = all.iter().map(|v| (v - value) / unit).collect();
        let (along, across): (Vec<f64>, Vec<f64>) = turned.iter().map(|v| (v.re, v.im)).unzip();
        let whiteness = Whiteness::of(&[&along, &across]);
        let std = |values: &[f64]| scatter_of_mean(values).map(|std| std * whiteness.inflation);
        Phasor { value, std: std(&along), across: std(&across), n, whiteness }
    }

    /// Adds the change that a transient, a drift or a steady line may make, in the unit of the phasor, to
    /// both uncertainties.
    fn allow(&mut self, left: f64) {
        for std in [&mut self.std, &mut self.across] {
            *std = std.map(|std| std.hypot(left));
        }
    }
}

/// Variance that values have in common beyond their own variances, from their squares and these: the weighted
/// mean of the differences, with weights for values of a normal distribution about 0; at least 0.
fn common(squares: &[(f64, f64)]) -> f64 {
    let mut found = squares.iter().map(|(square, _)| square).sum::<f64>() / squares.len() as f64;
    for _ in 0..ROUNDS {
        let known = squares.iter().filter(|(_, own)| *own + found > 0.0);
        let (over, all) = known.fold((0.0, 0.0), |(over, all), (square, own)| {
            let weight = (own + found).powi(-2);
            (over + weight * (square - own), all + weight)
        });
        found = if all > 0.0 { (over / all).max(0.0) } else { 0.0 };
    }
    found
}

/// Standard uncertainty (Student) of the mean of independent values; `None` for fewer than four.
fn scatter_of_mean(values: &[f64]) -> Option<f64> {
    let n = values.len();
    student(n.saturating_sub(1)).map(|factor| factor * mean::scatter(values) / (n as f64).sqrt())
}

/// Blocks of whole periods.
struct Blocks {
    /// Samples of a period.
    period: f64,
    /// Periods of a block.
    periods: usize,
    /// Number of samples of the trace.
    samples: usize,
}

impl Blocks {
    fn of(periods: f64, period: f64, samples: usize) -> Blocks {
        let whole = periods as usize;
        let few = BLOCK.into_iter().find(|p| whole / p >= BLOCKS.0).unwrap_or(1);
        // Long steps have blocks of more periods.
        Blocks { period, periods: few * (whole / few).div_ceil(BLOCKS.1).max(1), samples }
    }

    fn start(&self, block: usize) -> usize {
        ((block * self.periods) as f64 * self.period).round() as usize
    }

    /// Relative rate in 1/samples at which the force grows while the response is settled, with its standard
    /// uncertainty; the phasors of the force, and those of response over force, fitted with this growth where
    /// it is clear.
    fn growing(&self, force: &Trace, response: &Trace) -> ((f64, f64), Vec<Complex64>, Vec<Complex64>) {
        let fitted = |growth: f64| {
            let (f, x) = (self.phasors(force, growth), self.phasors(response, growth));
            let ratio: Vec<Complex64> = x.iter().zip(&f).map(|(x, f)| x / f).collect();
            (f, ratio)
        };
        let (f, ratio) = fitted(0.0);
        let begins = settled(&ratio).0.min(f.len());
        let growth = growth(&f[begins..], self.periods as f64 * self.period);
        let clear = growth.0.abs() > CLEAR * growth.1;
        let (f, ratio) = if clear { fitted(growth.0) } else { (f, ratio) };
        (growth, f, ratio)
    }

    /// Phasors at the excitation frequency, one per block: A e^{iφ} of A e^{εt} cos(ωt + φ). The `growth` ε
    /// in 1/samples counts from the middle of the block, the phase from the first sample.
    fn phasors(&self, trace: &Trace, growth: f64) -> Vec<Complex64> {
        let omega = TAU / self.period;
        let edges = (0..).map(|block| self.start(block)).take_while(|end| *end <= self.samples);
        let edges: Vec<usize> = edges.collect();
        let one = |edge: &[usize]| {
            let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
            for i in edge[0]..edge[1] {
                let (sin, cos) = (omega * i as f64).sin_cos();
                let grown = (growth * (i as f64 - f64::midpoint(edge[0] as f64, edge[1] as f64))).exp();
                let row = Vector3::new(grown * cos, grown * sin, 1.0);
                normal += row * row.transpose();
                right += row * trace.values[i];
            }
            normal.cholesky().map_or(Complex64::ZERO, |c| {
                let p = c.solve(&right);
                Complex64::new(p[0], -p[1])
            })
        };
        edges.windows(2).map(one).collect()
    }
}

/// First block from which on the phasors are settled, no later than half-way: the mean of the first quarter
/// of the rest differs from that of the others by no more than chance, or by less than [`SETTLED`]. The
/// block is moved on by half of its number, for a transient that noise hides. Also returns the change that
/// may be left, 0 where it is chance, and whether the phasors settle at all.
fn settled(all: &[Complex64]) -> (usize, f64, bool) {
    let n = all.len();
    let half = n / 2;
    let steps = all[half..].windows(2).map(|w| (w[1] - w[0]).norm_sqr());
    // Variance of one component of one block: a squared difference holds two components of two blocks.
    let variance = steps.sum::<f64>() / (4 * (n - half).saturating_sub(1).max(1)) as f64;
    let mean = |values: &[Complex64]| values.iter().sum::<Complex64>() / values.len() as f64;
    let change = |first: usize| {
        let rest = &all[first..];
        let (head, tail) = rest.split_at((rest.len() / 4).max(1));
        let change = (mean(head) - mean(tail)).norm();
        let chance = CHANCE * variance * (1.0 / head.len() as f64 + 1.0 / tail.len() as f64);
        (change, change * change <= chance)
    };
    let size = mean(&all[half..]).norm();
    let stays = |first: &usize| {
        let (change, by_chance) = change(*first);
        by_chance || change <= SETTLED * size
    };
    let Some(first) = (0..=half).find(stays) else { return (half, change(half).0, false) };
    let first = (first + first.div_ceil(2)).min(half);
    let (left, by_chance) = change(first);
    (first, if by_chance { 0.0 } else { left }, true)
}

#[cfg(test)]
mod tests;
