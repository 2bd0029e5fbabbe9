//! Analyses requested in a campaign give the answers of the commands.

use super::{complaint, json, text, vibro};
use serde_json::Value;
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use vibroimpact::math::Noise;

/// Runs a campaign of this text in a folder. Returns the exit code and the JSON object.
fn run(folder: &Path, campaign: &str) -> (i32, Value) {
    let path = folder.join("campaign.toml");
    fs::write(&path, campaign).unwrap();
    let output = vibro(&["run", text(&path), "--json"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    let code = output.status.code().unwrap();
    let value: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {stderr}"));
    (code, value)
}

/// Writes `bench.csv` at 1024 Hz, with a random force in N and the velocity in m/s of the oscillator that
/// it drives (1 kg, 60 Hz, ζ = 0.02), and `tones.csv`, a voltage with two tones.
fn bench(folder: &Path) {
    let (mut noise, mut table) = (Noise::new(7), String::from("time [s],force [N],velocity [m/s]\n"));
    let (w, zeta, dt) = (TAU * 60.0, 0.02, 1.0 / 1024.0);
    // x' = v, v' = f − 2ζω v − ω² x with a force that is constant over the sixteen steps of a sample.
    let (mut x, mut v) = (0.0, 0.0);
    for i in 0..30_000 {
        let force = noise.between(-0.5, 0.5);
        let _ = writeln!(table, "{:.9},{force:.9},{v:.9e}", f64::from(i) * dt);
        for _ in 0..16 {
            v += dt / 16.0 * (force - 2.0 * zeta * w * v - w * w * x);
            x += dt / 16.0 * v;
        }
    }
    fs::write(folder.join("bench.csv"), table).unwrap();
    let mut table = String::from("time [s],voltage [V]\n");
    for i in 0..2000 {
        let t = f64::from(i) * 1e-3;
        let _ = writeln!(table, "{t:.3},{:.6}", 2.0 * (TAU * 50.0 * t).cos() + (TAU * 55.0 * t + 1.0).cos());
    }
    fs::write(folder.join("tones.csv"), table).unwrap();
}

/// JSON in which no object has a key twice.
struct Unique;

impl<'de> serde::Deserialize<'de> for Unique {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Unique, D::Error> {
        struct Each;
        impl<'de> serde::de::Visitor<'de> for Each {
            type Value = Unique;
            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("JSON")
            }
            fn visit_bool<E>(self, _: bool) -> Result<Unique, E> {
                Ok(Unique)
            }
            fn visit_i64<E>(self, _: i64) -> Result<Unique, E> {
                Ok(Unique)
            }
            fn visit_u64<E>(self, _: u64) -> Result<Unique, E> {
                Ok(Unique)
            }
            fn visit_f64<E>(self, _: f64) -> Result<Unique, E> {
                Ok(Unique)
            }
            fn visit_str<E>(self, _: &str) -> Result<Unique, E> {
                Ok(Unique)
            }
            fn visit_unit<E>(self) -> Result<Unique, E> {
                Ok(Unique)
            }
            fn visit_seq<A: serde::de::SeqAccess<'de>>(self, mut all: A) -> Result<Unique, A::Error> {
                while all.next_element::<Unique>()?.is_some() {}
                Ok(Unique)
            }
            fn visit_map<A: serde::de::MapAccess<'de>>(self, mut all: A) -> Result<Unique, A::Error> {
                let mut keys = BTreeSet::new();
                while let Some(key) = all.next_key::<String>()? {
                    all.next_value::<Unique>()?;
                    if !keys.insert(key.clone()) {
                        return Err(serde::de::Error::custom(format!("{key} stands twice")));
                    }
                }
                Ok(Unique)
            }
        }
        from.deserialize_any(Each)
    }
}

