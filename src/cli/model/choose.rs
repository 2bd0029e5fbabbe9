//! `vibro model choose`: the simplest model that is good enough.

use crate::analysis::model::{figures, tables};
use crate::cli::args::{self, Came, Looked};
use crate::cli::{complain, print};
use crate::error::{Error, Result};
use crate::model::ladder::{Choice, Question, Survey, choose, choose_over};
use crate::model::{Observable, Scene};
use crate::record::Direction;
use crate::report::{Figure, Output, Table, files};
use crate::units::notation::significant;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// What was asked, and the answer.
#[derive(Serialize)]
struct Answer<'a, T> {
    scene: &'a Scene,
    #[serde(flatten)]
    question: &'a Question,
    #[serde(flatten)]
    found: &'a T,
    warnings: &'a [String],
    files: Vec<String>,
}

pub fn run(typed: &args::ModelChoose, json: bool) -> Result<()> {
    let question = question(typed);
    question.check()?;
    let (scene, warnings) = super::scene(&typed.scene, typed.frequency.or(typed.from))?;
    let excitation = super::excitation(&scene)?;
    if let (Some(from), Some(to)) = (typed.from, typed.to) {
        let survey = choose_over(&scene, from, to, typed.points, &question)?;
        return along(typed, json, &scene, &question, &survey, warnings);
    }
    let frequency = typed.frequency.unwrap_or(excitation.frequency());
    if frequency.is_nan() {
        return Err(Error::usage("no frequency", "--frequency HZ, or --from HZ --to HZ for an axis"));
    }
    let choice = choose(&scene, frequency, &question)?;
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
    warnings.extend(choice.doubt());
    warnings.extend(choice.rare(question));
    warnings.extend(choice.cut());
    if choice.chosen.is_none() {
        warnings.extend(choice.reasons.last().cloned());
    }
    if json {
        return print::json(&Answer { scene, question, found: choice, warnings: &warnings, files: written });
    }
    // What is not chosen is said below.
    complain::warn(&warnings[..warnings.len() - usize::from(choice.chosen.is_none())]);
    let mut text = format!("{}\n", rungs.text());
    if !choice.sensitivity.is_empty() {
        let _ = writeln!(text, "{}", sensitivity.text());
    }
    for sentence in &choice.reasons {
        let _ = writeln!(text, "{sentence}");
    }
    told(text, written)
}

/// What `say` says of the first of these points of which it says anything, and of how many it does.
fn at_first(points: &[Choice], say: impl Fn(&Choice) -> Option<String>) -> Option<String> {
    let said: Vec<(f64, String)> = points.iter().filter_map(|c| Some((c.frequency, say(c)?))).collect();
    let (first, what) = said.first()?;
    let (n, all, first) = (said.len(), points.len(), significant(*first, 6));
    Some(format!("At {n} of {all} points, the first at {first} Hz: {what}"))
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
            let (points, rungs) =
                (tables::chosen(&survey.points, question), tables::summaries(&survey.rungs));
            let tables = [("points.csv", &points), ("rungs.csv", &rungs), ("stretches.csv", &stretches)];
            write(folder, figures::ladder_over(survey, question)?, &tables)?
        }
    };
    let open = survey.points.iter().filter(|c| c.chosen.is_none()).count();
    if let Some(first) = survey.points.iter().find(|c| c.chosen.is_none()) {
        warnings.push(format!(
            "At {open} of {} frequencies no rung can be chosen, the first of them {} Hz: {}",
            survey.points.len(),
            significant(first.frequency, 6),
            first.reasons.last().map_or("", String::as_str)
        ));
    }
    warnings.extend(at_first(&survey.points, |c| c.rare(question)));
    warnings.extend(at_first(&survey.points, Choice::cut));
    let size = |c: &&Choice| c.law.map_or(0.0, |law| law.change.abs());
    let doubted = survey.points.iter().filter(|c| c.doubt().is_some());
    if let Some(worst) = doubted.max_by(|a, b| size(a).total_cmp(&size(b))) {
        let at = significant(worst.frequency, 6);
        warnings.push(format!("At {at} Hz: {}", worst.doubt().unwrap_or_default()));
    }
    if json {
        return print::json(&Answer { scene, question, found: survey, warnings: &warnings, files: written });
    }
    complain::warn(&warnings);
    let mut text = format!("{}\n{}", stretches.text(), tables::summaries(&survey.rungs).text());
    let _ = match survey.chosen {
        Some(model) => {
            let beyond = survey.points.iter().filter_map(|p| p.law).filter(|c| !c.enough);
            match beyond.max_by(|a, b| a.change.abs().total_cmp(&b.change.abs())) {
                Some(c) => writeln!(
                    text,
                    "\n{} is good enough at all of these frequencies if its law of the contact is: at {} the answer moves by up to {:.1} %. \
                     The law should be measured.",
                    model.name(),
                    c.at.name(),
                    100.0 * c.change.abs()
                ),
                None => writeln!(text, "\n{} is good enough at all of these frequencies.", model.name()),
            }
        }
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
