//! Result of a drill's record, and its findings.

use super::{
    Bandwidth, Beam, ChannelStatistics, Corner, DrillOptions, FaultCount, Group, Impact, NoiseFloor, Phases,
    TurnsFrom,
};
use crate::Estimate;
use crate::exposure::Exposure;
use serde::Serialize;
use std::collections::BTreeSet;
use vibro_record::code;
use vibro_record::{Finding, Uncertain, uncertain};

/// Result of a drill's record.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Drill {
    /// Mean speed of the crank in turns a second.
    pub speed: Estimate,
    /// Standard deviation of the speed from turn to turn, in Hz.
    pub speed_variation: f64,
    /// Number of whole turns.
    pub cycles: usize,
    /// Number of turns in the average: whole, and with no part of the velocity lost.
    pub averaged: usize,
    /// Where the turns come from.
    pub turns_from: TurnsFrom,
    /// The reference, or the impacts that begin the turns.
    pub reference: Pulses,
    /// Every impact.
    pub impacts: Vec<Impact>,
    /// Impacts by direction, and by phase where a turn has unlike ones; the strongest group first.
    pub groups: Vec<Group>,
    /// Mean velocity before the impacts of the strongest group, continued to the middle of the contact, in
    /// m/s. All means down to the restitution are of that group.
    pub before: Option<Estimate>,
    /// Mean velocity after the impacts, in m/s.
    pub after: Option<Estimate>,
    /// Mean phase of the impacts in turns after the edge.
    pub phase: Option<Estimate>,
    /// Mean kinetic energy before the impacts, in J.
    pub energy: Option<Estimate>,
    /// Mean energy that the impacts take out of the mass, in J.
    pub energy_given: Option<Estimate>,
    /// Restitution from the balance of momentum; without a stated struck mass, that mass is assumed not to
    /// move.
    pub restitution: Option<Estimate>,
    /// Number of turns whose impact lies in a fault of the velocity.
    pub hidden: usize,
    /// Number of impacts whose fits reach the end of the range; they are left out of the means unless there
    /// are no others.
    pub clipped: usize,
    /// Mean velocity over the phase.
    pub average: Phases,
    /// Displacement over the phase.
    pub displacement: Displacement,
    /// Number of drop-outs of the velocity.
    pub dropouts: usize,
    /// Drop-outs and spikes, and the samples bridged, lost and clipped.
    pub faults: FaultCount,
    /// Bandwidth of the motion, and whether the sampling can follow.
    pub bandwidth: Bandwidth,
    /// Motion against the noise of the instrument, where a record without motion was given.
    pub noise_floor: Option<NoiseFloor>,
    /// Hand-arm exposure, where a handle was measured.
    pub exposure: Option<Exposure>,
    /// The beam.
    pub beam: Beam,
    /// Smoothing of average and displacement; `None` where it was switched off.
    pub smoothing: Option<Corner>,
    /// Speed of each turn in Hz, for its plot.
    #[serde(skip)]
    pub speeds: Vec<f64>,
    /// Time of the beginning of each turn in s.
    #[serde(skip)]
    pub times: Vec<f64>,
    /// Measured velocity of a few turns in the middle, in m/s.
    #[serde(skip)]
    pub excerpt: Vec<f64>,
    /// The reference of the same turns.
    #[serde(skip)]
    pub excerpt_reference: Vec<f64>,
    /// Time of the first sample of these turns, and sampling interval, in s.
    #[serde(skip)]
    pub excerpt_time: (f64, f64),
    /// Findings: doubts, assumptions and what was left out.
    pub findings: Vec<Finding>,
}

// Speed and exposure do not depend on the velocity.
impl Uncertain for Drill {
    fn doubt(&mut self) {
        let Drill {
            impacts,
            groups,
            before,
            after,
            phase,
            energy,
            energy_given,
            restitution,
            displacement,
            ..
        } = self;
        let of_velocity: [&mut dyn Uncertain; 9] =
            [impacts, groups, before, after, phase, energy, energy_given, restitution, displacement];
        of_velocity.into_iter().for_each(Uncertain::doubt);
    }

    fn doubt_all(&mut self) {
        self.doubt();
        self.speed.doubt();
        self.exposure.doubt();
    }

    fn doubt_scale(&mut self) {
        self.impacts.doubt_scale();
        self.groups.doubt_scale();
        let Drill { before, after, energy, energy_given, displacement, exposure, .. } = self;
        let scaled: &mut [&mut dyn Uncertain] =
            &mut [before, after, energy, energy_given, displacement, exposure];
        scaled.doubt();
    }
}

impl Drill {
    /// Doubt where the velocity, of this range, has clipped samples: they bias the displacement low.
    pub(super) fn over_range(&mut self, velocity: &ChannelStatistics) -> Option<Finding> {
        let doubt = Finding::doubt("drill-over-range").count("n", self.faults.clipped);
        let doubt = doubt.number("low", velocity.low).number("high", velocity.high);
        (self.faults.clipped > 0).then(|| doubt.of(&mut self.displacement))
    }
}

/// Numbers of edges of the reference, or of impacts in its place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pulses {
    /// Edges found.
    pub edges: usize,
    /// Missing edges.
    pub missing: usize,
    /// False edges, which were ignored, or further impacts of the same direction.
    pub extra: usize,
    /// Stretches without edges.
    pub pauses: usize,
    /// Standard uncertainty of an edge in s.
    pub std: f64,
}

