//! All that a campaign asks for: responses, waterfalls, overlay, frequency response functions, and their files.

mod drill;
mod drops;
mod frf;
mod impacts;
mod pairing;
mod pulse;
mod spectral;

pub use drill::DrillResult;
pub use drops::DropResult;
pub use frf::FrfResult;
pub use impacts::ImpactsResult;
pub use pairing::Crossing;
pub use pulse::NamedPulse;
pub use spectral::SpectrumResult;

use super::{Figure, Output, files, page, pictures, tables, words};
use crate::campaign::Campaign;
use crate::compare::{Fit, Overlay, overlay};
use crate::error::{Error, Result};
use crate::measure::response::{Response, ResponseOptions, response, to_displacement};
use crate::measure::waterfall::{Waterfall, gathered};
use crate::model::Rig;
use crate::record::Sweep;
use rayon::prelude::*;
use serde::Serialize;
use std::path::PathBuf;

/// Steps of progress through a record.
const PARTS: usize = 100;

/// Told how far a job is.
pub trait Progress: Sync {
    /// A part with this many steps begins.
    fn start(&self, what: &str, steps: usize);
    /// One step is done.
    fn step(&self);
    /// All is done.
    fn done(&self);
}

/// Nobody is told.
impl Progress for () {
    fn start(&self, _: &str, _: usize) {}
    fn step(&self) {}
    fn done(&self) {}
}

/// How a job may go about its files.
#[derive(Debug, Clone, Copy, Default)]
pub struct JobOptions {
    /// Allow names that lead outside the campaign's folder.
    pub allow_outside: bool,
}

impl Results {
    /// Whether a campaign that asks for something got no answer at all.
    pub fn is_empty(&self) -> bool {
        let lengths = [
            self.responses.len(),
            self.spectra.len(),
            self.frf.len(),
            self.drill.len(),
            self.impacts.len(),
            self.drops.len(),
            self.pulses.len(),
        ];
        lengths.iter().all(|n| *n == 0)
    }
}

/// Everything a job found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Results {
    /// Name of the campaign.
    pub campaign: String,
    /// Version of this crate.
    pub version: &'static str,
    /// One response a sweep.
    pub responses: Vec<Response>,
    /// Antiresonance of mass 1 in Hz, going up and going down, at the first level of force.
    pub antiresonance: [Option<f64>; 2],
    /// Where the curves of both masses cross.
    pub crossings: Vec<Crossing>,
    /// The rig of the comparison.
    pub rig: Option<Rig>,
    /// Comparison with the model.
    pub overlay: Option<Overlay>,
    /// Parameters found from the responses.
    pub fit: Option<Fit>,
    /// Spectra of time records.
    pub spectra: Vec<SpectrumResult>,
    /// Frequency response functions.
    pub frf: Vec<FrfResult>,
    /// Hammer drills.
    pub drill: Vec<DrillResult>,
    /// Impacts of contact traces.
    pub impacts: Vec<ImpactsResult>,
    /// Restitution from drops.
    pub drops: Vec<DropResult>,
    /// Contact pulses.
    pub pulses: Vec<NamedPulse>,
    /// What a person must know, each sentence once.
    pub warnings: Vec<String>,
}

/// Reads all sweeps of a campaign and takes their responses to displacement, with the resonances named.
///
/// # Errors
/// If a list or a spectrum cannot be read, or an excitation cannot be found.
pub fn responses(campaign: &Campaign, options: JobOptions, progress: &dyn Progress) -> Result<Vec<Response>> {
    let taken = sweeps(campaign, options, progress)?;
    Ok(taken.into_iter().map(|(_, response, _)| response).collect())
}

type Taken = (Sweep, Response, ResponseOptions);

fn sweeps(campaign: &Campaign, options: JobOptions, progress: &dyn Progress) -> Result<Vec<Taken>> {
    progress.start("reading sweeps", campaign.sweep.len());
    let mut taken: Vec<Taken> = campaign
        .sweep
        .par_iter()
        .map(|entry| {
            let list = campaign.list(entry, options.allow_outside)?;
            let how = entry.reader();
            let compute = &campaign.compute;
            let sweep = how.read(&list)?;
            let integrate = to_displacement(sweep.unit().quantity());
            let options = ResponseOptions { band: compute.band, integrate, fmin: compute.fmin };
            let response = response(&sweep, &options)?;
            progress.step();
            Ok((sweep, response, options))
        })
        .collect::<Result<_>>()?;
    pairing::name(&mut taken.iter_mut().map(|(_, response, _)| response).collect::<Vec<_>>());
    Ok(taken)
}

