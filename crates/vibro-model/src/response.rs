//! Response curves: all motions with one impact a period over a range of frequencies, and where they change.

use super::excitation::Excitation;
use super::orbit::{Loss, Orbit};
use super::orbit::{backbone, orbits_of};
use super::parallel;
use super::rig::Rig;
use super::scales;
use super::steady::NoImpact;
use serde::Serialize;
use vibro_math::try_bisected;
use vibro_record::{Error, Result, sort_by_number};

/// The most frequencies of a response.
pub const MOST_POINTS: usize = 1_000_000;

/// Motions over frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Point by point, the frequency rising.
    pub points: Vec<ResponsePoint>,
    /// Where motions appear, vanish, or change stability or admissibility, the frequency rising.
    pub changes: Vec<Change>,
}

/// All motions at one frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponsePoint {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Motions with one impact a period.
    pub orbits: Vec<Orbit>,
    /// Motion without impacts; `None` where there is no steady one.
    pub no_impact: Option<NoImpact>,
    /// Free motion without losses at this frequency, where there is one.
    pub backbone: Option<Orbit>,
    /// Reason why this frequency has no motions, where it has none.
    pub refused: Option<String>,
}

/// How a motion changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChangeKind {
    /// Two motions meet and vanish.
    Fold,
    /// Stability is lost or gained; the period doubles.
    Flip,
    /// Stability is lost or gained; a slow beat grows.
    NeimarkSacker,
    /// The impulse of the impact falls to zero.
    Grazing,
    /// A second contact in the period begins or ends.
    #[serde(rename = "second contact")]
    SecondContact,
    /// The motion without impacts begins or ceases to reach the other mass.
    #[serde(rename = "no impact")]
    NoImpact,
}

impl ChangeKind {
    /// Name as it is printed.
    pub fn name(self) -> &'static str {
        ["fold", "flip", "neimark-sacker", "grazing", "second contact", "no impact"][self as usize]
    }
}

/// A change of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Change {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Kind of the change.
    pub kind: ChangeKind,
    /// Half the peak-to-peak values of x₁ and x₂ in m there.
    pub amplitude: [f64; 2],
}

/// Motions of the `rig` under the `excitation` at `points` equidistant frequencies from `from` to `to` (Hz),
/// with one impact in `cycles` cycles; changes are located between the points to a millionth of their
/// distance.
///
/// A frequency at which an undamped mass resonates gives a point without motions, with the reason.
///
/// # Errors
/// If the range of frequencies is invalid, or a parameter is impossible at all of them.
pub fn response(
    rig: &Rig,
    excitation: &Excitation,
    from: f64,
    to: f64,
    points: usize,
    cycles: u32,
) -> Result<Response> {
    let at = axis(from, to, points, MOST_POINTS)?;
    scales::check_values(rig, [excitation.size()])?;
    scales::check_points(rig, from, cycles, points)?;
    let points = parallel::each(points, |i| point(rig, excitation, at(i), cycles));
    if let Some(ResponsePoint { frequency, .. }) =
        points.first().filter(|_| points.iter().all(|p| p.refused.is_some()))
    {
        // Returns the error of the first frequency.
        orbits_of(rig, &excitation.at_frequency(*frequency), cycles)?;
    }
    let solve = |frequency: f64| point(rig, excitation, frequency, cycles);
    let known = |pair: &&[ResponsePoint]| pair.iter().all(|p| p.refused.is_none());
    let pairs = points.windows(2).filter(known);
    let mut changes: Vec<Change> =
        pairs.flat_map(|pair| changes_between(&pair[0], &pair[1], &solve)).collect();
    sort_by_number(&mut changes, |a| a.frequency);
    Ok(Response { points, changes })
}

/// Equidistant frequencies in Hz, as a function of the index of the point.
///
/// # Errors
/// If the range is invalid, or there are fewer than 2 or more than `most` points.
pub fn axis(from: f64, to: f64, points: usize, most: usize) -> Result<impl Fn(usize) -> f64 + Sync> {
    if !(from.is_finite() && to.is_finite() && from > 0.0 && to > from) {
        let expected = "finite frequencies above 0, the lower one first";
        return Err(Error::usage(format!("an axis from {from} to {to} Hz"), expected));
    }
    if !(2..=most).contains(&points) {
        return Err(Error::usage(format!("{points} points"), format!("2 to {most}")));
    }
    let step = (to - from) / (points - 1) as f64;
    Ok(move |i: usize| if i + 1 == points { to } else { from + i as f64 * step })
}