/// Displacement by integration over whole turns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Displacement {
    /// Displacement in m at the phases of the average; its mean is 0.
    pub value: Vec<f64>,
    /// Mean peak-to-peak displacement of a turn.
    pub stroke: Estimate,
    /// Mean displacement at the end of a turn, which was removed.
    pub drift: Estimate,
}

uncertain!(Displacement: ; scaled: stroke, drift);

/// Largest drift in a turn over the stroke; above it the velocity has an offset, or the machine moves.
const DRIFTING: f64 = 0.1;
/// Relative change of velocities for one degree of error in the beam angle, above which a finding is added.
const STEEP: f64 = 0.005;

/// Largest removed mean, relative to a velocity without an uncertainty, that gives no finding.
const SMALL: f64 = 0.01;

/// One turn in this many may lack an impact without a finding.
const FEW: usize = 10;

/// Findings on a result. `sharp`: edges of the reference rise within one sample; `still`: a
/// noise floor was requested.
pub(super) fn findings(d: &Drill, options: &DrillOptions, sharp: bool, still: bool) -> Vec<Finding> {
    let (r, f, bandwidth, pulses) = (&d.reference, &d.faults, &d.bandwidth, options.pulses_per_turn);
    let limit = options.instrument.unwrap_or(f64::INFINITY);
    let means =
        [&d.speed, &d.displacement.stroke].into_iter().chain(d.groups.iter().map(|g| &g.before)).map(|e| e.n);
    let of_a_turn = f64::sqrt(2.0) * r.std * d.speed.value.powi(2);
    let few = means.filter(|n| *n < 4).max();
    let phases: Vec<f64> = d.groups.iter().map(|g| g.phase.value).collect();
    let phase = phases.first().copied().unwrap_or(f64::NAN);
    let assumed = d.restitution.is_some() && options.struck_mass.is_none();
    let bridged = Finding::caution("drill-faults-bridged")
        .count("dropouts", f.dropouts)
        .count("spikes", f.spikes)
        .count("bridged", f.bridged);
    let lost = Finding::caution("drill-samples-lost").count("n", f.lost);
    let several = Finding::caution("drill-groups").count("n", phases.len()).number("phase", phase);
    // A bandwidth has no uncertainty.
    let limited = Finding::doubt("drill-instrument-limited").number("f2", bandwidth.f2).without_estimate();
    let [stroke, drift] = [d.displacement.stroke.value, d.displacement.drift.value];
    let drifts = Finding::caution("drill-drift").number("drift", drift).number("stroke", stroke);
    let mean = drift * d.speed.value;
    let moved = |v: &Estimate| mean.abs() > v.std.unwrap_or(SMALL * v.value.abs());
    let doubted = |g: &Group| g.findings.iter().any(|found| found.code == code::DRILL_MEAN_VELOCITY);
    let moved = |g: &Group| !doubted(g) && (moved(&g.before) || moved(&g.after));
    let removed = Finding::caution("drill-mean-removed").number("mean", mean);
    let own = d.turns_from == TurnsFrom::Impacts;
    let turned = Finding::caution("drill-turns-from-impacts").number("rpm", 60.0 * d.speed.value);
    let turned = if r.extra > 0 { turned.count("others", r.extra) } else { turned };
    let missing = if own { "drill-impacts-missing" } else { "drill-edges-missing" };
    let struck: BTreeSet<usize> = d.impacts.iter().filter(|i| i.group == 0).map(|i| i.cycle).collect();
    let without = if d.impacts.is_empty() { 0 } else { d.averaged.saturating_sub(struck.len()) };
    let missed = Finding::caution("drill-turns-without-impact").count("turns", d.averaged);
    let found = [
        (own, turned),
        (r.missing > 0, Finding::caution(missing).count("n", r.missing)),
        (!own && r.extra > 0, Finding::caution("drill-edges-extra").count("n", r.extra)),
        (r.pauses > 0, Finding::caution("drill-reference-pauses").count("n", r.pauses)),
        (sharp, Finding::caution(code::DRILL_EDGES_SHARP).number("std", r.std).number("speed", of_a_turn)),
        (pulses > 1, Finding::caution("drill-first-pulse-unknown").count("pulses", pulses)),
        (f.dropouts + f.spikes > 0, bridged),
        (f.lost > 0, lost.count("turns", d.cycles - d.averaged)),
        (d.hidden > 0, Finding::caution("drill-impacts-hidden").count("n", d.hidden)),
        (drift.abs() > DRIFTING * stroke, drifts),
        (d.groups.iter().any(moved), removed),
        (without > d.hidden && without > d.averaged / FEW, missed.count("n", without)),
        (d.impacts.is_empty(), Finding::caution("drill-no-impact").number("contact", options.contact)),
        (few.is_some(), Finding::caution("drill-few-values").count("n", few.unwrap_or(0))),
        (phases.len() > 1, several.numbers("phases", phases)),
        (assumed, Finding::caution("drill-struck-mass-unknown")),
        (d.beam.per_degree > STEEP, Finding::caution("drill-beam-angle").number("share", d.beam.per_degree)),
        (bandwidth.sampling_limited, Finding::caution("drill-sampling-limited").number("f2", bandwidth.f2)),
        (bandwidth.f2 > limit, limited.number("limit", limit)),
        (still && d.noise_floor.is_none(), Finding::caution("drill-noise-floor-short")),
    ];
    let mut all: Vec<Finding> =
        found.into_iter().filter(|(holds, _)| *holds).map(|(_, finding)| finding).collect();
    all.extend(d.groups.iter().flat_map(|g| g.findings.iter().cloned()));
    all.extend(d.exposure.iter().flat_map(|e| e.findings.iter().cloned()));
    all
}
