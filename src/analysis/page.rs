//! The report of a campaign as one page.

use super::answer::{Answer, LEFT_OUT};
use super::compared_rig::ComparedRig;
use super::headline::shortened;
use super::job::Job;
use crate::campaign::Campaign;
use crate::model::Parameter;
use crate::record::{Severity, Step};
use crate::report::Page;
use crate::report::Picture;
use crate::report::words::{About, Voice, graded};
use crate::units::notation::{counted, shortest};
use serde_json::json;
use std::fmt::Write as _;
use std::ops::Range;

/// Part of the report for one kind of record: its heading, and the ranges of its tables, figures, long
/// tables and findings.
pub(super) type Part = (&'static str, [Range<usize>; 4]);

/// Lays out the report with the pictures of its figures: answers first, then each kind of record, then the
/// origin of the numbers.
pub fn page(
    job: &Job<'_>,
    version: &str,
    inputs: &str,
    all: &Answer,
    pictures: &[Picture],
    parts: &[Part],
) -> Page {
    let mut page = Page::new(job.title.as_str()).heading("Answers");
    page = page.answers(&shortened(&all.headlines));
    if !all.headlines.is_empty() {
        page =
            page.paragraph("± is one standard uncertainty: twice as much holds the truth 95 times in 100.");
    }
    // Each finding is listed once: records without an answer and doubts beside the answers, all others at the
    // records.
    let is_without = |(_, one): &&About| [LEFT_OUT, Campaign::WAITING].contains(&&*one.code);
    let without: Vec<About> = all.findings.iter().filter(is_without).cloned().collect();
    // A record that waits for a value is a note of its campaign; the report lacks its answer.
    let mut doubts = graded(&without, Voice::Campaign);
    for found in &mut doubts {
        found.0 = found.0.max(Severity::Caution);
    }
    let mut rest = graded(&all.findings, Voice::Campaign);
    rest.retain(|found| found.0 > Severity::Note && !lists(&doubts, &found.1));
    let first = rest.iter().take_while(|found| found.0 == Severity::Doubt).count().min(MOST_DOUBTS);
    let others = rest.split_off(first);
    doubts.extend(rest);
    page = page.foremost(&doubts);
    if !others.is_empty() {
        let name = if doubts.is_empty() { "caution" } else { "more caution" };
        page = page.paragraph(&format!("{} below, at the records.", counted(others.len(), name)));
    }
    let at_records = |findings: &[About]| {
        let mut found = graded(findings, Voice::Campaign);
        found.retain(|found| !lists(&doubts, &found.1));
        found
    };
    for (title, [tables, figures, details, findings]) in parts.iter().cloned() {
        let findings = at_records(&all.findings[findings]);
        let (tables, details) = (&all.tables[tables], &all.details[details]);
        if tables.is_empty() && figures.is_empty() && details.is_empty() && findings.is_empty() {
            continue;
        }
        page = page.heading(title).findings(&findings);
        for ((name, figure), picture) in all.figures[figures.clone()].iter().zip(&pictures[figures]) {
            let files = [format!("{name}.svg"), format!("{name}.png")];
            page = page.figure(figure, picture, &files.each_ref().map(String::as_str));
        }
        page = page.tables(tables.iter().chain(details));
    }
    let compared = all.compared.as_ref();
    if let Some(sliders) = compared.and_then(|compared| compared.sliders.as_ref()) {
        page = page.heading("What if").paragraph(WHAT_IF).what_if(json!(sliders));
    }
    // Findings after the parts concern the campaign as a whole.
    let rest = parts.last().map_or(0, |(_, [.., findings])| findings.end);
    page = page.heading("Where the numbers come from").findings(&at_records(&all.findings[rest..]));
    let page = origin(page, job, inputs, all);
    page.paragraph(&format!(
        "Made by vibroimpact {version}. All numbers are in results.json beside this page."
    ))
}

/// Whether a sentence is among these.
fn lists(findings: &[(Severity, String)], sentence: &str) -> bool {
    findings.iter().any(|found| found.1 == sentence)
}

/// Adds the origin of the numbers: the rig, the files, the campaign, and the steps from file to result.
fn origin(mut page: Page, job: &Job<'_>, inputs: &str, all: &Answer) -> Page {
    if let Some(ComparedRig { rig, .. }) = &all.compared {
        let mut rig = *rig;
        let values: Vec<(&str, String)> =
            Parameter::of_rig().filter_map(|p| Some((p.name(), with_unit(p, *p.place(&mut rig)?)))).collect();
        page =
            page.details("Rig of the comparison", values.iter().map(|(key, value)| (*key, value.as_str())));
    }
    let steps: Vec<(String, String)> =
        all.histories.iter().map(|(name, steps)| (name.clone(), history(steps))).collect();
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
    page
}

/// A value of a rig with its unit.
fn with_unit(parameter: Parameter, value: f64) -> String {
    format!("{} {}", json!(value), Some(parameter.unit()).filter(|unit| *unit != "1").unwrap_or_default())
}

/// Text above the sliders.
const WHAT_IF: &str = "Curves: motions with one impact a cycle and without impacts, as the model has them for these values. A contact stiffness is taken into account to first \
    order, and curves end where the contact lasts longer than 2.5 % of a cycle.";

/// Largest number of doubts at the head of the page.
const MOST_DOUBTS: usize = 8;

/// Processing steps as text, one a line.
fn history(steps: &[Step]) -> String {
    let mut text = String::new();
    for step in steps {
        let arguments: Vec<String> =
            step.arguments.iter().map(|(k, v)| format!("{k} {}", without_rounding(v))).collect();
        let _ = writeln!(text, "{} (version {}): {}", step.name, step.version, arguments.join(", "));
    }
    text
}

/// An argument of a step; a decimal number with at most twelve digits, without the remains of rounding.
fn without_rounding(argument: &str) -> String {
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
        assert_eq!(without_rounding("0.00019999999999999998"), "0.0002");
        assert_eq!(without_rounding("0.039990000000000005"), "0.03999");
        assert_eq!(without_rounding("135.0625"), "135.0625");
        assert_eq!(without_rounding("20251120123456"), "20251120123456");
        assert_eq!(without_rounding("UP1.TXT"), "UP1.TXT");
    }
}
