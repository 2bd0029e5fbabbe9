//! Impacts of a trace as onsets, before anything is said of their times.

use super::burst::{Background, background, median};
use super::held::held;
use super::onset::{self, Onset, Timing, onsets};
use super::ringing::bursts;
use super::{Hum, ImpactsOptions, drift, hum, shape};
use std::ops::Range;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Trace};

/// The number of impacts must not change while the assumed decay of their ringing does by this factor.
const STEADY: f64 = 2.0;
/// Impacts of typically less than this many times the reach of the noise are hardly told from it.
const CLEAR: f64 = 2.0;
/// Impacts that typically rise above the reach of the noise by less than this many of its standard deviations are lost in it by chance, one of 700 and
/// more: how many there were is not known.
const LOST: f64 = 3.0;

/// Impacts as onsets in samples, before anything is said of their times.
pub struct Found {
    pub onsets: Vec<Onset>,
    pub timing: Timing,
    /// Whether most pulses rise within one sample, or within one value that is held.
    pub sharp: bool,
    /// Samples for which each value is held: 1 but in a trace that was sampled more slowly than it says.
    pub held: usize,
    pub hum: Option<Hum>,
    pub warnings: Vec<String>,
    /// What was looked at: how far noise reaches from the level, how far the trace does, and bursts that were left out as too low.
    reach: f64,
    highest: f64,
    low: usize,
    /// Whether some impacts are lost in the noise.
    pub lost: bool,
}

impl Found {
    /// Why there is no interval, and what may be done about it.
    pub fn too_few(&self, unit: &str) -> Error {
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

/// Finds the impacts of a trace of this sampling rate.
pub fn find(trace: &Trace, rate: f64, options: &ImpactsOptions) -> Found {
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
