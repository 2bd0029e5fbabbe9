//! A folder of recordings without a campaign: `vibro init`, `vibro check`, `vibro run FOLDER`, `vibro
//! response FILES`.

use super::stepped::steps;
use super::{complaint, json, text, vibro};
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;
use vibroimpact::math::Noise;

/// Writes a file with the time and one channel.
pub fn write(path: &Path, head: &str, rate: f64, seconds: f64, value: &mut dyn FnMut(f64) -> f64) {
    let mut text = format!("time [s],{head}\n");
    for i in 0..(rate * seconds) as usize {
        let t = i as f64 / rate;
        writeln!(text, "{t:.6},{:.7}", value(t)).unwrap();
    }
    fs::write(path, text).unwrap();
}

/// A burst of ringing at 2900 Hz that begins at t = 0.
pub fn burst(t: f64) -> f64 {
    if t < 0.0 { 0.0 } else { (-t / 0.003).exp() * (TAU * 2900.0 * t).sin() }
}

/// Writes recordings of most kinds. Returns file and section of each expected table, in their order.
fn folder(root: &Path) -> [(&'static str, &'static str); 7] {
    steps(root);
    fs::remove_file(root.join("campaign.toml")).unwrap();
    let mut noise = Noise::new(5);
    let at = |name: &str| root.join(name);
    write(&at("release.csv"), "displacement [mm]", 2000.0, 3.0, &mut |t| {
        let since = (t - 0.3).max(0.0);
        let swing = (-0.02 * TAU * 37.0 * since).exp() * (TAU * 37.0 * since).sin();
        swing + 0.002 * noise.normal()
    });
    write(&at("contact.csv"), "contact [V]", 10_000.0, 3.0, &mut |t| {
        let since = t.rem_euclid(1.0 / 11.0);
        if since < 0.001 { 5.0 } else { 0.02 * noise.normal() }
    });
    write(&at("shaft.csv"), "acceleration [m/s²]", 1000.0, 4.0, &mut |t| {
        (TAU * 23.0 * t).sin() + 0.01 * noise.normal()
    });
    write(&at("pulse.csv"), "acceleration [m/s²]", 200_000.0, 0.004, &mut |t| {
        let part = (t - 0.001) / 0.0009;
        let push = if (0.0..1.0).contains(&part) { (0.5 * TAU * part).sin() } else { 0.0 };
        900.0 * push + 0.5 * noise.normal()
    });
    for (k, rest) in (1..=4).zip([0.4788, 0.4791, 0.4789, 0.4790]) {
        write(&at(&format!("fall{k}.csv")), "sound [V]", 20_000.0, 1.0, &mut |t| {
            burst(t - 0.2) + 0.6 * burst(t - 0.2 - rest) + 0.003 * noise.normal()
        });
    }
    fs::write(at("notes.txt"), "Measured on Monday.\n").unwrap();
    [
        ("step1.csv", "sweep"),
        ("shaft.csv", "spectrum"),
        ("step1.csv", "frf"),
        ("contact.csv", "impacts"),
        ("4 files, fall1.csv to fall4.csv", "drop"),
        ("release.csv", "decay"),
        ("pulse.csv", "pulse"),
    ]
}

/// Files of the folder that a run reports as named by no table.
fn not_named(campaign: &Path) -> String {
    let run = json(&["run", text(campaign)]);
    let findings = run["results"]["findings"].as_array().unwrap();
    let of_files = findings.iter().find(|finding| finding["code"] == "files-not-named");
    of_files.map_or_else(String::new, |found| found["numbers"]["files"].as_str().unwrap().to_owned())
}

