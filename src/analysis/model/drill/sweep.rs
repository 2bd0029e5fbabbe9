//! Sweep of the speed of a hammer drill, and map over the speed and a second key.

use crate::analysis::answer::Answer;
use crate::analysis::model::figures;
use crate::analysis::progress::Progress;
use crate::error::{Error, Result};
use crate::model::drill::{Course, Extremes, MachineDraft, Regime, Rung, run};
use crate::record::Finding;
use crate::report::Table;
use crate::report::layout::table;
use rayon::prelude::*;
use serde::Serialize;
use serde_json::json;

/// Most values of an axis.
const MOST_VALUES: usize = 1000;
/// Most turns of all cells together: some minutes of work.
const MOST_TURNS: usize = 1_000_000;

/// Even values of the speed or of a key.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Key of the drill.
    pub key: String,
    /// Unit of the key.
    pub unit: &'static str,
    /// Values.
    pub values: Vec<f64>,
}

impl Axis {
    /// Speeds, `LOW:HIGH:N`.
    ///
    /// # Errors
    /// If the text is no such range.
    pub fn of_speeds(text: &str) -> Result<Axis> {
        let values = range(text).ok_or_else(|| {
            Error::usage(format!("speeds {text:?}"), format!("LOW:HIGH:N in Hz, N from 2 to {MOST_VALUES}"))
                .set("speeds", "5:60:56")
        })?;
        Ok(Axis { key: "crank.frequency".to_owned(), unit: "Hz", values })
    }

    /// A key with its range, `KEY=LOW:HIGH:N`.
    ///
    /// # Errors
    /// If the text is no such range, or the key takes no number.
    pub fn of_key(text: &str) -> Result<Axis> {
        let (key, values) = text.split_once('=').unwrap_or((text, ""));
        let values = range(values).ok_or_else(|| {
            Error::usage(format!("over {text:?}"), format!("KEY=LOW:HIGH:N, N from 2 to {MOST_VALUES}"))
                .set("over", "cushion.length=0.015:0.03:20")
        })?;
        MachineDraft::default().put(key, values[0]).map_err(|e| e.setting("over"))?;
        Ok(Axis { key: key.to_owned(), unit: crate::model::drill::Machine::unit_of(key), values })
    }
}

/// The values of `LOW:HIGH:N`.
fn range(text: &str) -> Option<Vec<f64>> {
    let mut parts = text.split(':').map(str::trim);
    let mut number = || parts.next()?.parse::<f64>().ok().filter(|value| value.is_finite());
    let (low, high) = (number()?, number()?);
    let n: usize = parts.next()?.parse().ok()?;
    let fine = parts.next().is_none() && low < high && (2..=MOST_VALUES).contains(&n);
    fine.then(|| (0..n).map(|i| low + (high - low) * (i as f64 / (n - 1) as f64)).collect())
}

/// Checks that one command can compute the cells.
///
/// # Errors
/// If they take too many turns.
pub fn check_work(speeds: &Axis, over: Option<&Axis>, turns: usize) -> Result<()> {
    let cells = speeds.values.len() * over.map_or(1, |axis| axis.values.len());
    if cells * turns <= MOST_TURNS {
        return Ok(());
    }
    let found = format!("{cells} machines of {turns} turns");
    Err(Error::usage(found, format!("{MOST_TURNS} turns in all")).setting("over").setting("settle"))
}

/// A machine of a sweep.
#[derive(Debug, Clone, Serialize)]
pub struct Cell {
    /// Turns of the crank a second.
    pub speed: f64,
    /// Value of the second key.
    pub value: Option<f64>,
    /// Pattern of the blows; `None` without an answer.
    pub regime: Option<Regime>,
    /// Mean energy of a blow in J.
    pub blow_energy: Option<f64>,
    /// Mean energy of the bit in J.
    pub bit_energy: Option<f64>,
    /// Blows a minute.
    pub blow_rate: f64,
    /// Energy of each blow in J.
    pub energies: Vec<f64>,
    /// Extremes of forces and pressure.
    pub extremes: Option<Extremes>,
    /// Reason why there is no answer.
    pub refused: Option<String>,
}

/// Machines over the speed, and over a second key.
#[derive(Debug)]
pub struct Sweep<'a> {
    speeds: &'a Axis,
    over: Option<&'a Axis>,
    rung: Rung,
    /// Rows over the second key, each over the speeds.
    cells: Vec<Cell>,
}

