//! Sweeps of time traces: from a folder of steps to a receptance and its modes.

use super::{json, vibro};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use vibroimpact::math::Noise;

/// Natural frequency in Hz, damping ratio and modal mass in kg.
const MODES: [(f64, f64, f64); 2] = [(31.7, 0.021, 1.6), (44.2, 0.012, 2.4)];

/// Receptance in m/N at `f` in Hz, real and imaginary part.
fn receptance(f: f64) -> (f64, f64) {
    MODES.iter().fold((0.0, 0.0), |sum, (own, zeta, mass)| {
        let (a, b) = (TAU * TAU * (own * own - f * f), 2.0 * zeta * TAU * TAU * own * f);
        let d = mass * (a * a + b * b);
        (sum.0 + a / d, sum.1 - b / d)
    })
}

fn frequency(step: usize) -> f64 {
    20.0 + 3.1 * step as f64
}

/// Writes 12 steps of 6 s: force in N with an offset, acceleration in m/s² with a transient; noise of 0.1 %
/// in both.
pub fn steps(folder: &Path) {
    let named: Vec<(String, f64)> = (1..=12).map(|k| (format!("step{k}.csv"), frequency(k))).collect();
    write_steps(folder, &named, 6.0);
    let campaign = "[[sweep]]\nname = \"up\"\ntraces = \"step*.csv\"\nforce = \"Force\"\nresponse = \"Accel\"\n\n[[frf]]\nsweep = \"up\"\n";
    fs::write(folder.join("campaign.toml"), campaign).unwrap();
}

/// Writes steps at these frequencies in Hz, of this duration in s, at 600 Hz.
pub fn write_steps(folder: &Path, named: &[(String, f64)], seconds: f64) {
    let mut noise = Noise::new(1);
    for (name, f) in named {
        let f = *f;
        let ((re, im), minus) = (receptance(f), -(TAU * f).powi(2));
        let size = re.hypot(im) * minus.abs();
        let mut text = "Time (s),Force (N),Accel (m/s²)\n".to_owned();
        for i in 0..(600.0 * seconds) as usize {
            let t = i as f64 / 600.0;
            let (sin, cos) = (TAU * f * t + 0.4).sin_cos();
            let steady = 3.0 * minus * (re * cos - im * sin);
            let transient = size * (-4.0 * t).exp() * (TAU * MODES[0].0 * t).cos();
            let (a, b) = (0.003 * noise.normal(), 0.003 * size * noise.normal());
            writeln!(text, "{t:.5},{:.6},{:.8}", 3.0 * cos + 0.1 + a, steady + transient + b).unwrap();
        }
        fs::write(folder.join(name), text).unwrap();
    }
}

#[test]
fn a_folder_of_steps_gives_receptance_and_modes() {
    let folder = tempfile::tempdir().unwrap();
    steps(folder.path());
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let answer = json(&["response", &path("campaign.toml#up")]);
    let points = answer["points"].as_array().unwrap();
    assert_eq!(points.len(), 12);
    for (step, point) in (1..).zip(points) {
        let (re, im) = receptance(frequency(step));
        let (std, phase) = (point["receptance"]["std"].as_f64().unwrap(), &point["phase"]);
        // At least twelve blocks, two thirds of them free of the transient: six standard uncertainties are
        // allowed.
        for (part, truth) in [("re", re), ("im", im)] {
            let off = (point["receptance"][part].as_f64().unwrap() - truth).abs();
            assert!(off < 6.0 * std && std < 2e-3 * re.hypot(im), "{step} {part}: {off} {std}");
        }
        let off = (phase["value"].as_f64().unwrap() - im.atan2(re)).abs();
        assert!(off < 6.0 * phase["std"].as_f64().unwrap(), "{step}: {off}");
    }
    for source in ["modal", "run"] {
        let answer = match source {
            "modal" => json(&["modal", &path("campaign.toml#up")])["modes"].clone(),
            _ => json(&["run", &path("campaign.toml"), "--out", &path("out")])["results"]["frf"][0]["modes"]
                .clone(),
        };
        for (mode, (own, zeta, mass)) in answer.as_array().unwrap().iter().zip(MODES) {
            for (key, truth) in [("frequency", own), ("zeta", zeta), ("modal_constant", 1.0 / mass)] {
                let value = mode[key]["value"].as_f64().unwrap();
                let std = mode[key]["std"].as_f64().unwrap_or_else(|| panic!("{source} {key}: {mode}"));
                assert!((value - truth).abs() < 6.0 * std, "{source} {key}: {value} ± {std} for {truth}");
            }
        }
    }
    assert!(folder.path().join("out/receptance.svg").exists());
}

