//! `vibro run` and `vibro compare`: what a campaign asks for.

use super::convert::folder_of;
use super::{complain, init, print};
use crate::analysis::sweep::modelled;
use crate::analysis::{self, INPUTS, JobOptions, REPORT, RESULTS, SUMMARY};
use crate::campaign::{Campaign, FitEntry, Reading};
use crate::error::Result;
use crate::proposal::Proposal;
use crate::report::words::{Voice, graded};
use crate::report::{Output, Table};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

#[derive(Debug, clap::Args)]
pub struct Run {
    /// campaign.toml, or a folder of recordings
    #[arg(index = 1)]
    campaign: PathBuf,
    /// Folder for results [default: `out` in the campaign, else `results` beside it]
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
    /// Allow files outside the folder of the campaign
    allow_outside: bool,
    /// Compute anew, also where nothing has changed since the last run
    again: bool,
    /// Run again whenever a file of the folder changes, until Ctrl+C
    watch: bool,
}

#[derive(Debug, clap::Args)]
pub struct Compare {
    /// campaign.toml with a rig, an excitation and sweeps
    #[arg(index = 1)]
    campaign: PathBuf,
    /// Allow files outside the folder of the campaign
    allow_outside: bool,
    /// Parameters to fit, separated by commas: force, restitution, c1, c2, gap, k1, k2, and m1, m2 with a prior in
    /// [fit] [default: those of [fit] in the campaign]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    fit: Vec<String>,
    /// Folder for the overlay and the fit as SVG, PNG and CSV
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
}

/// A campaign file, that of a folder, or one proposed for what lies there.
fn opened(path: &Path, json: bool) -> Result<Campaign> {
    let of_folder = path.join(Proposal::FILE);
    if !path.is_dir() {
        return analysis::open(path);
    }
    if of_folder.exists() {
        return analysis::open(of_folder);
    }
    let proposal = print::busy(json, "looking at files", |bar| Proposal::of(path, &Reading::default(), bar))?;
    init::tell(&proposal);
    complain::line(&format!("to change any of it: vibro init {}", print::typed(path)));
    proposal.campaign()
}

impl Run {
    /// The campaign of a file, with its own folder for results.
    pub fn of(campaign: PathBuf) -> Run {
        Run { campaign, out: None, allow_outside: false, again: false, watch: false }
    }
}

impl super::Run for Run {
    const VOICE: Voice = Voice::Campaign;

    fn run(&self, json: bool) -> Result<u8> {
        if !self.watch {
            return self.once(json);
        }
        if !self.campaign.exists() {
            return self.once(json);
        }
        let is_folder = self.campaign.is_dir();
        let folder = if is_folder { self.campaign.as_path() } else { folder_of(&self.campaign)? };
        loop {
            // What changes while it runs is for the next run.
            let before = stamps(folder);
            // A campaign that is being written may have a fault for a moment.
            if let Err(error) = self.once(json) {
                complain::error(&error, Voice::Campaign, json);
            }
            complain::line(&format!("watching {}; Ctrl+C ends", folder.display()));
            while stamps(folder) == before {
                std::thread::sleep(PAUSE);
            }
            // What is still being written lands within another pause.
            std::thread::sleep(PAUSE);
        }
    }
}

/// Time between two looks at a folder that is watched.
const PAUSE: Duration = Duration::from_millis(500);

/// Names, sizes and times of the files of a folder and of those in it, but for folders of results.
fn stamps(folder: &Path) -> Vec<(PathBuf, u64, Option<SystemTime>)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for entry in entries.flatten() {
            let path = entry.path();
            let Ok(meta) = std::fs::metadata(&path) else { continue };
            if meta.is_file() {
                found.push((path, meta.len(), meta.modified().ok()));
            } else if meta.is_dir() && !path.join(RESULTS).exists() {
                folders.push(path);
            }
        }
    }
    found.sort();
    found
}

