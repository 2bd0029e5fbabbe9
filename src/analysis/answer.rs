//! The answer of the analysis of a record.

use super::compared_rig::ComparedRig;
use super::evidence::Evidence;
use crate::error::{Error, Result};
use crate::measure::chain::Body;
use crate::record::{Finding, Step};
use crate::report::files::Files;
use crate::report::words::{About, Voice};
use crate::report::{Figure, Table};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::borrow::Borrow;

/// Results of an analysis, for programs and for people. Figures and files are named as for a single record,
/// such as `impacts`; a campaign adds a number or a name.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Answer {
    /// All numbers, by key.
    pub result: Map<String, Value>,
    /// Findings, each with its record.
    pub findings: Vec<About>,
    /// Channel of the record; empty for several channels.
    pub channel: String,
    /// Main numbers for the head of a report, without a column for the name of the record.
    pub headlines: Vec<Table>,
    /// Tables that are shown first.
    pub tables: Vec<Table>,
    /// Tables with details, for a close look at this record.
    pub details: Vec<Table>,
    /// Figures.
    pub figures: Vec<(String, Figure)>,
    /// Files of numbers: name and content.
    pub files: Files,
    /// Processing steps from file to result, for each record that has them.
    pub histories: Vec<(String, Vec<Step>)>,
    /// The model that the measurements were compared with.
    pub compared: Option<ComparedRig>,
    /// Evidence on the kinds of its records.
    pub evidence: Vec<Evidence>,
    /// Measured bodies of hammer drills, which are joined.
    pub bodies: Vec<Body>,
    /// Reason why the main result is missing, where the rest can still be shown.
    #[serde(skip)]
    pub refused: Option<Error>,
}

impl Answer {
    /// An answer with the numbers of a result.
    ///
    /// # Errors
    /// If it cannot be written as JSON.
    pub fn of(result: &impl Serialize) -> Result<Answer> {
        let Value::Object(mut result) = serde_json::to_value(result).map_err(unwritten)? else {
            return Err(Error::refused("the result is no object"));
        };
        // Findings are added to the answer separately, with their record.
        result.shift_remove("findings");
        Ok(Answer { result, ..Answer::default() })
    }

    /// Adds findings on a record; `""` stands for the whole answer.
    pub fn add(&mut self, record: &str, findings: impl IntoIterator<Item = impl Borrow<Finding>>) {
        self.findings.extend(findings.into_iter().map(|f| (record.to_owned(), f.borrow().clone())));
    }

    /// Adds a figure, if there is one.
    pub fn figure(&mut self, name: impl Into<String>, figure: impl Into<Option<Figure>>) {
        self.figures.extend(figure.into().map(|figure| (name.into(), figure)));
    }

    /// Adds a table to show, also as a CSV file.
    pub fn table(&mut self, name: &str, table: Table) {
        self.csv(name, &table);
        self.tables.push(table);
    }

    /// Adds another answer; tables with the same title and columns are joined.
    pub(super) fn append(&mut self, mut more: Answer) {
        join(&mut self.headlines, more.headlines);
        join(&mut self.tables, more.tables);
        self.histories.append(&mut more.histories);
        self.evidence.append(&mut more.evidence);
        self.bodies.append(&mut more.bodies);
        self.compared = self.compared.take().or(more.compared);
        self.result.append(&mut more.result);
        self.findings.append(&mut more.findings);
        self.details.append(&mut more.details);
        self.figures.append(&mut more.figures);
        self.files.append(&mut more.files);
    }

    /// Adds a table as a CSV file.
    pub fn csv(&mut self, name: &str, table: &Table) {
        self.files.push((format!("{name}.csv"), table.csv().into_bytes()));
    }
}

/// Adds tables; those with the same title and columns are joined.
fn join(tables: &mut Vec<Table>, more: Vec<Table>) {
    for table in more.into_iter().filter(|table| !table.rows.is_empty()) {
        let same = |known: &&mut Table| known.title == table.title && known.columns == table.columns;
        match tables.iter_mut().find(same) {
            Some(known) => {
                known.rows.extend(table.rows);
                if known.note.is_empty() {
                    known.note = table.note;
                }
            }
            None => tables.push(table),
        }
    }
}

/// The error of a result that JSON cannot represent.
#[allow(clippy::needless_pass_by_value)]
pub(crate) fn unwritten(error: serde_json::Error) -> Error {
    Error::refused(format!("the result cannot be written as JSON: {error}"))
}

/// Code of the finding that a record gave no answer.
pub const LEFT_OUT: &str = "left-out";

/// Finding that a record gave no answer, under this code, with the reason and the hint of the error.
pub fn left_out(code: &'static str, error: &Error) -> Finding {
    let found = Finding::caution(code).name("why", error.why().trim_end_matches('.'));
    let found = error.code().into_iter().fold(found, |found, code| found.name("refusal", code));
    let keys = error.settings_with(|key, value| Voice::Campaign.set(key, value));
    let keys = if keys.is_empty() { String::new() } else { format!(" ({})", keys.join(", ")) };
    if error.advice().is_empty() { found } else { found.name("hint", error.advice() + &keys) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::words::{Voice, sentences};

    #[test]
    fn what_is_left_out_is_told_with_what_to_try() {
        let refusal = Error::refused("no peak. Two are noise.").hint("is it a metre?");
        let findings = sentences(&[("a".to_owned(), left_out("left-out", &refusal))], Voice::Campaign, false);
        assert_eq!(findings, ["a: Left out: no peak. Two are noise. Try: is it a metre?"]);
        let usage = left_out("left-out", &Error::usage("x", "y").set("rate", "1"));
        let findings = sentences(&[("a".to_owned(), usage)], Voice::Campaign, false);
        assert_eq!(findings, ["a: Left out: x; expected y."]);
    }

    #[test]
    fn an_answer_has_its_numbers_without_its_sentences() {
        #[derive(Serialize)]
        struct Found {
            n: usize,
            findings: Vec<Finding>,
        }
        let answer = Answer::of(&Found { n: 3, findings: vec![Finding::note("x")] }).unwrap();
        assert_eq!(Value::Object(answer.result), serde_json::json!({ "n": 3 }));
        assert!(Answer::of(&3).is_err());
    }
}
