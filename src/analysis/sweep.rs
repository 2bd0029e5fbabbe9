//! Stepped-sine sweeps: `[[sweep]]`, `vibro response`, `vibro waterfall`, `vibro compare`.

mod draws;
pub mod figures;
pub mod listed;
pub mod modelled;
pub(crate) mod order;
pub mod pairing;
pub mod stored;
pub mod tables;

pub use draws::PairDraws;
pub use listed::{Files, Listed};
pub use stored::StoredResponseKeys;

use super::answer::Answer;
use super::entries::{all_entries, check, entries};
use super::job::Job;
use super::kind::Analysis;
use super::progress::Progress;
use crate::campaign::{Campaign, Entry, Fault, KeyRange, one_or_more};
use crate::error::{Error, Place, Result};
use crate::measure::response::{Response, ResponseOptions};
use crate::measure::waterfall::{Waterfall, waterfall};
use crate::read::SweepReader;
use crate::record::{Direction, Scaling, Sweep, nearest, shown};
use crate::report::files;
use crate::report::files::Names;
use crate::report::words::About;
use crate::units::Quantity;
use rayon::prelude::*;
use serde::Deserialize;
use std::path::PathBuf;

/// A sweep of one mass: its files, and the settings with which the analyser stored them.
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
    /// Time traces, one file a step: names, or a pattern such as `step*.csv`.
    #[serde(deserialize_with = "one_or_more")]
    pub traces: Vec<String>,
    /// Sampling rate of the traces in Hz, where the files do not say it.
    pub rate: Option<f64>,
    /// Channel of the force in the traces; without traces the force files, instead of a list.
    #[serde(deserialize_with = "one_or_more")]
    pub force: Vec<String>,
    /// Channel of the response, or several, each a sweep of its own; without traces the response files.
    #[serde(deserialize_with = "one_or_more")]
    pub response: Vec<String>,
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
    /// Number of integrations by the analyser before it stored. Default 1 for a displacement.
    pub analyser_integrated: Option<u8>,
}

impl Keys {
    /// Checks that the keys are complete and do not contradict each other.
    fn usable(&self) -> Result<()> {
        let wrong = |key, found: &str, expected: &str| Err(Error::usage(found, expected).setting(key));
        if self.name.is_empty() {
            return Err(Error::usage("the key `name` is missing", "").hint("add name = …"));
        }
        if !self.traces.is_empty() {
            return self.usable_traces();
        }
        let lists_files = !self.response.is_empty();
        if self.list.is_some() == lists_files {
            let found = if lists_files { "both a list and response" } else { "neither a list nor response" };
            let expected = "list = \"…\"; or force, response, lines and base_band; or traces, with a channel of force and of response";
            return wrong("name", &format!("{found} files"), expected);
        }
        if self.list.is_some() && (self.lines.is_some() || self.base_band.is_some()) {
            let found = "lines or base_band beside a list, which states both";
            return wrong("list", found, "one of them: correct the list, or leave the keys out");
        }
        let band = self.base_band.is_some_and(|b| b.is_finite() && b > 0.0);
        let complete = band && self.lines.is_some_and(|l| l > 0) && self.force.len() == self.response.len();
        if lists_files && !complete {
            let stated = |value: Option<f64>| value.map_or_else(|| "left out".to_owned(), |v| v.to_string());
            let (force, response) = (self.force.len(), self.response.len());
            let (lines, band) = (stated(self.lines.map(|n| n as f64)), stated(self.base_band));
            let found =
                format!("{force} force and {response} response files, lines {lines}, base_band {band}");
            return wrong("name", &found, "as many force as response files, and both numbers above 0");
        }
        self.checked()
    }

    /// As [`Keys::usable`], for a sweep of time traces.
    fn usable_traces(&self) -> Result<()> {
        let wrong = |key, found: &str, expected: &str| Err(Error::usage(found, expected).setting(key));
        let beside = [
            ("list", self.list.is_some()),
            ("lines", self.lines.is_some()),
            ("base_band", self.base_band.is_some()),
            ("window", self.window.is_some()),
            ("scaling", self.scaling.is_some()),
            ("analyser_integrated", self.analyser_integrated.is_some()),
        ];
        if let Some((key, _)) = beside.iter().find(|(_, given)| *given) {
            return wrong(key, &format!("{key} beside traces"), "traces alone: they are no spectra");
        }
        let (force, response) = (self.force.len(), self.response.len());
        let pairs = force > 1 && force == response && self.traces.len() == 1;
        if response == 0 || force != 1 && !pairs {
            let found = format!("traces with {force} channels of force and {response} of response");
            let expected = "force = CHANNEL and response = CHANNEL; of one file a channel of each a step";
            return wrong(if response == 0 { "name" } else { "force" }, &found, expected);
        }
        if self.mass.is_some() && response > 1 && !pairs {
            return wrong("mass", "one mass for several responses", "a table [[sweep]] for each mass");
        }
        self.checked()
    }

