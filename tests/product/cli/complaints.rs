//! Every error message names the place, what was found, what was expected and what to try; no file is
//! half-written.

use super::rig::{frequencies, spectrum, sweep};
use super::{complaint, json, text, vibro};
use std::fs;

fn has(complaint: &str, words: &[&str]) {
    for word in words {
        assert!(complaint.contains(word), "no {word:?} in:\n{complaint}");
    }
}

#[test]
fn unreadable_files() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    };
    has(&complaint(&["info", text(&at("empty.txt", b""))], 2), &["empty.txt", "empty", "try:"]);
    has(&complaint(&["info", text(folder.path())], 2), &["folder", "try:"]);
    has(&complaint(&["info", text(&folder.path().join("absent.txt"))], 2), &["absent.txt", "no such file"]);
    // A file name that contains the word FILE is printed unchanged.
    let log = at("LOGFILE.csv", b"operator: me\nnothing here\n");
    has(&complaint(&["response", text(&log)], 2), &[&format!("try: vibro info {}", text(&log))]);
    let noise: Vec<u8> = (0..4000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    has(&complaint(&["info", text(&at("noise.bin", &noise))], 2), &["noise.bin", "not a format", "--format"]);
    has(&complaint(&["info", text(&at("word.txt", b"1\n2\nx\n"))], 2), &["line 3", "\"x\"", "a number"]);
}

#[test]
fn wrong_usage() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    fs::write(&path, "1\n2\n").unwrap();
    let path = text(&path);
    for arguments in [
        &["nonsense"][..],
        &[],
        &["info"],
        &["info", path, "--rate", "-5"],
        &["info", path, "--rate", "x"],
        &["info", path, "--rate", "nan"],
        &["info", path, "--format", "xyz"],
        &["info", path, "--unit", "furlong"],
        &["info", path, "--rate", "1", "--base-band", "2"],
        &["convert", path],
        &["convert", path, "a.xyz"],
        &["response", path, "--band", "0"],
        &["response", path, "--window", "kaiser"],
        &["run", "absent.toml"],
    ] {
        complaint(arguments, 2);
    }
}

#[test]
fn numbers_that_are_not_written_as_expected() {
    let comma = complaint(&["restitution", "--height", "0,57", "--interval", "0.1"], 2);
    has(&comma, &["--height", "try: --height 0.57"]);
    has(
        &complaint(&["restitution", "--intervals", "0.3"], 1),
        &["one flight time", "try: state two", "--intervals"],
    );
    let long = complaint(&["restitution", "--height", "0.15", "--interval", "0.427172953818325"], 1);
    has(&long, &["drop 1, 0.4272 s, gives R = 1.221"]);
}

#[test]
fn a_coherence_above_one_and_a_band_beyond_the_function() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str, text: String| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    // A mode of 50 Hz, ζ = 2 %, as a receptance.
    let lines = (1..200).map(|k| {
        let (x, z) = (f64::from(k) / 50.0, 0.02);
        let (a, b) = (1.0 - x * x, 2.0 * z * x);
        format!("{k},{:e},{:e}\n", a / (a * a + b * b), -b / (a * a + b * b))
    });
    let frf = at("f.csv", format!("Frequency (Hz),H_re (m/N),H_im (m/N)\n{}", lines.collect::<String>()));
    let beyond = complaint(&["modal", text(&frf), "--band", "800:900"], 1);
    has(&beyond, &["no peak between 800 and 900 Hz", "runs from 1 to 199 Hz", "try:"]);
}

#[test]
fn wrong_usage_is_an_object_where_one_was_asked_for() {
    for (arguments, word) in [
        (&["spectrum", "--json"][..], "needs FILE"),
        (&["--json", "info", "a.csv", "--rate", "x"], "--rate"),
        (&["nonsense", "--json"], "nonsense"),
    ] {
        let output = vibro(arguments);
        assert_eq!(output.status.code(), Some(2));
        let value: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
        assert!(value["error"].as_str().unwrap().contains(word), "{value}");
        assert_eq!((value["exit_code"].as_u64(), &value["warnings"]), (Some(2), &serde_json::json!([])));
        assert!(!output.stderr.is_empty());
    }
    // Help is an answer, not an error.
    assert_eq!(vibro(&["spectrum", "--help", "--json"]).status.code(), Some(0));
}