impl Run {
    /// Does all that the campaign asks for. Gives the exit code: 1 where nothing that was asked for could be answered.
    fn once(&self, json: bool) -> Result<u8> {
        let campaign = opened(&self.campaign, json)?;
        let folder = self.out.clone().unwrap_or_else(|| campaign.out());
        let options = JobOptions { allow_outside: self.allow_outside };
        let held =
            if self.again || print::STYLE.get().is_some() { None } else { held(&folder, &campaign, options) };
        if let Some((found, summary)) = held {
            complain::line("nothing has changed since the last run; --again computes anew");
            let code = found["findings"]
                .as_array()
                .is_some_and(|f| f.iter().any(|f| f["code"] == "no-record-answers"));
            if json {
                of_results(&found, &folder)?;
            } else {
                // Findings stand before the first empty line.
                let (said, tables) = summary
                    .split_once("\n\n")
                    .filter(|_| !summary.starts_with('\n'))
                    .unwrap_or(("", summary.trim_start()));
                said.lines().for_each(complain::line);
                tables_of(tables, found["files"].as_array().map_or(0, Vec::len), &folder)?;
            }
            return Ok(u8::from(code));
        }
        let mut output = print::output(&folder)?;
        let (found, answered) =
            print::busy(json, "campaign", |bar| analysis::run(&campaign, options, &mut output, bar))?;
        let files = output.commit()?;
        if json {
            of_results(&found.result.into(), &folder)?;
        } else {
            complain::warn(&graded(&found.findings, Voice::Campaign));
            let tables = found.tables.iter().map(Table::text).collect::<Vec<String>>().join("\n");
            tables_of(&tables, files.len(), &folder)?;
        }
        Ok(u8::from(!answered && !campaign.is_empty()))
    }
}

/// Prints the tables of a campaign.
fn tables_of(tables: &str, files: usize, folder: &Path) -> Result<()> {
    print::text(&format!("{tables}\n{files} files in {}; open {REPORT} there\n", folder.display()))
}

/// Prints the results of a campaign as one object.
fn of_results(results: &Value, folder: &Path) -> Result<()> {
    let (warnings, files) = (&results["warnings"], &results["files"]);
    let folder = folder.display().to_string();
    print::object(json!({ "warnings": warnings, "results": results, "files": files, "folder": folder }))
}

/// The results in a folder and their summary, where they are of the same campaign, recordings and program, and complete.
fn held(folder: &Path, campaign: &Campaign, options: JobOptions) -> Option<(Value, String)> {
    let made = |path: &Path| std::fs::metadata(path).and_then(|meta| meta.modified()).ok();
    let text = |name| std::fs::read_to_string(folder.join(name)).ok();
    let same = text(INPUTS)? == analysis::inputs(campaign, options.allow_outside).ok()?;
    let results: Value = serde_json::from_str(&text(RESULTS).filter(|_| same)?).ok()?;
    // The page is written last: what is younger was changed by somebody else.
    let page = made(&folder.join(REPORT))?;
    let whole =
        |name: &Value| name.as_str().and_then(|name| made(&folder.join(name))).is_some_and(|at| at <= page);
    let complete =
        results["files"].as_array()?.iter().all(whole) && !folder.join(Output::INCOMPLETE).exists();
    complete.then_some((results, text(SUMMARY)?))
}

impl super::Run for Compare {
    const VOICE: Voice = Voice::Campaign;

    /// Prints measured responses over the model.
    fn run(&self, json: bool) -> Result<u8> {
        let mut campaign = opened(&self.campaign, json)?;
        if !self.fit.is_empty() {
            let names = self.fit.iter().map(|name| FitEntry::parameter(name.trim()));
            campaign.fit.parameters = names.collect::<Result<_>>()?;
            campaign.fit.usable()?;
        }
        let options = JobOptions { allow_outside: self.allow_outside };
        let answer = print::busy(json, "comparing", |bar| modelled::compared(&campaign, options, bar))?;
        print::answer(answer, self.out.as_deref(), json)
    }
}
