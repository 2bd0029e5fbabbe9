//! Faulty tables of a campaign: a run leaves out only the faulty table, and a check names all of them.

use super::init::write;
use super::stepped::write_steps;
use super::{complaint, json, text, vibro};
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use vibroimpact::math::Noise;

/// Writes a free decay and a campaign of this text into a folder.
fn campaign(root: &Path, tables: &str) {
    write(&root.join("ok.csv"), "displacement [mm]", 2000.0, 3.0, &mut |t| {
        (-0.02 * TAU * 37.0 * t).exp() * (TAU * 37.0 * t).sin()
    });
    fs::write(root.join("campaign.toml"), tables).unwrap();
}

fn warnings(run: &Value) -> String {
    run["results"]["warnings"].to_string()
}

#[test]
fn a_table_with_an_impossible_value_or_without_its_file_loses_only_itself() {
    let root = tempfile::tempdir().unwrap();
    let good = "[[decay]]\nname = \"good\"\nfile = \"ok.csv\"\n";
    for (table, line, said) in [
        ("[[decay]]\nname = \"bad\"\nfile = \"ok.csv\"\nband = [0, inf]\n", "line 7", "band is inf"),
        ("[[decay]]\nname = \"bad\"\nfile = \"gone.csv\"\n", "line 6", "gone.csv does not exist"),
        ("[[impacts]]\nname = \"bad\"\nfile = \"gone*.csv\"\n", "line 6", "no file matches"),
        ("[[impacts]]\nname = \"bad\"\nchannel = 2\n", "line 6", "channel without a file"),
        ("[[frf]]\nname = \"bad\"\nsweep = \"none\"\n", "line 6", "no sweep is named"),
        ("[[sweep]]\nname = \"bad\"\nlist = \"gone.txt\"\n", "line 6", "gone.txt does not exist"),
        ("[[drop]]\nname = \"bad\"\nfile = \"gone.wav\"\nheight = 1\n", "line 6", "gone.wav does not exist"),
    ] {
        campaign(root.path(), &format!("{good}{table}"));
        let run = json(&["run", text(root.path())]);
        assert_eq!(run["results"]["decays"].as_array().unwrap().len(), 1, "{table}: {run}");
        let warnings = warnings(&run);
        assert!(warnings.contains(said) && warnings.contains("Left out"), "{table}: {warnings}");
        assert!(warnings.contains(line) || said.starts_with("no sweep"), "{table}: {warnings}");
        let found = complaint(&["check", text(root.path())], 2);
        assert!(found.contains(said) && found.contains(line), "{table}: {found}");
        // If it is the only table, the run fails with its error.
        campaign(root.path(), table);
        let found = complaint(&["run", text(root.path())], 2);
        assert!(found.contains(said), "{table}: {found}");
    }
}

#[test]
fn a_check_names_every_fault_and_what_is_no_campaign_ends_a_run() {
    let root = tempfile::tempdir().unwrap();
    let bad = "[[decay]]\nfile = \"gone.csv\"\n[[decay]]\nfile = \"ok.csv\"\nband = [0, inf]\n\
               [[impacts]]\nfile = \"ok.csv\"\nchannel = \"none\"\n";
    campaign(root.path(), bad);
    let found = complaint(&["check", text(root.path())], 2);
    for said in ["gone.csv", "band is inf", "\"none\""] {
        assert!(found.contains(said), "{found}");
    }
    let output = vibro(&["check", text(root.path()), "--json"]);
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(object["error"].as_str().unwrap().contains("gone.csv") && object["exit_code"] == 2, "{object}");
    let good = "[[decay]]\nfile = \"ok.csv\"\n";
    for wrong in ["[[decay]]\nfil = \"ok.csv\"\n", "[[decay]\n", "[[decay]]\nfile = 3\n"] {
        campaign(root.path(), &format!("{good}{wrong}"));
        complaint(&["run", text(root.path())], 2);
        assert!(!root.path().join("results").exists());
    }
}

