//! `vibro drill` from the command line: the example's record against its truth, and input that cannot be
//! analysed.

#[allow(dead_code)]
#[path = "../../crates/vibro-demo/src/noise.rs"]
pub mod noise;
#[path = "../../crates/vibro-demo/src/hammer_drill/record.rs"]
pub mod record;

use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use vibroimpact::model::drill::{Course, Impact, Interface, Machine, Rung, run};
use vibroimpact::record::{Axis, Meta, Record, Trace};
use vibroimpact::units::Unit;
use vibroimpact::write::wav::write;
use vibroimpact::write::{Precision, Storage, Target};

const PLAIN: [&str; 12] = [
    "--velocity",
    "striker",
    "--reference",
    "pulse",
    "--sensitivity",
    "2",
    "--beam-angle",
    "30",
    "--pulses-per-turn",
    "1",
    "--edge",
    "rising",
];

fn drill(file: &Path, more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibro"));
    command.arg("--json").arg("drill").arg(file).args(more).output().expect("vibro starts")
}

fn with(file: &Path, more: &[&str]) -> Output {
    drill(file, &[&PLAIN[..], &["--from", "normal"], more].concat())
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// The finding with this code; null if there is none.
fn finding<'a>(found: &'a Value, code: &str) -> &'a Value {
    let mut all = found["findings"].as_array().unwrap().iter();
    all.find(|f| f["code"] == code).unwrap_or(&Value::Null)
}

pub fn volts(name: &str, values: Vec<f64>) -> Record {
    let meta = Meta::new(name, Unit::parse_or_opaque("V"));
    Record::Trace(Trace { meta, axis: Axis::time(0.0, 1.0 / record::RATE, values.len()), values })
}

pub fn wav(folder: &Path, name: &str, channels: &[Record]) -> PathBuf {
    let path = folder.join(name);
    write(channels, Precision::Single, &mut std::fs::File::create(&path).unwrap()).unwrap();
    path
}

#[test]
fn the_example_comes_out_as_it_was_made() {
    let folder = tempfile::tempdir().unwrap();
    let made = record::run(0, 2.0).unwrap();
    let channels = [volts("striker", made.velocity.clone()), volts("pulse", made.pulse.clone())];
    let file = wav(folder.path(), "drill.wav", &channels);
    let still = wav(folder.path(), "still.wav", &[volts("striker", record::still(1.0))]);
    let out = folder.path().join("out");
    let found = json(&with(
        &file,
        &[
            "--mass",
            "0.14",
            "--struck-mass",
            "0.28",
            "--noise",
            still.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ],
    ));
    assert_eq!(found["dropouts"].as_u64(), Some(made.dropouts as u64));
    // The duration of a turn scatters by 0.4 %, so the mean of 95 turns by 0.02 Hz; four times that is
    // allowed.
    assert!((found["speed"]["value"].as_f64().unwrap() - 47.3).abs() < 0.08);
    let impacts = found["impacts"].as_array().unwrap();
    assert!(impacts.len() + found["hidden"].as_u64().unwrap() as usize + 2 >= made.impacts.len());
    for impact in impacts {
        let number = |key: &str| impact[key].as_f64().unwrap();
        let truth =
            made.impacts.iter().find(|t| (t.time - number("time")).abs() < 5e-5).expect("a true impact");
        // Six standard uncertainties: any of 200 values exceeds them in fewer than one of a million records.
        assert!((number("before") - truth.before).abs() < 6.0 * number("before_std"), "{impact}");
        assert!((number("after") - truth.after).abs() < 6.0 * number("after_std"), "{impact}");
        assert!((number("phase") - truth.phase).abs() < 6.0 * number("phase_std"), "{impact}");
    }
    let restitution = &found["restitution"];
    let (value, std) = (restitution["value"].as_f64().unwrap(), restitution["std"].as_f64().unwrap());
    // Balance of momentum with the struck mass at rest before, as the record of the striker alone must take
    // it.
    let sum = |of: &dyn Fn(&record::Struck) -> f64| made.impacts.iter().map(of).sum::<f64>();
    let truth = sum(&|i| 0.5 * (i.before - i.after) - i.after) / sum(&|i| i.before);
    assert!((value - truth).abs() < 4.0 * std && std < 0.01, "{value} ± {std}, {truth}");
    assert!((found["beam"]["factor"].as_f64().unwrap() - 2.0).abs() < 1e-12);
    let average = &found["average"];
    for key in ["phase", "mean", "std"] {
        assert_eq!(average[key].as_array().unwrap().len(), 720);
    }
    assert!(!found["noise_floor"]["bands"].as_array().unwrap().is_empty());
    for name in ["drill_average.svg", "drill_trace.png", "drill_speed.svg", "drill_noise.svg", "impacts.csv"]
    {
        assert!(out.join(name).exists(), "{name}");
    }
    assert!(out.join("drill_bandwidth.svg").exists());
}

