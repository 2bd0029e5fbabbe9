//! Impacts in a trace: a contact circuit, or any signal that jumps at each of them.
//!
//! A burst over the background is one impact, ringing included; its time is that at which the first rising flank passes half its
//! height, below a sample. What is counted, what is left out and what was assumed is in [`Impacts::warnings`].

mod burst;
mod count;
mod cycle;
mod drift;
mod excited;
mod hum;
mod interval;
mod multiples;
mod onset;
mod pattern;
mod ringing;
mod shape;
mod unfit;

pub use cycle::{PerCycle, Phase, typed};
pub use hum::Hum;
pub use interval::{Interval, Scatter, interval};
pub use onset::Timing;
pub use shape::{Matched, Shape};

use super::Estimate;
use crate::error::{Error, Result};
use crate::record::Trace;
use crate::units::notation::quantity;
use burst::{Background, background, median};
use count::count;
use cycle::Reference;
use onset::{Onset, onsets};
use ringing::bursts;
use serde::Serialize;
use std::collections::HashSet;
use std::fmt::Write as _;
use std::ops::Range;

/// How impacts are found.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpactsOptions {
    /// Bursts lower than this part of the median burst are no impacts. Default 1/8.
    pub threshold: f64,
    /// Pause in s that parts two impacts. Default: found from the pauses of the trace.
    pub refractory: Option<f64>,
    /// Whether mains hum is looked for and taken away. Default true.
    pub hum: bool,
    /// Whether it is known that no impact is missed and none is too many, however uneven the intervals. Default false.
    pub complete: bool,
    /// Frequency of the excitation in Hz, for impacts per cycle.
    pub excitation: Option<f64>,
    /// Its standard uncertainty in Hz. Default: that of the digits it is written with.
    pub excitation_std: Option<f64>,
    /// Samples of a channel that rises once a cycle of the excitation, taken together with the trace.
    pub reference: Option<Vec<f64>>,
    /// Shape of the pulses over time in samples, where it is known; its origin is the time of the impact.
    pub shape: Option<Shape>,
    /// Whether onsets or intervals are known to scatter. Default: unknown.
    pub scatter: Scatter,
}

impl Default for ImpactsOptions {
    fn default() -> ImpactsOptions {
        ImpactsOptions {
            threshold: 0.125,
            refractory: None,
            hum: true,
            complete: false,
            excitation: None,
            excitation_std: None,
            reference: None,
            shape: None,
            scatter: Scatter::Unknown,
        }
    }
}

/// Impacts of a trace.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Impacts {
    /// Impacts that were found.
    pub n: usize,
    /// Mean time between impacts in s, missed ones counted.
    pub interval: Estimate,
    /// Impacts a second.
    pub frequency: Estimate,
    /// Median of the intervals between neighbours, in s.
    pub median_interval: f64,
    /// Standard deviation of the intervals between neighbours that miss none, in s; null for fewer than two.
    pub spread: Option<f64>,
    /// Serial correlation of neighbouring intervals, less what a pattern repeats: −0.5 where onsets are noisy, 0 where intervals jitter.
    pub serial_correlation: Option<f64>,
    /// Impacts after which the intervals repeat, where they are unlike within that pattern; null where there is none.
    pub pattern: Option<usize>,
    /// Impacts that should stand in intervals that are several of the others.
    pub missed: usize,
    /// Impacts that follow another within less than half an interval, or cut one of a pattern in two.
    pub doubled: usize,
    /// Frequency of the excitation in Hz, as given or from the reference channel.
    pub excitation: Option<f64>,
    /// Impacts per excitation cycle; null where no fraction fits or no excitation is known.
    pub per_cycle: Option<PerCycle>,
    /// Frequency in Hz by which the impacts miss the fraction that they come near to; null where they keep it, come near none, or no
    /// excitation is known.
    pub beat: Option<Estimate>,
    /// Whether impacts repeat: a fraction fits, or without an excitation, intervals spread by less than 5 %, or about those of a pattern. Two impacts
    /// do not show it.
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
    /// Hum that was taken away.
    pub hum: Option<Hum>,
    /// What a person must know.
    pub warnings: Vec<String>,
}

