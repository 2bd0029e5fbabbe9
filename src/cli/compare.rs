//! `vibro compare`: measured responses over the model.

use super::{args, complain, print, progress};
use crate::analysis::model::tables::climbed;
use crate::analysis::sweep::{self, figures, modelled, tables};
use crate::analysis::{self, JobOptions};
use crate::campaign::Parameter;
use crate::compare::{Fit, Overlay, Predicting, overlay};
use crate::error::{Error, Place, Result};
use crate::report::words::{Voice, told, with_record};
use crate::report::{Output, files};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    overlay: Overlay,
    /// Parameters found from the data.
    fit: Option<Fit>,
    files: Vec<String>,
}

pub fn run(typed: &args::Compare, json: bool) -> Result<()> {
    let mut campaign = analysis::open(&typed.campaign)?;
    if !typed.fit.is_empty() {
        let names = typed.fit.iter().map(|name| Parameter::from_name(name.trim()));
        campaign.fit.ask(names.collect::<Result<_>>()?)?;
    }
    let rig = campaign.rig.ok_or_else(|| {
        Error::input(Place::file(campaign.path()), "the campaign has no [rig]", "the rig to compare with")
            .hint("add a [rig] table; keys left out take the values of the thesis' rig")
    })?;
    let options = JobOptions { allow_outside: typed.allow_outside };
    let responses = sweep::responses(&campaign, options, &progress::bar(json))?;
    let force = campaign.excitation.and_then(|e| e.force);
    let mut overlay = overlay(&rig, force, &Predicting::from(&campaign), &responses)?;
    let whole = |finding| (String::new(), finding);
    let mut findings: Vec<_> = modelled::rig_left_out(&campaign).map(whole).into_iter().collect();
    findings.extend(overlay.findings.drain(..).map(whole));
    findings.extend(sweep::told(&responses));
    let fit = modelled::fit(&campaign, &rig, &responses)?;
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let mut figures =
            vec![("overlay".to_owned(), figures::overlay(&campaign.name, &overlay, &responses))];
        figures.extend(fit.as_ref().map(|fit| ("fit".to_owned(), figures::fit(&campaign.name, fit))));
        files::figures(&mut output, &figures, &|| ())?;
        output.write("pairs.csv", tables::pairs(&overlay).csv())?;
        if let Some(fit) = &fit {
            output.write("fit.csv", tables::fitted(fit).csv())?;
            output.write("fit_points.csv", tables::fit_points(fit).csv())?;
        }
        written = output.written().to_vec();
    }
    findings.extend(fit.iter().flat_map(|f| f.findings.iter().cloned()).map(whole));
    if json {
        overlay.findings = findings.into_iter().map(with_record).collect();
        return print::json(&Answer { overlay, fit, files: written });
    }
    complain::warn(&told(&findings, Voice::Command, true));
    let mut text = format!("{}\n{}", tables::peaks(&overlay).text(), tables::scores(&overlay).text());
    if !overlay.rungs.is_empty() {
        let _ = write!(text, "\n{}", climbed(&overlay).text());
    }
    if let Some(fit) = &fit {
        let _ = write!(text, "\n{}\n{}", tables::fitted(fit).text(), tables::fit_rungs(fit).text());
    }
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}
