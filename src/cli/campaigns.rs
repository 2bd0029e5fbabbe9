//! `vibro run` over several campaigns: each into its own folder, and a table of all.

use super::campaign::Run;
use super::print;
use super::study::Shared;
use crate::analysis::Answer;
use crate::analysis::study::{Cells, Computed, Study};
use crate::analysis::unwritten;
use crate::error::{Error, Result};
use crate::read::{Folder, hexadecimal};
use crate::report::Cell;
use crate::report::files::{self, Names};
use crate::report::layout::table;
use serde::{Deserialize, Serialize};
use serde_json::json;
use sha2::{Digest as _, Sha256};
use std::path::{Path, PathBuf};

/// Campaigns to run, each a cell.
#[derive(Debug, Serialize, Deserialize)]
pub struct Campaigns {
    listed: Vec<Listed>,
    allow_outside: bool,
    /// Folder of the folders for results. It changes nothing in them.
    #[serde(skip)]
    out: PathBuf,
    #[serde(skip)]
    again: bool,
}

/// A campaign, and the name of its folder for results.
#[derive(Debug, Serialize, Deserialize)]
struct Listed {
    path: PathBuf,
    name: String,
    /// Of its file; `None` for a folder without one.
    sha256: Option<String>,
}

/// What a run of a campaign gave.
#[derive(Debug, Serialize, Deserialize)]
struct Ran {
    campaign: PathBuf,
    folder: String,
    /// Whether any of its records has an answer.
    answered: bool,
    files: usize,
    findings: usize,
    /// Why nothing was written.
    error: Option<String>,
}

impl Campaigns {
    /// Names of its own files; those of the campaigns are in their folders.
    pub const FILES: Names = Names::Named(&["campaigns"]);

    /// The campaigns at these places.
    ///
    /// # Errors
    /// If there is no folder for results, or a campaign is named twice.
    pub fn of(paths: &[PathBuf], out: Option<&Path>, allow_outside: bool, again: bool) -> Result<Campaigns> {
        let out = out.ok_or_else(|| {
            Error::usage("several campaigns without a folder", "one for the results of all")
                .hint("--out results")
        })?;
        if let Some(path) =
            paths.iter().enumerate().find_map(|(i, path)| paths[..i].contains(path).then_some(path))
        {
            return Err(Error::usage(format!("{} stands twice", path.display()), "each campaign once"));
        }
        let title = |path: &PathBuf| {
            let of_file = path.extension().is_some_and(|ending| ending == "toml");
            let path = if of_file { path.parent().unwrap_or(path) } else { path };
            let real = path.canonicalize().unwrap_or_else(|_| path.to_owned());
            real.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
        };
        let titles: Vec<String> = paths.iter().map(title).collect();
        let names = files::slugs(titles.iter().map(String::as_str));
        let listed = paths.iter().zip(names).map(|(path, name)| {
            let text = std::fs::read(path).or_else(|_| std::fs::read(path.join("campaign.toml"))).ok();
            let sha256 = text.map(|text| hexadecimal(&Sha256::digest(text).into()));
            Listed { path: path.clone(), name, sha256 }
        });
        Ok(Campaigns { listed: listed.collect(), allow_outside, out: out.to_owned(), again })
    }

    /// Runs all of them, or a part, and prints what came of it. Gives the exit code: 1 if one has no answer.
    ///
    /// # Errors
    /// If the results cannot be written.
    pub fn printed(self, shard: Option<&str>, json: bool) -> Result<u8> {
        if let Some(shard) = shard {
            let out = self.out.clone();
            return Shared::Run(self).printed(shard.parse()?, Some(&out), json);
        }
        let output = print::results(&Folder::default(), Some(&self.out), Campaigns::FILES)?;
        let ran = |bar: &indicatif::ProgressBar| {
            let rows = Computed::new(&self, 0..self.cells(), bar);
            rows.map(|cell| read(&cell?)).collect::<Result<Vec<Ran>>>()
        };
        let rows = print::busy(json, self.what(), ran)?;
        let all = rows.iter().all(|ran| ran.answered);
        print::answer(answer(&rows)?, output, json).map(|code| code.max(u8::from(!all)))
    }
}

/// The bytes of a cell as what they say.
fn read(cell: &[u8]) -> Result<Ran> {
    serde_json::from_slice(cell)
        .map_err(|e| Error::refused(format!("a cell of the part is no campaign: {e}")))
}

/// The table of all campaigns.
fn answer(rows: &[Ran]) -> Result<Answer> {
    let mut answer = Answer::of(&json!({ "campaigns": rows }))?;
    let table = table(
        "Campaigns",
        rows,
        &[
            ("campaign", "", &|ran: &&Ran| ran.campaign.display().to_string().into()),
            ("folder", "", &|ran| ran.folder.as_str().into()),
            ("answered", "", &|ran| ran.answered.into()),
            ("files", "", &|ran| ran.files.into()),
            ("findings", "", &|ran| ran.findings.into()),
            ("error", "", &|ran| ran.error.as_deref().map_or(Cell::Missing, Into::into)),
        ],
    );
    answer.table("campaigns", table);
    Ok(answer)
}

impl Study for Campaigns {
    fn what(&self) -> &'static str {
        "campaigns"
    }

    fn cells(&self) -> u64 {
        self.listed.len() as u64
    }

    /// A campaign takes all cores.
    fn parallel(&self) -> bool {
        false
    }

    fn cell(&self, number: u64) -> Result<Vec<u8>> {
        let Listed { path, name, .. } = &self.listed[number as usize];
        let run = Run::into_folder(path.clone(), self.out.join(name), self.allow_outside, self.again);
        let ran = Ran {
            campaign: path.clone(),
            folder: name.clone(),
            answered: false,
            files: 0,
            findings: 0,
            error: None,
        };
        let ran = match run.results(&()) {
            Ok(results) => {
                let outcome = results.outcome;
                let (files, findings) = (outcome.files.len(), outcome.answer.findings.len());
                Ran { answered: outcome.answered, files, findings, ..ran }
            }
            Err(error) => Ran { error: Some(error.reason()), ..ran },
        };
        serde_json::to_vec(&ran).map_err(unwritten)
    }

    fn answer(&self, cells: &mut Cells<'_>) -> Result<Answer> {
        answer(&cells.map(|cell| read(&cell?)).collect::<Result<Vec<Ran>>>()?)
    }
}
