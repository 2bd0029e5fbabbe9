//! Spectral lines of a record in a named scaling.
//!
//! One-sided: a line holds its frequency and the negative one, so that powers are doubled; not so at zero
//! and, at an even number of samples, at half the sampling rate f. With Σw the sum of the window's samples
//! and c = 2 (or 1 for those two): power c|X|²/(Σw)², RMS its root, peak amplitude c|X|/Σw, density c|X|²/(f
//! Σw²) (Heinzel, Rüdiger & Schilling, Spectrum and spectral density estimation by the DFT, 2002, section 9).

use super::fft::Transform;
use super::segment::Segments;
use super::sound::{constant, no_gaps};
use super::welch::{Averages, Sums};
use super::window;
use num_complex::Complex64;
use vibro_record::units::Unit;
use vibro_record::{Axis, Error, Meta, Result, Scaling, Spectrum, Trace, Values, Window};

/// The spectrum of a whole trace; its lines are complex where the scaling keeps their phase (peak and RMS).
///
/// The phase is that of A cos(ωt + φ) at the first sample. With `detrend` the mean is subtracted first. The
/// line at 0 Hz is then NaN: it would hold only what the window adds to a mean of zero.
///
/// ```
/// use vibro_record::{Axis, Meta, Scaling, Trace, Window};
/// use vibro_signal::spectrum;
/// use vibro_record::units::Unit;
/// let values = (0..64).map(|i| 0.5 + 3.0 * (std::f64::consts::TAU * i as f64 / 8.0).cos()).collect();
/// let meta = Meta::new("laser", Unit::parse("m/s").unwrap());
/// let trace = Trace { meta, axis: Axis::time(0.0, 1.0 / 64.0, 64), values };
/// let lines = spectrum::plain(&trace, Window::Hann, Scaling::Peak, false)?;
/// assert!((lines.values.magnitude(8) - 3.0).abs() < 1e-12); // 8 Hz
/// assert!((lines.values.magnitude(0) - 0.5).abs() < 1e-12); // the mean
/// # Ok::<(), vibro_record::Error>(())
/// ```
///
/// # Errors
/// If the trace has no sampling rate, fewer than 8 samples, missing ones or a single value, or the scaling is
/// not one that a transform gives.
pub fn plain(trace: &Trace, window: Window, scaling: Scaling, detrend: bool) -> Result<Spectrum> {
    let rate = trace.sampling_rate()?;
    let n = trace.values.len();
    if n < 8 {
        return Err(Error::refused(format!("{n} samples are too few for a spectrum: at least 8 are needed")));
    }
    no_gaps(&trace.values, &trace.meta.name, 0)?;
    if trace.values.iter().all(|v| *v == trace.values[0]) {
        return Err(constant(&trace.meta.name, trace.values[0]));
    }
    let mean = if detrend { trace.values.iter().sum::<f64>() / n as f64 } else { 0.0 };
    let weights = window::samples(window, n);
    let transform = Transform::new(n);
    let mut work = transform.workspace();
    work.load(&trace.values, mean, &weights);
    transform.run(&mut work);
    let mut sums = Sums::new(1, false, transform.lines());
    sums.add(std::slice::from_ref(&work));
    let averages = sums.mean(&weights, Segments { length: n, hop: n }, rate, detrend);
    let mut meta = trace.meta.clone();
    meta.step("spectrum", &[("window", &window.name()), ("scaling", &scaling.name()), ("detrend", &detrend)]);
    let mut found = finished(&averages, &averages.auto[0], meta, window, scaling)?;
    if matches!(scaling, Scaling::Peak | Scaling::Rms) {
        let c = |k| if scaling == Scaling::Peak { sides(k, n) } else { sides(k, n).sqrt() };
        let lines = work.output.iter().enumerate().map(|(k, x)| x * (c(k) / averages.sum));
        let mut lines: Vec<Complex64> = lines.collect();
        if detrend {
            lines[0] = Complex64::new(f64::NAN, f64::NAN);
        }
        found.values = Values::Complex(lines);
    }
    Ok(found)
}

