//! `campaign.toml`: rig, measured files, settings of the instruments, and what to compute.
//!
//! ```toml
//! name = "Two-mass rig on the shaker"
//! out = "results"                 # folder for results, beside this file
//!
//! [rig]                           # keys of a rig file; a missing key takes the thesis rig's value
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

mod drill_model;
mod edit;
mod entry;
mod key_range;
mod locate;
mod meaning;
mod reading;
mod tables;
mod value;

pub use drill_model::DrillModelEntry;
pub use edit::{WrittenKey, WrittenTable};
pub use meaning::KeyMeaning;
pub use tables::{Compute, Drive, FitEntry, Follows, ModelEntry};

pub(crate) use entry::Entry;
pub(crate) use key_range::KeyRange;
#[cfg(test)]
pub(crate) use key_range::SHARED;
pub use reading::Reading;
pub(crate) use reading::{Channel, above_zero};
pub(crate) use value::{LowPass, channel, channels, one_or_more, two, word};

use crate::error::{Error, Place, Result};
use crate::model::drill::MachineDraft;
use crate::model::{ContactKeys, Parameter, Rig, Scene, Uncertainty};
use crate::read::Folder;
use crate::record::{Finding, shown};
use serde::Deserialize;
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The table of curved springs, which only a rig's own file may have.
const SPRINGS: &str = "springs";

/// Folder for results where the file names no folder.
const RESULTS: &str = "results";

/// The part of a campaign file that applies to all records. [`crate::analysis`] reads the tables of records.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Campaign {
    /// Title of the report.
    pub name: String,
    /// Command that makes the recordings, shown where one is missing.
    pub made_by: Option<String>,
    /// Folder for results, relative to the campaign file. Default `results`.
    pub out: Option<PathBuf>,
    /// The rig; needed for an overlay.
    pub rig: Option<Rig>,
    /// The excitation of the rig.
    pub excitation: Option<Drive>,
    /// Standard uncertainties of keys of the rig and of the force, from which a Monte Carlo draws.
    pub uncertainty: Option<Uncertainty>,
    /// Contact law of the masses; without it the contact stiffness is unknown.
    pub contact: Option<ContactKeys>,
    /// Model of the overlay's predictions, and its settings.
    pub model: ModelEntry,
    /// Model of the joined bodies of hammer drills.
    pub drill_model: Option<DrillModelEntry>,
    /// Parameters to be fitted to the responses.
    pub fit: FitEntry,
    /// What to compute, and how.
    pub compute: Compute,
    /// Number of tables of records.
    #[serde(skip)]
    sections: usize,
    #[serde(skip)]
    path: PathBuf,
    #[serde(skip)]
    folder: Folder,
    #[serde(skip)]
    text: String,
    #[serde(skip)]
    faults: Arc<Vec<Fault>>,
}

/// A table with an error. It is left out, and the other tables are analysed.
#[derive(Debug)]
pub struct Fault {
    /// Section of the table, such as `sweep`.
    pub(crate) section: &'static str,
    /// Name of the table in messages.
    pub(crate) name: String,
    /// Byte at which the table begins in the text, and the file that it names.
    pub(crate) place: (usize, Option<PathBuf>),
    /// The error, which points at its line.
    pub error: Error,
}