#[test]
fn sweeps_that_cannot_be_say_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    steps(folder.path());
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for (table, word) in [
        (
            "traces = \"stop*.csv\"\nforce = \"Force\"\nresponse = \"Accel\"",
            "try: write traces = \"step*.csv\"",
        ),
        ("traces = \"../*.csv\"\nforce = \"Force\"\nresponse = \"Accel\"", "leads outside"),
        ("traces = \"step*.csv\"\nforce = \"Accel\"\nresponse = \"Accel\"", "force_calibration"),
        (
            "traces = \"step*.csv\"\nforce = \"Force\"\nresponse = \"Force\"",
            "a displacement, velocity or acceleration",
        ),
        ("traces = \"step*.csv\"\nforce = \"Force\"\nresponse = \"Laser\"", "Laser"),
        ("traces = \"step*.csv\"\nforce = \"Force\"", "0 of response"),
        (
            "traces = \"step*.csv\"\nforce = \"Force\"\nresponse = \"Accel\"\nlines = 400",
            "lines beside traces",
        ),
        (
            "traces = \"step*.csv\"\nforce = \"Force\"\nresponse = [\"Accel\", \"Force\"]\nmass = 1",
            "for each mass",
        ),
    ] {
        fs::write(path("wrong.toml"), format!("[[sweep]]\nname = \"up\"\n{table}\n")).unwrap();
        let found = vibro(&["response", &path("wrong.toml")]);
        let said = String::from_utf8_lossy(&found.stderr);
        assert!(!found.status.success() && said.contains(word), "{table}: {said}");
    }
    let text = "[[frf]]\nfile = \"step1.csv\"\nsweep = \"up\"\n";
    fs::write(path("wrong.toml"), text).unwrap();
    let said = vibro(&["run", &path("wrong.toml")]);
    assert!(String::from_utf8_lossy(&said.stderr).contains("a file beside a sweep"));
}

#[test]
fn channels_of_one_file_are_steps_and_several_responses_are_sweeps() {
    let folder = tempfile::tempdir().unwrap();
    steps(folder.path());
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let columns = |step: usize| -> Vec<String> {
        let text = fs::read_to_string(path(&format!("step{step}.csv"))).unwrap();
        text.lines().skip(1).map(ToOwned::to_owned).collect()
    };
    let mut text = "Time (s),F1 (N),A1 (m/s²),F2 (N),A2 (m/s²),F3 (N),A3 (m/s²)\n".to_owned();
    for ((a, b), c) in columns(1).iter().zip(columns(2)).zip(columns(3)) {
        let rest = |line: &str| line.split_once(',').unwrap().1.to_owned();
        writeln!(text, "{a},{},{}", rest(&b), rest(&c)).unwrap();
    }
    fs::write(path("all.csv"), text).unwrap();
    let table = "[[sweep]]\nname = \"up\"\ntraces = \"all.csv\"\nforce = [\"F1\", \"F2\", \"F3\"]\nresponse = [\"A1\", \"A2\", \"A3\"]\n";
    fs::write(path("pairs.toml"), table).unwrap();
    let (one, many) = (json(&["response", &path("pairs.toml")]), json(&["response", &path("campaign.toml")]));
    assert_eq!(one["points"].as_array().unwrap().len(), 3);
    for k in 0..3 {
        assert_eq!(one["points"][k]["receptance"], many["points"][k]["receptance"]);
    }
    let table =
        "[[sweep]]\nname = \"up\"\ntraces = \"all.csv\"\nforce = \"F1\"\nresponse = [\"A1\", \"A2\"]\n";
    fs::write(path("two.toml"), table).unwrap();
    let said = String::from_utf8_lossy(&vibro(&["response", &path("two.toml")]).stderr).into_owned();
    assert!(said.contains("up A1, up A2"), "{said}");
}
