use super::*;
use std::fmt::Write as _;

fn json(bench: &mut Workbench, request: &Request) -> Value {
    match bench.answer(request, &()).unwrap() {
        Reply::Json(value) => value,
        Reply::Bytes(_) => panic!("no JSON"),
    }
}

fn set(table: usize, key: &str, value: &str, also: &[(&str, &str)]) -> Request {
    let also = also.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    Request::State { table, key: key.to_owned(), value: value.to_owned(), also }
}

/// An example gives what its run on a disk gives, but for the path of the campaign.
#[test]
fn an_example_runs_in_memory() {
    let mut bench = Workbench::default();
    json(&mut bench, &Request::Example { name: "bench".to_owned() });
    let seen = json(&mut bench, &Request::Look);
    assert_eq!(seen["recordings"].as_array().unwrap().len(), 5);
    let seen = json(&mut bench, &Request::Propose { known: None });
    assert_eq!(seen["tables"].as_array().unwrap().len(), 7);
    let run = json(&mut bench, &Request::Run);
    assert_eq!(run["answered"], true);
    let Reply::Bytes(report) = bench.answer(&Request::File { name: "report.html".to_owned() }, &()).unwrap()
    else {
        panic!("no bytes")
    };
    assert!(report.starts_with(b"<!DOCTYPE html>"));
    assert!(bench.answer(&Request::File { name: "../BENCH.CSV".to_owned() }, &()).is_err());
}

#[test]
fn a_missing_value_is_filled_in_and_the_record_answers() {
    let mut bench = Workbench::named("series");
    let values = |seed: u32| {
        let mut text = "time [s],sound [Pa]\n".to_owned();
        for k in 0..20_000_u32 {
            let (t, noise) = (f64::from(k) * 1e-4, f64::from((k * 7919 + seed) % 101) * 1e-5);
            let ring = |at: f64, size: f64| {
                if t < at { 0.0 } else { size * (-(t - at) / 2e-3).exp() * (9000.0 * (t - at)).sin() }
            };
            let value = noise + ring(0.3, 1.0) + ring(0.9, 0.8) + ring(1.35, 0.6);
            let _ = writeln!(text, "{t},{value}");
        }
        text.into_bytes()
    };
    bench.add("bounce.csv", values(3)).unwrap();
    let seen = json(&mut bench, &Request::Propose { known: None });
    let tables = seen["tables"].as_array().unwrap();
    assert!(!tables.is_empty(), "{seen}");
    let after = json(&mut bench, &set(0, "threshold", "0.2", &[]));
    assert!(after["text"].as_str().unwrap().contains("threshold = 0.2"), "{after}");
    let trace =
        json(&mut bench, &Request::Trace { table: 0, file: 0, from: Some(0.2), to: Some(0.4), columns: 50 });
    assert_eq!(trace["picture"]["low"].as_array().unwrap().len(), 50);
    assert_eq!(trace["n"], 20_000);
}

/// Files that come later get tables of their own; what a person wrote stays.
#[test]
fn a_changed_campaign_is_extended_for_further_files() {
    let mut bench = Workbench::default();
    json(&mut bench, &Request::Example { name: "bench".to_owned() });
    let mine = "name = \"mine\"\n\n[[decay]]\nfile = \"DECAY.CSV\"  # by hand\n".to_owned();
    let seen = json(&mut bench, &Request::Propose { known: Some(mine.clone()) });
    let text = seen["text"].as_str().unwrap();
    assert!(text.starts_with(mine.trim_end()) && text.contains("PULSE.CSV"), "{text}");
    assert_eq!(text.matches("DECAY.CSV").count(), 1);
    let wrong = json(&mut bench, &Request::Propose { known: Some("name = x".to_owned()) });
    assert_eq!((wrong["text"].as_str(), wrong["problems"][0]["line"].as_u64()), (Some("name = x"), Some(1)));
}

#[test]
fn an_error_in_the_text_points_at_its_line() {
    let mut bench = Workbench::named("series");
    let seen = json(&mut bench, &Request::Edit { text: "name = \"x\"\n[[decay]]\nfile = 3\n".to_owned() });
    assert_eq!(seen["problems"][0]["line"], 3, "{seen}");
    let seen = json(&mut bench, &Request::Edit { text: "name = x\n".to_owned() });
    assert_eq!(seen["problems"][0]["line"], 1, "{seen}");
}

