//! The answers that a report begins with: of each kind of record its main numbers.

use crate::report::{Cell, Table};
use serde_json::{Map, Value};

/// Main numbers of one kind of record.
struct Headline {
    title: &'static str,
    /// Key of the results.
    records: &'static str,
    /// List of numbers in each record, or that of the record itself.
    list: &'static str,
    /// Name, key and unit of each column; `unit` as a unit is that of the record.
    columns: &'static [(&'static str, &'static str, &'static str)],
}

/// All headlines, in the order of the report.
const HEADLINES: &[Headline] = &[
    Headline {
        title: "Resonances",
        records: "responses",
        list: "resonances",
        columns: &[
            ("kind", "kind", ""),
            ("frequency", "frequency", "Hz"),
            ("amplitude", "amplitude", "unit"),
        ],
    },
    Headline {
        title: "Jumps",
        records: "responses",
        list: "jumps",
        columns: &[("change", "change", ""), ("frequency", "frequency", "Hz")],
    },
    Headline {
        title: "Modes",
        records: "frf",
        list: "modes",
        columns: &[("frequency", "frequency", "Hz"), ("damping ratio", "zeta", "")],
    },
    Headline {
        title: "Hammer drill",
        records: "drill",
        list: "",
        columns: &[
            ("speed", "speed", "Hz"),
            ("velocity before impact", "before", "m/s"),
            ("restitution", "restitution", ""),
            ("impacts", "impacts", ""),
        ],
    },
    Headline {
        title: "Impacts",
        records: "impacts",
        list: "",
        columns: &[
            ("impacts", "n", ""),
            ("frequency", "frequency", "Hz"),
            ("impacts/cycles", "per_cycle", ""),
        ],
    },
    Headline {
        title: "Restitution",
        records: "drops",
        list: "",
        columns: &[("coefficient of restitution", "restitution", "")],
    },
    Headline {
        title: "Free decays",
        records: "decays",
        list: "modes",
        columns: &[("frequency", "frequency", "Hz"), ("damping ratio", "zeta", "")],
    },
    Headline {
        title: "Contact pulses",
        records: "pulses",
        list: "",
        columns: &[
            ("damping ratio ξ", "xi", ""),
            ("restitution", "restitution", ""),
            ("duration", "duration", "s"),
        ],
    },
];

/// Why the modes of a sweep differ from its resonances.
const OF_SWEEP: &str =
    "Modes of a sweep use all its points and their phase; its resonances are by the points around each peak.";

/// Rows of a headline, at most.
const ROWS: usize = 10;

/// The headlines of results.
pub fn headlines(results: &Map<String, Value>) -> Vec<Table> {
    let tables = HEADLINES.iter().filter_map(|headline| {
        let records = results.get(headline.records)?.as_array()?;
        let unit = |unit: &'static str| match unit {
            "unit" => records.first().and_then(|r| r["unit"].as_str()).unwrap_or_default().to_owned(),
            fixed => fixed.to_owned(),
        };
        let empty = Table::new(headline.title).column("record", "");
        let empty = headline
            .columns
            .iter()
            .fold(empty, |table, (name, _, of)| table.column(*name, unit(of)))
            .column("doubt", "");
        let rows: Vec<Vec<Cell>> = records.iter().flat_map(|record| rows(headline, record)).collect();
        let more = rows.len().saturating_sub(ROWS);
        let table = rows.into_iter().take(ROWS).fold(empty, Table::row);
        let has_modes = |record: &Value| record["modes"].as_array().is_some_and(|modes| !modes.is_empty());
        let of_sweep = records.iter().any(|record| record["file"] == "" && has_modes(record));
        Some(match more {
            0 if headline.records == "frf" && of_sweep => table.note(OF_SWEEP),
            0 => table,
            _ => table.note(format!("{more} more below.")),
        })
    });
    let scores = agreement(results);
    tables.chain(scores).filter(|table| !table.rows.is_empty()).collect()
}

fn rows(headline: &Headline, record: &Value) -> Vec<Vec<Cell>> {
    let name = record["name"].as_str().unwrap_or_default();
    let doubtful =
        record["findings"].as_array().is_some_and(|all| all.iter().any(|found| found["severity"] == "doubt"));
    let own = vec![record.clone()];
    let items = if headline.list.is_empty() { Some(&own) } else { record[headline.list].as_array() };
    let row = |item: &Value| {
        let cells = headline.columns.iter().map(|(_, key, _)| cell(item, key));
        let doubt = match item["at_jump"].as_bool() {
            _ if doubtful => "see the doubt",
            Some(true) => "ends in a jump",
            _ => "",
        };
        std::iter::once(name.into()).chain(cells).chain([doubt.into()]).collect()
    };
    items.map_or_else(Vec::new, |items| items.iter().map(row).collect())
}

/// The number, estimate or word of a key.
fn cell(item: &Value, key: &str) -> Cell {
    match &item[key] {
        Value::Number(number) => {
            let std = item[format!("{key}_std")].as_f64();
            number.as_f64().map_or(Cell::Missing, |value| Cell::Estimate { value, std })
        }
        Value::String(word) => word.as_str().into(),
        Value::Array(all) if all.is_empty() => Cell::Missing,
        Value::Array(all) => all.len().into(),
        Value::Object(ratio) if ratio.contains_key("cycles") => {
            format!("{}/{}", ratio["impacts"], ratio["cycles"]).into()
        }
        Value::Object(estimate) => {
            estimate.get("value").and_then(Value::as_f64).map_or(Cell::Missing, |value| Cell::Estimate {
                value,
                std: estimate.get("std").and_then(Value::as_f64),
            })
        }
        _ => Cell::Missing,
    }
}

/// Agreement with the model, sweep by sweep.
fn agreement(results: &Map<String, Value>) -> Option<Table> {
    let scores = results.get("overlay")?["scores"].as_array()?;
    let table = Table::new("Agreement with the model").column("sweep", "").column("points compared", "");
    let table = table.column("median deviation", "%").column("largest", "%");
    let percent = |score: &Value, key: &str| Cell::from(score[key].as_f64().map(|part| 100.0 * part));
    let count = |score: &Value, key: &str| score[key].as_u64().unwrap_or(0) as usize;
    let compared = |score: &Value| Cell::from(count(score, "n").saturating_sub(count(score, "faint")));
    let row = |score: &Value| {
        let name = score["sweep"].as_str().unwrap_or_default();
        [name.into(), compared(score), percent(score, "median_relative"), percent(score, "max_relative")]
    };
    Some(scores.iter().map(row).fold(table, Table::row))
}
