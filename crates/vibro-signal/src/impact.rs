//! Frequency response functions from hammer blows: each record holds the force of one blow and the response
//! that rings down.
//!
//! The force counts only while the hammer touches (force window). A response that still rings when the record
//! ends is weighted down to its end (exponential window, on the force, too). That adds damping by a known
//! amount, which is reported.

mod force;
mod left;

use super::fft::Transform;
use super::rails::Rails;
use super::segment::Segments;
use super::sound::no_gaps;
use super::transfer::{Estimator, Transfer, transfer};
use super::welch::Sums;
use serde::Serialize;
use std::f64::consts::PI;
use vibro_record::lanes;
use vibro_record::units::notation::shortest;
use vibro_record::{Error, Finding, Meta, Result, Trace, median};

/// Trigger level above the quiet level, as a fraction of the largest force: a lower one finds weaker blows,
/// but also noise.
const TRIGGER: f64 = 0.2;
/// Lowest threshold for a second blow, as a fraction of the smoothed peak. Blows of 10 % of the peak exceed
/// it even if noise and filters lower them by 30 %.
const SECOND: f64 = 0.07;
/// A second blow rises from the valley before it by this factor; the flank of one blow, however bent, does
/// not.
const RISE: f64 = 2.0;
/// Threshold for noise in its standard deviations: a sample exceeds 6σ by chance once in 10⁹.
const SIGMAS: f64 = 6.0;
/// A further contact within this time in s is a bounce of the hammer, not a new blow.
const BOUNCE: f64 = 0.1;
/// Least power of the force at a line over the power of its noise (10 dB). A line below it has no response
/// function.
const AUDIBLE: f64 = 10.0;
/// Least distance of a clipping level from the quiet level, as a fraction of the largest deviation. A nearer
/// extreme is the force at rest between blows: a blow does not pull.
const RAIL: f64 = 0.1;

/// Width of the force window where none is stated, in contact times of the longest blow.
const CONTACTS: usize = 10;
/// But at least this number of samples: filters of converters ring for some thirty.
const RINGING: usize = 64;

const CUT_OFF: &str = "the record cuts it off";
const DOUBLE: &str = "double hit";
const OVERLOAD: &str = "overload";

/// How records of single blows are cut out of a long record, and weighted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blows {
    /// Samples in the record of one blow.
    pub length: usize,
    /// Samples of it before the trigger.
    pub before: usize,
    /// Width in s of the force window, from the trigger on; the whole record where `None`.
    pub force_window: Option<f64>,
    /// Weight of the exponential window at the end of the record, e.g. 0.01; no such window where `None`.
    pub left_at_end: Option<f64>,
}

/// One blow.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Blow {
    /// Time in s at which the force passes the trigger.
    pub time: f64,
    /// Largest force, less the quiet level before the blow, in the unit of the force.
    pub peak: f64,
    /// Why the blow was left out; `None` where it counts.
    pub rejected: Option<&'static str>,
    /// First sample of its record.
    #[serde(skip)]
    pub(crate) start: usize,
}

/// A frequency response function from blows.
#[derive(Debug, Clone, PartialEq)]
pub struct BlowTransfer {
    /// The function; the damping that an exponential window adds has not been corrected.
    pub transfer: Transfer,
    /// Every blow.
    pub blows: Vec<Blow>,
    /// Decay in 1/s that the exponential window adds: it raises the damping ratio of a mode at f Hz by this
    /// divided by 2πf.
    pub added_decay: f64,
    /// The windows that were applied: `rectangular` for none, `force`, `exponential`, or `force and
    /// exponential`.
    pub window: &'static str,
    /// Equivalent noise bandwidth of the response's window in spectral lines, NΣw²/(Σw)².
    pub enbw: f64,
}