fn point(rig: &Rig, excitation: &Excitation, frequency: f64, cycles: u32) -> ResponsePoint {
    let mut point =
        ResponsePoint { frequency, orbits: Vec::new(), no_impact: None, backbone: None, refused: None };
    match orbits_of(rig, &excitation.at_frequency(frequency), cycles) {
        Ok(found) => {
            point.orbits = found.orbits;
            point.no_impact = Some(found.no_impact);
        }
        Err(error) => point.refused = Some(error.to_string()),
    }
    if cycles == 1 {
        point.backbone = backbone(rig, frequency).ok().flatten();
    }
    point
}

/// Existence and stability of a motion at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Standing {
    /// The motion has no solution.
    Gone,
    /// A solution without a positive impulse.
    Parted,
    /// The masses would pass through each other outside the impact.
    Passing,
    Unstable,
    Stable,
}

fn standing(orbit: Option<&Orbit>) -> Standing {
    let Some(orbit) = orbit else { return Standing::Gone };
    let v = &orbit.validity;
    match (v.exists, v.admissible, v.stable) {
        (false, ..) => Standing::Parted,
        (_, false, _) => Standing::Passing,
        (.., Some(false)) => Standing::Unstable,
        _ => Standing::Stable,
    }
}

/// Changes of motions between two neighbouring points.
fn changes_between(
    a: &ResponsePoint,
    b: &ResponsePoint,
    solve: &impl Fn(f64) -> ResponsePoint,
) -> Vec<Change> {
    let mut changes = Vec::new();
    // Upwards in frequency first, then downwards for motions that appear. Two motions vanish at a fold: only
    // the upper one reports it.
    for (here, there) in [(a, b), (b, a)] {
        for orbit in &here.orbits {
            let next = orbit.continued(&there.orbits);
            let (was, is) = (standing(Some(orbit)), standing(next));
            let found_upwards = here.frequency > there.frequency && next.is_some();
            let gone = is == Standing::Gone;
            if was != is && !found_upwards && !(gone && (was == Standing::Parted || !orbit.upper)) {
                changes.extend(locate(orbit, here.frequency, there, solve));
            }
        }
    }
    if let (Some(here), Some(there)) = (a.no_impact, b.no_impact)
        && here.possible != there.possible
    {
        let mut amplitude = here.amplitude;
        let same = |middle: f64| {
            let there = solve(middle).no_impact?;
            amplitude = there.amplitude;
            Some(there.possible == here.possible)
        };
        if let Some(frequency) = change_frequency(a.frequency, b.frequency, same) {
            changes.push(Change { frequency, kind: ChangeKind::NoImpact, amplitude: [amplitude, 0.0] });
        }
    }
    changes
}

/// Locates the change of `orbit` between the frequency `from` (Hz) and the point `to`.
fn locate(
    orbit: &Orbit,
    from: f64,
    to: &ResponsePoint,
    solve: &impl Fn(f64) -> ResponsePoint,
) -> Option<Change> {
    let was = standing(Some(orbit));
    let (mut here, mut there) = (orbit.clone(), orbit.continued(&to.orbits).cloned());
    let same = |middle: f64| {
        let found = solve(middle);
        if found.refused.is_some() {
            return None;
        }
        let next = here.continued(&found.orbits).cloned();
        let same = standing(next.as_ref()) == was;
        match next {
            Some(next) if same => here = next,
            other => there = other,
        }
        Some(same)
    };
    let frequency = change_frequency(from, to.frequency, same)?;
    let kind = match (was, standing(there.as_ref())) {
        (_, Standing::Gone) => ChangeKind::Fold,
        (Standing::Parted, _) | (_, Standing::Parted) => ChangeKind::Grazing,
        (Standing::Passing, _) | (_, Standing::Passing) => ChangeKind::SecondContact,
        _ => match [Some(&here), there.as_ref()].into_iter().flatten().find_map(|o| o.validity.instability) {
            Some(Loss::Flip) => ChangeKind::Flip,
            Some(Loss::NeimarkSacker) => ChangeKind::NeimarkSacker,
            Some(Loss::Fold) => ChangeKind::Fold,
            _ => ChangeKind::Grazing,
        },
    };
    Some(Change { frequency, kind, amplitude: here.peak_to_peak.map(|p| p / 2.0) })
}

