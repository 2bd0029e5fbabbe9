//! Stepped-sine sweeps: `[[sweep]]`, `vibro response`, `vibro waterfall`, `vibro compare`.

pub mod figures;
pub mod modelled;
pub mod pairing;
pub mod stored;
pub mod tables;

pub use stored::Stored;

use super::{Analysis, Answer, Job, JobOptions, Progress, entries};
use crate::campaign::{Campaign, Entry, above_zero};
use crate::error::{Error, Place, Result};
use crate::measure::response::{Response, ResponseOptions, response, to_displacement};
use crate::measure::waterfall::{Waterfall, gathered};
use crate::read::{SweepList, SweepReader};
use crate::record::{Direction, Scaling, Sweep};
use crate::report::files;
use crate::report::words::About;
use crate::units::Quantity;
use rayon::prelude::*;
use serde::Deserialize;
use std::path::PathBuf;

/// A sweep of one mass: its files, and what the analyser stored in them.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Keys {
    /// Name, unique in the campaign.
    pub name: String,
    /// `up` or `down`.
    pub direction: Option<Direction>,
    /// 1 excited mass, 2 passive mass.
    pub mass: Option<u8>,
    /// List file or hand-over file.
    pub list: Option<PathBuf>,
    /// Force files, instead of a list.
    pub force: Vec<PathBuf>,
    /// Response files, instead of a list.
    pub response: Vec<PathBuf>,
    /// Spectral lines, instead of a list.
    pub lines: Option<usize>,
    /// Base band in Hz, instead of a list.
    pub base_band: Option<f64>,
    /// What the analyser stored: displacement, velocity or acceleration. Default displacement.
    pub quantity: Option<String>,
    /// Unit in which it was stored. Default SI, with a warning.
    pub unit: Option<String>,
    /// Factor on stored responses. Default 1.
    pub calibration: Option<f64>,
    /// Factor on stored forces, to newtons. Default 1.
    pub force_calibration: Option<f64>,
    /// Window of the analyser, or `unknown`. Default Hann, with a warning.
    pub window: Option<String>,
    /// `peak` or `rms`. Default peak, with a warning.
    pub scaling: Option<Scaling>,
    /// How often the analyser integrated before it stored. Default once for a displacement.
    pub analyser_integrated: Option<u8>,
}

impl Keys {
    fn usable(&self) -> Result<()> {
        let wrong = |key, found: &str, expected: &str| Err(Error::usage(found, expected).setting(key));
        if self.name.is_empty() {
            return Err(Error::usage("the key `name` is missing", "").hint("add name = …"));
        }
        let written = !self.response.is_empty();
        if self.list.is_some() == written {
            let found = if written { "both a list and response" } else { "neither a list nor response" };
            let expected = "list = \"…\", or force, response, lines and base_band";
            return wrong("name", &format!("{found} files"), expected);
        }
        if self.list.is_some() && (self.lines.is_some() || self.base_band.is_some()) {
            let found = "lines or base_band beside a list, which states both";
            return wrong("list", found, "one of them: correct the list, or leave the keys out");
        }
        let band = self.base_band.is_some_and(|b| b.is_finite() && b > 0.0);
        let complete = band && self.lines.is_some_and(|l| l > 0) && self.force.len() == self.response.len();
        if written && !complete {
            let said = |value: Option<f64>| value.map_or_else(|| "left out".to_owned(), |v| v.to_string());
            let (force, response) = (self.force.len(), self.response.len());
            let (lines, band) = (said(self.lines.map(|n| n as f64)), said(self.base_band));
            let found =
                format!("{force} force and {response} response files, lines {lines}, base_band {band}");
            return wrong("name", &found, "as many force as response files, and both numbers above 0");
        }
        if let Some(mass) = self.mass.filter(|m| !matches!(m, 1 | 2)) {
            return wrong("mass", &format!("mass = {mass}"), "1 (excited) or 2 (passive)");
        }
        above_zero("force_calibration", self.force_calibration)?;
        self.reader().map(drop)
    }

    /// How the files of this sweep are to be read.
    ///
    /// # Errors
    /// If what is stated of them cannot be.
    pub fn reader(&self) -> Result<SweepReader> {
        let quantity = self.quantity.as_deref().map(|text| {
            Quantity::from_name(text).filter(|q| stored::MOTION.contains(q)).ok_or_else(|| {
                let expected = "displacement, velocity or acceleration";
                Error::usage(format!("the quantity {text:?} is not known"), expected).setting("quantity")
            })
        });
        let mut reader = SweepReader {
            name: self.name.clone(),
            direction: self.direction,
            mass: self.mass,
            quantity: quantity.transpose()?,
            force_calibration: self.force_calibration,
            ..SweepReader::default()
        };
        let stored = Stored {
            unit: self.unit.clone(),
            calibration: self.calibration,
            window: self.window.clone(),
            scaling: self.scaling,
            analyser_integrated: self.analyser_integrated,
        };
        stored.apply(&mut reader)?;
        Ok(reader)
    }
}

/// The files of a sweep.
///
/// # Errors
/// If its list cannot be read or a name leads outside the folder.
pub fn list(campaign: &Campaign, entry: &Entry<Keys>, allow_outside: bool) -> Result<SweepList> {
    let keys = &entry.keys;
    if let Some(list) = &keys.list {
        return SweepList::from_path(campaign.file(entry, "list", list, allow_outside)?, allow_outside);
    }
    let all = |key: &'static str, names: &[PathBuf]| -> Result<Vec<PathBuf>> {
        names.iter().map(|name| campaign.path_of(entry, key, name, allow_outside)).collect()
    };
    Ok(SweepList {
        lines: keys.lines.unwrap_or(0),
        base_band: keys.base_band.unwrap_or(0.0),
        force: all("force", &keys.force)?,
        excitation: Vec::new(),
        response: all("response", &keys.response)?,
        places: Vec::new(),
    })
}