/// Sampling rate in Hz of a force and its response.
///
/// # Errors
/// Those of [`from_blows`] about the traces and the settings.
fn rate_of(force: &Trace, response: &Trace, how: &Blows) -> Result<f64> {
    let (rate, other, n) = (force.sampling_rate()?, response.sampling_rate()?, force.values.len());
    if rate != other || n != response.values.len() {
        let (rate, other, m) = (shortest(rate), shortest(other), response.values.len());
        let why = format!("the force has {n} samples at {rate} Hz, the response {m} at {other} Hz");
        return Err(Error::refused(why));
    }
    for trace in [force, response] {
        no_gaps(&trace.values, &trace.meta.name, 0)?;
    }
    if how.length < 8 || how.before >= how.length {
        return Err(Error::usage(
            format!("records of {} samples, {} of them before the blow", how.length, how.before),
            "at least 8 samples, and the blow among them",
        ));
    }
    if how.length > n {
        let why = format!("blows of {} samples each in a record of {n} samples", how.length);
        return Err(Error::refused(why).hint("take shorter records, or measure longer"));
    }
    Ok(rate)
}

/// The error where no blow is clean: why each was rejected, and what to change.
///
/// # Errors
/// If the force has no sampling rate.
fn none_clean(blows: &[Blow], force: &Trace, how: &Blows) -> Result<Error> {
    let named = |b: &Blow| b.rejected.map(|why| format!("{:.3} s: {why}", b.time));
    let why: Vec<String> = blows.iter().filter_map(named).take(8).collect();
    let found = format!("0 of {} blows are clean; {}", blows.len(), why.join(", "));
    let refused = |why| blows.iter().all(|b| b.rejected == Some(why));
    let error = Error::refused(found);
    Ok(if refused(OVERLOAD) {
        error.hint("set a larger range of force and response, and strike again")
    } else if how.length > spacing(force)? {
        error.hint("a segment shorter than the time between blows").setting("segment")
    } else {
        error.hint("name the channel of the force; strike once a record").setting("reference")
    })
}

