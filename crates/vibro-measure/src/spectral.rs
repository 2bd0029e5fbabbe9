//! Spectra and frequency response functions of time records, from channels to lines with their uncertainty.

mod options;
mod result;
mod skirt;

pub use options::{Method, SpectralOptions};
pub use result::{FrfDetails, Lines, SpectralResult};

use super::stands_out::{FALSE_ALARMS, REACH, floor};
use super::tones;
use num_complex::Complex64;
use skirt::above_skirts;
use std::f64::consts::TAU;
use vibro_record::code;
use vibro_record::units::Unit;
use vibro_record::{Axis, Doubt, Error, Finding, Meta, Result, Scaling, Spectrum, Trace, Traces, Window};
use vibro_signal::impact::{BlowTransfer, Blows, force_window, from_blows, spacing};
use vibro_signal::integrate::in_frequency;
use vibro_signal::rails::Rails;
use vibro_signal::segment::Segments;
use vibro_signal::spectrum;
use vibro_signal::transfer::{Estimator, transfer};
use vibro_signal::welch::{Averages, Welch};
use vibro_signal::window::line_shape;

/// Samples of a segment where none is stated: lines 5.9 Hz apart at 48 kHz.
const SEGMENT: usize = 8192;
/// A reference comes in blows where half its span exceeds its RMS by this factor: noise has 3 to 5, and the
/// impacts of a machine at a duty of one in 200 have 10.
const BLOWS: f64 = 15.0;
/// Fewest samples of a blow's record, unless its length is stated.
const SHORTEST: usize = 256;
/// A hammer record begins 1/50 of its length before the blow.
pub(crate) const BEFORE: usize = 50;
/// But at least this many samples, up to a quarter of a record: the force rises, and an anti-alias filter
/// rings, before the trigger.
const RISE: usize = 16;

/// The spectrum of the only channel, or with an estimator the frequency response function from the first
/// channel to the second. `progress` gets the number of samples read.
///
/// ```
/// use vibro_measure::spectral::{SpectralOptions, spectral};
/// use vibro_record::Traces;
/// use vibro_record::{Axis, Meta, Trace};
/// use vibro_record::units::Unit;
/// let values = (0..4096).map(|i| 3.0 * (std::f64::consts::TAU * i as f64 / 16.0).cos()).collect();
/// let meta = Meta::new("laser", Unit::parse("m/s").unwrap());
/// let trace = Trace { meta, axis: Axis::time(0.0, 1.0 / 1024.0, 4096), values };
/// let options = SpectralOptions { segment: Some(1024), ..SpectralOptions::default() };
/// let found = spectral(&mut Traces::from_memory(vec![trace])?, &options, |_| ())?;
/// assert!((found.value[64] - 3.0).abs() < 1e-9); // 64 Hz
/// # Ok::<(), vibro_record::Error>(())
/// ```
///
/// # Errors
/// If options contradict each other ([`SpectralOptions::check`]), there are too few channels, or the record
/// allows no answer.
pub fn spectral(
    traces: &mut Traces,
    options: &SpectralOptions,
    progress: impl FnMut(usize) + Send,
) -> Result<SpectralResult> {
    options.check()?;
    let mut found = match options.estimator {
        None => lines(traces, options, progress),
        Some(estimator) => response(traces, options, estimator, progress),
    }?;
    if let Some(reference) = options.decibel {
        let channel = traces.channels().first().map(|meta| meta.unit.times_seconds(options.integrate));
        let unit = channel.filter(|_| options.estimator.is_none());
        let unit = unit.map_or_else(|| found.unit.clone(), |unit| unit.symbol().to_owned());
        found.over(reference, &unit);
    }
    Ok(found)
}

