//! `campaign.toml`: rig, files, what the instruments stored, what to compute.
//!
//! ```toml
//! name = "Two-mass rig on the shaker"
//! out = "results"                 # folder for results, beside this file
//!
//! [rig]                           # keys of a rig file; what is left out is the thesis' rig
//! gap = 1e-3
//! restitution = 0.97
//!
//! [excitation]
//! kind = "sine"
//! force = 0.1                     # N; left out: the measured force
//!
//! [[sweep]]
//! name = "mass 1, up"
//! direction = "up"
//! mass = 1
//! list = "UP1.TXT"                # or force = [...], response = [...], lines = 400, base_band = 20
//! quantity = "velocity"           # what the analyser stored
//! window = "hann"
//! scaling = "peak"
//! analyser_integrated = 1
//!
//! [[frf]]
//! file = "hammer_test.uff"
//! ```
//! An unknown key is an error that points at its line.

mod channel;
mod contact;
mod drill;
mod drop;
mod entry;
mod fault;
mod fit;
mod locate;
mod low_pass;
mod parameter;
mod prediction;
mod record;
mod rig_file;
mod spectral;

pub use entry::{Compute, Drive, SweepEntry};
pub use fit::FitEntry;
pub use low_pass::{LowPass, Word};
pub use parameter::Parameter;
pub use prediction::{Follows, ModelEntry};
pub use record::{
    Decimal, Detrend, DrillEntry, DropEntry, FrfEntry, ImpactsEntry, PulseEntry, RecordEntry, SpectrumEntry,
};

use crate::error::{Error, Place, Result};
use crate::model::{ContactKeys, Rig};
use crate::read::{Recording, SweepList, SweepReader, inside};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Folder for results where none is named.
const RESULTS: &str = "results";

/// A campaign as its file has it.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Campaign {
    /// Title of the report.
    pub name: String,
    /// Folder for results, relative to the campaign file. Default `results`.
    pub out: Option<PathBuf>,
    /// The rig; needed for an overlay.
    pub rig: Option<Rig>,
    /// What drives it.
    pub excitation: Option<Drive>,
    /// Stepped-sine sweeps.
    pub sweep: Vec<SweepEntry>,
    /// Spectra of time records.
    pub spectrum: Vec<SpectrumEntry>,
    /// Frequency response functions.
    pub frf: Vec<FrfEntry>,
    /// Impact traces.
    pub impacts: Vec<ImpactsEntry>,
    /// Drop tests.
    pub drop: Vec<DropEntry>,
    /// Contact pulses.
    pub pulse: Vec<PulseEntry>,
    /// Hammer-drill traces.
    pub drill: Vec<DrillEntry>,
    /// How the masses' contact gives way; left out, its stiffness is not known.
    pub contact: Option<ContactKeys>,
    /// How the overlay's predictions are made.
    pub model: ModelEntry,
    /// Parameters to be found from the responses.
    pub fit: FitEntry,
    /// What to compute, and how.
    pub compute: Compute,
    #[serde(skip)]
    path: PathBuf,
    #[serde(skip)]
    text: String,
}

