//! `vibro spectrum`: keys, values, error messages.

use super::{complaint, json, text, vibro};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use vibroimpact::math::Noise;

/// Writes a random force in N and a velocity at 1024 Hz. The velocity is twice the force, two samples later
/// and in mm/s, plus a sine of 5 mm/s at 64 Hz.
fn bench(folder: &Path) -> PathBuf {
    let mut noise = Noise::new(1);
    let force: Vec<f64> = (0..20_000).map(|_| noise.between(-0.5, 0.5)).collect();
    let mut table = String::from("time [s],force [N],velocity [mm/s]\n");
    for i in 20..force.len() {
        let t = (i - 20) as f64 / 1024.0;
        let velocity = 2.0 * force[i - 2] + 5.0 * (TAU * 64.0 * t).cos();
        let _ = writeln!(table, "{t:.12},{:.9},{velocity:.9}", force[i]);
    }
    let path = folder.join("bench.csv");
    fs::write(&path, table).unwrap();
    path
}

fn numbers(value: &serde_json::Value, key: &str) -> Vec<f64> {
    value[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap_or(f64::NAN)).collect()
}

#[test]
fn lines_of_a_channel() {
    let folder = tempfile::tempdir().unwrap();
    let path = bench(folder.path());
    let value = json(&["spectrum", text(&path), "--channel", "velocity", "--segment", "1024"]);
    assert_eq!((value["scaling"].as_str(), value["unit"].as_str()), (Some("peak"), Some("m/s")));
    assert_eq!((value["window"].as_str(), value["averages"].as_u64()), (Some("hann"), Some(38)));
    assert!((value["enbw"].as_f64().unwrap() - 1.5).abs() < 1e-12);
    let (f, v) = (numbers(&value, "frequency"), numbers(&value, "value"));
    assert_eq!((f.len(), f[64]), (513, 64.0));
    // 5 mm/s in noise of 2·0.29 mm/s·√(2·1.5/1024)·√2 per line.
    assert!((v[64] / 5e-3 - 1.0).abs() < 0.02, "{}", v[64]);
    let once = json(&["spectrum", text(&path), "--channel", "2", "--segment", "1024", "--integrate", "1"]);
    assert_eq!(once["unit"], "m");
    // The lines from the second on; the first is named as left out.
    assert_eq!(numbers(&once, "frequency")[0], 2.0);
    assert!((numbers(&once, "value")[62] / (v[64] / (TAU * 64.0)) - 1.0).abs() < 1e-9);
    assert_eq!(once["findings"][0]["code"], "lines-below-cutoff");
    let whole = json(&[
        "spectrum",
        text(&path),
        "--channel",
        "2",
        "--method",
        "fft",
        "--scaling",
        "psd",
        "--fmin",
        "10",
    ]);
    assert_eq!((whole["averages"].as_u64(), whole["unit"].as_str()), (Some(1), Some("(m/s)²/Hz")));
    assert!(numbers(&whole, "frequency")[0] >= 9.999);
}

#[test]
fn response_to_a_reference_with_files_that_are_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (bench(folder.path()), folder.path().join("out"));
    let arguments =
        ["spectrum", text(&path), "--reference", "force", "--segment", "256", "--out", text(&out)];
    let value = json(&arguments);
    assert_eq!((value["scaling"].as_str(), value["unit"].as_str()), (Some("frf"), Some("(m/s)/N")));
    let (f, h, phase) = (numbers(&value, "frequency"), numbers(&value, "value"), numbers(&value, "phase"));
    let std = numbers(&value, "value_std");
    assert_eq!((numbers(&value, "coherence").len(), numbers(&value, "phase_std").len()), (f.len(), f.len()));
    // Away from the sine at 64 Hz the gain is 2 mm/s per newton, with a delay of two samples.
    for k in 30..100 {
        assert!((h[k] - 2e-3).abs() < 6.0 * std[k] + 2e-5, "{} Hz: {} ± {}", f[k], h[k], std[k]);
        let late = -360.0 * f[k] * 2.0 / 1024.0;
        assert!(
            ((phase[k] - late + 540.0).rem_euclid(360.0) - 180.0).abs() < 1.5,
            "{} Hz: {}",
            f[k],
            phase[k]
        );
    }
    for name in ["frf.svg", "frf.png", "argand_frf.svg", "frf.csv", "frf.uff"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    for name in ["frf.csv", "frf.uff"] {
        let read = json(&["info", text(&out.join(name))]);
        let records = read["files"][0]["records"].as_array().unwrap();
        let frf = records.iter().find(|r| r["kind"] == "frf").unwrap();
        assert_eq!((frf["quantity"].as_str(), frf["n"].as_u64()), (Some("mobility"), Some(128)), "{name}");
    }
    let receptance =
        json(&["spectrum", text(&path), "--reference", "1", "--segment", "256", "--integrate", "1"]);
    assert_eq!(receptance["unit"], "m/N");
    assert!(vibro(&arguments).status.success());
}

