//! The files that a `[[sweep]]` table names, before they are read.

use super::{Keys, order};
use crate::analysis::recordings::matching;
use crate::campaign::{Campaign, Entry};
use crate::error::{Error, Result};
use crate::measure::response::{Response, ResponseOptions, answerable, response};
use crate::measure::stepped::stepped;
use crate::read::{Steps, SweepList, SweepReader};
use crate::record::{Axis, Finding, Sweep, doubt_with_record};
use std::path::{Path, PathBuf};

/// The files of a sweep, with the reader for them.
#[derive(Debug, Clone)]
pub struct Listed {
    /// Its files.
    pub files: Files,
    /// Reader with the settings of the sweep.
    pub reader: SweepReader,
    /// Findings from before the files are read.
    pub findings: Vec<Finding>,
}

/// Files of a sweep, by their content.
#[derive(Debug, Clone)]
pub enum Files {
    /// One spectrum a file.
    Spectra(SweepList),
    /// Time traces of force and response.
    Traces(Steps),
}

impl Listed {
    /// The files that a `[[sweep]]` table names.
    ///
    /// # Errors
    /// If its list cannot be read, a name leads outside the folder, or no file matches a pattern.
    pub fn of(campaign: &Campaign, entry: &Entry<Keys>) -> Result<Listed> {
        let keys = &entry.keys;
        let path = |key: &'static str, name: &String| campaign.path_of(entry, key, Path::new(name));
        let paths = |key: &'static str, names: &[String]| {
            names.iter().map(|name| path(key, name)).collect::<Result<Vec<_>>>()
        };
        let files = if let Some(list) = &keys.list {
            let list = campaign.file(entry, "list", list)?;
            Files::Spectra(SweepList::from_path(list, campaign.within())?)
        } else if keys.traces.is_empty() {
            // Without traces, `force` and `response` are names of spectrum files.
            Files::Spectra(SweepList {
                lines: keys.lines.unwrap_or(0),
                base_band: keys.base_band.unwrap_or(0.0),
                force: paths("force", &keys.force)?,
                excitation: Vec::new(),
                response: paths("response", &keys.response)?,
                places: Vec::new(),
            })
        } else {
            let (within, folder) = (campaign.within(), campaign.folder());
            let matches = |path: &PathBuf| matching(within, path.strip_prefix(folder).unwrap_or(path));
            let found: Result<Vec<Vec<PathBuf>>> =
                paths("traces", &keys.traces)?.iter().map(matches).collect();
            let files = found.map_err(|e| campaign.fault(entry, e.setting("traces")))?.concat();
            let files = files.iter().map(|name| folder.join(name)).collect();
            // With traces, `force` and `response` are channels.
            let (force, response) = (keys.force.clone(), keys.response.clone());
            Files::Traces(Steps { files, force, response, rate: keys.rate })
        };
        let reader = SweepReader { folder: campaign.within().clone(), ..keys.reader()? };
        Ok(Listed { files, reader, findings: Vec::new() })
    }

    /// The spectra of the sweep.
    ///
    /// # Errors
    /// If one cannot be read, or the sweep consists of time traces.
    pub fn spectra(&self) -> Result<(&SweepList, Sweep)> {
        match &self.files {
            Files::Spectra(list) => Ok((list, self.reader.read(list)?)),
            Files::Traces(_) => Err(Error::usage("a sweep of time traces", "a list of spectra")
                .setting("legacy")
                .setting("write_lists")),
        }
    }

    /// The sweep as spectra, and its response.
    ///
    /// # Errors
    /// If a file cannot be read, or holds no response.
    pub fn sweep_and_response(&self, options: &ResponseOptions) -> Result<(Sweep, Response)> {
        match &self.files {
            Files::Spectra(list) => {
                let sweep = answerable(self.reader.read(list)?, options)?;
                let mut response = response(&sweep, options)?;
                doubt_with_record(&sweep.findings, &mut response);
                Ok((sweep, response))
            }
            Files::Traces(steps) => {
                let (mut sweep, mut response) = self.stepped(steps, options)?;
                // Channels of a single file stay in the order in which they are named.
                let sorted = order::sorted(&sweep, &response, &steps.files).filter(|_| steps.files.len() > 1);
                if let Some(files) = sorted {
                    let found = Finding::caution("sweep-sorted").count("n", response.points.len());
                    (sweep, response) = self.stepped(&Steps { files, ..steps.clone() }, options)?;
                    response.findings.push(found);
                }
                doubt_with_record(&sweep.findings, &mut response);
                response.findings.extend(order::repeated(&sweep, &response));
                response.findings.extend(self.findings.iter().cloned());
                Ok((sweep, response))
            }
        }
    }

    /// The sweep and its response from time traces, in the order of the files.
    fn stepped(&self, steps: &Steps, options: &ResponseOptions) -> Result<(Sweep, Response)> {
        let SweepReader { name, direction, mass, .. } = self.reader.clone();
        let (axis, points, findings) = (Axis::index(0), Vec::new(), Vec::new());
        let named = Sweep { name, direction, mass, axis, analyser_integrated: 0, points, findings };
        stepped(named, self.reader.steps(steps)?, options)
    }
}
