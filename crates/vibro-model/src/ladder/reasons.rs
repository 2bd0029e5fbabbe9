//! A choice told in sentences.

use super::change::Answer;
use super::motions::{MOST_CYCLES, MOST_FOLLOWED};
use super::{Change, Choice, Followed, Known, Model, Question, Rung};
use std::fmt::Write as _;
use vibro_record::units::notation::quantity;

/// Why this rung, or why none.
pub fn sentences(choice: &Choice, question: &Question) -> Vec<String> {
    let mut said = Vec::new();
    if choice.needs.contains(&"history") {
        let named = |m: &Known| {
            let lost = if m.stable { "" } else { ", unstable: others with impacts may last round it" };
            let at =
                if m.model > Model::Restitution { format!(" at {}", m.model.name()) } else { String::new() };
            format!("{}{at} ({}{lost})", m.pattern, value(m.answer, question))
        };
        let all: Vec<String> = choice.motions.iter().map(named).collect();
        said.push(format!(
            "Several motions are possible here: {}. Which one the rig is in depends on how it came there: give the history, a frequency that \
             rose or fell.",
            all.join(", ")
        ));
        return said;
    }
    let top = choice.chosen.map_or(Model::ALL.len(), |model| model as usize);
    let (below, above) = choice.rungs.split_at(top);
    let mut left: Vec<&Rung> = below.iter().collect();
    let out = |r: &&Rung| !r.valid || unsure(r, question) > 1.0;
    left.extend(above.iter().filter(|r| Some(r.model) != choice.chosen).filter(out));
    said.extend(left.chunk_by(|a, b| not_valid(a).is_some() && not_valid(a) == not_valid(b)).map(|same| {
        let names: Vec<&str> = same.iter().map(|r| r.model.name()).collect();
        format!("{}: {}", names.join(", "), passed_over(same[0], question))
    }));
    said.extend(rare(choice, question));
    if let Some(Followed { states, of }) = choice.followed {
        let states = if states < of { format!("{states} of {of}") } else { of.to_string() };
        said.push(format!(
            "Other motions were looked for in closed form with one impact in up to {MOST_CYCLES} cycles, from rest and from {states} other states: there can be more, \
             which a history would tell."
        ));
    }
    if let Some(model) = choice.chosen {
        said.push(chosen(choice, choice.rung(model), question));
    } else if choice.sensitivity.is_empty() {
        said.push(if choice.needs.is_empty() {
            "No rung can be chosen: none is valid with an answer that is settled and stays within what is allowed at the rungs above."
                .to_owned()
        } else {
            format!("No rung can be chosen without {}.", choice.needs.join(" and "))
        });
    } else {
        said.push(unknown(choice, question));
    }
    said
}

/// What an answer that is not settled is told with.
pub const UNSETTLED: &str = "Not settled";

/// Why a rung says nothing about the scene.
fn not_valid(rung: &Rung) -> Option<&str> {
    (!rung.valid).then_some(rung.why.as_str())
}

fn passed_over(rung: &Rung, question: &Question) -> String {
    let moved = rung.changes.iter().find(|c| !c.enough);
    match moved {
        _ if !rung.valid => format!("not valid. {}", rung.why),
        _ if rung.why.contains(UNSETTLED) => format!("its motion has not settled. {}", rung.why),
        _ if unsure(rung, question) > 1.0 => hardly_known(rung, question),
        Some(c) => format!(
            "valid, but its answer moves by {} at {}, more than {} allows.",
            percent(c.change),
            c.at.name(),
            allowed(question)
        ),
        None => "valid, but nothing known says how far its answer is off.".to_owned(),
    }
}

/// That motions which strike less than once a cycle are possible beside the one that is answered for.
pub fn rare(choice: &Choice, question: &Question) -> Option<String> {
    let rare = choice.motions.iter().filter(|m| m.rare);
    let named: Vec<String> = rare.map(|m| format!("{} ({})", m.pattern, value(m.answer, question))).collect();
    let came = if question.history.is_some() { "the way it came" } else { "from rest" };
    (!named.is_empty() && choice.needs.is_empty()).then(|| {
        format!(
            "The rig does not come to them {came}, but motions that strike less than once a cycle are possible as well: {}. After a knock it may be in \
             one of them.",
            named.join(", ")
        )
    })
}

/// That not all states were followed, although no second motion was found that would have ended the search.
pub fn cut(choice: &Choice) -> Option<String> {
    let Followed { states, of } =
        choice.followed.filter(|f| f.states < f.of && !choice.needs.contains(&"history"))?;
    Some(format!(
        "Other motions were looked for from {states} of {of} states only: the others would take more than {MOST_FOLLOWED} cycles, or lead beyond what can be \
         followed. There can be more motions; a history would tell which one the rig is in."
    ))
}

/// Standard error of its answer over what is allowed.
fn unsure(rung: &Rung, question: &Question) -> f64 {
    let answer = |value| Answer { value, spread: rung.spread, steady: true };
    rung.answer.map_or(0.0, |value| answer(value).unsure(question))
}

