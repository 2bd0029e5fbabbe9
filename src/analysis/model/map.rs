//! Regime and stability over two parameters: `vibro model map`.

mod packed;

use super::{Driven, SceneKeys, figures};
use crate::analysis::answer::{Answer, unwritten};
use crate::analysis::progress::Progress;
use crate::analysis::study::{self, Cells, Study};
use crate::error::Result;
use crate::model::Regime;
use crate::model::map::{Cell, MapAxis, Plan};
use crate::record::Finding;
use crate::report::Table;
use crate::report::files::Names;
use crate::report::layout::{Shown, table};
use crate::write::npy;
use packed::{FIELDS, packed, unpacked};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::HashMap;

/// Keys of `vibro model map`.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// The scene.
    #[cfg_attr(feature = "cli", command(flatten))]
    pub scene: SceneKeys,
    /// Parameter across: one of m1 m2 k1 k2 c1 c2 gap restitution frequency force impulse width, e.g.
    /// frequency:3:14:120
    #[cfg_attr(feature = "cli", arg(value_name = "NAME:LOW:HIGH:N"))]
    pub x: String,
    /// Parameter upwards, as x
    #[cfg_attr(feature = "cli", arg(value_name = "NAME:LOW:HIGH:N"))]
    pub y: String,
    /// Excitation frequency in Hz, where it is not varied
    pub frequency: Option<f64>,
    /// Cycles of each cell, from rest; a settled cell ends earlier
    #[cfg_attr(feature = "cli", arg(default_value_t = 200))]
    pub cycles: u32,
}

impl Keys {
    /// Names of the files in its answer.
    pub const FILES: Names = Names::Numbered(&["map"]);

    /// The map.
    ///
    /// # Errors
    /// If the scene or a key is impossible, or nothing drives the rig; if it takes more cycles than one
    /// command computes.
    pub fn answer(&self, progress: &dyn Progress) -> Result<Answer> {
        let map = self.study()?;
        map.plan.check_work().map_err(|e| e.hint("in parts on one machine or many").set("shard", "1/16"))?;
        study::whole(&map, progress)
    }

    /// The map as cells that are still to be computed.
    ///
    /// # Errors
    /// If the scene or a key is impossible, or nothing drives the rig.
    pub fn study(&self) -> Result<Map> {
        let (x, y): (MapAxis, MapAxis) = (self.x.parse()?, self.y.parse()?);
        // A varied parameter need not be stated: the excitation then has its lowest value.
        let or_varied = |given: Option<f64>, name: &str| {
            given.or_else(|| [&x, &y].into_iter().find(|a| a.key.name() == name).map(|a| a.low))
        };
        let scene = SceneKeys {
            force: or_varied(self.scene.force, "force"),
            impulse: or_varied(self.scene.impulse, "impulse"),
            width: or_varied(self.scene.width, "width"),
            ..self.scene.clone()
        };
        let Driven { scene, excitation, findings } = scene.driven(or_varied(self.frequency, "frequency"))?;
        let plan = Plan { rig: scene.rig, excitation, x, y, cycles: self.cycles };
        plan.check()?;
        let scene = serde_json::to_value(scene).map_err(unwritten)?;
        Ok(Map { scene, plan, findings })
    }
}

/// A map whose cells are computed one by one.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Map {
    /// The scene, as answers state it.
    scene: Value,
    plan: Plan,
    findings: Vec<Finding>,
}

/// Largest number of cells that are listed in JSON and CSV, and drawn.
const LISTED: usize = 1_000_000;

impl Study for Map {
    fn what(&self) -> &'static str {
        "map"
    }

    fn cells(&self) -> u64 {
        self.plan.cells()
    }

    fn cell(&self, number: u64) -> Result<Vec<u8>> {
        Ok(packed(&self.plan.cell(number)).to_vec())
    }

    fn answer(&self, cells: &mut Cells<'_>) -> Result<Answer> {
        let Map { scene, plan, findings } = self;
        let (columns, rows) = (plan.x.n, plan.y.n);
        // Of a map with more cells every n-th column and row is drawn.
        let nth = (1..=columns.max(rows))
            .find(|nth| columns.div_ceil(*nth) * rows.div_ceil(*nth) <= LISTED)
            .unwrap_or(1);
        let mut array = npy::header(FIELDS, &format!("({rows}, {columns})"));
        let mut counts: HashMap<Option<Regime>, usize> = HashMap::new();
        let mut drawn: Vec<Vec<Cell>> = Vec::new();
        for row in 0..rows {
            let mut drawn_row = Vec::new();
            for (column, cell) in (&mut *cells).take(columns).enumerate() {
                let bytes = cell?;
                let cell = unpacked(&bytes)?;
                array.extend(bytes);
                *counts.entry(cell.regime).or_default() += 1;
                if row % nth == 0 && column % nth == 0 {
                    drawn_row.push(cell);
                }
            }
            if row % nth == 0 {
                drawn.push(drawn_row);
            }
        }
        let missing = counts.remove(&None).unwrap_or(0);
        let counts = figures::counted(counts.into_iter().filter_map(|(regime, n)| Some((regime?, n))));
        let grid = |of: &dyn Fn(&Cell) -> Value| -> Value {
            let all = drawn.iter().map(|row| row.iter().map(of).collect::<Value>());
            if nth == 1 { all.collect() } else { Value::Null }
        };
        let mut answer = Answer::of(&json!({
            "scene": scene,
            "x_name": plan.x.key.name(),
            "y_name": plan.y.key.name(),
            "x": plan.x.values(),
            "y": plan.y.values(),
            "regime": grid(&|c| json!(c.regime)),
            "spectral_radius": grid(&|c| json!(c.spectral_radius)),
        }))?;
        answer.add("", findings);
        if missing > 0 {
            answer.add("", [Finding::caution("map-cells-empty").count("n", missing)]);
        }
        answer.tables.push(table(
            "Regimes",
            &counts,
            &[("regime", "", &|c| c.0.to_string().into()), ("cells", "", &|c| c.1.into())],
        ));
        let [x, y] =
            [&plan.x, &plan.y].map(|axis| axis.values().into_iter().step_by(nth).collect::<Vec<_>>());
        if nth == 1 {
            answer.csv("map", &listed(plan, &x, &y, &drawn));
        } else {
            let thinned = Finding::note("map-thinned").count("n", plan.cells() as usize).count("nth", nth);
            answer.add("", [thinned]);
        }
        answer.files.push(("map.npy".to_owned(), array));
        answer.figure("map", figures::regimes([(&plan.x, &x), (&plan.y, &y)], &counts, &drawn)?);
        Ok(answer)
    }
}

/// One row for each cell.
fn listed(plan: &Plan, x: &[f64], y: &[f64], rows: &[Vec<Cell>]) -> Table {
    let cells = rows
        .iter()
        .enumerate()
        .flat_map(|(row, cells)| cells.iter().enumerate().map(move |(column, cell)| (column, row, cell)));
    let regime = |cell: &Cell| cell.regime.map_or_else(String::new, |r| r.to_string());
    let columns: [Shown<(usize, usize, &Cell)>; 4] = [
        (plan.y.key.name(), plan.y.key.unit(), &|c| y[c.1].into()),
        (plan.x.key.name(), plan.x.key.unit(), &|c| x[c.0].into()),
        ("regime", "", &|c| regime(c.2).into()),
        ("spectral radius", "", &|c| c.2.spectral_radius.into()),
    ];
    table("Map", cells, &columns)
}
