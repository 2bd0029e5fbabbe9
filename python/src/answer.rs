//! Answers: of a question with its options, and of a campaign.

use crate::drawing::Drawing;
use crate::head::{Passed, Told, told};
use crate::value::object;
use crate::watched::watched;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;
use serde_json::{Value, json};
use std::path::PathBuf;
use vibro_io::{Folder, Format, Recording};
use vibroimpact::analysis::Answer;
use vibroimpact::cli;
use vibroimpact::record::Finding;
use vibroimpact::report::Table;

/// Records made in memory, by the word that stands for them among the words of a question.
type Made<'py> = (PathBuf, Vec<Passed<'py>>);

/// Answers a question by the words of a command line, without `vibro`. `made` are records in memory.
#[pyfunction]
pub fn ask<'py>(
    py: Python<'py>,
    words: Vec<String>,
    made: Vec<Made<'py>>,
    show: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let recording = |(path, records): &Made<'py>| {
        let mut findings: Vec<Finding> = Vec::new();
        for found in records.iter().flat_map(|(head, _)| head.get().of_file()) {
            if !findings.contains(found) {
                findings.push(found.clone());
            }
        }
        let records = records.iter().map(|(head, values)| head.get().with(values));
        let records = records.collect::<PyResult<Vec<_>>>()?;
        Ok(Recording { path: path.clone(), format: Format::Memory, records, findings })
    };
    let recordings = made.iter().map(recording).collect::<PyResult<Vec<_>>>()?;
    let answer = watched(py, show, move |progress| {
        cli::answer(&words, &Folder::default().with_recordings(recordings), progress)
    })?;
    python(py, answer)
}

/// Runs a campaign as `vibro run` does, with its options: the answer, the folder of the results and the
/// files in it.
#[pyfunction]
pub fn run<'py>(
    py: Python<'py>,
    words: Vec<String>,
    show: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, PathBuf, Vec<String>)> {
    let done = watched(py, show, move |progress| cli::run(&words, progress))?;
    Ok((python(py, done.outcome.answer)?, done.folder, done.outcome.files))
}

/// An object of the class `Answer`.
pub fn python(py: Python<'_>, answer: Answer) -> PyResult<Bound<'_, PyAny>> {
    static ANSWER: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let mut findings: Vec<(String, Told)> = Vec::new();
    for (record, finding) in &answer.findings {
        let all = (record.clone(), told(finding));
        if !findings.contains(&all) {
            findings.push(all);
        }
    }
    let tables = answer.tables.iter().chain(&answer.details).filter(|table| !table.rows.is_empty());
    let text: Vec<String> = tables.clone().map(Table::text).collect();
    let tables = tables.map(|table| serde_json::to_value(table).unwrap_or_default()).collect();
    let figures: Vec<(String, Drawing)> =
        answer.figures.into_iter().map(|(name, figure)| (name, Drawing(figure))).collect();
    let result = object(py, Value::Object(answer.result))?;
    let (tables, text) = (object(py, Value::Array(tables))?, text.join("\n"));
    ANSWER.import(py, "vibroimpact._answer", "Answer")?.call1((result, findings, tables, text, figures))
}

/// The questions that [`ask`] takes: name, purpose, and for each option its name, help, placeholder, whether
/// it takes a value, may stand several times, is a place, or must be given.
#[pyfunction]
pub fn questions(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    let all = cli::questions().iter().map(described).collect();
    object(py, Value::Array(all))
}

/// A command with its options, for the makers of other interfaces.
fn described(command: &cli::Command) -> Value {
    let text = |text: Option<&cli::StyledStr>| text.map(ToString::to_string);
    let option = |arg: &cli::Arg| {
        json!({
            "name": arg.get_id().as_str(),
            "option": arg.get_long(),
            "help": text(arg.get_long_help().or(arg.get_help())),
            "placeholder": arg.get_value_names().and_then(|names| names.first()).map(ToString::to_string),
            "values": arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect::<Vec<_>>(),
            "takes_value": arg.get_action().takes_values(),
            "many": matches!(arg.get_action(), cli::ArgAction::Append),
            "joined": arg.get_value_delimiter().map(String::from),
            "place": arg.get_index().is_some(),
            "required": arg.is_required_set(),
            "heading": arg.get_help_heading(),
        })
    };
    json!({
        "name": command.get_name(),
        "about": text(command.get_about()),
        "example": text(command.get_after_help()),
        "options": command.get_arguments().map(option).collect::<Vec<_>>(),
        "parts": command.get_subcommands().map(described).collect::<Vec<_>>(),
    })
}
