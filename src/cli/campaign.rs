//! `vibro run` and `vibro compare`: runs a campaign, and compares its responses with the model.

use super::campaigns::Campaigns;
use super::print::folder_of;
use super::question::{Asked, Question};
use super::study::Shared;
use super::{complain, init, print, stdout};
use crate::analysis::sweep::{PairDraws, modelled};
use crate::analysis::{self, Answer, AnswerCache, CampaignOutcome, Progress, REPORT};
use crate::campaign::{Campaign, FitEntry, Reading};
use crate::error::{Error, Result};
use crate::proposal::Proposal;
use crate::read::{Folder, Occupant, Owner};
use crate::record::kind::whole;
use crate::record::{shown, typed};
use crate::report::Table;
use crate::report::files::Names;
use crate::report::words::{Voice, graded, sentences};
use crate::units::notation::counted;
use indicatif::ProgressBar;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

#[derive(Debug, clap::Args)]
pub struct Run {
    /// campaign.toml, or a folder of recordings; several, each into its own folder in --out
    #[arg(index = 1, value_name = "CAMPAIGN", default_value = ".")]
    campaigns: Vec<PathBuf>,
    /// Folder for results [default: `out` in the campaign, else `results` beside it]
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
    /// Allow files outside the folder of the campaign
    allow_outside: bool,
    /// Recompute everything, even what has not changed since the last run
    again: bool,
    /// Run again whenever a file of the folder changes, until Ctrl+C
    watch: bool,
    /// Run part I of N of several campaigns; `vibro merge` joins the table of all
    #[arg(value_name = "I/N", conflicts_with = "watch")]
    shard: Option<String>,
}

#[derive(Debug, clap::Args)]
pub struct Compare {
    /// campaign.toml with a rig, an excitation and sweeps
    #[arg(index = 1)]
    campaign: PathBuf,
    /// Allow files outside the folder of the campaign
    allow_outside: bool,
    /// Parameters to fit, separated by commas: force, restitution, c1, c2, gap, k1, k2, and m1, m2 with a
    /// prior in [fit] [default: those of [fit] in the campaign]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    fit: Vec<String>,
    /// Draw the parameters N times from [uncertainty] of the campaign: bands that hold 95 % of the draws
    #[arg(value_name = "N", conflicts_with = "fit", value_parser = whole::<u64, 100, 1_000_000>)]
    monte_carlo: Option<u64>,
    /// Compute part I of N of a Monte Carlo into --out; `vibro merge` joins them. Started again, it computes
    /// what is missing
    #[arg(value_name = "I/N")]
    shard: Option<String>,
    /// Folder for the overlay and the fit as SVG, PNG and CSV
    #[arg(value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Compare {
    /// Names of the files in its answer.
    pub const FILES: Names = Names::Numbered(&["overlay", "pairs", "peaks", "fit", "fit_points", "bands"]);
}

/// Opens a campaign file, or the campaign of a folder; an empty campaign for a folder without one.
fn opened(within: &Folder, path: &Path) -> Result<Campaign> {
    let of_folder = path.join(Proposal::FILE);
    if !path.is_dir() {
        analysis::open_in(within, path)
    } else if within.occupant(&of_folder) != Occupant::Nothing {
        analysis::open_in(within, &of_folder)
    } else {
        analysis::parse(within, &of_folder, String::new())
    }
}

/// The campaign itself; if it has no file, the campaign proposed for the recordings of its folder.
fn proposed(campaign: Campaign, kept: &AnswerCache, progress: &dyn Progress) -> Result<Campaign> {
    if campaign.is_file() {
        return Ok(campaign);
    }
    let (folder, within) = (campaign.folder(), campaign.within());
    progress.start("looking at files", 0);
    let proposal = Proposal::of(within, &Reading::default(), None, kept, progress)?;
    progress.aside(&mut || {
        init::print_tables(&proposal);
        complain::line(&format!("to change any of it: vibro init {}", typed(folder)));
    });
    proposal.campaign()
}

/// What a run of a campaign wrote, and where.
pub struct RunResults {
    /// The answer, and the files that were written.
    pub outcome: CampaignOutcome,
    /// Folder of the results.
    pub folder: PathBuf,
    /// Whether the campaign has no records.
    pub empty: bool,
}

impl Run {
    /// A run of this campaign with the default folder for results.
    pub fn of(campaign: PathBuf) -> Run {
        let (campaigns, out, shard) = (vec![campaign], None, None);
        Run { campaigns, out, allow_outside: false, again: false, watch: false, shard }
    }

    /// A run of this campaign into this folder.
    pub fn into_folder(campaign: PathBuf, out: PathBuf, allow_outside: bool, again: bool) -> Run {
        Run { out: Some(out), allow_outside, again, ..Run::of(campaign) }
    }

    /// The campaign; the first of several.
    fn campaign(&self) -> &Path {
        self.campaigns.first().map_or(Path::new("."), PathBuf::as_path)
    }
}

impl super::CommandArgs for Run {
    const VOICE: Voice = Voice::Campaign;

