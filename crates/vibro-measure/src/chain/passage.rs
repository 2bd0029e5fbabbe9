//! Contact of two bodies: momentum, restitution and energy.

use super::body::{Body, Hits, turn_between};
use crate::Estimate;
use serde::Serialize;
use vibro_record::Finding;

/// Standard uncertainties by which two momenta differ that do not agree: 0.3 % of those that are equal.
const DIFFERENT: f64 = 3.0;

/// Contact of two bodies.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Passage {
    /// Body behind.
    pub from: String,
    /// Body in front.
    pub to: String,
    /// Phase in turns by the record of the body behind.
    pub phase: f64,
    /// Phase by the record of the body in front less that.
    pub later: f64,
    /// Momentum in N s that the body behind gives.
    pub given: Option<Estimate>,
    /// Momentum in N s that the body in front takes.
    pub taken: Option<Estimate>,
    /// Whether both agree; `None` without both uncertainties.
    pub agree: Option<bool>,
    /// Restitution from the velocities of both records.
    pub restitution: Option<Estimate>,
    /// Restitution from the record of the body behind and both masses, the body in front at rest.
    pub restitution_from_one: Option<Estimate>,
    /// Kinetic energy in J that the body behind gives.
    pub energy_given: Option<Estimate>,
    /// Kinetic energy in J that the body in front takes.
    pub energy_taken: Option<Estimate>,
    /// Kinetic energy in J that is lost.
    pub energy_lost: Option<Estimate>,
}

impl Passage {
    pub(super) fn of((a, x): (&Body, &Hits), (b, y): (&Body, &Hits), direction: f64) -> Passage {
        let n = x.n.min(y.n);
        let momentum = |mass: Option<f64>, hits: &Hits, sign: f64, method| {
            let mass = mass?;
            let std = hits.variance([1.0, -1.0]).map(|variance| mass * variance.sqrt());
            Some(Estimate::new(sign * mass * direction * hits.jump(), std, "N s", hits.n, method))
        };
        let given = momentum(a.mass, x, -1.0, "m(v⁻ − v⁺) of the body behind");
        let taken = momentum(b.mass, y, 1.0, "m(v⁺ − v⁻) of the body in front");
        let agree = given.as_ref().zip(taken.as_ref()).and_then(|(given, taken)| {
            let apart = (given.value - taken.value).abs();
            Some(apart <= DIFFERENT * given.std?.hypot(taken.std?))
        });
        let ([before, after], [struck_before, struck_after]) = (x.velocities, y.velocities);
        let approach = before - struck_before;
        let both = (struck_after - after) / approach;
        // dR = (dv_b⁺ − dv_a⁺ − R(dv_a⁻ − dv_b⁻))/(v_a⁻ − v_b⁻).
        let variance = x.variance([-both, -1.0]).zip(y.variance([both, 1.0]));
        let std = variance.map(|(a, b)| (a + b).sqrt() / approach.abs());
        let restitution = Estimate::new(both, std, "1", n, "separation over approach, from both records");
        let restitution_from_one = a.mass.zip(b.mass).map(|(m, struck)| {
            // v_b⁺ = (m/M)(v_a⁻ − v_a⁺); with ρ = v_a⁺/v_a⁻, R = (m/M)(1 − ρ) − ρ.
            let (ratio, rebound) = (m / struck, after / before);
            let std = x.variance([-rebound, 1.0]).map(|v| (1.0 + ratio) * v.sqrt() / before.abs());
            let value = ratio * (1.0 - rebound) - rebound;
            Estimate::new(value, std, "1", x.n, "balance of momentum, the body in front at rest")
        });
        let energy = |of: Option<(f64, Option<f64>)>, sign: f64, method| {
            of.map(|(value, std)| Estimate::new(sign * value, std, "J", n, method))
        };
        let lost = x.given.zip(y.given).map(|((from, std), (to, other))| {
            let std = std.zip(other).map(|(a, b)| a.hypot(b));
            Estimate::new(from + to, std, "J", n, "energy given less energy taken")
        });
        Passage {
            from: a.name.clone(),
            to: b.name.clone(),
            phase: x.phase[0],
            later: turn_between(y.phase[0], x.phase[0]),
            given,
            taken,
            agree,
            restitution: Some(restitution).filter(|r| r.value.is_finite()),
            restitution_from_one,
            energy_given: energy(x.given, 1.0, "mean of ½m(v⁻² − v⁺²) of the body behind"),
            energy_taken: energy(y.given, -1.0, "mean of ½m(v⁺² − v⁻²) of the body in front"),
            energy_lost: lost,
        }
    }

    /// Caution that both records do not agree on the momentum.
    pub(super) fn disagreement(&self) -> Option<Finding> {
        let (given, taken) = self.given.as_ref().zip(self.taken.as_ref())?;
        let found =
            Finding::caution("drill-momentum-differs").name("from", &*self.from).name("to", &*self.to);
        let found = found.number("given", given.value).number("given_std", given.std?);
        let found = found.number("taken", taken.value).number("taken_std", taken.std?);
        (self.agree == Some(false)).then_some(found)
    }
}
