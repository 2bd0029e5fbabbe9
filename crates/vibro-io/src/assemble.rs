//! Builds records from values: chooses the kind of record and its axis.

use crate::options::Options;
use vibro_record::code;
use vibro_record::units::{self, Quantity, Unit};
use vibro_record::{
    Axis, AxisKind, Clock, Error, Finding, Frf, Grid, Meta, Record, Result, Scaling, Spectrum, Stretch,
    Trace, Values, Window, is_fine, stretches, uniform_std,
};

/// What a file states about a spectrum.
#[derive(Debug, Clone, Default)]
pub struct Spectral {
    /// Scaling, if it is stated.
    pub scaling: Option<Scaling>,
    pub window: Option<Window>,
    pub enbw: Option<f64>,
    /// Whether complex values are stated to be a frequency response function.
    pub frf: bool,
    /// Finding to report instead of [`code::SCALING_UNSAID`] if the scaling is unknown.
    pub doubt: Option<Finding>,
}

/// Builds the record of values in SI units. Real values over frequency are a spectrum, other real values a
/// trace. Complex values are a frequency response function if the file states so, or if it states no scaling
/// and their unit is a response divided by a force; else a spectrum.
///
/// # Errors
/// If values over time are complex.
pub fn record(mut meta: Meta, axis: Axis, values: Values, said: Spectral) -> Result<Record> {
    let values = match values {
        Values::Complex(_) if axis.kind == AxisKind::Time => return Err(complex_over_time()),
        Values::Real(values) if axis.kind != AxisKind::Frequency => {
            return Ok(Record::Trace(Trace { meta, axis, values }));
        }
        Values::Complex(values) if said.frf || (said.scaling.is_none() && meta.quantity.is_function()) => {
            return Ok(Record::Frf(Frf { meta, axis, values }));
        }
        values => values,
    };
    let scaling = said.scaling.unwrap_or(Scaling::Unknown);
    if scaling == Scaling::Unknown {
        meta.found(said.doubt.unwrap_or_else(|| Finding::caution(code::SCALING_UNSAID)));
    }
    Ok(Record::Spectrum(Spectrum { meta, axis, values, scaling, window: said.window, enbw: said.enbw }))
}

/// Refuses complex values over time.
pub fn complex_over_time() -> Error {
    Error::usage("complex values over time", "complex values over frequency, or real values over time")
        .hint("state the base band, and no sampling rate; or export real and imaginary part as two channels")
        .setting("base_band")
}

/// Multiplies values by the factor of their unit to SI.
///
/// # Errors
/// If a result overflows a double.
pub fn to_si(values: &mut Values, factor: f64) -> Result<()> {
    if factor == 1.0 {
        return Ok(());
    }
    match values {
        Values::Real(values) => units::scale(values, factor),
        Values::Complex(values) => {
            units::scale(values.iter_mut().flat_map(|v| [&mut v.re, &mut v.im]), factor)
        }
    }
}

impl Options {
    /// Sets the unit of a record: the one that the user states, else `said`, the file's. Returns the factor
    /// to SI.
    pub(crate) fn adopt(&self, meta: &mut Meta, said: Option<&str>) -> f64 {
        // A coherence stored with an FRF has no unit: the unit that the user states is that of the FRF.
        let without_unit = said.is_none_or(|u| matches!(u.trim(), "" | "1"));
        if self.unit.is_some() && without_unit && meta.name.to_lowercase().contains("coherence") {
            return meta.adopt_unit("1");
        }
        if let Some(given) = &self.unit {
            if let Some(said) = said.filter(|u| Unit::parse_or_opaque(u) != *given) {
                let differs = Finding::caution("unit-overrides-file").name("file", said);
                meta.found(differs.name("used", given.symbol()));
            }
            return meta.adopt_unit(given.symbol());
        }
        if let Some(said) = said {
            return meta.adopt_unit(said);
        }
        meta.found(Finding::caution(code::UNIT_UNSAID));
        1.0
    }
}

/// Quantity and unit of an abscissa; empty if it is neither time nor frequency.
pub fn domain(kind: &AxisKind) -> (&'static str, &'static str) {
    match kind {
        AxisKind::Time => ("time", "s"),
        AxisKind::Frequency => ("frequency", "Hz"),
        AxisKind::Index | AxisKind::Other(_) => ("", ""),
    }
}

/// An axis built from individually stored values, with its uncertainty and the finding on it.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgedAxis {
    pub axis: Axis,
    /// Relative standard uncertainty of the step; 0 for an uneven axis.
    pub step_relative_std: f64,
    /// Finding for an axis that is uneven, jitters or was printed with too few digits.
    pub found: Option<Finding>,
}

