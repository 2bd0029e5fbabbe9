//! All that a campaign asks for, and its files.

use super::answer::{left_out, unwritten};
use super::inputs::inputs;
use super::source::{Source, file_name, name_of};
use super::{Analysis, Answer, KINDS, page};
use crate::campaign::{Campaign, Entry};
use crate::error::Result;
use crate::record::{Fact, Finding, Severity, Step};
use crate::report::words::{About, Voice, graded, put};
use crate::report::{Medium, Output, Table, files};
use serde::Serialize;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// The files of a campaign's results that are not figures or tables of one record.
pub const RESULTS: &str = "results.json";
/// The page.
pub const REPORT: &str = "report.html";
/// Findings and tables, as the terminal shows them.
pub const SUMMARY: &str = "summary.txt";
/// What the results were computed from.
pub const INPUTS: &str = "inputs.sha256";

/// Findings and tables, for a person.
fn summary(all: &Answer) -> String {
    let findings = graded(&all.findings, Voice::Campaign);
    let findings = findings.iter().map(|(severity, sentence)| format!("{}: {sentence}\n", severity.name()));
    let tables: Vec<String> = all.tables.iter().map(Table::text).collect();
    format!("{}\n{}", findings.collect::<String>(), tables.join("\n"))
}

/// Told how far a job is.
pub trait Progress: Sync {
    /// A part with this many steps begins.
    fn start(&self, what: &str, steps: usize);
    /// One step is done.
    fn step(&self);
    /// So many of all steps are done.
    fn at(&self, done: usize, all: usize);
}

/// Nobody is told.
impl Progress for () {
    fn start(&self, _: &str, _: usize) {}
    fn step(&self) {}
    fn at(&self, _: usize, _: usize) {}
}

/// How a job may go about its files.
#[derive(Debug, Clone, Copy, Default)]
pub struct JobOptions {
    /// Allow names that lead outside the campaign's folder.
    pub allow_outside: bool,
}

/// A campaign at work: what its analyses ask, and where they put what they find.
pub struct Job<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// How it may go about its files.
    pub options: JobOptions,
    /// Told how far it is.
    pub progress: &'a dyn Progress,
    /// Title of the report.
    pub title: String,
    /// All answers, long tables as details.
    pub(super) all: Answer,
    /// Values that were assumed.
    pub(super) constants: Vec<(String, String)>,
    /// Steps by the name of their record.
    pub(super) histories: Vec<(String, Vec<Step>)>,
    pub(super) answers: usize,
}

