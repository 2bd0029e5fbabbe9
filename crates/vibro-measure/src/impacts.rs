//! Impacts in a trace: a contact circuit, or any signal that jumps at each of them.
//!
//! One pipeline: [`detect`] removes mains hum, takes each burst above the noise with its ringing as one
//! impact, and times it to less than a sample. [`impacts`] numbers the impacts, allowing for missed and
//! doubled ones, fits their mean interval, and compares them with the excitation. Assumptions and doubts are
//! in [`Impacts::findings`].

mod background;
mod bands;
mod detect;
mod echoes;
mod excitation;
mod heard;
mod hum;
mod interval;
mod onset;
mod rises;

pub use crate::mains::Hum;
pub(crate) use bands::{chosen, octaves};
pub(crate) use detect::{Choose, Sound, detect_among};
pub use detect::{Detected, ImpactsOptions, detect};
pub(crate) use echoes::QUIETER;
pub use excitation::{PerCycle, Phase};
pub use heard::{HeardSound, HeardSounds, heard};
pub use interval::{Interval, interval};

use super::Estimate;
use super::mean::{average, scatter};
use crate::swings::Swings;
use echoes::echoes;
use interval::{CountedImpacts, count, evened, pattern};
use serde::Serialize;
use vibro_record::{Doubt, Error, Finding, Result, Trace, median, uncertain};

/// Intervals that spread by less than this fraction of their median are regular.
pub const REGULAR: f64 = 0.05;

/// Impacts of a trace.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Impacts {
    /// Number of impacts found.
    pub n: usize,
    /// Mean time between impacts in s; missed impacts are counted.
    pub interval: Estimate,
    /// Impacts a second.
    pub frequency: Estimate,
    /// Median of the intervals between neighbours, in s.
    pub median_interval: f64,
    /// Standard deviation of the intervals between neighbours that miss none, in s; null for fewer than two.
    pub spread: Option<f64>,
    /// Serial correlation of neighbouring intervals, without the part that a pattern repeats: −0.5 where
    /// onsets are noisy, 0 where intervals jitter.
    pub serial_correlation: Option<f64>,
    /// Number of impacts after which the intervals repeat, if they differ within this pattern; null without
    /// a pattern.
    pub pattern: Option<usize>,
    /// Number of impacts missing from intervals that are several times the others.
    pub missed: usize,
    /// Number of impacts that follow another within less than half an interval, or split an interval of a
    /// pattern.
    pub doubled: usize,
    /// Frequency of the excitation in Hz, as given or from the reference channel.
    pub excitation: Option<f64>,
    /// Impacts per excitation cycle; null where no fraction fits or no excitation is known.
    pub per_cycle: Option<PerCycle>,
    /// Distance in Hz of the frequency of the impacts from the nearest simple fraction of the excitation.
    /// Null if the impacts are locked to it, near no fraction, or no excitation is known.
    pub beat: Option<Estimate>,
    /// Whether impacts repeat: a fraction fits; or, without an excitation, intervals spread by less than 5 %
    /// about their mean, or about those of a pattern. Two impacts do not show it.
    pub regular: bool,
    /// Phases of the impacts of the pattern, in excitation cycles; empty where there is no pattern.
    pub phases: Vec<Phase>,
    /// Times of the impacts in s.
    pub times: Vec<f64>,
    /// Standard uncertainty of one time from the noise of the trace, in s (the median).
    pub onset_std: Option<f64>,
    /// Heights over the background, in the unit of the trace.
    pub heights: Vec<f64>,
    /// Phase of each impact in its excitation cycle, 0 to 1; empty where no excitation is known.
    pub phase: Vec<f64>,
    /// Mains hum that was removed.
    pub hum: Option<Hum>,
    /// Changes made to the trace, and doubts.
    pub findings: Vec<Finding>,
}

uncertain!(Impacts: interval, frequency, beat);