/// Intervals that spread by less than this part of their median are regular.
pub const REGULAR: f64 = 0.05;

/// The number of impacts must not change while the assumed decay of their ringing does by this factor.
const STEADY: f64 = 2.0;
/// Impacts of typically less than this many times the reach of the noise are hardly told from it.
const CLEAR: f64 = 2.0;
/// Impacts that typically rise above the reach of the noise by less than this many of its standard deviations are lost in it by chance, one of 700 and
/// more: how many there were is not known.
const LOST: f64 = 3.0;

/// Finds the impacts of `trace` and what they repeat.
///
/// # Errors
/// Where the trace has no sampling rate, missing or equal values, or fewer than two impacts; where the reference channel has fewer than two
/// edges; on options that cannot be.
pub fn impacts(trace: &Trace, options: &ImpactsOptions) -> Result<Impacts> {
    let (mut found, of_train) = with_train(trace, options)?;
    found.warnings.extend(of_train);
    Ok(found)
}

/// As [`impacts`], with what there is to say of them as a steady train beside the warnings.
pub(super) fn with_train(trace: &Trace, options: &ImpactsOptions) -> Result<(Impacts, Vec<String>)> {
    let rate = rate_of(trace)?;
    check(trace, options)?;
    let found = find(trace, rate, options);
    if found.onsets.len() < 2 {
        return Err(found.too_few(trace.meta.unit.symbol()));
    }
    let Found { onsets, timing, sharp, held, hum, lost, mut warnings, .. } = found;
    let start = trace.axis.start();
    let times: Vec<f64> = onsets.iter().map(|o| start + o.time / rate).collect();
    let steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    let counted = count(&times, &steps, options.complete);
    let kept: Vec<f64> = counted.kept.iter().map(|i| times[*i]).collect();
    let even = if counted.length > 1 {
        pattern::evened(&kept, &counted.index, &counted.place, counted.length)
    } else {
        kept.clone()
    };
    let found = interval(&even, &counted.index, options.scatter)
        .ok_or_else(|| Error::refused("one impact alone counts: an interval needs two"))?;
    // The shifts of the places are fitted, too.
    let free = |n: usize| even.len().saturating_sub(n) as f64;
    let mut of_train = Vec::new();
    if found.wanders {
        of_train.push(
            "Intervals change slowly along the record: the uncertainty of their mean may be too small; measure longer.".to_owned(),
        );
    }
    let widened = if counted.length > 1 { (free(2) / free(1 + counted.length)).sqrt() } else { 1.0 };
    // What the samples hide of first and last, as a part of the interval.
    let span = counted.index.last().zip(counted.index.first()).map_or(0, |(l, f)| l - f) as f64;
    let hidden = if sharp { cycle::quantised(span * found.mean * rate / held as f64) } else { 0.0 };
    let std = Some((widened * found.std).hypot(hidden * found.mean))
        .filter(|s| s.is_finite() && !lost && counted.unsure.is_none());
    if sharp {
        warnings.push(format!(
            "The pulses rise within one sample: onsets are known to {} only.",
            quantity(held as f64 / (12f64.sqrt() * rate), "s", 2)
        ));
    }
    let single = |times: &[f64]| -> Vec<f64> {
        let next = |k: &[usize]| k[1] - k[0] == 1;
        let both = times.windows(2).zip(counted.index.windows(2));
        both.filter(|(_, k)| next(k)).map(|(t, _)| t[1] - t[0]).collect()
    };
    let median_interval = median(&steps);
    let spread = deviation(&single(&kept));
    let regular = deviation(&single(&even)).is_some_and(|s| s < REGULAR * median_interval);
    let mut method = described(&found, kept.len(), timing);
    if sharp {
        method.push_str("; first and last onset anywhere within a sample");
    }
    if counted.length > 1 {
        let _ = write!(method, "; a pattern of {} impacts fitted with it", counted.length);
    }
    let mut answer = Impacts {
        n: times.len(),
        interval: Estimate::new(found.mean, std, "s", kept.len(), method.as_str()),
        frequency: Estimate::new(
            1.0 / found.mean,
            std.map(|s| s / found.mean.powi(2)),
            "Hz",
            kept.len(),
            method,
        ),
        median_interval,
        spread,
        serial_correlation: Some(found.correlation).filter(|r| r.is_finite()),
        pattern: (counted.length > 1).then_some(counted.length),
        missed: counted.missed,
        doubled: counted.doubled,
        excitation: None,
        per_cycle: None,
        beat: None,
        regular,
        phases: Vec::new(),
        onset_std: Some(median(&onsets.iter().map(|o| o.std).collect::<Vec<f64>>()) / rate)
            .filter(|s| s.is_finite()),
        heights: onsets.iter().map(|o| o.height).collect(),
        phase: Vec::new(),
        hum,
        times,
        warnings: Vec::new(),
    };
    excited::compare(&mut answer, &counted, (start, rate, hidden), options, &mut of_train)?;
    doubts(&answer, &mut of_train);
    of_train.extend(counted.unsure);
    answer.warnings = warnings;
    Ok((answer, of_train))
}

