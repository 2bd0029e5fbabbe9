//! The closed-form prediction over frequency, and which of its motions a sweep would follow.

use super::forcing::Forcing;
use crate::error::Result;
use crate::model::Observable;
use crate::model::{Regime, Rig, orbits};
use crate::record::Direction;
use rayon::prelude::*;
use serde::Serialize;

/// Kind of a predicted motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum MotionKind {
    /// One impact a cycle.
    Impacting,
    /// No impact.
    Free,
    /// Another pattern of impacts.
    Pattern,
    /// No repeating pattern.
    Irregular,
}

impl MotionKind {
    /// The kind of a regime.
    pub fn of(regime: Regime) -> MotionKind {
        match regime {
            Regime::NoImpact => MotionKind::Free,
            Regime::Periodic { impacts: 1, cycles: 1 } => MotionKind::Impacting,
            Regime::Periodic { .. } | Regime::Chatter { cycles: Some(_) } => MotionKind::Pattern,
            Regime::Chatter { cycles: None } | Regime::Irregular => MotionKind::Irregular,
        }
    }
}

/// One predicted motion at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Impacting once a cycle, or free.
    pub kind: MotionKind,
    /// Observed amplitudes of x₁ and x₂ in m.
    pub amplitude: [f64; 2],
    /// Whether it can be observed, and if not, why.
    pub verdict: Verdict,
}

/// Whether a motion can be observed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Admissible and stable; a free motion clear of the other mass.
    Seen,
    /// Admissible, but rounding cannot tell whether a disturbance dies away.
    Neutral,
    /// Admissible, but the smallest disturbance grows.
    Unstable,
    /// The masses would pass through each other.
    Impossible,
}

impl Motion {
    /// Whether it can be observed.
    pub(crate) fn is_seen(&self) -> bool {
        self.verdict == Verdict::Seen
    }
}

/// Everything the closed form predicts over a grid of frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Frequencies in Hz, rising.
    pub frequency: Vec<f64>,
    /// Motions at each frequency: impacting ones with the larger impulse first, then the free one.
    pub motions: Vec<Vec<Motion>>,
}

impl Prediction {
    /// Predicts on `n` evenly spaced frequencies (two or more).
    ///
    /// # Errors
    /// As [`orbits`].
    pub(super) fn over(rig: &Rig, forcing: &Forcing, range: (f64, f64), n: usize) -> Result<Prediction> {
        let step = (range.1 - range.0) / (n - 1) as f64;
        let frequency: Vec<f64> = (0..n).map(|i| range.0 + i as f64 * step).collect();
        let points: Vec<(f64, f64)> = frequency.iter().map(|f| (*f, forcing.at(*f))).collect();
        Ok(Prediction { motions: all_motions(rig, &points)?, frequency })
    }

    /// The motion a slow sweep in `direction` would show at each frequency, in order of rising frequency.
    ///
    /// A sweep starts at rest, so without impacts where that is possible. Free motion lasts until it is no
    /// longer clear of the other mass; impacts last until no orbit with impacts exists. `None` where
    /// impacts go on but no orbit with one impact a cycle can be seen: the motion there has another
    /// pattern (after a flip, say) and is not predicted here.
    pub fn followed(&self, direction: Direction) -> Vec<Option<Motion>> {
        let mut kind = MotionKind::Free;
        let follow = |motions: &Vec<Motion>| {
            let seen = |kind: MotionKind| motions.iter().find(|m| m.is_seen() && m.kind == kind).copied();
            let goes_on = match kind {
                MotionKind::Free => seen(MotionKind::Free).is_some(),
                _ => motions.iter().any(|m| m.kind == MotionKind::Impacting),
            };
            if !goes_on {
                kind = if kind == MotionKind::Free { MotionKind::Impacting } else { MotionKind::Free };
            }
            seen(kind)
        };
        let swept = in_order(direction, self.motions.iter().collect());
        in_order(direction, swept.into_iter().map(follow).collect())
    }
}

/// Values by rising frequency in the order of a sweep; a second call reverts this.
pub(super) fn in_order<T>(direction: Direction, mut rising: Vec<T>) -> Vec<T> {
    if direction == Direction::Down {
        rising.reverse();
    }
    rising
}

/// Motions at each of `points`: frequency in Hz and force amplitude in N.
pub(super) fn all_motions(rig: &Rig, points: &[(f64, f64)]) -> Result<Vec<Vec<Motion>>> {
    points.par_iter().map(|(frequency, force)| motions(rig, *force, *frequency)).collect()
}

/// Motions at a force in N and a frequency in Hz: impacting ones with the larger impulse first, then the
/// free one, each with its fundamentals.
pub(super) fn motions(rig: &Rig, force: f64, frequency: f64) -> Result<Vec<Motion>> {
    let (found, observable) = (orbits(rig, force, frequency)?, Observable::Fundamental);
    let impacting = found.orbits.iter().filter(|o| o.validity.exists).map(|o| Motion {
        kind: MotionKind::Impacting,
        amplitude: observable.of_orbit(o),
        verdict: match (o.validity.admissible, o.validity.stable) {
            (false, _) => Verdict::Impossible,
            (true, Some(true)) => Verdict::Seen,
            (true, Some(false)) => Verdict::Unstable,
            (true, None) => Verdict::Neutral,
        },
    });
    let free = Motion {
        kind: MotionKind::Free,
        amplitude: observable.of_no_impact(&found.no_impact),
        verdict: if found.no_impact.possible { Verdict::Seen } else { Verdict::Impossible },
    };
    Ok(impacting.chain([free]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Near its upper end the impacting branch coexists with the free motion: the direction decides.
    #[test]
    fn history_decides_where_two_motions_exist() {
        let rig = Rig { restitution: 0.95, ..Rig::thesis() };
        let p = Prediction::over(&rig, &Forcing::constant(0.1), (6.0, 13.0), 1401).unwrap();
        let (up, down) = (p.followed(Direction::Up), p.followed(Direction::Down));
        let largest = |f: &[Option<Motion>]| {
            let mut best = (0.0, 0.0);
            for (f, m) in p.frequency.iter().zip(f) {
                if let Some(m) = m.filter(|m| m.amplitude[0] > best.1 && *f > 8.0) {
                    best = (*f, m.amplitude[0]);
                }
            }
            best
        };
        assert!(largest(&up).1 > 2.0 * largest(&down).1, "{:?} {:?}", largest(&up), largest(&down));
        for (i, motion) in up.iter().enumerate() {
            if let Some(motion) = motion {
                assert!(motion.is_seen() && p.motions[i].contains(motion));
            }
        }
    }
}
