//! What a person should know of a drill's record.

use super::{Drill, DrillOptions, Edges, Survey};
use vibro_record::Finding;

/// A displacement that drifts by more than this part of the stroke in a turn has an offset, or the machine moves.
const DRIFTING: f64 = 0.1;
/// Relative change of velocities for a degree of error in the beam angle that is worth a word.
const STEEP: f64 = 0.005;

/// Of a result, the edges of its reference and its velocity; `still`: a noise floor was asked for.
pub(super) fn findings(
    d: &Drill,
    options: &DrillOptions,
    edges: &Edges,
    velocity: &Survey,
    still: bool,
) -> Vec<Finding> {
    let (r, f, bandwidth, pulses) = (&d.reference, &d.faults, &d.bandwidth, options.pulses_per_turn);
    let limit = options.instrument.unwrap_or(f64::INFINITY);
    let means =
        [&d.speed, &d.displacement.stroke].into_iter().chain(d.groups.iter().map(|g| &g.before)).map(|e| e.n);
    let few = means.filter(|n| *n < 4).max();
    let phases: Vec<f64> = d.groups.iter().map(|g| g.phase.value).collect();
    let phase = phases.first().copied().unwrap_or(f64::NAN);
    let assumed = d.restitution.is_some() && options.struck_mass.is_none();
    let bridged = Finding::caution("drill-faults-bridged")
        .count("dropouts", f.dropouts)
        .count("spikes", f.spikes)
        .count("bridged", f.bridged);
    let over_range = Finding::doubt("drill-over-range").count("n", f.clipped);
    let lost = Finding::caution("drill-samples-lost").count("n", f.lost);
    let several = Finding::caution("drill-groups").count("n", phases.len()).number("phase", phase);
    let limited = Finding::doubt("drill-instrument-limited").number("f2", bandwidth.f2);
    let [stroke, drift] = [d.displacement.stroke.value, d.displacement.drift.value];
    let drifts = Finding::caution("drill-drift").number("drift", drift).number("stroke", stroke);
    let found = [
        (r.missing > 0, Finding::caution("drill-edges-missing").count("n", r.missing)),
        (r.extra > 0, Finding::caution("drill-edges-extra").count("n", r.extra)),
        (r.pauses > 0, Finding::caution("drill-reference-pauses").count("n", r.pauses)),
        (edges.sharp, Finding::caution("drill-edges-sharp").number("std", r.std)),
        (pulses > 1, Finding::caution("drill-first-pulse-unknown").count("pulses", pulses)),
        (f.dropouts + f.spikes > 0, bridged),
        (f.lost > 0, lost.count("turns", d.cycles - d.averaged)),
        (f.clipped > 0, over_range.number("low", velocity.low).number("high", velocity.high)),
        (d.hidden > 0, Finding::caution("drill-impacts-hidden").count("n", d.hidden)),
        (drift.abs() > DRIFTING * stroke, drifts),
        (d.impacts.is_empty(), Finding::caution("drill-no-impact").number("contact", options.contact)),
        (few.is_some(), Finding::caution("drill-few-values").count("n", few.unwrap_or(0))),
        (phases.len() > 1, several.numbers("phases", phases)),
        (assumed, Finding::caution("drill-struck-mass-unknown")),
        (d.beam.per_degree > STEEP, Finding::caution("drill-beam-angle").number("share", d.beam.per_degree)),
        (bandwidth.sampling_limited, Finding::doubt("drill-sampling-limited").number("f2", bandwidth.f2)),
        (bandwidth.f2 > limit, limited.number("limit", limit)),
        (still && d.noise_floor.is_none(), Finding::caution("drill-noise-floor-short")),
    ];
    let mut all: Vec<Finding> =
        found.into_iter().filter(|(holds, _)| *holds).map(|(_, finding)| finding).collect();
    all.extend(d.groups.iter().flat_map(|g| g.findings.iter().cloned()));
    all.extend(d.exposure.iter().flat_map(|e| e.findings.iter().cloned()));
    all
}
