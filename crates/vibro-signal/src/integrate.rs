//! From velocity to displacement and back: in frequency line by line, in time with a high-pass.

use super::filter::Filter;
use super::spectrum;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::units::Unit;
use vibro_record::units::notation::shortest;
use vibro_record::{Axis, Error, Grid, Result, Scaling, Spectrum, Trace, Values};

/// Integrates a spectrum `times` times (differentiates where below 0): each line is divided by (iω) that
/// often, magnitudes by ω, powers by ω². Lines below `fmin` Hz are left out. An integration also leaves out
/// the line at 0 Hz: a mean velocity has no displacement in a spectrum.
///
/// # Errors
/// If `times` is not −2 to 2, no line is left, or the lines are not of a scaling that can be integrated.
pub fn in_frequency(spectrum: &Spectrum, times: i8, fmin: f64) -> Result<Spectrum> {
    check(times, -2)?;
    let Grid::Even { start, step, n } = spectrum.axis.grid else {
        return Err(Error::refused("the lines of the spectrum are not evenly spaced"));
    };
    // A line at `fmin` is kept despite rounding.
    let first = (0..n).find(|k| {
        let f = start + *k as f64 * step;
        f >= fmin - 1e-9 * step && !(times > 0 && f <= 0.0)
    });
    let Some(first) = first else {
        let why = format!(
            "no line is left at or above {fmin} Hz: the highest is {} Hz",
            spectrum.axis.at(n.saturating_sub(1))
        );
        return Err(Error::refused(why).hint("a lower limit").setting("fmin"));
    };
    let omega = |k: usize| TAU * (start + k as f64 * step);
    let power = match spectrum.scaling {
        Scaling::Peak | Scaling::Rms | Scaling::Unknown => 1,
        Scaling::Power | Scaling::Psd | Scaling::Energy => 2,
        Scaling::Coherence => return Err(Error::usage("a coherence", "a spectrum that can be integrated")),
    };
    let values = match &spectrum.values {
        Values::Real(v) => {
            let rest = v.iter().enumerate().skip(first);
            Values::Real(rest.map(|(k, v)| v * omega(k).powi(-power * i32::from(times))).collect())
        }
        Values::Complex(v) => {
            let factor = |k| Complex64::new(0.0, omega(k)).powi(-i32::from(times));
            Values::Complex(v.iter().enumerate().skip(first).map(|(k, v)| v * factor(k)).collect())
        }
    };
    let mut result = Spectrum {
        meta: spectrum.meta.clone(),
        axis: Axis::frequency(start + first as f64 * step, step, n - first),
        values,
        ..spectrum.clone()
    };
    if times != 0 {
        let meta = &mut result.meta;
        // The unit of a density is spelled from the unit of the motion, where that is known.
        let base = Unit::parse_or_opaque(meta.quantity.symbol());
        let known = spectrum::unit(&base, spectrum.scaling).ok().filter(|u| *u == meta.unit);
        let integrated = base.times_seconds(times);
        meta.unit = match known {
            Some(_) => spectrum::unit(&integrated, spectrum.scaling)?,
            None => meta.unit.times_seconds(power as i8 * times),
        };
        meta.quantity = if known.is_some() { integrated.quantity() } else { meta.unit.quantity() };
        meta.step("integrate", &[("times", &times), ("fmin", &fmin)]);
    }
    Ok(result)
}

/// Options of an integration in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InTime {
    /// Number of integrations, 1 or 2.
    pub times: i8,
    /// Corner in Hz of the high-pass after each integration; it runs forwards and backwards, without phase.
    pub corner: f64,
    /// Order of the high-pass in one of the two passes.
    pub order: usize,
    /// Period of the excitation in s: means are taken over whole periods only.
    pub period: Option<f64>,
}

impl InTime {
    /// Gain of high-pass and trapezoid over the exact integral, in all integrations together, for a sine of
    /// `frequency` sampled at `rate` (Hz), away from the ends of the record.
    ///
    /// # Errors
    /// If the corner or the order is invalid.
    pub fn gain(&self, frequency: f64, rate: f64) -> Result<f64> {
        let filter = Filter::high_pass(self.corner, self.order, rate)?;
        let turn = 0.5 * TAU * frequency / rate;
        // Both passes of the high-pass, times the trapezoid's Δt/2·(1 + z⁻¹)/(1 − z⁻¹) over the integral's
        // 1/(iω).
        let once = filter.response(frequency).norm_sqr() * turn / turn.tan();
        Ok(once.powi(i32::from(self.times)))
    }
}

