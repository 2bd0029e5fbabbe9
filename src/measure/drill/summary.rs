//! From what the passes found to estimates and sentences.

use super::passing::Pass;
use super::result::{BeamResult, Displacement, Drill, Phases, Pulses};
use super::{
    DrillOptions, FaultCount, Found, Impact, NoiseFloor, Running, Smoothing, Survey, Turns, rebound,
};
use crate::measure::Estimate;
use crate::measure::exposure::Exposure;
use crate::signal::welch::Stream;
use std::f64::consts::TAU;

/// Everything that the passes leave behind.
pub(super) struct Measured<'a> {
    pub options: &'a DrillOptions,
    pub rate: f64,
    pub velocity: &'a Survey,
    pub reference: &'a Survey,
    pub found: &'a Found,
    pub edge: f64,
    pub turns: &'a Turns,
    pub pass: Pass<'a>,
    pub still: Option<&'a Stream>,
    pub exposure: Option<Exposure>,
    pub excerpt: (usize, Vec<f64>, Vec<f64>),
}

pub(super) fn summary(m: Measured<'_>) -> Drill {
    let (rate, options) = (m.rate, m.options);
    let (impacts, hidden) = m.pass.jumps.clone().finish(rate, m.edge);
    let mean = m.pass.average.mean();
    let period =
        m.turns.turns.iter().map(|t| t.end - t.start).sum::<f64>() / m.turns.turns.len() as f64 / rate;
    let value = super::displacement(&mean, period);
    let mut spread = Running::default();
    m.turns.speeds(rate).for_each(|s| spread.push(s));
    let over = |running: Running, method: &str| {
        let std = running.std() / (running.n() as f64).sqrt();
        Estimate::new(running.mean(), Some(std), "m", running.n(), method)
    };
    let still =
        m.still.and_then(|still| NoiseFloor::new(m.pass.spectrum.as_ref()?, still, rate, options.margin));
    let count = m.pass.count;
    let (taken, clipped) = within_range(&impacts);
    let (restitution, no_restitution) = match rebound::restitution(&taken, options) {
        Ok(found) => (found, None),
        Err(why) => (None, Some(why)),
    };
    let mut result = Drill {
        speed: m.turns.speed(rate, m.edge),
        speed_variation: spread.std(),
        cycles: m.turns.turns.len(),
        averaged: m.pass.averaged,
        reference: Pulses {
            edges: m.found.edges.len(),
            missing: m.turns.missing,
            extra: m.turns.extra,
            pauses: m.turns.pauses,
            std: m.edge / rate,
        },
        before: mean_of(&taken, "m/s", "parabola up to the contact, mean over impacts", |i| i.before),
        after: mean_of(&taken, "m/s", "parabola from the contact on, mean over impacts", |i| i.after),
        phase: phase(&taken),
        phase_variation: phase_scatter(&taken),
        energy: options.mass.and_then(|m| {
            mean_of(&taken, "J", "½ m v² before, mean over impacts", |i| 0.5 * m * i.before * i.before)
        }),
        energy_given: options.mass.and_then(|m| {
            let lost = |i: &Impact| 0.5 * m * (i.before * i.before - i.after * i.after);
            mean_of(&taken, "J", "½ m (v² before − v² after), mean over impacts", lost)
        }),
        restitution,
        impacts,
        hidden,
        clipped,
        average: Phases {
            phase: m.pass.average.phase(),
            mean,
            std: m.pass.average.std(),
            range: m.pass.average.range(),
        },
        displacement: Displacement {
            value,
            stroke: over(m.pass.motion.stroke(), "peak to peak of the integrated velocity, mean over turns"),
            drift: over(m.pass.motion.drift(), "integral of the velocity over a turn, mean over turns"),
        },
        dropouts: count.dropouts,
        spikes: count.spikes,
        faults: count,
        bandwidth: m.pass.motion.bandwidth(rate),
        noise_floor: still,
        exposure: m.exposure,
        beam: BeamResult { factor: options.beam.factor(), per_degree: options.beam.per_degree() },
        smoothing: m.pass.corner.map(|corner| options.smoothing.stated(corner, rate)),
        speeds: m.turns.speeds(rate).collect(),
        times: m.turns.turns.iter().map(|t| t.start / rate).collect(),
        excerpt: m.excerpt.1,
        excerpt_reference: m.excerpt.2,
        excerpt_time: (m.excerpt.0 as f64 / rate, 1.0 / rate),
        warnings: Vec::new(),
    };
    if one_sided(clipped, result.impacts.len()) {
        let means = [
            &mut result.before,
            &mut result.after,
            &mut result.energy,
            &mut result.energy_given,
            &mut result.restitution,
        ];
        means.into_iter().flatten().for_each(|e| e.std = None);
    }
    result.warnings = warnings(
        &result,
        options,
        count,
        (m.velocity, m.reference, m.found),
        (m.pass.left_out, m.turns.apart),
        m.still.is_some(),
    );
    result.warnings.extend(no_restitution);
    result
}