#[test]
fn all_missing_files_are_named_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    fs::remove_file(folder.path().join("FUP0004.DAT")).unwrap();
    fs::remove_file(folder.path().join("VUP0007.DAT")).unwrap();
    let found = complaint(&["response", text(&list)], 2);
    // In the list, three numbers precede twelve force files and twelve response files.
    let lines = ["FUP0004.DAT (line 7)", "VUP0007.DAT (line 22)"];
    has(&found, &["LIST.TXT, line 7: 2 of 24 files are missing", lines[0], lines[1], "try:"]);
}

#[test]
fn a_list_is_no_measurement() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    let out = folder.path().join("out.csv");
    for arguments in [&["info", text(&list)][..], &["convert", text(&list), text(&out)]] {
        has(&complaint(arguments, 2), &["the list of a sweep: 12 points, 200 lines", "vibro response"]);
    }
}

#[test]
fn numbers_below_zero_are_no_options() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    fs::write(&path, "1\n2\n").unwrap();
    let path = text(&path);
    let list = sweep(folder.path(), &frequencies());
    let list = text(&list);
    for (arguments, found) in [
        (&["info", path, "--rate", "-5"][..], "rate is -5"),
        (&["info", path, "--base-band", "-1e3"], "base_band is -1000"),
        (&["response", list, "--fmin", "-5"], "fmin is -5"),
        (&["response", list, "--calibration", "-0.5"], "calibration is -0.5"),
        (&["waterfall", list, "--fmax", "-5"], "fmax is -5"),
    ] {
        let option = format!("({})", arguments[arguments.len() - 2]);
        has(&complaint(arguments, 2), &[found, "expected a finite number above 0", &option]);
    }
    has(&complaint(&["response", list, "--band", "-3"], 2), &["-3", "a whole number from 1 to 1000"]);
    has(
        &complaint(&["response", list, "--analyser-integrated", "-1"], 2),
        &["-1", "a whole number from 0 to 2"],
    );
}

#[test]
fn a_file_cut_within_its_last_number() {
    let folder = tempfile::tempdir().unwrap();
    let with = |name: &str, content: &str| {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        path
    };
    for (name, rows) in
        [("a.csv", "t [s],v [m/s]\n0.0,1.25\n0.1,1.35\n0.2,1.45\n"), ("a.txt", "1.25\n1.35\n1.45\n")]
    {
        let row = if name == "a.csv" { "0.3," } else { "" };
        let half = with(name, &format!("{rows}{row}3.4e"));
        has(&complaint(&["info", text(&half)], 2), &["\"3.4e\"", "the export was cut off"]);
        let short = with(name, &format!("{rows}{row}3.4"));
        let value = json(&["info", text(&short)]);
        assert!(value["warnings"].to_string().contains("may be cut off"), "{}", value["warnings"]);
        let whole = with(name, &format!("{rows}{row}3.40"));
        let value = json(&["info", text(&whole)]);
        assert!(!value["warnings"].to_string().contains("cut off"), "{}", value["warnings"]);
    }
    let narrow = with("b.csv", "t [s],v [m/s]\n0.0,1.25\n0.1");
    has(&complaint(&["info", text(&narrow)], 2), &["line 3", "1 field in", "cut off"]);
    let narrow = with("b.txt", "0.0 1.25\n0.1 1.35\n0.2");
    has(&complaint(&["info", text(&narrow)], 2), &["line 3", "1 field in this row", "cut off"]);
}