/// Decides whether `values` (SI units) form an even axis. `resolution` is half a unit in their last digit;
/// `what` names them in findings, e.g. `column "t"`. The outcomes, in the order in which they are tried:
/// 1. steps equal within the digits, or fewer than two values: no finding;
/// 2. rising times with jitter, and the user resamples (`will_resample`): the stored times, no finding;
/// 3. an even clock: an even axis with `axis-jitter` or `axis-rounded`, or with `axis-rounded-or-lost` if a
///    shorter step with a few lost samples fits the printed times as well;
/// 4. times with even stretches between gaps: the stored times with `samples-lost`, or with `axis-backwards`
///    if they do not rise;
/// 5. other values: the stored values with `axis-uneven`, or with `axis-backwards` if they do not rise.
pub fn from_values(
    kind: AxisKind,
    values: Vec<f64>,
    resolution: f64,
    what: &str,
    will_resample: bool,
) -> JudgedAxis {
    let n = values.len();
    let mean_step = (values.last().unwrap_or(&0.0) - values.first().unwrap_or(&0.0)) / n.max(2) as f64;
    // With fine digits, steps count as equal within the resolution. Coarse digits could hide uneven steps, so
    // the printed steps must be equal but for the rounding of doubles.
    let tolerance = if is_fine(resolution, mean_step) { resolution } else { EQUAL_STEPS * resolution };
    let axis = Axis::from_values(kind, values, tolerance);
    let Axis { kind, grid: Grid::Uneven(values) } = axis else {
        let step_relative_std = axis.step().map_or(0.0, |step| uniform_std(resolution, n) / step);
        return JudgedAxis { axis, step_relative_std, found: None };
    };
    if n < 2 {
        let axis = Axis { kind, grid: Grid::Uneven(values) };
        return JudgedAxis { axis, step_relative_std: 0.0, found: None };
    }
    let time = kind == AxisKind::Time;
    let clock = if time { Clock::of(&values, resolution) } else { Clock::rounded(&values, resolution) };
    let steps = || values.windows(2).map(|w| w[1] - w[0]);
    let (smallest, largest) =
        steps().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(d), b.max(d)));
    let long = steps().filter(|d| *d > f64::midpoint(smallest, largest)).count();
    let with_steps = |found: Finding| {
        let found = found.name("column", what).name("unit", domain(&kind).1);
        let found = found.number("smallest", smallest).number("largest", largest);
        Some(found.count("long", long).count("n", n - 1))
    };
    let between_gaps = if time && clock.is_none() { stretches(&values, resolution) } else { Vec::new() };
    // A single stretch that covers the whole record, with RMS jitter below `CALM_JITTER` of a step, is an
    // even clock after all.
    let whole = between_gaps.first().filter(|stretch| stretch.samples == (0..n)).map(|stretch| stretch.clock);
    let clock = clock.or(whole.filter(|clock| clock.jitter <= CALM_JITTER * clock.step));
    let keeps_stored = will_resample && clock.is_some_and(|clock| clock.jitter > 0.0) && smallest > 0.0;
    if let Some(clock) = clock.filter(|_| !keeps_stored) {
        let digit = 2.0 * resolution;
        // Printed steps of one and of two digits have two explanations: an even step slightly above one
        // digit, or an even step of one digit with lost samples.
        let is_digits = |step: f64, count: f64| (step / digit - count).abs() < WHOLE_DIGITS;
        let one_or_two = is_digits(smallest, 1.0) && is_digits(largest, 2.0);
        let perhaps_lost = time && one_or_two && (long as f64) < LARGEST_SHARE_LOST * n as f64;
        let found = match clock.jitter > 0.0 {
            true => Some(clock.finding(what)),
            false if perhaps_lost => {
                let lost = Finding::doubt(code::AXIS_ROUNDED_OR_LOST).number("step", clock.step);
                with_steps(lost.without_estimate())
            }
            false => with_steps(clock.finding(what)),
        };
        let grid = Grid::Even { start: clock.start, step: clock.step, n };
        return JudgedAxis { axis: Axis { kind, grid }, step_relative_std: clock.relative(), found };
    }
    // Samples closer than the last printed digit have equal printed times: that is no step backwards.
    let rises = smallest > 0.0 || (smallest == 0.0 && !is_fine(resolution, mean_step));
    let gaps = with_gaps(&between_gaps, if rises { code::SAMPLES_LOST } else { code::AXIS_BACKWARDS });
    let code = if smallest > 0.0 { "axis-uneven" } else { code::AXIS_BACKWARDS };
    let found = gaps.unwrap_or_else(|| Finding::caution(code));
    let found = if keeps_stored { None } else { with_steps(found) };
    JudgedAxis { axis: Axis { kind, grid: Grid::Uneven(values) }, step_relative_std: 0.0, found }
}