/// Result for a spectrum that an instrument computed. Its lines have no uncertainty, since a file does not
/// say over how many segments they were averaged.
///
/// # Errors
/// If options state how a spectrum is computed, or the values are levels without a reference.
pub fn stored(spectrum: &Spectrum, options: &SpectralOptions) -> Result<SpectralResult> {
    options.check()?;
    let SpectralOptions { integrate, fmin, decibel, .. } = *options;
    let own = SpectralOptions { integrate, fmin, decibel, ..SpectralOptions::default() };
    if *options != own {
        let found = format!("{:?} is a spectrum already", spectrum.meta.name);
        return Err(Error::usage(
            found,
            "integrate, fmin and decibel at most, for the rest belongs to a time record",
        ));
    }
    if spectrum.meta.unit.is_level() {
        let found = format!("{:?} has levels in {}", spectrum.meta.name, spectrum.meta.unit);
        let hint = "state the unit with its reference, such as \"dB re 1 g\"";
        return Err(Error::usage(found, "amplitudes, or levels with their reference")
            .hint(hint)
            .setting("unit"));
    }
    let fmin = options.lowest(spectrum.axis.step().unwrap_or(0.0));
    let lines = in_frequency(spectrum, integrate, fmin)?;
    let (powers, left_out) = (powers(spectrum), spectrum.axis.len() - lines.axis.len());
    let (window, enbw) = (spectrum.window, spectrum.enbw);
    let mut found = SpectralResult::of(Lines::Spectrum(lines), &own, fmin, spectrum.meta.findings.clone());
    found.clear = clear(&found, &powers, left_out, 1.0, window);
    found.false_alarms = Some(FALSE_ALARMS);
    (found.window, found.detrend) = (window.map_or(UNSAID, Window::name), UNSAID);
    found.enbw = enbw.unwrap_or(f64::NAN);
    if let Some(reference) = decibel {
        found.over(reference, spectrum.meta.unit.times_seconds(integrate).symbol());
    }
    Ok(found)
}

/// Value of settings that a file does not state.
const UNSAID: &str = "not said";

fn lines(
    traces: &mut Traces,
    options: &SpectralOptions,
    progress: impl FnMut(usize) + Send,
) -> Result<SpectralResult> {
    let (scaling, window) = (options.scaling.unwrap_or(Scaling::Peak), options.window());
    let (mut tones, mut cut, mut segments) = (None, Vec::new(), None);
    let (spectrum, averages, independent, mut scatter) = if options.method() == Method::Welch {
        let averages = averages(traces, options, progress)?;
        cut = clipped(&averages.ranges, traces);
        let meta = traces.channels().first().cloned().unwrap_or_else(|| Meta::new("", Unit::opaque("")));
        let scatter = spectrum::scatter(&averages, scaling);
        let spectrum = spectrum::averaged(&averages, 0, &meta, window, scaling)?;
        let averages = segments.insert(averages);
        (spectrum, averages.count, averages.effective, scatter)
    } else {
        let [trace] = whole(traces, progress)?;
        // The fit of sines (`tones`) accounts for clipping itself.
        if options.tones.is_none() {
            let mut range = Rails::default();
            range.extend(&trace.values);
            cut = clipped(&[range], traces);
        }
        let spectrum = spectrum::plain(&trace, window, scaling, options.detrended())?;
        tones = options.tones.map(|count| tones::tones(&trace, count)).transpose()?;
        let unknown = vec![f64::NAN; spectrum.axis.len()];
        (spectrum, 1, 1.0, unknown)
    };
    let fmin = options.lowest(spectrum.axis.step().unwrap_or(0.0));
    let (powers, shown) = (powers(&spectrum), spectrum.window);
    let spectrum = in_frequency(&spectrum, options.integrate, fmin)?;
    let left_out = scatter.len() - spectrum.axis.len();
    scatter.drain(..left_out);
    let mut found = SpectralResult::of(Lines::Spectrum(spectrum), options, fmin, traces.findings());
    found.averages = averages;
    found.clear = clear(&found, &powers, left_out, independent, shown);
    found.false_alarms = Some(FALSE_ALARMS);
    found.value_std = found.value.iter().zip(scatter).map(|(v, part)| v * part).collect();
    let cut: Vec<Finding> = cut.into_iter().map(|doubt| doubt.of(&mut found)).collect();
    found.findings.extend(cut);
    found.findings.extend(segments.and_then(|segments| varying(&found, &segments, &powers, left_out, shown)));
    if let Some(tones) = tones {
        found.findings.extend(tones.findings);
        found.tones = tones.tones;
    }
    Ok(found)
}

/// Smallest power of a line over the noise around it, and smallest variation of its power from segment to
/// segment, at which it is said to vary: noise varies the power of such a line by √(2/100).
const VARIES: (f64, f64) = (100.0, 0.3);
/// Fewest segments that tell how a line varies.
const FEWEST: usize = 6;
/// Largest lines that are looked at.
const LARGEST: usize = 3;

