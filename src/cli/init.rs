//! `vibro init` and `vibro check`: a campaign for a folder, and whether it can run.

use super::print::folder_of;
use super::{complain, print, stdout};
use crate::analysis;
use crate::analysis::AnswerCache;
use crate::campaign::Reading;
use crate::error::{Error, Result};
use crate::proposal::{KeyStatus, Proposal, Table, TableKey};
use crate::read::{Folder, Occupant, Owner};
use crate::record::{shown, typed};
use crate::report::words::{Voice, graded, put};
use crate::units::notation::counted;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Init {
    /// Folder of recordings
    #[arg(index = 1, default_value = ".")]
    folder: PathBuf,
    /// Take files outside the folder, too, where links lead to them
    allow_outside: bool,
    #[command(flatten)]
    reading: Reading,
}

#[derive(Debug, clap::Args)]
pub struct Check {
    /// campaign.toml, or its folder
    #[arg(index = 1, default_value = ".")]
    campaign: PathBuf,
    /// Allow files outside the folder of the campaign
    allow_outside: bool,
}

impl super::CommandArgs for Init {
    /// Writes the campaign. To an existing one it appends tables for recordings that have none.
    fn run(&self, json: bool) -> Result<u8> {
        let within = Folder::from(self.folder.as_path()).allow_outside(self.allow_outside);
        let path = within.path(Path::new(Proposal::FILE))?;
        // A symbolic link is followed, so that its target is written and the link is kept.
        let linked = within.occupant(&path) == Occupant::Special;
        let path = if linked { path.canonicalize().unwrap_or(path) } else { path };
        let name = path.file_name().map_or_else(String::new, shown);
        let known =
            path.exists().then(|| analysis::open_in(&within, &path).map_err(|e| foreign(&within, &path, e)));
        let known = known.transpose()?;
        let proposal = print::busy(json, "looking at files", |bar| {
            Proposal::of(&within, &self.reading, known.as_ref(), &AnswerCache::default(), bar)
        })?;
        let text = match &known {
            Some(known) => {
                let end = if known.text().ends_with('\n') { "" } else { "\n" };
                let text = format!("{end}{}", proposal.tables());
                // Check that the extended file parses before it is written.
                analysis::parse(&within, &path, known.text().to_owned() + &text)?;
                text
            }
            None => proposal.toml(),
        };
        let nothing = text.trim().is_empty();
        let again = "move that file to another folder, and run the same command again".to_owned();
        let mut output = print::output(within.at(folder_of(&path)), Owner::Person, again)?;
        match &known {
            Some(_) if nothing => {}
            Some(known) => output.extend(&name, known.text(), &text)?,
            None => output.write(&name, &text)?,
        }
        output.commit()?;
        if json {
            stdout::object(json!({
                "written": path.display().to_string(),
                "found": keys(&proposal, |known| known == KeyStatus::Found),
                "guessed": keys(&proposal, |known| matches!(known, KeyStatus::Guessed(_))),
                "missing": keys(&proposal, |known| matches!(known, KeyStatus::Open(_) | KeyStatus::Missing(_))),
                "left": proposal.left,
                "refused": refused(&proposal),
                "warnings": [],
                "findings": [],
            }))?;
        } else {
            print_tables(&proposal);
            for (file, why) in &proposal.left {
                complain::line(&format!("not used: {file}: {why}"));
            }
            let done = match (&known, nothing) {
                (None, _) => "wrote",
                (Some(_), false) => "added to the end of",
                (Some(_), true) => "every recording of the folder stands in",
            };
            stdout::text(&format!("{done} {}\nnext: vibro run {}\n", shown(&path), typed(&path)))?;
        }
        Ok(0)
    }
}

/// The error of an unreadable campaign. Where the file has no table of a campaign, another program wrote it,
/// and the advice is to move it.
fn foreign(within: &Folder, path: &Path, error: Error) -> Error {
    let bytes = within.read(path).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes);
    if analysis::sections().any(|section| text.contains(section)) {
        return error;
    }
    let renamed = path.with_extension("other.toml");
    let error = error.aside("this file is no campaign of vibro");
    error.hint(format!("mv {} {}", typed(path), typed(&renamed)))
}

/// The keys of all tables with this status.
fn keys(proposal: &Proposal, of: impl Fn(KeyStatus) -> bool) -> Vec<Value> {
    let of = &of;
    let rows = |table: &Table| -> Vec<Value> {
        let known = table.rows.iter().filter(|row| of(row.known));
        known.map(|TableKey { key, value, known }| json!({"section": table.section, "name": table.name(), "key": key, "value": value, "why": known.why()})).collect()
    };
    proposal.tables.iter().flat_map(rows).collect()
}

/// The records that give no answer yet: their file or pattern, code and reason of the refusal.
fn refused(proposal: &Proposal) -> Vec<Value> {
    let refused = proposal.tables.iter().filter_map(|table| {
        let refusal = table.refused.as_ref()?;
        Some(json!({ "file": table.files, "code": refusal.code, "reason": refusal.in_words() }))
    });
    refused.collect()
}

/// Prints which tables are proposed, with guessed and missing keys.
pub fn print_tables(proposal: &Proposal) {
    let mut series: Vec<(&str, &str)> = Vec::new();
    for table in &proposal.tables {
        if series.contains(&(table.section, table.name())) {
            complain::line(&format!("{} -> [[{}]], of the same series", table.in_words(), table.section));
            continue;
        }
        series.push((table.section, table.name()));
        let filled = if table.lacks() { ", left out until it is filled in" } else { "" };
        complain::line(&format!("{} -> [[{}]]{filled}", table.in_words(), table.section));
        if let Some(refused) = &table.refused {
            complain::line(&format!("  {}", refused.in_words()));
        }
        for TableKey { key, value, known } in &table.rows {
            match known {
                KeyStatus::Found | KeyStatus::Open(_) => {}
                KeyStatus::Guessed(why) => complain::line(&format!("  guessed: {key} = {value} ({why})")),
                KeyStatus::Missing(what) => complain::line(&format!("  missing: {key}, {what}")),
            }
        }
    }
}

impl super::CommandArgs for Check {
    const VOICE: Voice = Voice::Campaign;

    /// Checks keys, values, files and channels without computing.
    fn run(&self, json: bool) -> Result<u8> {
        let of_folder = self.campaign.join(Proposal::FILE);
        if self.campaign.is_dir() && !of_folder.exists() {
            let shown = typed(&self.campaign);
            let error = Error::usage(format!("{shown} has no {}", Proposal::FILE), "");
            return Err(error.hint(format!("vibro init {shown}")));
        }
        let campaign = analysis::open_in(
            &Folder::default().allow_outside(self.allow_outside),
            if self.campaign.is_dir() { &of_folder } else { &self.campaign },
        )?;
        let errors = analysis::errors(&campaign)?;
        if !errors.is_empty() {
            return Ok(complain::errors(&errors, Voice::Campaign, json));
        }
        let files = analysis::files(&campaign)?;
        let found = campaign.commented().into_iter().chain(analysis::double_use(&campaign)?);
        let commented: Vec<_> = found.map(|found| (String::new(), found)).collect();
        if json {
            let mut answer = Map::new();
            answer.insert("files".to_owned(), json!(files));
            put(&mut answer, &commented, Voice::Campaign);
            stdout::object(answer)?;
        } else {
            complain::warn(&graded(&commented, Voice::Campaign), "--json");
            let shown = typed(&self.campaign);
            stdout::text(&format!(
                "{shown}: no fault, {} found\nnext: vibro run {shown}\n",
                counted(files.len(), "file")
            ))?;
        }
        Ok(0)
    }
}