/// If the share of double-length steps is below this, lost samples are possible as well as rounding, and a
/// caution says so. A larger share is rounding: instruments lose fewer samples.
const LARGEST_SHARE_LOST: f64 = 0.2;

/// Largest RMS jitter, divided by the step, of a clock without lost samples. If every third sample is lost,
/// the others deviate by 1/6 of a step from another even grid; other patterns of loss deviate more.
const CALM_JITTER: f64 = 0.1;

/// The finding `code` on times with even stretches between lost samples, pauses or restarts: number and
/// durations of the stretches, and clock of the longest. `None` if there are no stretches.
fn with_gaps(all: &[Stretch], code: &'static str) -> Option<Finding> {
    let (number, longest) = Stretch::longest(all)?;
    let (rate, std) = longest.clock.rate();
    let found = Finding::caution(code).count("stretches", all.len()).count("longest", number);
    let found = found.number("duration", longest.duration()).number("start", longest.clock.start);
    let found = found.number("rate", rate).number("std", std);
    let durations: Vec<f64> = all.iter().map(Stretch::duration).collect();
    Some(if all.len() <= MOST_LISTED { found.numbers("durations", durations) } else { found })
}

/// Number of the longest even stretch, from 1, as the finding on lost samples states it; `None` without that
/// finding.
pub fn longest_stretch(findings: &[Finding]) -> Option<usize> {
    let lost = findings.iter().find(|found| found.code == code::SAMPLES_LOST)?;
    lost.get("longest").map(|number| number as usize)
}

/// Resolution that is assumed for equal steps with coarse digits, divided by the printed resolution. It
/// covers the rounding of doubles: 1e-7 s for seconds since 1970.
const EQUAL_STEPS: f64 = 1e-2;

/// Largest difference between a step and a whole number of printed digits, in digits, that counts as none.
const WHOLE_DIGITS: f64 = 1e-2;

/// Largest relative difference between the nominal rate of a logger or telephone and the rate of its clock.
pub const NOMINAL: f64 = 1e-2;

/// Largest number of stretches whose durations a finding lists one by one.
const MOST_LISTED: usize = 12;

/// What a file states about an abscissa, in SI units.
pub struct Abscissa {
    pub kind: AxisKind,
    /// Start and step.
    pub even: Option<(f64, f64)>,
    /// Instants or spectral lines that are stored one by one; empty if none are stored.
    pub stored: Vec<f64>,
    /// Half a unit in the last digit of the stored values.
    pub resolution: f64,
}

/// Largest relative difference between the last spectral line and the base band that the user states. The
/// base band may be rounded to three digits.
const BAND_ROUNDING: f64 = 5e-3;

impl Abscissa {
    /// An abscissa with even start and step, or without any.
    pub fn even(kind: AxisKind, even: Option<(f64, f64)>) -> Abscissa {
        Abscissa { kind, even, stored: Vec::new(), resolution: 0.0 }
    }

    /// The abscissa of a known axis.
    pub fn of(axis: Axis) -> Abscissa {
        match axis {
            Axis { kind, grid: Grid::Even { start, step, .. } } => Abscissa::even(kind, Some((start, step))),
            Axis { kind, grid: Grid::Uneven(stored) } => Abscissa { stored, ..Abscissa::even(kind, None) },
        }
    }