/// Impacts as onsets in samples, before anything is said of their times.
struct Found {
    onsets: Vec<Onset>,
    timing: Timing,
    /// Whether most pulses rise within one sample, or within one value that is held.
    sharp: bool,
    /// Samples for which each value is held: 1 but in a trace that was sampled more slowly than it says.
    held: usize,
    hum: Option<Hum>,
    warnings: Vec<String>,
    /// What was looked at: how far noise reaches from the level, how far the trace does, and bursts that were left out as too low.
    reach: f64,
    highest: f64,
    low: usize,
    /// Whether some impacts are lost in the noise.
    lost: bool,
}

/// Sampling rate of a trace.
///
/// # Errors
/// Where it has none.
pub(super) fn rate_of(trace: &Trace) -> Result<f64> {
    trace.rate().filter(|r| r.is_finite() && *r > 0.0).ok_or_else(|| {
        unfit::uneven(trace).unwrap_or_else(|| {
            Error::usage("the file does not say at which even rate the trace was sampled", "a sampling rate")
                .hint("--rate HZ, or --base-band HZ for an analyser that samples at 2.56 times its base band")
        })
    })
}

fn check(trace: &Trace, options: &ImpactsOptions) -> Result<()> {
    if !(0.0..1.0).contains(&options.threshold) {
        return Err(Error::usage(
            format!("a threshold of {}", options.threshold),
            "0 to 1, of the median height",
        ));
    }
    for (what, value) in [
        ("a refractory time", options.refractory),
        ("an excitation", options.excitation),
        ("an uncertainty of the excitation", options.excitation_std),
    ] {
        if let Some(v) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
            return Err(Error::usage(format!("{what} of {v}"), "a finite number above 0"));
        }
    }
    unfit::lost(trace, &trace.values, "the trace", "an impact may stand in any of them")?;
    if trace.values.iter().all(|v| Some(v) == trace.values.first()) {
        return Err(Error::refused("all values of the trace are equal: there are no impacts in it"));
    }
    if options.reference.as_ref().is_some_and(|r| r.len() != trace.values.len()) {
        return Err(Error::refused("the reference channel has another number of samples than the trace"));
    }
    let reference = options.reference.as_deref().unwrap_or_default();
    unfit::lost(trace, reference, "the reference channel", "a cycle may begin in any of them")
}

