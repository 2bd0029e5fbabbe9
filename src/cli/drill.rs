//! `vibro drill`: speed, impacts and the average turn of a hammer drill.

use super::{args, print};
use crate::analysis::drill::{Keys, cycles};
use crate::error::{Error, Result};
use crate::measure::drill::Cycle;
use crate::report::{Growing, Output};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Drill {
    /// File with a velocity and a reference channel
    file: PathBuf,
    #[command(flatten)]
    keys: Keys,
    /// Write every impact with the speed of its turn, and beside it the velocity of every turn over the phase
    #[arg(long, value_name = "CSV")]
    each_cycle: Option<PathBuf>,
    #[command(flatten)]
    record: args::Record,
}

pub fn run(typed: &Drill, json: bool) -> Result<()> {
    let mut cycles = typed.each_cycle.as_deref().map(Cycles::new).transpose()?;
    let mut each = |cycle: &Cycle<'_>| cycles.as_mut().map_or(Ok(()), |c| c.push(cycle));
    let answer = typed.record.measured(&typed.file, json, |source| typed.keys.measure(source, &mut each))?;
    let mut written = Vec::new();
    if let Some((path, cycles)) = typed.each_cycle.as_ref().zip(cycles) {
        let (folder, name) = apart(path)?;
        if let Some((_, impacts)) = answer.files.iter().find(|(name, _)| name == "impacts.csv") {
            Output::new(folder)?.write(&name, impacts)?;
        }
        written.push(path.display().to_string());
        written.extend(cycles.finish()?);
    }
    let note = "each impact and the average turn: --json, or files with --out";
    print::answer(answer, typed.record.out.as_deref(), &written, note, json)
}

/// Folder and name of a file.
fn apart(path: &Path) -> Result<(&Path, String)> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned());
    Ok((folder, name.ok_or_else(|| Error::usage("--each-cycle without a file name", "a file, NAME.csv"))?))
}

/// The table of turns over the phase, written as they come, beside the table of impacts.
struct Cycles {
    output: Output,
    /// Made with the first turn, so that a record that allows no answer leaves nothing.
    file: Option<Growing>,
    name: String,
}

impl Cycles {
    fn new(path: &Path) -> Result<Cycles> {
        let (beside, name) = apart(path)?;
        let stem =
            Path::new(&name).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        Ok(Cycles { output: Output::new(beside)?, file: None, name: format!("{stem}_velocity.csv") })
    }

    fn push(&mut self, cycle: &Cycle<'_>) -> Result<()> {
        let mut file = if let Some(file) = self.file.take() {
            file
        } else {
            let mut file = self.output.growing(&self.name)?;
            file.push(&cycles::head(cycle.velocity.len()))?;
            file
        };
        file.push(&cycles::row(cycle))?;
        self.file = Some(file);
        Ok(())
    }

    /// Path of the file; `None` where there was no turn.
    fn finish(mut self) -> Result<Option<String>> {
        let Some(file) = self.file else { return Ok(None) };
        let path = self.output.finish(file)?;
        Ok(Some(path.display().to_string()))
    }
}
