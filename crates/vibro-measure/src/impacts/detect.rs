//! Detects the impacts of a trace: bursts above the noise, timed to less than a sample.

use super::background::{Background, background, bursts};
use super::bands::within;
use super::onset::PulseShape;
use super::onset::{Onsets, onsets};
use super::rises::{largest, rises};
use super::{Hum, hum};
use crate::Estimate;
use crate::swings::{Swings, are_close};
use std::cmp::Ordering;
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;
use vibro_record::units::Quantity;
use vibro_record::units::notation::{counted, quantity, shortest};
use vibro_record::{Doubt, Error, Finding, Result, Trace, median};
use vibro_signal::envelope::envelope;

/// Least height of an impact divided by the median height of all bursts.
const THRESHOLD: f64 = 0.125;
/// The assumed decay of the ringing must be able to change by this factor without changing the number of
/// impacts.
const STABLE: f64 = 2.0;
/// Standard deviations of the noise by which the median height must exceed the noise limit. At 3, noise
/// hides one impact of median height in 740 (normal distribution); below 3, more.
const LOST: f64 = 3.0;
/// A trace is inverted where the median depth of its pulses exceeds their median height by this factor.
const INVERTED: f64 = 1.2;

/// Impacts of a trace: when and how high.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Detected {
    /// Times of the impacts in s; two at least.
    pub times: Vec<f64>,
    /// Heights over the background, in the unit of the trace.
    pub heights: Vec<f64>,
    /// Standard uncertainty of one time from the noise of the trace, in s (the median).
    pub onset_std: Option<f64>,
    /// Mains hum that was removed.
    pub hum: Option<Hum>,
    /// Duration of a contact in s; only of a trace that returns from each impact without swinging to the
    /// other side, as a force does.
    pub contact: Option<Estimate>,
    /// Changes made to the trace.
    pub findings: Vec<Finding>,
    /// Doubts that all impacts were found, about every number computed from them.
    pub doubts: Vec<Doubt>,
    /// How the impacts were timed.
    pub(super) method: &'static str,
    /// Timing resolution in s: one sampling interval if the flanks are shorter than that; `None` if samples
    /// on the flanks time the onset.
    pub(super) resolution: Option<f64>,
}

/// Finds the impacts of a trace.
///
/// # Errors
/// Where the trace has no sampling rate, missing or equal values, or fewer than two impacts; on impossible
/// options.
pub fn detect(trace: &Trace, options: &ImpactsOptions) -> Result<Detected> {
    detect_among(trace, options, None)
}

/// Selects the impacts among sounds in the order of time, given the noise limit and the median height in the
/// unit of the trace. Returns the indices of the impacts, and findings.
pub type Choose<'a> = &'a dyn Fn(&[Sound], f64, f64) -> Result<(Vec<usize>, Vec<Finding>)>;

/// A sound that may be an impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sound {
    /// When it begins, in s.
    pub time: f64,
    /// Its largest distance from the background, in the unit of the trace.
    pub height: f64,
}