/// Caution about the first of the largest lines whose power varies from segment to segment, though it stands
/// high above the noise: two sines beat in it, or it is the resonance of a body that noise excites.
fn varying(
    found: &SpectralResult,
    segments: &Averages,
    powers: &[f64],
    left_out: usize,
    window: Option<Window>,
) -> Option<Finding> {
    if segments.count < FEWEST {
        return None;
    }
    let varies = |k: usize| {
        let line = k + left_out;
        let noise = floor(powers, line, REACH, segments.effective, window)?;
        let variation = segments.variation(line).filter(|variation| *variation > VARIES.1)?;
        (powers[line] > VARIES.0 * noise.power).then_some((found.frequency[k], variation))
    };
    let (frequency, variation) = found.peaks(LARGEST).into_iter().find_map(varies)?;
    let caution = Finding::caution("spectrum-line-varies").number("frequency", frequency);
    Some(caution.number("variation", variation).number("apart", 2.0 * segments.step()))
}

/// Doubts about channels that are clipped at ends of their range. A channel at one end for half of the time
/// or more is not clipped: it has two levels, or rests between pulses.
fn clipped(ranges: &[Rails], traces: &Traces) -> Vec<Doubt> {
    let of = |(range, meta): (&Rails, &Meta)| {
        let ends: Vec<(f64, usize)> = range.clipped(f64::INFINITY).collect();
        let levels = ends.iter().any(|(_, n)| 2 * n >= traces.frames());
        let doubt = |(level, n)| {
            let doubt = Finding::doubt("spectrum-clipped").count("n", n).number("level", level);
            doubt.name("unit", meta.unit.symbol()).about(&meta.name)
        };
        ends.into_iter().filter(|_| !levels).map(doubt).collect::<Vec<Doubt>>()
    };
    ranges.iter().zip(traces.channels()).flat_map(of).collect()
}

/// Marks the lines to list: peaks that are neither noise, nor leakage of a constant, nor on the skirt of a
/// larger one. `powers` are those of all lines; `found` does not have the first `left_out` of them.
fn clear(
    found: &SpectralResult,
    powers: &[f64],
    left_out: usize,
    independent: f64,
    window: Option<Window>,
) -> Vec<bool> {
    let is_more_than_noise = |line: usize, power: f64| {
        let noise = floor(powers, line, REACH, independent, window);
        noise.is_none_or(|noise| noise.is_below(power, independent, powers.len()))
    };
    let of_mean = |line| window.is_some_and(|window| is_of_mean(powers, line, window));
    let lines = left_out..left_out + found.value.len();
    let mut peaks: Vec<usize> = lines
        .filter(|line| {
            found.is_peak(line - left_out) && !of_mean(*line) && is_more_than_noise(*line, powers[*line])
        })
        .collect();
    if let Some(window) = window {
        peaks = above_skirts(peaks, powers, window, is_more_than_noise);
    }
    let mut clear = vec![false; found.value.len()];
    for line in peaks {
        clear[line - left_out] = true;
    }
    clear
}

/// Whether line `k` is leakage of a constant: the line beyond the constant's main lobe has less than half of
/// the amplitude that a sine at `k` would have there.
fn is_of_mean(powers: &[f64], k: usize, window: Window) -> bool {
    let beyond = window.coefficients().len();
    let sine = |line: usize| line_shape(window, (line - k) as f64).powi(2) * powers[k];
    k < beyond && powers.get(beyond).is_some_and(|power| *power < 0.25 * sine(beyond))
}

/// Powers of the lines: amplitudes are squared, power scalings kept.
fn powers(spectrum: &Spectrum) -> Vec<f64> {
    let mut powers = spectrum.values.magnitudes();
    if matches!(spectrum.scaling, Scaling::Peak | Scaling::Rms | Scaling::Unknown) {
        for v in &mut powers {
            *v *= *v;
        }
    }
    powers
}