impl<'a> Job<'a> {
    fn new(campaign: &'a Campaign, options: JobOptions, progress: &'a dyn Progress) -> Job<'a> {
        let title = if campaign.name.is_empty() { "Campaign".to_owned() } else { campaign.name.clone() };
        Job {
            campaign,
            options,
            progress,
            title,
            all: Answer::default(),
            constants: Vec::new(),
            histories: Vec::new(),
            answers: 0,
        }
    }

    /// What a record gave; `None` and a finding where it allows no answer.
    ///
    /// # Errors
    /// If something else is wrong than the record.
    pub fn found<T>(&mut self, record: &str, found: Result<T>) -> Result<Option<T>> {
        match found {
            Ok(found) => Ok(Some(found)),
            Err(error) => {
                self.all.add(record, [left_out("left-out", error)?]);
                Ok(None)
            }
        }
    }

    /// Puts a value under a key of the results.
    ///
    /// # Errors
    /// If it cannot be written as JSON.
    pub fn put(&mut self, key: &str, value: &impl Serialize) -> Result<()> {
        self.all.result.insert(key.to_owned(), serde_json::to_value(value).map_err(unwritten)?);
        Ok(())
    }

    /// Adds the answers of records to the list of their kind. Figures and files get the mark of their record behind their name.
    pub fn answer(&mut self, kind: &str, records: Vec<Record>) {
        self.answers += records.len();
        let mut list = Vec::new();
        for Record { name, file, mark, answer } in records {
            let result = self.show(&name, &mark, answer);
            let mut object = Map::new();
            object.insert("name".to_owned(), Value::String(name));
            object.insert(if file.is_array() { "files" } else { "file" }.to_owned(), file);
            for (key, value) in result {
                object.entry(key).or_insert(value);
            }
            list.push(Value::Object(object));
        }
        self.all.result.insert(kind.to_owned(), Value::Array(list));
    }

    /// Shows what an answer has and gives its result; a mark stands behind the names of figures and files.
    pub(super) fn show(&mut self, name: &str, mark: &str, answer: Answer) -> Map<String, Value> {
        let Answer { mut result, findings, tables, figures, files, .. } = answer;
        put(&mut result, &findings, Voice::Campaign);
        let about =
            |(record, finding): About| (if record.is_empty() { name.to_owned() } else { record }, finding);
        self.all.findings.extend(findings.into_iter().map(about));
        for table in tables.into_iter().filter(|t| !t.rows.is_empty()) {
            let same = |t: &&mut Table| t.title == table.title && t.columns == table.columns;
            match self.all.tables.iter_mut().find(same) {
                Some(known) => known.rows.extend(table.rows),
                None => self.all.tables.push(table),
            }
        }
        let marked = |name: String| match name.rsplit_once('.') {
            _ if mark.is_empty() => name,
            Some((stem, ending)) => format!("{stem}_{mark}.{ending}"),
            None => format!("{name}_{mark}"),
        };
        self.all.figures.extend(figures.into_iter().map(|(name, figure)| (marked(name), figure)));
        self.all.files.extend(files.into_iter().map(|(name, bytes)| (marked(name), bytes)));
        result
    }

    /// Measures the record of each table by itself.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub fn each<K: Analysis>(
        &mut self,
        kind: &str,
        entries: &[Entry<K>],
        marks: Marks,
        measure: impl Fn(&Entry<K>, &Source<'_>) -> Result<Vec<Answer>>,
    ) -> Result<()> {
        let mut records: Vec<Record> = Vec::new();
        for (i, entry) in entries.iter().enumerate() {
            let name = name_of(entry, i + 1);
            // Numbers alone have no file.
            let path = entry.file.as_ref().map_or_else(|| Ok(PathBuf::new()), |_| self.path(entry))?;
            let found = self.measured(entry, &name, &path, |source| measure(entry, source));
            for answer in self.found(&name, found)?.unwrap_or_default() {
                let file = Value::String(file_name(&path));
                records.push(Record { name: name.clone(), file, mark: String::new(), answer });
            }
        }
        let marks = match marks {
            Marks::Names => files::slugs(records.iter().map(|r| r.name.as_str())),
            Marks::Numbers => (1..=records.len()).map(|n| n.to_string()).collect(),
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
        self.campaign.file(entry, "file", file, self.options.allow_outside)
    }

    /// Measures the file of a table; the progress is that of its samples.
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
        let beside =
            |key: &'static str, file: &Path| self.campaign.file(entry, key, file, self.options.allow_outside);
        measure(&Source {
            name,
            path,
            channel: &entry.channel,
            reading: &entry.reading,
            beside: &beside,
            progress: self.progress,
        })
    }
}

/// How the files of a kind's records are told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marks {
    /// By their numbers, from 1.
    Numbers,
    /// By their names.
    Names,
}

/// An answer with the record that gave it.
#[derive(Debug)]
pub struct Record {
    /// Name for people.
    pub name: String,
    /// The file, or a list of files.
    pub file: Value,
    /// What stands behind the names of its figures and files.
    pub mark: String,
    /// What was found.
    pub answer: Answer,
}

/// What one kind of record adds to the report.
pub(super) struct Part {
    /// Its heading.
    pub title: &'static str,
    /// How much there was before.
    pub from: Extent,
    /// How much there is behind.
    pub to: Extent,
}