/// Finds the blows in a force, averages those that are clean, and relates the response to the force.
///
/// # Errors
/// If the traces are of different rate or length or shorter than one record of a blow, samples are missing,
/// or no blow is clean.
pub fn from_blows(
    force: &Trace,
    response: &Trace,
    how: &Blows,
    estimator: Estimator,
) -> Result<BlowTransfer> {
    let rate = rate_of(force, response, how)?;
    let blows = find(force, response, how, rate);
    let clean: Vec<&Blow> = blows.iter().filter(|b| b.rejected.is_none()).collect();
    let kept: Vec<usize> = clean.iter().map(|b| b.start).collect();
    if kept.is_empty() {
        return Err(none_clean(&blows, force, how)?);
    }
    let (decay, weights) = windows(how, rate)?;
    let transform = Transform::new(how.length);
    let mut work = [transform.workspace(), transform.workspace()];
    let mut sums = Sums::new(2, true, transform.lines());
    let mut noise = 0.0;
    for start in &kept {
        // Noise from differences of neighbouring samples, which leave out hum and drift. Only the first half
        // of the time before the trigger counts, since a blow begins below the trigger.
        let before = force.values.get(*start..start + how.before / 2).unwrap_or_default();
        let squares: f64 = before.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
        noise += 0.5 * squares / before.len().saturating_sub(1).max(1) as f64 / kept.len() as f64;
        for ((work, weights), trace) in work.iter_mut().zip(&weights).zip([force, response]) {
            let part = trace.values.get(*start..start + how.length).unwrap_or_default();
            // The level before the blow is the zero of this record.
            let level = part[..how.before / 2].iter().sum::<f64>() / (how.before / 2).max(1) as f64;
            work.load(part, level, weights);
            transform.run(work);
        }
        sums.add(&work);
    }
    let apart = Segments { length: how.length, hop: how.length };
    let averages = sums.mean(&vec![1.0; how.length], apart, rate, true);
    let metas: [Meta; 2] = [force.meta.clone(), response.meta.clone()];
    let mut transfer = transfer(&averages, 1, &metas, estimator)?;
    // H1 weights each blow by the square of its force.
    let [delays, squares] = clean.iter().fold([0.0; 2], |[delays, squares], blow| {
        [delays + blow.peak * blow.peak * force::delay(force, blow, how), squares + blow.peak * blow.peak]
    });
    let after = ((how.length - how.before) as f64 - delays / squares) / rate;
    let variance = force::variance(&averages.auto[0], averages.step());
    let apart = blows.windows(2).map(|pair| pair[1].time - pair[0].time).fold(f64::INFINITY, f64::min);
    let sample = rate.recip();
    let noise = noise * weights[0].iter().map(|w| w * w).sum::<f64>();
    let scatter = (0.5 * noise / (kept.len() as f64 * averages.auto[0][1])).sqrt();
    transfer.frf.meta.step(
        "blows",
        &[
            ("count", &kept.len()),
            ("length", &how.length),
            ("before", &how.before),
            ("after", &after),
            ("apart", &apart),
            ("variance", &variance),
            ("sample", &sample),
            ("scatter", &scatter),
        ],
    );
    let left = left::widen(&mut transfer, &response.values, &kept, how, &weights[1]);
    let force = &averages.auto[0];
    transfer.silence(|k| force[k + 1] <= AUDIBLE * noise, Finding::caution("frf-not-excited"));
    if let Some([_, mode]) = left.filter(|[_, mode]| mode.part > 0.0) {
        let after = (how.length - how.before) as f64 / rate;
        let hidden = mode.hidden(&transfer.frf, force, after);
        let found = Finding::caution("frf-end-hides").number("mode", transfer.frf.axis.at(mode.line));
        transfer.silence(|k| hidden[k], found);
    }
    transfer.findings.extend(left_out(&blows));
    transfer.findings.extend((kept.len() == 1).then(|| Finding::caution("frf-one-blow")));
    let cut_off = left.and_then(|[left, _]| left.finding(&transfer));
    transfer.findings.extend(cut_off);
    if decay > 0.0 {
        let ratio = decay / (2.0 * PI);
        let added = Finding::caution("window-adds-decay").number("decay", decay).number("ratio", ratio);
        transfer.findings.push(added);
        transfer.frf.meta.step("exponential_window", &[("decay", &decay)]);
    }
    let [sum, squares] = weights[1].iter().fold([0.0, 0.0], |[s, q], w| [s + w, q + w * w]);
    Ok(BlowTransfer {
        transfer,
        blows,
        added_decay: decay,
        window: ["rectangular", "force", "exponential", "force and exponential"]
            [usize::from(how.force_window.is_some()) + 2 * usize::from(how.left_at_end.is_some())],
        enbw: how.length as f64 * squares / (sum * sum),
    })
}

/// Longest record in samples that holds a single blow: the shortest interval between blows, or from the last
/// blow to the end.
///
/// The samples after the last blow count unless they are fewer than half of those between blows.
///
/// # Errors
/// If the force has no sampling rate.
pub fn spacing(force: &Trace) -> Result<usize> {
    let bounce = (BOUNCE * force.sampling_rate()?) as usize;
    let values = &force.values;
    let above = triggered(values);
    let begins: Vec<usize> = (0..above.len()).filter(|i| above[*i] && (*i == 0 || !above[i - 1])).collect();
    let between = begins.windows(2).map(|w| w[1] - w[0]).filter(|gap| *gap > bounce).min();
    let behind = values.len() - begins.last().copied().unwrap_or(0);
    Ok(match between {
        Some(gap) if behind < gap / 2 => gap,
        Some(gap) => gap.min(behind),
        None => behind,
    })
}

/// Width in s of a force window for the blows of a force: no blow lasts longer.
///
/// Force sensors are noisy, and a record is long: without a window a line shows the noise of all samples.
///
/// # Errors
/// If the force has no sampling rate.
pub fn force_window(force: &Trace) -> Result<f64> {
    let runs = triggered(&force.values);
    let contact = runs.split(|above| !above).map(<[bool]>::len).max().unwrap_or(0);
    Ok((CONTACTS * contact).max(RINGING) as f64 / force.sampling_rate()?)
}