/// A table gets another kind; what this does not know is a comment, and all its keys are explained.
#[test]
fn a_table_becomes_one_of_another_kind() {
    let mut bench = Workbench::default();
    json(&mut bench, &Request::Example { name: "bench".to_owned() });
    let seen = json(&mut bench, &Request::Propose { known: None });
    let place = |seen: &Value, file: &str, section: &str| {
        let all = seen["tables"].as_array().unwrap().iter();
        all.clone().position(|table| table["files"] == file && table["section"] == section)
    };
    let table = place(&seen, "PULSE.CSV", "pulse").unwrap();
    let seen = json(&mut bench, &Request::Kind { table, section: "decay".to_owned() });
    let table = place(&seen, "PULSE.CSV", "decay").unwrap();
    assert!(seen["text"].as_str().unwrap().contains("# mass = 0.125"), "{seen}");
    let keys = seen["tables"][table]["keys"].as_array().unwrap();
    let band = keys.iter().find(|row| row["key"] == "band").unwrap();
    assert_eq!(
        (&band["known"], &band["unit"], &band["value"]),
        (&json!("possible"), &json!("Hz"), &json!(""))
    );
    assert!(keys.iter().all(|row| row["meaning"].is_string()), "{keys:?}");
    let unknown = Request::Kind { table, section: "bell".to_owned() };
    assert!(bench.answer(&unknown, &()).is_err());
}

/// Everything that is saved comes back: recordings, campaign, and results that are taken for no recordings.
#[test]
fn an_archive_of_all_is_the_same_folder() {
    let mut bench = Workbench::default();
    json(&mut bench, &Request::Example { name: "bench".to_owned() });
    let before = json(&mut bench, &Request::Look);
    json(&mut bench, &Request::Propose { known: None });
    json(&mut bench, &Request::Run);
    let Reply::Bytes(saved) = bench.answer(&Request::Archive, &()).unwrap() else { panic!("no bytes") };
    let mut again = Workbench::named("bench");
    again.add("bench.zip", saved).unwrap();
    json(&mut again, &Request::Unpack { path: "bench.zip".to_owned() });
    assert_eq!(json(&mut again, &Request::Look), before);
    json(&mut again, &Request::Propose { known: None });
    assert_eq!(json(&mut again, &Request::Run)["answered"], true);
    let file = |bench: &mut Workbench| bench.answer(&Request::File { name: "results.json".to_owned() }, &());
    assert_eq!(file(&mut again).unwrap(), file(&mut bench).unwrap());
}

/// A table that waits for a value is there after files were added to a campaign that was changed.
#[test]
fn what_waits_for_a_value_outlives_further_files() {
    let mut bench = Workbench::named("lab");
    let mut fall = "time [s],sound [Pa]\n".to_owned();
    for k in 0..4000_u32 {
        let t = f64::from(k) * 2.5e-4;
        let ring = |at: f64| if t < at { 0.0 } else { (-(t - at) / 2e-3).exp() * (3000.0 * (t - at)).sin() };
        let value = ring(0.2) + 0.6 * ring(0.5) + 1e-5 * f64::from(k * 7919 % 101);
        writeln!(fall, "{t},{value}").unwrap();
    }
    bench.add("fall.csv", fall.into_bytes()).unwrap();
    let first = json(&mut bench, &Request::Propose { known: None });
    let waits = |seen: &Value| {
        let all = seen["tables"].as_array().unwrap().clone();
        all.into_iter()
            .filter(|table| table["line"].is_null())
            .map(|table| table["files"].clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(waits(&first), [json!("fall.csv")], "{first}");
    let text = format!("# mine\n{}", first["text"].as_str().unwrap());
    bench.add("let_go.csv", b"t [s],x [mm]\n0,1\n0.001,0.9\n0.002,0.7\n".to_vec()).unwrap();
    let second = json(&mut bench, &Request::Propose { known: Some(text) });
    assert_eq!(waits(&second), [json!("fall.csv")], "{second}");
}

/// A value that needs another one is refused with its name, and taken together with it, in either order.
#[test]
fn a_value_that_needs_another_one_waits_for_it() {
    let mut bench = Workbench::default();
    json(
        &mut bench,
        &Request::Edit { text: "[[pulse]]\ntime_to_peak = 6.64e-6\nduration = 18e-6\n".to_owned() },
    );
    let (order, low_pass) = (("order", "2"), ("low_pass", "2e5"));
    for (one, other) in [(order, low_pass), (low_pass, order)] {
        let alone = bench.answer(&set(0, one.0, one.1, &[]), &()).unwrap_err();
        assert!(alone.to_string().contains(other.0), "{alone}");
        assert!(!bench.text.contains(one.0), "{}", bench.text);
        let both = json(&mut bench, &set(0, other.0, other.1, &[one]));
        assert!(both["problems"].as_array().unwrap().is_empty(), "{both}");
        for key in ["order", "low_pass"] {
            assert!(bench.text.contains(key), "{}", bench.text);
        }
        bench.text = bench.text.split_inclusive('\n').take(3).collect();
    }
    // A fault of another kind is not held back.
    json(&mut bench, &set(0, "duration", "-1", &[]));
    assert!(bench.text.contains("duration = -1"), "{}", bench.text);
}