#[test]
fn the_truth_beside_the_example_is_the_one_it_is_made_from() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/hammer_drill/TRUTH.csv");
    let text = std::fs::read_to_string(path).unwrap();
    let rows = text.lines().skip(1).map(|l| l.split(',').map(|v| v.parse().unwrap()).collect::<Vec<f64>>());
    let made = record::run(0, 0.5).unwrap().impacts;
    assert!(made.len() > 20 && text.lines().count() > 900);
    for (row, made) in rows.zip(&made) {
        // The truth has four decimals. The rest allows for roundings of another machine's mathematics
        // library.
        for (written, made) in row[1..].iter().zip([made.time, made.phase, made.before, made.after]) {
            assert!((written - made).abs() < 6e-5, "{row:?}");
        }
    }
}

/// Writes the recordings of the example, of `seconds` s each.
pub fn example(data: &Path, seconds: f64) {
    for (body, (file, name)) in
        [("drill", "striker"), ("piston", "piston"), ("bit", "bit")].into_iter().enumerate()
    {
        let made = record::run(body, seconds).unwrap();
        let channels = [volts(name, made.velocity), volts("pulse", made.pulse)];
        wav(data, &format!("{file}.wav"), &channels);
    }
    wav(data, "still.wav", &[volts("striker", record::still(0.5))]);
}

/// The blow of a settled machine: striker on intermediate piston and that on the bit, as a measurement shows
/// them.
fn run_of(machine: &Machine) -> [Impact; 2] {
    let course = Course { judged: 1, samples: 8000, ..Course::turns(60) };
    let run = run(machine, Rung::Compliant, &course).unwrap();
    let period = machine.crank.period();
    [Interface::Striker, Interface::Bit].map(|interface| {
        let own = run.turns[0].impacts.iter().filter(|impact| impact.interface == interface);
        let blow = own.max_by(|a, b| a.before[0].total_cmp(&b.before[0])).unwrap();
        run.turns[0].at_once(blow, 59.0 * period, period)
    })
}

