//! `vibro modal`.

use super::{complaint, json, text};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use vibroimpact::record::{Axis, Meta, Record, Scaling, Spectrum, Values};
use vibroimpact::units::Unit;
use vibroimpact::write::{Precision, Storage, Target};

/// Accelerance of a mode at 80.3 Hz with ζ = 0.01 and A = 2/kg, computed by its formula.
fn accelerance() -> String {
    let mut rows =
        String::from("frequency [Hz],accelerance real [(m/s²)/N],accelerance imaginary [(m/s²)/N]\n");
    for i in 0..400 {
        let f = f64::from(i) * 0.5;
        let (omega, own) = (TAU * f, TAU * 80.3);
        let (re, im) = (own * own - omega * omega, 0.02 * own * omega);
        let size = -2.0 * omega * omega / (re * re + im * im);
        let _ = writeln!(rows, "{f},{:.8e},{:.8e}", size * re, -size * im);
    }
    rows
}

#[test]
fn modes_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plate.csv");
    fs::write(&path, accelerance()).unwrap();
    let out = folder.path().join("figures");
    let answer = json(&["modal", text(&path), "--complex", "--mass", "0.125", "--out", text(&out)]);
    let mode = &answer["modes"][0];
    // Values are printed with nine digits.
    assert!((mode["frequency"]["value"].as_f64().unwrap() - 80.3).abs() < 1e-5, "{answer}");
    assert!((mode["zeta"]["value"].as_f64().unwrap() - 0.01).abs() < 1e-6, "{answer}");
    assert!((mode["modal_constant"]["value"].as_f64().unwrap() - 2.0).abs() < 1e-3, "{answer}");
    assert!(mode["phase"]["value"].as_f64().unwrap().abs() < 0.1, "{answer}");
    assert!(mode["method"].is_string() && mode["stiffness"]["value"].is_f64());
    let methods: Vec<&str> =
        mode["by"].as_array().unwrap().iter().filter_map(|b| b["method"].as_str()).collect();
    assert_eq!(methods, ["rational fit", "circle fit", "half power", "peak"]);
    assert!(out.join("argand.png").is_file() && out.join("stability.png").is_file());
    assert!(out.join("frf.png").is_file() && out.join("modes.csv").is_file());
    let none = complaint(&["modal", text(&path), "--complex", "--band", "120:150"], 1);
    assert!(none.contains("no peak between"), "{none}");
    complaint(&["modal", text(&path), "--complex", "--band", "120"], 2);
}

/// A ratio of two voltages is fitted as A/(ωᵣ² − ω² + 2iζωᵣω), so A has the unit of the ratio times
/// (rad/s)².
#[test]
fn the_modal_constant_of_a_ratio_is_no_inverse_mass() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gain.csv");
    let (own, constant) = (TAU * 80.3, 1e4);
    let mut rows = String::from("frequency [Hz],gain real [V/V],gain imaginary [V/V]\n");
    for i in 0..400 {
        let omega = TAU * f64::from(i) * 0.5;
        let (re, im) = (own * own - omega * omega, 0.02 * own * omega);
        let size = constant / (re * re + im * im);
        let _ = writeln!(rows, "{},{:.8e},{:.8e}", f64::from(i) * 0.5, size * re, -size * im);
    }
    fs::write(&path, rows).unwrap();
    let answer = json(&["modal", text(&path), "--complex"]);
    let found = &answer["modes"][0]["modal_constant"];
    // Values are printed with nine digits.
    assert!((found["value"].as_f64().unwrap() / constant - 1.0).abs() < 1e-5, "{answer}");
    assert_eq!(found["unit"], "1/s²");
}

/// Lines without frequencies give no result in Hz, and the spectrum of one signal gives no modal constant.
/// The options that the error message names help.
#[test]
fn lines_that_are_no_function_are_refused_until_it_is_stated() {
    let folder = tempfile::tempdir().unwrap();
    let (numbered, spectrum) = (folder.path().join("numbered.txt"), folder.path().join("spectrum.csv"));
    let rows = accelerance();
    let lines: Vec<[f64; 3]> = rows
        .lines()
        .skip(1)
        .map(|row| std::array::from_fn(|i| row.split(',').nth(i).unwrap().parse().unwrap()))
        .collect();
    let complex: Vec<String> = lines.iter().map(|[_, re, im]| format!("({re:e}{im:+e}j)")).collect();
    fs::write(&numbered, complex.join("\n")).unwrap();
    fs::write(&spectrum, rows.replace("(m/s²)/N", "m/s²")).unwrap();
    let frequency =
        |args: &[&str]| json(args)["modes"][0]["frequency"]["value"].as_f64().expect("a frequency");

    let refused = complaint(&["modal", text(&numbered)], 1);
    assert!(refused.contains("(--base-band)") && refused.contains("frequencies"), "{refused}");
    // The last line lies at 199.5 Hz; values have nine digits.
    assert!(
        (frequency(&["modal", text(&numbered), "--base-band", "199.5", "--unit", "(m/s²)/N"]) - 80.3).abs()
            < 1e-5
    );

    let refused = complaint(&["modal", text(&spectrum)], 1);
    assert!(refused.contains("spectrum of acceleration [m/s²]") && refused.contains("--unit"), "{refused}");
    assert!((frequency(&["modal", text(&spectrum), "--unit", "(m/s²)/N"]) - 80.3).abs() < 1e-5);
}

#[test]
fn a_campaign_takes_a_coherence_of_another_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("plate.csv"), accelerance()).unwrap();
    json(&["convert", text(&at("plate.csv")), text(&at("plate.uff")), "--complex"]);
    let coherence = |name: &str, n: usize| {
        let mut values = vec![0.99; n];
        values[158] = 1.2; // impossible: left out and named
        let lines = Spectrum {
            meta: Meta::new("coherence", Unit::parse_or_opaque("1")),
            axis: Axis::frequency(0.0, 0.5, n),
            values: Values::Real(values),
            scaling: Scaling::Coherence,
            window: None,
            enbw: None,
        };
        let mut bytes = Vec::new();
        let storage = Storage { binary: false, precision: Precision::Double };
        Target::Uff.write(&[Record::Spectrum(lines)], storage, &mut bytes).unwrap();
        fs::write(at(name), bytes).unwrap();
    };
    coherence("good.uff", 400);
    coherence("short.uff", 300);
    let entry = |name: &str| {
        format!("[[frf]]\nname = \"{name}\"\nfile = \"plate.uff\"\ncoherence = \"{name}.uff\"\n")
    };
    fs::write(at("campaign.toml"), entry("short") + &entry("good")).unwrap();
    let found = json(&["run", text(&at("campaign.toml"))]);
    let all = found["results"]["frf"].as_array().unwrap();
    assert_eq!((all.len(), &all[0]["name"]), (1, &"good".into()), "{found}");
    assert!((all[0]["modes"][0]["frequency"]["value"].as_f64().unwrap() - 80.3).abs() < 1e-3, "{found}");
    assert!(all[0]["warnings"].to_string().contains("coherence"), "{found}");
    assert!(
        found["warnings"].to_string().contains("short: Left out: the coherence has other lines"),
        "{found}"
    );
    fs::write(at("campaign.toml"), entry("absent")).unwrap();
    complaint(&["run", text(&at("campaign.toml"))], 2);
}