    /// The axis of `n` values: from the user's rate or base band, else from the file's step, else from stored
    /// values. Without any of these, or if the step is not positive and finite, the axis counts samples.
    pub fn axis(self, n: usize, options: &Options, meta: &mut Meta) -> Axis {
        let Abscissa { kind, even, stored, resolution } = self;
        let silent = even.is_none() && stored.len() != n;
        if let (Some(band), true) = (options.base_band, silent && options.rate.is_none()) {
            return Axis::frequency(0.0, band / n.saturating_sub(1).max(1) as f64, n);
        }
        if let Some(band) = options.base_band {
            let ends_at = |end: f64| (end - band).abs() <= BAND_ROUNDING * band;
            // LabVIEW labels the axis of a spectrum as time. The last spectral line lies at the base band or
            // one step below.
            if let (AxisKind::Time, Some((0.0, step))) = (&kind, even)
                && (ends_at(step * n as f64) || ends_at(step * n.saturating_sub(1) as f64))
            {
                return Axis::frequency(0.0, step, n);
            }
            meta.found(Finding::caution("band-unused"));
        }
        let (start, step) = match (options.rate.filter(|_| kind == AxisKind::Time), even) {
            (Some(rate), _) => {
                let (start, step) = even.unzip();
                let said = 1.0 / rate;
                // Files print steps with six digits: smaller differences are rounding.
                if !silent && step.is_none_or(|step| (step / said - 1.0).abs() > 1e-5) {
                    let found = match step {
                        Some(step) => Finding::caution("rate-overrides-step").number("step", step),
                        None => Finding::caution("rate-overrides-instants"),
                    };
                    meta.found(found.number("rate", rate));
                }
                (start.unwrap_or(0.0), said)
            }
            (None, Some(even)) => even,
            (None, None) if silent => {
                meta.found(Finding::caution(code::ABSCISSA_UNSAID));
                return Axis::index(n);
            }
            // Spectral lines keep their stored frequencies, even or not.
            (None, None) if kind != AxisKind::Time => return Axis { kind, grid: Grid::Uneven(stored) },
            (None, None) => {
                let judged = from_values(kind, stored, resolution, "abscissa", options.resample.is_some());
                (meta.clock, meta.resolution) = (judged.step_relative_std, resolution);
                meta.findings.extend(judged.found);
                return judged.axis;
            }
        };
        if step > 0.0 && step.is_finite() && start.is_finite() {
            return Axis { kind, grid: Grid::Even { start, step, n } };
        }
        meta.found(Finding::caution("increment-impossible").number("step", step));
        Axis::index(n)
    }
}

/// Resolution of binary `values`, in their unit: half a millionth of the mean step, since a time that sums
/// steps drifts by rounding; at least the rounding of the largest value (2⁻²⁴ of it for 32-bit floats, which
/// `single` states, else 2⁻⁵³).
pub fn drift(values: &[f64], single: bool) -> f64 {
    let (first, last) = (values[0], values[values.len() - 1]);
    let drift = 0.5e-6 * (last - first) / (values.len() - 1).max(1) as f64;
    let digits = if single { f64::from(f32::EPSILON) } else { f64::EPSILON };
    drift.max(first.abs().max(last.abs()) * digits / 2.0)
}

/// The kind of abscissa that a unit implies: time or frequency. A unit such as rpm has the dimension of a
/// frequency, but gives no frequency axis.
pub fn kind_of(unit: &Unit) -> Option<AxisKind> {
    match unit.quantity() {
        Quantity::Time => Some(AxisKind::Time),
        Quantity::Frequency if unit.symbol().ends_with("Hz") => Some(AxisKind::Frequency),
        _ => None,
    }
}