#[test]
fn a_campaign_joins_the_bodies_by_the_crank() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    std::fs::create_dir(&data).unwrap();
    example(&data, 2.0);
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/hammer_drill");
    let text = std::fs::read_to_string(own.join("campaign.toml")).unwrap();
    std::fs::copy(own.join("drill.toml"), folder.path().join("drill.toml")).unwrap();
    let campaign = folder.path().join("campaign.toml");
    std::fs::write(&campaign, &text).unwrap();
    let run = |path: &Path| {
        Command::new(env!("CARGO_BIN_EXE_vibro")).arg("--json").arg("run").arg(path).output().unwrap()
    };
    let found = json(&run(&campaign));
    let drills = found["results"]["drill"].as_array().unwrap();
    assert_eq!(drills.len(), 3);
    // The bit strikes nothing. Its velocity before the impacts is consistent with zero: no restitution.
    assert!(drills[2]["restitution"].is_null() && drills[0]["restitution"]["value"].as_f64().unwrap() < 1.0);
    assert!(
        finding(&drills[2], "drill-not-striking")["numbers"]["speed"].is_f64(),
        "{}",
        drills[2]["findings"]
    );
    let machine = &found["results"]["drill_machines"][0];
    assert_eq!(machine["bodies"], serde_json::json!(["striker", "intermediate piston", "bit"]));
    let passages = machine["passages"].as_array().unwrap();
    // The bodies as the model moves them without scatter from turn to turn. That of 3 % of leakage changes
    // the means by its square, far below the uncertainty of 90 turns.
    let truth = record::machine().unwrap();
    let model = run_of(&truth);
    let near = |estimate: &Value, truth: f64| {
        let (value, std) = (estimate["value"].as_f64().unwrap(), estimate["std"].as_f64().unwrap());
        assert!((value - truth).abs() < 4.0 * std && std < 0.02 * truth, "{truth}: {estimate}");
    };
    assert_eq!(passages.len(), 2);
    let masses = [truth.striker.mass, truth.intermediate.mass, truth.bit.mass];
    for (k, (passage, impact)) in passages.iter().zip(&model).enumerate() {
        near(&passage["given"], masses[k] * (impact.before[0] - impact.after[0]));
        near(&passage["taken"], masses[k + 1] * (impact.after[1] - impact.before[1]));
        let separation = impact.after[1] - impact.after[0];
        near(&passage["restitution"], separation / (impact.before[0] - impact.before[1]));
        let [given, taken, lost] = ["given", "taken", "lost"]
            .map(|what| passage[format!("energy_{what}")]["value"].as_f64().unwrap());
        assert!((given - taken - lost).abs() < 1e-12 && lost > 0.0, "{passage}");
    }
    let energy = |k: usize, v: f64| 0.5 * masses[k] * v * v;
    near(&machine["blow_energy"], energy(0, model[0].before[0]));
    let taken = energy(2, model[1].after[1]) - energy(2, model[1].before[1]);
    near(&machine["efficiency"], taken / energy(0, model[0].before[0]));
    assert!((machine["blow_rate"].as_f64().unwrap() - 60.0 * 47.3).abs() < 60.0);
    let model = &machine["model"];
    let bodies = model["bodies"].as_array().unwrap();
    assert_eq!(bodies.len(), 3);
    for body in bodies {
        assert_eq!(body["velocity"].as_array().unwrap().len(), 720);
        // Root mean square in standard deviations from turn to turn: of the mean of 90 turns that is 0.11.
        assert!(body["scatters"].as_f64().unwrap() < 0.3, "{}: {}", body["name"], body["scatters"]);
    }
    let differences = model["differences"].as_array().unwrap();
    assert_eq!(differences.len(), 10, "{differences:?}");
    for difference in differences {
        let [measured, model] = ["measured", "model"].map(|key| difference[key]["value"].as_f64().unwrap());
        if let Some(std) = difference["measured"]["std"].as_f64() {
            let deviations = difference["deviations"].as_f64().unwrap();
            let expected = (measured - model) / std;
            assert!(
                (deviations - expected).abs() < 1e-9 * expected.abs() && expected.abs() < 4.0,
                "{difference}"
            );
        }
    }
    // The keys that `drill.toml` states otherwise are found again, and nothing is in doubt.
    let findings = model["findings"].as_array().unwrap();
    assert!(findings.iter().all(|finding| finding["severity"] != "doubt"), "{findings:?}");
    let keys = model["fit"]["keys"].as_array().unwrap();
    assert_eq!(keys.len(), 4);
    for key in keys {
        let [value, std] = ["value", "std"].map(|part| key["estimate"][part].as_f64().unwrap());
        let true_value = truth.value(key["key"].as_str().unwrap()).unwrap();
        let stated = key["start"].as_f64().unwrap();
        assert!((value - true_value).abs() < 4.0 * std, "{key}: {true_value}");
        // So clearly that the stated value is excluded.
        assert!((stated - true_value).abs() > 4.0 * std, "{key}: {stated}");
    }
    for name in ["drill_average_striker_run.svg", "drill_joined.svg", "drill_chain.csv", "drill_model.svg"] {
        assert!(folder.path().join("results").join(name).exists(), "{name}");
    }
    // A missing key that has no default is named.
    std::fs::write(&campaign, text.replace("beam_from = \"normal\"", "")).unwrap();
    let without = run(&campaign);
    assert_eq!(without.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&without.stderr).contains("beam from (axis or normal"));
}