impl Campaign {
    /// Reads and checks a campaign file.
    ///
    /// # Errors
    /// If it is not TOML, has an unknown key, or a value that cannot be; each points at its line.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Campaign> {
        let path = path.as_ref();
        let toml = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        if !toml || path.is_dir() {
            return Err(Error::input(Place::file(path), "not a campaign", "a campaign file, NAME.toml")
                .hint("a list of files goes to `vibro response`; the README shows a campaign.toml"));
        }
        let bytes = std::fs::read(path).map_err(|e| Error::io("open", path, e))?;
        if bytes.trim_ascii().is_empty() {
            return Err(Error::input(Place::file(path), "the file is empty", "a campaign").hint(
                "write what it is to do, e.g. a table [[sweep]] with name, list and quantity, or [[frf]] with file; docs/campaign.md lists every key",
            ));
        }
        let text = String::from_utf8(bytes).map_err(|e| {
            Error::input(
                Place::byte(path, e.utf8_error().valid_up_to() as u64),
                "bytes that are not UTF-8",
                "text in UTF-8",
            )
            .hint("save the file as UTF-8 in your editor")
        })?;
        Campaign::parse(path, text)
    }

    fn parse(path: &Path, text: String) -> Result<Campaign> {
        let mut campaign: Campaign = toml::from_str(&text).map_err(|e| {
            rig_file::complaint(path, &text).unwrap_or_else(|| locate::toml_error(path, &text, &e))
        })?;
        path.clone_into(&mut campaign.path);
        campaign.text = text;
        campaign.check()?;
        Ok(campaign)
    }

    /// The campaign file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Folder of the campaign file, to which its names are relative.
    pub fn folder(&self) -> &Path {
        self.path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
    }

    /// Folder for results.
    pub fn out(&self) -> PathBuf {
        self.folder().join(self.out.as_deref().unwrap_or(Path::new(RESULTS)))
    }

    fn check(&self) -> Result<()> {
        if let Some((key, error)) = self.rig.as_ref().and_then(Rig::fault) {
            let span = locate::find(&self.text, key, self.text.find("[rig]"));
            return Err(error.in_file(&self.path).excerpt(&self.text, span));
        }
        let out = self.out.as_deref().unwrap_or(Path::new(RESULTS));
        inside(self.folder(), out, false).map_err(|_| {
            self.at(
                locate::find(&self.text, "out", None),
                format!("out = {} leads outside this folder", out.display()),
            )
            .hint("name a folder beside the campaign, or give --out on the command line")
        })?;
        self.compute.check().map_err(|(key, why)| {
            let from = self.text.find("[compute]");
            self.at(locate::find(&self.text, key, from), why)
        })?;
        self.model.check().map_err(|(key, why)| {
            let from = self.text.find("[model]");
            self.at(locate::find(&self.text, key, from), why)
        })?;
        self.fit.check().map_err(|(key, why)| {
            let from = self.text.find("[fit");
            self.at(locate::find(&self.text, key, from), why)
        })?;
        for entry in self.records() {
            entry.check().map_err(|why| self.at(entry.file.span(), why))?;
        }
        let spectra = self.spectrum.iter().map(|e| (e.record().file.span(), e.options().map(drop)));
        let functions = self.frf.iter().map(|e| (e.record().file.span(), e.options().map(drop)));
        for (span, checked) in spectra.chain(functions) {
            checked.map_err(|why| self.at(self.key_named(span, &why), why))?;
        }
        self.check_contacts()?;
        let mut seen: Vec<&str> = Vec::new();
        for entry in &self.sweep {
            let name = entry.name.get_ref();
            if seen.contains(&name.as_str()) {
                return Err(self.at(entry.name.span(), format!("two sweeps are named {name:?}")));
            }
            seen.push(name);
            entry.check().map_err(|why| self.at(why.span, why.found).hint(why.hint))?;
        }
        Ok(())
    }

    /// Whether no entry asks for anything.
    pub fn is_empty(&self) -> bool {
        self.sweep.is_empty()
            && self.drop.is_empty()
            && self.pulse.is_empty()
            && self.records().next().is_none()
    }

    /// The common keys of all entries of files.
    pub fn records(&self) -> impl Iterator<Item = RecordEntry> {
        let frf = self.frf.iter().map(FrfEntry::record);
        let impacts = self.impacts.iter().map(ImpactsEntry::record);
        let drop = self.drop.iter().filter_map(DropEntry::record);
        let pulse = self.pulse.iter().filter_map(PulseEntry::record);
        let drill = self.drill.iter().map(DrillEntry::record);
        let spectrum = self.spectrum.iter().map(SpectrumEntry::record);
        spectrum.chain(frf).chain(impacts).chain(drop).chain(pulse).chain(drill)
    }

    /// A sentence that names the keys of the rig that are not given and were taken from the thesis' rig; `None` where
    /// all are given.
    pub fn rig_left_out(&self) -> Option<String> {
        let table = toml::from_str::<toml::Table>(&self.text).ok()?;
        let rig = table.get("rig")?.as_table()?;
        let missing: Vec<&str> = Rig::KEYS.into_iter().filter(|k| !rig.contains_key(*k)).collect();
        (!missing.is_empty()).then(|| {
            format!("[rig] does not give {}: the values of the thesis' rig are used.", missing.join(", "))
        })
    }

    /// Where the key that a complaint begins with stands in the section of `span`; `span` where it does not.
    fn key_named(&self, span: std::ops::Range<usize>, why: &str) -> std::ops::Range<usize> {
        let (before, behind) = (self.text.get(..span.start), self.text.get(span.end..));
        let from = before.and_then(|t| t.rfind("[[")).unwrap_or(0);
        let to = behind.and_then(|t| t.find("\n[")).map_or(self.text.len(), |n| span.end + n);
        let key = why.split(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or_default();
        let found = if key.is_empty() { 0..0 } else { locate::find(&self.text, key, Some(from)) };
        if found.is_empty() || found.end > to { span } else { found }
    }

    /// An error that points into this file.
    pub(crate) fn at(&self, span: std::ops::Range<usize>, found: String) -> Error {
        Error::input(Place::file(&self.path), found, "").excerpt(&self.text, span)
    }

    /// List and reader of the sweep `name`; of the only sweep where `name` is `None`.
    ///
    /// # Errors
    /// If there is no such sweep, or its list cannot be read.
    pub fn sweep(&self, name: Option<&str>, allow_outside: bool) -> Result<(SweepList, SweepReader)> {
        let names = || self.sweep.iter().map(|s| s.name.get_ref().as_str()).collect::<Vec<_>>().join(", ");
        let entry = match (name, self.sweep.as_slice()) {
            (Some(name), all) => all.iter().find(|s| s.name.get_ref() == name).ok_or_else(|| {
                Error::input(Place::file(&self.path), format!("no sweep is named {name:?}"), names())
            })?,
            (None, [only]) => only,
            (None, all) => {
                return Err(Error::input(
                    Place::file(&self.path),
                    format!("{} sweeps and none was chosen", all.len()),
                    names(),
                )
                .hint(format!("name one: {}#NAME", self.path.display())));
            }
        };
        Ok((self.list(entry, allow_outside)?, entry.reader()))
    }

    /// The files of a sweep.
    ///
    /// # Errors
    /// If its list cannot be read or a name leads outside the folder.
    pub fn list(&self, entry: &SweepEntry, allow_outside: bool) -> Result<SweepList> {
        let folder = self.folder();
        let place = |path: &Path, span: std::ops::Range<usize>| {
            inside(folder, path, allow_outside).map_err(|e| e.in_file(&self.path).excerpt(&self.text, span))
        };
        if let Some(list) = &entry.list {
            let path = place(list.get_ref(), list.span())?;
            if !path.exists() {
                return Err(self
                    .at(list.span(), format!("the list {} does not exist", path.display()))
                    .hint("names are relative to the folder of the campaign file"));
            }
            return SweepList::from_path(path, allow_outside);
        }
        let all = |names: &[PathBuf]| -> Result<Vec<PathBuf>> {
            names.iter().map(|n| place(n, entry.name.span())).collect()
        };
        Ok(SweepList {
            lines: entry.lines.unwrap_or(0),
            base_band: entry.base_band.unwrap_or(0.0),
            force: all(&entry.force)?,
            excitation: Vec::new(),
            response: all(&entry.response)?,
            places: Vec::new(),
        })
    }

    /// The records of an entry's file.
    ///
    /// # Errors
    /// If it leads outside the folder or cannot be read.
    pub fn recording(&self, entry: &RecordEntry, allow_outside: bool) -> Result<Recording> {
        entry.reader().from_path(self.record_path(entry, allow_outside)?)
    }

    /// Path of a further file that a record entry names.
    ///
    /// # Errors
    /// If it leads outside the folder.
    pub fn beside(&self, entry: &RecordEntry, file: &Path, allow_outside: bool) -> Result<PathBuf> {
        inside(self.folder(), file, allow_outside)
            .map_err(|e| e.in_file(&self.path).excerpt(&self.text, entry.file.span()))
    }

    /// Path of a record entry.
    ///
    /// # Errors
    /// If it leads outside the folder or does not exist.
    pub fn record_path(&self, entry: &RecordEntry, allow_outside: bool) -> Result<PathBuf> {
        let path = self.beside(entry, entry.file.get_ref(), allow_outside)?;
        if !path.exists() {
            return Err(self
                .at(entry.file.span(), format!("the file {} does not exist", path.display()))
                .hint("names are relative to the folder of the campaign file"));
        }
        Ok(path)
    }
}

#[cfg(test)]
mod tests;
