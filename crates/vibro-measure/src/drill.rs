//! Hammer drills: a laser on the striker or the bit, and a pulse once a turn of the crank.
//!
//! The velocity is the signal of the laser times its sensitivity over cos α, α the angle between beam and
//! motion. Edges of the reference cut the record into turns; a phase is the fraction of a turn after the
//! edge. If the pulse comes at the upper end of the piston's stroke, this is the phase after top dead
//! centre. Without a reference the turns run from impact to impact. Besides the channels, an analysis needs
//! 25 bytes of memory a sample.
//!
//! ```
//! use vibro_measure::drill::{AngleOrigin, Beam, DrillOptions, Edge, Slices, drill};
//! let rate = 20_000.0;
//! let turn = |i: u32| f64::from(i) / 400.0; // 50 turns a second
//! // 1 V is 2 m/s; 6 m/s before an impact, −1 m/s after it, and no mean over a turn.
//! // The pulse begins a turn.
//! let speed = |s: f64| -1.0 + 7.0 * s - 5.0 * (std::f64::consts::PI * s).sin().powi(2);
//! let volts: Vec<f64> = (0..20_000).map(|i| 0.5 * speed((turn(i) + 0.4).fract())).collect();
//! let pulse: Vec<f64> = (0..20_000).map(|i| if turn(i).fract() < 0.1 { 5.0 } else { 0.0 }).collect();
//! let options = DrillOptions::new(2.0, Beam::new(0.0, AngleOrigin::Axis)?, 1, Edge::Rising);
//! let found = drill(&Slices { rate, channels: vec![&volts, &pulse] }, &options, None)?;
//! assert!((found.speed.value - 50.0).abs() < 1e-3);
//! assert!((found.impacts[0].before - 6.0).abs() < 0.05 && (found.impacts[0].phase - 0.6).abs() < 0.003);
//! # Ok::<(), vibro_record::Error>(())
//! ```

mod cycles;
mod expected;
mod faults;
mod floor;
mod groups;
mod jumps;
mod options;
mod parabola;
mod result;
mod survey;
mod train;
mod turns;

pub use cycles::{Bandwidth, Cycle, Phases};
pub use expected::{GuessedBlows, expected, rehearse};
pub use faults::FaultCount;
pub use floor::NoiseFloor;
use groups::Offset;
pub use groups::{Group, Impact};
pub(crate) use jumps::PART;
pub use options::{AngleOrigin, Beam, Corner, DrillOptions, Smoothing, TurnsFrom};
pub use result::{Displacement, Drill, Pulses};
pub(crate) use survey::levels;
pub use turns::Edge;
pub(crate) use turns::{Edges, Numbered, value};

use crate::Estimate;
use crate::converter::{analogue_step, rounding};
use crate::exposure::exposure;
use crate::mean::{Mean, scatter};
use cycles::Cycles;
use faults::State;
use jumps::Jumps;
use survey::ChannelStatistics;
use train::TurnImpacts;
use turns::{Turn, Turns};
use vibro_record::{Error, Finding, Result, median};

/// Number of turns in the excerpt, which a figure shows as measured.
const DRAWN: usize = 3;
/// Parts into which a record without known turns is cut for the search for impacts.
const PARTS: usize = 16;

/// Channels of one record.
#[derive(Debug, Clone, PartialEq)]
pub struct Slices<'a> {
    /// Sampling rate in Hz.
    pub rate: f64,
    /// Signal of the laser; reference, only if the turns come from one; then up to three accelerations of a
    /// handle in m/s². Missing samples are NaN.
    pub channels: Vec<&'a [f64]>,
}

/// Measures the turns and impacts of a drill; `still` is the velocity channel of a record without motion,
/// for the noise floor.
///
/// # Errors
/// If the parameters are impossible; if the velocity is constant or missing, or the same as the reference; if
/// the reference has no whole turn between its edges, or without a reference the impacts have no common
/// period; if a handle allows no exposure.
pub fn drill(record: &Slices<'_>, options: &DrillOptions, still: Option<&[f64]>) -> Result<Drill> {
    drill_each(record, options, still, &mut |_| Ok(()))
}

