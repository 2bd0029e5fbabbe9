//! Regime and stability over two parameters: `vibro model map`.

use super::{Driven, SceneKeys, figures};
use crate::analysis::{Answer, Progress};
use crate::error::Result;
use crate::model::map::{Axis, Cell, Plan, Rows};
use crate::record::Finding;
use crate::report::layout::table;
use serde_json::json;

/// What is asked.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// The scene.
    #[cfg_attr(feature = "cli", command(flatten))]
    pub scene: SceneKeys,
    /// Parameter across: one of m1 m2 k1 k2 c1 c2 gap restitution frequency force impulse width, e.g. frequency:3:14:120
    pub x: String,
    /// Parameter upwards, as x
    pub y: String,
    /// Excitation frequency in Hz, where it is not varied
    pub frequency: Option<f64>,
    /// Cycles of each cell, from rest; a settled cell ends earlier
    #[cfg_attr(feature = "cli", arg(default_value_t = 200))]
    pub cycles: u32,
}

impl Keys {
    /// The map.
    ///
    /// # Errors
    /// If the scene or a key cannot be, or nothing drives the rig.
    pub fn answer(&self, progress: &dyn Progress) -> Result<Answer> {
        let (x, y): (Axis, Axis) = (self.x.parse()?, self.y.parse()?);
        // What is varied needs not be given: the excitation then begins at its low end.
        let or_varied = |given: Option<f64>, name: &str| {
            given.or_else(|| [&x, &y].into_iter().find(|a| a.key.label().0 == name).map(|a| a.low))
        };
        let scene = SceneKeys {
            force: or_varied(self.scene.force, "force"),
            impulse: or_varied(self.scene.impulse, "impulse"),
            width: or_varied(self.scene.width, "width"),
            ..self.scene.clone()
        };
        let Driven { scene, excitation, finding } = scene.driven(or_varied(self.frequency, "frequency"))?;
        let plan = Plan { rig: scene.rig, excitation, x, y, cycles: self.cycles };
        plan.check()?;
        let mut rows = Rows::none(&plan);
        progress.start("map", plan.y.n);
        plan.run(&mut rows, |_, _| {
            progress.step();
            Ok(())
        })?;
        let all: Vec<&[Cell]> = (0..plan.y.n).filter_map(|row| rows.get(row)).collect();
        let grid = |of: &dyn Fn(&Cell) -> serde_json::Value| -> Vec<Vec<serde_json::Value>> {
            all.iter().map(|row| row.iter().map(of).collect()).collect()
        };
        let mut answer = Answer::of(&json!({
            "scene": scene,
            "x_name": x.key.label().0,
            "y_name": y.key.label().0,
            "x": x.values(),
            "y": y.values(),
            "regime": grid(&|c| json!(c.regime)),
            "spectral_radius": grid(&|c| json!(c.spectral_radius)),
        }))?;
        answer.tell("", finding);
        let missing = all.iter().flat_map(|row| *row).filter(|c| c.regime.is_none()).count();
        if missing > 0 {
            answer.tell("", [Finding::caution("map-cells-empty").count("n", missing)]);
        }
        let counts = figures::counted(all.iter().flat_map(|row| *row));
        answer.tables.push(table(
            "Regimes",
            &counts,
            &[("regime", "", &|c| c.0.to_string().into()), ("cells", "", &|c| c.1.into())],
        ));
        let lines = (0..plan.y.n).filter_map(|row| Some(Rows::lines(&plan, row, rows.get(row)?)));
        let text = Rows::header(&plan)? + &lines.collect::<String>();
        answer.files.push(("map.csv".to_owned(), text.into_bytes()));
        answer.figure("map", figures::regimes(&plan, &rows)?);
        Ok(answer)
    }
}