#[test]
fn what_has_no_answer_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = bench(folder.path());
    let ask = |more: &[&str], code| {
        let mut arguments = vec!["spectrum", text(&path)];
        arguments.extend(more);
        complaint(&arguments, code)
    };
    assert!(ask(&[], 2).contains("force, velocity"));
    assert!(ask(&["--channel", "x"], 2).contains("\"velocity\""));
    assert!(ask(&["--channel", "1", "--segment", "30000"], 1).contains("not one segment"));
    assert!(ask(&["--channel", "1", "--overlap", "1"], 2).contains("overlap"));
    assert!(ask(&["--channel", "1", "--window", "kaiser"], 2).contains("hann"));
    assert!(ask(&["--channel", "1", "--scaling", "decibel"], 2).contains("psd"));
    assert!(
        ask(&["--channel", "2", "--reference", "1", "--segment", "19980"], 1).contains("one segment only")
    );
    let plain = folder.path().join("plain.txt");
    fs::write(&plain, "1\n2\n3\n1\n2\n3\n1\n2\n3\n4\n").unwrap();
    assert!(complaint(&["spectrum", text(&plain)], 2).contains("--rate"));
    fs::write(&plain, "5\n".repeat(100)).unwrap();
    assert!(complaint(&["spectrum", text(&plain), "--rate", "100"], 1).contains("constant at 5"));
    fs::write(&plain, "5\nNaN\n".repeat(50)).unwrap();
    assert!(complaint(&["spectrum", text(&plain), "--rate", "100"], 2).contains("--allow-missing"));
    let missing = ["spectrum", text(&plain), "--rate", "100", "--allow-missing"];
    assert!(complaint(&missing, 1).contains("is missing"));
}

#[test]
fn a_mean_is_a_line_or_null() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mean.csv");
    let mut table = String::from("time [s],signal [V]\n");
    for i in 0..4096 {
        let t = f64::from(i) / 1024.0;
        let _ = writeln!(table, "{t},{}", 5.0 + (TAU * 100.3 * t).cos());
    }
    fs::write(&path, table).unwrap();
    let ask = |more: &[&str]| {
        let mut arguments = vec!["spectrum", text(&path), "--segment", "1024"];
        if more.contains(&"fft") {
            arguments.truncate(2);
        }
        arguments.extend(more);
        let value = json(&arguments);
        (
            value["detrend"].as_str().unwrap().to_owned(),
            value["value"][0].clone(),
            value["frequency"][0].as_f64(),
        )
    };
    let null = serde_json::Value::Null;
    assert_eq!(ask(&[]), ("mean".to_owned(), null.clone(), Some(0.0)));
    assert_eq!(ask(&["--method", "fft", "--detrend", "mean"]), ("mean".to_owned(), null, Some(0.0)));
    for more in [&["--detrend", "none"][..], &["--method", "fft"]] {
        let (detrend, value, _) = ask(more);
        assert_eq!(detrend, "none");
        // The sine is 100 lines away: with a Hann window about 0.3·10⁻⁶ of it leaks there.
        assert!((value.as_f64().unwrap() - 5.0).abs() < 1e-5, "{value}");
    }
    // Files do not contain this line.
    let out = folder.path().join("out");
    json(&["spectrum", text(&path), "--segment", "1024", "--out", text(&out)]);
    let read = json(&["info", text(&out.join("spectrum.csv"))]);
    let record = &read["files"][0]["records"][0];
    assert_eq!((record["n"].as_u64(), record["x0"].as_f64()), (Some(512), Some(1.0)));
}