/// How many tables, figures, long tables and findings an answer has.
pub(super) struct Extent {
    pub tables: usize,
    pub figures: usize,
    pub details: usize,
    pub findings: usize,
}

impl Extent {
    fn of(answer: &Answer) -> Extent {
        Extent {
            tables: answer.tables.len(),
            figures: answer.figures.len(),
            details: answer.details.len(),
            findings: answer.findings.len(),
        }
    }
}

/// What the records of a campaign answer.
#[derive(Debug)]
pub struct Heard {
    /// The results.
    pub result: Map<String, Value>,
    /// What is said of them.
    pub findings: Vec<Finding>,
}

impl Heard {
    /// The worst that is said.
    pub fn worst(&self) -> Option<Severity> {
        self.findings.iter().map(|finding| finding.severity).max()
    }
}

/// Measures the records of a campaign without a report; where none answers, the reason.
///
/// # Errors
/// As [`run`].
pub fn answers(campaign: &Campaign, progress: &dyn Progress) -> Result<std::result::Result<Heard, String>> {
    let mut job = Job::new(campaign, JobOptions::default(), progress);
    for kind in KINDS {
        (kind.run)(&mut job)?;
    }
    let findings: Vec<Finding> = job.all.findings.into_iter().map(|(_, finding)| finding).collect();
    if job.answers > 0 {
        return Ok(Ok(Heard { result: job.all.result, findings }));
    }
    let why = findings.iter().find_map(|finding| match finding.fact("why") {
        Some(Fact::Name(why)) => Some(why.clone()),
        _ => None,
    });
    Ok(Err(why.unwrap_or_else(|| "no answer".to_owned())))
}

/// Does all that a campaign asks for, and writes it to `output`. Gives what was found, and whether any record was answered.
///
/// # Errors
/// If a file cannot be read; if the overlay is not possible; if a file cannot be written.
pub fn run(
    campaign: &Campaign,
    options: JobOptions,
    output: &mut Output,
    progress: &dyn Progress,
) -> Result<(Answer, bool)> {
    let mut job = Job::new(campaign, options, progress);
    // Before anything is read: what changes meanwhile is for the next run.
    let inputs = inputs(campaign, options.allow_outside)?;
    let version = env!("CARGO_PKG_VERSION");
    job.put("campaign", &job.title.clone())?;
    job.put("version", &version)?;
    let mut parts = Vec::new();
    for kind in KINDS {
        let from = Extent::of(&job.all);
        (kind.run)(&mut job)?;
        parts.push(Part { title: kind.title, from, to: Extent::of(&job.all) });
    }
    job.all.add("", campaign.commented());
    if campaign.is_empty() {
        job.all.add("", [Finding::caution("campaign-without-record")]);
    } else if job.answers == 0 {
        job.all.add("", [Finding::caution("no-record-answers")]);
    }
    let mut all = std::mem::take(&mut job.all);
    progress.start("drawing figures", all.figures.len());
    let drawings = files::figures(output, &all.figures, &|| progress.step())?;
    for (name, bytes) in &all.files {
        output.write(name, bytes)?;
    }
    put(&mut all.result, &all.findings, Voice::Campaign);
    output.write(SUMMARY, summary(&all))?;
    // Figures of another style are not those of a run without it.
    let style = if output.medium == Medium::Report { "" } else { "# with figures of another style\n" };
    output.write(INPUTS, format!("{inputs}{style}"))?;
    let names = output.written().iter().map(String::as_str).chain([RESULTS, REPORT]);
    all.result.insert("files".to_owned(), names.collect());
    let json = serde_json::to_string_pretty(&all.result).map_err(unwritten)?;
    output.write(RESULTS, json + "\n")?;
    output.write(REPORT, page::page(&job, version, &inputs, &all, &drawings, &parts).html())?;
    Ok((all, job.answers > 0))
}