impl Found {
    /// Why there is no interval, and what may be done about it.
    fn too_few(&self, unit: &str) -> Error {
        let n = self.onsets.len();
        let hum = self.warnings.iter().filter(|w| w.contains("mains hum")).map(|w| format!(" {w}"));
        let error = Error::refused(format!(
            "{n} impact{} found: an interval needs two; the background alone may reach {} from its level, the trace reaches {}.{}",
            if n == 1 { " was" } else { "s were" },
            quantity(self.reach, unit, 3),
            quantity(self.highest, unit, 3),
            hum.collect::<String>()
        ));
        let mut tried = Vec::new();
        if let Some(h) = &self.hum {
            tried.push(format!(
                "--keep-hum if what comes at {:.2} Hz is the impacts: it was taken away as mains hum",
                h.frequency
            ));
        }
        if self.low > 0 {
            tried.push("--threshold lower, as lower bursts were left out".to_owned());
        }
        tried.push(
            "a high-pass where hum or a wandering level hides the impacts (vibro convert --high-pass HZ)"
                .to_owned(),
        );
        tried.push("--refractory S shorter than the pauses where ringing fills them".to_owned());
        error.hint(tried.join("; "))
    }
}

fn find(trace: &Trace, rate: f64, options: &ImpactsOptions) -> Found {
    let mut values = trace.values.clone();
    let mut warnings = Vec::new();
    if let Some(slope) = drift::remove(&mut values) {
        warnings.push(format!(
            "A drift of the level by {} a second was taken away.",
            quantity(slope * rate, trace.meta.unit.symbol(), 3)
        ));
    }
    let hum::Treated { taken: hum, reach: bound } =
        hum::remove(&mut values, rate, !options.hum, &mut warnings);
    if let Some(h) = &hum {
        warnings.push(format!(
            "Mains hum of {:.2} Hz, amplitude {}, with {} was fitted and taken away.",
            h.frequency,
            quantity(h.amplitude, trace.meta.unit.symbol(), 3),
            if h.harmonics == 1 { "one harmonic".to_owned() } else { format!("{} harmonics", h.harmonics) }
        ));
    }
    let quiet = options.refractory.map(|s| ((s * rate) as usize).max(1));
    let found = background(&values);
    for v in &mut values {
        *v -= found.level;
    }
    let level = Background { level: 0.0, reach: bound.map_or(found.reach, |b| b.min(found.reach)), ..found };
    let bursts = bursts(&values, level.reach, quiet);
    let mut all = bursts.each;
    let extreme = |b: &Range<usize>, sign: f64| {
        values.get(b.clone()).unwrap_or_default().iter().map(|v| sign * v).fold(0.0, f64::max)
    };
    let typical = |sign: f64| median(&all.iter().map(|b| extreme(b, sign)).collect::<Vec<f64>>());
    if typical(-1.0) > shape::TURNED * typical(1.0) {
        warnings.push("The pulses point downwards: the trace was turned around.".to_owned());
        for v in &mut values {
            *v = -*v;
        }
    }
    let heights: Vec<f64> = all
        .iter()
        .map(|b| values.get(b.clone()).unwrap_or_default().iter().copied().fold(0.0, f64::max))
        .collect();
    let least = (options.threshold * median(&heights)).max(level.reach);
    let before = all.len();
    let mut high = heights.iter().map(|h| *h > least);
    all.retain(|_| high.next() == Some(true));
    let low = before - all.len();
    if low > 0 {
        let unit = trace.meta.unit.symbol();
        warnings.push(format!(
            "{low} burst{} lower than {} {} left out (noise between impacts has a standard deviation of {}).",
            if low == 1 { "" } else { "s" },
            quantity(least, unit, 3),
            if low == 1 { "was" } else { "were" },
            quantity(level.sigma, unit, 3)
        ));
    }
    if let Some(steady) = bursts.steady.filter(|s| *s < STEADY && all.len() > 1) {
        warnings.push(format!(
            "The number of impacts depends on how long ringing is taken to last: it stays the same over a factor of {steady:.1} alone. State the pause that parts impacts: --refractory S."
        ));
    }
    let typical = median(&heights.iter().copied().filter(|h| *h > least).collect::<Vec<f64>>());
    let lost = is_drowned(typical, level, &mut warnings);
    if let Some(sentence) = clipped(&trace.values, &all) {
        warnings.push(sentence);
    }
    let onset::Found { onsets: mut found, timing, mut sharp } =
        onsets(&values, &all, level, options.shape.as_ref());
    let held = held(&trace.values);
    if held > 1 {
        warnings.push(format!(
            "Each value is held for {held} samples: the trace was sampled at {} and no faster.",
            quantity(rate / held as f64, "Hz", 4)
        ));
        sharp = true;
        found.iter_mut().flatten().for_each(|o| o.std = o.std.hypot(held as f64 / 12f64.sqrt()));
    }
    let cut = found.iter().filter(|o| o.is_none()).count();
    if cut > 0 {
        warnings.push(format!(
            "{cut} pulse{} cut by an end of the record or without a flank: not counted.",
            if cut == 1 { " is" } else { "s are" }
        ));
    }
    Found {
        onsets: found.into_iter().flatten().collect(),
        timing,
        sharp,
        held,
        hum,
        warnings,
        reach: level.reach,
        highest: values.iter().fold(0.0, |h, v| h.max(v.abs())),
        low,
        lost,
    }
}