/// Finds the impacts of `trace`, their mean interval, and the pattern that they repeat. Two further searches
/// follow if the record shows none or most are lost in its noise, and no option states how to search: for
/// sudden rises, as in the sound of an impact, then in the envelope of the octave in which the impacts ring.
///
/// # Errors
/// Where the trace has no sampling rate, missing or equal values, or fewer than two impacts; where the
/// reference channel has fewer than two edges; on impossible options.
pub fn impacts(trace: &Trace, options: &ImpactsOptions) -> Result<Impacts> {
    let whole = impacts_so(trace, options);
    let lost = |f: &Finding| ["impacts-lost-in-noise", "impacts-mostly-missed"].contains(&&*f.code);
    let shown = match &whole {
        Ok(found) => !found.findings.iter().any(lost),
        Err(error) => error.exit_code() != 1,
    };
    let open =
        ImpactsOptions { excitation: None, reference: None, ..options.clone() } == ImpactsOptions::default();
    if shown || !open {
        return whole;
    }
    // Every sudden rise counts.
    let all = |sounds: &[Sound], _: f64, _: f64| Ok(((0..sounds.len()).collect(), Vec::new()));
    let sounding = detect_among(trace, options, Some(&all));
    let sounding = sounding.and_then(|detected| of_detected(trace, options, detected)).ok();
    match sounding.filter(|found| found.n >= ENOUGH && repeats(found)) {
        Some(found) => Ok(found),
        None if rings(trace) => whole,
        None => ringing(trace, options).map_or(whole, Ok),
    }
}

/// Whether the record is a vibration ([`Swings`]). Its envelope must not be searched: the envelope of two
/// beating modes looks like impacts.
fn rings(trace: &Trace) -> bool {
    let level = average(&trace.values);
    let values: Vec<f64> = trace.values.iter().map(|v| v - level).collect();
    trace.sampling_rate().is_ok_and(|rate| Swings::of(&values, rate, &[], 0.0).is_some())
}

/// Whether the impacts of a further search are regular, mostly complete and without a finding of doubt.
fn repeats(found: &Impacts) -> bool {
    let steady = found.spread.is_some_and(|spread| spread < REGULAR * found.median_interval);
    let sure = found.findings.iter().all(|f| !f.is_doubt());
    steady && sure && MISSING * found.missed < found.n
}

/// The impacts of the octave whose frequency of impacts has the smallest relative uncertainty.
fn ringing(trace: &Trace, options: &ImpactsOptions) -> Option<Impacts> {
    let inside = |band: (f64, f64)| {
        if !bands::is_impulsive(trace, band) {
            return None;
        }
        let own = ImpactsOptions { band: Some(band), envelope: true, ..options.clone() };
        let mut found = impacts_so(trace, &own).ok()?;
        found.findings.insert(0, chosen(band));
        let shown = found.n > TELLING && repeats(&found);
        shown.then_some((found.frequency.std? / found.frequency.value, found))
    };
    let each = octaves(trace.sampling_rate().ok()?).filter_map(inside);
    each.min_by(|a, b| a.0.total_cmp(&b.0)).map(|best| best.1)
}

/// Fewest sudden rises that show repetition: their seven intervals lie within 5 % of the median, where at
/// random one in ten does.
const ENOUGH: usize = 8;

/// Impacts that must be found for each one missed.
const MISSING: usize = 4;

/// As [`impacts`], without a further search.
fn impacts_so(trace: &Trace, options: &ImpactsOptions) -> Result<Impacts> {
    of_detected(trace, options, detect(trace, options)?)
}