/// CSV file with the channels `striker` and `pulse` in V, 6000 samples at 10 kHz.
fn csv(folder: &Path, name: &str, row: impl Fn(usize) -> (f64, f64)) -> PathBuf {
    let mut text = String::from("t [s],striker [V],pulse [V]\n");
    for i in 0..6000 {
        let (v, r) = row(i);
        let _ = writeln!(text, "{:.4},{v},{r}", i as f64 / 1e4);
    }
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn what_allows_no_answer_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let wave = |i: usize| (i as f64 * 0.03).sin();
    let pulse = |i: usize| f64::from(u8::from(i % 200 < 20));
    let good = csv(at, "good.csv", |i| (wave(i), pulse(i)));
    let cases = [
        (csv(at, "none.csv", |i| (wave(i), 0.0)), 1, "no edge"),
        (csv(at, "one.csv", |i| (wave(i), f64::from(u8::from(i > 3000)))), 1, "one edge"),
        (csv(at, "constant.csv", |i| (1.0, pulse(i))), 1, "constant"),
        (csv(at, "same.csv", |i| (pulse(i), pulse(i))), 1, "the same channel"),
    ];
    for (file, code, why) in &cases {
        let output = with(file, &[]);
        let text =
            String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(*code), "{why}: {text}");
        assert!(text.contains(why), "{why}: {text}");
    }
    let code = |more: &[&str]| drill(&good, more).status.code();
    assert_eq!(code(&PLAIN), Some(2), "an angle without --from");
    let square = ["--velocity", "1", "--reference", "2", "--sensitivity", "2", "--beam-angle", "90"];
    let rest = ["--pulses-per-turn", "1", "--edge", "rising", "--from", "axis"];
    assert_eq!(code(&[&square[..], &rest].concat()), Some(1), "a beam square to the motion");
    let twice = ["--velocity", "1", "--reference", "1", "--sensitivity", "2", "--beam-angle", "0"];
    assert_eq!(code(&[&twice[..], &rest].concat()), Some(1), "one channel for both");
    for bad in [["--mass", "-1"], ["--fit", "0"], ["--points", "1"], ["--low-pass", "6000"]] {
        assert_eq!(with(&good, &bad).status.code(), Some(2), "{bad:?}");
    }
    let smooth = json(&with(&good, &["--low-pass", "500"]));
    // Default low-pass: half the phases of the average times 50 turns/s, but at most a quarter of 10 kHz.
    let plain = json(&with(&good, &[]));
    assert_eq!(plain["smoothing"]["corner"].as_f64(), Some(2500.0));
    let off = json(&with(&good, &["--low-pass", "none"]));
    assert!(off["smoothing"].is_null());
    // Impacts and bandwidth come from the velocity before the low-pass, so it does not change them.
    for found in [&plain, &smooth] {
        assert_eq!((&found["bandwidth"], &found["impacts"]), (&off["bandwidth"], &off["impacts"]));
    }
    // A low-pass at 500 Hz lowers a sine of 47.7 Hz by (47.7/500)⁴ = 8e-5. The period of the sine is 209.4
    // samples, but a turn has 200: turns do not end at turning points. The whole record is smoothed, not
    // each turn alone, which changes the displacement near the ends of turns.
    let stroke = |d: &Value| d["displacement"]["stroke"]["value"].as_f64().unwrap();
    for found in [&plain, &smooth] {
        assert!((stroke(found) / stroke(&off) - 1.0).abs() < 2e-3, "{} {}", stroke(found), stroke(&off));
    }
    assert_eq!((smooth["impacts"].as_array().unwrap().len(), smooth["cycles"].as_u64()), (0, Some(28)));
    assert_eq!(finding(&smooth, "drill-no-impact")["numbers"]["contact"], 2e-4);
    assert_eq!(smooth["smoothing"]["corner"], 500.0);
}

#[test]
fn without_a_reference_the_turns_come_from_the_impacts() {
    let folder = tempfile::tempdir().unwrap();
    let made = record::run(0, 2.0).unwrap();
    let channels = [volts("striker", made.velocity.clone()), volts("pulse", made.pulse)];
    let file = wav(folder.path(), "drill.wav", &channels);
    let out = folder.path().join("out");
    let masses = ["--mass", "0.14", "--struck-mass", "0.43", "--out", out.to_str().unwrap()];
    let plain = ["--velocity", "striker", "--sensitivity", "2", "--beam-angle", "30", "--from", "normal"];
    let own = json(&drill(&file, &[&plain[..], &masses].concat()));
    let with = json(&with(&file, &masses[..4]));
    for key in ["before", "after", "restitution"] {
        let part = |found: &Value, what: &str| found[key][what].as_f64().unwrap();
        assert!((part(&own, "value") - part(&with, "value")).abs() < part(&with, "std"), "{key}");
    }
    // True speed in Hz, from the first impact to the last.
    let n = own["cycles"].as_f64().unwrap();
    let times: Vec<f64> = made.impacts.iter().map(|i| i.time).collect();
    let truth = (times.len() - 1) as f64 / (times[times.len() - 1] - times[0]);
    let speed = |what: &str| own["speed"][what].as_f64().unwrap();
    assert!((speed("value") - truth).abs() < 1.96 * speed("std") && n > 85.0, "{} {truth}", own["speed"]);
    assert_eq!((&own["turns_from"], &with["turns_from"]), (&"impacts".into(), &"reference".into()));
    let said = finding(&own, "drill-turns-from-impacts");
    assert!((said["numbers"]["rpm"].as_f64().unwrap() / 60.0 / speed("value") - 1.0).abs() < 1e-12);
    assert!(finding(&with, "drill-turns-from-impacts").is_null());
    assert_eq!((own["phase"]["value"].as_f64(), own["phase"]["std"].is_null()), (Some(0.0), true));
    // The average begins in the middle of the impact, half-way between 7.6 m/s before and −1.4 m/s after.
    assert!((own["average"]["mean"][0].as_f64().unwrap() - 0.5 * (7.6 - 1.4)).abs() < 1.5);
    assert!(out.join("drill_trace.svg").exists());
    // A crank motion without impacts is refused, and so is `--edge` without a reference.
    let sine = csv(folder.path(), "sine.csv", |i| ((i as f64 * 0.03).sin(), 0.0));
    let mut noise = noise::ShiftedNoise::new(3);
    let rows: Vec<f64> = (0..6000).map(|i| (f64::from(i) * 0.03).sin() + 0.01 * noise.normal()).collect();
    for file in [&sine, &csv(folder.path(), "noisy.csv", |i| (rows[i], 0.0))] {
        let refused = drill(file, &plain);
        let text = String::from_utf8_lossy(&refused.stderr);
        assert!(refused.status.code() == Some(1) && text.contains("impacts"), "{text}");
    }
    let contradicted = drill(&file, &[&plain[..], &["--edge", "rising"]].concat());
    assert_eq!(contradicted.status.code(), Some(2));
    let table =
        Command::new(env!("CARGO_BIN_EXE_vibro")).arg("drill").arg(&file).args(plain).output().unwrap();
    assert!(String::from_utf8_lossy(&table.stdout).contains("rpm"));
}

