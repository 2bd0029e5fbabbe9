//! One turn of a hammer drill, its start, and its regimes over the speed and a second key.

use crate::analysis::model::drill::{Axis, Cell};
use crate::error::Result;
use crate::model::drill::{Machine, Regime, Run, Rung, Sample, Turn};
use crate::report::layout::{lettered, line, points};
use crate::report::{AxisSpec, Figure, Heatmap, Ink, Legend, Marker, Plot, Series, Stroke};
use ndarray::Array2;
use std::f64::consts::TAU;

/// Moving bodies: name, and the look of their lines.
const BODIES: [(&str, Ink, Stroke); 3] = [
    ("striker", Ink::Nth(0), Stroke::Solid),
    ("intermediate piston", Ink::Nth(1), Stroke::Dashed),
    ("bit", Ink::Nth(2), Stroke::Dotted),
];

/// Samples of turns, each with the number of turns since the first.
fn samples(turns: &[Turn]) -> impl Iterator<Item = (f64, &Sample)> {
    let all = turns.iter().enumerate().flat_map(|(i, turn)| turn.samples.iter().map(move |s| (i, s)));
    all.map(|(i, sample)| (i as f64 + sample.angle / TAU, sample))
}

/// Displacements of all bodies on one scale; the driving piston where its face is.
fn displacements(plot: Plot, machine: &Machine, turns: &[Turn], scale: f64) -> Plot {
    let face = samples(turns).map(|(t, s)| (scale * t, 1e3 * (s.piston - machine.cushion.length)));
    let mut plot = line(plot, "driving piston", face, Ink::Grey, Stroke::Solid);
    for (body, (name, ink, stroke)) in BODIES.into_iter().enumerate() {
        plot =
            line(plot, name, samples(turns).map(|(t, s)| (scale * t, 1e3 * s.positions[body])), ink, stroke);
    }
    plot
}

/// Displacements, velocities and pressure over the turns that are drawn.
pub fn drill_turn(machine: &Machine, run: &Run, turns: &[Turn]) -> Figure {
    let end = 360.0 * turns.len() as f64;
    let x = || AxisSpec::new("Angle of the crank from top dead centre", "°").limits(0.0, end);
    let displacement = Plot::new(x(), AxisSpec::new("Displacement", "mm")).legend(Legend::Above);
    let displacement = displacements(displacement, machine, turns, 360.0);
    let mut velocity = Plot::new(x(), AxisSpec::new("Velocity", "m/s")).legend(Legend::Hidden);
    for (body, (name, ink, stroke)) in BODIES.into_iter().enumerate() {
        velocity =
            line(velocity, name, samples(turns).map(|(t, s)| (360.0 * t, s.velocities[body])), ink, stroke);
    }
    let pressure = Plot::new(x(), AxisSpec::new("Pressure", "kPa")).legend(Legend::Hidden);
    let over = samples(turns).map(|(t, s)| (360.0 * t, 1e-3 * s.pressure));
    let pressure = line(pressure, "", over, Ink::Nth(0), Stroke::Solid)
        .with(Series::horizontal("", 1e-3 * machine.cushion.ambient));
    let figure = Figure::double(format!("Turn at {:.4} Hz", machine.crank.frequency))
        .height(170.0)
        .shared_x()
        .panel(displacement)
        .panel(velocity)
        .panel(pressure);
    lettered(figure.caption(format!(
        "Model {} of the impact unit, {}. (a) Displacements towards the bit; striker and intermediate piston touch where their lines meet, so do intermediate piston and bit. The cushion lies between driving piston and striker. (b) Velocities towards the bit. (c) Absolute pressure of the cushion; the horizontal line is the ambient one.",
        run.rung.name(),
        run.regime.name(),
    )))
}

/// First turns from rest: displacements above, energy of the blows below.
pub fn drill_start(machine: &Machine, turns: &[Turn], caught: Option<usize>) -> Figure {
    let x = || AxisSpec::new("Turns from rest", "").limits(0.0, turns.len() as f64);
    let displacement = Plot::new(x(), AxisSpec::new("Displacement", "mm")).legend(Legend::Above);
    let displacement = displacements(displacement, machine, turns, 1.0);
    let place = |time: f64| time / machine.crank.period();
    let blows = turns.iter().filter_map(|turn| turn.blow).map(|blow| (place(blow.time), blow.energy));
    let blows = points(
        Plot::new(x(), AxisSpec::new("Blow energy", "J").limits(0.0, f64::NAN)),
        "",
        blows,
        Ink::Nth(0),
        Marker::Circle,
    );
    let caught = match caught {
        Some(turn) => format!("The first blow comes in turn {}.", turn + 1),
        None => "No blow comes.".to_owned(),
    };
    let figure =
        Figure::double(format!("Start at {:.4} Hz", machine.crank.frequency)).height(120.0).shared_x();
    lettered(figure.panel(displacement).panel(blows.legend(Legend::Hidden)).caption(format!(
        "From rest, the striker on the intermediate piston. (a) Displacements. (b) Energy ½mv² of the striker before each blow. {caught}"
    )))
}

