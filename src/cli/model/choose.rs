//! `vibro model choose`: the simplest model that is good enough.

use crate::analysis::model::{figures, tables};
use crate::cli::args::{self, Came, Looked};
use crate::cli::progress::Busy;
use crate::cli::{complain, print};
use crate::error::{Error, Result};
use crate::model::ladder::{Choice, Question, Rung, Survey, choose, choose_over};
use crate::model::{Observable, Scene};
use crate::record::{Direction, Finding, Severity};
use crate::report::words::{self, Voice, sentences};
use crate::report::{Figure, Output, Table, files};
use crate::units::notation::significant;
use serde::Serialize;
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;

/// What was asked, and the answer.
#[derive(Serialize)]
struct Answer<'a> {
    scene: &'a Scene,
    #[serde(flatten)]
    question: &'a Question,
    #[serde(flatten)]
    found: Value,
    warnings: &'a [String],
    files: Vec<String>,
}

/// A choice as JSON, with `why` of each rung and `reasons` in words.
fn worded(choice: &Choice) -> Result<Value> {
    let mut value = to_value(choice)?;
    for (rung, found) in choice.rungs.iter().enumerate() {
        value["rungs"][rung]["why"] = tables::why(found, Voice::Command).into();
    }
    value["reasons"] = reasons(choice).into();
    Ok(value)
}

fn to_value(found: &impl Serialize) -> Result<Value> {
    serde_json::to_value(found)
        .map_err(|e| Error::refused(format!("the result cannot be written as JSON: {e}")))
}

/// Why the rungs below the chosen one are passed over, why that one is chosen, and what was found beside.
fn reasons(choice: &Choice) -> Vec<String> {
    let top = choice.chosen.map_or(choice.rungs.len(), |model| model as usize + 1);
    let mut said: Vec<String> = Vec::new();
    let told = |rung: &Rung| (rung.valid, tables::why(rung, Voice::Command));
    for alike in choice.rungs[..top].chunk_by(|a, b| told(a) == told(b)) {
        let names: Vec<&str> = alike.iter().map(|r| r.model.name()).collect();
        let (valid, why) = told(&alike[0]);
        let fate = match valid {
            _ if choice.chosen == Some(alike[0].model) => "chosen",
            true => "valid",
            false => "not valid",
        };
        said.push(format!("{}: {fate}. {why}", names.join(", ")));
    }
    said.extend(sentences(&choice.findings, Voice::Command));
    said
}

pub fn run(typed: &args::ModelChoose, json: bool) -> Result<()> {
    let question = question(typed);
    question.check()?;
    let (scene, warnings) = super::scene(&typed.scene, typed.frequency.or(typed.from))?;
    let excitation = super::excitation(&scene)?;
    if let (Some(from), Some(to)) = (typed.from, typed.to) {
        let busy = Busy::with(json, "choosing a model at each frequency");
        let survey = choose_over(&scene, from, to, typed.points, &question)?;
        drop(busy);
        return along(typed, json, &scene, &question, &survey, warnings);
    }
    let frequency = typed.frequency.unwrap_or(excitation.frequency());
    if frequency.is_nan() {
        return Err(Error::usage("no frequency", "--frequency HZ, or --from HZ --to HZ for an axis"));
    }
    let busy = Busy::with(json, "choosing a model");
    let choice = choose(&scene, frequency, &question)?;
    drop(busy);
    single(typed, json, &scene, &question, &choice, warnings)
}

fn question(typed: &args::ModelChoose) -> Question {
    Question {
        observable: match typed.observable {
            Looked::Fundamental => Observable::Fundamental,
            Looked::Peak => Observable::HalfPeakToPeak,
            Looked::ImpactSpeed => Observable::ImpactSpeed,
            Looked::Impulse => Observable::Impulse,
        },
        tolerance: typed.tolerance,
        noise: typed.noise,
        gap_std: typed.gap_std,
        history: typed.history.map(|came| match came {
            Came::Up => Direction::Up,
            Came::Down => Direction::Down,
        }),
    }
}