/// Unit of a time since 1970 that has none, with its factor to s: the unit that gives a date from 2001 to
/// 2096. `None` if no unit does.
pub fn epoch(first: f64) -> Option<(&'static str, f64)> {
    let since_1970 = |(_, factor): &(&str, f64)| (1e9..4e9).contains(&(first * factor));
    [("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)].into_iter().find(since_1970)
}

/// Seconds of a day.
pub const DAY: f64 = 86_400.0;

/// Whether times without a unit are days as spreadsheets count them. Two cases count as days:
/// - dates from 1982 to 2064 with at least one row per second. Read as seconds, the record would begin after
///   8 h and have steps of 12 µs or less.
/// - fractions of one day at a rate of 1 to 1000 whole hertz. Read as seconds, the rate would be 86 400 times
///   that.
pub fn is_serial(times: &[f64]) -> bool {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return false };
    let step = (last - first) / (times.len() as f64 - 1.0);
    let rate = 1.0 / (DAY * step);
    let dated = (30_000.0..60_000.0).contains(first) && *last < 60_000.0;
    let whole = (0.5..1000.5).contains(&rate) && (rate - rate.round()).abs() < 1e-6;
    dated && rate > 0.99 || whole && *first >= 0.0 && *last < 1.0
}

/// Finding that a file contains `n` values, fewer than the `declared` number.
pub fn fewer(declared: usize, n: usize) -> Finding {
    Finding::caution("fewer-values").count("declared", declared).count("n", n)
}

/// Rounds to six significant digits, enough for a message.
pub fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A logger that takes 10 samples per second, prints whole seconds and starts within a second.
    #[test]
    fn whole_seconds_of_a_faster_logger_give_its_rate() {
        for n in [34, 65, 1003] {
            let printed = (0..n).map(|i| (0.7 + 0.1 * f64::from(i)).floor()).collect();
            let JudgedAxis { axis, found, .. } =
                from_values(AxisKind::Time, printed, 0.5, "column \"t\"", false);
            // Rounding puts 0.7 + 0.1 i on a whole second or just below it, so at most one sample is
            // misplaced among those in between.
            assert!((axis.step().unwrap() - 0.1).abs() < 0.1 / f64::from(n - 20), "{n}: {:?}", axis.step());
            assert_eq!(found.unwrap().code, "axis-rounded");
        }
    }

    #[test]
    fn only_what_a_person_must_know_is_said() {
        let of = |values: &[f64], resolution| {
            let judged = from_values(AxisKind::Time, values.to_vec(), resolution, "column \"t\"", false);
            (judged.axis, judged.found)
        };
        let (axis, doubt) = of(&[0.0, 0.1, 0.2, 0.300_000_000_000_000_04], 0.0);
        assert_eq!((axis.step().is_some(), doubt), (true, None));
        // Steps of 1.25 ms, printed in whole milliseconds: every fourth printed step is longer.
        let printed: Vec<f64> = (0..16).map(|i| (1.25 * f64::from(i)).round() / 1e3).collect();
        let (axis, doubt) = of(&printed, 0.5e-3);
        // Both ends are rounded by at most half a millisecond.
        assert!((axis.step().unwrap() - 0.00125).abs() <= 1e-3 / 15.0);
        let steps = |found: Option<Finding>, code: &str| {
            let found = found.unwrap();
            assert_eq!(found.code, code);
            ["smallest", "largest", "long", "n"].map(|name| short(found.get(name).unwrap()))
        };
        assert_eq!(steps(doubt, "axis-rounded"), [1e-3, 2e-3, 4.0, 15.0]);
        assert_eq!(steps(of(&[0.0, 1.0, 3.0], 0.0).1, "axis-uneven"), [1.0, 2.0, 1.0, 2.0]);
        assert_eq!(steps(of(&[0.0, 2.0, 1.0], 0.0).1, "axis-backwards")[..2], [-1.0, 2.0]);
        assert_eq!(of(&[1.0], 0.0).1, None);
        assert_eq!(of(&[], 0.0).1, None);
    }

    #[test]
    fn lost_samples_are_not_taken_for_rounding() {
        for lost in [vec![3], vec![5, 20], vec![5, 6, 30, 70]] {
            let times: Vec<f64> =
                (0..100).filter(|i| !lost.contains(i)).map(|i| f64::from(i) / 1e3).collect();
            let judged = from_values(AxisKind::Time, times.clone(), 0.5e-3, "column \"t\"", false);
            assert_eq!(judged.axis.values(), times, "{lost:?}");
            assert_eq!(judged.found.unwrap().code, "samples-lost", "{lost:?}");
        }
    }

    /// Instants that deviate by up to 0.16 of a step lie on one even grid without lost samples; a lost
    /// sample leaves a step of at least 1.68. With every third sample lost, the others lie near another
    /// even grid.
    #[test]
    fn a_clock_that_jitters_without_a_gap_is_even() {
        let off = |i: i32| 0.16 * (f64::from((i * 7919) % 1000) / 500.0 - 1.0);
        let times: Vec<f64> = (0..1000).map(|i| 0.01 * (f64::from(i) + off(i))).collect();
        let mut lost = times.clone();
        lost.remove(400);
        let judged = |times: &[f64]| from_values(AxisKind::Time, times.to_vec(), 1e-9, "column \"t\"", false);
        let (whole, gap) = (judged(&times), judged(&lost));
        // The fitted step scatters relatively by σ√(12/n³) with σ = 0.16/√3 of a step.
        let scatter = 0.16 / 3f64.sqrt() * (12.0 / 1000f64.powi(3)).sqrt();
        let step = whole.axis.step().unwrap();
        assert!((step / 0.01 - 1.0).abs() < 4.0 * scatter, "{step}");
        assert_eq!(whole.found.unwrap().code, "axis-jitter");
        assert_eq!((gap.axis.step(), &*gap.found.unwrap().code), (None, "samples-lost"));
        let thirds: Vec<f64> = (0..60).filter(|i| i % 3 != 1).map(|i| 25.0 * f64::from(i)).collect();
        assert_eq!(judged(&thirds).axis.values(), thirds);
    }
}
