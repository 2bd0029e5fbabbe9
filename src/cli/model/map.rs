//! `vibro model map`: regime and stability over two parameters.

use crate::analysis::Progress;
use crate::analysis::model::figures;
use crate::cli::{args, complain, print, progress};
use crate::error::{Error, Result};
use crate::model::map::{Axis, Cell, Plan, Rows};
use crate::model::{Excitation, Regime, Scene};
use crate::report::{Output, Table, files};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

#[derive(Serialize)]
struct Answer<'a> {
    scene: &'a Scene,
    x_name: &'static str,
    y_name: &'static str,
    x: Vec<f64>,
    y: Vec<f64>,
    regime: Vec<Vec<Option<Regime>>>,
    spectral_radius: Vec<Vec<Option<f64>>>,
    warnings: &'a [String],
    files: Vec<String>,
}

/// Rows as they come.
const PART: &str = "map.part.csv";
/// All rows.
const WHOLE: &str = "map.csv";

pub fn run(typed: &args::ModelMap, json: bool) -> Result<()> {
    let (x, y): (Axis, Axis) = (typed.x.parse()?, typed.y.parse()?);
    let varied = |name: &str| [&x, &y].into_iter().find(|a| a.key.label().0 == name).map(|a| a.low);
    // What is varied needs not be given: the excitation then begins at its low end.
    let mut scene = args::Scene { rig: typed.scene.rig.clone(), set: typed.scene.set.clone(), ..typed.scene };
    for (given, name) in
        [(&mut scene.force, "force"), (&mut scene.impulse, "impulse"), (&mut scene.width, "width")]
    {
        *given = given.or_else(|| varied(name));
    }
    let frequency = typed.frequency.or_else(|| varied("frequency"));
    let (scene, mut warnings) = super::scene(&scene, frequency)?;
    let excitation: Excitation = super::excitation(&scene)?.clone();
    let plan = Plan { rig: scene.rig, excitation, x, y, cycles: typed.cycles };
    plan.check()?;
    let mut store = typed.out.as_deref().map(|folder| Store::open(folder, &plan)).transpose()?;
    let mut rows = store.as_ref().map_or_else(|| Rows::none(&plan), |s| s.rows.clone());
    if rows.done() > 0 {
        warnings.push(format!("{} of {} rows were there already and are kept.", rows.done(), plan.y.n));
    }
    let bar = progress::bar(json);
    bar.start("map", plan.y.n - rows.done());
    plan.run(&mut rows, |row, cells| {
        bar.step();
        store.as_mut().map_or(Ok(()), |s| s.push(&plan, row, cells))
    })?;
    bar.done();
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let whole = (0..plan.y.n).filter_map(|row| Some(Rows::lines(&plan, row, rows.get(row)?)));
        output.write(WHOLE, Rows::header(&plan)? + &whole.collect::<String>())?;
        let part = folder.join(PART);
        drop(store);
        if part.exists() {
            fs::remove_file(&part).map_err(|e| Error::io("remove", &part, e))?;
        }
        files::figures(&mut output, &[("map".to_owned(), figures::regimes(&plan, &rows)?)], &|| ())?;
        written = output.written().to_vec();
    }
    let missing = cells(&plan, &rows).filter(|c| c.regime.is_none()).count();
    if missing > 0 {
        warnings.push(format!("{missing} cells have no answer: the rig cannot be simulated there."));
    }
    if json {
        let grid = |row: usize| rows.get(row).unwrap_or_default().iter();
        return print::json(&Answer {
            scene: &scene,
            x_name: plan.x.key.label().0,
            y_name: plan.y.key.label().0,
            x: plan.x.values(),
            y: plan.y.values(),
            regime: (0..plan.y.n).map(|row| grid(row).map(|c| c.regime).collect()).collect(),
            spectral_radius: (0..plan.y.n)
                .map(|row| grid(row).map(|c| c.spectral_radius).collect())
                .collect(),
            warnings: &warnings,
            files: written,
        });
    }
    complain::warn(&warnings);
    let mut text = counted(&plan, &rows).text();
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}

fn cells<'a>(plan: &Plan, rows: &'a Rows) -> impl Iterator<Item = &'a Cell> {
    (0..plan.y.n).filter_map(|row| rows.get(row)).flatten()
}

/// How many cells have each regime, the most frequent first.
fn counted(plan: &Plan, rows: &Rows) -> Table {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for regime in cells(plan, rows).filter_map(|c| c.regime) {
        *counts.entry(regime.to_string()).or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
    let table = Table::new("Regimes").column("regime", "").column("cells", "");
    counts.into_iter().fold(table, |table, (name, n)| table.row([name.into(), n.into()]))
}

/// The file of rows that grows with the map.
struct Store {
    path: PathBuf,
    file: File,
    rows: Rows,
}

impl Store {
    /// Takes up what an earlier run has left in `folder`, or begins.
    fn open(folder: &Path, plan: &Plan) -> Result<Store> {
        fs::create_dir_all(folder).map_err(|e| Error::io("create", folder, e))?;
        let path = folder.join(PART);
        let earlier = |path: &Path| match fs::read_to_string(path) {
            Ok(text) => Ok(Some(text)),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(e) => Err(Error::io("read", path, e)),
        };
        let rows = match earlier(&path)? {
            // What was cut short is kept only if it belongs to this map.
            Some(text) if !text.is_empty() => Rows::read(plan, &text)?,
            // A whole map of another plan is replaced, as any result.
            _ => earlier(&folder.join(WHOLE))?
                .and_then(|text| Rows::read(plan, &text).ok())
                .unwrap_or_else(|| Rows::none(plan)),
        };
        let kept = (0..plan.y.n).filter_map(|row| Some(Rows::lines(plan, row, rows.get(row)?)));
        let text = Rows::header(plan)? + &kept.collect::<String>();
        let mut file = File::create(&path).map_err(|e| Error::io("write", &path, e))?;
        file.write_all(text.as_bytes()).map_err(|e| Error::io("write", &path, e))?;
        Ok(Store { path, file, rows })
    }

    fn push(&mut self, plan: &Plan, row: usize, cells: &[Cell]) -> Result<()> {
        let text = Rows::lines(plan, row, cells);
        self.file.write_all(text.as_bytes()).map_err(|e| Error::io("write", &self.path, e))
    }
}