fn single(
    typed: &args::ModelChoose,
    json: bool,
    scene: &Scene,
    question: &Question,
    choice: &Choice,
    mut warnings: Vec<String>,
) -> Result<()> {
    let rungs = tables::rungs(choice, question);
    let sensitivity = tables::sensitivity(&choice.sensitivity, question);
    let written = match &typed.out {
        None => Vec::new(),
        Some(folder) => {
            let tables = [("rungs.csv", &rungs), ("sensitivity.csv", &sensitivity)];
            write(folder, figures::ladder(choice, question), &tables)?
        }
    };
    if json {
        let found = worded(choice)?;
        return print::json(&Answer { scene, question, found, warnings: &warnings, files: written });
    }
    warnings.extend(words::warnings(&choice.findings, Voice::Command));
    complain::warn(&warnings);
    let mut text = format!("{}\n", rungs.text());
    if choice.motions.len() > 1 {
        let _ = writeln!(text, "{}", tables::motions(&choice.motions, question).text());
    }
    if !choice.sensitivity.is_empty() {
        let _ = writeln!(text, "{}", sensitivity.text());
    }
    for sentence in reasons(choice).iter().filter(|said| !warnings.contains(said)) {
        let _ = writeln!(text, "{sentence}");
    }
    told(text, written)
}

/// The findings of an axis that are not notes: of each code the first, and at how many points it was found.
fn over(points: &[Choice]) -> Vec<String> {
    let mut seen: Vec<(&Finding, f64, usize)> = Vec::new();
    for choice in points {
        for finding in choice.findings.iter().filter(|f| f.severity != Severity::Note) {
            match seen.iter_mut().find(|known| known.0.code == finding.code) {
                Some(known) => known.2 += 1,
                None => seen.push((finding, choice.frequency, 1)),
            }
        }
    }
    let said = |(finding, first, n): &(&Finding, f64, usize)| {
        let (all, first) = (points.len(), significant(*first, 6));
        let sentence = words::sentence(finding, Voice::Command);
        format!("At {n} of {all} frequencies, first at {first} Hz: {sentence}")
    };
    seen.iter().map(said).collect()
}

fn along(
    typed: &args::ModelChoose,
    json: bool,
    scene: &Scene,
    question: &Question,
    survey: &Survey,
    mut warnings: Vec<String>,
) -> Result<()> {
    let stretches = tables::stretches(&survey.stretches);
    let written = match &typed.out {
        None => Vec::new(),
        Some(folder) => {
            let (points, rungs) = (tables::chosen(&survey.points, question), tables::summaries(survey));
            let tables = [("points.csv", &points), ("rungs.csv", &rungs), ("stretches.csv", &stretches)];
            write(folder, figures::ladder_over(survey, question)?, &tables)?
        }
    };
    warnings.extend(over(&survey.points));
    if json {
        let mut found = to_value(survey)?;
        for (rung, summary) in survey.rungs.iter().enumerate() {
            found["rungs"][rung]["why"] = tables::where_chosen(summary, survey.points.len()).into();
        }
        found["points"] = survey.points.iter().map(worded).collect::<Result<Vec<Value>>>()?.into();
        return print::json(&Answer { scene, question, found, warnings: &warnings, files: written });
    }
    complain::warn(&warnings);
    let mut text = format!("{}\n{}", stretches.text(), tables::summaries(survey).text());
    let _ = match survey.chosen {
        Some(model) => writeln!(text, "\n{} is good enough at all of these frequencies.", model.name()),
        None => writeln!(text, "\nNo single model was found good enough at all of these frequencies."),
    };
    told(text, written)
}

/// Figure and tables, empty ones left out.
fn write(folder: &Path, figure: Figure, tables: &[(&str, &Table)]) -> Result<Vec<String>> {
    let mut output = Output::new(folder)?;
    files::figures(&mut output, &[("ladder".to_owned(), figure)], &|| ())?;
    for (name, table) in tables.iter().filter(|t| !t.1.rows.is_empty()) {
        output.write(name, table.csv())?;
    }
    Ok(output.written().to_vec())
}

fn told(mut text: String, written: Vec<String>) -> Result<()> {
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}