#[test]
fn a_mean_velocity_that_is_taken_off_is_told() {
    let folder = tempfile::tempdir().unwrap();
    // Sawtooth of 200 samples from −1 to 1 V (4 m/s per volt), each tooth up to 2 % higher or lower, plus a
    // mean.
    let tooth = |i: usize| {
        let (k, s) = ((i + 100) / 200, (i + 100) % 200);
        (1.0 + 0.01 * ((7 * k % 5) as f64 - 2.0)) * (2.0 * (s as f64 + 0.5) / 200.0 - 1.0)
    };
    let pulse = |i: usize| f64::from(u8::from(i % 200 < 20));
    let found =
        |mean: f64| json(&with(&csv(folder.path(), "mean.csv", |i| (tooth(i) + mean, pulse(i))), &[]));
    let [plain, moved] = [found(0.0), found(0.05)];
    assert!(finding(&plain, "drill-mean-removed").is_null());
    // 0.05 V are 0.2 m/s. A turn holds halves of two teeth of 4 m/s. Where one tooth is 2 % higher, the mean
    // is off by a quarter of 2 % of 4 m/s.
    let mean = finding(&moved, "drill-mean-removed")["numbers"]["mean"].as_f64().unwrap();
    assert!((mean - 0.2).abs() < 0.02, "{mean}");
    // The mean that is reported as removed has been removed.
    let before = |d: &Value| d["before"]["value"].as_f64().unwrap();
    assert!((before(&moved) - before(&plain)).abs() < 1e-9, "{} {}", before(&moved), before(&plain));
}

#[test]
fn all_that_is_missing_is_asked_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let file =
        csv(folder.path(), "asks.csv", |i| ((i as f64 * 0.03).sin(), f64::from(u8::from(i % 200 < 20))));
    let said = String::from_utf8(drill(&file, &[]).stderr).unwrap();
    let tried =
        "--velocity 1 --reference 2 --beam-angle 0 --beam-from axis --pulses-per-turn 1 --edge rising";
    assert!(said.contains("6 values are missing") && said.contains(tried), "{said}");
    let typed: Vec<&str> = tried.split(' ').chain(["--sensitivity", "1"]).collect();
    json(&drill(&file, &typed));
}

#[test]
fn channels_of_different_rates_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let made = record::run(0, 0.3).unwrap();
    let striker = volts("striker", made.velocity);
    let Record::Trace(mut pulse) = volts("pulse", made.pulse) else { unreachable!() };
    pulse.axis = Axis::time(0.0, 2.0 / record::RATE, pulse.values.len());
    let path = folder.path().join("rates.uff");
    let mut bytes = Vec::new();
    let storage = Storage { binary: true, precision: Precision::Double };
    Target::Uff.write(&[striker, Record::Trace(pulse)], storage, &mut bytes).unwrap();
    std::fs::write(&path, bytes).unwrap();
    let output = with(&path, &[]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && text.contains("rate"), "{text}");
}

#[test]
fn missing_samples_of_the_reference_between_its_pulses_cost_no_turn() {
    let folder = tempfile::tempdir().unwrap();
    let wave = |i: usize| (i as f64 * 0.03).sin();
    let pulse = |i: usize| f64::from(u8::from(i % 200 < 20));
    let path = csv(folder.path(), "gap.csv", |i| (wave(i), pulse(i)));
    let text = std::fs::read_to_string(&path).unwrap();
    // Seven samples of the reference are missing between two pulses; line 1 is the header.
    let gap = text.lines().enumerate().map(|(n, line)| match n {
        2101..=2107 => format!("{},\n", line.rsplit_once(',').unwrap().0),
        _ => format!("{line}\n"),
    });
    std::fs::write(&path, gap.collect::<String>()).unwrap();
    let found = json(&with(&path, &[]));
    // 30 pulses, the first already high at the start: 29 edges, none lost, make 28 turns.
    assert_eq!(found["cycles"].as_u64(), Some(28));
}

