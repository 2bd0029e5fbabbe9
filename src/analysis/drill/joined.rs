//! Records of several bodies of a machine, joined by the crank.

use super::modelled;
use crate::analysis::answer::Answer;
use crate::analysis::answer::left_out;
use crate::analysis::headline::headline;
use crate::campaign::DrillModelEntry;
use crate::compare::drill_comparison;
use crate::error::Result;
use crate::measure::Estimate;
use crate::measure::chain::{Body, Chain, Passage};
use crate::model::drill::MachineDraft;
use crate::record::Finding;
use crate::report::layout::{headed, lettered, pair, points, table};
use crate::report::words::About;
use crate::report::{AxisSpec, Cell, Figure, Ink, Legend, Marker, Plot, Series, Table};

/// Sets of records with one speed and each body once, in their order; and findings on records that do not
/// belong to the first set.
fn sets<'a>(bodies: &[&'a Body]) -> (Vec<Vec<&'a Body>>, Vec<About>) {
    let mut sets: Vec<Vec<&Body>> = Vec::new();
    let mut findings = Vec::new();
    for body in bodies.iter().copied() {
        let fits =
            |set: &&mut Vec<&Body>| set.iter().all(|other| body.runs_with(other) && other.name != body.name);
        if let Some(set) = sets.iter_mut().find(fits) {
            set.push(body);
            continue;
        }
        if let Some(first) = sets.first().map(|set| set[0]).filter(|first| !body.runs_with(first)) {
            let apart = Finding::caution("drill-speeds-apart").name("record", &*first.record);
            let apart = apart.number("speed", body.speed[0]).number("scatter", body.speed[1]);
            let apart = apart.number("other", first.speed[0]).number("other_scatter", first.speed[1]);
            findings.push((body.record.clone(), apart));
        }
        sets.push(vec![body]);
    }
    (sets, findings)
}

/// Answers of a joined machine, and of the model over it.
pub(super) struct Joined {
    pub machine: Answer,
    pub model: Option<Answer>,
}

/// The machines that are joined from records, and findings on records that are not. A model is drawn over
/// each.
///
/// # Errors
/// If the numbers cannot be written as JSON.
pub(super) fn joined(
    bodies: &[Body],
    model: Option<&(DrillModelEntry, MachineDraft)>,
) -> Result<(Vec<Joined>, Vec<About>)> {
    let (counted, uncounted): (Vec<&Body>, Vec<&Body>) = bodies.iter().partition(|body| body.crank);
    let (sets, mut apart) = sets(&counted);
    let uncounted = uncounted.iter().filter(|_| bodies.len() > 1);
    apart.extend(uncounted.map(|body| (body.record.clone(), Finding::caution("drill-no-crank"))));
    let mut answers = Vec::new();
    for set in sets {
        let Some(chain) = Chain::of(&set) else { continue };
        let mut answer = Answer::of(&chain)?;
        answer.add("", &chain.findings);
        answer.headlines.push(blow(&chain));
        answer.table("drill_chain", passages(&chain));
        answer.csv("drill_joined", &turn(&set));
        answer.figure("drill_joined", figure(&set, &chain));
        let mut modelled = None;
        if let Some((entry, draft)) = model {
            match drill_comparison(draft, entry, &set, &chain) {
                Ok(found) => modelled = Some(modelled::answer(&set, &chain, &found)?),
                Err(error) => answer.add("", [left_out("drill-model-left-out", &error)]),
            }
        }
        answers.push(Joined { machine: answer, model: modelled });
    }
    if model.is_some() && answers.is_empty() {
        apart.push((String::new(), Finding::caution("drill-model-unused")));
    }
    Ok((answers, apart))
}

/// Energy and rate of the blows.
fn blow(chain: &Chain) -> Table {
    headline(
        "Blows of the joined machine",
        [chain],
        &[
            ("speed", "Hz", &|c| c.speed.into()),
            ("blow energy", "J", &|c| c.blow_energy.as_ref().into()),
            ("blow rate", "1/min", &|c| c.blow_rate.into()),
            ("efficiency to the last body", "%", &|c| {
                c.efficiency
                    .as_ref()
                    .map_or(Cell::from(None::<f64>), |e| pair(100.0 * e.value, e.std.map(|s| 100.0 * s)))
            }),
        ],
    )
}

/// Momentum, restitution and energy at each contact.
fn passages(chain: &Chain) -> Table {
    let of = |estimate: &Option<Estimate>| Cell::from(estimate.as_ref());
    table(
        "Contacts of the joined machine",
        &chain.passages,
        &[
            ("from", "", &|p| p.from.as_str().into()),
            ("to", "", &|p| p.to.as_str().into()),
            ("phase", "°", &|p| (360.0 * p.phase).into()),
            ("momentum given", "N s", &|p| of(&p.given)),
            ("momentum taken", "N s", &|p| of(&p.taken)),
            ("records", "", &|p| agreement(p).into()),
            ("restitution, both records", "", &|p| of(&p.restitution)),
            ("restitution, first record alone", "", &|p| of(&p.restitution_from_one)),
            ("energy given", "J", &|p| of(&p.energy_given)),
            ("energy taken", "J", &|p| of(&p.energy_taken)),
            ("energy lost", "J", &|p| of(&p.energy_lost)),
        ],
    )
    .note("Given: by the body behind, by its own record; taken: by the body in front, by its. From the first record alone the body in front is at rest before. Records agree where momenta differ by no more than three standard uncertainties.")
}