#[test]
fn endings_that_stand_for_no_format_are_told() {
    for (name, found) in [("x.xyz", "x.xyz ends in .xyz"), ("x", "x has no ending")] {
        has(
            &complaint(&["convert", "absent.csv", name], 2),
            &[found, ".uff", ".ufb", ".csv", ".npy", "try:"],
        );
    }
}

/// No user can write to /proc/self.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_written_is_named_and_no_other_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    fs::write(&path, "t [s],v [m/s]\n0,1\n1,2\n").unwrap();
    let found = complaint(&["convert", text(&path), "/proc/self/out.csv"], 2);
    has(&found, &["cannot write /proc/self:"]);
    assert!(!found.contains(".part") && !found.contains(".lock"), "{found}");
    let list = sweep(folder.path(), &frequencies());
    let found = complaint(&["response", text(&list), "--out", "/proc/self/out"], 2);
    has(&found, &["/proc/self/out:"]);
}

#[test]
fn a_list_that_leads_outside_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).unwrap();
    let list = sweep(&inner, &frequencies());
    let escaped = fs::read_to_string(&list).unwrap().replace("VUP0003.DAT", "../VUP0003.DAT");
    fs::write(&list, escaped).unwrap();
    fs::rename(inner.join("VUP0003.DAT"), folder.path().join("VUP0003.DAT")).unwrap();
    has(&complaint(&["response", text(&list)], 2), &["../VUP0003.DAT", "outside", "--allow-outside"]);
    json(&["response", text(&list), "--allow-outside"]);
}

#[test]
fn a_file_of_another_length() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    fs::write(folder.path().join("VUP0005.DAT"), "1\n2\n3\n").unwrap();
    has(&complaint(&["response", text(&list)], 2), &["VUP0005.DAT", "3 values", "201", "try:"]);
}

#[test]
fn a_force_of_zeros() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    fs::write(folder.path().join("FUP0002.DAT"), "0.0\n".repeat(201)).unwrap();
    has(&complaint(&["excitation", text(&list)], 2), &["FUP0002.DAT", "zero", "try:"]);
}

#[test]
fn odd_sweeps_are_answered_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let mut shuffled = frequencies();
    shuffled.swap(3, 4);
    let warned = |frequencies: &[f64], code: &str| {
        let list = sweep(folder.path(), frequencies);
        let value = json(&["response", text(&list), "--unit", "m/s"]);
        assert_eq!(value["points"].as_array().unwrap().len(), frequencies.len());
        let findings = value["findings"].as_array().unwrap();
        assert!(findings.iter().any(|f| f["code"] == code), "{}", value["findings"]);
    };
    warned(&shuffled, "sweep-out-of-order");
    let mut doubled = frequencies();
    doubled[5] = doubled[4];
    warned(&doubled, "sweep-steps-repeated");
    warned(&[5.03], "sweep-too-few-points");
    // Repeated excitations have one row each in the map.
    let list = sweep(folder.path(), &doubled);
    let out = folder.path().join("out");
    json(&["waterfall", text(&list), "--unit", "m/s", "--out", text(&out)]);
}

#[test]
fn a_window_that_does_not_fit_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    for (window, said) in [("hann", false), ("rectangular", true), ("flat-top", true)] {
        let value = json(&["response", text(&list), "--unit", "m/s", "--window", window]);
        let finding =
            &value["findings"].as_array().unwrap().iter().find(|f| f["code"] == "sweep-window-unlike");
        assert_eq!(finding.map(|f| f["numbers"]["better"].clone()), said.then(|| "hann".into()), "{window}");
        assert_eq!(value["points"][0]["amplitude"]["std"].is_null(), said, "{window}");
    }
}

#[test]
fn the_largest_line_elsewhere_is_flagged() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    fs::write(folder.path().join("VUP0006.DAT"), spectrum(15.02, 1.0)).unwrap();
    let value = json(&["response", text(&list), "--unit", "m/s"]);
    assert_eq!(value["points"][5]["largest_elsewhere"], true);
    assert_eq!(value["points"][4]["largest_elsewhere"], false);
}