/// As [`drill`], and passes each turn of the average, resampled, to `each`.
///
/// # Errors
/// As [`drill`], and if `each` fails.
pub fn drill_each(
    record: &Slices<'_>,
    options: &DrillOptions,
    still: Option<&[f64]>,
    each: &mut dyn FnMut(&Cycle<'_>) -> Result<()>,
) -> Result<Drill> {
    options.check()?;
    let (rate, reference) = (record.rate, check(record, options)?);
    let handles = &record.channels[1 + usize::from(reference.is_some())..];
    let factor = options.sensitivity * options.beam.factor;
    let scaled = |volts: &[f64]| volts.iter().map(|v| v * factor).collect::<Vec<f64>>();
    let mut velocity = scaled(record.channels[0]);
    let survey = ChannelStatistics::of(&velocity);
    moves(&survey)?;
    let (states, faults) = faults::repair(&mut velocity, &survey, (options.longest_dropout * rate) as usize);
    let marks = match reference {
        Some(reference) => Marks::of_reference(reference, record.channels[0], options, options.delay * rate)?,
        None => Marks::of_impacts(&velocity, &states, options, rate)?,
    };
    let (turns, edge) = (Turns::new(&marks.at, options.pulses_per_turn)?, marks.std);
    let whole = &turns.whole;
    let typical = median(whole.iter().map(|t| (t.end - t.start) / rate));
    options.check_turn(typical)?;
    let (drawn, excerpt, excerpt_reference) =
        excerpt(whole, record.channels[0], reference.unwrap_or_default(), options.delay * rate);
    let smoothing = options.smoothing.corner(options.points, typical, rate);
    let smooth = smoothing.map(|corner| corner.smooth(&velocity, rate)).transpose()?;
    let smooth = smooth.as_deref().unwrap_or(&velocity);
    let mut cycles = Cycles::new(rate, options.points);
    let sound = || whole.iter().copied().enumerate().filter(|(_, turn)| turn.is_measured(&states));
    for (number, turn) in sound() {
        cycles.differentiate(&velocity, &states, turn);
        cycles.integrate(smooth, &velocity, turn);
        each(&cycles.average(smooth, &states, number, turn))?;
    }
    let (mut stroke, drift) = (Mean::of(&cycles.stroke), Mean::of(&cycles.drift));
    let (speed, speed_wanders) = turns.speed(rate, edge);
    let period = 1.0 / speed.value;
    // Largest error of the mean from over-range: each clipped sample lacks at most the whole range.
    let beyond = faults.clipped as f64 / velocity.len() as f64 * (survey.high - survey.low);
    let offset = Offset::of(&drift, period, beyond);
    let around: Vec<f64> = velocity.iter().map(|v| v - offset.value).collect();
    let jumps = Jumps::of(&around, &states, options.lengths(rate), sound(), Some(options.turns_from));
    let (hidden, gap, averaged) = (jumps.hidden, jumps.gap, cycles.stroke.len());
    let (mut impacts, residuals) = jumps.finish(rate, edge);
    let reach = around.iter().fold(0.0f64, |reach, v| reach.max(v.abs()));
    let groups = groups::groups(&mut impacts, &residuals, gap, averaged, options, &offset);
    let groups: Vec<Group> = groups.into_iter().map(|group| group.within(reach)).collect();
    groups::doubt_impacts(&mut impacts, &groups);
    stroke.std = stroke.std.map(|std| std.hypot(lacking(&cycles.blunted, &groups, reach, rate)));
    let strongest = groups.first();
    let speeds: Vec<f64> = whole.iter().map(|t| rate / (t.end - t.start)).collect();
    let metres = |mean: Mean, method| {
        Estimate::new(mean.value, mean.std, "m", mean.n, method).with_relative(options.clock)
    };
    let noise_floor = still.and_then(|still| NoiseFloor::new(velocity, scaled(still), rate, options.margin));
    let slow = slow_changes([
        ("speed", speed_wanders),
        ("stroke", stroke.wanders),
        ("drift", drift.wanders),
        ("impacts", strongest.is_some_and(|g| g.wanders)),
    ]);
    let mut result = Drill {
        speed: speed.with_relative(options.clock),
        speed_variation: scatter(&speeds),
        cycles: whole.len(),
        averaged,
        turns_from: options.turns_from,
        reference: marks.count(&turns, rate),
        before: strongest.map(|g| g.before.clone()),
        after: strongest.map(|g| g.after.clone()),
        phase: strongest.map(|g| g.phase.clone()),
        energy: strongest.and_then(|g| g.energy.clone()),
        energy_given: strongest.and_then(|g| g.energy_given.clone()),
        restitution: strongest.and_then(|g| g.restitution.clone()),
        groups,
        hidden,
        clipped: impacts.iter().filter(|i| i.clipped).count(),
        impacts,
        displacement: Displacement {
            value: cycles::displacement(&cycles.phases().mean, period),
            stroke: metres(stroke, "peak to peak of the integrated velocity, mean over turns"),
            drift: metres(drift, "integral of the velocity over a turn, mean over turns"),
        },
        average: cycles.phases(),
        dropouts: faults.dropouts,
        faults,
        bandwidth: cycles.bandwidth(),
        noise_floor,
        exposure: if handles.is_empty() { None } else { Some(exposure(rate, handles, options.hours)?) },
        beam: options.beam,
        smoothing,
        speeds,
        times: whole.iter().map(|t| t.start / rate).collect(),
        excerpt_time: (drawn as f64 / rate, 1.0 / rate),
        excerpt: scaled(&excerpt),
        excerpt_reference,
        findings: Vec::new(),
    };
    let over_range = result.over_range(&survey);
    result.findings = result::findings(&result, options, marks.sharp, still.is_some());
    result.findings.extend(faults::recurring(&states, &turns.whole));
    result.findings.extend(over_range);
    result.findings.extend(slow);
    Ok(result)
}

/// Refuses a velocity that is constant or missing.
fn moves(velocity: &ChannelStatistics) -> Result<()> {
    if velocity.low < velocity.high {
        return Ok(());
    }
    let error = Error::refused("the velocity is constant, or missing");
    Err(error.hint("check that the laser sees the target").setting("velocity"))
}

/// Finding that names the quantities that change slowly; `quantities` has a flag for each.
fn slow_changes(quantities: [(&str, bool); 4]) -> Option<Finding> {
    let slow = quantities.into_iter().filter(|(_, wanders)| *wanders).map(|(name, _)| name);
    let slow: Vec<&str> = slow.collect();
    let changes = || Finding::caution("drill-slow-changes").name("quantities", slow.join(", "));
    (!slow.is_empty()).then(changes)
}

/// Standard uncertainty in m of a stroke from two losses: by the smoothing, and by the travel between an
/// impact, which reverses the mass abruptly, and the nearest sample. `reach` in m/s is the largest velocity
/// of the record.
fn lacking(blunted: &[f64], groups: &[Group], reach: f64, rate: f64) -> f64 {
    let corner = |group: &Group| {
        // The upper limit of an unknown velocity is the largest of the record.
        let known = |v: f64| if v.is_nan() { reach } else { v.abs() };
        let [before, after] = [&group.before, &group.after].map(|v| known(v.value));
        if before + after > 0.0 { before * after / (before + after) / rate } else { 0.0 }
    };
    let corners: f64 = groups.iter().map(corner).sum();
    (Mean::of(blunted).value.abs() + corners) / f64::sqrt(3.0)
}

/// Checks that there are a rate, a velocity and a reference that differ. Returns the reference, where the
/// turns come from one.
fn check<'a>(record: &Slices<'a>, options: &DrillOptions) -> Result<Option<&'a [f64]>> {
    let rate = record.rate;
    if !(rate.is_finite() && rate > 0.0) {
        let found = format!("a sampling rate of {rate} Hz");
        return Err(Error::usage(found, "a finite number above 0").setting("rate"));
    }
    match (record.channels.as_slice(), options.turns_from) {
        ([_, ..], TurnsFrom::Impacts) => Ok(None),
        ([velocity, reference, ..], _) if velocity == reference => {
            Err(Error::refused("velocity and reference are the same channel")
                .hint("name two channels; `vibro info` lists them")
                .setting("velocity")
                .setting("reference"))
        }
        ([_, reference, ..], _) => Ok(Some(reference)),
        (few, _) => Err(Error::usage(format!("{} channels", few.len()), "a velocity and a reference")),
    }
}

