//! The report of a campaign as one page.

use super::job::{Crossing, Results};
use super::{Drawing, Figure, Page, tables};
use crate::measure::resonance::ResonanceKind;
use crate::model::Rig;
use crate::record::Step;
use crate::units::notation::{shortest, significant};
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
        page = page.table(&tables::curve(response));
    }
    let histories: Vec<(String, String)> =
        results.responses.iter().map(|r| (r.name.clone(), history(&r.history))).collect();
    if let Some(rig) = &results.rig {
        let values = rig_values(rig);
        page = page.details("Rig of the comparison", values.iter().map(|(n, v)| (*n, v.as_str())));
    }
    page = page
        .heading("Where the numbers come from")
        .details("Steps from file to curve", histories.iter().map(|(n, h)| (n.as_str(), h.as_str())));
    page.paragraph(&format!(
        "Made by vibroimpact {}. All numbers are in results.json beside this page.",
        results.version
    ))
}

/// One sentence for each named resonance, and one for each direction in which both masses were measured.
fn summary(results: &Results) -> Vec<String> {
    let mut sentences = Vec::new();
    for kind in [ResonanceKind::Grazing, ResonanceKind::Clapping] {
        // Sweeps by the frequency as it is printed.
        let mut found: Vec<(String, Vec<&str>)> = Vec::new();
        for response in &results.responses {
            for r in response.resonances.iter().filter(|r| r.kind == kind) {
                let frequency = format!("{:.2} Hz", r.frequency);
                match found.iter_mut().find(|f| f.0 == frequency) {
                    Some(known) => known.1.push(&response.name),
                    None => found.push((frequency, vec![&response.name])),
                }
            }
        }
        if !found.is_empty() {
            let places: Vec<String> =
                found.iter().map(|(f, sweeps)| format!("{f} ({})", sweeps.join("; "))).collect();
            sentences.push(format!("The {} resonance lies at {}.", kind.name(), places.join(", ")));
        }
    }
    let same = |a: &Crossing, b: &Crossing| (a.direction, a.force) == (b.direction, b.force);
    for crossings in results.crossings.chunk_by(same) {
        let mut stretches = Vec::new();
        for (i, crossing) in crossings.iter().enumerate() {
            match crossing.larger_above {
                2 => stretches.push(match crossings.get(i + 1) {
                    Some(end) => format!("between {:.2} and {:.2} Hz", crossing.frequency, end.frequency),
                    None => format!("above {:.2} Hz", crossing.frequency),
                }),
                _ if i == 0 => stretches.push(format!("below {:.2} Hz", crossing.frequency)),
                _ => {}
            }
        }
        let Some(first) = crossings.first().filter(|_| !stretches.is_empty()) else { continue };
        let force = first.force.map_or_else(String::new, |f| format!(" at {} N", significant(f, 3)));
        sentences.push(format!(
            "Going {}{force}, the passive mass moves more than the excited one {}.",
            first.direction.name(),
            stretches.join(" and ")
        ));
    }
    sentences
}

fn rig_values(rig: &Rig) -> [(&'static str, String); 8] {
    [
        ("m1, excited mass", format!("{} kg", rig.m1)),
        ("m2, passive mass", format!("{} kg", rig.m2)),
        ("k1", format!("{} N/m", rig.k1)),
        ("k2", format!("{} N/m", rig.k2)),
        ("c1", format!("{} N s/m", rig.c1)),
        ("c2", format!("{} N s/m", rig.c2)),
        ("gap", format!("{} m", rig.gap)),
        ("restitution", rig.restitution.to_string()),
    ]
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