/// Two sweeps of one name: the results of the second would replace those of the first.
#[test]
fn of_two_tables_of_one_name_the_second_is_left_out() {
    let root = tempfile::tempdir().unwrap();
    let steps = |name: &str| -> Vec<(String, f64)> {
        (1..=6).map(|k| (format!("{name}{k}.csv"), 15.0 + 4.0 * f64::from(k))).collect()
    };
    let table = |files: &str| {
        format!("[[sweep]]\nname = \"up\"\ntraces = \"{files}*.csv\"\nforce = 1\nresponse = 2\n")
    };
    write_steps(root.path(), &steps("a"), 6.0);
    write_steps(root.path(), &steps("b"), 6.0);
    campaign(root.path(), &format!("{}{}[[decay]]\nfile = \"ok.csv\"\n", table("a"), table("b")));
    let run = json(&["run", text(root.path())]);
    let results = &run["results"];
    assert_eq!(
        [results["responses"].as_array().unwrap().len(), results["decays"].as_array().unwrap().len()],
        [1, 1]
    );
    assert!(warnings(&run).contains("two sweeps are named \\\"up\\\""), "{}", warnings(&run));
}

#[test]
fn a_file_in_two_tables_is_a_caution() {
    let root = tempfile::tempdir().unwrap();
    let steps: Vec<(String, f64)> =
        (1..=6).map(|k| (format!("s{k}.csv"), 15.0 + 4.0 * f64::from(k))).collect();
    write_steps(root.path(), &steps, 6.0);
    let sweep = "[[sweep]]\nname = \"up\"\ntraces = \"s*.csv\"\nforce = \"Force\"\nresponse = \"Accel\"\n";
    let again = sweep.replace("\"up\"", "\"again\"").replace("s*", "s[12]");
    let decay = "[[decay]]\nname = \"one\"\nfile = \"ok.csv\"\n";
    let tables = format!("{sweep}{again}{decay}{}", decay.replace("one", "two"));
    campaign(root.path(), &tables);
    let twice = |answer: &Value| -> Vec<(String, f64)> {
        let all = answer["findings"].as_array().unwrap().iter();
        let named = all.filter(|found| found["code"] == "file-named-twice");
        let of = |found: &Value| {
            let subject = found["subject"].as_str().unwrap().to_owned();
            (subject, found["numbers"]["n"].as_f64().unwrap())
        };
        named.map(of).collect()
    };
    let expected = [("two".to_owned(), 1.0), ("again".to_owned(), 2.0)];
    assert_eq!(twice(&json(&["check", text(root.path())])), expected);
    assert_eq!(twice(&json(&["run", text(root.path())])["results"]), expected);
    // Another channel, another part of a record or another analysis is no repetition.
    let other =
        format!("{decay}span = [0, 1]\n{}[[spectrum]]\nfile = \"ok.csv\"\n", decay.replace("one", "two"));
    campaign(root.path(), &other);
    assert!(twice(&json(&["check", text(root.path())])).is_empty());
}

/// A record that waits for a value is named at the head of the report, in view, and only there.
#[test]
fn a_record_that_waits_for_a_value_stands_at_the_head_of_the_report() {
    let root = tempfile::tempdir().unwrap();
    let waits = "#[[drop]]\n#file = \"ball.csv\"\n#height =\n";
    campaign(root.path(), &format!("[[decay]]\nfile = \"ok.csv\"\n\n{waits}"));
    json(&["run", text(root.path())]);
    let report = fs::read_to_string(root.path().join("results/report.html")).unwrap();
    let said = "ball.csv is not measured yet: state height.";
    let (head, _) = report.split_once("Free decays</h2>").unwrap();
    assert_eq!(report.matches(said).count(), 1, "{report}");
    assert!(head.contains(said) && !head.split(said).next().unwrap().contains("<details"), "{head}");
}

/// A single step of a sweep has power in one line only.
#[test]
fn a_function_of_a_lone_sine_is_refused() {
    let root = tempfile::tempdir().unwrap();
    write_steps(root.path(), &[("sine.csv".to_owned(), 26.0)], 6.0);
    let file = root.path().join("sine.csv");
    let found = complaint(&["modal", text(&file), "--reference", "Force"], 1);
    assert!(found.contains("Force is a sine of 26.000 Hz alone"), "{found}");
    assert!(found.contains("vibro response") && found.contains("vibro spectrum"), "{found}");
    // The suggested command works.
    let answer = json(&["spectrum", text(&file), "--channel", "Accel", "--tones", "1"]);
    assert!((answer["tones"][0]["frequency"]["value"].as_f64().unwrap() - 26.0).abs() < 1e-3, "{answer}");
    let table = "[[frf]]\nname = \"lone\"\nfile = \"sine.csv\"\nreference = \"Force\"\n[[decay]]\nfile = \"ok.csv\"\n";
    campaign(root.path(), table);
    let run = json(&["run", text(root.path())]);
    assert_eq!(warnings(&run).matches("sine of 26.000 Hz alone").count(), 1, "{}", warnings(&run));
    assert!(!root.path().join("results/frf_1.svg").exists());
}

