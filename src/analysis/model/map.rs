//! Regime and stability over two parameters: `vibro model map`.

use super::{Driven, SceneKeys, figures};
use crate::analysis::answer::Answer;
use crate::analysis::progress::Progress;
use crate::error::Result;
use crate::model::map::{Cell, MapAxis, Plan};
use crate::record::Finding;
use crate::report::files::Names;
use crate::report::layout::{Shown, table};
use serde_json::json;

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
    /// If the scene or a key is impossible, or nothing drives the rig.
    pub fn answer(&self, progress: &dyn Progress) -> Result<Answer> {
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
        progress.start("map", plan.y.n);
        let rows = plan.run(|| progress.step())?;
        let grid = |of: &dyn Fn(&Cell) -> serde_json::Value| -> Vec<Vec<serde_json::Value>> {
            rows.iter().map(|row| row.iter().map(of).collect()).collect()
        };
        let mut answer = Answer::of(&json!({
            "scene": scene,
            "x_name": x.key.name(),
            "y_name": y.key.name(),
            "x": x.values(),
            "y": y.values(),
            "regime": grid(&|c| json!(c.regime)),
            "spectral_radius": grid(&|c| json!(c.spectral_radius)),
        }))?;
        answer.add("", findings);
        let missing = rows.iter().flatten().filter(|c| c.regime.is_none()).count();
        if missing > 0 {
            answer.add("", [Finding::caution("map-cells-empty").count("n", missing)]);
        }
        let counts = figures::counted(rows.iter().flatten());
        answer.tables.push(table(
            "Regimes",
            &counts,
            &[("regime", "", &|c| c.0.to_string().into()), ("cells", "", &|c| c.1.into())],
        ));
        let cells = rows
            .iter()
            .enumerate()
            .flat_map(|(row, cells)| cells.iter().enumerate().map(move |(column, cell)| (column, row, cell)));
        let regime = |cell: &Cell| cell.regime.map_or_else(String::new, |r| r.to_string());
        let columns: [Shown<(usize, usize, &Cell)>; 4] = [
            (y.key.name(), y.key.unit(), &|c| y.value(c.1).into()),
            (x.key.name(), x.key.unit(), &|c| x.value(c.0).into()),
            ("regime", "", &|c| regime(c.2).into()),
            ("spectral radius", "", &|c| c.2.spectral_radius.into()),
        ];
        answer.csv("map", &table("Map", cells, &columns));
        answer.figure("map", figures::regimes(&plan, &rows)?);
        Ok(answer)
    }
}
