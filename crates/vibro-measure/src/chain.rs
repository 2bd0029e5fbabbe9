//! Bodies of one machine that were measured in separate runs, joined by the crank.
//!
//! Each run has a [`Drill`](crate::drill::Drill) with its turns counted from the same pulse of the crank. At
//! a contact the body behind gives the momentum m(v⁻ − v⁺), and the body in front takes m(v⁺ − v⁻): from both
//! records `R = (v_b⁺ − v_a⁺)/(v_a⁻ − v_b⁻)`, and from one with the masses and the struck body at rest.

mod body;
mod passage;
mod shown;

pub use body::{Body, Hits};
pub use passage::Passage;
pub use shown::Jump;

use crate::Estimate;
use body::turn_between;
use serde::Serialize;
use vibro_record::Finding;

/// Standard deviations of the phases, both together, within which the impacts of two bodies are one contact.
const ALIKE: f64 = 4.0;

/// Machine that is joined from several runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Chain {
    /// Names of the bodies, in the direction of a blow.
    pub bodies: Vec<String>,
    /// Their records.
    pub records: Vec<String>,
    /// Speed in Hz, of the first run.
    pub speed: f64,
    /// Sign of a velocity in the direction of a blow.
    pub direction: f64,
    /// Contacts of neighbours.
    pub passages: Vec<Passage>,
    /// Kinetic energy in J of the first body before it strikes.
    pub blow_energy: Option<Estimate>,
    /// Blows a minute.
    pub blow_rate: Option<f64>,
    /// Energy that the last body takes over that of a blow.
    pub efficiency: Option<Estimate>,
    /// Findings.
    #[serde(skip)]
    pub findings: Vec<Finding>,
}

impl Chain {
    /// Joins bodies, which are listed in the direction of a blow. `None` unless two of them or more have
    /// impacts that count from the crank.
    pub fn of(bodies: &[&Body]) -> Option<Chain> {
        let [first, _, ..] = bodies else { return None };
        let blow = first.hits.first().filter(|_| bodies.iter().all(|body| body.crank))?;
        let direction = blow.velocities[0].signum();
        let mut findings = Vec::new();
        let mut passages = Vec::new();
        let mut ends = [None, None];
        for pair in bodies.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let Some((behind, front)) = common(a, b, direction) else {
                let none = Finding::caution("drill-no-common-impact").name("from", &*a.name);
                findings.push(none.name("to", &*b.name));
                ends[1] = None;
                continue;
            };
            let passage = Passage::of((a, behind), (b, front), direction);
            findings.extend(passage.disagreement());
            ends[0] = ends[0].or(Some(behind));
            ends[1] = Some(front);
            passages.push(passage);
        }
        let blow_energy = ends[0].and_then(|hits: &Hits| hits.energy).map(|(value, std)| {
            Estimate::new(value, std, "J", blow.n, "mean of ½mv² of the first body before its impacts")
        });
        let taken = ends[1].and_then(|hits: &Hits| hits.given).map(|(value, std)| (-value, std));
        let efficiency = blow_energy.as_ref().zip(taken).map(|(blow, (taken, std))| {
            let part = taken / blow.value;
            let std = std.zip(blow.std).map(|(taken, std)| taken.hypot(part * std) / blow.value);
            Estimate::new(part, std, "1", blow.n, "energy that the last body takes over that of a blow")
        });
        Some(Chain {
            bodies: bodies.iter().map(|body| body.name.clone()).collect(),
            records: bodies.iter().map(|body| body.record.clone()).collect(),
            speed: first.speed[0],
            direction,
            passages,
            blow_energy,
            blow_rate: ends[0].map(|hits| 60.0 * hits.share * first.speed[0]),
            efficiency,
            findings,
        })
    }
}

