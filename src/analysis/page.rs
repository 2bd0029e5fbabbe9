//! The report of a campaign as one page.

use super::{Answer, Job};
use crate::record::Step;
use crate::report::words::{Voice, sentences};
use crate::report::{Drawing, Page};
use crate::units::notation::shortest;
use std::fmt::Write as _;

/// Lays out all that is shown, with the drawings of its figures.
pub fn page(job: &Job<'_>, version: &str, all: &Answer, drawings: &[Drawing]) -> Page {
    let warnings = sentences(&all.findings, Voice::Campaign, true);
    let page = warnings.into_iter().fold(Page::new(job.title.as_str()), Page::warning);
    let mut page = all.tables.iter().fold(page, Page::table);
    for ((name, figure), drawing) in all.figures.iter().zip(drawings) {
        let files = [format!("{name}.svg"), format!("{name}.png")];
        page = page.figure(drawing, &figure.caption, &files.each_ref().map(String::as_str));
    }
    page = all.details.iter().fold(page, Page::table);
    if !job.constants.is_empty() {
        let values = job.constants.iter().map(|(name, value)| (name.as_str(), value.as_str()));
        page = page.details("Rig of the comparison", values);
    }
    let steps: Vec<(&str, String)> =
        job.histories.iter().map(|(name, steps)| (name.as_str(), history(steps))).collect();
    page.heading("Processing")
        .details("Steps from file to result", steps.iter().map(|(name, text)| (*name, text.as_str())))
        .paragraph(&format!(
            "Made by vibroimpact {version}. All numbers are in results.json beside this page."
        ))
}

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