impl Campaign {
    /// Reads a campaign file and checks the tables that apply to all records. `sections` are the names of
    /// the tables of records.
    ///
    /// # Errors
    /// If the file is not TOML, or has an unknown key or an invalid value; each error points at its line.
    pub fn from_path(within: &Folder, path: &Path, sections: &[&str]) -> Result<Campaign> {
        let other = |found: &str, expected: &str| Error::input(Place::file(path), found, expected);
        if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("toml")) || within.is_folder(path) {
            if !within.exists(path) {
                return Err(Error::absent(
                    format!("there is no file or folder {}", shown(path)),
                    Path::new(""),
                    path,
                ));
            }
            return Err(other("not a campaign", "a campaign file, NAME.toml, or a folder of recordings")
                .hint("a list of files goes to `vibro response`; docs/campaign.md shows a campaign"));
        }
        let bytes = within.read(path)?;
        if bytes.trim_ascii().is_empty() {
            let hint = "write what it is to do, e.g. a table [[sweep]] with name, list and quantity, or [[frf]] with file;";
            let hint = format!("{hint} docs/campaign.md lists every key");
            return Err(other("the file is empty", "a campaign").hint(hint));
        }
        let text = String::from_utf8(bytes).map_err(|e| {
            let place = Place::byte(path, e.utf8_error().valid_up_to() as u64);
            Error::input(place, "bytes that are not UTF-8", "text in UTF-8")
                .hint("save the file as UTF-8 in your editor")
        })?;
        Campaign::parse(within, path, text, sections)
    }

    /// Reads the text of a campaign as if it were the file `path`.
    ///
    /// # Errors
    /// As [`Campaign::from_path`].
    pub fn parse(within: &Folder, path: &Path, text: String, sections: &[&str]) -> Result<Campaign> {
        let written = locate::written(&text, sections);
        let complaint = |e: Error| e.in_file(path);
        let table = written.parse().map_err(complaint)?;
        let keys = || table.keys().map(|key| key.get_ref().as_ref());
        if keys().any(Parameter::is_of_rig)
            && keys().all(|key| Parameter::is_of_rig(key) || Scene::TABLES.contains(&key))
        {
            let expected = "a campaign: the rig's keys under [rig], and what was measured, such as [[sweep]]";
            let rig = Error::input(Place::file(path), "this is a rig, not a campaign", expected);
            let hint = format!("`vibro model orbit {}` tells what the rig does", shown(path));
            return Err(rig.hint(format!("{hint}; docs/campaign.md shows a campaign")));
        }
        if let Some((key, springs)) = table.get_key_value(SPRINGS) {
            let values = springs.get_ref().as_table().into_iter().flatten();
            let set = |(key, value): (&Spanned<Cow<'_, str>>, &Spanned<DeValue<'_>>)| {
                format!(" --set {SPRINGS}.{}={}", key.get_ref(), &text[value.span()])
            };
            let springs: String = values.map(set).collect();
            let hint = "take it out; what curvature changes is told by";
            let hint = format!("{hint} `vibro model choose --force 0.5 --frequency 11{springs}`");
            let expected = "straight springs: no model of an overlay has curved ones";
            let error = Error::usage(format!("[{SPRINGS}] in a campaign"), expected).hint(hint);
            return Err(error.in_file(path).excerpt(&text, key.span()));
        }
        let of_records = |key: &str| sections.contains(&key);
        let (records, head): (DeTable<'_>, DeTable<'_>) =
            table.into_iter().partition(|(key, _)| of_records(key.get_ref()));
        let sections = records.len();
        let head: Campaign = written.read(&head, 0..0).map_err(complaint)?;
        let parent = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let (path, folder) = (path.to_owned(), within.at(parent));
        Campaign { sections, path, folder, text, ..head }.checked()
    }

    /// All tables of the file.
    fn table(&self) -> Result<DeTable<'_>> {
        locate::written(&self.text, &[]).parse().map_err(|e| e.in_file(&self.path))
    }

    /// Text of all tables except the sections `left_out`, without comments and blanks.
    ///
    /// # Errors
    /// If the text is not TOML.
    pub(crate) fn stated_without(&self, left_out: impl Fn(&str) -> bool) -> Result<String> {
        let written = locate::written(&self.text, &[]);
        let mut all: toml::Table = written.read(&self.table()?, 0..0)?;
        all.retain(|key, _| !left_out(key));
        Ok(format!("{all:?}"))
    }

    /// Comment above a proposed table that lacks values.
    pub(crate) const FILL_IN: &str =
        "Fill in what is missing and remove the # in front of the table and its keys.";

    /// Code of the finding on a record whose table waits in a comment for a value.
    pub(crate) const WAITING: &str = "table-in-comment";

    /// Findings on proposed tables that are still in comments, and on files that the proposal did not use.
    pub(crate) fn commented(&self) -> Vec<Finding> {
        let lines: Vec<&str> = self.text.lines().collect();
        let comment = |line: &&str| line.strip_prefix('#').map(|text| text.trim_start().to_owned());
        // In a table that is commented out, optional keys begin with `##` and are skipped.
        let below = |i: usize| lines[i..].iter().map_while(comment).filter(|text| !text.starts_with('#'));
        let above = |i: usize, n: usize| comment(lines.get(i.checked_sub(n)?)?);
        // The lines above a refused table: its description, the reason of the refusal, then `FILL_IN`.
        let refused =
            |i: usize| above(i, 1).filter(|text| text == Campaign::FILL_IN).and(above(i, 3)).and(above(i, 2));
        let table = |i: usize| {
            let head = comment(&lines[i])
                .filter(|text| text.starts_with("[[") && text.trim_end().ends_with("]]"))?;
            let row = |row: String| {
                let (key, value) = row.split_once('=')?;
                Some((key.trim().to_owned(), value.split('#').next()?.trim().to_owned()))
            };
            let keys: Vec<(String, String)> = below(i + 1).map_while(row).collect();
            let file = keys.iter().find(|(key, _)| key == "file").map(|(_, name)| name.trim_matches('"'));
            if file.is_some_and(|file| {
                lines.iter().any(|line| !line.starts_with('#') && line.contains(&format!("\"{file}\"")))
            }) {
                return None;
            }
            let lacking = keys.iter().filter(|(_, value)| value.is_empty());
            let lacking: Vec<&str> = lacking.map(|(key, _)| key.as_str()).collect();
            let found = Finding::note(Campaign::WAITING).about(file.unwrap_or(&head));
            // A proposal that is not written to a file has no line numbers.
            let found = if self.is_file() { found.count("line", i + 1) } else { found };
            Some(match refused(i) {
                Some(why) => found.name("why", why.trim_end_matches('.')),
                None if lacking.is_empty() => found,
                None => found.name("keys", lacking.join(", ")),
            })
        };
        let unused = lines.iter().position(|line| *line == "# Not used:");
        let unused = unused.into_iter().flat_map(|i| below(i + 1)).filter_map(|line| {
            let (file, why) = line.split_once(": ")?;
            Some(Finding::note("file-not-used").about(file).name("why", why))
        });
        (0..lines.len()).filter_map(table).chain(unused).collect()
    }

    /// The same campaign without the tables that have errors.
    pub(crate) fn without(self, faults: Vec<Fault>) -> Campaign {
        Campaign { faults: Arc::new(faults), ..self }
    }

    /// The tables with errors.
    pub fn faults(&self) -> &[Fault] {
        &self.faults
    }

    /// Text of the campaign file.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The campaign file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Folder of the campaign file, to which file names are relative.
    pub fn folder(&self) -> &Path {
        self.folder.root()
    }

    /// The same folder with its access rule: whether file names may lead outside it.
    pub fn within(&self) -> &Folder {
        &self.folder
    }

    /// Whether the campaign exists as a file; otherwise it is a proposal.
    pub fn is_file(&self) -> bool {
        self.folder.is_file(&self.path)
    }

    /// Folder for results.
    pub fn out(&self) -> PathBuf {
        let out = self.folder().join(self.out.as_deref().unwrap_or(Path::new(RESULTS)));
        // Collecting the components drops `.` between them.
        out.components().collect()
    }

    /// Whether the campaign has no table of records.
    pub fn is_empty(&self) -> bool {
        self.sections == 0
    }

    /// The campaign with the stiffness of its contact, if its head has no impossible value.
    fn checked(mut self) -> Result<Campaign> {
        let at = |table: &str, key: &str, error: Error| {
            let all = self.table().unwrap_or_default();
            let found = locate::find(table_of(&all, table).unwrap_or(&all), key);
            self.pointed(error, found.unwrap_or(0..0))
        };
        if let Some((key, error)) = self.rig.as_ref().and_then(Rig::fault) {
            return Err(at("rig", key, error));
        }
        for (parameter, std) in self.uncertainty.iter().flat_map(Uncertainty::all) {
            if !(std.is_finite() && std >= 0.0) {
                let found = format!("the uncertainty of {} is {std}", parameter.name());
                let error = Error::usage(found, "a finite value of 0 or more");
                return Err(at("uncertainty", parameter.name(), error));
            }
        }
        let contact = self.contact.map(ContactKeys::resolved).transpose();
        let contact = contact.map_err(|(key, error)| at("contact", key, error))?;
        let out = self.out.as_deref().unwrap_or(Path::new(RESULTS));
        self.folder.path(out).map_err(|e| at("", "out", e))?;
        let checked =
            [("compute", self.compute.check()), ("model", self.model.check()), ("fit", self.fit.check())];
        for (table, checked) in checked {
            checked.map_err(|(key, why)| at(table, key, Error::usage(why, "")))?;
        }
        if let Some(model) = &self.drill_model {
            model.check().map_err(|(key, error)| at("drill_model", key, error))?;
            self.drill_file(model).map_err(|e| at("drill_model", "file", e))?;
        }
        self.contact = contact;
        Ok(self)
    }

    /// The file of the model of a hammer drill.
    fn drill_file(&self, model: &DrillModelEntry) -> Result<PathBuf> {
        self.existing(self.folder.path(&model.file)?, &model.file)
    }

    /// The keys of the model of a hammer drill.
    ///
    /// # Errors
    /// If its file cannot be read, is none of a drill, or has an impossible value.
    pub(crate) fn drill_draft(&self, model: &DrillModelEntry) -> Result<MachineDraft> {
        let path = self.drill_file(model)?;
        let text = String::from_utf8(self.folder.read(&path)?);
        let text = text.map_err(|_| Error::usage("bytes that are not UTF-8", "a drill as TOML text"));
        let draft = text.and_then(|text| MachineDraft::from_toml(&text));
        let checked = draft.and_then(|draft| draft.machine().map(|_| draft));
        checked.map_err(|error| error.in_file(path))
    }

    /// Rig keys that the file does not state and that take the values of the thesis' rig.
    pub(crate) fn rig_left_out(&self) -> Vec<&'static str> {
        let table = self.table().unwrap_or_default();
        let given = |key: &&str| table_of(&table, "rig").is_none_or(|rig| rig.contains_key(*key));
        Parameter::of_rig().map(Parameter::name).filter(|key| !given(key)).collect()
    }

    /// Path of a file that a table names under a key.
    ///
    /// # Errors
    /// If it leads outside the folder.
    pub(crate) fn path_of<K>(&self, entry: &Entry<K>, key: &'static str, name: &Path) -> Result<PathBuf> {
        self.folder.path(name).map_err(|e| self.fault(entry, e.setting(key)))
    }

    /// Path of an existing file that a table names under a key.
    ///
    /// # Errors
    /// If it leads outside the folder or does not exist.
    pub(crate) fn file<K>(&self, entry: &Entry<K>, key: &'static str, name: &Path) -> Result<PathBuf> {
        let path = self.path_of(entry, key, name)?;
        self.existing(path, name).map_err(|e| self.fault(entry, e.setting(key)))
    }

    /// The path of a file, stated as `name`, if it exists.
    fn existing(&self, path: PathBuf, name: &Path) -> Result<PathBuf> {
        if self.folder.exists(&path) {
            return Ok(path);
        }
        let found = format!("the file {} does not exist", shown(path));
        let error = if self.folder().is_dir() {
            Error::absent(found, self.folder(), name)
        } else {
            let all = self.folder.walk(self.folder.root(), LEVELS).map(|walk| walk.files).unwrap_or_default();
            let root = self.folder.root();
            let name_of = |path: &PathBuf| path.strip_prefix(root).unwrap_or(path).display().to_string();
            Error::absent_among(found, &all.iter().map(name_of).collect::<Vec<_>>(), name)
        };
        Err(match &self.made_by {
            Some(command) => error.hint(format!("`{command}` makes it")),
            None => error,
        })
    }
}

/// Levels of folders in which a name is looked for that was probably meant.
const LEVELS: usize = 8;

/// The table of this name; `None` where the key is missing or is no table.
fn table_of<'a>(all: &'a DeTable<'a>, name: &str) -> Option<&'a DeTable<'a>> {
    all.get(name)?.get_ref().as_table()
}