#[test]
fn lines_without_excitation_are_null_and_not_in_files() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path().join("multisine.csv"), folder.path().join("out"));
    let mut table = String::from("time [s],force [N],position [m]\n");
    for i in 0..1280 {
        let x: f64 = [10, 30].iter().map(|k| (TAU * f64::from(k * (i % 128)) / 128.0).cos()).sum();
        let _ = writeln!(table, "{},{x},{}", f64::from(i) / 1024.0, 3.0 * x);
    }
    fs::write(&path, table).unwrap();
    let value =
        json(&["spectrum", text(&path), "--reference", "force", "--segment", "128", "--out", text(&out)]);
    for (i, h) in value["value"].as_array().unwrap().iter().enumerate() {
        // With a Hann window, a sine on a line excites three lines.
        let excited = [10, 30].iter().any(|k| (i + 1).abs_diff(*k) <= 1);
        assert_eq!(h.as_f64().is_some_and(|h| (h - 3.0).abs() < 1e-9), excited, "line {}: {h}", i + 1);
        assert_eq!(h.is_null(), !excited);
        assert_eq!(value["coherence"][i].is_null(), !excited);
    }
    for name in ["frf.csv", "frf.uff"] {
        let read = json(&["info", text(&out.join(name))]);
        for record in read["files"][0]["records"].as_array().unwrap() {
            assert_eq!((record["n"].as_u64(), record["x0"].as_f64()), (Some(6), Some(72.0)), "{name}");
        }
    }
}

#[test]
fn a_hammer_names_the_windows_applied() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hammer.csv");
    let mut table = String::from("time [s],force [N],velocity [m/s]\n");
    for i in 0..9000 {
        let since = f64::from((i - 500) % 3000);
        let force = [30.0, 100.0, 30.0].get(since as usize).filter(|_| i >= 500).map_or(0.5, |f| f + 0.5);
        let velocity = if i < 500 { 0.0 } else { (-0.003 * since).exp() * (0.3 * since).sin() };
        let _ = writeln!(table, "{},{force},{velocity}", f64::from(i) / 1024.0);
    }
    fs::write(&path, table).unwrap();
    let hammer = ["spectrum", text(&path), "--reference", "force", "--hammer", "--segment", "1000"];
    let ask = |more: &[&str]| {
        let value = json(&[&hammer[..], more].concat());
        assert_eq!(
            (value["averages"].as_u64(), value["detrend"].as_str()),
            (Some(3), Some("level before the blow"))
        );
        (value["window"].as_str().unwrap().to_owned(), value["enbw"].as_f64().unwrap())
    };
    // Segments as long as the next blow allows: 2500 samples follow the last blow. After 2048 samples 0.2 %
    // of the response is left, so all are used.
    let free = json(&hammer[..5]);
    assert_eq!((free["averages"].as_u64(), free["value"].as_array().unwrap().len()), (Some(3), 1250));
    // Segments regardless of blows are refused, and the suggested option is the one used above.
    assert!(
        complaint(&hammer[..4], 1).contains("comes in blows")
            && complaint(&hammer[..4], 1).contains("--hammer")
    );
    assert_eq!(ask(&[]), ("force".to_owned(), 1.0));
    assert_eq!(ask(&["--force-window", "0.05"]), ("force".to_owned(), 1.0));
    let (window, enbw) = ask(&["--left-at-end", "0.01"]);
    // Weight 1 for 2 % of the record, then an exponential decay to 0.01.
    let weights = (0..1000).map(|i| 0.01f64.powf(f64::from((i - 20).max(0)) / 980.0));
    let (sum, squares) = weights.fold((0.0, 0.0), |(s, q), w| (s + w, q + w * w));
    assert_eq!(window, "force and exponential");
    assert!((enbw / (1000.0 * squares / (sum * sum)) - 1.0).abs() < 1e-12, "{enbw}");
    // The response decays by 0.003 a sample at 0.3 rad a sample, so ζ = 0.01. The decay of the window is
    // written to the file, read back and subtracted.
    let out = folder.path().join("out");
    let options = ["--estimator", "h1", "--left-at-end", "0.01", "--out", text(&out)];
    json(&[&hammer[..], &options].concat());
    let written = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().path());
    let of_numbers = |p: &PathBuf| p.extension().is_some_and(|e| e == "csv" || e == "unv" || e == "uff");
    let files: Vec<_> = written.filter(of_numbers).collect();
    assert_eq!(files.len(), 2, "{files:?}");
    for file in files {
        let value = json(&["modal", text(&file), "--band", "40:58", "--channel", "1"]);
        let zeta = value["modes"][0]["zeta"]["value"].as_f64().unwrap();
        // At the end of a record 0.01 e⁻³ of the response is left. With the decay of the window ζ would be
        // 0.026.
        assert!((zeta / 0.01 - 1.0).abs() < 0.05, "{file:?}: {value}");
        assert!(value["findings"].to_string().contains("modal-window-decay"), "{value}");
        // The file states that the function comes from blows, not from continuous excitation.
        assert!(!value["findings"].to_string().contains("modal-leakage"), "{value}");
    }
    for (option, value) in [
        ("--window", "hann"),
        ("--overlap", "0.5"),
        ("--method", "welch"),
        ("--scaling", "psd"),
        ("--detrend", "mean"),
    ] {
        let found = complaint(&[&hammer[..], &[option, value]].concat(), 2);
        let key = option.trim_start_matches("--");
        let with = if key == "scaling" { "reference" } else { "hammer" };
        assert!(found.contains(&format!("{key} with a {with}")) && found.contains(option), "{found}");
    }
    let reference = ["spectrum", text(&path), "--reference", "force"];
    let found = complaint(&[&reference[..], &["--scaling", "psd"]].concat(), 2);
    assert!(found.contains("scaling with a reference") && found.contains("(--scaling)"), "{found}");
    let found = complaint(&[&reference[..], &["--method", "fft"]].concat(), 2);
    assert!(found.contains("reference with method fft") && found.contains("(--reference)"), "{found}");
    let whole = ["spectrum", text(&path), "--channel", "1", "--method", "fft", "--overlap", "0.2"];
    let found = complaint(&whole, 2);
    assert!(found.contains("overlap with method fft") && found.contains("(--overlap)"), "{found}");
}