#[test]
fn each_impact_and_the_handle() {
    let folder = tempfile::tempdir().unwrap();
    let made = record::run(0, 2.0).unwrap();
    // Handle: 10 m/s² along and 5 m/s² across at 100 Hz, in V at 100 m/s² per volt.
    let wave = |amplitude: f64| {
        let turn = std::f64::consts::TAU * 100.0 / record::RATE;
        (0..made.velocity.len()).map(|i| 0.01 * amplitude * (turn * i as f64).sin()).collect()
    };
    let channels = [
        volts("striker", made.velocity.clone()),
        volts("pulse", made.pulse.clone()),
        volts("along", wave(10.0)),
        volts("across", wave(5.0)),
    ];
    let file = wav(folder.path(), "drill.wav", &channels);
    let table = folder.path().join("cycles.csv");
    let handle =
        ["--handle", "along", "--handle", "across", "--handle-sensitivity", "100", "--exposure", "2"];
    // The table of turns goes to the path of `--each-cycle`, the table of impacts into the folder of
    // `--out`.
    let out = folder.path().join("out");
    let each = ["--each-cycle", table.to_str().unwrap(), "--out", out.to_str().unwrap()];
    let found = json(&with(&file, &[&handle[..], &each].concat()));
    // Weighting factor of ISO 5349-1, table A.2: 0.160 at 100 Hz, to three digits.
    let truth = 0.160 * (100f64 + 25.0).sqrt() / 2f64.sqrt();
    let number = |key: &str| found["exposure"][key]["value"].as_f64().unwrap();
    assert!((number("a_hv") / truth - 1.0).abs() < 0.005, "{} {truth}", number("a_hv"));
    assert!((number("a8") / number("a_hv") - 0.5).abs() < 1e-12);
    // Crests of the sine lie between samples, and samples are rounded to 32 bits.
    assert!((found["exposure"]["unweighted_peak"].as_f64().unwrap() / 10.0 - 1.0).abs() < 1e-3);
    // An output never replaces the input, and a missing folder is reported before the measurement.
    for (to, word) in [(file.clone(), "same file"), (folder.path().join("no/x.csv"), "does not exist")] {
        let refused = with(&file, &["--each-cycle", to.to_str().unwrap()]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&refused.stderr).contains(word), "{refused:?}");
    }
    // One row per turn, one column per phase: the means of the columns are the average.
    assert_eq!(found["each_cycle"], table.to_str().unwrap());
    let rows = std::fs::read_to_string(&table).unwrap();
    let head = rows.lines().next().unwrap();
    assert!(head.starts_with("cycle,time (s),speed (Hz),velocity at phase 0.000000 (m/s)"), "{head}");
    assert_eq!(head.split(',').count(), 723);
    assert_eq!(rows.lines().count() as u64, 1 + found["averaged"].as_u64().unwrap());
    let mut sums = vec![(0.0, 0.0); 720];
    for row in rows.lines().skip(1) {
        for (sum, cell) in sums.iter_mut().zip(row.split(',').skip(3)).filter(|(_, c)| !c.is_empty()) {
            *sum = (sum.0 + cell.parse::<f64>().unwrap(), sum.1 + 1.0);
        }
    }
    for ((sum, n), mean) in sums.iter().zip(found["average"]["mean"].as_array().unwrap()) {
        // Values of at most 10 m/s are printed with seven digits.
        assert!((sum / n - mean.as_f64().unwrap()).abs() < 1e-5);
    }
    let text = std::fs::read_to_string(out.join("impacts.csv")).unwrap();
    let impacts = found["impacts"].as_array().unwrap();
    assert!(text.starts_with("cycle,time") || text.starts_with("cycle,\"time"), "{}", &text[..40]);
    assert_eq!(text.lines().count(), impacts.len() + 1);
    for (row, impact) in text.lines().skip(1).zip(impacts) {
        let cells: Vec<f64> = row.split(',').take(2).map(|c| c.parse().unwrap()).collect();
        assert_eq!(cells[0] as u64, impact["cycle"].as_u64().unwrap());
        assert!((cells[1] - impact["time"].as_f64().unwrap()).abs() < 1e-5, "{row}");
    }
    let refused = with(&file, &["--handle", "along"]);
    assert_eq!(refused.status.code(), Some(2), "a handle in volts without its sensitivity");
}