/// Frequency between `near` and `far` at which `same` becomes false, to a millionth of their distance; `None`
/// if `same` has no answer at a frequency in between.
fn change_frequency(near: f64, far: f64, same: impl FnMut(f64) -> Option<bool>) -> Option<f64> {
    /// 2⁻²⁰ is about a millionth.
    const BISECTIONS: usize = 20;
    try_bisected(near, far, BISECTIONS, same).map(|(near, far)| f64::midpoint(near, far))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::{Impulses, Sine};

    #[test]
    fn changes_lie_where_the_conditions_say() {
        let rig = Rig::thesis();
        let unit = rig.natural_frequencies()[0];
        let sine = Excitation::Sine(Sine { force: 0.5, frequency: 1.0 });
        let found = response(&rig, &sine, 1.9 * unit, 2.3 * unit, 400, 1).unwrap();
        assert_eq!(found.points.len(), 400);
        let of = |kind: ChangeKind| {
            found.changes.iter().filter(|c| c.kind == kind).map(|c| c.frequency / unit).collect::<Vec<_>>()
        };
        // From an independent calculation: A = Δ at ν = 2.168715614919, where the smaller root is zero too.
        let step = 0.4 / 399.0;
        for kind in [ChangeKind::NoImpact, ChangeKind::Grazing] {
            let near: Vec<_> =
                of(kind).into_iter().filter(|nu| (nu - 2.168_715_614_919).abs() < step * 2e-6).collect();
            assert_eq!(near.len(), 1, "{kind:?}: {:?}", found.changes);
        }
    }

    #[test]
    fn a_fold_is_where_two_motions_meet() {
        let rig = Rig::thesis();
        let sine = Excitation::Sine(Sine { force: 0.1, frequency: 1.0 });
        let found = response(&rig, &sine, 4.0, 13.0, 300, 1).unwrap();
        let folds: Vec<_> =
            found.changes.iter().filter(|c| c.kind == ChangeKind::Fold).map(|c| c.frequency).collect();
        assert!(!folds.is_empty(), "{:?}", found.changes);
        for fold in folds {
            let count = |f: f64| {
                orbits_of(&rig, &sine.at_frequency(f), 1)
                    .unwrap()
                    .orbits
                    .iter()
                    .filter(|o| o.impulse > 0.0)
                    .count()
            };
            // Located to a millionth of 0.03 Hz.
            let (below, above) = (count(fold - 6e-8), count(fold + 6e-8));
            assert!(below.abs_diff(above) == 2, "{fold}: {below} {above}, {:?}", found.changes);
        }
    }

    #[test]
    fn a_flip_is_located() {
        // Unstable by a flip at ν = 1.2, F₀ 0.9 N, R = 1: where it begins, a multiplier is −1.
        let rig = Rig { restitution: 1.0, ..Rig::thesis() };
        let unit = rig.natural_frequencies()[0];
        let sine = Excitation::Sine(Sine { force: 0.9, frequency: 1.0 });
        let found = response(&rig, &sine, 1.0 * unit, 1.4 * unit, 200, 1).unwrap();
        let flips: Vec<_> = found.changes.iter().filter(|c| c.kind == ChangeKind::Flip).collect();
        assert!(!flips.is_empty(), "{:?}", found.changes);
        for flip in flips {
            let orbit = orbits_of(&rig, &sine.at_frequency(flip.frequency), 1).unwrap().orbits.remove(0);
            let nearest =
                orbit.multipliers.unwrap().iter().map(|z| (z + 1.0).norm()).fold(f64::INFINITY, f64::min);
            // Located to 1e-6 of 0.01 Hz; multipliers change by some tens per Hz.
            assert!(nearest < 1e-5, "{nearest}");
        }
    }

    #[test]
    fn impulses_have_their_gap_without_motions() {
        // From an independent calculation: F = 0.009 N s and R = 0.7 allow no one-impact orbit from ν ≈ 1.17
        // to 1.88.
        let rig = Rig::thesis();
        let unit = rig.natural_frequencies()[0];
        let train = Excitation::Impulse(Impulses { impulse: 0.009, frequency: 1.0 });
        let found = response(&rig, &train, 1.2 * unit, 1.85 * unit, 50, 1).unwrap();
        assert!(found.points.iter().all(|p| p.orbits.iter().all(|o| !o.validity.exists)));
        assert!(response(&rig, &train, 5.0, 4.0, 50, 1).is_err());
        assert!(response(&rig, &train, 5.0, 6.0, 1, 1).is_err());
        assert!(response(&rig, &train, f64::NAN, 6.0, 10, 1).is_err());
        assert!(response(&rig, &train, 1e-9, 2e-9, 10, 1).is_err());
    }

    #[test]
    fn a_resonance_without_damper_is_one_point_without_motions() {
        let omega = std::f64::consts::TAU;
        let rig = Rig { m1: 1.0, k1: omega * omega, c1: 0.0, ..Rig::thesis() };
        let sine = Excitation::Sine(Sine { force: 0.5, frequency: 1.0 });
        let found = response(&rig, &sine, 0.7, 1.3, 3, 1).unwrap();
        assert!(found.points[1].refused.as_ref().is_some_and(|why| why.contains("natural frequency")));
        assert!(found.points[0].refused.is_none() && found.points[2].refused.is_none());
    }
}
