//! Hammer drills of a campaign.

use super::{JobOptions, PARTS, Progress, file_name, merge, or_left_out, slugs};
use crate::campaign::Campaign;
use crate::error::Result;
use crate::measure::drill::Drill;
use crate::report::words::{Voice, sentences};
use crate::report::{Figure, Output, pictures, tables};
use serde::Serialize;
use std::cell::Cell;

/// What a drill's record gave.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrillResult {
    /// Name of the record.
    pub name: String,
    /// File.
    pub file: String,
    /// What was found.
    #[serde(flatten)]
    pub drill: Drill,
}

pub(super) fn drills(
    campaign: &Campaign,
    options: JobOptions,
    progress: &dyn Progress,
    figures: &mut Vec<(String, Figure)>,
    warnings: &mut Vec<String>,
) -> Result<Vec<DrillResult>> {
    let mut results = Vec::new();
    for entry in &campaign.drill {
        let name = entry.name.clone().unwrap_or_else(|| file_name(entry.record().file.get_ref()));
        let asked = or_left_out(campaign.drill(entry, options.allow_outside), &name, warnings)?;
        let Some((file, how)) = asked else { continue };
        progress.start(&format!("drill {name}"), PARTS);
        let shown = Cell::new(0);
        let drill = file.measure(&how, &|done, all| {
            let parts = (PARTS * done).checked_div(all).unwrap_or(0);
            (shown.replace(parts)..parts).for_each(|_| progress.step());
        });
        let Some(drill) = or_left_out(drill, &name, warnings)? else { continue };
        merge(warnings, &name, &sentences(&drill.findings, Voice::Campaign));
        results.push(DrillResult { name, file: file_name(&file.path), drill });
    }
    for (slug, result) in slugs(results.iter().map(|r| r.name.as_str())).iter().zip(&results) {
        let drawn = pictures::drill(&result.name, &result.drill);
        figures.extend(drawn.into_iter().map(|(name, figure)| (format!("{name}_{slug}"), figure)));
    }
    Ok(results)
}

/// Writes each record's impacts and its average turn.
pub(super) fn tables(results: &[DrillResult], output: &mut Output) -> Result<()> {
    for (slug, found) in slugs(results.iter().map(|r| r.name.as_str())).iter().zip(results) {
        output.write(&format!("drill_impacts_{slug}.csv"), tables::drill_impacts(&found.drill).csv())?;
        output.write(&format!("drill_average_{slug}.csv"), tables::drill_average(&found.drill).csv())?;
    }
    Ok(())
}
