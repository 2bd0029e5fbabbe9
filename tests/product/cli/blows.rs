//! Hammer tests whose blows are records of their own in one file.

use super::{json, text, vibro};
use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::Path;
use vibroimpact::math::Noise;
use vibroimpact::record::{Axis, Meta, Record, Trace};
use vibroimpact::units::Unit;
use vibroimpact::write::uff58::{Storage, write_uff58};

const RATE: f64 = 2048.0;

/// Writes force and velocity of a blow for each number of samples, under the same two names.
fn write(path: &Path, lengths: &[usize]) {
    let mut noise = Noise::new(3);
    let mut records = Vec::new();
    for n in lengths {
        let peak = 60.0 + 60.0 * noise.uniform();
        let since = |i: usize| (i as f64 - 100.0) / RATE;
        let force =
            |i: usize| if (100..112).contains(&i) { peak * (PI * since(i) * RATE / 12.0).sin() } else { 0.0 };
        let ring =
            |t: f64| if t < 0.0 { 0.0 } else { (-0.02 * TAU * 40.0 * t).exp() * (TAU * 40.0 * t).cos() };
        // Each sample of the force is a small impulse on 4 kg.
        let velocity = |i: usize| (100..112).map(|k| force(k) / RATE / 4.0 * ring(since(i) - since(k))).sum();
        for (name, unit, values) in [
            ("hammer", "N", (0..*n).map(force).collect::<Vec<f64>>()),
            ("plate", "m/s", (0..*n).map(velocity).collect()),
        ] {
            let scale = values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            let values = values.iter().map(|v| v + 1e-3 * scale * noise.normal()).collect();
            let meta = Meta::new(name, Unit::parse_or_opaque(unit));
            records.push(Record::Trace(Trace { meta, axis: Axis::time(0.0, 1.0 / RATE, *n), values }));
        }
    }
    let mut bytes = Vec::new();
    write_uff58(&records, &mut bytes, Storage::default()).unwrap();
    fs::write(path, bytes).unwrap();
}

fn codes(answer: &serde_json::Value) -> Vec<&str> {
    answer["findings"].as_array().unwrap().iter().filter_map(|found| found["code"].as_str()).collect()
}

#[test]
fn records_of_one_name_are_averaged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plate.uff");
    write(&path, &[4096; 5]);
    let all = ["spectrum", text(&path), "--reference", "hammer", "--channel", "plate", "--hammer"];
    let found = json(&all);
    assert_eq!(found["averages"], 5, "{found}");
    assert!(codes(&found).contains(&"records-joined") && !codes(&found).contains(&"frf-one-blow"));
    // One of them alone has its number.
    let one = ["spectrum", text(&path), "--reference", "hammer #2", "--channel", "plate #2", "--hammer"];
    assert_eq!(json(&one)["averages"], 1);
}

#[test]
fn records_that_cannot_be_averaged_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plate.uff");
    write(&path, &[4096, 4096, 3000]);
    let found = json(&["modal", text(&path), "--reference", "hammer", "--channel", "plate", "--hammer"]);
    assert!(codes(&found).contains(&"records-unused"), "{:?}", codes(&found));
    let said = vibro(&["modal", text(&path), "--reference", "hammer", "--channel", "plate", "--hammer"]);
    let said = String::from_utf8(said.stderr).unwrap();
    assert!(said.contains("--reference \"hammer #2\", --channel \"plate #2\""), "{said}");
}

#[test]
fn a_campaign_takes_all_blows_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("plate.uff"), &[4096; 5]);
    json(&["init", text(folder.path())]);
    let campaign = fs::read_to_string(folder.path().join("campaign.toml")).unwrap();
    assert_eq!(campaign.matches("[[").count(), 1, "{campaign}");
    assert!(campaign.contains("[[frf]]") && campaign.contains("hammer = true"), "{campaign}");
}

/// Of a file with more channels than are tried, the others are named.
#[test]
fn channels_that_are_not_tried_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut noise = Noise::new(8);
    let row = |first: String, others: Vec<String>| first + "," + &others.join(",");
    let mut rows = vec![row("time [s]".to_owned(), (1..11).map(|k| format!("c{k} [V]")).collect())];
    for i in 0..600 {
        let values = (0..10).map(|_| format!("{:.5}", noise.normal())).collect();
        rows.push(row(format!("{:.4}", f64::from(i) * 1e-3), values));
    }
    fs::write(folder.path().join("many.csv"), rows.join("\n")).unwrap();
    let said = vibro(&["init", text(folder.path())]);
    let said = String::from_utf8([said.stdout, said.stderr].concat()).unwrap();
    assert!(said.contains("channels 9 to 10") && said.contains("c9"), "{said}");
}