#[test]
fn no_key_stands_twice_and_channels_may_be_numbers() {
    let folder = tempfile::tempdir().unwrap();
    bench(folder.path());
    let path = folder.path().join("campaign.toml");
    fs::write(
        &path,
        "[[spectrum]]\nname = \"speed\"\nfile = \"bench.csv\"\nchannel = 2\nsegment = 1024\n\
         [[frf]]\nname = \"modes\"\nfile = \"bench.csv\"\nreference = 1\nsegment = 4096\nband = [40.0, 80.0]\n",
    )
    .unwrap();
    let output = vibro(&["run", text(&path), "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice::<Unique>(&output.stdout).unwrap();
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let spectrum = &answer["results"]["spectra"][0];
    assert_eq!((&spectrum["name"], &spectrum["channel"]), (&"speed".into(), &"velocity".into()));
    let wrong = "[[spectrum]]\nfile = \"bench.csv\"\nchannel = 1.5\n";
    fs::write(&path, wrong).unwrap();
    assert!(complaint(&["run", text(&path)], 2).contains("number from 1"));
}

#[test]
fn spectra_and_functions_from_two_channels() {
    let folder = tempfile::tempdir().unwrap();
    bench(folder.path());
    let (code, answer) = run(
        folder.path(),
        "[[spectrum]]\nname = \"speed\"\nfile = \"bench.csv\"\nchannel = \"velocity\"\nsegment = 1024\nscaling = \"psd\"\nintegrate = 1\n\
         [[spectrum]]\nname = \"function\"\nfile = \"bench.csv\"\nreference = \"force\"\nestimator = \"hv\"\nsegment = 2048\n\
         [[spectrum]]\nname = \"tone\"\nfile = \"tones.csv\"\ntones = 2\ndecibel = 1e-6\n\
         [[frf]]\nname = \"modes\"\nfile = \"bench.csv\"\nreference = \"force\"\nsegment = 4096\nband = [40.0, 80.0]\n",
    );
    let results = &answer["results"];
    assert_eq!(code, 0, "{answer}");
    // 50 Hz of 2 V and 55 Hz of 1 V, rounded to 1e-6 V, which has a standard deviation of 3e-7 V.
    for (tone, (f, a)) in
        results["spectra"][2]["tones"].as_array().unwrap().iter().zip([(50.0, 2.0), (55.0, 1.0)])
    {
        let of = |key: &str, part: &str| tone[key][part].as_f64().unwrap();
        assert!(
            (of("frequency", "value") - f).abs() < 1e-6 && (of("amplitude", "value") - a).abs() < 1e-6,
            "{tone}"
        );
        // Times are printed in whole milliseconds. Either end of the 2000 samples is known to 0.5 ms, so the
        // duration to 1 ms (uniform distribution).
        let of_digits = f * 1e-3 / (3f64.sqrt() * 1.999);
        assert!((of("frequency", "std") / of_digits - 1.0).abs() < 1e-3, "{tone}");
        assert!(of("phase", "std") < 1e-6, "{tone}");
    }
    let (value, level) = (&results["spectra"][2]["value"], &results["spectra"][2]["level"]);
    for (v, l) in value.as_array().unwrap().iter().zip(level.as_array().unwrap()) {
        let expected = 20.0 * (v.as_f64().unwrap() / 1e-6).log10();
        assert!((l.as_f64().unwrap() - expected).abs() < 1e-9);
    }
    assert_eq!(results["spectra"][2]["level_unit"], "dB re 1 µV");
    let bench = folder.path().join("bench.csv");
    let same = ["spectrum", text(&bench), "--channel", "velocity", "--segment", "1024", "--scaling", "psd"];
    let alone = json(&[&same[..], &["--integrate", "1"]].concat());
    for key in ["frequency", "value", "value_std", "unit", "window", "averages", "detrend"] {
        assert_eq!(results["spectra"][0][key], alone[key], "{key}");
    }
    let function =
        ["spectrum", text(&bench), "--reference", "force", "--segment", "2048", "--estimator", "hv"];
    let alone = json(&function);
    for key in ["value", "phase", "coherence", "estimator"] {
        assert_eq!(results["spectra"][1][key], alone[key], "{key}");
    }
    let mode = &results["frf"][0]["modes"][0];
    assert!((mode["frequency"]["value"].as_f64().unwrap() - 60.0).abs() < 0.5, "{mode}");
    // The bandwidth has 9.6 lines of 0.25 Hz. Leakage, which would widen it by 1.5 %, is part of the fit.
    let (zeta, std) = (mode["zeta"]["value"].as_f64().unwrap(), mode["zeta"]["std"].as_f64().unwrap());
    assert!((zeta - 0.02).abs() < 4.0 * std && std < 0.1 * 0.02, "{mode}");
    for file in [
        "spectrum_speed.csv",
        "spectrum_function.uff",
        "spectrum_tone.svg",
        "frf_1.png",
        "frf_1.csv",
        "frf_1.uff",
        "modes_1.csv",
    ] {
        assert!(folder.path().join("results").join(file).is_file(), "{file}");
    }
    let report = fs::read_to_string(folder.path().join("results/report.html")).unwrap();
    assert!(report.contains("Largest peaks of spectra"));
}

#[test]
fn keys_that_contradict_each_other_point_at_the_file() {
    let folder = tempfile::tempdir().unwrap();
    bench(folder.path());
    for (keys, words) in [
        ("[[spectrum]]\nfile = \"bench.csv\"\nmethod = \"fft\"\nsegment = 8", "segment with method fft"),
        ("[[spectrum]]\nfile = \"bench.csv\"\nestimator = \"h2\"", "estimator without a reference"),
        ("[[spectrum]]\nfile = \"bench.csv\"\nwindow = \"kaiser\"", "kaiser"),
        ("[[spectrum]]\nfile = \"bench.csv\"\ntones = 2\nmethod = \"welch\"", "with tones"),
        (
            "[[spectrum]]\nfile = \"bench.csv\"\nreference = \"force\"\nscaling = \"rms\"",
            "scaling with a reference",
        ),
        ("[[frf]]\nfile = \"bench.csv\"\nsegment = 1024", "segment without a reference"),
    ] {
        let path = folder.path().join("campaign.toml");
        fs::write(&path, keys).unwrap();
        let found = complaint(&["run", text(&path)], 2);
        // The last key is the wrong one.
        let line = format!("line {}", keys.lines().count());
        assert!(found.contains(words) && found.contains(&line), "{keys}\n{found}");
    }
}

#[test]
fn drops_and_pulses_of_numbers_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (code, answer) = run(
        folder.path(),
        "[[drop]]\nname = \"struck\"\nmasses = [0.14, 0.28]\nbefore = [7.5, 0.0]\nafter = [-0.5]\nvelocity_std = 0.05\n\
         [[drop]]\nname = \"fall\"\nheight = 0.57\nheight_std = 0.001\ninterval = 0.144\ninterval_std = 0.002\n\
         [[drop]]\nname = \"train\"\nintervals = [0.300, 0.181, 0.109, 0.066]\n\
         [[pulse]]\nname = \"bit\"\ntime_to_peak = 6.64e-6\nduration = 18.0e-6\nstd = 0.05e-6\nmass = 0.43\n",
    );
    assert_eq!(code, 0, "{answer}");
    let alone = [
        json(&[
            "restitution",
            "--before",
            "7.5,0",
            "--after=-0.5",
            "--masses",
            "0.14,0.28",
            "--velocity-std",
            "0.05",
        ]),
        json(&[
            "restitution",
            "--height",
            "0.57",
            "--interval",
            "0.144",
            "--height-std",
            "0.001",
            "--interval-std",
            "0.002",
        ]),
        json(&["restitution", "--intervals", "0.300,0.181,0.109,0.066"]),
    ];
    for (found, alone) in answer["results"]["drops"].as_array().unwrap().iter().zip(&alone) {
        assert_eq!(found["restitution"], alone["restitution"]);
        assert_eq!(found["by"], alone["by"]);
    }
    let alone = json(&[
        "pulse",
        "--time-to-peak",
        "6.64e-6",
        "--duration",
        "18.0e-6",
        "--std",
        "0.05e-6",
        "--mass",
        "0.43",
    ]);
    assert_eq!(answer["results"]["pulses"][0]["xi"], alone["xi"]);
    assert_eq!(answer["results"]["pulses"][0]["stiffness"], alone["stiffness"]);
    for (keys, words) in [
        ("[[drop]]\nheight = 1.0", "a height and no time"),
        ("[[drop]]\ninterval = 1.0", "interval without a height"),
        ("[[drop]]\nafter = [1.0]\nintervals = [0.1, 0.05]", "without before"),
        ("[[pulse]]\nmass = 1.0", "neither a file nor two times"),
        ("[[pulse]]\nduration = 1.0", "only one of"),
    ] {
        let path = folder.path().join("campaign.toml");
        fs::write(&path, keys).unwrap();
        let found = complaint(&["run", text(&path)], 2);
        assert!(found.contains(words), "{keys}\n{found}");
    }
}

#[test]
fn keys_of_contacts_are_checked_before_anything_is_measured() {
    let folder = tempfile::tempdir().unwrap();
    // No file exists: the error message about a key must come before one about a file.
    for (keys, line, words) in [
        ("[[pulse]]\ntime_to_peak = 6e-6\nduration = 18e-6\nrate = 1e6", "line 4", "rate without a file"),
        ("[[pulse]]\ntime_to_peak = 6e-6\nduration = 18e-6\nunit = \"m\"", "line 4", "unit without a file"),
        ("[[pulse]]\ntime_to_peak = 6e-6\nduration = 18e-6\nchannel = \"a\"", "line 4", "channel without"),
        ("[[pulse]]\ntime_to_peak = 6e-6\nduration = 18e-6\nlow_pass = 5e3", "line 4", "without its order"),
        (
            "[[pulse]]\nfile = \"a.csv\"\n[[pulse]]\nfile = \"b.csv\"\nlow_pass = 5e3",
            "line 5",
            "without its order",
        ),
        ("[[pulse]]\nfile = \"a.csv\"\norder = 3", "line 3", "without its corner"),
        ("[[pulse]]\nfile = \"a.csv\"\nlow_pass = -1.0\norder = 2", "line 3", "above 0"),
        ("[[pulse]]\nfile = \"a.csv\"\nlow_pass = 1e3\norder = 20", "line 3", "order 20"),
        ("[[pulse]]\nmass = 1.0", "line 1", "neither a file nor two times"),
        ("[contact]\nradius = [0.01, inf]", "line 2", "radius without contact.modulus"),
        ("[[drop]]\nintervals = [0.3, 0.2]\nrate = 100.0", "line 3", "rate without a file"),
        (
            "[[drop]]\nname = \"a\"\nfile = \"a\"\nheight = 1.0\n[[drop]]\nname = \"a\"\nfile = \"b\"\nheight = 2.0",
            "line 8",
            "another height",
        ),
        ("[[drop]]\nbefore = [1.0, 0.0]\nafter = [1.0, 2.0, 3.0]", "line 2", "3 velocities"),
        (
            "[[impacts]]\nfile = \"a\"\nreference = \"b\"\nexcitation = 10.0",
            "line 4",
            "both reference and excitation",
        ),
    ] {
        let path = folder.path().join("campaign.toml");
        fs::write(&path, keys).unwrap();
        let found = complaint(&["run", text(&path)], 2);
        assert!(
            found.contains(words) && found.contains(line) && found.contains("campaign.toml"),
            "{keys}\n{found}"
        );
    }
    for option in [["--rate", "1000"], ["--unit", "g"], ["--channel", "a"]] {
        let times = ["pulse", "--time-to-peak", "6e-6", "--duration", "18e-6"];
        assert!(complaint(&[&times[..], &option[..]].concat(), 2).contains(option[0]), "{option:?}");
    }
}

#[test]
fn a_record_that_is_impossible_leaves_the_rest_alone() {
    let folder = tempfile::tempdir().unwrap();
    bench(folder.path());
    let drill = "[[drill]]\nname = \"square\"\nfile = \"bench.csv\"\nvelocity = \"velocity\"\nreference = \"force\"\n\
                 beam_angle = 90.0\nfrom = \"axis\"\npulses_per_turn = 1\nedge = \"rising\"\nsensitivity = 1.0\n";
    let (code, answer) =
        run(folder.path(), &format!("{drill}[[spectrum]]\nfile = \"bench.csv\"\nchannel = \"velocity\"\n"));
    assert_eq!((code, answer["results"]["spectra"].as_array().unwrap().len()), (0, 1));
    let said = |answer: &Value, word: &str| {
        answer["warnings"].as_array().unwrap().iter().any(|w| w.as_str().unwrap().contains(word))
    };
    assert!(said(&answer, "square: Left out"), "{answer}");
    // No record can be analysed: the report is written with the reason, and the exit code is 1.
    let (code, answer) = run(folder.path(), drill);
    assert_eq!(code, 1);
    assert!(said(&answer, "square: Left out") && said(&answer, "nothing was computed"), "{answer}");
    let report = fs::read_to_string(folder.path().join("results/report.html")).unwrap();
    assert!(report.contains("square: Left out"));
}

/// Long options of a command, written as keys.
fn options(command: &str) -> BTreeSet<String> {
    let help = String::from_utf8(vibro(&[command, "--help"]).stdout).unwrap();
    let names = help
        .lines()
        .filter_map(|l| l.trim_start().split("--").nth(1).filter(|_| l.trim_start().starts_with('-')));
    names.map(|n| n.split([' ', '=', ',']).next().unwrap().replace('-', "_")).collect()
}

/// Keys of a section, from the error message about an unknown key.
fn keys(folder: &Path, section: &str) -> BTreeSet<String> {
    let path = folder.join("campaign.toml");
    known(&path, &format!("[[{section}]]\nxqzxqzxqzxqz = 1\n")).into_iter().collect()
}

/// Names of the tables and keys of a campaign, kinds of records first.
pub fn sections() -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    known(&folder.path().join("campaign.toml"), "xqzxqzxqzxqz = 1\n")
}