/// As [`detect`]. With `choose`, every sudden rise is a candidate, and `choose` selects the impacts.
pub(crate) fn detect_among(
    trace: &Trace,
    options: &ImpactsOptions,
    choose: Option<Choose<'_>>,
) -> Result<Detected> {
    let rate = check(trace, options)?;
    let unit = trace.meta.unit.symbol();
    // Only a force or a voltage (switch or sensor) shows the contact itself. An envelope or a sound level
    // has one sign, too, but lasts longer than the contact.
    let is_force = matches!(trace.meta.quantity, Quantity::Force | Quantity::Voltage) && !options.envelope;
    let mut findings = Vec::new();
    let (mut values, quiet, hum) = cleared(trace, options, rate, &mut findings)?;
    let pause = options.refractory.map(|s| ((s * rate) as usize).max(1));
    let (mut bursts, stable) = match choose.filter(|_| pause.is_none()) {
        Some(_) => (rises(&values, quiet.reach, rate), None),
        None => bursts(&values, quiet.reach, pause),
    };
    findings.extend(turned_upright(&mut values, &bursts));
    let all = match choose {
        Some(_) => bursts.iter().map(|b| largest(&values[b.clone()])).collect(),
        None => heights(&values, &bursts, 1.0),
    };
    let least = (options.threshold.unwrap_or(THRESHOLD) * median(&all)).max(quiet.reach);
    let mut high = all.iter().map(|h| *h > least);
    bursts.retain(|_| high.next() == Some(true));
    let low = all.len() - bursts.len();
    let ignored = Finding::note("low-bursts-ignored").count("n", low).number("level", least);
    findings.extend((low > 0).then(|| ignored.name("unit", unit)));
    // Refuses a vibration. An envelope does not oscillate and is not checked. With `choose`, filtered
    // values are not checked either: the unfiltered record was checked before.
    let swings =
        !options.envelope && if choose.is_none() { are_close(&bursts) } else { options.band.is_none() };
    if swings && let Some(swings) = Swings::of(&values, rate, &bursts, quiet.reach) {
        return Err(swings.refusal());
    }
    if let Some(choose) = choose {
        let time = |b: &Range<usize>| trace.axis.start() + b.start as f64 / rate;
        let high = all.iter().copied().filter(|h| *h > least);
        let sounds: Vec<Sound> =
            bursts.iter().zip(high).map(|(b, height)| Sound { time: time(b), height }).collect();
        let (chosen, said) = choose(&sounds, quiet.reach, median(&all))?;
        bursts = chosen.into_iter().map(|i| bursts[i].clone()).collect();
        findings.extend(said);
    }
    findings.extend(ringing(&bursts, stable));
    let doubts = lost(&values, &bursts, &quiet).into_iter().collect();
    let shape = options.shape.as_ref().map(|pulse| recorded(pulse, rate)).transpose()?;
    let Onsets { each, method, sharp } = onsets(&values, &bursts, quiet.sigma, shape.as_ref());
    if each.len() < 2 {
        let joined = pause.is_some() && self::bursts(&values, quiet.reach, None).0.len() > 1;
        return Err(too_few(
            each.len(),
            &values,
            (quiet.reach, unit),
            low > 0,
            joined,
            options.band.is_some(),
        ));
    }
    let mut std = median(each.iter().map(|o| o.std)) / rate;
    if sharp {
        // An onset anywhere within a sample has a uniform distribution (JCGM 100:2008, 4.3.7).
        let within = 1.0 / (12f64.sqrt() * rate);
        findings.push(Finding::caution("onset-within-sample").number("std", within));
        std = std.hypot(within);
        findings.extend(chatter(&values, &bursts, rate).filter(|_| pause.is_none()));
    }
    Ok(Detected {
        times: each.iter().map(|o| trace.axis.start() + o.time / rate).collect(),
        heights: each.iter().map(|o| o.height).collect(),
        onset_std: Some(std).filter(|s| s.is_finite()),
        hum,
        contact: if is_force { contact(&values, &bursts, &quiet, rate) } else { None },
        findings,
        doubts,
        method,
        resolution: sharp.then_some(1.0 / rate),
    })
}

/// Turns values upright whose pulses point down.
pub(super) fn turned_upright(values: &mut [f64], bursts: &[Range<usize>]) -> Option<Finding> {
    if median(heights(values, bursts, -1.0)) <= INVERTED * median(heights(values, bursts, 1.0)) {
        return None;
    }
    for v in values {
        *v = -*v;
    }
    Some(Finding::note("pulses-inverted"))
}

/// Caution on bursts whose number depends on their ringing. `stable` is the factor by which the assumed decay
/// may change without another number of bursts.
fn ringing(bursts: &[Range<usize>], stable: Option<f64>) -> Option<Finding> {
    let factor = stable.filter(|s| *s < STABLE && bursts.len() > 1)?;
    Some(Finding::caution("count-depends-on-ringing").number("factor", factor))
}

/// Doubt where noise may hide impacts.
fn lost(values: &[f64], bursts: &[Range<usize>], quiet: &Background) -> Option<Doubt> {
    let above = (median(heights(values, bursts, 1.0)) - quiet.reach) / quiet.sigma;
    (above < LOST).then(|| Finding::doubt("impacts-lost-in-noise").number("sigmas", above))
}

/// The values, filtered to their band and without mains hum and background level, or the envelope of these;
/// the background of the noise; the removed hum.
pub(super) fn cleared(
    trace: &Trace,
    options: &ImpactsOptions,
    rate: f64,
    findings: &mut Vec<Finding>,
) -> Result<(Vec<f64>, Background, Option<Hum>)> {
    let mut values = banded(trace, options, rate)?;
    let unit = trace.meta.unit.symbol();
    let hum = if options.keep_hum { None } else { hum::remove(&mut values, (rate, unit), findings) };
    let mut quiet = background(&values);
    let zeroed = |values: &mut [f64], level: f64| values.iter_mut().for_each(|v| *v -= level);
    zeroed(&mut values, quiet.level);
    if options.envelope {
        values = envelope(&values);
        let width = options.band.map_or(0.5 * rate, |(low, high)| high.min(0.5 * rate) - low);
        quiet = quiet.of_envelope(&values, rate / width);
        zeroed(&mut values, quiet.level);
    }
    Ok((values, quiet, hum))
}