/// The spectrum of one channel from averaged squares. The line at 0 Hz is NaN where the mean of segments was
/// subtracted.
///
/// # Errors
/// If there is no such channel, or the scaling is not one that a transform gives.
pub fn averaged(
    averages: &Averages,
    channel: usize,
    meta: &Meta,
    window: Window,
    scaling: Scaling,
) -> Result<Spectrum> {
    let Some(squared) = averages.auto.get(channel) else {
        let found = format!("channel {}", channel + 1);
        return Err(Error::usage(found, format!("1 to {}", averages.auto.len())));
    };
    let mut meta = meta.clone();
    meta.step(
        "welch",
        &[
            ("segment", &averages.length),
            ("averages", &averages.count),
            ("window", &window.name()),
            ("scaling", &scaling.name()),
            ("detrend", &averages.detrended),
        ],
    );
    finished(averages, squared, meta, window, scaling)
}

/// Fewest independent segments for which the scatter of a line is stated, see [`scatter`].
const FEWEST: f64 = 17.0;

/// Relative standard deviation of each averaged line, for noise: 1/√n for powers of n independent segments,
/// half of that for amplitudes. The lines at 0 Hz and at half the sampling rate are real and have √2 times
/// as much (Bendat & Piersol, Random Data, 4th ed. 2010, eq. 8.158). A sine well above the noise scatters
/// less. NaN for fewer than 17 independent segments: by the gamma distribution of their mean, ±1.96 standard
/// deviations around the power found would hold the truth in less than 92 % of all cases.
pub fn scatter(averages: &Averages, scaling: Scaling) -> Vec<f64> {
    let n = if averages.effective < FEWEST { f64::NAN } else { averages.effective };
    let order = if matches!(scaling, Scaling::Peak | Scaling::Rms) { 0.5 } else { 1.0 };
    let lines = averages.auto.first().map_or(0, Vec::len);
    (0..lines).map(|k| order * (2.0 / sides(k, averages.length) / n).sqrt()).collect()
}

/// Scales the |X|² of a channel. The line at 0 Hz is NaN where the mean was subtracted.
fn finished(
    averages: &Averages,
    squared: &[f64],
    mut meta: Meta,
    window: Window,
    scaling: Scaling,
) -> Result<Spectrum> {
    let Averages { length: n, rate, sum, squares, .. } = *averages;
    meta.unit = unit(&meta.unit, scaling)?;
    meta.declared_n = None;
    let value = |(k, x): (usize, &f64)| match scaling {
        Scaling::Peak => sides(k, n) * x.sqrt() / sum,
        Scaling::Rms => (sides(k, n) * x).sqrt() / sum,
        Scaling::Power => sides(k, n) * x / (sum * sum),
        _ => sides(k, n) * x / (rate * squares),
    };
    let mut values: Vec<f64> = squared.iter().enumerate().map(value).collect();
    if averages.detrended {
        values[0] = f64::NAN;
    }
    let axis = Axis::frequency(0.0, averages.step(), values.len());
    let enbw = Some(n as f64 * squares / (sum * sum));
    Ok(Spectrum { meta, axis, values: Values::Real(values), scaling, window: Some(window), enbw })
}

/// Number of lines of a two-sided spectrum of `n` samples that the one-sided line `k` combines.
fn sides(k: usize, n: usize) -> f64 {
    if k == 0 || 2 * k == n { 1.0 } else { 2.0 }
}

/// Unit of a spectral line in a scaling, for a record in `unit`.
///
/// # Errors
/// If the scaling is not one that a transform gives.
pub fn unit(unit: &Unit, scaling: Scaling) -> Result<Unit> {
    let symbol = unit.symbol();
    let base =
        if symbol.chars().all(char::is_alphanumeric) { symbol.to_owned() } else { format!("({symbol})") };
    match scaling {
        Scaling::Peak | Scaling::Rms => Ok(unit.clone()),
        Scaling::Power => Ok(Unit::parse_or_opaque(&format!("{base}²"))),
        Scaling::Psd => Ok(Unit::parse_or_opaque(&format!("{base}²/Hz"))),
        Scaling::Energy | Scaling::Coherence | Scaling::Unknown => {
            Err(Error::usage(format!("the scaling {:?}", scaling.name()), "peak, rms, power or psd"))
        }
    }
}

#[cfg(test)]
mod tests;