#[test]
fn each_record_of_a_folder_gets_the_table_of_its_kind() {
    let root = tempfile::tempdir().unwrap();
    let expected = folder(root.path());
    let answer = json(&["init", text(root.path())]);
    let campaign = root.path().join("campaign.toml");
    assert_eq!(answer["written"], text(&campaign));
    let written = fs::read_to_string(&campaign).unwrap();
    let tables: Vec<&str> =
        written.lines().filter_map(|l| l.trim_start_matches('#').strip_prefix("[[")).collect();
    assert_eq!(
        tables.iter().map(|t| t.trim_end_matches("]]")).collect::<Vec<_>>(),
        expected.map(|(_, section)| section)
    );
    for (file, section) in expected {
        let about = written.lines().any(|l| l.starts_with('#') && l.contains(file));
        assert!(about, "{file} for {section}:\n{written}");
    }
    let keys = |list: &str, key: &str| {
        answer[list].as_array().unwrap().iter().filter(|row| row["key"] == key).count()
    };
    assert_eq!([keys("guessed", "force"), keys("guessed", "response"), keys("missing", "height")], [1, 1, 1]);
    assert_eq!(answer["left"][0][0], "notes.txt");
    // The campaign runs unchanged, and a second `init` does not change it.
    let found = json(&["check", text(&campaign)]);
    assert_eq!(found["files"].as_array().unwrap().len(), 12 + 4);
    let run = json(&["run", text(&campaign)]);
    assert_eq!(run["results"]["frf"][0]["modes"].as_array().unwrap().len(), 2);
    assert!(json(&["init", text(root.path())])["found"].as_array().unwrap().is_empty());
    assert_eq!(fs::read_to_string(&campaign).unwrap(), written);
    assert!(!run.to_string().contains("files-not-named"));
    // A recording that is added later is reported, and `init` appends a table for it.
    fs::copy(root.path().join("release.csv"), root.path().join("later.csv")).unwrap();
    assert_eq!(not_named(&campaign), "later.csv");
    json(&["init", text(root.path())]);
    let longer = fs::read_to_string(&campaign).unwrap();
    assert!(
        longer.starts_with(&written) && longer[written.len()..].contains("file = \"later.csv\""),
        "{longer}"
    );
    let later = json(&["run", text(&campaign)]);
    let decays = |run: &Value| run["results"]["decays"].as_array().unwrap().len();
    assert_eq!(decays(&later), 1 + decays(&run));
}

/// Two drops in one record: the bounces of one cannot be told from those of the other.
#[test]
fn drops_whose_bounces_are_not_told_yet_are_drops_with_what_to_try() {
    let root = tempfile::tempdir().unwrap();
    let bounces = [0.3, 0.72, 1.014, 1.22, 2.3, 2.72, 3.014, 3.22];
    let ring = |t: f64| if t < 0.0 { 0.0 } else { (-t / 7e-3).exp() * (7200.0 * t).cos() };
    let mut sound = |t: f64| {
        let each = bounces.iter().enumerate().map(|(k, at)| 0.7f64.powi((k % 4) as i32) * ring(t - at));
        each.sum()
    };
    write(&root.path().join("two.csv"), "sound [V]", 8000.0, 3.75, &mut sound);
    let answer = json(&["init", text(root.path())]);
    assert_eq!(answer["missing"][0]["key"], "height", "{answer}");
    let refused = &answer["refused"][0];
    assert_eq!(
        (&refused["file"], &refused["code"]),
        (&"two.csv".into(), &"bounces-untold".into()),
        "{answer}"
    );
    assert!(refused["reason"].as_str().unwrap().contains("two series of bounces"), "{answer}");
    let written = fs::read_to_string(root.path().join("campaign.toml")).unwrap();
    let (_, refused) = written.split_once("two series of bounces").expect("why it is left out");
    assert!(refused.contains("`span = [") && refused.contains("#[[drop]]"), "{written}");
    // A check prints the keys that would help.
    let said = String::from_utf8(vibro(&["check", text(root.path())]).stderr).unwrap();
    assert!(said.contains("two.csv is not measured yet: ") && said.contains("`span = ["), "{said}");
}

