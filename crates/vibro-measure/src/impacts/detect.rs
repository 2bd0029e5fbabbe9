//! Impacts of a trace: bursts above the noise, timed below a sample.

use super::background::{Background, background, median};
use super::onset::{Timing, onsets};
use super::options::check;
use super::recorder::{clipped, sample_and_hold};
use super::ringing::bursts;
use super::shape::INVERTED;
use super::{Hum, ImpactsOptions, drift, hum};
use std::ops::Range;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Finding, Result, Trace};

/// The number of impacts must not change while the assumed decay of their ringing does by this factor.
const STABLE: f64 = 2.0;
/// Median height, in noise limits, below which impacts hardly differ from noise.
const CLEAR: f64 = 2.0;
/// Standard deviations of the noise by which the median height must exceed the noise limit: below them one impact in 700 or more is
/// lost by chance.
const LOST: f64 = 3.0;

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
    /// What was done to the trace, and what is doubtful.
    pub findings: Vec<Finding>,
    pub(super) timing: Timing,
    /// Time in s within which each onset may lie anywhere; `None` where samples on the flanks tell.
    pub(super) resolution: Option<f64>,
}

/// Finds the impacts of a trace.
///
/// # Errors
/// Where the trace has no sampling rate, missing or equal values, or fewer than two impacts; on impossible options.
pub fn detect(trace: &Trace, options: &ImpactsOptions) -> Result<Detected> {
    let rate = check(trace, options)?;
    let unit = trace.meta.unit.symbol();
    let mut values = trace.values.clone();
    let mut findings = Vec::new();
    if let Some(slope) = drift::remove(&mut values) {
        findings.push(Finding::note("drift-removed").number("slope", slope * rate).name("unit", unit));
    }
    let hum::Treated { removed: hum, reach: bound } =
        hum::remove(&mut values, rate, !options.hum, &mut findings);
    if let Some(h) = &hum {
        findings.push(
            Finding::note("mains-hum-removed")
                .number("frequency", h.frequency)
                .number("amplitude", h.amplitude)
                .name("unit", unit)
                .count("harmonics", h.harmonics),
        );
    }
    let found = background(&values);
    for v in &mut values {
        *v -= found.level;
    }
    let level = Background { level: 0.0, reach: bound.map_or(found.reach, |b| b.min(found.reach)), ..found };
    let pause = options.refractory.map(|s| ((s * rate) as usize).max(1));
    let bursts = bursts(&values, level.reach, pause);
    let mut each = bursts.each;
    if median(&extremes(&values, &each, -1.0)) > INVERTED * median(&extremes(&values, &each, 1.0)) {
        findings.push(Finding::note("pulses-inverted"));
        for v in &mut values {
            *v = -*v;
        }
    }
    let mut heights = extremes(&values, &each, 1.0);
    let least = (options.threshold * median(&heights)).max(level.reach);
    let before = each.len();
    let mut high = heights.iter().map(|h| *h > least);
    each.retain(|_| high.next() == Some(true));
    heights.retain(|h| *h > least);
    let low = before - each.len();
    if low > 0 {
        findings.push(
            Finding::note("low-bursts-ignored")
                .count("n", low)
                .number("level", least)
                .number("noise", level.sigma)
                .name("unit", unit),
        );
    }
    if let Some(factor) = bursts.stable.filter(|s| *s < STABLE && each.len() > 1) {
        findings.push(Finding::caution("count-depends-on-ringing").number("factor", factor));
    }
    findings.extend(near_noise(median(&heights), level));
    let flat = clipped(&trace.values, &each);
    if flat > 0 {
        findings.push(Finding::note("pulses-clipped").count("n", flat).count("of", each.len()));
    }
    let mut found = onsets(&values, &each, level.sigma, options.shape.as_ref());
    let hold = sample_and_hold(&trace.values);
    if hold > 1 {
        let rate = rate / hold as f64;
        findings.push(Finding::caution("sample-and-hold").count("n", hold).number("rate", rate));
    }
    let resolution = (found.sharp || hold > 1).then(|| hold as f64 / rate);
    if let Some(step) = resolution {
        // Anywhere within a step (JCGM 100:2008, 4.3.7).
        let std = step / 12f64.sqrt();
        findings.push(Finding::caution("onset-within-sample").number("std", std));
        found.each.iter_mut().flatten().for_each(|o| o.std = o.std.hypot(std * rate));
    }
    let cut = found.each.iter().filter(|o| o.is_none()).count();
    if cut > 0 {
        findings.push(Finding::note("pulses-cut").count("n", cut));
    }
    let onsets: Vec<_> = found.each.into_iter().flatten().collect();
    if onsets.len() < 2 {
        let highest = values.iter().fold(0.0f64, |h, v| h.max(v.abs()));
        return Err(too_few(onsets.len(), [level.reach, highest].map(|v| quantity(v, unit, 3)), hum, low));
    }
    let std = median(&onsets.iter().map(|o| o.std).collect::<Vec<f64>>()) / rate;
    Ok(Detected {
        times: onsets.iter().map(|o| trace.axis.start() + o.time / rate).collect(),
        heights: onsets.iter().map(|o| o.height).collect(),
        onset_std: Some(std).filter(|s| s.is_finite()),
        hum,
        findings,
        timing: found.timing,
        resolution,
    })
}

/// Largest value of each burst, those of −`values` with a `sign` of −1.
fn extremes(values: &[f64], bursts: &[Range<usize>], sign: f64) -> Vec<f64> {
    bursts.iter().map(|b| values[b.clone()].iter().map(|v| sign * v).fold(0.0, f64::max)).collect()
}

/// Whether impacts of this median height are hardly higher than the noise, or some are lost in it.
fn near_noise(height: f64, level: Background) -> Option<Finding> {
    let above = (height - level.reach) / level.sigma;
    if above < LOST {
        return Some(Finding::doubt("impacts-lost-in-noise").number("sigmas", above));
    }
    let ratio = height / level.reach;
    (ratio < CLEAR).then(|| Finding::caution("impacts-near-noise").number("ratio", ratio))
}

/// Why there is no interval, and what may help.
fn too_few(n: usize, [noise, highest]: [String; 2], hum: Option<Hum>, low: usize) -> Error {
    let error = Error::refused(format!(
        "{n} impact{} found, an interval needs two; noise reaches {noise} from the level, the trace {highest}",
        if n == 1 { "" } else { "s" }
    ));
    match hum {
        Some(h) => error
            .hint(format!(
                "keep what repeats at {:.2} Hz, if these are impacts and no mains hum",
                h.frequency
            ))
            .setting("keep_hum"),
        None if low > 0 => error.hint("a lower threshold, as lower bursts were ignored").setting("threshold"),
        None => error
            .hint("a shorter pause between impacts, or a high-pass where hum or a slow level hides them")
            .setting("refractory"),
    }
}