/// Error for fewer than two impacts above the noise limit. The hint depends on whether bursts were ignored
/// as too low (`lower`), a shorter pause separates more (`joined`), or a band is chosen already (`banded`).
fn too_few(
    n: usize,
    values: &[f64],
    (reach, unit): (f64, &str),
    lower: bool,
    joined: bool,
    banded: bool,
) -> Error {
    let highest = values.iter().fold(0.0f64, |h, v| h.max(v.abs()));
    let [noise, highest] = [reach, highest].map(|v| quantity(v, unit, 3));
    let why = format!(
        "{} found, an interval needs two: an impact must exceed {noise}, the trace reaches {highest}",
        counted(n, "impact")
    );
    let refused = Error::refused(why);
    let hidden = if banded {
        "another band: a spectrum shows where the impacts ring"
    } else {
        "a band in which the impacts ring, above hum and slow levels: a spectrum shows it"
    };
    match (lower, joined) {
        (true, _) => refused.hint("a lower threshold, as lower bursts were ignored").setting("threshold"),
        (false, true) => refused.hint("a shorter pause").setting("refractory"),
        (false, false) => refused.hint(hidden).setting("band"),
    }
}

/// A pulse lasts as long as it exceeds this fraction of its height, or the noise limit where that is higher.
const FOOT: f64 = 0.1;
/// A pulse that swings back by this fraction of its height rings, and is no contact force.
const BACK: f64 = 0.2;

/// Duration of an impact in s, the median of all. A pulse that exceeds the fraction p of its height for a
/// time w lasts w if its flanks are steep, and πw/(π − 2 asin p) if it is a half-sine; the truth is anywhere
/// between. Slow impacts of round bodies last longer, so the range of all durations widens the uncertainty
/// as a uniform distribution.
fn contact(values: &[f64], bursts: &[Range<usize>], quiet: &Background, rate: f64) -> Option<Estimate> {
    let bounds = |burst: &Range<usize>| {
        let peak = burst.clone().max_by(|a, b| values[*a].total_cmp(&values[*b]))?;
        let height = values[peak];
        let level = (FOOT * height).max(quiet.reach);
        let under = |i: &usize| values[*i] < level;
        let (before, behind) = ((0..peak).rev().find(under)?, (peak..values.len()).find(under)?);
        let width = behind - 1 - before;
        let beside = before.saturating_sub(width)..(behind + width).min(values.len());
        let rings = values[beside].iter().any(|v| *v < -(BACK * height).max(quiet.reach));
        let cross = |out: usize, on: usize| (level - values[out]) / (values[on] - values[out]);
        // A pulse begins and ends between samples. At its foot the flank lies below the straight line between
        // two samples, so that line gives the longest duration.
        let inner = (width as f64 - 1.0) / rate;
        let outer = inner + (2.0 - cross(before, before + 1) - cross(behind, behind - 1)) / rate;
        let half = 1.0 - (level / height).min(1.0).asin() / FRAC_PI_2;
        (level < 0.5 * height && !rings).then_some((inner, outer / half))
    };
    let all: Vec<(f64, f64)> = bursts.iter().filter_map(bounds).collect();
    if 2 * all.len() <= bursts.len() {
        return None;
    }
    let [least, most] = [0, 1].map(|k| median(all.iter().map(|b| [b.0, b.1][k])));
    let (short, long) =
        all.iter().fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), c| (a.min(c.0), b.max(c.0)));
    let std = (most - least).hypot(long - short) / 12f64.sqrt();
    Some(Estimate::new(0.5 * (least + most), Some(std), "s", all.len(), "time above a tenth of the height"))
}

/// A contact is open below this fraction of its height.
const OPEN: f64 = 0.2;
/// A contact is closed above this fraction of its height.
const CLOSED: f64 = 0.8;

/// Finding on switching contacts, which have two levels, that open and close again within an impact. A burst
/// that swings below the background is ringing, and does not count.
fn chatter(values: &[f64], bursts: &[Range<usize>], rate: f64) -> Option<Finding> {
    let again = |burst: &Range<usize>| {
        let values = &values[burst.start.saturating_sub(1)..burst.end];
        let high = values.iter().copied().fold(0.0, f64::max);
        if values.iter().any(|v| *v < -OPEN * high) {
            return None;
        }
        let (mut open, mut closings) = (true, Vec::new());
        for (i, v) in values.iter().enumerate() {
            if open && *v > CLOSED * high {
                closings.push(i);
            }
            open = *v < OPEN * high || open && *v < CLOSED * high;
        }
        let (first, last) = (closings.first()?, closings.last()?);
        (last > first).then(|| (last - first) as f64 / rate)
    };
    let longest: Vec<f64> = bursts.iter().filter_map(again).collect();
    let found = Finding::note("contact-chatter").count("n", longest.len()).count("all", bursts.len());
    let within = longest.iter().copied().fold(0.0, f64::max);
    (!longest.is_empty()).then(|| found.number("within", within))
}

