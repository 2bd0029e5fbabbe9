//! The benchmark as cells that are measured one by one: scenes, and the borders of a family.

use super::{FAMILIES, answer};
use crate::analysis::Answer;
use crate::analysis::answer::unwritten;
use crate::analysis::study::{Cells, Study};
use crate::error::{Error, Result};
use crate::precision::{BenchmarkScene, FailureMap, Family, Measurement, Results};
use crate::report::files::Names;
use serde::{Deserialize, Serialize};

/// What is to be measured.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Benchmark {
    /// Only the methods of this family.
    pub family: Option<Family>,
    /// Fewer settings, repeats, records and cycles.
    pub quick: bool,
    /// The borders, too.
    pub failures: bool,
}

/// A cell that is still to be measured.
enum Task {
    Scene(Measurement),
    Borders(Family),
}

/// A cell that was measured.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Measured {
    Scene(BenchmarkScene),
    Borders(FailureMap),
}

impl Benchmark {
    /// Names of written files: one chart a scene, one failure map a method.
    pub const FILES: Names = Names::Named(&["precision", "failures"]);

    /// All cells, in the order of their numbers.
    fn tasks(&self) -> Vec<Task> {
        let families = FAMILIES.into_iter().filter(|family| self.family.is_none_or(|only| only == *family));
        let tasks = families.flat_map(|family| {
            let scenes = Results::scenes_of(family, self.quick).into_iter().map(Task::Scene);
            scenes.chain(self.failures.then_some(Task::Borders(family)))
        });
        tasks.collect()
    }

    /// The results of all cells.
    ///
    /// # Errors
    /// Those of the cells; if their bytes are not those of a benchmark.
    pub fn results(cells: &mut Cells<'_>) -> Result<Results> {
        let mut results = Results::default();
        for cell in cells {
            let strange = |e| Error::refused(format!("a cell of the part is no result of a scene: {e}"));
            match serde_json::from_slice(&cell?).map_err(strange)? {
                Measured::Scene(scene) => results.push(scene),
                Measured::Borders(map) => results.failures.cells.extend(map.cells),
            }
        }
        Ok(results)
    }
}

impl Study for Benchmark {
    fn what(&self) -> &'static str {
        "scenes"
    }

    fn cells(&self) -> u64 {
        self.tasks().len() as u64
    }

    /// Times are measured with nothing beside.
    fn parallel(&self) -> bool {
        false
    }

    fn cell(&self, number: u64) -> Result<Vec<u8>> {
        let task = self.tasks().into_iter().nth(number as usize);
        let measured =
            match task.ok_or_else(|| Error::refused(format!("the benchmark has no cell {number}")))? {
                Task::Scene(measure) => Measured::Scene(measure()?),
                Task::Borders(family) => Measured::Borders(Results::failures_of(family, self.quick)?),
            };
        serde_json::to_vec(&measured).map_err(unwritten)
    }

    fn answer(&self, cells: &mut Cells<'_>) -> Result<Answer> {
        answer(&Benchmark::results(cells)?, &[])
    }
}
