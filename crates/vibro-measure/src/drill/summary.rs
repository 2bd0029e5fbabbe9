//! From what the passes measured to estimates.

use super::pass::Pass;
use super::result::{BeamResult, Displacement, Drill, Pulses};
use super::{DrillOptions, Excerpt, Found, NoiseFloor, Running, Surveyed, Turns, findings, groups, motion};
use crate::Estimate;
use crate::exposure::exposure;
use crate::mean::Mean;
use vibro_record::{Finding, Result};
use vibro_signal::welch::Stream;

/// Everything that the passes leave behind.
pub(super) struct Measured<'a> {
    pub options: &'a DrillOptions,
    pub rate: f64,
    pub surveyed: &'a Surveyed,
    pub edges: &'a Found,
    pub turns: &'a Turns,
    pub pass: Pass<'a>,
    pub still: Option<&'a Stream>,
    /// Of velocity and reference.
    pub excerpts: [Excerpt; 2],
}

/// Estimates and findings.
///
/// # Errors
/// If a handle was measured that allows no exposure.
pub(super) fn summary(m: Measured<'_>) -> Result<Drill> {
    let Measured { options, rate, surveyed, edges, turns, pass, still, excerpts: [velocity, reference] } = m;
    let edge = edges.std(surveyed.reference.noise());
    let jumps = pass.jumps.finish(rate, edge);
    let mut impacts = jumps.impacts;
    let groups = groups::groups(&mut impacts, &jumps.residuals, pass.averaged, options);
    let strongest = groups.first();
    let average = pass.average.phases();
    let period = turns.whole.iter().map(|t| t.end - t.start).sum::<f64>() / turns.whole.len() as f64 / rate;
    let (speed, speed_wanders) = turns.speed(rate, edge);
    let speeds: Vec<f64> = turns.speeds(rate).collect();
    let mut spread = Running::default();
    for speed in &speeds {
        spread.push(*speed);
    }
    let [stroke, drift] = [pass.motion.stroke(), pass.motion.drift()].map(Mean::of);
    // Where speeds are too small, so is what they add up to: no uncertainty is stated.
    let metres = |mean: Mean, method| {
        Estimate::new(mean.value, mean.std.filter(|_| pass.count.clipped == 0), "m", mean.n, method)
    };
    let noise_floor =
        still.and_then(|still| NoiseFloor::new(pass.spectrum.as_ref()?, still, rate, options.margin));
    let exposure =
        if surveyed.handles.is_empty() { None } else { Some(exposure(&surveyed.handles, options.hours)?) };
    let slow = [
        ("speed", speed_wanders),
        ("stroke", stroke.wanders),
        ("drift", drift.wanders),
        ("impacts", strongest.is_some_and(|g| g.wanders)),
    ];
    let slow: Vec<&str> = slow.into_iter().filter(|(_, wanders)| *wanders).map(|(name, _)| name).collect();
    let mut result = Drill {
        speed,
        speed_variation: spread.std(),
        cycles: turns.whole.len(),
        averaged: pass.averaged,
        reference: Pulses {
            edges: edges.edges.len(),
            missing: turns.missing,
            extra: turns.extra,
            pauses: turns.pauses,
            std: edge / rate,
        },
        before: strongest.map(|g| g.before.clone()),
        after: strongest.map(|g| g.after.clone()),
        phase: strongest.map(|g| g.phase.clone()),
        phase_variation: strongest.and_then(|g| g.phase_variation),
        energy: strongest.and_then(|g| g.energy.clone()),
        energy_given: strongest.and_then(|g| g.energy_given.clone()),
        restitution: strongest.and_then(|g| g.restitution.clone()),
        groups,
        hidden: jumps.hidden,
        clipped: impacts.iter().filter(|i| i.clipped).count(),
        impacts,
        displacement: Displacement {
            value: motion::displacement(&average.mean, period),
            stroke: metres(stroke, "peak to peak of the integrated velocity, mean over turns"),
            drift: metres(drift, "integral of the velocity over a turn, mean over turns"),
        },
        average,
        dropouts: pass.count.dropouts,
        spikes: pass.count.spikes,
        faults: pass.count,
        bandwidth: pass.motion.bandwidth(rate),
        noise_floor,
        exposure,
        beam: BeamResult { factor: options.beam.factor(), per_degree: options.beam.per_degree() },
        smoothing: pass.corner.map(|corner| options.smoothing.stated(corner, rate)),
        speeds,
        times: turns.whole.iter().map(|t| t.start / rate).collect(),
        excerpt_time: (velocity.start() as f64 / rate, 1.0 / rate),
        excerpt: velocity.values,
        excerpt_reference: reference.values,
        findings: Vec::new(),
    };
    let mut findings = findings::reference(&result, surveyed, edges, turns, options);
    findings.extend(findings::velocity(&result, surveyed, pass.left_out, options));
    findings.extend(findings::means(&result, options));
    findings.extend(findings::bandwidth(&result, options, still.is_some()));
    findings.extend(result.exposure.iter().flat_map(|e| e.findings.iter().cloned()));
    if !slow.is_empty() {
        findings.push(Finding::caution("drill-slow-changes").name("quantities", slow.join(", ")));
    }
    result.findings = findings;
    Ok(result)
}