/// An integrated trace and the limits of its accuracy.
#[derive(Debug, Clone, PartialEq)]
pub struct Integrated {
    /// The trace, with its new unit.
    pub trace: Trace,
    /// Frequencies in Hz between which amplitudes are right within 1 %: the high-pass attenuates lower ones,
    /// the trapezoid higher ones.
    pub band: [f64; 2],
    /// Seconds at both ends in which the high-pass has not settled.
    pub edge: f64,
    /// Remaining drift between the edges, in the unit of the trace: the change of the mean from the first
    /// period to the last, or without a period the change of a fitted straight line.
    pub drift: f64,
}

/// Integrates a trace by the trapezoidal rule. The mean over whole periods is removed before, the drift by a
/// zero-phase Butterworth high-pass afterwards.
///
/// # Errors
/// If the trace has no sampling rate, is too short for the filter or for one period, a sample is missing, or
/// the corner leaves no band.
pub fn in_time(trace: &Trace, how: &InTime) -> Result<Integrated> {
    check(how.times, 1)?;
    let rate = trace.sampling_rate()?;
    let filter = Filter::high_pass(how.corner, how.order, rate)?;
    let band = band(how, rate);
    if band[0] >= band[1] {
        let why = format!(
            "a corner of {} Hz at a sampling rate of {} Hz leaves no band in which an integral is right within 1 %",
            shortest(how.corner),
            shortest(rate)
        );
        let hint = "a lower corner, a higher order, or integration in frequency";
        return Err(Error::refused(why).hint(hint));
    }
    let whole = whole_periods(trace.values.len(), how.period, rate)?;
    let mut values = trace.values.clone();
    for _ in 0..how.times {
        let mean = values[..whole].iter().sum::<f64>() / whole as f64;
        let (mut sum, mut before) = (0.0, values.first().map_or(0.0, |v| v - mean));
        for v in &mut values {
            let now = *v - mean;
            sum += 0.5 * (before + now) / rate;
            (*v, before) = (sum, now);
        }
        values = filter.zero_phase(&values)?;
    }
    let edge = 3.0 / how.corner;
    let drift = drift(&values, (edge * rate) as usize, how.period.map(|p| (p * rate).round() as usize));
    let mut meta = trace.meta.clone();
    meta.unit = meta.unit.times_seconds(how.times);
    meta.quantity = meta.unit.quantity();
    meta.step(
        "integrate",
        &[
            ("times", &how.times),
            ("rule", &"trapezoid"),
            ("filter", &filter),
            ("passes", &2),
            ("drift", &format!("{drift:.2e}")),
        ],
    );
    Ok(Integrated { trace: Trace { meta, axis: trace.axis.clone(), values }, band, edge, drift })
}

fn check(times: i8, least: i8) -> Result<()> {
    if (least..=2).contains(&times) {
        return Ok(());
    }
    Err(Error::usage(format!("{times} integrations"), format!("a whole number from {least} to 2")))
}

/// Frequencies in Hz between which high-pass and trapezoid attenuate by at most 0.5 % each, in all
/// integrations together. The gain of two passes of the high-pass is 1/(1 + (corner/f)^2N), that of the
/// trapezoid over the integral (ωΔt/2)/tan(ωΔt/2) ≈ 1 − (ωΔt)²/12.
fn band(how: &InTime, rate: f64) -> [f64; 2] {
    let share = 0.005 / f64::from(how.times);
    let low = how.corner * (1.0 / share - 1.0).powf(0.5 / how.order as f64);
    [low, rate * (12.0 * share).sqrt() / TAU]
}

/// Number of samples in the whole periods of the record; all samples where no period is known.
fn whole_periods(n: usize, period: Option<f64>, rate: f64) -> Result<usize> {
    let Some(period) = period else { return Ok(n.max(1)) };
    let cycles = (n as f64 / rate / period).floor();
    if !(cycles >= 1.0 && cycles.is_finite() && period * rate >= 2.0) {
        let why = format!("{n} samples at {rate} Hz do not hold one whole period of {period} s");
        return Err(Error::refused(why));
    }
    Ok(((cycles * period * rate).round() as usize).clamp(1, n))
}

