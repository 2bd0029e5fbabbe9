//! `vibro run` over several campaigns: each into its own folder, and a table of all.

use super::campaign::Run;
use super::print::{self, folder_of};
use super::study::Shared;
use crate::analysis::Answer;
use crate::analysis::study::{Cells, Computed, Study};
use crate::analysis::{LEFT_OUT, unwritten};
use crate::error::{Error, Result};
use crate::proposal::Proposal;
use crate::read::Folder;
use crate::record::{Severity, shown};
use crate::report::Cell;
use crate::report::files::{self, Names};
use crate::report::layout::table;
use crate::report::words::{Voice, sentences};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Campaigns to run, each a cell. What lies in their folders may change, so a part begins anew each time; a
/// run keeps the answers whose inputs are the same.
#[derive(Debug, Serialize, Deserialize)]
pub struct Campaigns {
    /// Names of their folders for results.
    names: Vec<String>,
    /// Where they lie: it changes no number.
    place: CampaignPlaces,
    /// Folder of the folders for results.
    #[serde(skip)]
    out: PathBuf,
    #[serde(skip)]
    again: bool,
}

/// Where campaigns lie.
#[derive(Debug, Serialize, Deserialize)]
struct CampaignPlaces {
    paths: Vec<PathBuf>,
    allow_outside: bool,
}

/// What a run of a campaign gave.
#[derive(Debug, Serialize, Deserialize)]
struct Ran {
    campaign: PathBuf,
    folder: String,
    /// Whether any of its records has an answer.
    answered: bool,
    files: usize,
    /// Numbers of findings by severity.
    doubts: usize,
    cautions: usize,
    notes: usize,
    /// Records that were left out, each with the reason.
    left_out: Vec<String>,
    /// Why nothing was written.
    error: Option<String>,
}

impl Campaigns {
    /// Names of its own files; those of the campaigns are in their folders.
    pub const FILES: Names = Names::Named(&["campaigns"]);

    /// The campaigns at these places.
    ///
    /// # Errors
    /// If there is no folder for results, if a campaign is named twice, or if its results would lie among the
    /// recordings of a campaign.
    pub fn of(paths: &[PathBuf], out: Option<&Path>, allow_outside: bool, again: bool) -> Result<Campaigns> {
        let out = out.ok_or_else(|| {
            let found = "campaigns without a folder for their results";
            Error::usage(found, "one for the results of all").hint("--out results")
        })?;
        let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let file = |path: &PathBuf| if path.is_dir() { path.join(Proposal::FILE) } else { path.clone() };
        let folders: Vec<PathBuf> = paths.iter().map(|path| real(folder_of(&file(path)))).collect();
        let files: Vec<PathBuf> = paths
            .iter()
            .zip(&folders)
            .map(|(path, folder)| folder.join(file(path).file_name().unwrap_or_default()))
            .collect();
        if let Some(i) = (0..files.len()).find(|i| files[..*i].contains(&files[*i])) {
            return Err(Error::usage(format!("{} stands twice", shown(&paths[i])), "each campaign once"));
        }
        let title = |folder: &PathBuf| {
            folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
        };
        let titles: Vec<String> = folders.iter().map(title).collect();
        // Folders of one name are told apart by the whole path, not by the order in which they are typed.
        let titles = titles.iter().zip(paths).map(|(title, path)| {
            let is_alone =
                titles.iter().filter(|other| files::slug(other) == files::slug(title)).count() == 1;
            if is_alone { title.clone() } else { path.display().to_string() }
        });
        let titles: Vec<String> = titles.collect();
        let names = files::slugs(titles.iter().map(String::as_str));
        for name in &names {
            let results = out.join(name);
            if folders.contains(&real(&results)) {
                let found = format!("{} is the folder of a campaign", shown(&results));
                return Err(Error::usage(found, "another folder for results").hint("--out results"));
            }
        }
        let place = CampaignPlaces { paths: paths.to_vec(), allow_outside };
        Ok(Campaigns { names, place, out: out.to_owned(), again })
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
        let all = self.cells();
        let ran = |bar: &indicatif::ProgressBar| {
            let rows = Computed::new(&self, 0..all, all, bar);
            rows.map(|(_, cell)| read(&cell?)).collect::<Result<Vec<Ran>>>()
        };
        let rows = print::busy(json, self.what(), ran)?;
        let all_answered = rows.iter().all(|ran| ran.answered);
        Ok(print::answer(answer(&rows)?, output, json)?.max(u8::from(!all_answered)))
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
            ("doubts", "", &|ran| ran.doubts.into()),
            ("cautions", "", &|ran| ran.cautions.into()),
            ("left out", "", &|ran| ran.left_out.len().into()),
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
        self.names.len() as u64
    }

    /// A campaign takes all cores.
    fn parallel(&self) -> bool {
        false
    }

    fn keeps(&self) -> bool {
        false
    }

    fn complaint(&self, cell: &[u8]) -> Option<String> {
        let ran = read(cell).ok().filter(|ran| !ran.answered)?;
        let why = ran.error.unwrap_or_else(|| "no record has an answer".to_owned());
        Some(format!("{}: {why}", shown(ran.campaign)))
    }

    fn cell(&self, number: u64) -> Result<Vec<u8>> {
        let CampaignPlaces { paths, allow_outside } = &self.place;
        let (path, name) = (&paths[number as usize], &self.names[number as usize]);
        let run = Run::into_folder(path.clone(), self.out.join(name), *allow_outside, self.again);
        let ran = Ran {
            campaign: path.clone(),
            folder: name.clone(),
            answered: false,
            files: 0,
            doubts: 0,
            cautions: 0,
            notes: 0,
            left_out: Vec::new(),
            error: None,
        };
        let ran = match run.results(&()) {
            Ok(results) => {
                let outcome = results.outcome;
                let findings = &outcome.answer.findings;
                let count = |severity| findings.iter().filter(|found| found.1.severity() == severity).count();
                let left_out = findings.iter().filter(|found| found.1.code == LEFT_OUT).cloned();
                Ran {
                    answered: outcome.answered,
                    files: outcome.files.len(),
                    doubts: count(Severity::Doubt),
                    cautions: count(Severity::Caution),
                    notes: count(Severity::Note),
                    left_out: sentences(&left_out.collect::<Vec<_>>(), Voice::Campaign, false),
                    ..ran
                }
            }
            Err(error) => Ran { error: Some(error.reason()), ..ran },
        };
        serde_json::to_vec(&ran).map_err(unwritten)
    }

    fn answer(&self, cells: &mut Cells<'_>) -> Result<Answer> {
        answer(&cells.map(|cell| read(&cell?)).collect::<Result<Vec<Ran>>>()?)
    }
}
