//! Numbers of the blows: measured, and of the model.

use super::BODIES;
use super::turn::{ModelTurn, TurnModel};
use crate::measure::Estimate;
use crate::measure::chain::Chain;
use crate::model::drill::{Impact, Interface, Machine};
use serde::Serialize;

/// A number of the blows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Name, with the bodies.
    pub quantity: String,
    /// Measured.
    pub measured: Estimate,
    /// By the model.
    pub model: Estimate,
    /// Measured less model in standard uncertainties of the measurement; `None` where that has none.
    pub deviations: Option<f64>,
}

impl Difference {
    fn of(quantity: impl Into<String>, measured: &Estimate, model: f64) -> Difference {
        let deviations = measured.std.filter(|std| *std > 0.0).map(|std| (measured.value - model) / std);
        let model = Estimate::new(model, None, measured.unit, 1, "mean over the blows of the model");
        Difference { quantity: quantity.into(), measured: measured.clone(), model, deviations }
    }
}

/// Mean over the strongest impact at an interface in each turn; `None` without one.
fn mean(turn: &ModelTurn, interface: Interface, of: impl Fn(&Impact) -> f64) -> Option<f64> {
    let approach = |impact: &&Impact| impact.before[0] - impact.before[1];
    let strongest = turn.run.turns.iter().filter_map(|turn| {
        let own = turn.impacts.iter().filter(|impact| impact.interface == interface);
        own.max_by(|a, b| approach(a).total_cmp(&approach(b)))
    });
    let (sum, n) = strongest.fold((0.0, 0.0), |(sum, n), impact| (sum + of(impact), n + 1.0));
    (n > 0.0).then(|| sum / n)
}

/// Numbers that both have. The angle of the blow is one only where that of the pulse is stated.
pub fn differences(
    machine: &Machine,
    turn: &ModelTurn,
    turns: &TurnModel<'_>,
    chain: &Chain,
    pulse_angle: Option<f64>,
) -> Vec<Difference> {
    let mut found = Vec::new();
    let striker = turns.bodies.iter().find(|(_, place)| *place == 0);
    let hits = striker.and_then(|(body, _)| body.hits.first());
    if let Some(hits) = hits {
        let std = hits.covariance.map(|c| c[0][0].sqrt());
        let speed = turns.direction * hits.velocities[0];
        let method = "mean velocity before the strongest impacts";
        let speed = Estimate::new(speed, std, "m/s", hits.n, method);
        let of_model = mean(turn, Interface::Striker, |impact| impact.before[0]);
        found.extend(
            of_model.map(|model| Difference::of("speed of the striker before the blow", &speed, model)),
        );
        let period = machine.crank.period();
        let ahead = |impact: &Impact| 360.0 * (impact.time + 0.5 * impact.duration) / period;
        // The mean of directions: angles on both sides of top dead centre have none of their own.
        let directed = |of: fn(f64) -> f64| mean(turn, Interface::Striker, |i| of(ahead(i).to_radians()));
        if let (Some(pulse), Some(sine), Some(cosine)) = (pulse_angle, directed(f64::sin), directed(f64::cos))
        {
            let model = sine.atan2(cosine).to_degrees();
            let std = 360.0 * hits.phase[1] / (hits.n as f64).sqrt();
            // Within half a turn of the measured one.
            let angle = 360.0 * hits.phase[0] + pulse;
            let model = angle + (model - angle + 180.0).rem_euclid(360.0) - 180.0;
            let angle = Estimate::new(angle, Some(std), "°", hits.n, "mean phase of the strongest impacts");
            found.push(Difference::of("angle of the blow after top dead centre", &angle, model));
        }
    }
    // Energy and rate of the chain are those of its first body.
    let first = chain.bodies.first().is_some_and(|name| name.eq_ignore_ascii_case(BODIES[0]));
    if first {
        let energy = mean(turn, Interface::Striker, |i| 0.5 * machine.striker.mass * i.before[0].powi(2));
        let energies = chain.blow_energy.as_ref().zip(energy);
        found.extend(energies.map(|(measured, model)| Difference::of("blow energy", measured, model)));
    }
    if let Some(rate) = chain.blow_rate.filter(|_| first) {
        let rate =
            Estimate::new(rate, None, "1/min", hits.map_or(0, |hits| hits.n), "impacts a turn times speed");
        found.push(Difference::of("blow rate", &rate, 60.0 * turn.run.rate));
    }
    let masses = [machine.striker.mass, machine.intermediate.mass, machine.bit.mass];
    for (behind, interface) in [(0, Interface::Striker), (1, Interface::Bit)] {
        let is = |name: &str, place: usize| name.eq_ignore_ascii_case(BODIES[place]);
        let own = chain.passages.iter().find(|p| is(&p.from, behind) && is(&p.to, behind + 1));
        let Some(passage) = own else { continue };
        let [a, b] = [masses[behind], masses[behind + 1]];
        let mut add = |name: &str, measured: &Option<Estimate>, of: &dyn Fn(&Impact) -> f64| {
            let both = measured.as_ref().zip(mean(turn, interface, of));
            let quantity = format!("{name}, {}", interface.name());
            found.extend(both.map(|(measured, model)| Difference::of(quantity, measured, model)));
        };
        add("restitution", &passage.restitution, &|i| {
            (i.after[1] - i.after[0]) / (i.before[0] - i.before[1])
        });
        add("momentum given", &passage.given, &|i| a * (i.before[0] - i.after[0]));
        add("energy taken", &passage.energy_taken, &|i| 0.5 * b * (i.after[1].powi(2) - i.before[1].powi(2)));
    }
    found
}