/// Mean over impacts, its standard uncertainty from their scatter.
pub(super) fn mean_of(
    impacts: &[Impact],
    unit: &'static str,
    method: &str,
    of: impl Fn(&Impact) -> f64,
) -> Option<Estimate> {
    let values: Vec<f64> = impacts.iter().map(of).collect();
    if values.is_empty() {
        return None;
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let std = (values.len() >= 4).then(|| super::turns::mean_variance(&values, mean).sqrt());
    Some(Estimate::new(mean, std, unit, values.len(), method))
}

/// Phases run round the circle: differences from the direction of the mean do not.
fn circle(impacts: &[Impact]) -> Option<(f64, Vec<f64>)> {
    let (s, c) = impacts.iter().fold((0.0, 0.0), |(s, c), i| {
        let (sin, cos) = (TAU * i.phase).sin_cos();
        (s + sin, c + cos)
    });
    let centre = f64::atan2(s, c) / TAU;
    let off = impacts.iter().map(|i| i.phase - centre).map(|d| d - d.round()).collect();
    (!impacts.is_empty()).then_some((centre, off))
}

fn phase(impacts: &[Impact]) -> Option<Estimate> {
    let (centre, off) = circle(impacts)?;
    let shift = off.iter().sum::<f64>() / off.len() as f64;
    let std = (off.len() >= 4).then(|| super::turns::mean_variance(&off, shift).sqrt());
    let method = "turns after the edge, mean over impacts on the circle";
    Some(Estimate::new((centre + shift).rem_euclid(1.0), std, "1", off.len(), method))
}

fn phase_scatter(impacts: &[Impact]) -> Option<f64> {
    let mut running = Running::default();
    circle(impacts)?.1.into_iter().for_each(|d| running.push(d));
    Some(running.std()).filter(|s| s.is_finite())
}

/// Impacts of the means: those that the instrument could follow, unless it could follow none.
fn within_range(impacts: &[Impact]) -> (Vec<Impact>, usize) {
    let kept: Vec<Impact> = impacts.iter().filter(|i| !i.clipped).copied().collect();
    let clipped = impacts.len() - kept.len();
    (if kept.is_empty() { impacts.to_vec() } else { kept }, clipped)
}

/// Whether leaving out `clipped` of `all` impacts may move a mean by more than its uncertainty. The impacts left out are likely
/// the fastest; without a share p of its fastest, the mean of a normal distribution lies about 2pσ lower, and its standard
/// uncertainty is σ/√n.
fn one_sided(clipped: usize, all: usize) -> bool {
    clipped > 0 && 2.0 * clipped as f64 > (all as f64).sqrt()
}

fn are(n: usize) -> &'static str {
    if n == 1 { "is" } else { "are" }
}