/// Drift as in [`Integrated::drift`]; `edge` and `period` are in samples.
fn drift(values: &[f64], edge: usize, period: Option<usize>) -> f64 {
    let inner =
        values.get(edge..values.len().saturating_sub(edge)).filter(|v| v.len() >= 2).unwrap_or(values);
    let n = inner.len();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    if let Some(p) = period.filter(|p| *p >= 1 && 2 * p <= n) {
        return mean(&inner[n - p..]) - mean(&inner[..p]);
    }
    let (middle, centre) = (mean(inner), 0.5 * (n as f64 - 1.0));
    let about = || inner.iter().enumerate().map(|(i, v)| (i as f64 - centre, v - middle));
    let product: f64 = about().map(|(x, v)| x * v).sum();
    product / about().map(|(x, _)| x * x).sum::<f64>() * (n as f64 - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;
    use vibro_math::Noise;
    use vibro_record::units::Quantity;
    use vibro_record::{Meta, Window};

    fn trace(unit: &str, rate: f64, values: Vec<f64>) -> Trace {
        let meta = Meta::new("laser", Unit::parse(unit).unwrap());
        Trace { meta, axis: Axis::time(0.0, 1.0 / rate, values.len()), values }
    }

    #[test]
    fn the_gain_is_what_is_left_of_a_sine() {
        let (rate, n) = (1000.0, 8000);
        let values: Vec<f64> = (0..n).map(|i| (TAU * 20.0 * f64::from(i) / rate + 0.4).sin()).collect();
        let meta = Meta::new("velocity", Unit::parse("m/s").unwrap());
        let trace = Trace { meta, axis: Axis::time(0.0, 1.0 / rate, values.len()), values };
        for times in [1, 2] {
            for corner in [5.0, 12.0] {
                let how = InTime { times, corner, order: 4, period: Some(0.05) };
                let found = in_time(&trace, &how).unwrap().trace.values;
                // 80 whole periods in the middle. There the filter's transients from the ends, 2 s away, have
                // decayed to exp(−0.38·2π·5·2) = 4e-11.
                let sum = |f: fn(f64) -> f64| -> f64 {
                    (2000..6000).map(|i| found[i] * f(TAU * 20.0 * i as f64 / rate)).sum::<f64>() / 2000.0
                };
                let left = sum(f64::sin).hypot(sum(f64::cos)) * (TAU * 20.0).powi(i32::from(times));
                let gain = how.gain(20.0, rate).unwrap();
                // The sum of an integration carries rounding of 8000 steps.
                assert!((left / gain - 1.0).abs() < 1e-9, "{times} {corner}: {left} {gain}");
            }
        }
    }

    #[test]
    fn a_line_is_divided_by_its_angular_frequency() {
        let (rate, n) = (512.0, 512);
        // Acceleration A cos(ωt + φ) on line 20: displacement −A/ω² cos(ωt + φ).
        let values = (0..n).map(|i| 3.0 * (TAU * 20.0 * f64::from(i) / rate + 0.4).cos() + 1.0).collect();
        let trace = trace("m/s²", rate, values);
        let omega = TAU * 20.0;
        let plain = |scaling| spectrum::plain(&trace, Window::Hann, scaling, false).unwrap();
        let peak = in_frequency(&plain(Scaling::Peak), 2, 0.0).unwrap();
        assert_eq!((peak.meta.quantity, peak.meta.unit.symbol()), (Quantity::Displacement, "m"));
        // The line at 0 Hz is absent, not 0.
        assert_eq!((peak.axis.start(), peak.axis.len()), (1.0, 256));
        let Values::Complex(lines) = &peak.values else { panic!() };
        let truth = -Complex64::from_polar(3.0 / (omega * omega), 0.4);
        assert!((lines[19] / truth - 1.0).norm() < 1e-12);
        let once = in_frequency(&plain(Scaling::Peak), 1, 5.0).unwrap();
        assert_eq!((once.axis.start(), once.meta.unit.symbol()), (5.0, "m/s"));
        let Values::Complex(lines) = &once.values else { panic!() };
        // Velocity lags acceleration by a quarter of a period.
        assert!((lines[15] / Complex64::from_polar(3.0 / omega, 0.4 - TAU / 4.0) - 1.0).norm() < 1e-12);
        let psd = in_frequency(&plain(Scaling::Psd), 1, 0.0).unwrap();
        assert_eq!((psd.meta.unit.symbol(), psd.meta.quantity), ("(m/s)²/Hz", Quantity::Velocity));
        assert!((psd.values.magnitude(19) / (4.5 / 1.5 / (omega * omega)) - 1.0).abs() < 1e-12);
        // A differentiation undoes the integration.
        let back = in_frequency(&once, -1, 0.0).unwrap();
        assert_eq!(back.meta.unit.symbol(), "m/s²");
        assert!((back.values.magnitude(15) / 3.0 - 1.0).abs() < 1e-12);
        assert!(in_frequency(&once, 3, 0.0).is_err());
        assert!(in_frequency(&once, 1, 257.0).unwrap_err().to_string().contains("no line is left"));
    }

    /// Velocity with offset, drift and noise: the displacement is right within 1 % from one end of the stated
    /// band to the other.
    #[test]
    fn displacement_is_right_within_the_stated_band() {
        let (rate, n) = (2048.0, 40_960usize);
        let how = InTime { times: 1, corner: 2.0, order: 4, period: None };
        let [low, high] = band(&how, rate);
        let mut noise = Noise::new(7);
        for f in [1.001 * low, 10.0, 30.0, 0.999 * high] {
            let omega = TAU * f;
            // Amplitude 1 mm; noise of 1 % of the velocity's amplitude, offset 100 %, drift 200 %.
            let amplitude = 1e-3 * omega;
            let values = (0..n)
                .map(|i| {
                    let t = i as f64 / rate;
                    amplitude * ((omega * t).cos() + 1.0 + 2.0 * t * rate / n as f64 + 0.01 * noise.normal())
                })
                .collect();
            let found =
                in_time(&trace("m/s", rate, values), &InTime { period: Some(1.0 / f), ..how }).unwrap();
            assert_eq!(found.trace.meta.unit.symbol(), "m");
            let edge = (found.edge * rate) as usize;
            // Amplitude by projection between the edges, over whole periods.
            let inner = n - 2 * edge;
            let inner = ((inner as f64 * f / rate).floor() / f * rate).round() as usize;
            let sine = (edge..edge + inner)
                .map(|i| found.trace.values[i] * Complex64::cis(-omega * i as f64 / rate))
                .sum::<Complex64>()
                * (2.0 / inner as f64);
            let truth = Complex64::new(0.0, -1e-3);
            assert!((sine / truth - 1.0).norm() < 0.01, "{f} Hz: {sine}");
            // Integrated white noise above the corner f_c has the variance σ²/(2π² f_c · rate), since
            // ∫df/(2πf)² = 1/(4π² f_c) and its density is 2σ²/rate. The difference of two uncorrelated
            // samples has √2 times this standard deviation, that of two means over a period less.
            let left = 0.01 * amplitude / (2.0 * PI * PI * how.corner * rate).sqrt();
            assert!(found.drift.abs() < 4.0 * 2f64.sqrt() * left, "{f} Hz: {}", found.drift);
        }
    }

    #[test]
    fn constant_acceleration_is_the_closed_form_before_the_filter() {
        // Two integrations of a slow cosine, far above the corner.
        let rate = 1000.0;
        let values = (0..20_000).map(|i| (TAU * 5.0 * f64::from(i) / rate).cos()).collect();
        let how = InTime { times: 2, corner: 0.5, order: 2, period: Some(0.2) };
        let found = in_time(&trace("m/s²", rate, values), &how).unwrap();
        assert_eq!(found.trace.meta.unit.symbol(), "m");
        let truth = |i: usize| -(TAU * 5.0 * i as f64 / rate).cos() / (TAU * 5.0).powi(2);
        for i in 8000..12_000 {
            assert!((found.trace.values[i] - truth(i)).abs() < 0.01 / (TAU * 5.0).powi(2), "{i}");
        }
    }

    #[test]
    fn what_cannot_be_integrated_is_refused() {
        let how = InTime { times: 1, corner: 2.0, order: 4, period: None };
        let short = trace("m/s", 100.0, vec![1.0; 10]);
        assert!(in_time(&short, &how).unwrap_err().to_string().contains("10 samples"));
        let long = trace("m/s", 100.0, vec![1.0; 1000]);
        assert!(in_time(&long, &InTime { corner: 5.0, ..how }).unwrap_err().to_string().contains("no band"));
        assert!(in_time(&long, &InTime { period: Some(11.0), corner: 0.1, ..how }).is_err());
        assert!(in_time(&long, &InTime { times: 0, ..how }).is_err());
    }
}