/// The mean interval of detected impacts, and the pattern that they repeat.
fn of_detected(trace: &Trace, options: &ImpactsOptions, detected: Detected) -> Result<Impacts> {
    let Detected { mut times, mut heights, onset_std, hum, mut findings, method, resolution, .. } = detected;
    let mut doubts = detected.doubts;
    if !options.complete && options.refractory.is_none() {
        doubts.extend(without_echoes(&mut times, &mut heights, &mut findings));
    }
    let steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    let pattern = pattern(&steps);
    let counted = count(&times, &steps, options.complete || pattern.is_some());
    let kept: Vec<f64> = counted.kept.iter().map(|i| times[*i]).collect();
    let even = pattern.map_or_else(|| kept.clone(), |length| evened(&kept, length));
    let excited = options.excitation.is_some() || options.reference.is_some();
    let known = options.complete || excited;
    if !known && pattern.is_none() && irregular(&steps) {
        return Err(without_period(times.len(), options));
    }
    let fitted = interval(&even, &counted.index).ok_or_else(|| {
        Error::refused("one impact alone counts: an interval needs two")
            .hint("record longer, or lower the threshold")
            .setting("threshold")
    })?;
    findings.extend(fitted.wanders.then(|| Finding::caution("intervals-drift")));
    let mostly_missed = counted.missed > times.len();
    let missed = Finding::doubt("impacts-mostly-missed").count("n", times.len());
    doubts.extend(mostly_missed.then(|| missed.count("missed", counted.missed)));
    let median_interval = median(&steps);
    let regular = spread(&even, &counted).is_some_and(|s| s < REGULAR * median_interval);
    // A mean interval of a body that bounces is no property of it.
    doubts.extend((!regular && !excited && bounces(&times)).then(|| Finding::doubt("impacts-bounce")));
    let intervals = counted.index.last().copied().unwrap_or(0);
    let std = widened(fitted.std, even.len(), pattern).hypot(within_sample(resolution, intervals));
    let mut std = Some(std).filter(|s| s.is_finite());
    // Interval, frequency and beat follow from this uncertainty.
    findings.extend(doubts.into_iter().map(|doubt| doubt.of(&mut std)));
    let interval_by = if kept.len() < 3 {
        "difference of two onsets"
    } else {
        "generalised least squares of the intervals"
    };
    let method = format!("{interval_by}; {method}");
    let of = |value, std, unit| Estimate::new(value, std, unit, kept.len(), method.as_str());
    let mut answer = Impacts {
        n: times.len(),
        interval: of(fitted.mean, std, "s").with_relative(trace.meta.clock),
        frequency: of(1.0 / fitted.mean, std.map(|s| s / fitted.mean.powi(2)), "Hz")
            .with_relative(trace.meta.clock),
        median_interval,
        spread: spread(&kept, &counted),
        serial_correlation: Some(fitted.correlation).filter(|r| r.is_finite()),
        pattern,
        missed: counted.missed,
        doubled: counted.doubled,
        excitation: None,
        per_cycle: None,
        beat: None,
        regular,
        phases: Vec::new(),
        onset_std,
        heights,
        phase: Vec::new(),
        hum,
        times,
        findings,
    };
    excitation::compare(&mut answer, &counted, (trace.axis.start(), trace.sampling_rate()?), options)?;
    let of_train = of_train(&answer);
    answer.findings.extend(of_train);
    Ok(answer)
}

/// Standard uncertainty of an interval from `n` onsets, widened for the fit of a pattern.
fn widened(std: f64, n: usize, pattern: Option<usize>) -> f64 {
    // The mean shift of each impact of a pattern is fitted too, and costs a degree of freedom.
    let free = |parameters: usize| n.saturating_sub(parameters) as f64;
    (free(2) / free(1 + pattern.unwrap_or(1))).sqrt() * std
}

/// Standard uncertainty in s of the mean of `intervals` whose onsets are known to a sample.
fn within_sample(resolution: Option<f64>, intervals: usize) -> f64 {
    // First and last onset each lie anywhere within a sample. If the interval is near a whole number of
    // samples, all onsets lie alike between samples: the scatter of the intervals does not show this error,
    // and no number of impacts averages it out.
    resolution.map_or(0.0, |step| step / (6f64.sqrt() * intervals as f64))
}