/// Which samples of a force are above the trigger.
fn triggered(values: &[f64]) -> Vec<bool> {
    let rest = Quiet::of(values);
    let push = values.iter().map(|v| v - rest.level);
    let extreme = push.clone().fold(0.0f64, |m, v| if v.abs() > m.abs() { v } else { m });
    push.map(|v| v * extreme.signum() > TRIGGER * extreme.abs()).collect()
}

/// The finding that blows are left out, counted by reason; `None` where all count.
fn left_out(blows: &[Blow]) -> Option<Finding> {
    let count = |why| blows.iter().filter(|b| b.rejected == Some(why)).count();
    let reasons = [("double", DOUBLE), ("overload", OVERLOAD), ("cut_off", CUT_OFF)];
    let counts = reasons.map(|(name, why)| (name, count(why))).into_iter().filter(|(_, n)| *n > 0);
    let all = Finding::caution("blows-left-out").count("all", blows.len());
    let found = counts.fold(all, |found, (name, n)| found.count(name, n));
    blows.iter().any(|b| b.rejected.is_some()).then_some(found)
}

/// All blows of a force.
fn find(force: &Trace, response: &Trace, how: &Blows, rate: f64) -> Vec<Blow> {
    let values = &force.values;
    // Blows are short: the median of the force is its zero, whatever offset the amplifier adds.
    let rest = Quiet::of(values);
    let zero = rest.level;
    let extreme = values.iter().map(|v| v - zero).fold(0.0f64, |m, v| if v.abs() > m.abs() { v } else { m });
    let sign = if extreme < 0.0 { -1.0 } else { 1.0 };
    let trigger_level = TRIGGER * extreme.abs();
    let smooth = smoothed(values);
    let smooth_rest = Quiet::of(&smooth);
    let channels = [values, &response.values];
    let mut rails = [Vec::new(), Vec::new()];
    let (mut found, mut i) = (Vec::new(), 0);
    while i < values.len() {
        if sign * (values[i] - zero) <= trigger_level {
            i += 1;
            continue;
        }
        let (trigger, end) = (i, i.saturating_add(how.length - how.before).min(values.len()));
        let start = trigger.saturating_sub(how.before);
        // The zero may drift from blow to blow.
        let quiet = if trigger > start { Quiet::of(&values[start..trigger]) } else { rest };
        let peak = values[trigger..end].iter().map(|v| sign * (v - quiet.level)).fold(0.0, f64::max);
        let second = second(&smooth[start..end], trigger - start, sign, smooth_rest.sigma);
        for (channel, rails) in channels.iter().zip(&mut rails) {
            rails.extend(overloaded(&channel[start..end], trigger - start));
        }
        let cut_off = trigger < how.before || end - trigger < how.length - how.before;
        let rejected = cut_off.then_some(CUT_OFF).or(second.then_some(DOUBLE));
        let time = force.axis.start() + trigger as f64 / rate;
        found.push(Blow { time, peak: sign * peak, rejected, start });
        i = end.max(trigger + 1);
    }
    // A sample at a value where any blow was clipped is clipped, even where it is alone.
    for blow in &mut found {
        let reaches = |(channel, rails): (&&Vec<f64>, &Vec<f64>)| {
            let part = lanes::survey(&channel[blow.start..blow.start + how.length]);
            rails.iter().any(|rail| *rail == part.low || *rail == part.high)
        };
        if blow.rejected.is_none() && channels.iter().zip(&rails).any(reaches) {
            blow.rejected = Some(OVERLOAD);
        }
    }
    found
}

/// The force averaged with a Hann window of eight samples. It reduces the ringing of filters near the end of
/// the band by 18 dB above a fifth of the sampling rate and by 31 dB above a quarter, but not a blow, whose
/// force has one sign.
fn smoothed(values: &[f64]) -> Vec<f64> {
    let weights: [f64; 7] = std::array::from_fn(|k| 0.25 * (PI * (k + 1) as f64 / 8.0).sin().powi(2));
    let last = values.len().saturating_sub(1);
    let at = |i: usize| {
        weights.iter().enumerate().map(|(k, w)| w * values[(i + k).saturating_sub(3).min(last)]).sum()
    };
    (0..values.len()).map(at).collect()
}