/// Energy and rate of the blows over the speed.
pub fn drill_speeds(cells: &[Cell], rung: Rung) -> Figure {
    let (low, high) = (cells[0].speed, cells[cells.len() - 1].speed);
    let room = 0.03 * (high - low);
    let x = || AxisSpec::new("Speed", "Hz").limits(low - room, high + room);
    let mut energy =
        Plot::new(x(), AxisSpec::new("Blow energy", "J").limits(0.0, f64::NAN)).legend(Legend::Above);
    let mut rate =
        Plot::new(x(), AxisSpec::new("Blow rate", "1/min").limits(0.0, f64::NAN)).legend(Legend::Hidden);
    let mut pressure =
        Plot::new(x(), AxisSpec::new("Largest pressure", "kPa").limits(0.0, f64::NAN)).legend(Legend::Hidden);
    let ends = cells.iter().map(|cell| (cell.speed, 60.0 * cell.speed));
    rate = line(rate, "", ends, Ink::Grey, Stroke::Dashed);
    let markers = [Marker::OpenCircle, Marker::Circle, Marker::Square, Marker::Cross];
    for ((i, regime), marker) in Regime::ALL.into_iter().enumerate().zip(markers) {
        let of = || cells.iter().filter(move |cell| cell.regime == Some(regime));
        let struck = of().flat_map(|cell| {
            let none = cell.energies.is_empty().then_some((cell.speed, 0.0));
            cell.energies.iter().map(|energy| (cell.speed, *energy)).chain(none)
        });
        let ink = Ink::Nth(i);
        energy = points(energy, regime.name(), struck, ink, marker);
        rate = points(rate, "", of().map(|cell| (cell.speed, cell.blow_rate)), ink, marker);
        let largest = of().filter_map(|cell| Some((cell.speed, 1e-3 * cell.extremes?.pressure[1])));
        pressure = points(pressure, "", largest, ink, marker);
    }
    let figure = Figure::double("Speeds").height(170.0).shared_x().panel(energy).panel(rate).panel(pressure);
    lettered(figure.caption(format!(
        "Model {} at each speed, from rest. (a) Energy of every analysed blow; 0 without a blow. (b) Blows a minute; on the dashed line one every turn. (c) Largest absolute pressure of the cushion.",
        rung.name()
    )))
}

/// Regimes and blow energy over the speed and a second key.
///
/// # Errors
/// As [`Heatmap::new`].
pub fn drill_map((speeds, over): (&[f64], &Axis), cells: &[Cell], rung: Rung) -> Result<Figure> {
    let matrix = |value: &dyn Fn(&Cell) -> f64| {
        Array2::from_shape_fn((over.values.len(), speeds.len()), |(row, column)| {
            value(&cells[row * speeds.len() + column])
        })
    };
    let class = |regime: Regime| Regime::ALL.iter().position(|r| *r == regime);
    let regime = matrix(&|c| c.regime.and_then(class).map_or(f64::NAN, |class| class as f64));
    let energy = matrix(&|c| c.blow_energy.unwrap_or(f64::NAN));
    let names = Regime::ALL.map(Regime::name);
    let plot = |title: &str| {
        Plot::new(AxisSpec::new("Speed", "Hz"), AxisSpec::new(&*over.key, over.unit)).title(title)
    };
    let scale = AxisSpec::new("Blow energy", "J").limits(0.0, f64::NAN);
    let figure = Figure::double("Regimes")
        .columns(2)
        .panel(
            plot("regime")
                .heatmap(Heatmap::classes(speeds, &over.values, &regime, &names)?)
                .legend(Legend::Above),
        )
        .panel(plot("blow energy").heatmap(Heatmap::new(speeds, &over.values, &energy, scale)?));
    Ok(lettered(figure.caption(format!(
        "Model {} in each cell, from rest. (a) Pattern of the blows. (b) Mean energy ½mv² of the striker before a blow; white without one.",
        rung.name()
    ))))
}
