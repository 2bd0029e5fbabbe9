//! `vibro run` and `vibro compare`: what a campaign asks for.

use super::convert::folder_of;
use super::{complain, init, print};
use crate::analysis::sweep::modelled;
use crate::analysis::{self, JobOptions, Kept, REPORT, RESULTS, Ran};
use crate::campaign::{Campaign, FitEntry, Reading};
use crate::error::Result;
use crate::proposal::Proposal;
use crate::report::Table;
use crate::report::words::{Voice, graded};
use crate::units::notation::counted;
use indicatif::ProgressBar;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

#[derive(Debug, clap::Args)]
pub struct Run {
    /// campaign.toml, or a folder of recordings
    #[arg(index = 1, default_value = ".")]
    campaign: PathBuf,
    /// Folder for results [default: `out` in the campaign, else `results` beside it]
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
    /// Allow files outside the folder of the campaign
    allow_outside: bool,
    /// Recompute everything, even what has not changed since the last run
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

/// A campaign file, or that of a folder; an empty one where the folder has none.
fn opened(path: &Path) -> Result<Campaign> {
    let of_folder = path.join(Proposal::FILE);
    if !path.is_dir() {
        analysis::open(path)
    } else if of_folder.exists() {
        analysis::open(of_folder)
    } else {
        analysis::parse(&of_folder, String::new())
    }
}

/// The campaign; one proposed for what lies in its folder where it has no file.
fn proposed(campaign: Campaign, kept: &Kept, json: bool) -> Result<Campaign> {
    if campaign.path().exists() {
        return Ok(campaign);
    }
    let folder = campaign.folder();
    let look = |bar: &ProgressBar| Proposal::of(folder, &Reading::default(), None, kept, bar);
    let proposal = print::busy(json, "looking at files", look)?;
    init::tell(&proposal);
    complain::line(&format!("to change any of it: vibro init {}", print::typed(folder)));
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
        let campaign = opened(&self.campaign)?;
        let folder = self.out.clone().unwrap_or_else(|| campaign.out());
        let kept = if self.again { Kept::default() } else { Kept::of(&folder) };
        let campaign = proposed(campaign, &kept, json)?;
        let options = JobOptions { allow_outside: self.allow_outside, kept: Some(&kept) };
        let mut output = print::output(&folder)?;
        let run = |bar: &ProgressBar| analysis::run(&campaign, options, &mut output, bar);
        let Ran { answer, answered, again } = print::busy(json, "campaign", run)?;
        output.commit()?;
        if again > 0 {
            let kept = counted(again, "answer");
            complain::line(&format!(
                "{kept} of the last run kept: same files, same keys; --again computes anew"
            ));
        }
        let files = answer.result["files"].as_array().map_or(0, Vec::len);
        if json {
            of_results(&answer.result.into(), &folder)?;
        } else {
            complain::warn(&graded(&answer.findings, Voice::Campaign));
            let tables = answer.tables.iter().map(Table::text).collect::<Vec<String>>().join("\n");
            print::text(&format!("{tables}\n{files} files in {}; open {REPORT} there\n", folder.display()))?;
        }
        Ok(u8::from(!answered && !campaign.is_empty()))
    }
}

/// Prints the results of a campaign as one object.
fn of_results(results: &Value, folder: &Path) -> Result<()> {
    let (warnings, files) = (&results["warnings"], &results["files"]);
    let folder = folder.display().to_string();
    print::object(json!({ "warnings": warnings, "results": results, "files": files, "folder": folder }))
}

impl super::Run for Compare {
    const VOICE: Voice = Voice::Campaign;

    /// Prints measured responses over the model.
    fn run(&self, json: bool) -> Result<u8> {
        let mut campaign = proposed(opened(&self.campaign)?, &Kept::default(), json)?;
        if !self.fit.is_empty() {
            let names = self.fit.iter().map(|name| FitEntry::parameter(name.trim()));
            campaign.fit.parameters = names.collect::<Result<_>>()?;
            campaign.fit.usable()?;
        }
        let options = JobOptions { allow_outside: self.allow_outside, ..JobOptions::default() };
        let answer = print::busy(json, "comparing", |bar| modelled::compared(&campaign, options, bar))?;
        print::answer(answer, self.out.as_deref(), json)
    }
}
