//! What matters most of the sweeps of a campaign, in sentences.

use super::Crossing;
use crate::measure::resonance::ResonanceKind;
use crate::measure::response::Response;
use crate::units::notation::significant;

/// One sentence for each named resonance, and one for each direction in which both masses were measured.
pub fn summary(responses: &[Response], crossings: &[Crossing]) -> Vec<String> {
    let mut sentences = Vec::new();
    for kind in [ResonanceKind::Grazing, ResonanceKind::Clapping] {
        // Sweeps by the frequency as it is printed.
        let mut found: Vec<(String, Vec<&str>)> = Vec::new();
        for response in responses {
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
    for crossings in crossings.chunk_by(same) {
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
