//! The report of a campaign as one page.

use super::headline::headlines;
use super::job::Part;
use super::{Answer, Job};
use crate::model::Parameter;
use crate::record::{Severity, Step};
use crate::report::Page;
use crate::report::Picture;
use crate::report::words::{Voice, graded};
use crate::units::notation::{counted, shortest};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::fmt::Write as _;

/// Lays out all that is shown, with the pictures of its figures: answers first, then kind by kind, then where they come from.
pub fn page(
    job: &Job<'_>,
    version: &str,
    inputs: &str,
    all: &Answer,
    pictures: &[Picture],
    parts: &[Part],
) -> Page {
    let mut page = Page::new(job.title.as_str()).heading("Answers");
    page = page.answers(&headlines(&all.result));
    let mut worst = graded(&all.findings, Voice::Campaign);
    worst.retain(|(severity, _)| *severity > Severity::Note);
    let doubts = worst.iter().filter(|(severity, _)| *severity == Severity::Doubt).count();
    let shown = doubts.clamp(MATTER, MOST).min(worst.len());
    page = page.findings(&worst[..shown]);
    if worst.len() > shown {
        let more = counted(worst.len() - shown, "more caution");
        page = page.paragraph(&format!("{more} below, at the records."));
    }
    for (title, [tables, figures, details, findings]) in parts.iter().cloned() {
        let findings = graded(&all.findings[findings], Voice::Campaign);
        let (tables, details) = (&all.tables[tables], &all.details[details]);
        if tables.is_empty() && figures.is_empty() && details.is_empty() && findings.is_empty() {
            continue;
        }
        page = page.heading(title).findings(&findings);
        for ((name, figure), picture) in all.figures[figures.clone()].iter().zip(&pictures[figures]) {
            let files = [format!("{name}.svg"), format!("{name}.png")];
            page = page.figure(figure, picture, &files.each_ref().map(String::as_str));
        }
        page = tables.iter().chain(details).fold(page, Page::table);
    }
    if let Some(start) = what_if(job, &all.result) {
        page = page.heading("What if").paragraph(WHAT_IF).what_if(start);
    }
    let rest = parts.last().map_or(0, |(_, [.., findings])| findings.end);
    page =
        page.heading("Where the numbers come from").findings(&graded(&all.findings[rest..], Voice::Campaign));
    if let Some(rig) = all.result.get("rig").and_then(Value::as_object) {
        let values: Vec<(&str, String)> =
            rig.iter().map(|(key, value)| (key.as_str(), constant(key, value))).collect();
        page =
            page.details("Rig of the comparison", values.iter().map(|(key, value)| (*key, value.as_str())));
    }
    let responses = all.result.get("responses").and_then(Value::as_array);
    let steps = |response: &Value| {
        let steps = Vec::<Step>::deserialize(&response["history"]).unwrap_or_default();
        (response["name"].as_str().unwrap_or_default().to_owned(), history(&steps))
    };
    let steps: Vec<(String, String)> = responses.into_iter().flatten().map(steps).collect();
    let files = inputs
        .lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| line.split_once("  "))
        .map(|(digest, name)| (name, &digest[..16]));
    page = page.details("Files with the start of their SHA-256 (in full in inputs.sha256)", files);
    page = page.details("The campaign as it ran", [("campaign.toml", job.campaign.text())]);
    if !steps.is_empty() {
        page = page.details(
            "Steps from file to result",
            steps.iter().map(|(name, text)| (name.as_str(), text.as_str())),
        );
    }
    page.paragraph(&format!(
        "Made by vibroimpact {version}. All numbers are in results.json beside this page."
    ))
}

/// A value of a rig with its unit.
fn constant(key: &str, value: &Value) -> String {
    let unit = Parameter::named(key).map(Parameter::unit).filter(|unit| *unit != "1").unwrap_or_default();
    format!("{value} {unit}")
}

/// What stands above the sliders.
const WHAT_IF: &str = "Curves: motions with one impact a cycle and without impacts, as the model has them for these values. A contact stiffness is taken into account to first \
    order, and curves end where the contact lasts longer than 2.5 % of a cycle.";

/// What the sliders begin with: the rig of the overlay, over what was measured.
fn what_if(job: &Job<'_>, results: &Map<String, Value>) -> Option<Value> {
    let rig = results.get("rig").filter(|rig| rig.is_object())?;
    let overlay = results.get("overlay").filter(|overlay| overlay.is_object())?;
    let force = overlay["levels"][0]["force"].as_f64()?;
    // The sweeps of one level of force.
    let level = overlay["levels"][0]["sweeps"].as_array()?;
    let pairs = overlay["pairs"].as_array()?;
    let point = |pair: &Value| Some((pair["frequency"].as_f64()?, 1e3 * pair["measured"]["value"].as_f64()?));
    let of = |sweep: &Value| pairs.iter().filter(|pair| pair["sweep"] == *sweep).collect::<Vec<&Value>>();
    let (mut measured, mut all) = (Vec::new(), Vec::new());
    for sweep in level {
        let own = of(sweep);
        let Some(first) = own.first() else { continue };
        let points: Vec<(f64, f64)> = own.iter().filter_map(|pair| point(pair)).collect();
        let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let down = first["direction"] == "down";
        measured.push(json!({"name": sweep, "mass": first["mass"], "down": down, "x": x, "y": y}));
        all.extend(points);
    }
    let largest = all.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let lowest = all.iter().map(|point| point.0).fold(f64::INFINITY, f64::min);
    let highest = all.iter().map(|point| point.0).fold(0.0, f64::max);
    let stiffness = job.campaign.contact.and_then(|contact| contact.stiffness).unwrap_or(0.0);
    (lowest < highest).then(|| {
        json!({
            "rig": rig, "force": force, "stiffness": stiffness, "frequency": largest.0, "from": lowest, "to": highest,
            "low": largest.1 * 1e-3, "high": largest.1 * 3.0, "measured": measured,
        })
    })
}

/// Findings that the page begins with: so many, or all doubts up to the most.
const MATTER: usize = 3;
const MOST: usize = 8;

fn history(steps: &[Step]) -> String {
    let mut text = String::new();
    for step in steps {
        let arguments: Vec<String> =
            step.arguments.iter().map(|(k, v)| format!("{k} {}", brief(v))).collect();
        let _ = writeln!(text, "{} (version {}): {}", step.name, step.version, arguments.join(", "));
    }
    text
}

/// An argument as it is, but a decimal number to no more than twelve digits.
fn brief(argument: &str) -> String {
    match argument.parse() {
        Ok(number) if argument.contains('.') => shortest(number),
        _ => argument.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_shown_without_the_remains_of_computing() {
        assert_eq!(brief("0.00019999999999999998"), "0.0002");
        assert_eq!(brief("0.039990000000000005"), "0.03999");
        assert_eq!(brief("135.0625"), "135.0625");
        assert_eq!(brief("20251120123456"), "20251120123456");
        assert_eq!(brief("UP1.TXT"), "UP1.TXT");
    }
}
