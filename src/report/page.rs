//! The report of a campaign as one page.

use super::job::Results;
use super::{Drawing, Figure, Page, tables};
use crate::record::Step;
use std::fmt::Write as _;

/// Lays out results, tables and drawings; `figures` and `drawings` belong together one by one.
pub fn page(results: &Results, figures: &[(String, Figure)], drawings: &[Drawing]) -> Page {
    let mut page = Page::new(results.campaign.clone());
    for sentence in summary(results) {
        page = page.summary(sentence);
    }
    for warning in &results.warnings {
        page = page.warning(warning.clone());
    }
    for table in tables::summary(results) {
        page = page.table(&table);
    }
    for ((name, figure), drawing) in figures.iter().zip(drawings) {
        let files = [format!("{name}.svg"), format!("{name}.png")];
        page = page.figure(drawing, &figure.caption, &files.each_ref().map(String::as_str));
    }
    for response in &results.responses {
        page = page.table(&tables::response(response));
    }
    let histories: Vec<(String, String)> =
        results.responses.iter().map(|r| (r.name.clone(), history(&r.history))).collect();
    page = page
        .heading("Where the numbers come from")
        .details("Steps from file to curve", histories.iter().map(|(n, h)| (n.as_str(), h.as_str())));
    page.paragraph(&format!(
        "Made by vibroimpact {}. All numbers are in results.json beside this page.",
        results.version
    ))
}

/// One sentence for each named resonance, and one for each crossing.
fn summary(results: &Results) -> Vec<String> {
    let mut sentences = Vec::new();
    for kind in ["grazing", "clapping"] {
        let mut found = Vec::new();
        for response in &results.responses {
            for r in response.resonances.iter().filter(|r| r.kind == kind) {
                found.push(format!("{:.2} Hz ({})", r.frequency, response.name));
            }
        }
        if !found.is_empty() {
            sentences.push(format!("The {kind} resonance lies at {}.", found.join(", ")));
        }
    }
    for c in &results.crossings {
        let going = c.direction.name();
        sentences.push(format!(
            "Going {going}, the curves of the two masses cross at {:.2} Hz; above it mass {} moves more.",
            c.frequency, c.larger_above
        ));
    }
    sentences
}

fn history(steps: &[Step]) -> String {
    let mut text = String::new();
    for step in steps {
        let arguments: Vec<String> = step.arguments.iter().map(|(k, v)| format!("{k} {v}")).collect();
        let _ = writeln!(text, "{} (version {}): {}", step.name, step.version, arguments.join(", "));
    }
    text
}