    /// One sweep for each response in the same traces.
    fn per_response(&self) -> Vec<Keys> {
        if self.traces.is_empty() || self.force.len() > 1 || self.response.len() < 2 {
            return vec![self.clone()];
        }
        let with_response = |channel: &String| Keys {
            name: format!("{} {channel}", self.name),
            response: vec![channel.clone()],
            ..self.clone()
        };
        self.response.iter().map(with_response).collect()
    }

    /// Checks the mass and the settings of the reader.
    fn checked(&self) -> Result<()> {
        if let Some(mass) = self.mass.filter(|m| !matches!(m, 1 | 2)) {
            let found = format!("mass = {mass}");
            return Err(Error::usage(found, "1 (excited) or 2 (passive)").setting("mass"));
        }
        self.reader().map(drop)
    }

    /// The reader for the files of this sweep.
    ///
    /// # Errors
    /// If a stated value is impossible.
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
        let stored = StoredResponseKeys {
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

/// The sweep `name` of a campaign; of its only sweep where `name` is `None`.
///
/// # Errors
/// If there is no such sweep, or its list cannot be read.
pub fn named(campaign: &Campaign, name: Option<&str>) -> Result<Listed> {
    let all = per_response(entries(campaign)?);
    // A faulty table gives its own error.
    let is_meant = |fault: &Fault| name.map_or(all.is_empty(), |name| fault.name == name);
    if let Some(fault) = check::<Keys>(campaign)?.into_iter().find(is_meant) {
        return Err(fault.error);
    }
    let names = || all.iter().map(|s| s.keys.name.as_str()).collect::<Vec<_>>().join(", ");
    let none = |found: String| Error::input(Place::file(campaign.path()), found, names());
    let entry = match (name, all.as_slice()) {
        (Some(name), all) => all.iter().find(|s| s.keys.name == name).ok_or_else(|| {
            let error = none(format!("no sweep is named {name:?}"));
            match nearest(name, all.iter().map(|s| s.keys.name.as_str())) {
                Some(near) => error.hint(format!("{}#{near}", shown(campaign.path()))),
                None => error,
            }
        })?,
        (None, [only]) => only,
        (None, all) => {
            let error = none(format!("{} sweeps and none was chosen", all.len()));
            let path = campaign.path();
            let files = || "name the files of one sweep, by a pattern such as up*.csv".to_owned();
            return Err(error.hint(if campaign.is_file() {
                format!("name one: {}#NAME", shown(path))
            } else {
                files()
            }));
        }
    };
    Listed::of(campaign, entry)
}

/// The tables of sweeps, one for each response.
fn per_response(entries: Vec<Entry<Keys>>) -> Vec<Entry<Keys>> {
    let parts_of = |entry: Entry<Keys>| {
        let parts = entry.keys.per_response().into_iter();
        parts.map(move |keys| {
            let mut part = entry.clone();
            part.keys = keys;
            part
        })
    };
    entries.into_iter().flat_map(parts_of).collect()
}

/// Responses of all sweeps of a campaign, converted to displacement, with named resonances.
///
/// # Errors
/// If a list or a spectrum cannot be read, or an excitation cannot be found.
pub fn responses(campaign: &Campaign, progress: &dyn Progress) -> Result<Vec<Response>> {
    let taken: Result<Vec<SweptResponse>> = read_responses(campaign, all_entries(campaign)?, progress)
        .into_iter()
        .map(|(_, taken)| taken)
        .collect();
    let mut responses: Vec<Response> = taken?.into_iter().map(|(_, response, _)| response).collect();
    pairing::name(&mut responses.iter_mut().collect::<Vec<_>>());
    Ok(responses)
}

/// A sweep, its response, and the settings with which that was found.
type SweptResponse = (Sweep, Response, ResponseOptions);

/// Reads the sweep of each of these tables and its response, with the name of the sweep.
fn read_responses(
    campaign: &Campaign,
    entries: Vec<Entry<Keys>>,
    progress: &dyn Progress,
) -> Vec<(String, Result<SweptResponse>)> {
    let entries = per_response(entries);
    if !entries.is_empty() {
        progress.start("reading sweeps", entries.len());
    }
    let read = |entry: &Entry<Keys>| {
        let listed = Listed::of(campaign, entry)?;
        let compute = &campaign.compute;
        let options = ResponseOptions { band: compute.peak_lines, integrate: None, fmin: compute.fmin };
        let (sweep, response) = listed.sweep_and_response(&options)?;
        progress.step();
        Ok((sweep, response, options))
    };
    entries.par_iter().map(|entry| (entry.keys.name.clone(), read(entry))).collect()
}

/// Findings on responses, each about its sweep.
fn findings_of(responses: &[Response]) -> impl Iterator<Item = About> {
    responses.iter().flat_map(|r| r.findings.iter().map(|f| (r.name.clone(), f.clone())))
}

impl Analysis for Keys {
    const SECTION: &'static str = "sweep";
    const TITLE: &'static str = "Sweeps";
    const FILES: Names = Names::Named(&[
        "response",
        "receptance",
        "force",
        "waterfall",
        "map",
        "overlay",
        "pairs",
        "peaks",
        "fit",
        "fit_points",
    ]);
    const RANGES: &'static [KeyRange] = &[
        KeyRange::above_zero("", &["force_calibration"]),
        KeyRange::count(1e3, &["analyser_integrated"]),
        KeyRange::count(1e9, &["lines"]),
    ];
    const OF_FILES: bool = false;
    const TOGETHER: bool = true;

    fn check(entry: &Entry<Keys>, earlier: &[Entry<Keys>]) -> Result<()> {
        let name = &entry.keys.name;
        if earlier.iter().any(|e| e.keys.name == *name) {
            let expected = "a name of its own for each";
            return Err(Error::usage(format!("two sweeps are named {name:?}"), expected).setting("name"));
        }
        entry.keys.usable()
    }

    fn stated_name(entry: &Entry<Keys>) -> Option<String> {
        Some(entry.keys.name.clone()).filter(|name| !name.is_empty())
    }

    fn channels(&self) -> Vec<(&'static str, &String)> {
        // Without traces these keys name files.
        let of_traces = [("force", &self.force), ("response", &self.response)];
        let all = of_traces.into_iter().flat_map(|(key, names)| names.iter().map(move |name| (key, name)));
        all.filter(|_| !self.traces.is_empty()).collect()
    }

    fn files(campaign: &Campaign, entry: &Entry<Keys>) -> Result<Vec<PathBuf>> {
        let files = match Listed::of(campaign, entry)?.files {
            Files::Spectra(list) => [list.force, list.response].concat(),
            Files::Traces(steps) => steps.files,
        };
        let list = entry.keys.list.as_ref().map(|list| campaign.file(entry, "list", list));
        let files = list.transpose()?.into_iter().chain(files).collect::<Vec<_>>();
        match files.iter().find(|file| !campaign.within().exists(file)) {
            Some(file) => {
                let error = Error::usage(format!("the file {} does not exist", shown(file)), "");
                Err(campaign.fault(entry, error.setting("list").setting("response")))
            }
            None => Ok(files),
        }
    }

    fn measured(campaign: &Campaign, entry: &Entry<Keys>) -> Result<Vec<PathBuf>> {
        Ok(match Listed::of(campaign, entry)?.files {
            Files::Spectra(list) => list.response,
            Files::Traces(steps) => steps.files,
        })
    }

    fn run(entries: &[Entry<Keys>], job: &mut Job<'_>) -> Result<()> {
        let taken = read_responses(job.campaign, entries.to_vec(), job.progress).into_iter();
        let mut taken: Vec<SweptResponse> =
            taken.filter_map(|(name, taken)| job.found(&name, taken)).collect();
        pairing::name(&mut taken.iter_mut().map(|(_, response, _)| response).collect::<Vec<_>>());
        let matrix =
            |(sweep, response, options): SweptResponse| (waterfall(&sweep, &options, &response), response);
        let (matrices, responses): (Vec<Waterfall>, Vec<Response>) =
            taken.into_par_iter().map(matrix).unzip();
        job.answers += responses.len();
        job.put("antiresonance", &pairing::antiresonances(&responses))?;
        job.put("crossings", &pairing::all_crossings(&responses))?;
        let mut all = Answer { findings: pairing::swept_twice(&responses), ..Answer::default() };
        if !responses.is_empty() {
            figures::responses(&mut all, &job.title, &responses);
            all.tables = vec![tables::resonances(&responses), tables::jumps(&responses)];
        }
        job.show("", "", all);
        let agreement = modelled::run(job, &responses)?;
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
            one.evidence.push(response.into());
            one.headlines = vec![tables::named_peaks(response), tables::jumped(response)];
            one.histories.push((response.name.clone(), response.history.clone()));
            one.csv("response", &tables::response(response));
            one.files.push(("waterfall.csv".to_owned(), files::matrix_csv(matrix).into_bytes()));
            shown.push(job.show(&response.name, slug, one));
            job.found.details.push(tables::curve(response));
        }
        job.found.headlines.extend(agreement);
        job.put("responses", &shown)
    }
}
