//! Tables of a hammer drill.

use crate::model::drill::{Book, Extremes, Impact, Interface, Ladder, Machine, Run, Rung, Turn};
use crate::report::layout::{headed, table};
use crate::report::{Cell, Table};
use crate::units::notation::significant;

/// Energy of the bit over that of the striker.
pub(super) fn efficiency(run: &Run) -> Option<f64> {
    Some(run.bit_energy? / run.blow_energy?)
}

/// Relative scatter of the blow energy, without what the integration errs by.
pub(super) fn scatter(run: &Run) -> Option<f64> {
    let part = run.blow_scatter? / run.blow_energy?;
    Some(if part < 1e-6 { 0.0 } else { part })
}

/// Extremes over turns; `None` without air.
pub(super) fn extremes(turns: &[Turn]) -> Option<Extremes> {
    let all = turns.iter().fold(Extremes::default(), |all, turn| all.with(&turn.extremes));
    all.pressure[0].is_finite().then_some(all)
}

/// Mean energy book of turns.
pub(super) fn mean_book(turns: &[Turn]) -> Book {
    let mean =
        |of: fn(&Book) -> f64| turns.iter().map(|turn| of(&turn.book)).sum::<f64>() / turns.len() as f64;
    Book {
        piston: mean(|b| b.piston),
        kinetic: mean(|b| b.kinetic),
        potential: mean(|b| b.potential),
        elastic: mean(|b| b.elastic),
        air: mean(|b| b.air),
        impacts: mean(|b| b.impacts),
        contacts: mean(|b| b.contacts),
        seal: mean(|b| b.seal),
        flow: mean(|b| b.flow),
        residual: mean(|b| b.residual),
    }
}

/// Blows in one row.
pub(super) fn blows(machine: &Machine, run: &Run) -> Table {
    let speed = |run: &Run| {
        let all: Vec<f64> = run.blows.iter().flatten().map(|blow| blow.speed).collect();
        (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
    };
    table(
        "Blows",
        [run],
        &[
            ("speed", "Hz", &|_| machine.crank.frequency.into()),
            ("regime", "", &|r| r.regime.name().into()),
            ("blow energy", "J", &|r| r.blow_energy.into()),
            ("scatter", "%", &|r| scatter(r).map(|part| 100.0 * part).into()),
            ("blow rate", "1/min", &|r| (60.0 * r.rate).into()),
            ("striker", "m/s", &|r| speed(r).into()),
            ("energy of the bit", "J", &|r| r.bit_energy.into()),
            ("efficiency", "%", &|r| efficiency(r).map(|part| 100.0 * part).into()),
            ("first blow in turn", "", &|r| r.caught.map(|turn| (turn + 1) as f64).into()),
        ],
    )
    .note("Energies are ½mv², of the striker just before it strikes and of the bit after the chain has parted. They are not blow energies by EPTA.")
}

/// Impacts of the analysed turns, one row an interface.
pub(super) fn impacts(run: &Run) -> Table {
    let turns = run.turns.len() as f64;
    let of = |interface: Interface| {
        run.turns.iter().flat_map(|turn| &turn.impacts).filter(move |impact| impact.interface == interface)
    };
    let fastest = |interface: Interface| {
        of(interface).max_by(|a, b| (a.before[0] - a.before[1]).total_cmp(&(b.before[0] - b.before[1])))
    };
    let struck = Interface::ALL.into_iter().filter(|interface| fastest(*interface).is_some());
    // Velocities that are rounding only.
    let clean = |v: f64| if v.abs() < 1e-9 { 0.0 } else { v };
    let side = |k: Interface, of: fn(&Impact) -> f64| fastest(k).map(|impact| clean(of(impact)));
    let lost = |k: Interface| {
        let rigid = of(k).all(|impact| impact.duration == 0.0);
        rigid.then(|| of(k).map(|impact| impact.lost).sum::<f64>() / turns)
    };
    let duration = |k: &Interface| fastest(*k).map(|i| 1e3 * i.duration).filter(|duration| *duration > 0.0);
    table(
        "Impacts",
        struck,
        &[
            ("of", "", &|k| k.name().into()),
            ("a turn", "", &|k| (of(*k).count() as f64 / turns).into()),
            ("fastest approach", "m/s", &|k| fastest(*k).map(|i| i.before[0] - i.before[1]).into()),
            ("behind, before", "m/s", &|k| side(*k, |i| i.before[0]).into()),
            ("in front, before", "m/s", &|k| side(*k, |i| i.before[1]).into()),
            ("behind, after", "m/s", &|k| side(*k, |i| i.after[0]).into()),
            ("in front, after", "m/s", &|k| side(*k, |i| i.after[1]).into()),
            ("contact", "ms", &|k| duration(k).into()),
            ("lost a turn", "J", &|k| lost(*k).into()),
        ],
    )
    .note("Velocities of the fastest impact, towards the bit. Lost: at rigid impacts; contacts that give way act at once, and `Energy of a turn` has their loss.")
}

/// Extremes of forces and pressure.
pub(super) fn forces(found: &Extremes, [handle, damper]: [f64; 2]) -> Table {
    let rows = [
        ("force on the housing", "N", found.handle, Some(handle)),
        ("force on the damper", "N", found.damper, Some(damper)),
        ("pressure of the air", "kPa", found.pressure.map(|p| 1e-3 * p), None),
    ];
    table(
        "Forces and pressure",
        rows,
        &[
            ("quantity", "", &|r| r.0.into()),
            ("unit", "", &|r| r.1.into()),
            ("least", "", &|r| r.2[0].into()),
            ("largest", "", &|r| r.2[1].into()),
            ("impulse a turn in N s", "", &|r| r.3.into()),
        ],
    )
    .note("Forces towards the bit, without those of rigid impacts, which have no duration; their impulses count.")
}

/// Where the energy of a turn goes.
pub(super) fn energies(book: &Book) -> Table {
    let rows = [
        ("work of the driving piston", book.piston),
        ("lost at rigid impacts", book.impacts),
        ("lost in compliant contacts and the damper", book.contacts),
        ("lost in the seal", book.seal),
        ("lost by flow", book.flow),
        (
            "stored in motion, height, contacts and air",
            book.kinetic + book.potential + book.elastic + book.air,
        ),
        ("not accounted for", book.residual),
    ];
    table("Energy of a turn", rows, &[("part", "", &|r| r.0.into()), ("energy", "J", &|r| r.1.into())])
        .note("Mean over the analysed turns. What is not accounted for is the error of the integration.")
}

/// The ladder of models.
pub(super) fn models(ladder: &Ladder) -> Table {
    let answer =
        |step: &crate::model::drill::Step, of: fn(&Run) -> Option<f64>| step.run.as_ref().and_then(of);
    table(
        "Models compared",
        &ladder.steps,
        &[
            ("model", "", &|s| s.rung.name().into()),
            ("adds", "", &|s| added(s.rung).into()),
            ("blow energy", "J", &|s| answer(s, |run| run.blow_energy).into()),
            ("energy of the bit", "J", &|s| answer(s, |run| run.bit_energy).into()),
            ("blow rate", "1/min", &|s| answer(s, |run| Some(60.0 * run.rate)).into()),
            ("error", "%", &|s| match s.error {
                Some(error) if error.is_finite() => Cell::from(100.0 * error),
                Some(_) => "one strikes, one does not".into(),
                None => Cell::from(s.refused.clone()),
            }),
            ("integration steps", "", &|s| answer(s, |run| Some(run.steps as f64)).into()),
            ("chosen", "", &|s| (s.rung == ladder.chosen).into()),
        ],
    )
    .note("Error: largest relative difference of blow energy, energy of the bit and rate from the compliant model.")
}

/// What a rung knows beyond the one before.
fn added(rung: Rung) -> &'static str {
    match rung {
        Rung::Prescribed => "a striker thrown at the piston's largest speed",
        Rung::Sealed => "a sealed air cushion",
        Rung::Vented => "leakage and vents",
        Rung::Friction => "friction of the seal",
        Rung::Compliant => "contacts that give way",
    }
}