    fn run(&self, json: bool) -> Result<u8> {
        if self.campaigns.len() > 1 || self.shard.is_some() {
            if self.watch {
                return Err(Error::usage("several campaigns to watch", "one"));
            }
            let out = self.out.as_deref();
            let all = Campaigns::of(&self.campaigns, out, self.allow_outside, self.again)?;
            return all.printed(self.shard.as_deref(), json);
        }
        let campaign = self.campaign();
        if !self.watch || !campaign.exists() {
            return self.once(json);
        }
        let folder = if campaign.is_dir() { campaign } else { folder_of(campaign) };
        loop {
            // Stamps are taken before the run: a change during it starts the next one.
            let before = self.stamps(folder);
            // An editor may save an incomplete campaign for a moment: keep watching.
            if let Err(error) = self.once(json) {
                complain::error(&error, Voice::Campaign, json);
            }
            complain::line(&format!("watching {}; Ctrl+C ends", shown(folder)));
            while self.stamps(folder) == before {
                std::thread::sleep(PAUSE);
            }
            // Wait once more, so that a file that is still being written is complete.
            std::thread::sleep(PAUSE);
        }
    }
}

/// Interval between two checks of a watched folder.
const PAUSE: Duration = Duration::from_millis(500);

/// Size and modification time of each watched file.
type Stamps = BTreeMap<PathBuf, Option<(u64, SystemTime)>>;

impl Run {
    /// Access to files, with or without names that lead outside the folder of the campaign.
    fn within(&self) -> Folder {
        Folder::default().allow_outside(self.allow_outside)
    }

    /// Stamps of the recordings of a folder and of the files that its campaign names; results are excluded.
    fn stamps(&self, folder: &Path) -> Stamps {
        let within = self.within().at(folder);
        let named = opened(&within, self.campaign()).and_then(|campaign| analysis::files(&campaign));
        let seen = analysis::recordings(&within).unwrap_or_default();
        let all = seen.files.into_iter().chain(seen.others).chain(named.unwrap_or_default());
        all.map(|path| (path.clone(), within.stamp(&path))).collect()
    }

    /// Runs the campaign once and writes its results.
    ///
    /// # Errors
    /// If the campaign or one of its files cannot be read, or results cannot be written.
    pub fn results(&self, progress: &dyn Progress) -> Result<RunResults> {
        let campaign = opened(&self.within(), self.campaign())?;
        let folder = self.out.clone().unwrap_or_else(|| campaign.out());
        let results = campaign.within().at(&folder);
        let kept = if self.again { AnswerCache::none(&results) } else { AnswerCache::of(&results) };
        let elsewhere = format!("--out {}", typed(print::unused(&folder)));
        let mut output = print::output(results, Owner::Run, elsewhere)?;
        let campaign = proposed(campaign, &kept, progress)?;
        let outcome = analysis::run(&campaign, &kept, &mut output, progress)?;
        output.commit()?;
        Ok(RunResults { outcome, folder, empty: campaign.is_empty() })
    }

    /// Runs the campaign once. Returns the exit code: 1 if no record gives an answer.
    fn once(&self, json: bool) -> Result<u8> {
        let run = |bar: &ProgressBar| self.results(bar);
        let RunResults { outcome, folder, empty } = print::busy(json, "campaign", run)?;
        let CampaignOutcome { answer, files, answered, again } = outcome;
        if again > 0 {
            let kept = counted(again, "answer");
            complain::line(&format!(
                "{kept} of the last run kept: same files, same keys; --again computes anew"
            ));
        }
        if json {
            let warnings = sentences(&answer.findings, Voice::Campaign, false);
            let folder = folder.display().to_string();
            stdout::object(
                json!({ "warnings": warnings, "results": answer.result, "files": files, "folder": folder }),
            )?;
        } else {
            let report = format!("{}, or --json", shown(folder.join(REPORT)));
            complain::warn(&graded(&answer.findings, Voice::Campaign), &report);
            let tables = answer.tables.iter().map(Table::text).collect::<Vec<String>>().join("\n");
            let files = files.len();
            stdout::text(&format!("{tables}\n{files} files in {}; open {REPORT} there\n", shown(&folder)))?;
        }
        Ok(u8::from(!answered && !empty))
    }
}

impl Question for Compare {
    fn names(&self) -> Names {
        Compare::FILES
    }

    fn out(&self) -> Option<&Path> {
        self.out.as_deref()
    }

    fn allow_outside(&self) -> bool {
        self.allow_outside
    }

    fn work(&self) -> &'static str {
        "comparing"
    }

    fn shard(&self) -> Option<&str> {
        self.shard.as_deref()
    }

    fn study(&self, folder: &Folder) -> Result<Option<Shared>> {
        let Some(draws) = self.monte_carlo else { return Ok(None) };
        let draws = PairDraws::of(opened(folder, &self.campaign)?, self.allow_outside, draws)?;
        Ok(Some(Shared::Compare(draws)))
    }

    /// Measured responses against the model.
    fn answer(&self, asked: &Asked<'_>) -> Result<Answer> {
        if let Some(study) = self.study(asked.folder)? {
            return study.whole(asked.progress);
        }
        let campaign = opened(asked.folder, &self.campaign)?;
        let mut campaign = proposed(campaign, &AnswerCache::default(), asked.progress)?;
        if !self.fit.is_empty() {
            let names = self.fit.iter().map(|name| FitEntry::parameter(name.trim()));
            campaign.fit.parameters = names.collect::<Result<_>>()?;
            campaign.fit.usable()?;
        }
        modelled::compared(&campaign, asked.progress)
    }
}
