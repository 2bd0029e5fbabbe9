//! All that a campaign asks for: responses, waterfalls, overlay, frequency response functions, and their files.

mod frf;
mod pulse;

pub use frf::FrfResult;
pub use pulse::NamedPulse;

use super::{Figure, Output, files, page, pictures, tables};
use crate::campaign::{Campaign, DrillEntry, DropEntry, ImpactsEntry};
use crate::compare::{Overlay, overlay};
use crate::error::{Error, Result};
use crate::measure::resonance::{NamedCurve, crossings, deepest, name_modes};
use crate::measure::response::{Response, ResponseOptions, response, to_displacement};
use crate::measure::waterfall::{Waterfall, waterfall};
use crate::model::Rig;
use crate::read::Header;
use crate::record::{Direction, Sweep};
use rayon::prelude::*;
use serde::Serialize;
use std::path::PathBuf;

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

/// Where the curves of both masses cross.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Crossing {
    /// Direction of the two sweeps.
    pub direction: Direction,
    /// Frequency in Hz.
    pub frequency: f64,
    /// The mass that moves more above it.
    pub larger_above: u8,
}

/// A file that a campaign names but that is only listed here.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Listed {
    /// Part of the campaign: `drop`, `pulse`, …
    pub part: &'static str,
    /// File.
    pub file: String,
    /// Its records.
    pub records: Vec<Header>,
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
    /// Antiresonance of mass 1 in Hz, going up and going down.
    pub antiresonance: [Option<f64>; 2],
    /// Where the curves of both masses cross.
    pub crossings: Vec<Crossing>,
    /// The rig of the comparison.
    pub rig: Option<Rig>,
    /// Comparison with the model.
    pub overlay: Option<Overlay>,
    /// Frequency response functions.
    pub frf: Vec<FrfResult>,
    /// Contact pulses.
    pub pulses: Vec<NamedPulse>,
    /// Files that are listed only.
    pub listed: Vec<Listed>,
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
    let mut curves: Vec<NamedCurve<'_>> = taken
        .iter_mut()
        .filter_map(|(_, r, _)| {
            let (mass, direction) = (r.mass?, r.direction?);
            let mut curve: Vec<(f64, f64, f64)> = r
                .points
                .iter()
                .map(|p| (p.excitation, p.amplitude.value, p.amplitude.std.unwrap_or(f64::NAN)))
                .collect();
            curve.sort_by(|a, b| a.0.total_cmp(&b.0));
            Some(NamedCurve { mass, direction, curve, jumps: r.jumps.clone(), resonances: &mut r.resonances })
        })
        .collect();
    name_modes(&mut curves);
    Ok(taken)
}

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
    let mut matrices: Vec<Waterfall> = Vec::new();
    for (sweep, _, options) in &taken {
        matrices.push(waterfall(sweep, options)?);
    }
    let responses: Vec<Response> = taken.into_iter().map(|(_, response, _)| response).collect();
    let mut warnings: Vec<String> = Vec::new();
    for response in &responses {
        merge(&mut warnings, &response.name, &response.warnings);
    }
    let slugs = slugs(responses.iter().map(|r| r.name.as_str()));
    let name = if campaign.name.is_empty() { "Campaign".to_owned() } else { campaign.name.clone() };
    if !responses.is_empty() {
        figures.push(("response".to_owned(), pictures::response(&name, &responses)));
    }
    let overlay = model(campaign, &responses, &mut warnings)?;
    if let Some(overlay) = &overlay {
        figures.push(("overlay".to_owned(), pictures::overlay(&name, overlay, &responses)));
    }
    if campaign.compute.waterfall {
        let fmax = campaign.compute.fmax;
        for (slug, matrix) in slugs.iter().zip(&matrices) {
            figures.push((format!("waterfall_{slug}"), pictures::waterfall(matrix, fmax)?));
            figures.push((format!("map_{slug}"), pictures::map(matrix, fmax)?));
        }
    }
    let frf = frf::frfs(campaign, options, &mut figures, &mut warnings)?;
    let pulses = pulse::pulses(campaign, options, &mut figures, &mut warnings)?;
    let listed = listed(campaign, options, &mut warnings)?;
    if responses.is_empty() && frf.is_empty() && pulses.is_empty() && listed.is_empty() {
        warnings.push("The campaign names no file: nothing was computed.".to_owned());
    }
    twice(&responses, &mut warnings);
    if overlay.is_some() {
        warnings.extend(campaign.rig_left_out());
    }
    let found = antiresonances(&responses);
    let results = Results {
        campaign: name,
        version: env!("CARGO_PKG_VERSION"),
        antiresonance: found,
        crossings: all_crossings(&responses),
        responses,
        rig: campaign.rig.filter(|_| overlay.is_some()),
        overlay,
        frf,
        pulses,
        listed,
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
    let json = serde_json::to_string_pretty(&results)
        .map_err(|e| Error::refused(format!("the results cannot be written as JSON: {e}")))?;
    output.write("results.json", json + "\n")?;
    output.write("report.html", page::page(&results, &figures, &drawings).html())?;
    progress.done();
    Ok(results)
}