/// What an answer is told with that is a mean of too large an error.
fn hardly_known(rung: &Rung, question: &Question) -> String {
    format!(
        "valid, but its motion never repeats, and the standard error of its mean is {:.1} times what {} allows: try a larger tolerance.",
        unsure(rung, question),
        allowed(question)
    )
}

fn chosen(choice: &Choice, rung: &Rung, question: &Question) -> String {
    let mut text = format!("{} is chosen. {}", rung.model.name(), rung.why);
    if let (Some(first), Some(last)) = (choice.sensitivity.first(), choice.sensitivity.last()) {
        let _ = write!(
            text,
            " The contact's stiffness is not known and need not be: from {:.0e} to {:.0e} N/m the answer stays within {}.",
            first.stiffness,
            last.stiffness,
            allowed(question)
        );
    }
    for change in &rung.changes {
        if change.at == Model::HuntCrossley {
            continue;
        }
        let excused = change.enough && change.change.abs() > question.tolerance;
        let _ = write!(text, " Its answer moves by {} at {}", percent(change.change), change.at.name());
        text.push_str(if excused {
            ", more than the tolerance: the noise floor, or what the answers themselves are uncertain by, allows it."
        } else {
            "."
        });
    }
    if let Some(law) = choice.law {
        let _ = write!(text, " {}", bent(law));
    }
    text
}

/// How far the law of the contact moves the chosen answer.
fn bent(law: Change) -> String {
    let moved = format!(
        "With curved bodies that meet for as long and rebound alike it moves by {}",
        percent(law.change)
    );
    if law.enough {
        moved + "."
    } else {
        moved
            + ": the law of the contact matters more than the tolerance, and should be measured (`vibro pulse`)."
    }
}

/// What a chosen answer is to be doubted for, in a sentence.
pub fn doubt(choice: &Choice) -> Option<String> {
    let law = choice.law.filter(|law| !law.enough)?;
    Some(format!("The answer of {} depends on the law of the contact. {}", choice.chosen?.name(), bent(law)))
}

/// What the uncertainty of the gap does to the chosen answer.
pub fn gap(choice: &Choice, question: &Question) -> Option<String> {
    let at = |change: &Option<Change>| match change {
        Some(change) => format!("moves it by {}", percent(change.change)),
        None => "leaves no such answer".to_owned(),
    };
    let [smaller, larger] = choice.gap.as_slice() else { return None };
    let enough = choice.gap.iter().all(|c| c.is_some_and(|c| c.enough));
    Some(format!(
        "A gap smaller by its uncertainty of {} {}, a larger one {}: {}.",
        quantity(question.gap_std, "m", 2),
        at(smaller),
        at(larger),
        if enough {
            "within what is allowed"
        } else {
            "whatever the model, the answer is known no better than the gap"
        }
    ))
}

/// Why the stiffness must be known.
fn unknown(choice: &Choice, question: &Question) -> String {
    let rows = &choice.sensitivity;
    let range = |low: f64, high: f64| format!("from {low:.0e} to {high:.0e} N/m");
    let last = &rows[rows.len() - 1];
    let all = range(rows[0].stiffness, last.stiffness);
    let worst = rows.iter().map(|r| r.change.abs()).fold(0.0, f64::max);
    let (within, needs) = (allowed(question), choice.needs.join(" and "));
    let mut text = format!(
        "No rung can be chosen without {needs}: {all} the answer moves by up to {:.3} % of that of impacts without duration",
        100.0 * worst
    );
    let _ = match rows.iter().rposition(|r| !r.enough) {
        Some(i) if i + 1 == rows.len() => {
            let still = percent(last.change);
            write!(text, ", and at the stiffest of them it is still {still} off, outside {within}.")
        }
        Some(i) => write!(text, ", and stays within {within} from {:.0e} N/m on.", rows[i + 1].stiffness),
        None => write!(text, ", within {within}."),
    };
    if !choice.sensitivity_failed.is_empty() {
        let failed: Vec<String> = choice.sensitivity_failed.iter().map(|k| format!("{k:.0e}")).collect();
        let _ = write!(text, " At {} N/m it could not be computed.", failed.join(", "));
    }
    text
}

/// A relative change in percent; one that rounds to nothing is not nothing.
fn percent(change: f64) -> String {
    if change == 0.0 || change.abs() >= 5e-6 {
        format!("{:+.3} %", 100.0 * change)
    } else {
        "less than 0.001 %".to_owned()
    }
}

/// What a change may be.
fn allowed(question: &Question) -> String {
    let tolerance = format!("{} %", 100.0 * question.tolerance);
    if question.noise > 0.0 {
        format!("the larger of {tolerance} and {} {}", question.noise, question.observable.unit())
    } else {
        tolerance
    }
}

/// An answer for a person.
fn value(answer: [f64; 2], question: &Question) -> String {
    let [one, two] = answer.map(|v| quantity(v, question.observable.unit(), 4));
    if question.observable.is_of_impacts() { one } else { format!("x₁ {one}, x₂ {two}") }
}