/// Samples of turns.
pub(super) fn turn(turns: &[Turn]) -> Table {
    let columns = [
        ("angle", "°"),
        ("driving piston", "m"),
        ("striker", "m"),
        ("intermediate piston", "m"),
        ("bit", "m"),
        ("striker velocity", "m/s"),
        ("intermediate piston velocity", "m/s"),
        ("bit velocity", "m/s"),
        ("pressure", "Pa"),
        ("force on the housing", "N"),
        ("force on the damper", "N"),
    ];
    let mut table = headed("Turn", &columns);
    for (index, sample) in
        turns.iter().enumerate().flat_map(|(i, turn)| turn.samples.iter().map(move |s| (i, s)))
    {
        let angle = sample.angle.to_degrees() + 360.0 * index as f64;
        let ([x, y, z], [u, v, w]) = (sample.positions, sample.velocities);
        let all = [angle, sample.piston, x, y, z, u, v, w, sample.pressure, sample.handle, sample.damper];
        table.push(all.map(Cell::Number));
    }
    table
}

/// First turns of a start.
pub(super) fn start(turns: &[Turn]) -> Table {
    let largest = |turn: &Turn| {
        let positions = turn.samples.iter().map(|sample| sample.positions[0]);
        let (low, high) =
            positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        (high >= low).then_some(1e3 * (high - low))
    };
    table(
        "Start from rest",
        turns.iter().enumerate(),
        &[
            ("turn", "", &|(i, _)| (i + 1).into()),
            ("stroke of the striker", "mm", &|(_, t)| largest(t).into()),
            ("largest pressure", "kPa", &|(_, t)| {
                extremes(&[(*t).clone()]).map(|e| 1e-3 * e.pressure[1]).into()
            }),
            ("striker", "m/s", &|(_, t)| t.blow.map(|blow| blow.speed).into()),
            ("blow energy", "J", &|(_, t)| match t.blow {
                Some(blow) => Cell::from(significant(blow.energy, 4)),
                None => Cell::from("no blow"),
            }),
        ],
    )
}