/// The values, zero-phase filtered to the band of the options.
fn banded(trace: &Trace, options: &ImpactsOptions, rate: f64) -> Result<Vec<f64>> {
    if let Some((low, high)) = options.band {
        if low.partial_cmp(&high) != Some(Ordering::Less) {
            return Err(Error::usage(format!("a band from {low} to {high} Hz"), "LO:HI in Hz, LO below HI")
                .hint("the lower limit first")
                .setting("band"));
        }
        return within(&trace.values, (low, high), rate);
    }
    Ok(trace.values.clone())
}

/// The shape of a recorded pulse, for a trace of this sampling rate in Hz.
fn recorded(pulse: &Trace, rate: f64) -> Result<PulseShape> {
    let own = pulse.sampling_rate().map_err(|error| error.setting("shape_rate"))?;
    PulseShape::recorded(&pulse.values, rate / own).ok_or_else(|| {
        let name = &pulse.meta.name;
        Error::refused(format!("{name:?} is no shape of a pulse: its samples have no rising flank"))
            .hint("cut the record to one pulse with its level before it, without missing values")
    })
}

/// Largest value of each burst, or of its negative with a `sign` of −1; at least 0.
pub(super) fn heights(values: &[f64], bursts: &[Range<usize>], sign: f64) -> Vec<f64> {
    bursts.iter().map(|b| values[b.clone()].iter().map(|v| sign * v).fold(0.0, f64::max)).collect()
}

/// How impacts are found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ImpactsOptions {
    /// Least height of an impact over the median height. Default 1/8.
    pub threshold: Option<f64>,
    /// Shortest pause in s between two impacts. Default: from the pauses of the trace.
    pub refractory: Option<f64>,
    /// Band in Hz to which the trace is first filtered, with zero phase. Default: no filter.
    pub band: Option<(f64, f64)>,
    /// Whether impacts are searched in the envelope, which joins the swings of a ringing structure. Default
    /// false.
    pub envelope: bool,
    /// Whether mains hum stays in the trace. Default: it is removed.
    pub keep_hum: bool,
    /// One recorded pulse, whose shape all pulses have. Default: the average of the pulses.
    pub shape: Option<Trace>,
    /// True if the impacts are known to be complete: every interval counts as one, even if intervals are
    /// uneven. Default false.
    pub complete: bool,
    /// Frequency of the excitation in Hz, for impacts per cycle.
    pub excitation: Option<f64>,
    /// Samples of a channel that rises once a cycle of the excitation, recorded with the trace.
    pub reference: Option<Vec<f64>>,
}

/// Checks options and trace. Returns the sampling rate in Hz.
pub(super) fn check(trace: &Trace, options: &ImpactsOptions) -> Result<f64> {
    let rate = trace.sampling_rate()?;
    if let Some(threshold) = options.threshold.filter(|t| !(0.0..1.0).contains(t)) {
        let found = format!("a threshold of {threshold}");
        let expected = "a part of the median height, from 0 to 1";
        return Err(Error::usage(found, expected).setting("threshold"));
    }
    for (key, value) in [("refractory", options.refractory), ("excitation", options.excitation)] {
        if let Some(v) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
            return Err(Error::usage(format!("{key} is {v}"), "a finite number above 0").setting(key));
        }
    }
    no_gaps(trace, &trace.values, "the trace")?;
    if trace.values.iter().all(|v| Some(v) == trace.values.first()) {
        return Err(Error::refused("all values of the trace are equal: it has no impacts")
            .hint("another channel, or check its cable")
            .setting("channel"));
    }
    if let Some(reference) = &options.reference {
        let (n, expected) = (reference.len(), trace.values.len());
        if n != expected {
            let why = format!("the reference channel has {n} samples, the trace {expected}");
            return Err(Error::refused(why));
        }
        no_gaps(trace, reference, "the reference channel")?;
    }
    Ok(rate)
}

/// Refuses missing values: any of them may hide an impact or the beginning of a cycle.
fn no_gaps(trace: &Trace, values: &[f64], name: &str) -> Result<()> {
    let missing: Vec<usize> = (0..values.len()).filter(|i| !values[*i].is_finite()).collect();
    let (Some(first), Some(last)) = (missing.first(), missing.last()) else { return Ok(()) };
    let [first, last] = [first, last].map(|i| shortest(trace.axis.at(*i)));
    let n = missing.len();
    let why = format!("{n} values of {name} are missing or infinite, from {first} s to {last} s");
    Err(Error::refused(why).hint("read the part before or behind them").setting("span"))
}
