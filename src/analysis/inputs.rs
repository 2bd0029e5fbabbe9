//! Digests of all inputs of a campaign.

use super::kept::AnswerCache;
use super::source::file_name;
use crate::campaign::Campaign;
use crate::read::listed;
use crate::record::shown;
use rayon::prelude::*;
use sha2::{Digest as _, Sha256};
use std::path::{Path, PathBuf};

/// Digests of the program, the campaign and `all` of its recordings, one a line as `sha256sum` writes them;
/// names are relative to the folder of the campaign.
pub fn inputs(campaign: &Campaign, mut all: Vec<PathBuf>, kept: &AnswerCache) -> String {
    for path in &mut all {
        *path = campaign.within().file(path).to_owned();
    }
    all.sort();
    all.dedup();
    // The reader reports what is wrong with a folder or a pipe.
    all.retain(|path| campaign.within().is_file(path));
    let campaign_line = listed(&Sha256::digest(campaign.text()).into(), &file_name(campaign.path()));
    // A proposed campaign is no file that could be checked: its line is a comment.
    let campaign_line = if campaign.is_file() { campaign_line } else { format!("# {campaign_line}") };
    let program = listed(&kept.program().unwrap_or_default(), concat!("vibro ", env!("CARGO_PKG_VERSION")));
    let of_file = |path: &Path| {
        let name = path.strip_prefix(campaign.folder()).unwrap_or(path);
        // The record gives the reason.
        let unread = |_| format!("# {} cannot be read\n", shown(name));
        kept.file(path).map_or_else(unread, |digest| listed(&digest, &name.to_string_lossy()))
    };
    let lines: Vec<String> = all.par_iter().map(|path| of_file(path)).collect();
    format!("# {program}{campaign_line}{}", lines.concat())
}