/// Whether impacts of this typical height are lost in the noise by chance; what is to be said of it.
fn is_drowned(typical: f64, level: Background, said: &mut Vec<String>) -> bool {
    if typical < CLEAR * level.reach {
        said.push(format!(
            "Impacts rise to only {:.1} times the level that noise reaches: either they drown in it, or ringing fills the pauses, and impacts may be missing.",
            typical / level.reach
        ));
    }
    let lost = typical - level.reach < LOST * level.sigma;
    if lost {
        said.push(format!(
            "Impacts rise above the level that noise reaches by only {:.1} of its standard deviations: some are lost by chance, and the uncertainty of the mean interval is not known.",
            (typical - level.reach) / level.sigma
        ));
    }
    lost
}

/// Words of a trace that show that its values are held. They hold as many changes at least, which all stand at multiples of two samples by
/// chance in one of 65 000 traces.
const WORDS: usize = 16;

/// Samples for which each value is held: the largest number of which all distances between changes of the value are multiples.
///
/// A train that is locked to the sampling clock has such a number, too, as it has few distances. What shows that values are held are words of
/// four values of that length in which none returns after the next: flat pulses return to their level, and a train of stairs repeats its words.
/// A trace of two values, whether held or not, is taken for one that is not.
fn held(values: &[f64]) -> usize {
    let (mut common, mut changes) = (0, Vec::new());
    for i in (1..values.len()).filter(|i| values[*i] != values[i - 1]) {
        let (mut a, mut b) = (common, i - changes.last().unwrap_or(&i));
        while b > 0 {
            (a, b) = (b, a % b);
        }
        common = a;
        if common == 1 {
            return 1;
        }
        changes.push(i);
    }
    let goes_on = |w: &&[usize]| {
        w.windows(2).all(|w| w[1] - w[0] == common)
            && values[w[0]] != values[w[2]]
            && values[w[1]] != values[w[3]]
    };
    let word = |w: &[usize]| [0, 1, 2, 3].map(|k| values[w[k]].to_bits());
    let words: HashSet<[u64; 4]> = changes.windows(4).filter(goes_on).map(word).collect();
    if words.len() < WORDS { 1 } else { common }
}

/// Says where pulses have flat tops at the largest or smallest value.
fn clipped(values: &[f64], bursts: &[Range<usize>]) -> Option<String> {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let flat = |b: &&Range<usize>| {
        values
            .get((*b).clone())
            .unwrap_or_default()
            .windows(3)
            .any(|w| w.iter().all(|v| *v == high) || w.iter().all(|v| *v == low))
    };
    let n = bursts.iter().filter(flat).count();
    (n > 0).then(|| {
        format!("{n} of {} pulses are clipped: their heights are too low, and half of that height is passed a little early.", bursts.len())
    })
}