fn response(
    traces: &mut Traces,
    options: &SpectralOptions,
    estimator: Estimator,
    progress: impl FnMut(usize) + Send,
) -> Result<SpectralResult> {
    let mut cut = Vec::new();
    let (found, step, blows) = if options.hammer {
        let [force, response] = whole(traces, progress)?;
        let (found, length) = of_blows(&force, &response, options, estimator)?;
        let blows = (found.window, found.enbw, found.blows);
        (found.transfer, traces.rate() / length as f64, Some(blows))
    } else {
        let averages = averages(traces, options, progress)?;
        if let Some(crest) = averages.crest(0).filter(|crest| *crest > BLOWS) {
            let why = format!("the force comes in blows (half its span is {crest:.0} times its RMS)");
            return Err(Error::refused(why)
                .hint("take one segment a blow, or cut spikes out")
                .setting("hammer"));
        }
        if averages.count == 1 {
            return Err(Error::refused("one segment only; coherence needs two or more")
                .hint("take a longer record or shorter segments, for ten averages or more")
                .setting("segment"));
        }
        let mut found = transfer(&averages, 1, traces.channels(), estimator)?;
        cut = clipped(&averages.ranges, traces);
        found.frf.meta.step("segments", &[("window", &options.window().name())]);
        (found, averages.step(), None)
    };
    let fmin = options.lowest(step);
    let mut found = found.integrated(options.integrate, fmin)?;
    if let Some(delay) = options.delay {
        // A response late by τ has the factor e^(−iωτ), which is removed.
        for (k, value) in found.frf.values.iter_mut().enumerate() {
            *value *= Complex64::cis(TAU * found.frf.axis.at(k) * delay);
        }
        found.frf.meta.step("delay", &[("seconds", &delay)]);
    }
    let mut result = SpectralResult::of(Lines::Transfer(found), options, fmin, traces.findings());
    let cut: Vec<Finding> = cut.into_iter().map(|doubt| doubt.of(&mut result)).collect();
    result.findings.extend(cut);
    if let Some((window, enbw, blows)) = blows {
        (result.window, result.enbw, result.detrend) = (window, enbw, "level before the blow");
        result.response.iter_mut().for_each(|r| r.blows.clone_from(&blows));
    }
    Ok(result)
}

/// The frequency response function of blows, and the length of their records in samples: as stated, or as
/// long as the response rings and the next blow allows.
fn of_blows(
    force: &Trace,
    response: &Trace,
    options: &SpectralOptions,
    estimator: Estimator,
) -> Result<(BlowTransfer, usize)> {
    // The part of a record before its blow is 1/[`BEFORE`].
    let between = spacing(force)?;
    let longest = between / (BEFORE - 1) * BEFORE;
    let mut length = options.segment.unwrap_or(SEGMENT);
    while options.segment.is_none() && length > longest && length > SHORTEST {
        length /= 2;
    }
    let width = options.force_window.map_or_else(|| force_window(force), Ok)?;
    let of = |length: usize| {
        let before = (length / BEFORE).max(RISE.min(length / 4));
        let (force_window, left_at_end) = (Some(width), options.left_at_end);
        from_blows(force, response, &Blows { length, before, force_window, left_at_end }, estimator)
    };
    let clean = |found: &BlowTransfer| found.blows.iter().filter(|blow| blow.rejected.is_none()).count();
    let rings =
        |found: &BlowTransfer| found.transfer.findings.iter().any(|f| f.code == code::RESPONSE_CUT_OFF);
    let mut found = of(length)?;
    // At last a record from blow to blow, which ends before the next one rises.
    let whole = between / 2 * 2;
    while options.segment.is_none() && rings(&found) && length < whole {
        let more = if 2 * length <= longest { 2 * length } else { whole };
        // A longer record that would lose a blow is not taken.
        let Some(longer) = of(more).ok().filter(|longer| clean(longer) >= clean(&found)) else { break };
        (found, length) = (longer, more);
    }
    Ok((found, length))
}

/// Averages over segments, with cross spectra where a frequency response function is estimated.
fn averages(
    traces: &mut Traces,
    options: &SpectralOptions,
    progress: impl FnMut(usize) + Send,
) -> Result<Averages> {
    let length = options.segment.unwrap_or(SEGMENT.min(traces.frames()));
    let segments = Segments::new(length, options.overlap.unwrap_or(0.5))?;
    let welch = Welch { segments, window: options.window(), detrend: options.detrended() };
    welch.average(traces, options.estimator.is_some(), progress)
}