/// The known keys that the error message about an unknown key lists.
fn known(path: &Path, campaign: &str) -> Vec<String> {
    fs::write(path, campaign).unwrap();
    let found = complaint(&["run", text(path)], 2);
    let list =
        found.split("keys known here: ").nth(1).unwrap_or_else(|| panic!("{found}")).lines().next().unwrap();
    list.split(", ").map(|k| k.trim().to_owned()).collect()
}

#[test]
fn every_option_of_a_command_is_a_key_of_its_section() {
    let folder = tempfile::tempdir().unwrap();
    // Options of the terminal, and options for single files that a campaign always writes.
    let general = ["style", "json", "max_memory", "help", "out", "replace", "legacy", "each_cycle"];
    let pairs = [
        ("spectrum", "spectrum"),
        ("drill", "drill"),
        ("impacts", "impacts"),
        ("restitution", "drop"),
        ("modal", "frf"),
        ("decay", "decay"),
        ("pulse", "pulse"),
    ];
    // A sweep consists of several files and belongs to several commands.
    let of_records = sections().into_iter().take_while(|section| section != "name");
    let forgotten = |section: &String| section != "sweep" && pairs.iter().all(|(_, of)| of != section);
    assert_eq!(of_records.filter(forgotten).collect::<Vec<_>>(), Vec::<String>::new());
    for (command, section) in pairs {
        let (options, keys) = (options(command), keys(folder.path(), section));
        assert!(options.len() > 10, "{options:?}");
        let missing: Vec<&String> =
            options.iter().filter(|o| !general.contains(&o.as_str()) && !keys.contains(*o)).collect();
        assert!(missing.is_empty(), "[[{section}]] lacks {missing:?} of `vibro {command}`");
    }
}