#[test]
fn lines_carry_their_scatter() {
    let folder = tempfile::tempdir().unwrap();
    let path = bench(folder.path());
    let ask = |more: &[&str]| {
        let value = json(&[&["spectrum", text(&path), "--channel", "1"], more].concat());
        (numbers(&value, "value"), numbers(&value, "value_std"))
    };
    // 19980 samples give 19 segments without overlap: a relative scatter of 1/√19, and half of it for
    // amplitudes.
    let apart = ["--segment", "1024", "--overlap", "0"];
    let (value, std) = ask(&[&apart[..], &["--scaling", "psd"]].concat());
    assert!((std[100] / value[100] * 19f64.sqrt() - 1.0).abs() < 1e-12);
    assert!((std[512] / value[512] * 9.5f64.sqrt() - 1.0).abs() < 1e-12);
    let (value, std) = ask(&apart);
    assert!((std[100] / value[100] * 19f64.sqrt() - 0.5).abs() < 1e-12);
    // A single transform gives no scatter.
    let (value, std) = ask(&["--method", "fft"]);
    assert!(value.len() == std.len() && std.iter().all(|s| s.is_nan()));
}

#[test]
fn blows_left_out_are_named_and_records_too_short_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hammer.csv");
    let (decay, turn) = (0.003, 0.3f64);
    let mut table = String::from("time [s],force [N],velocity [m/s]\n");
    for i in 0..9000 {
        let since = f64::from((i - 500) % 3000);
        // The second blow is a double hit.
        let hit = [30.0, 100.0, 30.0].get(since as usize).filter(|_| i >= 500).copied().unwrap_or(0.0);
        let again = if i == 3700 { 60.0 } else { 0.0 };
        // Exact response to the three samples of force, in (m/s)/(N s).
        let free = |n: f64| if n < 0.0 { 0.0 } else { (-decay * n).exp() * (turn * n).cos() };
        let velocity = if i < 500 {
            0.0
        } else {
            30.0 * free(since) + 100.0 * free(since - 1.0) + 30.0 * free(since - 2.0)
        };
        let _ = writeln!(table, "{},{},{velocity:.9e}", f64::from(i) / 1024.0, hit + again);
    }
    fs::write(&path, table).unwrap();
    let out = folder.path().join("out");
    let found = json(&[
        "spectrum",
        text(&path),
        "--reference",
        "force",
        "--hammer",
        "--segment",
        "800",
        "--out",
        text(&out),
    ]);
    let said = found["warnings"].to_string();
    assert!(said.contains("Left out of 3 blows: 1 double hit. `blows` lists all."), "{said}");
    // e^(−0.003·784) = 9.5 % of the response remains.
    assert!(said.contains("remains when the record of a blow ends"), "{said}");
    for name in ["frf.csv", "frf.uff"] {
        let file = out.join(name);
        let value = json(&["modal", text(&file), "--band", "40:58", "--channel", "1"]);
        let mode = &value["modes"][0];
        let z = |key: &str, truth: f64| {
            (mode[key]["value"].as_f64().unwrap() - truth) / mode[key]["std"].as_f64().unwrap()
        };
        // The velocity cos per impulse is twice the real part of a residue of 1/2. A sample lasts 1/1024 s,
        // so A = 1024.
        let own = turn.hypot(decay) * 1024.0 / TAU;
        for (key, truth) in
            [("modal_constant", 1024.0), ("zeta", decay / turn.hypot(decay)), ("frequency", own)]
        {
            assert!(z(key, truth).abs() < 2.5, "{name}, {key}: {} from {truth}: {mode}", z(key, truth));
        }
        assert!(value["findings"].to_string().contains("modal-blow-cut-off"), "{value}");
        // `--unit` changes the unit of the function, not that of the coherence beside it.
        let scaled = json(&["modal", text(&file), "--band", "40:58", "--channel", "1", "--unit", "(mm/s)/N"]);
        let ratio = scaled["modes"][0]["modal_constant"]["value"].as_f64().unwrap()
            / mode["modal_constant"]["value"].as_f64().unwrap();
        assert!((ratio / 1e-3 - 1.0).abs() < 1e-6, "{name}: {ratio}");
    }
    let own = complaint(&["spectrum", text(&path), "--reference", "force", "--channel", "force"], 2);
    assert!(own.contains("its own reference"), "{own}");
}

