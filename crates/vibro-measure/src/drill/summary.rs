//! From what the passes found to estimates and sentences.

use super::groups;
use super::passing::Pass;
use super::result::{BeamResult, Displacement, Drill, Phases, Pulses};
use super::{DrillOptions, FaultCount, Found, NoiseFloor, Running, Smoothing, Survey, Turns};
use crate::Estimate;
use crate::exposure::Exposure;
use crate::mean::Mean;
use vibro_record::units::notation::quantity;
use vibro_signal::welch::Stream;

/// A displacement that drifts by more than this part of the stroke in a turn is no steady motion.
const DRIFTING: f64 = 0.1;

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
    let (mut impacts, misfits, hidden) = m.pass.jumps.clone().finish(rate, m.edge);
    let groups = groups::groups(&mut impacts, &misfits, m.pass.averaged, options);
    let strongest = groups.first();
    let mean = m.pass.average.mean();
    let period =
        m.turns.turns.iter().map(|t| t.end - t.start).sum::<f64>() / m.turns.turns.len() as f64 / rate;
    let value = super::displacement(&mean, period);
    let mut spread = Running::default();
    m.turns.speeds(rate).for_each(|s| spread.push(s));
    let mut wander = Vec::new();
    if m.turns.wander(m.edge) {
        wander.push("speed");
    }
    let mut over = |values: &[f64], name: &'static str, method: &str| {
        let mean = Mean::of(values);
        if mean.wanders {
            wander.push(name);
        }
        Estimate::new(mean.value, mean.std, "m", mean.n, method)
    };
    let still =
        m.still.and_then(|still| NoiseFloor::new(m.pass.spectrum.as_ref()?, still, rate, options.margin));
    let count = m.pass.count;
    let clipped = impacts.iter().filter(|i| i.clipped).count();
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
        before: strongest.map(|g| g.before.clone()),
        after: strongest.map(|g| g.after.clone()),
        phase: strongest.map(|g| g.phase.clone()),
        phase_variation: strongest.and_then(|g| g.phase_variation),
        energy: strongest.and_then(|g| g.energy.clone()),
        energy_given: strongest.and_then(|g| g.energy_given.clone()),
        restitution: strongest.and_then(|g| g.restitution.clone()),
        groups,
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
            stroke: over(
                m.pass.motion.stroke(),
                "stroke",
                "peak to peak of the integrated velocity, mean over turns",
            ),
            drift: over(
                m.pass.motion.drift(),
                "drift",
                "integral of the velocity over a turn, mean over turns",
            ),
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
    if result.groups.first().is_some_and(|g| g.wanders) {
        wander.push("impacts");
    }
    if count.clipped > 0 {
        result.displacement.over_range();
    }
    result.warnings = warnings(
        &result,
        options,
        count,
        (m.velocity, m.reference, m.found),
        (m.pass.left_out, m.turns.apart),
        m.still.is_some(),
    );
    result.warnings.extend(wandering(&wander));
    result
}

/// The sentence on means that change slowly along the record.
fn wandering(names: &[&str]) -> Option<String> {
    (!names.is_empty()).then(|| {
        format!(
            "Slow changes along the record ({}): the uncertainties of these means may be too small; measure longer.",
            names.join(", ")
        )
    })
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
    say(
        result.restitution.as_ref().is_some_and(|r| r.value < 0.0),
        "The restitution is negative: after the impacts the velocity has the sign that it had before. Is the velocity the channel of the striker, and are impacts found where they are (--out draws them)?"
            .to_owned(),
    );
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
    let taken = match (clipped == found, result.groups.first().is_some_and(groups::Group::leans)) {
        (true, _) => "there are no others, so the means are too small and have no uncertainty",
        (_, true) => "left out of the means, which lean to the slower ones and have no uncertainty",
        _ => "left out of the means",
    };
    let [stroke, drift] = [&result.displacement.stroke, &result.displacement.drift].map(|e| e.value);
    say(
        drift.abs() > DRIFTING * stroke,
        format!(
            "The displacement drifts by {} a turn beside a stroke of {}: the velocity has an offset, or the machine moves. A straight line a turn is taken out of stroke and displacement.",
            quantity(drift, "m", 2),
            quantity(stroke, "m", 2)
        ),
    );
    say(clipped > 0, format!("{} of {found} over-range: {taken}.", several(clipped, "impact")));
    say(
        result.impacts.is_empty(),
        format!(
            "No impact was found: no jump of the velocity within {} stands out; one whose contact lasts longer needs a longer --contact.",
            quantity(options.contact, "s", 2)
        ),
    );
    let per_degree = 100.0 * result.beam.per_degree;
    say(
        per_degree > 0.5,
        format!(
            "One degree of error in the beam angle changes every velocity by {per_degree:.1} %; that is in no uncertainty."
        ),
    );
    bandwidth(result, options, &mut say);
    means(result, options, &mut say);
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
        format!(
            "The reference rises within one sample: edges are known to {} only.",
            quantity(r.std, "s", 2)
        ),
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

fn means(result: &Drill, options: &DrillOptions, say: &mut impl FnMut(bool, String)) {
    let means = [&result.speed, &result.displacement.stroke];
    let few =
        means.into_iter().chain(result.groups.iter().map(|g| &g.before)).map(|e| e.n).filter(|n| *n < 4);
    if let Some(n) = few.max() {
        say(true, format!("A mean over {n} turns or impacts has no standard uncertainty: it needs four."));
    }
    for sentence in groups::doubts(&result.groups) {
        say(true, sentence);
    }
    let unmoved = result.restitution.is_some() && options.struck_mass.is_none();
    say(unmoved, "The restitution assumes that the struck mass does not move.".to_owned());
    say(
        result.restitution.as_ref().is_some_and(|e| !(0.0..=1.0).contains(&e.value)),
        "The restitution lies outside 0 to 1: check masses, direction of the beam, and what is struck."
            .to_owned(),
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