#[test]
fn times_and_pulses_that_no_turn_can_hold_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let pulse = |i: usize| f64::from(u8::from(i % 200 < 20));
    let good = csv(folder.path(), "good.csv", |i| ((i as f64 * 0.03).sin(), pulse(i)));
    for bad in [["--fit", "1e9"], ["--fit", "1e300"], ["--contact", "1e300"], ["--fit", "0.0101"]] {
        let output = with(&good, &bad);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{bad:?}: {text}");
        assert!(text.contains("longer than half a turn"), "{bad:?}: {text}");
    }
    let at = PLAIN.iter().position(|a| *a == "--pulses-per-turn").unwrap() + 1;
    for (pulses, code) in [("18446744073709551615", 2), ("10001", 2), ("10000", 1)] {
        let mut typed = PLAIN;
        typed[at] = pulses;
        let output = drill(&good, &[&typed[..], &["--from", "normal"]].concat());
        assert_eq!(output.status.code(), Some(code), "{pulses}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn a_front_impact_and_a_rear_catch_are_two_groups() {
    let folder = tempfile::tempdir().unwrap();
    let mut noise = noise::ShiftedNoise::new(5);
    // 52 turns of 2048 samples. Front impact at phase 0.3, from 6.5 to −1.5 m/s; rear catch at phase 0.8,
    // from −6 to 1 m/s. All velocities scatter by 2 %.
    let turn = record::RATE / 50.0;
    let mut vary = |v: f64| v * (1.0 + 0.02 * noise.normal());
    let speeds: Vec<[f64; 4]> = (0..52).map(|_| [6.5, -1.5, -6.0, 1.0].map(&mut vary)).collect();
    let value = |i: usize| {
        let at = i as f64 / turn;
        let (k, p) = (at as usize, at.fract());
        let rest = if k == 0 { 1.0 } else { speeds[k - 1][3] };
        let [front, back, rear, caught] = speeds[k];
        let before = |p: f64| if p < 0.3 { rest + (front - rest) * (p + 0.2) / 0.5 } else { back };
        let between = |p: f64| back + (rear - back) * (p - 0.3) / 0.5;
        let behind = |p: f64| caught + (speeds[k + 1][0] - caught) * (p - 0.8) / 0.5;
        // Contacts last 0.2 ms, which is 0.01 turn.
        let mix =
            |p: f64, at: f64| 0.5 + 0.5 * (std::f64::consts::PI * ((p - at) / 0.01).clamp(-0.5, 0.5)).sin();
        if p < 0.295 {
            before(p)
        } else if p < 0.305 {
            let far = rest + (front - rest) * (p + 0.2) / 0.5;
            far + mix(p, 0.3) * (between(p) - far)
        } else if p < 0.795 {
            between(p)
        } else if p < 0.805 {
            between(p) + mix(p, 0.8) * (behind(p) - between(p))
        } else {
            behind(p)
        }
    };
    let count = (50.6 * turn) as usize;
    let velocity: Vec<f64> = (0..count).map(|i| 0.25 * value(i) + 0.001 * noise.normal()).collect();
    let pulse = |i: usize| {
        let s = ((i as f64 / turn + 0.5).fract() - 0.5) * turn;
        2.5 * (s / 3.0).tanh() - 2.5 * ((s - 100.0) / 3.0).tanh()
    };
    let pulses = (0..count).map(|i| pulse(i) + 0.02 * noise.normal()).collect();
    let file = wav(folder.path(), "drill.wav", &[volts("striker", velocity), volts("pulse", pulses)]);
    let out = folder.path().join("out");
    let masses = ["--mass", "0.14", "--struck-mass", "0.28", "--out", out.to_str().unwrap()];
    let found = json(&with(&file, &masses));
    let groups = found["groups"].as_array().unwrap();
    assert_eq!(groups.len(), 2, "{}", found["warnings"]);
    // Front: a struck mass of twice the striker gives ½(1 + 1.5/6.5) + 1.5/6.5. Rear: the catcher is taken
    // as fixed, which gives 1/6.
    let front = 0.5 * (1.0 + 1.5 / 6.5) + 1.5 / 6.5;
    let truths = [[0.3, 6.5, -1.5, front], [0.8, -6.0, 1.0, 1.0 / 6.0]];
    for (group, truth) in groups.iter().zip(truths) {
        assert_eq!(group["n"].as_u64().unwrap(), 49, "{group}");
        for (key, truth) in ["phase", "before", "after", "restitution"].into_iter().zip(truth) {
            let part = |what: &str| group[key][what].as_f64().unwrap();
            // Five standard uncertainties with six degrees of freedom. The half sine of the contact
            // (velocities) and the sampling (phases) add 0.2 %.
            assert!((part("value") - truth).abs() < 5.0 * part("std") + 0.002 * truth.abs(), "{key} {group}");
        }
        let energy = 0.5 * 0.14 * truth[1].powi(2);
        assert!((group["energy"]["value"].as_f64().unwrap() / energy - 1.0).abs() < 0.03, "{group}");
        assert!((group["share"].as_f64().unwrap() - 1.0).abs() < 0.05);
    }
    assert_eq!(found["before"], groups[0]["before"]);
    for impact in found["impacts"].as_array().unwrap() {
        assert_eq!(impact["group"].as_u64() == Some(1), impact["phase"].as_f64().unwrap() > 0.5);
    }
    assert_eq!(finding(&found, "drill-groups")["numbers"]["n"], 2.0);
    let table = std::fs::read_to_string(out.join("impacts.csv")).unwrap();
    assert!(table.lines().next().is_some_and(|l| l.contains("group")), "{table}");
    let svg = std::fs::read_to_string(out.join("drill_average.svg")).unwrap();
    assert!(
        svg.contains("before impact, group 0") && svg.contains("after impact, group 1"),
        "a legend with both groups"
    );
}

#[test]
fn swapped_channels_and_a_vibration_as_reference_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let pulse = |i: usize| f64::from(u8::from(i % 200 < 20));
    let file = csv(folder.path(), "swapped.csv", |i| (pulse(i), (i as f64 * 0.03).sin()));
    let refusal = |output: &Output| {
        assert_eq!(output.status.code(), Some(1));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let swapped = refusal(&with(&file, &[]));
    assert!(swapped.contains("are the two channels swapped?"), "{swapped}");
    // Three sines without a common period cross their middle at irregular intervals, unlike pulses of a
    // shaft.
    let vibration = |i: usize| [0.11, 0.173, 0.291].iter().map(|w| (i as f64 * w).sin()).sum::<f64>();
    let file = csv(folder.path(), "handle.csv", |i| ((i as f64 * 0.03).sin(), vibration(i)));
    let handle = refusal(&with(&file, &[]));
    assert!(handle.contains("no pulse of a shaft"), "{handle}");
    let file = csv(folder.path(), "right.csv", |i| ((i as f64 * 0.03).sin(), pulse(i)));
    assert!(with(&file, &[]).status.success());
}

#[test]
fn impacts_beyond_the_range_are_in_no_mean() {
    let folder = tempfile::tempdir().unwrap();
    let made = record::run(0, 1.0).unwrap();
    let limited = |limit: f64| {
        let striker = made.velocity.iter().map(|v| v.min(0.25 * limit)).collect();
        let channels = [volts("striker", striker), volts("pulse", made.pulse.clone())];
        json(&with(
            &wav(folder.path(), "limited.wav", &channels),
            &["--mass", "0.14", "--struck-mass", "0.43"],
        ))
    };
    // Velocities before the impact scatter by 0.07 m/s about 7.63 m/s. At the beginning of the fits, 0.6 ms
    // before, they are 0.22 m/s higher: a quarter of them exceeds 7.9 m/s there.
    let some = limited(7.9);
    let impacts = some["impacts"].as_array().unwrap();
    let clipped = |i: &&Value| i["clipped"].as_bool().unwrap();
    let count = impacts.iter().filter(clipped).count();
    assert!(count > 4 && count < impacts.len() / 2, "{count}");
    assert_eq!(some["clipped"].as_u64(), Some(count as u64));
    for impact in impacts {
        let number = |key: &str| impact[key].as_f64().unwrap();
        let truth = made.impacts.iter().find(|t| (t.time - number("time")).abs() < 5e-5).unwrap();
        // Two samples at the limit count as clipped; the velocity falls by 0.003 m/s a sample. Four times the
        // noise of 12 mm/s is 0.05 m/s.
        if truth.before > 7.68 + 0.06 {
            assert!(clipped(&impact), "{impact} {}", truth.before);
        } else if truth.before < 7.68 - 0.06 {
            assert!(!clipped(&impact), "{impact} {}", truth.before);
            assert!((number("before") - truth.before).abs() < 6.0 * number("before_std"), "{impact}");
        }
    }
    assert_eq!(some["before"]["n"].as_u64(), Some((impacts.len() - count) as u64));
    for key in ["before", "after", "energy", "energy_given", "restitution"] {
        assert!(some[key]["value"].is_f64() && some[key]["std"].is_null(), "{key}: {}", some[key]);
    }
    assert_eq!(finding(&some, "drill-impacts-over-range")["severity"], "doubt");
    let all = limited(5.0);
    assert_eq!(all["clipped"].as_u64(), Some(all["impacts"].as_array().unwrap().len() as u64));
    assert!(all["before"]["std"].is_null());
    assert_eq!(finding(&all, "drill-impacts-over-range")["severity"], "doubt");
}
