//! Frequency response functions from hammer blows: one record a blow, of the force and of the response that
//! rings down.
//!
//! The force counts only while the hammer touches (force window); a response that has not died away when the
//! record ends is made to (exponential window, on the force, too). That adds damping, by an amount that is
//! known and reported.

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

/// Part of the largest force, above the level before it, at which a blow is noticed.
const TRIGGER: f64 = 0.2;
/// A second blow from this part of the smoothed peak on: from a tenth, where noise and filters take less than
/// a third of it.
const SECOND: f64 = 0.07;
/// A second blow rises from a valley by this factor; the flank of a blow, however bent, does not.
const RISE: f64 = 2.0;
/// Standard deviations of the noise that no sample of a record reaches by chance: 1 in 10⁹.
const SIGMAS: f64 = 6.0;
/// A hammer that bounces does so within this time in s; nobody strikes again so soon.
const BOUNCE: f64 = 0.1;
/// A force that stands less than this factor (10 dB) above its noise tells nothing of the response to it.
const AUDIBLE: f64 = 10.0;
/// An extreme nearer the quiet level than this part of the other one is no rail: a force does not go below
/// zero.
const RAIL: f64 = 0.1;

const CUT_OFF: &str = "the record cuts it off";
const DOUBLE: &str = "double hit";
const OVERLOAD: &str = "overload";

/// How blows are taken out of a long record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blows {
    /// Samples of one record.
    pub length: usize,
    /// Samples before the blow.
    pub before: usize,
    /// Width in s of the force window from the blow on; the whole record where `None`.
    pub force_window: Option<f64>,
    /// What the exponential window leaves at the end of the record, e.g. 0.01; none where `None`.
    pub left_at_end: Option<f64>,
}

/// One blow.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Blow {
    /// Time in s at which the force passes the trigger.
    pub time: f64,
    /// Largest force.
    pub peak: f64,
    /// Why it was left out; `None` where it counts.
    pub rejected: Option<&'static str>,
    /// First sample of its record.
    #[serde(skip)]
    pub(crate) start: usize,
}

/// A function from blows.
#[derive(Debug, Clone, PartialEq)]
pub struct BlowTransfer {
    /// The function; an exponential window has not been corrected for.
    pub transfer: Transfer,
    /// Every blow.
    pub blows: Vec<Blow>,
    /// Decay in 1/s that the exponential window adds: a mode of f Hz seems to have a damping ratio that is
    /// this over 2πf larger.
    pub added_decay: f64,
    /// The windows that were applied: `rectangular` for none, `force`, `exponential`, or `force and
    /// exponential`.
    pub window: &'static str,
    /// Equivalent noise bandwidth in lines of the response's window, NΣw²/(Σw)².
    pub enbw: f64,
}

/// Sampling rate in Hz of a force and its response.
///
/// # Errors
/// Those of [`from_blows`] that its traces and its settings have before a blow is found.
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