/// Names of the files that hold all results.
const RESULTS: &str = "results.json";
const REPORT: &str = "report.html";

/// Does everything and writes it to `output`.
///
/// # Errors
/// As [`responses`]; if the overlay is not possible; if a file cannot be written.
pub fn run(
    campaign: &Campaign,
    options: JobOptions,
    output: &mut Output,
    progress: &dyn Progress,
) -> Result<Results> {
    let taken = sweeps(campaign, options, progress)?;
    let mut figures: Vec<(String, Figure)> = Vec::new();
    let matrix = |(sweep, response, options): Taken| {
        let excitation = response.points.iter().map(|p| p.excitation).collect();
        (gathered(&sweep, &options, excitation, response.fmin), response)
    };
    let (matrices, responses): (Vec<Waterfall>, Vec<Response>) = taken.into_par_iter().map(matrix).unzip();
    let mut warnings = common(&responses);
    let slugs = slugs(responses.iter().map(|r| r.name.as_str()));
    let name = if campaign.name.is_empty() { "Campaign".to_owned() } else { campaign.name.clone() };
    if !responses.is_empty() {
        figures.push(("response".to_owned(), pictures::response(&name, &responses)));
    }
    let overlay = model(campaign, &responses, &mut warnings)?;
    if let Some(overlay) = &overlay {
        figures.push(("overlay".to_owned(), pictures::overlay(&name, overlay, &responses)));
    }
    let fit = match &overlay {
        Some(_) => fitted(campaign, &responses, &mut warnings)?,
        None => None,
    };
    figures.extend(fit.as_ref().map(|fit| ("fit".to_owned(), pictures::fit(&name, fit))));
    if campaign.compute.waterfall {
        let fmax = campaign.compute.fmax;
        for (slug, matrix) in slugs.iter().zip(&matrices) {
            figures.push((format!("waterfall_{slug}"), pictures::waterfall(matrix, fmax)?));
            figures.push((format!("map_{slug}"), pictures::map(matrix, fmax)?));
        }
    }
    let spectra = spectral::spectra(campaign, options, progress, &mut figures, &mut warnings)?;
    let (frf, computed) = frf::frfs(campaign, options, progress, &mut figures, &mut warnings)?;
    let drilled = drill::drills(campaign, options, progress, &mut figures, &mut warnings)?;
    let impacts = impacts::impacts(campaign, options, &mut figures, &mut warnings)?;
    let drops = drops::drops(campaign, options, &mut figures, &mut warnings)?;
    let pulses = pulse::pulses(campaign, options, &mut figures, &mut warnings)?;
    let mut nothing = figures.is_empty();
    nothing = nothing && drops.is_empty() && pulses.is_empty();
    if nothing {
        let why = if campaign.is_empty() { "The campaign names no file" } else { "No file allows an answer" };
        warnings.push(format!("{why}: nothing was computed."));
    }
    pairing::twice(&responses, &mut warnings);
    if overlay.is_some() {
        // All that follows rests on it.
        warnings.splice(0..0, campaign.rig_left_out());
    }
    let mut results = Results {
        campaign: name,
        version: env!("CARGO_PKG_VERSION"),
        antiresonance: pairing::antiresonances(&responses),
        crossings: pairing::all_crossings(&responses),
        responses,
        rig: campaign.rig.filter(|_| overlay.is_some()),
        overlay,
        fit,
        spectra,
        frf,
        drill: drilled,
        impacts,
        drops,
        pulses,
        warnings,
    };
    progress.start("drawing figures", figures.len());
    let drawings = files::figures(output, &figures, &|| progress.step())?;
    for (slug, (response, matrix)) in slugs.iter().zip(results.responses.iter().zip(&matrices)) {
        output.write(&format!("response_{slug}.csv"), tables::response(response).csv())?;
        output.write(&format!("waterfall_{slug}.csv"), files::matrix_csv(matrix))?;
    }
    if let Some(overlay) = &results.overlay {
        output.write("pairs.csv", tables::pairs(overlay).csv())?;
        output.write("peaks.csv", tables::peaks(overlay).csv())?;
    }
    if let Some(fit) = &results.fit {
        output.write("fit.csv", tables::fitted(fit).csv())?;
        output.write("fit_points.csv", tables::fit_points(fit).csv())?;
    }
    spectral::tables(&results.spectra, output, &mut results.warnings)?;
    frf::tables(&results.frf, &computed, output, &mut results.warnings)?;
    drill::tables(&results.drill, output)?;
    for (i, result) in results.impacts.iter().enumerate() {
        output.write(&format!("impacts_{}.csv", i + 1), tables::impact_times(&result.impacts).csv())?;
    }
    results.warnings.extend(files::left_over(output, &[RESULTS, REPORT]));
    let json = serde_json::to_string_pretty(&results)
        .map_err(|e| Error::refused(format!("the results cannot be written as JSON: {e}")))?;
    output.write(RESULTS, json + "\n")?;
    output.write(REPORT, page::page(&results, &figures, &drawings).html())?;
    progress.done();
    Ok(results)
}