impl<'a> Sweep<'a> {
    /// Runs every machine from rest.
    ///
    /// # Errors
    /// If a value of an axis is impossible.
    pub fn of(
        draft: &MachineDraft,
        rung: Rung,
        course: &Course,
        (speeds, over): (&'a Axis, Option<&'a Axis>),
        progress: &dyn Progress,
    ) -> Result<Sweep<'a>> {
        let rows: Vec<Option<f64>> =
            over.map_or(vec![None], |axis| axis.values.iter().copied().map(Some).collect());
        let mut machines = Vec::new();
        for value in rows {
            for speed in &speeds.values {
                let mut draft = draft.clone();
                if let Some((axis, value)) = over.zip(value) {
                    draft.put(&axis.key, value)?;
                }
                draft.put(&speeds.key, *speed)?;
                machines.push((value, draft.machine()?));
            }
        }
        progress.start("speeds", machines.len());
        let cell = |(value, machine): &(Option<f64>, crate::model::drill::Machine)| {
            let found = run(machine, rung, course);
            progress.step();
            let refused = found.as_ref().err().map(Error::why);
            let found = found.ok();
            Cell {
                speed: machine.crank.frequency,
                value: *value,
                regime: found.as_ref().map(|run| run.regime),
                blow_energy: found.as_ref().and_then(|run| run.blow_energy),
                bit_energy: found.as_ref().and_then(|run| run.bit_energy),
                blow_rate: found.as_ref().map_or(0.0, |run| 60.0 * run.rate),
                energies: found.iter().flat_map(|run| &run.blows).flatten().map(|blow| blow.energy).collect(),
                extremes: found.as_ref().and_then(|run| super::tables::extremes(&run.turns)),
                refused,
            }
        };
        let cells = machines.par_iter().map(cell).collect();
        Ok(Sweep { speeds, over, rung, cells })
    }

    /// Adds the cells as JSON, table, figure and finding.
    ///
    /// # Errors
    /// If the figure cannot be made.
    pub fn add_to(&self, answer: &mut Answer) -> Result<()> {
        let refused: Vec<&Cell> = self.cells.iter().filter(|cell| cell.refused.is_some()).collect();
        if let Some(first) = refused.first() {
            let found = Finding::caution("drill-cells-refused").count("n", refused.len());
            let found = found.count("all", self.cells.len()).number("speed", first.speed);
            answer.add("", [found.name("why", first.refused.as_deref().unwrap_or_default())]);
        }
        let Some(over) = self.over else {
            answer.result.insert("speeds".to_owned(), json!(self.cells));
            answer.table("speeds", self.table("Speeds"));
            answer.figure("speeds", figures::drill_speeds(&self.cells, self.rung));
            return Ok(());
        };
        let map = json!({ "over": over.key, "unit": over.unit, "values": over.values, "speeds": self.speeds.values, "cells": self.cells });
        answer.result.insert("map".to_owned(), map);
        answer.csv("map", &self.table("Map"));
        answer.tables.push(self.counted());
        let axes = (&*self.speeds.values, over);
        answer.figure("map", figures::drill_map(axes, &self.cells, self.rung)?);
        Ok(())
    }

    /// One row a machine.
    fn table(&self, title: &str) -> Table {
        let kilopascal = |c: &Cell| c.extremes.map(|e| 1e-3 * e.pressure[1]);
        let mut found = table(
            title,
            &self.cells,
            &[
                ("speed", "Hz", &|c| c.speed.into()),
                ("regime", "", &|c| c.regime.map(Regime::name).into()),
                ("blow energy", "J", &|c| c.blow_energy.into()),
                ("blow rate", "1/min", &|c| c.blow_rate.into()),
                ("energy of the bit", "J", &|c| c.bit_energy.into()),
                ("largest pressure", "kPa", &|c| kilopascal(c).into()),
                ("largest pull on the housing", "N", &|c| c.extremes.map(|e| -e.handle[0]).into()),
            ],
        );
        if let Some(over) = self.over {
            found = found.column(&*over.key, over.unit);
            found.rows.iter_mut().zip(&self.cells).for_each(|(row, cell)| row.push(cell.value.into()));
        }
        found
    }

    /// Number of cells of each regime.
    fn counted(&self) -> Table {
        let count = |regime: &Regime| self.cells.iter().filter(|cell| cell.regime == Some(*regime)).count();
        let rows = Regime::ALL.into_iter().filter(|regime| count(regime) > 0);
        table("Regimes", rows, &[("regime", "", &|r| r.name().into()), ("cells", "", &|r| count(r).into())])
    }
}