/// All samples of all channels.
fn whole<const N: usize>(traces: &mut Traces, mut progress: impl FnMut(usize)) -> Result<[Trace; N]> {
    let mut columns = vec![Vec::new(); N];
    while traces.append(&mut columns)? > 0 {
        progress(columns.first().map_or(0, Vec::len));
    }
    let (start, step) = (traces.start(), 1.0 / traces.rate());
    let trace = |(values, meta): (Vec<f64>, &Meta)| Trace {
        meta: meta.clone(),
        axis: Axis::time(start, step, values.len()),
        values,
    };
    let all: Vec<Trace> = columns.into_iter().zip(traces.channels()).map(trace).collect();
    all.try_into().map_err(|all: Vec<Trace>| Error::usage(format!("{} channels", all.len()), N.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;
    use vibro_record::Fact;

    /// Frequencies in Hz of the peaks listed for a sine of amplitude 1 with noise of 0.002: 8 segments of
    /// 256 samples at 256 Hz, with lines 1 Hz apart.
    fn peaks(frequency: f64, window: Window) -> Vec<f64> {
        let mut noise = Noise::new(5);
        let sine = |i: i32| (TAU * frequency * f64::from(i) / 256.0).sin() + 2e-3 * noise.normal();
        let values = (0..2048).map(sine).collect();
        let axis = Axis::time(0.0, 1.0 / 256.0, 2048);
        let trace = Trace { meta: Meta::new("v", Unit::opaque("V")), axis, values };
        let mut traces = Traces::from_memory(vec![trace]).unwrap();
        let options =
            SpectralOptions { segment: Some(256), window: Some(window), ..SpectralOptions::default() };
        let found = spectral(&mut traces, &options, |_| ()).unwrap();
        found.peaks(8).iter().map(|k| found.frequency[*k]).collect()
    }

    /// Two sines half a line apart beat in one line: in 40 segments their power varies by √2ab/(a² + b²) of
    /// its mean, to some hundredths for the phases that the segments happen to see. A single one is steady.
    #[test]
    fn a_line_in_which_two_sines_beat_is_named() {
        let found = |other: f64| {
            let mut noise = Noise::new(7);
            let mut value = |i: i32| {
                let t = f64::from(i) / 256.0;
                (TAU * 40.2 * t).sin() + other * (TAU * 40.7 * t).sin() + 0.05 * noise.normal()
            };
            let values: Vec<f64> = (0..10_240).map(&mut value).collect();
            let axis = Axis::time(0.0, 1.0 / 256.0, values.len());
            let trace = Trace { meta: Meta::new("v", Unit::opaque("V")), axis, values };
            let options = SpectralOptions { segment: Some(256), ..SpectralOptions::default() };
            let found = spectral(&mut Traces::from_memory(vec![trace]).unwrap(), &options, |_| ()).unwrap();
            let varies = found.findings.iter().find(|found| found.code == "spectrum-line-varies");
            varies.map(|found| found.fact("variation").cloned())
        };
        assert_eq!(found(0.0), None);
        let Some(Some(Fact::Number(variation))) = found(0.5) else { panic!("{:?}", found(0.5)) };
        // The line at 40 Hz shows each by the window's shape.
        let (a, b) = (line_shape(Window::Hann, 0.2), 0.5 * line_shape(Window::Hann, 0.7));
        let expected = f64::sqrt(2.0) * a * b / (a * a + b * b);
        assert!((variation - expected).abs() < 0.05 * expected, "{variation} {expected}");
    }

    #[test]
    fn a_mean_that_was_taken_out_is_no_peak_and_a_low_sine_is_one() {
        assert_eq!(peaks(31.4, Window::Hann), [31.0]);
        assert_eq!(peaks(1.0, Window::Hann), [1.0]);
        assert_eq!(peaks(4.0, Window::FlatTop), [4.0]);
    }

    /// Frequencies in Hz of the peaks listed for one record of 1000 samples with noise of 0.01: a sine of
    /// amplitude 1 at line `position`, and one of amplitude `second` 12.3 lines above.
    fn listed(seed: u64, position: f64, second: f64, window: Window) -> Vec<f64> {
        let mut noise = Noise::new(seed);
        let sine = |lines: f64, i: i32| (TAU * lines * f64::from(i) / 1000.0 + 0.3).sin();
        let value = |i: i32| sine(position, i) + second * sine(position + 12.3, i) + 0.01 * noise.normal();
        let values = (0..1000).map(value).collect();
        let axis = Axis::time(0.0, 1e-3, 1000);
        let trace = Trace { meta: Meta::new("v", Unit::opaque("V")), axis, values };
        let mut traces = Traces::from_memory(vec![trace]).unwrap();
        let options = SpectralOptions { window: Some(window), ..SpectralOptions::default() };
        let found = spectral(&mut traces, &options, |_| ()).unwrap();
        found.peaks(8).iter().map(|k| found.frequency[*k]).collect()
    }

    #[test]
    fn noise_on_the_skirt_of_a_sine_is_no_peak_and_a_sine_a_hundredth_as_large_is_one() {
        for window in Window::ALL {
            let alone = (0..300)
                .filter(|seed| listed(*seed, 62.5 - 0.1 * (seed % 10) as f64, 0.0, window).len() != 1);
            let alone = alone.count();
            // At most one in a thousand records shows noise as a line, [`FALSE_ALARMS`]: three in 300 have a
            // chance of 0.4 %.
            assert!(alone <= 3, "{alone} of 300 with more than one peak, {window:?}");
            if window != Window::Rectangular {
                assert_eq!(listed(7, 62.4, 0.02, window), [62.0, 75.0], "{window:?}");
            }
        }
    }
}