/// The warnings of all sweeps, once each, with the names of the sweeps that they hold for where these are not all.
pub(crate) fn common(responses: &[Response]) -> Vec<String> {
    let mut found: Vec<(String, Vec<&str>)> = Vec::new();
    for response in responses {
        let own = words::sentences(&response.findings, words::Voice::Campaign);
        for sentence in own.into_iter().chain(response.warnings.iter().cloned()) {
            match found.iter_mut().find(|f| f.0 == sentence) {
                Some(known) => known.1.push(&response.name),
                None => found.push((sentence, vec![&response.name])),
            }
        }
    }
    let said = |(sentence, names): (String, Vec<&str>)| {
        if responses.len() > 1 && names.len() < responses.len() {
            format!("{}: {sentence}", names.join("; "))
        } else {
            sentence
        }
    };
    found.into_iter().map(said).collect()
}

/// Adds sentences, once each, with the names of what they are about.
fn merge(all: &mut Vec<String>, name: &str, sentences: &[String]) {
    for sentence in sentences {
        let sentence = in_keys(sentence);
        if name.is_empty() {
            if !all.contains(&sentence) {
                all.push(sentence);
            }
            continue;
        }
        let said = format!(": {sentence}");
        match all.iter_mut().find_map(|text| text.strip_suffix(&said).map(str::to_owned).map(|n| (text, n))) {
            Some((text, names)) if !names.split("; ").any(|n| n == name) => {
                *text = format!("{names}; {name}{said}");
            }
            Some(_) => {}
            None => all.push(format!("{name}{said}")),
        }
    }
}

/// Options of the command as keys of a campaign, `--low-pass` as `low_pass`, but not those of a command line that is named whole.
fn in_keys(sentence: &str) -> String {
    let mut text = String::new();
    let mut rest = sentence;
    while let Some(at) = rest.find("--") {
        let (before, option) = rest.split_at(at);
        let end =
            option[2..].find(|c: char| !c.is_ascii_lowercase() && c != '-').map_or(option.len(), |n| n + 2);
        let begins = before.chars().next_back().is_none_or(|c| c.is_whitespace() || "(`:".contains(c));
        let clause = format!("{text}{before}");
        let of_command =
            clause.rsplit(['(', '`', ';', ':', '.']).next().is_some_and(|c| c.contains("vibro "));
        text.push_str(before);
        if begins && end > 2 && !of_command {
            text.push_str(&option[2..end].replace('-', "_"));
        } else {
            text.push_str(&option[..end]);
        }
        rest = &option[end..];
    }
    text + rest
}

/// What a record gave. One that allows no answer is no reason to give up the rest of a campaign: it becomes a warning.
fn or_left_out<T>(found: Result<T>, name: &str, warnings: &mut Vec<String>) -> Result<Option<T>> {
    match found {
        Err(error) if error.exit_code() == 1 => {
            let told = error.to_string();
            let (why, hint) = told.split_once("\n  try: ").unwrap_or((&told, ""));
            let ended =
                |text: &str| format!("{}{}", text, if text.ends_with(['.', '?', '!']) { "" } else { "." });
            let hint = if hint.is_empty() { String::new() } else { format!(" Try: {}", ended(hint)) };
            merge(warnings, name, &[format!("Left out: {}{hint}", ended(why))]);
            Ok(None)
        }
        found => found.map(Some),
    }
}

