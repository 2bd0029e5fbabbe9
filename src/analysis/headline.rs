//! The answers that a report begins with: of each kind of record its main numbers.

use crate::report::{Cell, Table};
use serde_json::{Map, Value};

/// Name, key and unit of a column; `unit` as a unit is that of the record.
type Column = (&'static str, &'static str, &'static str);

/// Main numbers of one kind of record: title, key of the results, list of numbers in each record (empty: of the record itself), and columns.
type Headline = (&'static str, &'static str, &'static str, &'static [Column]);

const FREQUENCY: Column = ("frequency", "frequency", "Hz");
const DAMPING: Column = ("damping ratio", "zeta", "");
const RESTITUTION: Column = ("restitution", "restitution", "");

/// All headlines, in the order of the report.
const HEADLINES: &[Headline] = &[
    (
        "Resonances",
        "responses",
        "resonances",
        &[("kind", "kind", ""), FREQUENCY, ("amplitude", "amplitude", "unit")],
    ),
    ("Jumps", "responses", "jumps", &[("change", "change", ""), FREQUENCY]),
    ("Modes", "frf", "modes", &[FREQUENCY, DAMPING]),
    (
        "Hammer drill",
        "drill",
        "",
        &[
            ("speed", "speed", "Hz"),
            ("velocity before impact", "before", "m/s"),
            RESTITUTION,
            ("impacts", "impacts", ""),
        ],
    ),
    ("Impacts", "impacts", "", &[("impacts", "n", ""), FREQUENCY, ("impacts/cycles", "per_cycle", "")]),
    ("Restitution", "drops", "", &[("coefficient of restitution", "restitution", "")]),
    ("Free decays", "decays", "modes", &[FREQUENCY, DAMPING]),
    (
        "Contact pulses",
        "pulses",
        "",
        &[("damping ratio ξ", "xi", ""), RESTITUTION, ("duration", "duration", "s")],
    ),
];

/// Why the modes of a sweep differ from its resonances.
const OF_SWEEP: &str =
    "Modes of a sweep use all its points and their phase; its resonances are by the points around each peak.";

/// Rows of a headline, at most.
const ROWS: usize = 10;

/// The headlines of results.
pub fn headlines(results: &Map<String, Value>) -> Vec<Table> {
    let tables = HEADLINES.iter().filter_map(|headline| {
        let (title, key, _, columns) = *headline;
        let records = results.get(key)?.as_array()?;
        let unit = |unit: &'static str| match unit {
            "unit" => records.first().and_then(|r| r["unit"].as_str()).unwrap_or_default().to_owned(),
            fixed => fixed.to_owned(),
        };
        let empty = Table::new(title).column("record", "");
        let empty = columns.iter().fold(empty, |table, (name, _, of)| table.column(*name, unit(of)));
        let empty = empty.column("remark", "");
        let rows: Vec<Vec<Cell>> = records.iter().flat_map(|record| rows(headline, record)).collect();
        let more = rows.len().saturating_sub(ROWS);
        let table = rows.into_iter().take(ROWS).fold(empty, Table::row);
        let has_modes = |record: &Value| record["modes"].as_array().is_some_and(|modes| !modes.is_empty());
        let of_sweep = records.iter().any(|record| record["file"] == "" && has_modes(record));
        Some(match more {
            0 if key == "frf" && of_sweep => table.note(OF_SWEEP),
            0 => table,
            _ => table.note(format!("{more} more below.")),
        })
    });
    let scores = agreement(results);
    tables.chain(scores).filter(|table| !table.rows.is_empty()).collect()
}

fn rows((.., list, columns): &Headline, record: &Value) -> Vec<Vec<Cell>> {
    let name = record["name"].as_str().unwrap_or_default();
    let doubtful =
        record["findings"].as_array().is_some_and(|all| all.iter().any(|found| found["severity"] == "doubt"));
    let own = vec![record.clone()];
    let items = if list.is_empty() { Some(&own) } else { record[*list].as_array() };
    let row = |item: &Value| {
        let cells = columns.iter().map(|(_, key, _)| cell(item, key));
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
    let pair = |value: &Value, std: &Value| {
        value.as_f64().map_or(Cell::Missing, |value| Cell::Estimate { value, std: std.as_f64() })
    };
    match &item[key] {
        number @ Value::Number(_) => pair(number, &item[format!("{key}_std")]),
        Value::String(word) => word.as_str().into(),
        Value::Array(all) if all.is_empty() => Cell::Missing,
        Value::Array(all) => all.len().into(),
        Value::Object(ratio) if ratio.contains_key("cycles") => {
            format!("{}/{}", ratio["impacts"], ratio["cycles"]).into()
        }
        estimate => pair(&estimate["value"], &estimate["std"]),
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
