//! Regime and stability over two parameters: `vibro model map`.

use super::{Driven, SceneKeys, figures};
use crate::analysis::{Answer, Progress};
use crate::error::{Error, Result};
use crate::model::map::{Axis, Cell, Plan};
use crate::record::Finding;
use crate::report::layout::table;
use serde_json::json;
use std::fs::{self, File};
use std::io::Write;
use std::path::Path;

/// What is asked.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// The scene.
    #[cfg_attr(feature = "cli", command(flatten))]
    pub scene: SceneKeys,
    /// Parameter across: one of m1 m2 k1 k2 c1 c2 gap restitution frequency force impulse width, e.g. frequency:3:14:120
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME:LOW:HIGH:N"))]
    pub x: String,
    /// Parameter upwards, as x
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME:LOW:HIGH:N"))]
    pub y: String,
    /// Excitation frequency in Hz, where it is not varied
    #[cfg_attr(feature = "cli", arg(long, value_name = "HZ", allow_negative_numbers = true))]
    pub frequency: Option<f64>,
    /// Cycles a cell, from rest; a cell that has settled ends before
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = 200))]
    pub cycles: u32,
}

/// Rows as they come.
const PART: &str = "map.part.csv";

impl Keys {
    /// The map. Where a folder is named, rows stand in it as they come, and a map that was cut short there is taken up again.
    ///
    /// # Errors
    /// If the scene or a key cannot be, nothing drives the rig, or the folder holds a part of another map or cannot be written.
    pub fn answer(&self, folder: Option<&Path>, progress: &dyn Progress) -> Result<Answer> {
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
        let part = folder.map(|folder| folder.join(PART));
        let (mut rows, mut store) = match &part {
            Some(part) => {
                let (rows, file) = taken_up(part, &plan)?;
                (rows, Some((part, file)))
            }
            None => (Vec::new(), None),
        };
        let kept = rows.len();
        progress.start("map", plan.y.n - kept);
        plan.run(&mut rows, |row, cells| {
            progress.step();
            store.as_mut().map_or(Ok(()), |(part, file)| {
                let lines = plan.lines(row, cells);
                file.write_all(lines.as_bytes()).map_err(|e| Error::io("write", part, e))
            })
        })?;
        if let Some((part, file)) = store {
            drop(file);
            fs::remove_file(part).map_err(|e| Error::io("remove", part, e))?;
        }
        let grid = |of: &dyn Fn(&Cell) -> serde_json::Value| -> Vec<Vec<serde_json::Value>> {
            rows.iter().map(|row| row.iter().map(of).collect()).collect()
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
        if kept > 0 {
            answer.tell("", [Finding::caution("map-rows-kept").count("done", kept).count("rows", plan.y.n)]);
        }
        let missing = rows.iter().flatten().filter(|c| c.regime.is_none()).count();
        if missing > 0 {
            answer.tell("", [Finding::caution("map-cells-empty").count("n", missing)]);
        }
        let counts = figures::counted(rows.iter().flatten());
        answer.tables.push(table(
            "Regimes",
            &counts,
            &[("regime", "", &|c| c.0.to_string().into()), ("cells", "", &|c| c.1.into())],
        ));
        answer.files.push(("map.csv".to_owned(), text(&plan, &rows)?.into_bytes()));
        answer.figure("map", figures::regimes(&plan, &rows)?);
        Ok(answer)
    }
}

/// The rows that stand.
fn text(plan: &Plan, rows: &[Vec<Cell>]) -> Result<String> {
    let lines = rows.iter().enumerate().map(|(row, cells)| plan.lines(row, cells));
    Ok(plan.header()? + &lines.collect::<String>())
}

/// What an earlier run has left of this map, in a file that can grow.
fn taken_up(part: &Path, plan: &Plan) -> Result<(Vec<Vec<Cell>>, File)> {
    if let Some(folder) = part.parent() {
        fs::create_dir_all(folder).map_err(|e| Error::io("create", folder, e))?;
    }
    let rows = match fs::read_to_string(part) {
        Ok(earlier) if !earlier.is_empty() => plan.rows(&earlier)?,
        _ => Vec::new(),
    };
    let whole = text(plan, &rows)?;
    let mut file = File::create(part).map_err(|e| Error::io("write", part, e))?;
    file.write_all(whole.as_bytes()).map_err(|e| Error::io("write", part, e))?;
    Ok((rows, file))
}