#[test]
fn a_channel_that_rests_at_an_end_of_its_range_is_clipped_and_one_of_two_levels_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let of = |value: &dyn Fn(f64) -> f64| {
        let rows = (0..9000).map(|i| format!("{i},{}\n", value(f64::from(i))));
        fs::write(&path, format!("time [ms],voltage [V]\n{}", rows.collect::<String>())).unwrap();
        let value = json(&["spectrum", text(&path)]);
        let found = value["findings"].as_array().unwrap().iter().any(|f| f["code"] == "spectrum-clipped");
        (found, value["value_std"][181].is_null())
    };
    let sine = |i: f64| (TAU * 0.0221 * i).sin();
    assert_eq!(of(&|i| sine(i).min(0.7)), (true, true));
    assert!(!of(&|i| if sine(i) > 0.5 { 5.0 } else { 0.0 }).0);
    assert!(!of(&|i| (100.0 * sine(i)).round()).0);
}

/// A spectrum as LabVIEW writes it, in dB re 1 g over an axis labelled as time: noise at about −100 dB and
/// three lines of 0 to −20 dB.
fn labview(folder: &Path) -> PathBuf {
    let head = "LabVIEW Measurement\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\n\nChannels\t1\n";
    let axis = "Y_Unit_Label\tg\nX_Dimension\tTime\nX0\t0\nDelta_X\t0.1\n***End_of_Header***\n";
    let mut file = format!("{head}{axis}X_Value\tAcceleration (FFT - (RMS))\tComment\n");
    for k in 0..2000 {
        let peak = [(66, 0.0), (415, -10.0), (1179, -20.0)].iter().find(|(at, _)| *at == k);
        let _ = writeln!(file, "\t{}", peak.map_or(-100.0 - f64::from(k * 7919 % 13), |(_, level)| *level));
    }
    let path = folder.join("fft.lvm");
    fs::write(&path, file).unwrap();
    path
}