/// What to say where no blow is clean.
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
    let kept: Vec<usize> = blows.iter().filter(|b| b.rejected.is_none()).map(|b| b.start).collect();
    if kept.is_empty() {
        return Err(none_clean(&blows, force, how)?);
    }
    let (decay, weights) = windows(how, rate)?;
    let transform = Transform::new(how.length);
    let mut work = [transform.workspace(), transform.workspace()];
    let mut sums = Sums::new(2, true, transform.lines());
    let mut noise = 0.0;
    for start in &kept {
        // Steps from sample to sample: hum and drift before the blow are no noise of all lines. A blow begins
        // below the trigger.
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
    transfer.frf.meta.step("blows", &[("length", &how.length), ("before", &how.before)]);
    let floor = AUDIBLE * noise * weights[0].iter().map(|w| w * w).sum::<f64>();
    transfer.silence(&averages.auto[0], floor);
    transfer.findings.extend(left_out(&blows));
    transfer.findings.extend((kept.len() == 1).then(|| Finding::caution("frf-one-blow")));
    left::widen(&mut transfer, &response.values, &kept, how, &weights[1]);
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

/// Samples from a blow to the next, or from the last one to the end of the record: what a record that holds
/// one blow alone may have.
///
/// What is behind the last blow counts where it is not much shorter than what is behind the others.
///
/// # Errors
/// If the force has no sampling rate.
pub fn spacing(force: &Trace) -> Result<usize> {
    let bounce = (BOUNCE * force.sampling_rate()?) as usize;
    let values = &force.values;
    let rest = Quiet::of(values);
    let push = values.iter().map(|v| v - rest.level);
    let extreme = push.clone().fold(0.0f64, |m, v| if v.abs() > m.abs() { v } else { m });
    let above: Vec<bool> = push.map(|v| v * extreme.signum() > TRIGGER * extreme.abs()).collect();
    let begins: Vec<usize> = (0..above.len()).filter(|i| above[*i] && (*i == 0 || !above[i - 1])).collect();
    let between = begins.windows(2).map(|w| w[1] - w[0]).filter(|gap| *gap > bounce).min();
    let behind = values.len() - begins.last().copied().unwrap_or(0);
    Ok(match between {
        Some(gap) if behind < gap / 2 => gap,
        Some(gap) => gap.min(behind),
        None => behind,
    })
}

/// How many blows are left out, and why.
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
    // Blows are short: what the force is most of the time is its zero, whatever the amplifier adds.
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
        // The zero may wander from blow to blow.
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
    // One sample at the value where any blow was clipped is clipped as well.
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

/// Samples of the force, averaged with the Hann window of eight: what a filter near the end of the band rings
/// with, above a fifth of the rate, is 18 dB down there and above a quarter 31 dB, and a blow is not, whose
/// force has one sign.
fn smoothed(values: &[f64]) -> Vec<f64> {
    let weights: [f64; 7] = std::array::from_fn(|k| 0.25 * (PI * (k + 1) as f64 / 8.0).sin().powi(2));
    let last = values.len().saturating_sub(1);
    let at = |i: usize| {
        weights.iter().enumerate().map(|(k, w)| w * values[(i + k).saturating_sub(3).min(last)]).sum()
    };
    (0..values.len()).map(at).collect()
}

/// Whether a smoothed force, quiet in its first `before` samples, rises again behind its largest blow or
/// before it.
fn second(values: &[f64], before: usize, sign: f64, noise: f64) -> bool {
    let quiet = Quiet::of(if before > 0 { &values[..before] } else { values });
    let push = |j: usize| sign * (values[j] - quiet.level);
    let Some(top) = (before..values.len()).max_by(|a, b| push(*a).total_cmp(&push(*b))) else { return false };
    let peak = push(top);
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

/// Level and noise of samples of which most are quiet.
#[derive(Clone, Copy)]
struct Quiet {
    level: f64,
    sigma: f64,
}

impl Quiet {
    /// Median, and the standard deviation of the normal distribution that has the same median deviation.
    fn of(values: &[f64]) -> Quiet {
        let level = median(values);
        Quiet { level, sigma: 1.4826 * median(values.iter().map(|v| (v - level).abs())) }
    }
}

/// The highest or lowest value of a record, quiet in its first `before` samples, where it stays there: each
/// rail on its own, since an offset takes a signal to one of them first.
fn overloaded(values: &[f64], before: usize) -> Option<f64> {
    let level = Quiet::of(if before > 0 { &values[..before] } else { values }).level;
    let mut rails = Rails::default();
    rails.extend(values);
    let reach = rails.range().map(|end| (end - level).abs()).into_iter().fold(0.0, f64::max);
    rails.clipped(reach).map(|(rail, _)| rail).find(|rail| (rail - level).abs() > RAIL * reach)
}

/// Decay in 1/s, and the weights of force and response.
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
        // A quarter of its width to come down, so that the window itself rings little.
        let down = if width.is_finite() { ((t - width) / (0.25 * width)).clamp(0.0, 1.0) } else { 0.0 };
        weight * 0.5 * (1.0 + (PI * down).cos())
    });
    Ok((decay, [force.collect(), exponential]))
}

#[cfg(test)]
mod tests;