#[test]
fn mistakes_in_a_campaign_point_at_their_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("campaign.toml");
    let with = |content: &str| fs::write(&path, content).unwrap();
    with("name = \"x\"\n\n[[sweep]]\nname = \"a\"\nlist = \"L.TXT\"\ndirektion = \"up\"\n");
    let found = complaint(&["run", text(&path)], 2);
    has(&found, &["campaign.toml, line 6, column 1", "direktion", "^^^", "did you mean `direction`?"]);
    with("[[sweep]]\nname = \"a\"\nlist = \"L.TXT\"\n");
    has(&complaint(&["run", text(&path)], 2), &["line 3", "L.TXT", "does not exist", "^"]);
    with("[rig]\nm1 = -1.0\n");
    has(&complaint(&["run", text(&path)], 2), &["m1 is -1 kg"]);
    with("[[sweep]]\nname = \"a\"\nlist = \"../L.TXT\"\n");
    has(&complaint(&["run", text(&path)], 2), &["outside", "line 3"]);
    // Failed runs leave no files.
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert!(left.iter().all(|n| n == "campaign.toml"), "{left:?}");
    with("name = \"nothing asked\"\n");
    json(&["run", text(&path)]);
    has(&complaint(&["compare", text(&path)], 2), &["[rig]", "try:"]);
}

#[test]
fn a_rig_and_a_campaign_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let (rig, campaign) = (folder.path().join("rig.toml"), folder.path().join("campaign.toml"));
    fs::write(&rig, "m1 = 0.42\ngap = 1e-3\n[excitation]\nkind = \"sine\"\nforce = 0.4\n").unwrap();
    fs::write(&campaign, "name = \"x\"\n[rig]\nm1 = 0.42\n[excitation]\nforce = 0.4\n").unwrap();
    for command in ["run", "compare"] {
        let found = complaint(&[command, text(&rig)], 2);
        has(&found, &["rig.toml: this is a rig, not a campaign", "[[sweep]]", "try: `vibro model orbit "]);
    }
    for command in ["orbit", "choose"] {
        let found = complaint(&["model", command, text(&campaign), "--frequency", "5"], 2);
        has(&found, &["campaign.toml: [rig]: this is a campaign, not a rig", "try:", "`vibro run "]);
    }
    // An unknown key is still reported as one.
    fs::write(&campaign, "gap = 1e-3\n[[frf]]\nfile = \"a.uff\"\n").unwrap();
    has(&complaint(&["run", text(&campaign)], 2), &["line 1", "unknown key `gap`"]);
}

#[test]
fn a_name_that_is_not_in_the_campaign() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("campaign.toml");
    sweep(folder.path(), &frequencies());
    fs::write(&path, "[[sweep]]\nname = \"a\"\nlist = \"LIST.TXT\"\nquantity = \"velocity\"\n").unwrap();
    has(&complaint(&["response", &format!("{}#b", text(&path))], 2), &["\"b\"", "expected a"]);
    json(&["response", &format!("{}#a", text(&path))]);
    json(&["response", text(&path)]);
}

#[test]
fn a_failed_conversion_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let (bad, out) = (folder.path().join("bad.txt"), folder.path().join("out.csv"));
    fs::write(&bad, "1\nx\n").unwrap();
    fs::write(&out, "old").unwrap();
    complaint(&["convert", text(&bad), text(&out)], 2);
    assert_eq!(fs::read_to_string(&out).unwrap(), "old");
    let deep = folder.path().join("no/such/folder/out.csv");
    fs::write(&bad, "1\n2\n").unwrap();
    has(&complaint(&["convert", text(&bad), text(&deep)], 2), &["folder", "does not exist"]);
}