/// Edges or impacts that begin the turns, in samples of the velocity.
struct Marks {
    at: Vec<f64>,
    /// Standard uncertainty of each, in samples.
    std: f64,
    /// Whether edges rise within one sample.
    sharp: bool,
    /// Impacts that begin no turn.
    others: usize,
}

impl Marks {
    /// Numbers of edges found, missing and false.
    fn count(&self, turns: &Turns, rate: f64) -> Pulses {
        let (edges, extra) = (self.at.len(), turns.extra + self.others);
        Pulses { edges, missing: turns.missing, extra, pauses: turns.pauses, std: self.std / rate }
    }

    /// Edges of a reference, as positions in the velocity channel, which lags by `delay` samples.
    fn of_reference(
        reference: &[f64],
        velocity: &[f64],
        options: &DrillOptions,
        delay: f64,
    ) -> Result<Marks> {
        let (low, high) = levels(reference).unwrap_or((f64::NAN, f64::NAN));
        // A stated level is the middle of the edge; the nearer of the two levels gives the height.
        let middle = options.level.unwrap_or(0.5 * (low + high));
        let half = (middle - low).min(high - middle);
        let mut edges = Edges::of(reference, (middle - half, middle + half), options.edge);
        survey::check_pulses(velocity, (reference, (low, high)), &edges.at)?;
        let last = velocity.len().saturating_sub(1) as f64;
        edges.at.iter_mut().for_each(|edge| *edge += delay);
        edges.at.retain(|edge| (0.0..=last).contains(edge));
        let std = edges.std(survey::noise(reference).max(rounding(analogue_step(reference))));
        Ok(Marks { std, sharp: edges.sharp, others: 0, at: edges.at })
    }