#[test]
fn a_campaign_file_of_another_program_is_not_touched() {
    let root = tempfile::tempdir().unwrap();
    for text_of_other in ["[package]\nversion = \"1\"\n", "campaign:\n  - a: 1\n"] {
        campaign(root.path(), text_of_other);
        let found = complaint(&["init", text(root.path())], 2);
        assert!(found.contains("no campaign of vibro") && found.contains("try: mv "), "{found}");
        assert_eq!(fs::read_to_string(root.path().join("campaign.toml")).unwrap(), text_of_other);
        // The suggested command works.
        let (from, to) = (root.path().join("campaign.toml"), root.path().join("campaign.other.toml"));
        fs::rename(from, to).unwrap();
        json(&["init", text(root.path())]);
    }
}

/// Force and response in separate files give the same function as in one file, bit for bit.
#[test]
fn a_reference_may_lie_in_a_file_of_its_own() {
    let root = tempfile::tempdir().unwrap();
    let mut noise = Noise::new(4);
    let (mut last, mut before) = (0.0, 0.0);
    let mut both = "time [s],force [N],velocity [m/s]\n".to_owned();
    let [mut force, mut velocity] =
        ["time [s],force [N]\n".to_owned(), "time [s],velocity [m/s]\n".to_owned()];
    for i in 0..8192 {
        let (t, f) = (f64::from(i) / 1024.0, noise.normal());
        // A mode at 100 Hz that loses 5 % of its amplitude a sample.
        let v = 2.0 * 0.95 * (TAU * 100.0 / 1024.0).cos() * last - 0.95 * 0.95 * before + 0.01 * f;
        (before, last) = (last, v);
        writeln!(both, "{t:.10},{f:.6},{v:.7}").unwrap();
        writeln!(force, "{t:.10},{f:.6}").unwrap();
        writeln!(velocity, "{t:.10},{v:.7}").unwrap();
    }
    let at = |name: &str| root.path().join(name);
    for (name, text) in [("both.csv", &both), ("force.csv", &force), ("velocity.csv", &velocity)] {
        fs::write(at(name), text).unwrap();
    }
    let beside = format!("{}#force", text(&at("force.csv")));
    let modal = |file: &str, reference: &str| {
        json(&[
            "modal",
            text(&at(file)),
            "--reference",
            reference,
            "--channel",
            "velocity",
            "--segment",
            "1024",
        ])
    };
    let expected = modal("both.csv", "force")["modes"].clone();
    assert!((expected[0]["frequency"]["value"].as_f64().unwrap() - 100.0).abs() < 2.0, "{expected}");
    assert_eq!(modal("velocity.csv", &beside)["modes"], expected);
    let table = |reference: &str| {
        format!("[[frf]]\nfile = \"velocity.csv\"\nreference = \"{reference}\"\nsegment = 1024\n")
    };
    fs::write(at("campaign.toml"), table("force.csv#force")).unwrap();
    assert_eq!(json(&["check", text(root.path())])["files"].as_array().unwrap().len(), 2);
    assert_eq!(json(&["run", text(root.path())])["results"]["frf"][0]["modes"], expected);
    fs::write(at("campaign.toml"), table("gone.csv#force")).unwrap();
    assert!(complaint(&["check", text(root.path())], 2).contains("gone.csv does not exist"));
    // A reference of another length is refused.
    fs::write(at("force.csv"), force.lines().take(4000).collect::<Vec<_>>().join("\n")).unwrap();
    let said = complaint(&["modal", text(&at("velocity.csv")), "--reference", &beside], 2);
    assert!(said.contains("reference in") && said.contains("samples"), "{said}");
}

/// Both masses are measured under the same force, which is recorded once for each step.
#[test]
fn a_force_may_be_that_of_two_sweeps() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/two_mass_rig/campaign.toml");
    let found = json(&["check", text(&example)]);
    let codes = found["findings"].as_array().unwrap().iter().map(|found| &found["code"]);
    assert!(!codes.into_iter().any(|code| code == "file-named-twice"), "{found}");
}