fn agreement(passage: &Passage) -> &'static str {
    match passage.agree {
        Some(true) => "agree",
        Some(false) => "differ",
        None => "not compared: one has no uncertainty",
    }
}

/// Average turns beside each other, where all have the same phases.
fn turn(bodies: &[&Body]) -> Table {
    let names: Vec<[String; 3]> = bodies
        .iter()
        .map(|b| ["velocity", "scatter", "displacement"].map(|what| format!("{}, {what}", b.name)))
        .collect();
    let units = ["m/s", "m/s", "m"];
    let columns = names.iter().flat_map(|names| names.iter().map(String::as_str).zip(units));
    let mut table = headed("Joined turn", &[("phase", "1")].into_iter().chain(columns).collect::<Vec<_>>());
    let alike = bodies.iter().all(|body| body.phase == bodies[0].phase);
    for (i, phase) in bodies[0].phase.iter().enumerate().filter(|_| alike) {
        let row = bodies.iter().flat_map(|b| [b.mean[i], b.std[i], b.displacement[i]]);
        table.push([*phase].into_iter().chain(row).map(Cell::Number));
    }
    table
}

/// Values over a turn as a closed curve, since the turn ends where it begins.
pub(super) fn closed(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut curve: Vec<f64> = values.collect();
    curve.extend(curve.first().copied());
    curve
}

/// Velocities with their scatter and displacements of all bodies over a turn, positive in the direction of a
/// blow; vertical lines at the contacts.
fn figure(bodies: &[&Body], chain: &Chain) -> Figure {
    let x = || AxisSpec::new("Crank angle after the pulse", "°").limits(0.0, 360.0);
    let mut velocity = Plot::new(x(), AxisSpec::new("Velocity", "m/s")).legend(Legend::Above);
    let mut displacement = Plot::new(x(), AxisSpec::new("Displacement", "mm")).legend(Legend::Hidden);
    let sign = chain.direction;
    for (i, body) in bodies.iter().enumerate() {
        let degrees: Vec<f64> = body.phase.iter().map(|p| 360.0 * p).chain([360.0]).collect();
        let edge = |by: f64| closed(body.mean.iter().zip(&body.std).map(|(m, s)| sign * m + by * s));
        let ink = Ink::Nth(i);
        velocity = velocity.with(Series::band("", degrees.clone(), edge(-1.0), edge(1.0)).ink(ink));
        let mean = closed(body.mean.iter().map(|m| sign * m));
        velocity = velocity.with(Series::line(&*body.name, degrees.clone(), mean).ink(ink));
        for (side, marker) in [Marker::Circle, Marker::OpenCircle].into_iter().enumerate() {
            let places = body.hits.iter().map(|hits| (360.0 * hits.phase[0], sign * hits.velocities[side]));
            velocity = points(velocity, "", places, ink, marker);
        }
        let moved = closed(body.displacement.iter().map(|x| 1e3 * sign * x));
        displacement = displacement.with(Series::line(&*body.name, degrees, moved).ink(ink));
    }
    for passage in &chain.passages {
        let at = 360.0 * passage.phase;
        (velocity, displacement) =
            (velocity.with(Series::vertical("", at)), displacement.with(Series::vertical("", at)));
    }
    let figure = Figure::double(format!("Joined turn at {:.4} Hz", chain.speed)).height(130.0).shared_x();
    lettered(figure.panel(velocity).panel(displacement).caption(format!(
        "Average turns of separate runs ({}), joined by the crank and positive in the direction of a blow. (a) Velocities; shaded: ± 1 standard deviation from turn to turn; full circles: before an impact, open: after, without the smoothing of the average. (b) Displacements, each with a mean of 0: where the bodies are relative to each other is not measured. Vertical lines: contacts.",
        chain.records.join(", ")
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(record: &str, name: &str, speed: f64) -> Body {
        Body {
            record: record.to_owned(),
            name: name.to_owned(),
            mass: None,
            speed: [speed, 0.1],
            crank: true,
            rate: 1e5,
            instrument: None,
            smoothing: None,
            turns: 100,
            hits: Vec::new(),
            phase: Vec::new(),
            mean: Vec::new(),
            std: Vec::new(),
            displacement: Vec::new(),
        }
    }

    #[test]
    fn records_of_other_speeds_do_not_belong_together() {
        let all = [
            body("a", "striker", 45.0),
            body("b", "striker", 20.0),
            body("c", "bit", 45.05),
            body("d", "bit", 20.1),
            body("e", "bit", 45.0),
        ];
        let (found, findings) = sets(&all.each_ref());
        let names: Vec<Vec<&str>> =
            found.iter().map(|set| set.iter().map(|body| &*body.record).collect()).collect();
        assert_eq!(names, [vec!["a", "c"], vec!["b", "d"], vec!["e"]]);
        let apart: Vec<&str> = findings.iter().map(|(record, _)| record.as_str()).collect();
        assert_eq!(apart, ["b"]);
    }
}
