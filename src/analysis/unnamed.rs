//! Recordings of a folder that its campaign does not name.

use super::kinds::files;
use super::named_file::few;
use super::own_files::OWN;
use super::recordings::{WHOLE_NAMES, recordings};
use super::source::file_name;
use crate::campaign::Campaign;
use crate::error::Result;
use crate::read::plain;
use crate::record::Finding;
use glob::Pattern;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The files of `all` that no table and no comment of the campaign names.
///
/// # Errors
/// As [`files`].
pub fn unnamed(campaign: &Campaign, all: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let named: BTreeSet<PathBuf> =
        files(campaign)?.iter().map(|path| plain(campaign.within().file(path))).collect();
    let folder = plain(campaign.folder());
    // A character that cannot belong to a file name.
    let ends_name = |c: char| !c.is_alphanumeric() && !['_', '-', '.', '/', '\\'].contains(&c);
    // A table that is commented out may name a pattern.
    let commented = campaign.text().lines().filter_map(|line| {
        let key = line.trim_start().strip_prefix('#')?.trim_start().strip_prefix("file")?;
        key.trim_start().strip_prefix('=')?.split('"').nth(1)
    });
    let patterns: Vec<Pattern> = commented.filter_map(|text| Pattern::new(text).ok()).collect();
    let mentioned = |path: &Path| {
        let name = path.strip_prefix(&folder).unwrap_or(path).to_string_lossy().replace('\\', "/");
        let in_text = || {
            campaign.text().match_indices(&name).any(|(at, _)| {
                let (before, behind) = (&campaign.text()[..at], &campaign.text()[at + name.len()..]);
                // A full stop may end a sentence. A slash begins the name of a part of the file.
                let behind = behind
                    .strip_prefix('.')
                    .filter(|b| !b.starts_with(char::is_alphanumeric))
                    .unwrap_or(behind);
                before.chars().next_back().is_none_or(ends_name)
                    && behind.chars().next().is_none_or(|c| c == '/' || ends_name(c))
            })
        };
        patterns.iter().any(|pattern| pattern.matches_with(&name, WHOLE_NAMES)) || in_text()
    };
    let is_new = |path: &&PathBuf| {
        let path = plain(path);
        !named.contains(&path) && !mentioned(&path)
    };
    Ok(all.iter().filter(is_new).cloned().collect())
}

/// Notes on files that a campaign does not name, and on files that could not be read. Only the folder's own
/// campaign gets them.
///
/// # Errors
/// As [`files`].
pub fn beside(campaign: &Campaign) -> Result<Vec<Finding>> {
    if !campaign.is_file() || !campaign.path().ends_with(OWN) {
        return Ok(Vec::new());
    }
    let seen = recordings(campaign.within())?;
    let new = unnamed(campaign, &seen.files)?;
    let names: Vec<String> = new.iter().map(|path| file_name(path)).collect();
    let found = Finding::note("files-not-named").count("n", new.len());
    let found = (!new.is_empty()).then(|| found.name("files", few(&names)));
    let skipped = seen.skipped.into_iter().map(|(path, why)| (file_name(&path), why));
    // A file that the campaign names already has a finding.
    let skipped = skipped.filter(|(name, _)| !campaign.text().contains(name));
    let skipped = skipped.map(|(name, why)| Finding::note("file-not-used").about(name).name("why", why));
    Ok(found.into_iter().chain(skipped).collect())
}