#[test]
fn a_source_is_never_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scope.csv");
    fs::write(&path, "t [s],v [m/s]\n0,1\n1,2\n").unwrap();
    let other = folder.path().join(".").join("scope.csv");
    has(&complaint(&["convert", text(&path), text(&other)], 2), &["same file", "try:"]);
    let list = sweep(folder.path(), &frequencies());
    complaint(&["excitation", text(&list), "--write-lists", text(&list), "x.txt"], 2);
    complaint(&["excitation", text(&list), "--write-lists", text(&other), text(&path)], 2);
}

#[test]
fn what_files_state_is_believed_and_contradictions_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    let plain = json(&["response", text(&list), "--unit", "m/s"]);
    for i in 1..=frequencies().len() {
        let path = folder.path().join(format!("VUP{i:04}.DAT"));
        let values: Vec<f64> =
            fs::read_to_string(&path).unwrap().lines().map(|l| l.parse().unwrap()).collect();
        let rms: Vec<String> = values.iter().map(|v| format!("{:e}", v * 1e3)).collect();
        fs::write(&path, format!("unit: mm/s\nwindow: hann\n{}\n", rms.join("\n"))).unwrap();
    }
    for arguments in [&["response", text(&list)][..], &["response", text(&list), "--unit", "mm/s"]] {
        let value = json(arguments);
        let (a, b) = (&value["points"][3]["amplitude"]["value"], &plain["points"][3]["amplitude"]["value"]);
        assert!((a.as_f64().unwrap() / b.as_f64().unwrap() - 1.0).abs() < 1e-12, "{a} against {b}");
        assert_eq!(value["unit"], "m");
    }
    has(&complaint(&["response", text(&list), "--unit", "mm"], 2), &["velocity", "displacement", "try:"]);
    has(&complaint(&["response", text(&list), "--unit", "N"], 2), &["force"]);
}

#[test]
fn frequency_limits_that_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    for fmin in ["50", "1e30"] {
        has(&complaint(&["response", text(&list), "--fmin", fmin], 2), &["cut-off", "20 Hz"]);
    }
    let out = folder.path().join("out");
    let limits = ["waterfall", text(&list), "--fmin", "3", "--fmax", "2", "--out", text(&out)];
    has(&complaint(&limits, 2), &["cut-off", "try:"]);
    assert!(!out.exists());
}

#[test]
fn failures_are_objects_where_json_was_asked_for() {
    for arguments in [&["response", "absent.txt", "--json"][..], &["run", "absent.toml", "--json"]] {
        let output = vibro(arguments);
        assert_eq!(output.status.code(), Some(2));
        let value: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
        assert!(value["error"].as_str().unwrap().contains("absent") && value["warnings"].is_array());
    }
    let output = vibro(&["info", "absent.txt", "--json"]);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
    assert_eq!(value["errors"].as_array().unwrap().len(), 1);
}

/// Replaces response files of a sweep by a text made from their values.
fn rewrite(
    folder: &std::path::Path,
    which: std::ops::RangeInclusive<usize>,
    make: impl Fn(&[f64]) -> String,
) {
    for i in which {
        let path = folder.join(format!("VUP{i:04}.DAT"));
        let values: Vec<f64> =
            fs::read_to_string(&path).unwrap().lines().map(|l| l.parse().unwrap()).collect();
        fs::write(&path, make(&values)).unwrap();
    }
}

#[test]
fn a_list_that_contradicts_the_frequency_column_of_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    let plain = json(&["response", text(&list), "--unit", "m/s"]);
    // The same lines with a frequency column, from 0 to 20 Hz in steps of 0.1 Hz.
    let column = |values: &[f64]| {
        let rows = values.iter().enumerate().map(|(k, v)| format!("{:.1},{v:e}", k as f64 * 0.1));
        format!("Frequency [Hz],v [m/s]\n{}\n", rows.collect::<Vec<_>>().join("\n"))
    };
    rewrite(folder.path(), 3..=4, column);
    let same = json(&["response", text(&list), "--unit", "m/s"]);
    assert_eq!(same["points"][3]["amplitude"]["value"], plain["points"][3]["amplitude"]["value"]);
    let written = fs::read_to_string(&list).unwrap();
    fs::write(&list, written.replacen("\n20\n", "\n40\n", 1)).unwrap();
    let found = complaint(&["response", text(&list)], 2);
    has(&found, &["VUP0003.DAT", "from 0 to 20 Hz", "base band of 40 Hz", "try:"]);
    has(&found, &["2 of 24 files cannot be read so: VUP0003.DAT, VUP0004.DAT"]);
}