    /// The impacts that begin the turns: they follow each other at the period of their pattern.
    fn of_impacts(velocity: &[f64], states: &[State], options: &DrillOptions, rate: f64) -> Result<Marks> {
        // A turn is half the record at most.
        options.check_turn(0.5 * velocity.len() as f64 / rate)?;
        // In each part of the record, the largest jump sets the threshold for all others.
        let part = velocity.len() as f64 / PARTS as f64;
        let parts = (0..PARTS).map(|k| (k, Turn { start: part * k as f64, end: part * (k + 1) as f64 }));
        let jumps = Jumps::of(velocity, states, options.lengths(rate), parts, None);
        let TurnImpacts { at, std, others } = TurnImpacts::of(&jumps.finish(rate, 0.0).0, rate)?;
        Ok(Marks { at, std, sharp: false, others })
    }
}

/// Some turns in the middle of the record, as measured: their first sample, velocity and reference. The
/// reference is `delay` samples earlier.
fn excerpt(turns: &[Turn], velocity: &[f64], reference: &[f64], delay: f64) -> (usize, Vec<f64>, Vec<f64>) {
    let first = turns.len().saturating_sub(DRAWN) / 2;
    let shown = &turns[first..(first + DRAWN).min(turns.len())];
    let from = shown.first().map_or(0, |t| t.start as usize);
    let to = shown.last().map_or(0, |t| t.end as usize + 1);
    let earlier = |i: usize| i.saturating_add_signed((-delay).round() as isize);
    let beside = reference.iter().take(earlier(to)).skip(earlier(from));
    (from, velocity[from..to].to_vec(), beside.copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// v = −1.3 m/s + 5.5 m/s u^p with zero mean, where u is the fraction of a turn: the displacement falls
    /// until u = (1.3/5.5)^(1/p), and its highest point is the impact.
    #[test]
    fn the_stroke_of_a_sharp_impact_lies_within_its_uncertainty() {
        let (back, range, f, rate) = (1.3, 5.5, 44.1, 40_000.0);
        let p = range / back - 1.0;
        let falls = f64::powf(back / range, 1.0 / p);
        let truth = (back * falls - range * falls.powf(p + 1.0) / (p + 1.0)) / f;
        let turn = |i: u32| f * f64::from(i) / rate;
        let volts: Vec<f64> = (0..80_000).map(|i| range * (turn(i) + 0.65).fract().powf(p) - back).collect();
        let pulse: Vec<f64> = (0..80_000).map(|i| f64::from(u8::from(turn(i).fract() < 0.1))).collect();
        for smoothing in [Smoothing::Off, Smoothing::LowPass(12_500.0), Smoothing::LowPass(2000.0)] {
            let beam = Beam::new(0.0, AngleOrigin::Axis).unwrap();
            let options = DrillOptions { smoothing, ..DrillOptions::new(1.0, beam, 1, Edge::Rising) };
            let found = drill(&Slices { rate, channels: vec![&volts, &pulse] }, &options, None).unwrap();
            let stroke = &found.displacement.stroke;
            let (off, std) = (stroke.value / truth - 1.0, stroke.std.unwrap() / truth);
            // The true peak lies within a sample or the width of the smoothing: (1.3 · 4.2/5.5) m/s times
            // 1/40 kHz is 0.2 % of the stroke.
            assert!(off.abs() < 2.5 * std && std < 0.01, "{smoothing:?}: {off:.2e} ± {std:.2e}");
        }
    }

    #[test]
    fn a_velocity_that_comes_late_keeps_its_phase_where_the_delay_is_stated() {
        let turn = |i: i32| f64::from(i) / 400.0;
        let volts = |late: i32| -> Vec<f64> {
            (0..20_000).map(|i| 0.5 * (-1.0 + 7.0 * (turn(i - late) + 0.4).rem_euclid(1.0))).collect()
        };
        let pulse: Vec<f64> = (0..20_000).map(|i| if turn(i).fract() < 0.1 { 5.0 } else { 0.0 }).collect();
        let found = |late: i32, delay: f64| {
            let values = volts(late);
            let beam = Beam::new(0.0, AngleOrigin::Axis).unwrap();
            let options = DrillOptions { delay, ..DrillOptions::new(2.0, beam, 1, Edge::Rising) };
            let channels = Slices { rate: 20_000.0, channels: vec![&values, &pulse] };
            let found = drill(&channels, &options, None).unwrap();
            // The edge that begins the turns drawn, at half the height of the pulse, lies on their first
            // samples.
            assert!(found.excerpt_reference.len() == found.excerpt.len() && found.excerpt.len() > 1200);
            let edge = found.excerpt_reference.iter().position(|v| *v > 2.5);
            assert!(edge.is_some_and(|i| i <= 1), "{edge:?} with a delay of {delay} s");
            found.impacts[5].phase
        };
        // 5 samples of the 400 in a turn: 0.0125 turns.
        let (right, late) = (found(0, 0.0), found(5, 0.0));
        assert!((late - right - 0.0125).abs() < 1e-9, "{right} {late}");
        assert!((found(5, 5.0 / 20_000.0) - right).abs() < 1e-9);
    }
}