#[test]
fn a_folder_runs_without_a_campaign_and_nothing_is_written_beside_its_files() {
    let root = tempfile::tempdir().unwrap();
    folder(root.path());
    let before: Vec<_> = fs::read_dir(root.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    for _ in 0..2 {
        // The second run ignores the results of the first.
        let output = vibro(&["run", text(root.path())]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{said}");
        let of_files = said.lines().filter(|line| !line.contains("; all findings: "));
        assert!(!of_files.collect::<String>().contains("results"), "{said}");
        assert!(said.contains("guessed: force = \"Force\""), "{said}");
    }
    let mut after: Vec<_> = fs::read_dir(root.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    after.retain(|name| name != "results");
    assert_eq!(after.len(), before.len());
    let results: Value =
        serde_json::from_slice(&fs::read(root.path().join("results/results.json")).unwrap()).unwrap();
    let interval = &results["impacts"][0]["interval"];
    let [value, std] = ["value", "std"].map(|key| interval[key].as_f64().unwrap());
    // Samples are 0.1 ms apart; the mean of 33 intervals of 1/11 s is off by at most a quarter of that.
    assert!((value - 1.0 / 11.0).abs() < 2.5e-5 && std < 1e-4, "{interval}");
}

#[test]
fn a_sweep_is_named_by_its_files_a_pattern_or_a_folder() {
    let root = tempfile::tempdir().unwrap();
    steps(root.path());
    let files: Vec<String> =
        (1..=12).map(|k| text(&root.path().join(format!("step{k}.csv"))).to_owned()).collect();
    let named = json(&[&["response".to_owned()][..], &files].concat());
    let pattern = json(&["response", text(&root.path().join("step*.csv"))]);
    let of_folder = json(&["response", text(root.path())]);
    assert_eq!(named["points"].as_array().unwrap().len(), 12);
    assert_eq!(named["points"], pattern["points"]);
    assert_eq!(named["points"], of_folder["points"]);
    // A single trace is no sweep, and traces without a force are none.
    let alone = root.path().join("alone.csv");
    write(&alone, "sound [V]", 1000.0, 1.0, &mut f64::sin);
    let said = complaint(&["response", text(&alone), text(&alone)], 2);
    assert!(said.contains("sound [V]") && said.contains("[[sweep]]"), "{said}");
    let said = complaint(&["response", text(&root.path().join("step1.csv"))], 2);
    assert!(said.contains("all steps of a sweep") && said.contains("step*.csv"), "{said}");
}

#[test]
fn a_folder_without_recordings_is_named_and_a_rate_can_be_stated() {
    let root = tempfile::tempdir().unwrap();
    assert!(complaint(&["init", text(root.path())], 2).contains("no recording"));
    let values: Vec<String> = (0..4000).map(|i| (f64::from(i) * 0.3).sin().to_string()).collect();
    let values = values.join("\n");
    fs::write(root.path().join("column.dat"), values).unwrap();
    assert!(complaint(&["init", text(root.path())], 2).contains("--rate"));
    json(&["init", text(root.path()), "--rate", "1000", "--unit", "m/s²"]);
    let written = fs::read_to_string(root.path().join("campaign.toml")).unwrap();
    assert!(written.contains("rate = 1000") && written.contains("unit = \"m/s²\""), "{written}");
}

/// Steps between 0.3 and 1.7 ms. What the complaint names is typed.
#[test]
fn of_uneven_samples_the_rate_that_interpolates_is_named_and_taken() {
    let root = tempfile::tempdir().unwrap();
    let mut noise = Noise::new(7);
    let (mut table, mut t) = ("time [s],a [m/s²]\n".to_owned(), 0.0);
    for _ in 0..3000 {
        t += 1e-3 * noise.between(0.3, 1.7);
        writeln!(table, "{t:.6},{:.6}", (20.0 * t).sin()).unwrap();
    }
    fs::write(root.path().join("uneven.csv"), table).unwrap();
    let said = complaint(&["init", text(root.path())], 2);
    let rate = said.split("--resample ").nth(1).expect(&said).split([' ', ')']).next().unwrap();
    json(&["init", text(root.path()), "--resample", rate]);
    let written = fs::read_to_string(root.path().join("campaign.toml")).unwrap();
    assert!(written.contains(&format!("resample = {rate}")), "{written}");
}

/// 1 s of samples, a gap of 0.3 s, then 1.5 s of samples.
#[test]
fn of_a_record_with_lost_samples_the_longest_even_stretch_is_proposed() {
    let dir = tempfile::tempdir().unwrap();
    let instants = (0..1000).chain(1300..2800).map(|i| f64::from(i) * 1e-3);
    let mut table = "time [s],acceleration [m/s²]\n".to_owned();
    for t in instants {
        writeln!(table, "{t:.3},{:.5}", (TAU * 20.0 * t).sin()).unwrap();
    }
    fs::write(dir.path().join("pause.csv"), table).unwrap();
    json(&["init", text(dir.path())]);
    let campaign = fs::read_to_string(dir.path().join("campaign.toml")).unwrap();
    assert!(campaign.contains("\nstretch = 2   # guessed: "), "{campaign}");
    let answer = json(&["run", text(dir.path())]);
    let spectrum = &answer["results"]["spectra"][0];
    let values: Vec<f64> = spectrum["value"].as_array().unwrap().iter().filter_map(Value::as_f64).collect();
    let largest = (0..values.len()).max_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap();
    // A record of 1.5 s has lines 0.67 Hz apart.
    assert!((spectrum["frequency"][largest].as_f64().unwrap() - 20.0).abs() < 0.67, "{largest}");
}

/// A bad cell loses the shorter part of the record beside it, not the record.
#[test]
fn of_a_record_with_a_bad_cell_the_longest_part_without_is_proposed() {
    let dir = tempfile::tempdir().unwrap();
    for (name, cell) in [("blank.csv", ""), ("word.csv", "ERR")] {
        let mut table = "time [s],acceleration [m/s²]\n".to_owned();
        for i in 0..2500 {
            let (t, cell) = (f64::from(i) * 1e-3, if i == 999 { Some(cell) } else { None });
            let value = || format!("{:.5}", (TAU * 20.0 * t).sin());
            writeln!(table, "{t:.3},{}", cell.map_or_else(value, str::to_owned)).unwrap();
        }
        fs::write(dir.path().join(name), table).unwrap();
    }
    json(&["init", text(dir.path())]);
    let campaign = fs::read_to_string(dir.path().join("campaign.toml")).unwrap();
    for key in ["allow_missing = true ", "span = [0.9995,2.4995] "] {
        assert_eq!(campaign.matches(&format!("\n{key}")).count(), 2, "{key} in {campaign}");
    }
    let answer = json(&["run", text(dir.path())]);
    for spectrum in answer["results"]["spectra"].as_array().unwrap() {
        // 1500 samples: 751 lines.
        assert_eq!(spectrum["frequency"].as_array().unwrap().len(), 751);
    }
}

#[test]
fn the_help_begins_with_five_commands_and_each_has_an_example() {
    let short = String::from_utf8(vibro::<&str>(&[]).stderr).unwrap();
    assert_eq!(short.lines().filter(|l| l.starts_with("  ")).count(), 5, "{short}");
    let help = String::from_utf8(vibro(&["--help"]).stdout).unwrap();
    let listed = help.lines().take_while(|l| *l != "Options:").filter(|l| l.starts_with("  "));
    for command in listed.filter_map(|l| l.split_whitespace().next()) {
        let help = String::from_utf8(vibro(&[command, "--help"]).stdout).unwrap();
        assert!(help.contains(&format!("Example:\n  vibro {command} ")), "{help}");
    }
    for shell in ["bash", "zsh", "fish", "powershell"] {
        let completions = String::from_utf8(vibro(&["completions", shell]).stdout).unwrap();
        assert!(completions.contains("restitution"), "{shell}");
    }
    assert!(String::from_utf8(vibro(&["man"]).stdout).unwrap().starts_with(".ie"));
}

#[test]
fn an_example_is_written_with_its_recordings_and_runs() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("bench");
    let listed = json(&["demo"]);
    assert_eq!(listed["demos"].as_array().unwrap().len(), 4);
    let answer = json(&["demo", "bench", "--out", text(&folder)]);
    assert_eq!(answer["results"]["decays"][0]["modes"].as_array().unwrap().len(), 1);
    // The recordings equal those of the repository. A second call writes nothing, and a changed file is not
    // replaced.
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bench");
    for name in ["BENCH.CSV", "PULSE.CSV", "FILTERED.CSV", "DECAY.CSV", "TRUTH.csv", "campaign.toml"] {
        assert_eq!(fs::read(folder.join(name)).unwrap(), fs::read(own.join(name)).unwrap(), "{name}");
    }
    json(&["demo", "bench", "--out", text(&folder)]);
    fs::write(folder.join("DECAY.CSV"), "mine").unwrap();
    assert!(complaint(&["demo", "bench", "--out", text(&folder)], 2).contains("does not replace"));
    assert_eq!(fs::read_to_string(folder.join("DECAY.CSV")).unwrap(), "mine");
    assert!(complaint(&["demo", "bensh"], 2).contains("try: vibro demo bench"));
    assert!(complaint(&["open", text(root.path())], 2).contains("vibro run"));
}

#[test]
fn a_folder_that_is_watched_runs_again_when_a_file_lands() {
    let root = tempfile::tempdir().unwrap();
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bench");
    let copy = |name: &str| fs::copy(own.join(name), root.path().join(name)).unwrap();
    copy("DECAY.CSV");
    let mut child = Command::new(env!("CARGO_BIN_EXE_vibro"))
        .args(["run", "--watch", text(root.path())])
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let pulses = || {
        let bytes = fs::read(root.path().join("results/results.json")).ok()?;
        let results: Value = serde_json::from_slice(&bytes).ok()?;
        Some(results["pulses"].as_array().map_or(0, Vec::len))
    };
    let wait = |wanted: usize| {
        // A loaded machine needs some seconds.
        (0..300).any(|_| {
            std::thread::sleep(std::time::Duration::from_millis(100));
            pulses() == Some(wanted)
        })
    };
    let first = wait(0);
    std::thread::sleep(std::time::Duration::from_millis(700));
    copy("PULSE.CSV");
    let second = wait(1);
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(first && second, "{first} {second}");
}

/// Two accelerometers of the same name, one clipped step, and a file name that would end a comment.
#[cfg(unix)]
#[test]
fn odd_names_and_one_bad_step_still_give_a_campaign_that_runs() {
    let root = tempfile::tempdir().unwrap();
    let mut noise = Noise::new(3);
    for step in 1..=8 {
        let f = 20.0 + 3.0 * f64::from(step);
        let mut text = "time [s],F [N],acc [m/s²],acc [m/s²]\n".to_owned();
        for i in 0..3000 {
            let (sin, cos) = (TAU * f * f64::from(i) / 600.0).sin_cos();
            let end = if step == 3 { 0.6 } else { f64::INFINITY };
            let (a, b) =
                ((2.0 * sin).clamp(-end, end) + 0.003 * noise.normal(), cos + 0.003 * noise.normal());
            writeln!(text, "{:.6},{:.6},{a:.6},{b:.6}", f64::from(i) / 600.0, 3.0 * cos).unwrap();
        }
        fs::write(root.path().join(format!("run{step}.csv")), text).unwrap();
    }
    fs::write(root.path().join("x\n[[sweep]].csv"), "no numbers\n").unwrap();
    json(&["init", text(root.path())]);
    let campaign = root.path().join("campaign.toml");
    json(&["check", text(&campaign)]);
    let answer = json(&["run", text(&campaign)]);
    let responses = answer["results"]["responses"].as_array().unwrap();
    assert_eq!(responses.iter().map(|r| r["points"].as_array().unwrap().len()).collect::<Vec<_>>(), [8, 8]);
}

#[test]
fn a_check_names_channels_that_are_not_there_and_tables_that_are_comments() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("campaign.toml");
    fs::write(folder.path().join("a.csv"), "t [s],force [N],a [m/s2]\n0,1,2\n0.1,2,1\n0.2,1,0\n").unwrap();
    let with = |text: &str| fs::write(&path, text).unwrap();
    with("[[frf]]\nfile = \"a.csv\"\nreference = \"forc\"\n");
    let found = complaint(&["check", text(folder.path())], 2);
    assert!(found.contains("line 3") && found.contains("try: \"force\""), "{found}");
    with(
        "[[frf]]\nfile = \"a.csv\"\nreference = \"force\"\n\n# [[drill]] of Monday\n#[[drill]]\n#file = \"drill.csv\" # left\n#beam_angle =   # missing: degrees\n#edge = \"rising\"\n\n#[[pulse]]\n#file = \"a.csv\"\n",
    );
    let value = json(&["check", text(folder.path())]);
    let found = value["findings"].as_array().unwrap();
    assert_eq!(found.len(), 1, "{value}");
    let (subject, numbers) = (&found[0]["subject"], &found[0]["numbers"]);
    assert_eq!(
        (subject, &numbers["keys"], &numbers["line"]),
        (&"drill.csv".into(), &"beam_angle".into(), &6.0.into())
    );
}

/// `init` inside the folder, with file names that are parts of others, and a series of drops whose height
/// is known.
#[test]
fn what_comes_later_joins_its_series_and_is_not_taken_for_another_file() {
    let root = tempfile::tempdir().unwrap();
    folder(root.path());
    for file in ["contact.csv", "shaft.csv", "pulse.csv", "fall4.csv"] {
        fs::remove_file(root.path().join(file)).unwrap();
    }
    let here = |arguments: &[&str]| {
        let output =
            Command::new(env!("CARGO_BIN_EXE_vibro")).args(arguments).current_dir(root.path()).output();
        let output = output.unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(here(&["init", "."]).0, Some(0));
    let path = root.path().join("campaign.toml");
    let filled = |text: &str| {
        let rows = text.lines().map(|line| match line.trim_start_matches('#') {
            row if row.starts_with("height =") => "height = 0.57".to_owned(),
            row if row.starts_with("height_std =") => "height_std = 0.001".to_owned(),
            row if line.starts_with("#[[") || line.starts_with("#name") || line.starts_with("#file") => {
                row.to_owned()
            }
            _ => line.to_owned(),
        });
        rows.collect::<Vec<String>>().join("\n")
    };
    let text = filled(&fs::read_to_string(&path).unwrap());
    fs::write(&path, &text).unwrap();
    assert_eq!(not_named(&path), "");
    fs::copy(root.path().join("fall3.csv"), root.path().join("fall4.csv")).unwrap();
    fs::copy(root.path().join("release.csv"), root.path().join("lease.csv")).unwrap();
    // A table with a pattern includes the new file; tables of one file each do not.
    assert_eq!(not_named(&path), "lease.csv");
    let pattern = "[[drop]]\nname = \"fall\"\nfile = \"fall*.csv\"\nheight = 0.57\nheight_std = 0.001\n";
    let each = ["1", "2", "3"].map(|k| pattern.replace('*', k)).concat();
    assert!(text.contains(pattern), "{text}");
    let text = text.replace(pattern, &each);
    fs::write(&path, &text).unwrap();
    assert_eq!(not_named(&path), "fall4.csv, lease.csv");
    assert_eq!(here(&["init", "."]).0, Some(0));
    let longer = fs::read_to_string(&path).unwrap();
    let added = longer.strip_prefix(&text).unwrap();
    assert!(
        added.contains("name = \"fall\"\nfile = \"fall4.csv\"\nheight = 0.57\nheight_std = 0.001\n"),
        "{added}"
    );
    assert!(added.contains("file = \"lease.csv\"") && added.matches("[[").count() == 2, "{added}");
    // If no table can be appended to the file, it is not changed.
    fs::write(&path, "decay = [{ file = \"release.csv\" }]\n").unwrap();
    assert_eq!(here(&["init", "."]).0, Some(2));
    assert_eq!(fs::read_to_string(&path).unwrap(), "decay = [{ file = \"release.csv\" }]\n");
}