#[test]
fn decibels_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    let level = |v: f64| 20.0 * (v / 1e-6).log10();
    rewrite(folder.path(), 2..=2, |values| {
        values.iter().map(|v| format!("{:.3}", level(*v) - 90.0)).collect::<Vec<_>>().join("\n")
    });
    let found = complaint(&["response", text(&list)], 2);
    has(&found, &["VUP0002.DAT", "are these decibels?", "Line 0 (0 Hz)", "linear amplitudes"]);
    // A header that states decibels is enough, even where no level is negative.
    for header in ["Unit: dB", "Y axis: dB re 1e-9 m/s", "Level (dB)"] {
        sweep(folder.path(), &frequencies());
        rewrite(folder.path(), 2..=2, |_| format!("{header}\n{}", "60.5\n".repeat(201)));
        has(&complaint(&["response", text(&list)], 2), &["VUP0002.DAT", "says that its values are decibels"]);
    }
}

#[test]
fn one_true_sentence_is_said_of_the_unit() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    let campaign = folder.path().join("campaign.toml");
    let said = |arguments: &[&str]| {
        let warnings = json(arguments)["warnings"].as_array().unwrap().clone();
        warnings
            .iter()
            .map(|w| w.as_str().unwrap().to_owned())
            .filter(|w| w.contains("unit"))
            .collect::<Vec<_>>()
    };
    let list = text(&list);
    assert_eq!(said(&["response", list, "--unit", "mm/s"]), Vec::<String>::new());
    let assumed = |unit: &str| format!("No unit of the responses is known: {unit} is assumed. State --unit.");
    assert_eq!(said(&["response", list]), [assumed("m")]);
    fs::write(&campaign, "[[sweep]]\nname = \"a\"\nlist = \"LIST.TXT\"\nquantity = \"velocity\"\n").unwrap();
    assert_eq!(said(&["response", text(&campaign)]), [assumed("m/s")]);
    fs::write(
        &campaign,
        "[[sweep]]\nname = \"a\"\nlist = \"LIST.TXT\"\nquantity = \"velocity\"\nunit = \"mm\"\n",
    )
    .unwrap();
    let found = complaint(&["response", text(&campaign)], 2);
    has(&found, &["line 5", "a unit of velocity, such as m/s or mm/s"]);
    assert!(!found.contains("or g"), "{found}");
}

#[test]
fn a_spectrum_in_place_of_a_list_and_an_empty_campaign() {
    let folder = tempfile::tempdir().unwrap();
    sweep(folder.path(), &frequencies());
    let found = complaint(&["response", text(&folder.path().join("VUP0001.DAT"))], 2);
    has(&found, &["a list holds: number of points", "traces = \"step_*.csv\""]);
    let several = folder.path().join("VUP*.DAT");
    has(&complaint(&["response", text(&several)], 2), &["VUP0001.DAT", "expected a force in N", "[[sweep]]"]);
    let path = folder.path().join("campaign.toml");
    fs::write(&path, "").unwrap();
    has(&complaint(&["run", text(&path)], 2), &["the file is empty; expected a campaign", "[[sweep]]"]);
    fs::write(&path, "name = \"x\"\n[[frf]]\nfile = \"absent.uff\"\n").unwrap();
    has(&complaint(&["run", text(&path)], 2), &["line 3", "absent.uff does not exist", "^"]);
}