/// File names of the sweeps, each once.
fn slugs<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut slugs: Vec<String> = Vec::new();
    for (i, name) in names.enumerate() {
        let slug = files::slug(name);
        let numbered = slug.is_empty() || slugs.contains(&slug);
        slugs.push(if numbered { format!("{slug}_{}", i + 1) } else { slug });
    }
    slugs
}

fn model(campaign: &Campaign, responses: &[Response], warnings: &mut Vec<String>) -> Result<Option<Overlay>> {
    let Some(rig) = campaign.rig.filter(|_| campaign.compute.overlay) else { return Ok(None) };
    if responses.iter().all(|r| r.mass.is_none() || r.direction.is_none()) {
        if !responses.is_empty() {
            warnings.push("No sweep names its mass, so nothing is overlaid on the model.".to_owned());
        }
        return Ok(None);
    }
    let overlay = overlay(&rig, campaign.excitation.and_then(|e| e.force), &campaign.into(), responses)?;
    merge(warnings, "", &overlay.warnings);
    Ok(Some(overlay))
}

/// The parameters that a campaign asks for; `None` where it asks for none.
///
/// # Errors
/// As [`crate::compare::fit()`].
pub fn fit(campaign: &Campaign, rig: &Rig, responses: &[Response]) -> Result<Option<Fit>> {
    if campaign.fit.parameters.is_empty() {
        return Ok(None);
    }
    let force = campaign.excitation.and_then(|e| e.force);
    // A curved contact has no stiffness in N/m, and a damper that is stated leaves no restitution to be found.
    let straight = campaign.contact.filter(|c| c.exponent.is_none_or(|n| n == 1.0) && c.damping.is_none());
    let contact = straight.and_then(|c| c.stiffness);
    let pace = crate::compare::Predicting::from(campaign).pace;
    crate::compare::fit(rig, force, contact, pace, responses, &campaign.fit).map(Some)
}

/// As [`fit`] with its warnings; data that allow no answer are no reason to give up the rest.
fn fitted(campaign: &Campaign, responses: &[Response], warnings: &mut Vec<String>) -> Result<Option<Fit>> {
    let Some(rig) = &campaign.rig else { return Ok(None) };
    let found = or_left_out(fit(campaign, rig, responses), "fit", warnings)?.flatten();
    if let Some(fit) = &found {
        // That nothing has an uncertainty comes before all else.
        let doubted = usize::from(fit.parameters.iter().all(|p| p.estimate.std.is_none()));
        let (first, rest) = fit.warnings.split_at(doubted.min(fit.warnings.len()));
        warnings.splice(0..0, first.iter().cloned());
        merge(warnings, "", rest);
    }
    Ok(found)
}

fn file_name(path: &std::path::Path) -> String {
    path.file_name()
        .map_or_else(|| PathBuf::from(path).display().to_string(), |n| n.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_of_many_files_stands_once() {
        let mut all = Vec::new();
        for name in ["a.txt", "b.txt", "a.txt", "c.txt"] {
            merge(&mut all, name, &["The file says no unit.".to_owned()]);
        }
        merge(&mut all, "", &["Plain.".to_owned(), "Plain.".to_owned()]);
        assert_eq!(all, ["a.txt; b.txt; c.txt: The file says no unit.", "Plain."]);
    }

    #[test]
    fn advice_in_a_campaign_names_its_keys() {
        for (said, key) in [
            ("If none is: --none-missed.", "If none is: none_missed."),
            ("a low-pass (--low-pass HZ)", "a low-pass (low_pass HZ)"),
            ("a high-pass (vibro convert --high-pass HZ)", "a high-pass (vibro convert --high-pass HZ)"),
            ("5 -- 6, a--b", "5 -- 6, a--b"),
        ] {
            assert_eq!(in_keys(said), key);
        }
    }

    #[test]
    fn what_is_left_out_is_one_sentence_after_another() {
        let mut all = Vec::new();
        let refusal = Error::refused("no peak. Two are noise.").hint("is it a metre?");
        assert_eq!(or_left_out::<()>(Err(refusal), "a", &mut all).unwrap(), None);
        assert_eq!(all, ["a: Left out: no peak. Two are noise. Try: is it a metre?"]);
    }
}