/// Whether a smoothed force rises again before or after its largest blow; the first `before` of `values` are
/// quiet.
fn second(values: &[f64], before: usize, sign: f64, noise: f64) -> bool {
    let quiet = Quiet::of(if before > 0 { &values[..before] } else { values });
    let push = |j: usize| sign * (values[j] - quiet.level);
    let Some(top) = (before..values.len()).max_by(|a, b| push(*a).total_cmp(&push(*b))) else { return false };
    let peak = push(top);
    // Smoothed, a blow of few samples may lie below the level before it.
    if peak.is_nan() || peak <= 0.0 {
        return false;
    }
    let level = (SIGMAS * noise.max(quiet.sigma)).clamp(SECOND * peak, TRIGGER * peak);
    let rises = |mut side: Box<dyn Iterator<Item = usize>>| {
        let mut valley = peak;
        side.any(|j| {
            valley = valley.min(push(j));
            push(j) > level.max(RISE * valley)
        })
    };
    rises(Box::new(top..values.len())) || rises(Box::new((before..top).rev()))
}

/// Level and noise of values of which most are quiet.
#[derive(Clone, Copy)]
struct Quiet {
    level: f64,
    sigma: f64,
}

impl Quiet {
    /// Median, and the standard deviation of a normal distribution with the same median absolute deviation.
    fn of(values: &[f64]) -> Quiet {
        let level = median(values);
        Quiet { level, sigma: 1.4826 * median(values.iter().map(|v| (v - level).abs())) }
    }
}

/// The value at which a record is clipped, its highest or its lowest; the first `before` of `values` are
/// quiet. Highest and lowest value are judged separately: with an offset, a signal clips at one of them
/// first.
fn overloaded(values: &[f64], before: usize) -> Option<f64> {
    let level = Quiet::of(if before > 0 { &values[..before] } else { values }).level;
    let mut rails = Rails::default();
    rails.extend(values);
    let reach = rails.range().map(|end| (end - level).abs()).into_iter().fold(0.0, f64::max);
    rails.clipped(reach).map(|(rail, _)| rail).find(|rail| (rail - level).abs() > RAIL * reach)
}

/// Decay of the exponential window in 1/s, and the weights of force and response.
fn windows(how: &Blows, rate: f64) -> Result<(f64, [Vec<f64>; 2])> {
    let after = (how.length - how.before) as f64 / rate;
    let outside = |value: Option<f64>, most: f64| value.filter(|v| !(*v > 0.0 && *v <= most));
    if let Some(left) = outside(how.left_at_end, 1.0) {
        return Err(Error::usage(format!("an exponential window that leaves {left}"), "above 0 to 1"));
    }
    if let Some(width) = outside(how.force_window, f64::INFINITY) {
        return Err(Error::usage(format!("a force window of {width} s"), "a width above 0"));
    }
    let decay = how.left_at_end.map_or(0.0, |left| -left.ln() / after);
    let width = how.force_window.unwrap_or(f64::INFINITY);
    let exponential: Vec<f64> =
        (0..how.length).map(|i| (-decay * (i as f64 - how.before as f64).max(0.0) / rate).exp()).collect();
    let force = exponential.iter().enumerate().map(|(i, weight)| {
        let t = (i as f64 - how.before as f64) / rate;
        // It falls over a quarter of its width, so that the window itself rings little.
        let down = if width.is_finite() { ((t - width) / (0.25 * width)).clamp(0.0, 1.0) } else { 0.0 };
        weight * 0.5 * (1.0 + (PI * down).cos())
    });
    Ok((decay, [force.collect(), exponential]))
}

#[cfg(test)]
mod tests;