/// Groups of two bodies that are one contact: the body behind is slowed and the one in front driven, at the
/// same phase.
fn common<'a>(a: &'a Body, b: &'a Body, direction: f64) -> Option<(&'a Hits, &'a Hits)> {
    let slowed = a.hits.iter().filter(|hits| direction * hits.jump() < 0.0);
    let driven = || b.hits.iter().filter(|hits| direction * hits.jump() > 0.0);
    let pairs = slowed.flat_map(|x| driven().map(move |y| (x, y)));
    let apart = |(x, y): &(&Hits, &Hits)| turn_between(x.phase[0], y.phase[0]).abs();
    let alike = pairs.filter(|pair| apart(pair) <= ALIKE * pair.0.phase[1].hypot(pair.1.phase[1]));
    alike.min_by(|p, q| apart(p).total_cmp(&apart(q)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body with one group of impacts of known velocities, each with a variance of 1e-4 of its mean.
    fn body(name: &str, mass: f64, hits: &[(f64, [f64; 2])]) -> Body {
        let hits = hits.iter().map(|(phase, [before, after])| Hits {
            n: 100,
            share: 1.0,
            phase: [*phase, 1e-3],
            velocities: [*before, *after],
            covariance: Some([[1e-4, 0.0], [0.0, 1e-4]]),
            energy: Some((0.5 * mass * before * before, Some(0.01))),
            given: Some((0.5 * mass * (before * before - after * after), Some(0.01))),
        });
        Body {
            record: name.to_owned(),
            name: name.to_owned(),
            mass: Some(mass),
            speed: [45.0, 0.2],
            crank: true,
            rate: 1e5,
            instrument: None,
            smoothing: None,
            turns: 100,
            hits: hits.collect(),
            phase: Vec::new(),
            mean: Vec::new(),
            std: Vec::new(),
            displacement: Vec::new(),
        }
    }

    #[test]
    fn two_impacts_of_known_restitution_are_found_again() {
        // Velocities of both balances: R = 0.6 between 0.14 kg and 0.28 kg, then 0.8 on 0.43 kg.
        let (v, r, s) = (7.5, 0.6, 0.8);
        let piston = (1.0 + r) * 0.14 / 0.42 * v;
        let bit = (1.0 + s) * 0.28 / 0.71 * piston;
        for sign in [1.0, -1.0] {
            let all = [
                body("striker", 0.14, &[(0.62, [v, piston - r * v])]),
                body("piston", 0.28, &[(0.7, [piston, bit - s * piston]), (0.6203, [0.0, piston])]),
                body("bit", 0.43, &[(0.6999, [0.0, bit])]),
            ];
            let all = all.map(|mut body| {
                for hits in &mut body.hits {
                    hits.velocities = hits.velocities.map(|v| sign * v);
                }
                body
            });
            let chain = Chain::of(&all.each_ref()).unwrap();
            assert!(chain.findings.is_empty() && chain.passages.len() == 2, "{:?}", chain.findings);
            for (passage, expected) in chain.passages.iter().zip([r, s]) {
                let close = |e: &Option<Estimate>, to: f64| (e.as_ref().unwrap().value - to).abs() < 1e-12;
                assert!(
                    close(&passage.restitution, expected) && close(&passage.restitution_from_one, expected)
                );
                assert!(close(&passage.taken, passage.given.as_ref().unwrap().value));
                assert!(passage.agree == Some(true) && passage.energy_lost.as_ref().unwrap().value > 0.0);
            }
            // 0.14 kg and √2 × 0.01 m/s.
            let std = chain.passages[0].given.as_ref().unwrap().std.unwrap();
            assert!((std - 0.14 * 0.01 * 2.0_f64.sqrt()).abs() < 1e-15);
            let part = 0.5 * 0.43 * bit * bit / (0.5 * 0.14 * v * v);
            assert!((chain.efficiency.unwrap().value - part).abs() < 1e-12);
            assert_eq!((chain.blow_rate, chain.direction), (Some(2700.0), sign));
        }
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let striker = body("striker", 0.14, &[(0.62, [7.5, -0.7])]);
        let twice = body("bit", 0.86, &[(0.62, [0.0, 2.67])]);
        let chain = Chain::of(&[&striker, &twice]).unwrap();
        assert_eq!(chain.passages[0].agree, Some(false));
        assert_eq!(chain.findings[0].code, "drill-momentum-differs");
        let elsewhere = body("bit", 0.43, &[(0.3, [0.0, 2.67])]);
        let chain = Chain::of(&[&striker, &elsewhere]).unwrap();
        assert!(chain.passages.is_empty() && chain.efficiency.is_none());
        assert_eq!(chain.findings[0].code, "drill-no-common-impact");
        let mut faster = body("bit", 0.43, &[]);
        faster.speed[0] = 45.2;
        assert!(striker.runs_with(&faster));
        faster.speed[0] = 45.3;
        assert!(!striker.runs_with(&faster));
        faster.crank = false;
        assert!(Chain::of(&[&striker, &faster]).is_none() && Chain::of(&[&striker]).is_none());
    }
}
