//! What a person should know of a drill's record.

use super::{Drill, DrillOptions, Found, Smoothing, Surveyed, Turns};
use vibro_record::Finding;

/// A displacement that drifts by more than this part of the stroke in a turn has an offset, or the machine moves.
const DRIFTING: f64 = 0.1;
/// Relative change of velocities for a degree of error in the beam angle that is worth a word.
const STEEP: f64 = 0.005;

/// Those of `found` whose condition holds.
fn holding<const N: usize>(found: [(bool, Finding); N]) -> impl Iterator<Item = Finding> {
    found.into_iter().filter(|(holds, _)| *holds).map(|(_, finding)| finding)
}

/// Of the reference and its edges.
pub(super) fn reference(
    result: &Drill,
    surveyed: &Surveyed,
    edges: &Found,
    turns: &Turns,
    options: &DrillOptions,
) -> Vec<Finding> {
    let (r, pulses, lost) =
        (&result.reference, options.pulses_per_turn, surveyed.reference.missing() as usize);
    let found = [
        (r.missing > 0, Finding::caution("drill-edges-missing").count("n", r.missing)),
        (r.extra > 0, Finding::caution("drill-edges-extra").count("n", r.extra)),
        (r.pauses > 0, Finding::caution("drill-reference-pauses").count("n", r.pauses)),
        (turns.apart > 0, Finding::caution("drill-turns-apart").count("n", turns.apart)),
        (edges.sharp, Finding::caution("drill-edges-sharp").number("std", r.std)),
        (lost > 0, Finding::caution("drill-reference-samples-missing").count("n", lost)),
        (pulses > 1, Finding::caution("drill-first-pulse-unknown").count("pulses", pulses)),
    ];
    holding(found).collect()
}

/// Of faults of the velocity and what they cost.
pub(super) fn velocity(
    result: &Drill,
    surveyed: &Surveyed,
    left_out: usize,
    options: &DrillOptions,
) -> Vec<Finding> {
    let f = &result.faults;
    let share = (f.bridged + f.lost) as f64 / surveyed.velocity.samples().max(1) as f64;
    let bridged = Finding::caution("drill-faults-bridged")
        .count("dropouts", f.dropouts)
        .count("spikes", f.spikes)
        .number("share", share)
        .count("bridged", f.bridged);
    let (low, high) = surveyed.velocity.range().unwrap_or((0.0, 0.0));
    let over_range =
        Finding::doubt("drill-over-range").count("n", f.clipped).number("low", low).number("high", high);
    let [stroke, drift] = [&result.displacement.stroke, &result.displacement.drift].map(|e| e.value);
    let drifts = Finding::caution("drill-drift").number("drift", drift).number("stroke", stroke);
    let no_impact = Finding::caution("drill-no-impact").number("contact", options.contact);
    let found = [
        (f.dropouts + f.spikes > 0, bridged),
        (f.lost > 0, Finding::caution("drill-samples-lost").count("n", f.lost).count("turns", left_out)),
        (left_out > 0 && f.lost == 0, Finding::caution("drill-turns-cut-off").count("n", left_out)),
        (f.clipped > 0, over_range),
        (result.hidden > 0, Finding::caution("drill-impacts-hidden").count("n", result.hidden)),
        (drift.abs() > DRIFTING * stroke, drifts),
        (result.impacts.is_empty(), no_impact),
    ];
    holding(found).collect()
}

/// Of means over turns and impacts.
pub(super) fn means(result: &Drill, options: &DrillOptions) -> Vec<Finding> {
    let groups = &result.groups;
    let all =
        [&result.speed, &result.displacement.stroke].into_iter().chain(groups.iter().map(|g| &g.before));
    let few = all.map(|e| e.n).filter(|n| *n < 4).max();
    let mut found: Vec<Finding> =
        few.map(|n| Finding::caution("drill-few-values").count("n", n)).into_iter().collect();
    if let [first, others @ ..] = groups.as_slice()
        && !others.is_empty()
    {
        let each = |of: fn(&super::Group) -> f64| groups.iter().map(of).collect::<Vec<f64>>();
        found.push(
            Finding::caution("drill-groups")
                .count("n", groups.len())
                .number("phase", first.phase.value)
                .numbers("phases", each(|g| g.phase.value))
                .numbers("before", each(|g| g.before.value))
                .numbers("after", each(|g| g.after.value))
                .numbers("share", each(|g| g.share)),
        );
    }
    found.extend(groups.iter().flat_map(|g| g.findings.iter().cloned()));
    if result.restitution.is_some() && options.struck_mass.is_none() {
        found.push(Finding::caution("drill-struck-mass-unknown"));
    }
    found
}

/// Of beam, bandwidth, smoothing and noise floor.
pub(super) fn bandwidth(result: &Drill, options: &DrillOptions, still: bool) -> Vec<Finding> {
    let (f2, per_degree) = (result.bandwidth.f2, result.beam.per_degree);
    let limit = options.instrument.unwrap_or(f64::INFINITY);
    let corner = result.smoothing.as_ref().map_or(f64::NAN, |s| s.corner);
    let time = if let Smoothing::Exponential(time) = options.smoothing { time } else { 0.0 };
    let floor = result.noise_floor.as_ref();
    let found = [
        (per_degree > STEEP, Finding::caution("drill-beam-angle").number("share", per_degree)),
        (result.bandwidth.sampling_limited, Finding::doubt("drill-sampling-limited").number("f2", f2)),
        (f2 > limit, Finding::doubt("drill-instrument-limited").number("f2", f2).number("limit", limit)),
        (time > 0.0, Finding::caution("drill-exponential-delay").number("time", time)),
        (
            !corner.is_nan() && options.smoothing != Smoothing::Phases,
            Finding::note("drill-smoothed").number("corner", corner),
        ),
        (
            floor.is_some_and(|f| f.bands.is_empty()),
            Finding::caution("drill-below-noise-floor").number("margin", options.margin),
        ),
        (still && floor.is_none(), Finding::caution("drill-noise-floor-short")),
    ];
    holding(found).collect()
}
