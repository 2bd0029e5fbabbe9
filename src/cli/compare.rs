//! `vibro compare`: measured responses over the model.

use super::{args, complain, print, progress};
use crate::campaign::Campaign;
use crate::compare::{Overlay, Predicting, overlay};
use crate::error::{Error, Place, Result};
use crate::report::job::{self, JobOptions};
use crate::report::{Output, files, pictures, tables};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    overlay: Overlay,
    /// Parameters found from the data; none are fitted yet.
    fit: Option<()>,
    files: Vec<String>,
}

pub fn run(typed: &args::Compare, json: bool) -> Result<()> {
    let campaign = Campaign::from_path(&typed.campaign)?;
    let rig = campaign.rig.ok_or_else(|| {
        Error::input(Place::file(campaign.path()), "the campaign has no [rig]", "the rig to compare with")
            .hint("add a [rig] table; keys left out take the values of the thesis' rig")
    })?;
    let options = JobOptions { allow_outside: typed.allow_outside };
    let responses = job::responses(&campaign, options, &progress::bar(json))?;
    let force = campaign.excitation.and_then(|e| e.force);
    let mut overlay = overlay(&rig, force, &Predicting::from(&campaign), &responses)?;
    overlay.warnings.extend(job::common(&responses));
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let figure = pictures::overlay(&campaign.name, &overlay, &responses);
        files::figures(&mut output, &[("overlay".to_owned(), figure)], &|| ())?;
        output.write("pairs.csv", tables::pairs(&overlay).csv())?;
        written = output.written().to_vec();
    }
    if json {
        return print::json(&Answer { overlay, fit: None, files: written });
    }
    complain::warn(&overlay.warnings);
    let mut text = format!("{}\n{}", tables::peaks(&overlay).text(), tables::scores(&overlay).text());
    if !overlay.rungs.is_empty() {
        let _ = write!(text, "\n{}", tables::climbed(&overlay).text());
    }
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}