fn deviation(values: &[f64]) -> Option<f64> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.len() >= 2).then(|| (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
}

fn described(found: &Interval, n: usize, timing: Timing) -> String {
    let onsets = match timing {
        Timing::Flank => "onsets at half height of the rising flanks",
        Timing::Average => "onsets by matching each pulse to the average pulse",
        Timing::Known => "onsets by matching each pulse to its known shape",
    };
    if n < 3 {
        return format!("difference of two onsets; {onsets}");
    }
    let line = match (found.onset > 0.0, found.jitter > 0.0) {
        (_, false) => {
            "generalised least squares, nearest the straight line through index and time (onset noise alone)"
        }
        (false, true) => "generalised least squares, nearest (t_last − t_first)/(n − 1) (jitter alone)",
        (true, true) => "generalised least squares of the intervals (onset noise and jitter)",
    };
    let correlation = if found.correlation.is_finite() {
        format!(", serial correlation of intervals {:.2}", found.correlation)
    } else {
        String::new()
    };
    format!(
        "{line}: onset noise {}, cycle-to-cycle jitter {}{correlation}; {onsets}",
        quantity(found.onset, "s", 3),
        quantity(found.jitter, "s", 3)
    )
}

/// Times of impacts in excitation cycles.
struct Cycles {
    frequency: f64,
    /// Standard uncertainty of the frequency that `at` does not show.
    std: f64,
    at: Vec<f64>,
}

fn cycles(
    times: &[f64],
    start: f64,
    rate: f64,
    options: &ImpactsOptions,
    warnings: &mut Vec<String>,
) -> Result<Option<Cycles>> {
    if let Some(channel) = &options.reference {
        let reference = Reference::new(channel)?;
        if reference.missing + reference.extra > 0 {
            warnings.push(format!(
                "Edges of the reference channel: {} missing, {} too many; cycles were counted as if they were right.",
                reference.missing, reference.extra
            ));
        }
        let at = times.iter().map(|t| reference.counted((t - start) * rate)).collect();
        let frequency = rate / reference.mean_cycle();
        return Ok(Some(Cycles { frequency, std: frequency * reference.std(), at }));
    }
    Ok(options.excitation.map(|frequency| Cycles {
        frequency,
        std: options.excitation_std.unwrap_or_else(|| cycle::of_digits(frequency)),
        at: times.iter().map(|t| t * frequency).collect(),
    }))
}

fn doubts(found: &Impacts, warnings: &mut Vec<String>) {
    if let Some(length) = found.pattern {
        warnings.push(format!(
            "Intervals repeat after {length}: a pattern of {length} impacts, none of which is counted as missed or too many."
        ));
    }
    if found.n == 2 {
        warnings.push("Two impacts have one interval: whether it repeats is not known.".to_owned());
    }
    if found.missed > 0 {
        warnings.push(format!(
            "{} impact{} missed: intervals that are {} are counted as such in the mean. If none is: --none-missed.",
            found.missed,
            if found.missed == 1 { " is" } else { "s are" },
            if found.pattern.is_some() { "several of the pattern" } else { "a multiple of the median" }
        ));
    }
    if found.missed > found.n {
        warnings.push(
            "More impacts are missed than were found: either the record rests for long, or what was found is no impacts but their ringing. State the pause that parts impacts: --refractory S.".to_owned(),
        );
    }
    if found.doubled > 0 {
        warnings.push(format!(
            "{} impact{} another within half an interval, or between two of a pattern: left out of the mean interval.",
            found.doubled,
            if found.doubled == 1 { " follows" } else { "s follow" }
        ));
    }
    if let Some(spread) = found.spread.filter(|_| !found.regular && found.excitation.is_none()) {
        warnings.push(format!(
            "Intervals spread by {:.0} % of their median: impacts are irregular, and their mean is no period.",
            100.0 * spread / found.median_interval
        ));
    }
}

#[cfg(test)]
pub(super) mod tests;