/// Removes bursts that follow impacts at fixed delays, as echoes do. Where that is not sure, they stay with a
/// doubt.
fn without_echoes(
    times: &mut Vec<f64>,
    heights: &mut Vec<f64>,
    findings: &mut Vec<Finding>,
) -> Option<Doubt> {
    let echoes = echoes(times, heights)?;
    let n = echoes.places.len();
    if echoes.sure {
        let impacts: Vec<usize> =
            (0..times.len()).filter(|i| echoes.places.binary_search(i).is_err()).collect();
        *times = impacts.iter().map(|i| times[*i]).collect();
        *heights = impacts.iter().map(|i| heights[*i]).collect();
        findings.push(Finding::caution("echoes-ignored").count("n", n).number("delay", echoes.delay));
        return None;
    }
    let doubt = Finding::doubt("impacts-or-echoes").count("n", n).number("delay", echoes.delay);
    Some(doubt.number("pause", PAUSE * echoes.delay))
}

/// Error for bursts without a period; its hint leaves out what the options already set.
fn without_period(n: usize, options: &ImpactsOptions) -> Error {
    let refused = Error::refused(format!("{n} bursts whose intervals are irregular: no period is in them"));
    match (options.band, options.envelope) {
        (Some(_), true) => refused
            .hint("another band, where a spectrum shows the impacts ringing; or say that none is missed, for their mean interval")
            .setting("band")
            .setting("none_missed"),
        _ => refused
            .hint("choose the band in which the impacts ring, and the envelope; or say that none is missed, for their mean interval")
            .setting("band")
            .setting("envelope")
            .setting("none_missed"),
    }
}

/// Pause that joins echoes with their impact, over their longest delay.
const PAUSE: f64 = 1.2;

/// Fewest intervals that can show that they are irregular.
const TELLING: usize = 12;

/// Share of the intervals off every multiple of their median, above which they are irregular. At random nine
/// in ten are off, in short records somewhat fewer.
const SCATTERED: f64 = 0.85;

/// Whether no more intervals lie near a multiple of their median than by chance: within 5 % on either side
/// lies one in ten.
fn irregular(steps: &[f64]) -> bool {
    let median = median(steps);
    let off = |step: &&f64| ((*step / median).round().max(1.0) - *step / median).abs() > REGULAR;
    steps.len() >= TELLING && steps.iter().filter(off).count() as f64 > SCATTERED * steps.len() as f64
}

/// Standard deviation in s of the intervals between neighbours without a missed impact between them; `None`
/// for fewer than two.
fn spread(times: &[f64], counted: &CountedImpacts) -> Option<f64> {
    let pairs = times.windows(2).zip(counted.index.windows(2));
    let single: Vec<f64> = pairs.filter(|(_, k)| k[1] - k[0] == 1).map(|(t, _)| t[1] - t[0]).collect();
    Some(scatter(&single)).filter(|s| s.is_finite())
}

/// Findings on the count of the impacts and the spread of their intervals.
fn of_train(found: &Impacts) -> Vec<Finding> {
    let irregular = found.spread.filter(|_| !found.regular && found.excitation.is_none());
    let all = [
        found.pattern.map(|n| Finding::note("interval-pattern").count("n", n)),
        (found.n == 2).then(|| Finding::note("one-interval")),
        (1..=found.n)
            .contains(&found.missed)
            .then(|| Finding::caution("impacts-missed").count("n", found.missed)),
        (found.doubled > 0).then(|| Finding::caution("impacts-doubled").count("n", found.doubled)),
        irregular.map(|s| Finding::caution("impacts-irregular").number("spread", s / found.median_interval)),
    ];
    all.into_iter().flatten().collect()
}

/// Fewest intervals that show a bouncing body: at random, one order in 120 of five falls throughout.
const FALLING: usize = 5;

/// Whether each interval is shorter than the one before, as the flights of a bouncing body.
fn bounces(times: &[f64]) -> bool {
    let steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    steps.len() >= FALLING && steps.is_sorted_by(|a, b| a > b)
}

#[cfg(test)]
mod tests;