#[test]
fn peaks_of_a_spectrum_that_a_file_holds() {
    let folder = tempfile::tempdir().unwrap();
    let path = labview(folder.path());
    let read = ["spectrum", text(&path), "--base-band", "200", "--unit", "dB re 1 g"];
    let value = json(&read);
    let (f, v) = (numbers(&value, "frequency"), numbers(&value, "value"));
    let peaks: Vec<usize> = (0..f.len()).filter(|k| v[*k] > 0.5).collect();
    assert_eq!(peaks, [66, 415, 1179]);
    // Standard gravity, 9.80665 m/s².
    for (k, level) in [(66, 0.0), (415, -10.0), (1179, -20.0)] {
        assert!((f[k] - 0.1 * k as f64).abs() < 1e-9);
        assert!((v[k] / (9.80665 * 10f64.powf(level / 20.0)) - 1.0).abs() < 1e-12);
    }
    assert_eq!(
        (value["window"].as_str(), value["value_std"].as_array().map(Vec::len)),
        (Some("not said"), Some(0))
    );
    let shown = String::from_utf8(vibro(&read).stdout).unwrap();
    for peak in ["6.60", "41.50", "117.90"] {
        assert!(shown.contains(peak), "{peak}: {shown}");
    }
    let said = complaint(&[&read[..], &["--segment", "512"]].concat(), 2);
    assert!(said.contains("is a spectrum already"), "{said}");
    // A level without its reference is no amplitude.
    let said = complaint(&["spectrum", text(&path), "--base-band", "200"], 2);
    assert!(said.contains("dB"), "{said}");
}

/// Two records with sines on spectral lines, 16 periods or more per segment. Peaks that both records have
/// share a row; the third peak exists in the second record only.
#[test]
fn spectra_of_several_files_stand_beside_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, sines: &[(f64, f64)]| {
        let mut noise = Noise::new(7);
        let mut rows = String::from("time [s],handle [m/s^2],body [m/s^2]\n");
        for k in 0..8192 {
            let t = f64::from(k) / 1024.0;
            let sum: f64 = sines.iter().map(|(f, a)| a * (TAU * f * t).sin()).sum();
            let [one, other] = [sum, 2.0 * sum].map(|value| value + noise.between(-0.05, 0.05));
            let _ = writeln!(rows, "{t},{one:.6},{other:.6}");
        }
        let path = folder.path().join(name);
        fs::write(&path, rows).unwrap();
        path
    };
    let drill = write("drill.csv", &[(32.0, 3.0), (96.0, 1.0)]);
    let rig = write("rig.csv", &[(32.0, 2.0), (96.0, 0.5), (160.0, 0.4)]);
    let out = folder.path().join("out");
    let both = ["spectrum", text(&drill), text(&rig), "--channel", "handle", "--segment", "1024"];
    let found = json(&[&both[..], &["--out", text(&out)]].concat());
    let spectra = found["spectra"].as_array().unwrap();
    assert_eq!((spectra.len(), spectra[1]["name"].as_str()), (2, Some("rig")));
    // A file gives the same spectrum alone as beside another.
    let alone = json(&["spectrum", text(&rig), "--channel", "handle", "--segment", "1024"]);
    assert_eq!(alone["value"], spectra[1]["value"]);
    let peaks = fs::read_to_string(out.join("spectrum_peaks.csv")).unwrap();
    let rows: Vec<Vec<Option<f64>>> =
        peaks.lines().skip(1).map(|row| row.split(',').map(|cell| cell.parse().ok()).collect()).collect();
    let expected = [
        [Some(32.0), Some(3.0), Some(32.0), Some(2.0)],
        [Some(96.0), Some(1.0), Some(96.0), Some(0.5)],
        [None, None, Some(160.0), Some(0.4)],
    ];
    assert_eq!(rows.len(), 3, "{peaks}");
    for (row, expected) in rows.iter().zip(expected) {
        for (cell, expected) in row.iter().zip(expected) {
            // Noise of 0.03 RMS over 512 lines and 15 averages is 0.002 per line; five times that is
            // allowed.
            let near = cell.zip(expected).is_none_or(|(cell, expected)| (cell - expected).abs() < 0.01);
            assert!(near && cell.is_some() == expected.is_some(), "{peaks}");
        }
    }
    for name in ["spectrum.svg", "spectrum.png", "spectrum_drill.csv", "spectrum_rig.uff"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let channels = [format!("{}#handle", text(&rig)), format!("{}#body", text(&rig))];
    let of_one = json(&["spectrum", &channels[0], &channels[1], "--segment", "1024"]);
    let names: Vec<_> = (0..2).map(|k| of_one["spectra"][k]["channel"].as_str().unwrap()).collect();
    assert_eq!(names, ["handle", "body"]);
    let lower = folder.path().join("lower.csv");
    fs::write(&lower, fs::read_to_string(&rig).unwrap().replace("m/s^2", "m/s")).unwrap();
    let other = complaint(&["spectrum", text(&drill), text(&lower), "--channel", "handle"], 2);
    assert!(other.contains("m/s²") && other.contains("lower"), "{other}");
}