#[test]
fn a_file_that_a_list_names_and_that_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    fs::remove_file(folder.path().join("VUP0002.DAT")).unwrap();
    // Line 17 is the second response file, after three numbers and twelve force files.
    has(
        &complaint(&["response", text(&list)], 2),
        &["LIST.TXT, line 17", "1 of 24 files is missing", "VUP0002.DAT"],
    );
}

/// The hint in an error message, after `try:`.
fn hint(complaint: &str) -> &str {
    let hint = complaint.split("try: ").nth(1).unwrap_or_else(|| panic!("no hint: {complaint}"));
    hint.lines().next().unwrap()
}

/// Splits a line into words as a shell does.
fn words(typed: &str) -> Vec<String> {
    let parts = typed.split('"').enumerate().flat_map(|(k, part)| -> Vec<&str> {
        if k % 2 == 1 { vec![part] } else { part.split_whitespace().collect() }
    });
    parts.map(str::to_owned).collect()
}

#[test]
fn what_a_command_tells_to_type_works() {
    let folder = tempfile::tempdir().unwrap();
    let run = |words: &[String]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_vibro"));
        command.args(words).current_dir(folder.path()).output().unwrap()
    };
    let trace = "t [s],v [m/s]\n0,1\n0.1,2\n0.2,1\n0.3,2\n";
    for name in ["Hammertest 2024.csv", "hammer m1-m2 5 hits.txt", "step 1.csv", "step 2.csv"] {
        fs::write(folder.path().join(name), trace).unwrap();
    }
    fs::write(folder.path().join("c.txt"), "1\n2\n1\n2\n").unwrap();
    for (wrong, expected) in [
        ("info Hammertest.csv", "vibro info \"Hammertest 2024.csv\""),
        ("response \"hammer m1-m2 5 hits.txt\"", "vibro info \"hammer m1-m2 5 hits.txt\""),
        ("inf c.txt", "vibro info c.txt"),
        ("info c.txt --rate 1,5", "--rate 1.5"),
        ("info c.txt --rate 5kHz", "--rate 5000"),
        ("info c.txt --rate 5,5kHz", "--rate 5500"),
        ("info c.txt --decimal komma", "--decimal comma"),
        ("info \"step 1.csv\" --span 0-0.2", "--span 0:0.2"),
        ("info \"step 1.csv\" --stretch 1.0", "--stretch 1"),
        ("info c.txt --rate x", "vibro info --help"),
        ("info c.txt --rate 1 --base-band 2", "vibro info --help"),
        ("excitation c.txt --write-lists x", "vibro excitation --help"),
        ("restitution --masses 1;2 --before 1,0 --after 0.1,0.45", "--masses 1,2"),
        ("spectrum c.txt --rate 10 --window kaiser", "vibro spectrum --help"),
        ("spectrum c.txt --rate 10 --integrate 3", "vibro spectrum --help"),
    ] {
        let typed = words(wrong);
        let output = run(&typed);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{wrong}: {said}");
        let told = hint(&said);
        assert_eq!(told, expected, "{wrong}: {said}");
        let mended = if let Some(command) = told.strip_prefix("vibro ") {
            words(command)
        } else {
            let [option, value] = words(told).try_into().unwrap();
            let at = typed.iter().position(|word| *word == option).unwrap();
            [&typed[..=at], &[value], &typed[at + 2..]].concat()
        };
        let output = run(&mended);
        assert!(output.status.success(), "{wrong}: {told}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn what_a_campaign_is_told_to_write_works() {
    let folder = tempfile::tempdir().unwrap();
    let trace = "t [s],v [m/s]\n0,1\n0.1,2\n0.2,1\n0.3,2\n";
    fs::write(folder.path().join("a.csv"), trace).unwrap();
    let path = folder.path().join("campaign.toml");
    let drill = "[[drill]]\nfile = \"a.csv\"\nvelocity = \"v\"\nbeam_angle = 0\nbeam_from = \"axis\"\nsensitivity = 1\n";
    let frf = "[[frf]]\nfile = \"a.csv\"\nreference = 1\n";
    for (table, wrong, right) in [
        (drill, "low_pass = 40000,", "low_pass = 40000"),
        (drill, "low_pass = 40000,5", "low_pass = 40000.5"),
        (drill, "low_pass = \"no\"", "low_pass = \"none\""),
        (drill, "low_pass = \"40 kHz\"", "low_pass = 40000"),
        (drill, "edge = \"up\"", "edge = \"rising\""),
        (drill, "edge = \"fallin\"", "edge = \"falling\""),
        (drill, "edge = 3", "edge = \"rising\""),
        (drill, "pulses_per_turn = 1.0 # one", "pulses_per_turn = 1"),
        (frf, "band = \"1-2\"", "band = [1, 2]"),
        (frf, "band = 1:2", "band = [1, 2]"),
        (frf, "band = [1; 2]", "band = [1, 2]"),
        (frf, "hammer = yes", "hammer = true"),
        (frf, "hammer = 1", "hammer = true"),
        (frf, "least coherence = 0.5", "least_coherence = 0.5"),
        (frf, "least_coherence = 50 %", "least_coherence = 0.5"),
        (frf, "least_coherence = ,5", "least_coherence = 0.5"),
        (frf, "least_coherence: 0,5", "least_coherence = 0.5"),
        ("[fit]\n", "parameters = \"gap\"", "parameters = [\"gap\"]"),
        ("[fit]\n", "parameters = [\"gapp\", \"k1\"]", "parameters = [\"gap\", \"k1\"]"),
        ("[rig]\n", "gap = 1 mm", "gap = 0.001"),
        ("", "[[rig]]", "[rig]"),
        ("", "[[frf]", "[[frf]]"),
        ("", "name = abc", "name = \"abc\""),
        ("", "name = 3", "name = \"3\""),
    ] {
        fs::write(&path, format!("{table}{wrong}\n")).unwrap();
        let said = complaint(&["check", text(&path)], 2);
        let told = hint(&said).strip_prefix("write ").unwrap_or_else(|| panic!("{wrong}: {said}"));
        assert_eq!(told, right, "{said}");
        fs::write(&path, format!("{table}{told}\n")).unwrap();
        let output = vibro(&["check", text(&path)]);
        let said = String::from_utf8_lossy(&output.stderr);
        let line = format!("campaign.toml, line {}", table.lines().count() + 1);
        // A table without its file is reported at its first line.
        assert!(!said.contains(&line) || right == "[[frf]]", "{said}");
    }
    // A value without a likely meaning has no hint.
    for (table, wrong) in [("[rig]\n", "gap = true"), (frf, "band = [1]"), (frf, "channel = 1.5")] {
        fs::write(&path, format!("{table}{wrong}\n")).unwrap();
        let said = complaint(&["check", text(&path)], 2);
        assert!(said.contains(&format!("{wrong}; expected ")) && !said.contains("try: write"), "{said}");
    }
}

#[test]
fn three_findings_are_printed_and_the_rest_counted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("campaign.toml");
    let kinds = ["pulse", "impacts", "decay", "frf", "spectrum"];
    let table = |kind: &str| format!("# [[{kind}]]\n# file = \"{kind}.csv\"\n");
    for (tables, printed, last) in [(5, 3, Some("and 2 notes more; all findings: --json")), (4, 4, None)] {
        fs::write(&path, kinds[..tables].iter().map(|kind| table(kind)).collect::<String>()).unwrap();
        let said = String::from_utf8(vibro(&["check", text(&path)]).stderr).unwrap();
        assert_eq!(said.lines().filter(|line| line.starts_with("note: ")).count(), printed, "{said}");
        assert_eq!(said.lines().nth(printed), last, "{said}");
        assert_eq!(json(&["check", text(&path)])["findings"].as_array().unwrap().len(), tables);
    }
}
