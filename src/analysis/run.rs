//! Runs a campaign, from its first record to its report.

use super::answer::{Answer, unwritten};
use super::inputs::inputs;
use super::job::Job;
use super::kept::{AnswerCache, digest, packed};
use super::kind::AnalysisKind;
use super::kinds::{KINDS, faults, files as files_of};

use super::own_files::{INPUTS, REPORT, RESULTS};
use super::page;
use super::progress::Progress;
use super::twice::double_use;
use super::unnamed::beside;
use crate::campaign::Campaign;
use crate::error::Result;
use crate::record::Finding;
use crate::report::words::{Voice, put};
use crate::report::{Output, Picture, files};

/// Numbers of tables, figures, long tables and findings in an answer.
fn counts(answer: &Answer) -> [usize; 4] {
    [answer.tables.len(), answer.figures.len(), answer.details.len(), answer.findings.len()]
}

/// Measures the records of a campaign without a report. Where none answers, returns the finding with the
/// reason, if there is one.
///
/// # Errors
/// As [`run`].
pub fn answers(
    campaign: &Campaign,
    kept: &AnswerCache,
    progress: &dyn Progress,
) -> Result<std::result::Result<Answer, Option<Finding>>> {
    let mut job = Job::new(campaign, kept, KINDS, progress);
    for kind in KINDS {
        (kind.run)(&mut job)?;
    }
    if job.answers > 0 {
        return Ok(Ok(job.found));
    }
    let mut findings = job.found.findings.into_iter().map(|(_, finding)| finding);
    Ok(Err(findings.find(|finding| finding.fact("why").is_some())))
}

/// Outcome of a campaign.
#[derive(Debug)]
pub struct CampaignOutcome {
    /// All answers.
    pub answer: Answer,
    /// Names of the files that were written.
    pub files: Vec<String>,
    /// Whether any record was answered.
    pub answered: bool,
    /// Number of answers kept from the last run, because all their inputs are the same.
    pub again: usize,
}

/// Adds the findings on a campaign as a whole.
///
/// # Errors
/// If no record was answered and one of them could not be read.
fn whole(job: &mut Job<'_>) -> Result<()> {
    let campaign = job.campaign;
    job.found.add("", campaign.commented());
    job.found.add("", beside(campaign)?);
    job.found.add("", double_use(campaign)?);
    if job.answers == 0 {
        let of_tables = faults(campaign)?.into_iter().map(|fault| fault.error);
        of_tables.chain(job.failed.take()).next().map_or(Ok(()), Err)?;
    }
    if campaign.is_empty() {
        job.found.add("", [Finding::caution("campaign-without-record")]);
    } else if job.answers == 0 {
        job.found.add("", [Finding::caution("no-record-answers")]);
    }
    Ok(())
}

/// Measures all records of a campaign and writes results and report to `output`.
///
/// # Errors
/// If no record was answered and one of them could not be read; if a file cannot be found or written; if a
/// file that vibro did not write is in the way.
pub fn run(
    campaign: &Campaign,
    kept: &AnswerCache,
    output: &mut Output,
    progress: &dyn Progress,
) -> Result<CampaignOutcome> {
    // A file is an input even where its answer is kept from an earlier run: it is not replaced.
    let files = files_of(campaign)?;
    for path in &files {
        campaign.within().reads(path);
    }
    let has_tables =
        |kind: &&AnalysisKind| campaign.written(kind.section).is_ok_and(|tables| !tables.is_empty());
    let (fixed_names, kinds) =
        ([RESULTS, REPORT, INPUTS, AnswerCache::FILE], KINDS.iter().filter(has_tables).collect::<Vec<_>>());
    output.expect(|name| fixed_names.contains(&name) || kinds.iter().any(|kind| kind.names.has(name)))?;
    let mut job = Job::new(campaign, kept, KINDS, progress);
    // Digests are taken before files are read: a change meanwhile is for the next run.
    let inputs = inputs(campaign, files, kept);
    let version = env!("CARGO_PKG_VERSION");
    job.put("campaign", &job.title.clone())?;
    job.put("version", &version)?;
    let mut parts = Vec::new();
    for kind in KINDS {
        let from = counts(&job.found);
        (kind.run)(&mut job)?;
        let to = counts(&job.found);
        parts.push((kind.title, [0, 1, 2, 3].map(|i| from[i]..to[i])));
    }
    whole(&mut job)?;
    let mut all = std::mem::take(&mut job.found);
    progress.start("drawing figures", all.figures.len());
    let medium = output.medium;
    let pictures = files::figures(output, &all.figures, |figure| {
        let inputs = digest([packed(&(medium as u8, figure)).unwrap_or_default()]);
        let picture = kept.or_make(inputs, &[], || Picture::of(figure, medium));
        progress.step();
        picture
    })?;
    for (name, bytes) in &all.files {
        output.write(name, bytes)?;
    }
    put(&mut all.result, &all.findings, Voice::Campaign);
    output.write(INPUTS, &inputs)?;
    let names: Vec<String> = output.written().chain([RESULTS, REPORT]).map(str::to_owned).collect();
    all.result.insert("files".to_owned(), names.clone().into());
    let json = serde_json::to_string_pretty(&all.result).map_err(unwritten)?;
    output.write(RESULTS, json + "\n")?;
    output.write(REPORT, page::page(&job, version, &inputs, &all, &pictures, &parts).html())?;
    output.write(AnswerCache::FILE, kept.bytes())?;
    Ok(CampaignOutcome { answer: all, files: names, answered: job.answers > 0, again: job.again })
}