/// A number with its noun.
fn several(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

fn warnings(
    result: &Drill,
    options: &DrillOptions,
    count: FaultCount,
    channels: (&Survey, &Survey, &Found),
    (left_out, apart): (usize, usize),
    still: bool,
) -> Vec<String> {
    let (velocity, reference, found) = channels;
    let mut all = Vec::new();
    let mut say = |when: bool, sentence: String| {
        if when {
            all.push(sentence);
        }
    };
    pulses(result, options, (reference, found), apart, &mut say);
    let faults = count.dropouts + count.spikes;
    let share = 100.0 * (count.bridged + count.lost) as f64 / velocity.samples().max(1) as f64;
    say(
        faults > 0,
        format!(
            "{} and {} of the velocity found, {share:.2} % of the samples; {} bridged by straight lines.",
            several(count.dropouts, "drop-out"),
            several(count.spikes, "spike"),
            several(count.bridged, "sample")
        ),
    );
    say(
        count.lost > 0,
        format!(
            "{} in drop-outs too long to be bridged; {} left out.",
            several(count.lost, "sample"),
            several(left_out, "turn")
        ),
    );
    say(
        left_out > 0 && count.lost == 0,
        format!(
            "{} left out: longer than can be kept, or cut off by the end of the record.",
            several(left_out, "turn")
        ),
    );
    let limits = velocity.range().unwrap_or((0.0, 0.0));
    say(
        count.clipped > 0,
        format!(
            "{} at the end of the range, {:.3} or {:.3} m/s: the instrument was over-range, and speeds near there are too small.",
            several(count.clipped, "sample"),
            limits.0,
            limits.1
        ),
    );
    say(result.hidden > 0, format!("{} hidden by faults of the velocity.", several(result.hidden, "impact")));
    let (clipped, found) = (result.clipped, result.impacts.len());
    let taken = match (clipped == found, one_sided(clipped, found)) {
        (true, _) => "there are no others, so the means are too small and have no uncertainty",
        (_, true) => "left out of the means, which lean to the slower ones and have no uncertainty",
        _ => "left out of the means",
    };
    say(clipped > 0, format!("{} of {found} over-range: {taken}.", several(clipped, "impact")));
    say(result.impacts.is_empty(), "No impact was found: no jump of the velocity stands out.".to_owned());
    let per_degree = 100.0 * result.beam.per_degree;
    say(
        per_degree > 0.5,
        format!(
            "One degree of error in the beam angle changes every velocity by {per_degree:.1} %; that is in no uncertainty."
        ),
    );
    bandwidth(result, options, &mut say);
    let unmoved = result.restitution.is_some() && options.struck_mass.is_none();
    say(unmoved, "The restitution assumes that the struck mass does not move.".to_owned());
    say(
        result.restitution.as_ref().is_some_and(|e| !(0.0..=1.0).contains(&e.value)),
        "The restitution lies outside 0 to 1: check masses, direction of the beam, and what is struck."
            .to_owned(),
    );
    if let Some(floor) = &result.noise_floor {
        say(
            floor.bands.is_empty(),
            format!("Nowhere does the motion stand {} dB above the noise.", floor.margin),
        );
    }
    say(
        still && result.noise_floor.is_none(),
        "Motion or noise is shorter than 8192 samples: no spectra.".to_owned(),
    );
    all.extend(result.exposure.iter().flat_map(|e| e.warnings.clone()));
    all
}

/// What is to be said of the reference.
fn pulses(
    result: &Drill,
    options: &DrillOptions,
    (reference, found): (&Survey, &Found),
    apart: usize,
    say: &mut impl FnMut(bool, String),
) {
    let r = &result.reference;
    say(
        r.missing > 0,
        format!("{} missing: the turns there are left out.", several(r.missing, "reference edge")),
    );
    say(r.extra > 0, format!("{} too many: passed over.", several(r.extra, "reference edge")));
    say(r.pauses > 0, format!("The reference has {}.", several(r.pauses, "pause")));
    say(
        apart > 0,
        format!(
            "With {} pulses a turn the phase is lost in a pause: only the longest stretch between pauses is used, without {}.",
            options.pulses_per_turn,
            several(apart, "turn")
        ),
    );
    say(
        found.sharp,
        format!("The reference rises within one sample: edges are known to {:.1e} s only.", r.std),
    );
    say(
        reference.missing() > 0,
        format!(
            "{} of the reference {} missing.",
            several(reference.missing() as usize, "sample"),
            are(reference.missing() as usize)
        ),
    );
    say(
        options.pulses_per_turn > 1,
        format!(
            "With {} pulses a turn the phase counts from the first pulse of the record, whichever that is.",
            options.pulses_per_turn
        ),
    );
}

fn bandwidth(result: &Drill, options: &DrillOptions, say: &mut impl FnMut(bool, String)) {
    let b = &result.bandwidth;
    say(
        b.sampling_limited,
        format!(
            "f2 = {:.0} Hz is within a factor of two of what differences of samples can show: it is the sampling that is measured, not the motion.",
            b.f2
        ),
    );
    if let Some(limit) = options.instrument {
        say(b.f2 > limit, format!("f2 = {:.0} Hz lies beyond the instrument's {limit:.0} Hz.", b.f2));
    }
    if let Smoothing::Exponential(time) = options.smoothing {
        say(true, format!("Exponential smoothing delays average and displacement by up to {time} s."));
    }
    // The one chosen from the data stands in the result; one that was stated acts on what was asked for.
    if let Some(corner) = result.smoothing.as_ref().filter(|_| options.smoothing != Smoothing::Phases) {
        let corner = corner.corner;
        say(
            true,
            format!(
                "Average and displacement are smoothed with a corner of {corner:.1} Hz; impacts and bandwidth are not."
            ),
        );
    }
}