/// Adds sentences, once each, with the sweep's name where they differ from sweep to sweep.
fn merge(all: &mut Vec<String>, name: &str, sentences: &[String]) {
    for sentence in sentences {
        let general = sentence.starts_with("The files do not");
        let text = if general || name.is_empty() { sentence.clone() } else { format!("{name}: {sentence}") };
        if !all.contains(&text) {
            all.push(text);
        }
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

/// Several sweeps of one mass and direction: naming and crossings know only the first.
fn twice(responses: &[Response], warnings: &mut Vec<String>) {
    for (i, r) in responses.iter().enumerate() {
        let same = |o: &&Response| o.mass.is_some() && (o.mass, o.direction) == (r.mass, r.direction);
        if let Some(first) = responses[..i].iter().find(same) {
            warnings.push(format!(
                "\"{}\" and \"{}\" are sweeps of the same mass and direction: resonances of both are named by the first sweep of the other mass, and crossings are those of the first.",
                first.name, r.name
            ));
        }
    }
}

fn model(campaign: &Campaign, responses: &[Response], warnings: &mut Vec<String>) -> Result<Option<Overlay>> {
    let Some(rig) = campaign.rig.filter(|_| campaign.compute.overlay) else { return Ok(None) };
    if responses.iter().all(|r| r.mass.is_none() || r.direction.is_none()) {
        if !responses.is_empty() {
            warnings.push("No sweep names its mass, so nothing is overlaid on the model.".to_owned());
        }
        return Ok(None);
    }
    let overlay = overlay(&rig, campaign.excitation.and_then(|e| e.force), responses)?;
    merge(warnings, "", &overlay.warnings);
    Ok(Some(overlay))
}

fn antiresonances(responses: &[Response]) -> [Option<f64>; 2] {
    [Direction::Up, Direction::Down].map(|direction| {
        deepest(&responses.iter().find(|r| r.mass == Some(1) && r.direction == Some(direction))?.resonances)
    })
}

fn all_crossings(responses: &[Response]) -> Vec<Crossing> {
    let mut found = Vec::new();
    for direction in [Direction::Up, Direction::Down] {
        let of = |mass| responses.iter().find(|r| r.mass == Some(mass) && r.direction == Some(direction));
        if let (Some(first), Some(second)) = (of(1), of(2)) {
            let curve = |r: &Response| r.points.iter().map(|p| (p.excitation, p.amplitude.value)).collect();
            for (frequency, second_above) in crossings(curve(first), curve(second)) {
                found.push(Crossing { direction, frequency, larger_above: if second_above { 2 } else { 1 } });
            }
        }
    }
    found
}

/// Parts of a campaign that have no analysis yet are listed, and that is said.
fn listed(campaign: &Campaign, options: JobOptions, warnings: &mut Vec<String>) -> Result<Vec<Listed>> {
    let parts = [
        ("impacts", campaign.impacts.iter().map(ImpactsEntry::record).collect::<Vec<_>>()),
        ("drop", campaign.drop.iter().map(DropEntry::record).collect()),
        ("drill", campaign.drill.iter().map(DrillEntry::record).collect()),
    ];
    let mut listed = Vec::new();
    for (part, entries) in parts {
        for entry in &entries {
            let path = campaign.record_path(entry, options.allow_outside)?;
            let (_, records, doubts) = entry.reader().survey(&path)?;
            merge(warnings, &file_name(&path), &doubts);
            if entry.calibration.is_some() {
                warnings.push(format!(
                    "{}: the calibration is not applied to a file that is listed only.",
                    file_name(&path)
                ));
            }
            listed.push(Listed { part, file: file_name(&path), records });
        }
        if !entries.is_empty() {
            warnings.push(format!(
                "[[{part}]] files are listed, not analysed: this version has no analysis for them."
            ));
        }
    }
    Ok(listed)
}

fn file_name(path: &std::path::Path) -> String {
    path.file_name()
        .map_or_else(|| PathBuf::from(path).display().to_string(), |n| n.to_string_lossy().into_owned())
}
