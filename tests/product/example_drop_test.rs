//! The example drop test: its generator reproduces the data, and its campaign recovers the true values.

use serde_json::Value;
use std::path::{Path, PathBuf};
use vibro_demo::drop_test as records;
use vibroimpact::analysis::{self, AnswerCache};
use vibroimpact::read::Owner;
use vibroimpact::report::Output;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/drop_test")
}

#[test]
fn the_records_come_out_again() {
    let all = records::all();
    assert!(all.iter().map(|(_, text)| text.len()).sum::<usize>() < 300_000);
    for (name, text) in all {
        let committed = std::fs::read_to_string(folder().join(&name)).unwrap();
        assert!(committed == text, "{name} differs from what the generator makes");
    }
}

#[test]
fn the_campaign_gives_back_the_truth() {
    let campaign = analysis::open(folder().join("campaign.toml")).unwrap();
    let out = tempfile::tempdir().unwrap();
    let mut output = Output::new(out.path(), Owner::Run).unwrap();
    let results = analysis::run(&campaign, &AnswerCache::default(), &mut output, &()).unwrap();
    output.commit().unwrap();
    let results = Value::Object(results.answer.result);
    let estimate = |found: &Value| (found["value"].as_f64().unwrap(), found["std"].as_f64().unwrap());
    let drops = &results["drops"][0];
    assert_eq!(drops["files"].as_array().unwrap().len(), 5);
    // Five drops whose restitution scatters by 2 %: the mean lies within four standard uncertainties.
    let (r, u) = estimate(&drops["restitution"]);
    assert!((r - records::RESTITUTION).abs() < 4.0 * u && u < 0.02 * r, "{drops}");
    let lively = &results["drops"][1];
    let by = lively["by"].as_array().unwrap();
    assert!(lively["agree"] == true && by.len() == 2, "{lively}");
    for way in by {
        let (r, u) = estimate(&way["restitution"]);
        assert!((r - records::LIVELY).abs() < 4.0 * u && u < 0.005, "{way}");
    }
    let contact = &results["impacts"][0];
    let truth = std::fs::read_to_string(folder().join("TRUTH.csv")).unwrap();
    let count = truth.lines().find_map(|l| l.strip_prefix("impacts in the contact trace,")).unwrap();
    assert_eq!(contact["n"].to_string(), count.trim_end_matches(','));
    assert_eq!(contact["per_cycle"], serde_json::json!({ "impacts": 1, "cycles": 2 }));
    let (f, u) = estimate(&contact["frequency"]);
    assert!((f - records::EXCITATION / 2.0).abs() < 4.0 * u, "{contact}");
    assert!((contact["hum"]["frequency"].as_f64().unwrap() - 50.02).abs() < 0.01, "{}", contact["hum"]);
    for file in ["drop_1.svg", "drop_2.png", "impacts_1.svg", "impacts_1.csv", "results.json", "report.html"]
    {
        assert!(out.path().join(file).is_file(), "{file}");
    }
    let json: Value =
        serde_json::from_str(&std::fs::read_to_string(out.path().join("results.json")).unwrap()).unwrap();
    assert_eq!(json["drops"][0]["name"], "ball on plate");
    assert_eq!(json["impacts"][0]["per_cycle"]["cycles"], 2);
}

#[test]
fn drops_of_one_name_with_other_heights_are_left_out_with_their_line() {
    let out = tempfile::tempdir().unwrap();
    let run = |names: [&str; 2], height_std: f64| {
        for file in ["DROP01.CSV", "DROP02.CSV"] {
            std::fs::copy(folder().join(file), out.path().join(file)).unwrap();
        }
        let text = format!(
            "[[drop]]\n{}file = \"DROP01.CSV\"\nheight = 0.57\nheight_std = 0.001\n\n[[drop]]\n{}file = \"DROP02.CSV\"\nheight = 0.57\nheight_std = {height_std}\n",
            names[0], names[1]
        );
        std::fs::write(out.path().join("campaign.toml"), text).unwrap();
        let campaign = analysis::open(out.path().join("campaign.toml"))?;
        let mut output = Output::new(out.path().join("out"), Owner::Run).unwrap();
        analysis::run(&campaign, &AnswerCache::default(), &mut output, &())
    };
    let name = "name = \"a\"\n";
    let drops = |names| run(names, 0.001).unwrap().answer.result["drops"].as_array().unwrap().len();
    assert_eq!((drops([name, name]), drops(["", ""])), (1, 2));
    // The second drop is left out, with a warning that gives its line; the first is analysed alone.
    let answer = run([name, name], 0.01).unwrap().answer;
    let files = &answer.result["drops"][0]["files"];
    assert_eq!(files, &serde_json::json!(["DROP01.CSV"]), "{files}");
    let warnings = answer.result["warnings"].to_string();
    assert!(warnings.contains("another height_std") && warnings.contains("line 11"), "{warnings}");
}
