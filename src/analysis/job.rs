//! The run of a campaign: measures the records and collects their answers.

use super::answer::{Answer, LEFT_OUT, left_out, unwritten};
use super::headline::of_record;
use super::kept::{AnswerCache, digest};
use super::kind::{Analysis, AnalysisKind, name_of};
use super::progress::Progress;
use super::source::{Source, file_name};
use crate::campaign::{Campaign, Entry};
use crate::error::{Error, Result};
use crate::read::Digest;
use crate::report::files::{self, Names};
use crate::report::words::{About, Voice, put};
use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// The run of a campaign. Analyses read their settings from it and add their answers to it.
pub struct Job<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// Answers of the last run.
    kept: &'a AnswerCache,
    /// All kinds of records.
    kinds: &'static [AnalysisKind],
    /// Receives the progress of the run.
    pub progress: &'a dyn Progress,
    /// Title of the report.
    pub title: String,
    /// All answers together; long tables, such as response curves, are in its `details`.
    pub(super) found: Answer,
    /// Number of records with an answer.
    pub(super) answers: usize,
    /// Number of answers taken from those kept of the last run.
    pub(super) again: usize,
    /// First error of a record other than a refusal, such as a file that cannot be read.
    pub(super) failed: Option<Error>,
}

impl<'a> Job<'a> {
    /// A run without answers yet.
    pub(super) fn new(
        campaign: &'a Campaign,
        kept: &'a AnswerCache,
        kinds: &'static [AnalysisKind],
        progress: &'a dyn Progress,
    ) -> Job<'a> {
        let title = if campaign.name.is_empty() { "Campaign".to_owned() } else { campaign.name.clone() };
        let (found, answers, again, failed) = (Answer::default(), 0, 0, None);
        Job { campaign, kept, kinds, progress, title, found, answers, again, failed }
    }

    /// The result of a record. On an error `None`, with a finding that this record is left out: the other
    /// records are still measured.
    pub fn found<T>(&mut self, record: &str, found: Result<T>) -> Option<T> {
        found.map_err(|error| self.leave_out(record, error)).ok()
    }

    /// Adds a finding that a record is left out, and keeps the first error that is no refusal.
    fn leave_out(&mut self, record: &str, error: Error) {
        self.found.add(record, [left_out(LEFT_OUT, &error)]);
        if error.refusal().is_none() {
            self.failed.get_or_insert(error);
        }
    }

    /// Puts a value under a key of the results.
    ///
    /// # Errors
    /// If it cannot be written as JSON.
    pub fn put(&mut self, key: &str, value: &impl Serialize) -> Result<()> {
        self.found.result.insert(key.to_owned(), serde_json::to_value(value).map_err(unwritten)?);
        Ok(())
    }

    /// Adds the answers of records to the list of their kind. The mark of a record is appended to the names
    /// of its figures and files.
    pub fn answer(&mut self, kind: &str, records: Vec<AnsweredRecord>) {
        self.answers += records.len();
        let mut list = Vec::new();
        for AnsweredRecord { name, file, mark, answer } in records {
            let result = self.show(&name, &mark, answer);
            let mut object = Map::new();
            object.insert("name".to_owned(), Value::String(name));
            object.insert(if file.is_array() { "files" } else { "file" }.to_owned(), file);
            for (key, value) in result {
                object.entry(key).or_insert(value);
            }
            list.push(Value::Object(object));
        }
        self.found.result.insert(kind.to_owned(), Value::Array(list));
    }

    /// Adds an answer to the report and returns its result values. `mark` is appended to the names of figures
    /// and files.
    pub(super) fn show(&mut self, name: &str, mark: &str, answer: Answer) -> Map<String, Value> {
        let Answer {
            mut result,
            findings,
            headlines,
            tables,
            figures,
            files,
            histories,
            compared,
            evidence,
            bodies,
            ..
        } = answer;
        let of_record = |headline| of_record(headline, name, findings.iter().map(|(_, finding)| finding));
        let headlines = headlines.into_iter().map(of_record).collect();
        put(&mut result, &findings, Voice::Campaign);
        let with_record =
            |(record, finding): About| (if record.is_empty() { name.to_owned() } else { record }, finding);
        let marked = |name: String| match name.rsplit_once('.') {
            _ if mark.is_empty() => name,
            Some((stem, ending)) => format!("{stem}_{mark}.{ending}"),
            None => format!("{name}_{mark}"),
        };
        self.found.append(Answer {
            findings: findings.into_iter().map(with_record).collect(),
            headlines,
            tables,
            histories,
            compared,
            evidence,
            bodies,
            figures: figures.into_iter().map(|(name, figure)| (marked(name), figure)).collect(),
            files: files.into_iter().map(|(name, bytes)| (marked(name), bytes)).collect(),
            ..Answer::default()
        });
        result
    }

    /// Measures a section as a whole, or takes its answer from the last run. A section that fails is left
    /// out, and the others are measured.
    ///
    /// # Errors
    /// If a file cannot be found.
    pub(super) fn together(
        &mut self,
        section: &str,
        measure: impl FnOnce(&mut Job<'_>) -> Result<()>,
    ) -> Result<()> {
        let (inputs, files) = self.inputs_of(&[section])?;
        // What is said of each record where none has an answer.
        let mut said = Answer::default();
        let answered = self.kept.or_make(inputs, &files, || {
            let mut job = Job::new(self.campaign, self.kept, self.kinds, self.progress);
            measure(&mut job)?;
            match job.failed {
                Some(error) if job.answers == 0 => {
                    said = job.found;
                    Err(error)
                }
                _ => Ok((job.found, job.answers)),
            }
        });
        let (all, answers) = match answered {
            Ok(found) => found,
            Err(error) if said.findings.is_empty() => {
                self.leave_out(section, error);
                return Ok(());
            }
            Err(error) => {
                self.found.append(said);
                self.failed.get_or_insert(error);
                return Ok(());
            }
        };
        if self.kept.is_old(&inputs) {
            self.again += answers;
        }
        self.found.append(all);
        self.answers += answers;
        Ok(())
    }

    /// Digest of all inputs of these sections, and their files. Inputs are the files and all tables of the
    /// campaign except those of other kinds of record.
    fn inputs_of(&self, sections: &[&str]) -> Result<(Digest, Vec<PathBuf>)> {
        let (these, others): (Vec<&AnalysisKind>, Vec<&AnalysisKind>) =
            self.kinds.iter().partition(|kind| sections.contains(&kind.section));
        let files: Result<Vec<_>> = these.iter().map(|kind| (kind.files)(self.campaign)).collect();
        let stated = self.campaign.stated_without(|key| others.iter().any(|kind| kind.section == key))?;
        let files = files?.concat();
        Ok((self.digest([sections.concat(), stated], &files), files))
    }

    /// Digest of texts (section, name, keys), and of names and contents of files. A file that cannot be read
    /// counts by name only.
    fn digest(&self, words: impl IntoIterator<Item = String>, files: &[PathBuf]) -> Digest {
        let words = words.into_iter().map(String::into_bytes);
        let of_file = |file: &PathBuf| {
            let name = file.strip_prefix(self.campaign.folder()).unwrap_or(file);
            [name.to_string_lossy().as_bytes(), &self.kept.file(file).unwrap_or_default()].concat()
        };
        let files: Vec<Vec<u8>> = files.par_iter().map(of_file).collect();
        digest(words.chain(files))
    }

    /// Measures the record of each table separately. A record whose file is missing or cannot be read is left
    /// out, and the others are measured.
    ///
    /// # Errors
    /// If the campaign cannot be read.
    pub fn each<K: Analysis>(
        &mut self,
        kind: &str,
        entries: &[Entry<K>],
        measure: impl Fn(&Entry<K>, &Source<'_>) -> Result<Vec<Answer>>,
    ) -> Result<()> {
        let mut records: Vec<AnsweredRecord> = Vec::new();
        for entry in entries {
            let name = name_of(entry);
            let Some(mut files) = self.found(&name, K::files(self.campaign, entry)) else { continue };
            // A table may state numbers instead of a file.
            let path = files.first().filter(|_| entry.file.is_some()).cloned().unwrap_or_default();
            let table = [K::SECTION.to_owned(), name.clone(), self.campaign.stated_in(entry)];
            let mut inputs = self.digest(table, &files);
            if entry.file.is_none() && !K::RESTS_ON.is_empty() {
                let (others, other_files) = self.inputs_of(K::RESTS_ON)?;
                (inputs, files) = (digest([inputs, others]), other_files);
            }
            let found = self.kept.or_make(inputs, &files, || {
                match self.measured(entry, &name, &path, |source| measure(entry, source)) {
                    Err(error) if error.refusal().is_some() => Ok(Err(left_out(LEFT_OUT, &error))),
                    found => found.map(Ok),
                }
            });
            let found = match self.found(&name, found) {
                Some(Ok(found)) => found,
                Some(Err(left_out)) => {
                    self.found.add(&name, [left_out]);
                    Vec::new()
                }
                None => Vec::new(),
            };
            if self.kept.is_old(&inputs) {
                self.again += found.len();
            }
            for answer in found {
                let file = Value::String(file_name(&path));
                records.push(AnsweredRecord { name: name.clone(), file, mark: String::new(), answer });
            }
        }
        let marks = match K::FILES {
            Names::Named(_) => files::slugs(records.iter().map(|r| r.name.as_str())),
            Names::Numbered(_) => (1..=records.len()).map(|n| n.to_string()).collect(),
        };
        for (record, mark) in records.iter_mut().zip(marks) {
            record.mark = mark;
        }
        self.answer(kind, records);
        Ok(())
    }

    /// The file of a table.
    ///
    /// # Errors
    /// If it leads outside the folder or does not exist.
    pub fn path<K>(&self, entry: &Entry<K>) -> Result<PathBuf> {
        let file = entry.file.as_deref().unwrap_or(Path::new(""));
        self.campaign.file(entry, "file", file)
    }

    /// Measures the file of a table. Progress counts the samples that are read.
    ///
    /// # Errors
    /// As `measure`.
    pub fn measured<K, T>(
        &self,
        entry: &Entry<K>,
        name: &str,
        path: &Path,
        measure: impl FnOnce(&Source<'_>) -> Result<T>,
    ) -> Result<T> {
        self.progress.start(name, 0);
        let beside = |key: &'static str, file: &Path| self.campaign.file(entry, key, file);
        measure(&Source {
            name,
            path,
            folder: self.campaign.within(),
            channel: &entry.channel,
            reading: &entry.reading,
            beside: &beside,
            progress: self.progress,
        })
    }
}

/// The answer of a record.
#[derive(Debug)]
pub struct AnsweredRecord {
    /// Name of the record in the report.
    pub name: String,
    /// The file, or a list of files.
    pub file: Value,
    /// Suffix of the names of its figures and files.
    pub mark: String,
    /// The answer.
    pub answer: Answer,
}