/// List and reader of the sweep `name` of a campaign; of its only sweep where `name` is `None`.
///
/// # Errors
/// If there is no such sweep, or its list cannot be read.
pub fn named(
    campaign: &Campaign,
    name: Option<&str>,
    allow_outside: bool,
) -> Result<(SweepList, SweepReader)> {
    let all = entries::<Keys>(campaign)?;
    let names = || all.iter().map(|s| s.keys.name.as_str()).collect::<Vec<_>>().join(", ");
    let none = |found: String| Error::input(Place::file(campaign.path()), found, names());
    let entry = match (name, all.as_slice()) {
        (Some(name), all) => all
            .iter()
            .find(|s| s.keys.name == name)
            .ok_or_else(|| none(format!("no sweep is named {name:?}")))?,
        (None, [only]) => only,
        (None, all) => {
            let error = none(format!("{} sweeps and none was chosen", all.len()));
            return Err(error.hint(format!("name one: {}#NAME", campaign.path().display())));
        }
    };
    Ok((list(campaign, entry, allow_outside)?, entry.keys.reader()?))
}

/// Reads all sweeps of a campaign and takes their responses to displacement, with the resonances named.
///
/// # Errors
/// If a list or a spectrum cannot be read, or an excitation cannot be found.
pub fn responses(campaign: &Campaign, options: JobOptions, progress: &dyn Progress) -> Result<Vec<Response>> {
    let taken = taken(campaign, &entries(campaign)?, options, progress)?;
    Ok(taken.into_iter().map(|(_, response, _)| response).collect())
}

type Taken = (Sweep, Response, ResponseOptions);

fn taken(
    campaign: &Campaign,
    entries: &[Entry<Keys>],
    options: JobOptions,
    progress: &dyn Progress,
) -> Result<Vec<Taken>> {
    progress.start("reading sweeps", entries.len());
    let mut taken: Vec<Taken> = entries
        .par_iter()
        .map(|entry| {
            let list = list(campaign, entry, options.allow_outside)?;
            let sweep = entry.keys.reader()?.read(&list)?;
            let integrate = to_displacement(sweep.unit().quantity());
            let compute = &campaign.compute;
            let options = ResponseOptions { band: compute.band, integrate, fmin: compute.fmin };
            let response = response(&sweep, &options)?;
            progress.step();
            Ok((sweep, response, options))
        })
        .collect::<Result<_>>()?;
    pairing::name(&mut taken.iter_mut().map(|(_, response, _)| response).collect::<Vec<_>>());
    Ok(taken)
}

/// What is known of the responses, each about its sweep.
fn findings_of(responses: &[Response]) -> impl Iterator<Item = About> {
    responses.iter().flat_map(|r| r.findings.iter().map(|f| (r.name.clone(), f.clone())))
}

impl Analysis for Keys {
    const SECTION: &'static str = "sweep";
    const OF_FILES: bool = false;

    fn check(entry: &Entry<Keys>, earlier: &[Entry<Keys>]) -> Result<()> {
        let name = &entry.keys.name;
        if earlier.iter().any(|e| e.keys.name == *name) {
            let expected = "a name of its own for each";
            return Err(Error::usage(format!("two sweeps are named {name:?}"), expected).setting("name"));
        }
        entry.keys.usable()
    }

    fn run(entries: &[Entry<Keys>], job: &mut Job<'_>) -> Result<()> {
        let taken = taken(job.campaign, entries, job.options, job.progress)?;
        let matrix = |(sweep, response, options): Taken| {
            let excitation = response.points.iter().map(|p| p.excitation).collect();
            (gathered(&sweep, &options, excitation, response.fmin), response)
        };
        let (matrices, responses): (Vec<Waterfall>, Vec<Response>) =
            taken.into_par_iter().map(matrix).unzip();
        job.answers += responses.len();
        job.put("antiresonance", &pairing::antiresonances(&responses))?;
        job.put("crossings", &pairing::all_crossings(&responses))?;
        let mut all = Answer { findings: pairing::twice(&responses), ..Answer::default() };
        if !responses.is_empty() {
            all.figure("response", figures::response(&job.title, &responses));
            all.tables = vec![tables::resonances(&responses), tables::jumps(&responses)];
        }
        job.show("", "", all);
        modelled::run(job, &responses)?;
        let slugs = files::slugs(responses.iter().map(|r| r.name.as_str()));
        let compute = &job.campaign.compute;
        let mut shown = Vec::new();
        for (slug, (response, matrix)) in slugs.iter().zip(responses.iter().zip(&matrices)) {
            let mut one = Answer::of(response)?;
            one.add("", &response.findings);
            if compute.waterfall {
                one.figure("waterfall", figures::waterfall(matrix, compute.fmax)?);
                one.figure("map", figures::map(matrix, compute.fmax)?);
            }
            one.csv("response", &tables::response(response));
            one.files.push(("waterfall.csv".to_owned(), files::matrix_csv(matrix).into_bytes()));
            shown.push(job.show(&response.name, slug, one));
            job.all.details.push(tables::curve(response));
            job.histories.push((response.name.clone(), response.history.clone()));
        }
        job.put("responses", &shown)
    }
}
