//! User files are never lost: replacing results, searching folders, killed and failing runs.

use super::kept::{contents, records};
use super::{complaint, json, text, vibro};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use vibroimpact::math::Noise;

/// Commands that write into a folder, each with the example recording that it reads (empty: none).
const COMMANDS: [(&str, &[&str]); 22] = [
    ("bench/BENCH.CSV", &["spectrum", "--channel", "velocity", "--segment", "1024"]),
    ("bench/BENCH.CSV", &["spectrum", "--channel", "velocity", "--reference", "force", "--segment", "1024"]),
    ("bench/BENCH.CSV", &["modal", "--reference", "force", "--segment", "1024"]),
    ("bench/DECAY.CSV", &["decay"]),
    ("bench/PULSE.CSV", &["pulse", "--low-pass", "none"]),
    ("drop_test/BOUNCE.CSV", &["impacts"]),
    ("drop_test/DROP01.CSV", &["restitution", "--height", "0.57", "--interval-std", "1e-5"]),
    ("plan/rig.toml", &["plan"]),
    ("bench/BENCH.CSV", &["response"]),
    ("bench/BENCH.CSV", &["waterfall"]),
    ("", &["pulse", "--time-to-peak", "6.6e-6", "--duration", "18e-6"]),
    ("", &["restitution", "--intervals", "0.4,0.3,0.2"]),
    ("", &["model", "orbit", "--frequency", "11.2", "--force", "0.5"]),
    ("", &["model", "simulate", "--frequency", "11.2", "--force", "0.5", "--cycles", "40"]),
    ("", &["model", "response", "--from", "10", "--to", "12", "--points", "5", "--force", "0.5"]),
    (
        "",
        &[
            "model",
            "backbone",
            "--force",
            "5e-3",
            "--set",
            "springs.cubic1=2e7",
            "--from",
            "5",
            "--to",
            "6",
            "--points",
            "5",
        ],
    ),
    (
        "",
        &[
            "model",
            "continue",
            "--frequency",
            "11.2",
            "--force",
            "0.5",
            "--over",
            "frequency",
            "--from",
            "11",
            "--to",
            "11.4",
        ],
    ),
    ("", &["model", "sweep", "--from", "10", "--to", "11", "--steps", "3", "--force", "0.5"]),
    (
        "",
        &[
            "model",
            "choose",
            "--from",
            "10",
            "--to",
            "11",
            "--points",
            "3",
            "--force",
            "0.5",
            "--set",
            "contact.stiffness=1e6",
        ],
    ),
    ("", &["model", "map", "--x", "frequency:10:12:2", "--y", "gap:1e-3:2e-3:2", "--force", "0.5"]),
    ("hammer_drill/drill.toml", &["model", "drill", "--speeds", "10:40:2", "--turns", "4", "--from-rest"]),
    ("two_mass_rig/campaign.toml", &["compare"]),
];

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name)
}

fn line<'a>(command: &[&'a str], file: Option<&'a Path>, more: &[&'a str]) -> Vec<&'a str> {
    let (file, own) = (file.map(text), usize::from(command[0] == "model"));
    command[..=own]
        .iter()
        .copied()
        .chain(file)
        .chain(command[own + 1..].iter().copied())
        .chain(more.iter().copied())
        .collect()
}

/// Names of the files that a command wrote, without its hidden ones.
fn written(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.filter(|name| !name.starts_with(".vibro")).collect()
}

/// No result replaces a user's file or the input recording. A user's file is reported before the input is
/// read, which is empty here.
#[test]
fn no_command_replaces_what_a_person_has() {
    let mut tried = 0;
    for (recording, command) in COMMANDS {
        let root = tempfile::tempdir().unwrap();
        let (clean, out) = (root.path().join("clean"), root.path().join("out"));
        let file = Some(recording).filter(|name| !name.is_empty()).map(example);
        let output = vibro(&line(command, file.as_deref(), &["--out", text(&clean)]));
        if ["response", "waterfall"].contains(&command[0]) {
            // One recording is no sweep, so these two commands fail; the next test covers them.
            assert!(!output.status.success());
            continue;
        }
        assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
        fs::create_dir(&out).unwrap();
        let empty = root.path().join("empty.csv");
        fs::write(&empty, "").unwrap();
        for name in written(&clean) {
            let path = out.join(&name);
            fs::write(&path, "a person's").unwrap();
            let said =
                complaint(&line(command, file.is_some().then_some(&*empty), &["--out", text(&out)]), 2);
            assert!(said.contains(&name) && said.contains("does not replace"), "{command:?}: {said}");
            assert_eq!(fs::read(&path).unwrap(), b"a person's", "{command:?} {name}");
            fs::remove_file(&path).unwrap();
            assert_eq!(written(&out), [""; 0]);
            tried += 1;
            let Some(file) = &file else { continue };
            let bytes = fs::read(file).unwrap();
            fs::write(&path, &bytes).unwrap();
            for more in [&[][..], &["--replace"]] {
                complaint(&line(command, Some(&path), &[&["--out", text(&out)], more].concat()), 2);
                assert_eq!(fs::read(&path).unwrap(), bytes, "{command:?} {name}");
            }
            fs::remove_file(&path).unwrap();
            tried += 2;
        }
        // Results of an earlier run are replaced without `--replace`.
        json(&line(command, file.as_deref(), &["--out", text(&clean)]));
    }
    assert!(tried > 100, "{tried}");
}

/// The input of a sweep is a file pattern: the steps that `records` writes.
#[test]
fn a_sweep_and_a_conversion_replace_nothing() {
    let root = tempfile::tempdir().unwrap();
    records(root.path());
    let (out, steps) = (root.path().join("out"), root.path().join("step*.csv"));
    for command in ["response", "waterfall"] {
        let clean = root.path().join(command);
        json(&[command, text(&steps), "--out", text(&clean)]);
        fs::create_dir_all(&out).unwrap();
        for name in written(&clean) {
            fs::write(out.join(&name), "a person's").unwrap();
            assert!(complaint(&[command, text(&steps), "--out", text(&out)], 2).contains(&name));
            assert_eq!(fs::read(out.join(&name)).unwrap(), b"a person's");
            fs::remove_file(out.join(&name)).unwrap();
        }
    }
    let (from, to) = (example("bench/DECAY.CSV"), out.join("decay.uff"));
    fs::write(&to, "a person's").unwrap();
    let said = complaint(&["convert", text(&from), text(&to)], 2);
    assert!(said.contains("decay_2.uff") && said.contains("--replace"), "{said}");
    assert_eq!(fs::read(&to).unwrap(), b"a person's");
    json(&["convert", text(&from), text(&to), "--replace"]);
    json(&["convert", text(&from), text(&to), "--single"]);
}

/// A user's file under each result name of a campaign with most kinds of record: none is replaced.
#[test]
fn no_campaign_replaces_what_a_person_has() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("campaign.toml");
    fs::write(&path, records(root.path())).unwrap();
    let clean = root.path().join("clean");
    json(&["run", text(&path), "--out", text(&clean)]);
    let names: Vec<String> = contents(&clean).keys().map(|name| text(name).to_owned()).collect();
    assert!(names.len() > 40, "{names:?}");
    // With `out = "."` the results go into the folder of the recordings.
    let campaign = format!("out = \".\"\n{}", records(root.path()));
    fs::write(&path, campaign).unwrap();
    // A user's file with each name in turn: the run refuses it, and nothing is computed.
    for name in &names {
        let mine = root.path().join(name);
        assert!(!mine.exists(), "{name}");
        fs::write(&mine, "a person's").unwrap();
        let said = complaint(&["run", text(&path)], 2);
        assert!(said.contains(name.as_str()) && said.contains("does not replace"), "{said}");
        assert_eq!(fs::read(&mine).unwrap(), b"a person's", "{name}");
        fs::remove_file(&mine).unwrap();
    }
    // None of these runs wrote a result.
    assert!(!root.path().join("results.json").exists());
    let said = complaint(&["run", text(&path), "--out", text(&root.path().join("BENCH.CSV"))], 2);
    assert!(!said.contains("panicked"));
}

/// A recording that has the name of its own table's result is not replaced.
#[test]
fn a_recording_of_a_results_own_name_stays() {
    for (recording, section, name) in [
        ("bench/DECAY.CSV", "decay", "modes_1.csv"),
        ("bench/PULSE.CSV", "pulse", "pulse_1.csv"),
        ("drop_test/BOUNCE.CSV", "impacts", "impacts_1.csv"),
        ("drop_test/BOUNCE.CSV", "drop", "restitution_1.csv"),
        ("drop_test/BOUNCE.CSV", "spectrum", "spectrum_a.csv"),
    ] {
        let root = tempfile::tempdir().unwrap();
        let (path, bytes) = (root.path().join("campaign.toml"), fs::read(example(recording)).unwrap());
        fs::write(root.path().join(name), &bytes).unwrap();
        fs::write(&path, format!("out = \".\"\n[[{section}]]\nname = \"a\"\nfile = \"{name}\"\n")).unwrap();
        for more in [&[][..], &["--replace"]] {
            let said = complaint(&[&["run", text(&path)], more].concat(), 2);
            assert!(said.contains(name), "{said}");
            assert_eq!(fs::read(root.path().join(name)).unwrap(), bytes);
        }
    }
}

fn bench() -> (TempDir, PathBuf) {
    let root = tempfile::tempdir().unwrap();
    fs::copy(example("bench/DECAY.CSV"), root.path().join("DECAY.CSV")).unwrap();
    fs::copy(example("bench/PULSE.CSV"), root.path().join("PULSE.CSV")).unwrap();
    let path = root.path().join("campaign.toml");
    fs::write(&path, "[[decay]]\nfile = \"DECAY.CSV\"\n[[pulse]]\nfile = \"PULSE.CSV\"\n").unwrap();
    (root, path)
}

#[test]
fn results_of_tables_that_are_gone_go_too() {
    let (root, path) = bench();
    json(&["run", text(&path)]);
    let out = root.path().join("results");
    assert!(out.join("pulse_1.csv").exists());
    fs::write(out.join("notes.txt"), "a person's").unwrap();
    fs::write(&path, "[[decay]]\nfile = \"DECAY.CSV\"\n").unwrap();
    let answer = json(&["run", text(&path)]);
    let said: Vec<_> =
        answer["files"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    let mut found = written(&out);
    found.retain(|name| !said.contains(&name.as_str()));
    found.sort();
    assert_eq!(found, ["notes.txt"]);
}

#[test]
fn one_bad_file_loses_only_itself() {
    let (root, path) = bench();
    fs::write(root.path().join("PULSE.CSV"), b"\x00\x01\x02 no measurement").unwrap();
    let answer = json(&["run", text(&path)]);
    assert!(answer["results"]["decays"][0]["modes"][0]["frequency"]["value"].is_number());
    let said = answer["warnings"].to_string();
    assert!(said.contains("PULSE.CSV") && said.contains("Left out"), "{said}");
    // If no table can be analysed, the run fails.
    fs::write(&path, "[[pulse]]\nfile = \"PULSE.CSV\"\n").unwrap();
    assert!(complaint(&["run", text(&path)], 2).contains("PULSE.CSV"));
}

/// A result that the campaign now reads is an input: it is not replaced, even if its answer is kept from an
/// earlier run.
#[test]
fn a_result_that_is_read_stays() {
    let (root, path) = bench();
    fs::copy(example("bench/BENCH.CSV"), root.path().join("BENCH.CSV")).unwrap();
    fs::write(&path, "[[frf]]\nfile = \"BENCH.CSV\"\nreference = \"force\"\nsegment = 1024\n").unwrap();
    json(&["run", text(&path)]);
    let file = root.path().join("results/frf_1.uff");
    let before = fs::read(&file).unwrap();
    fs::write(&path, "[[frf]]\nfile = \"results/frf_1.uff\"\n").unwrap();
    for more in [&[][..], &[], &["--replace"], &["--again", "--replace"]] {
        vibro(&[&["run", text(&path)], more].concat());
        assert_eq!(fs::read(&file).unwrap(), before, "{more:?}");
    }
}

/// Runs `vibro run --watch` for the time `wait`, kills it, and returns how often it printed `watching`.
fn watched(folder: &Path, wait: Duration) -> usize {
    let said = tempfile::tempdir().unwrap();
    let out = said.path().join("said");
    let mut child = Command::new(env!("CARGO_BIN_EXE_vibro"))
        .args(["run", text(folder), "--watch"])
        .stdout(Stdio::null())
        .stderr(fs::File::create(&out).unwrap())
        .spawn()
        .unwrap();
    std::thread::sleep(wait);
    child.kill().unwrap();
    child.wait().unwrap();
    fs::read_to_string(&out).unwrap().matches("watching").count()
}

#[test]
fn results_in_the_folder_that_is_watched_are_no_change() {
    let (root, path) = bench();
    fs::write(&path, "out = \".\"\n[[decay]]\nfile = \"DECAY.CSV\"\n").unwrap();
    // The folder is polled every 0.5 s; 8 polls must not start a second run.
    assert_eq!(watched(root.path(), Duration::from_secs(4)), 1);
}

#[cfg(unix)]
mod on_unix {
    use super::*;
    use std::os::unix::fs::{PermissionsExt, symlink};

    #[test]
    fn a_folder_of_traps_is_looked_through_once() {
        let (root, _) = bench();
        fs::remove_file(root.path().join("campaign.toml")).unwrap();
        let other = tempfile::tempdir().unwrap();
        fs::write(other.path().join("o.csv"), "time [s],v [m/s]\n0,1\n1,2\n2,3\n").unwrap();
        for (to, link) in [(".", "a"), (".", "b"), ("DECAY.CSV", "again.csv"), ("/dev/zero", "zero.csv")] {
            symlink(to, root.path().join(link)).unwrap();
        }
        symlink(other.path().join("o.csv"), root.path().join("outside.csv")).unwrap();
        fs::copy(root.path().join("DECAY.CSV"), root.path().join("two\nlines\u{202e}.csv")).unwrap();
        let locked = root.path().join("System Volume Information");
        fs::create_dir(&locked).unwrap();
        fs::set_permissions(&locked, fs::Permissions::from_mode(0o000)).unwrap();
        let pipe = root.path().join("pipe.csv");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let began = Instant::now();
        let answer = json(&["init", text(root.path())]);
        assert!(began.elapsed() < Duration::from_secs(20));
        fs::set_permissions(&locked, fs::Permissions::from_mode(0o700)).unwrap();
        let toml = fs::read_to_string(root.path().join("campaign.toml")).unwrap();
        assert_eq!(toml.matches("file = \"DECAY.CSV\"").count(), 1, "{toml}");
        for (name, why) in [
            ("outside.csv", "a link that leads outside the folder"),
            ("zero.csv", "outside the folder"),
            ("pipe.csv", "a pipe, a socket or a device"),
            ("two\u{fffd}lines\u{fffd}.csv", "rename it"),
        ] {
            assert!(toml.lines().any(|line| line.contains(name) && line.contains(why)), "{name}: {toml}");
        }
        assert!(answer["written"].is_string());
        fs::remove_file(root.path().join("campaign.toml")).unwrap();
        json(&["init", text(root.path()), "--allow-outside"]);
        assert!(fs::read_to_string(root.path().join("campaign.toml")).unwrap().contains("outside.csv"));
    }

    #[test]
    fn what_comes_from_a_pipe_or_has_another_name_is_not_replaced() {
        let (root, _) = bench();
        let [file, link] = ["d.csv", "l.csv"].map(|name| root.path().join(name));
        json(&["convert", text(&root.path().join("DECAY.CSV")), text(&file)]);
        fs::hard_link(&file, &link).unwrap();
        let before = fs::read(&file).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_vibro"));
        command.args(["convert", "-", text(&file), "--integrate", "1", "--fmin", "5"]);
        let output = command.stdin(fs::File::open(&file).unwrap()).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        complaint(&["convert", text(&file), text(&link), "--single", "--replace"], 2);
        assert_eq!(fs::read(&file).unwrap(), before);
    }

    /// A pipe or a folder in place of a recording loses only its own table.
    #[test]
    fn records_that_cannot_be_read_lose_only_themselves() {
        let (root, path) = bench();
        fs::remove_file(root.path().join("PULSE.CSV")).unwrap();
        for make in ["mkfifo", "mkdir"] {
            assert!(Command::new(make).arg(root.path().join("PULSE.CSV")).status().unwrap().success());
            let answer = json(&["run", text(&path)]);
            assert_eq!(answer["results"]["decays"].as_array().unwrap().len(), 1);
            assert!(answer["warnings"].to_string().contains("PULSE.CSV"));
            Command::new("rm").arg("-rf").arg(root.path().join("PULSE.CSV")).status().unwrap();
        }
    }

    #[test]
    fn links_lead_nowhere_else() {
        let (root, path) = bench();
        let other = tempfile::tempdir().unwrap();
        fs::copy(root.path().join("DECAY.CSV"), other.path().join("d.csv")).unwrap();
        symlink(other.path(), root.path().join("elsewhere")).unwrap();
        for campaign in [
            "[[decay]]\nfile = \"elsewhere/d.csv\"\n",
            "[[decay]]\nfile = \"elsewhere/*.csv\"\n",
            "out = \"elsewhere\"\n[[decay]]\nfile = \"DECAY.CSV\"\n",
        ] {
            fs::write(&path, campaign).unwrap();
            let said = complaint(&["run", text(&path)], 2);
            assert!(said.contains("outside") && said.contains("allow-outside"), "{said}");
            json(&["run", text(&path), "--allow-outside"]);
        }
        // The campaign file is a pipe: it is refused.
        fs::remove_file(&path).unwrap();
        assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        assert!(complaint(&["run", text(root.path())], 2).contains("not a regular file"));
        // The campaign file is a link to a file outside the folder: `init` does not append to it.
        fs::remove_file(&path).unwrap();
        fs::write(other.path().join("c.toml"), "[[decay]]\nfile = \"DECAY.CSV\"\n").unwrap();
        symlink(other.path().join("c.toml"), &path).unwrap();
        assert!(complaint(&["init", text(root.path())], 2).contains("outside"));
        assert_eq!(
            fs::read_to_string(other.path().join("c.toml")).unwrap(),
            "[[decay]]\nfile = \"DECAY.CSV\"\n"
        );
    }

    /// A full disk, simulated by a file size limit of 0 (`ulimit -f 0`).
    #[test]
    fn a_campaign_is_written_whole_or_not_at_all() {
        let (root, path) = bench();
        fs::remove_file(&path).unwrap();
        let full = || {
            let limited = format!(
                "trap '' XFSZ; ulimit -f 0; exec {} init {}",
                env!("CARGO_BIN_EXE_vibro"),
                text(root.path())
            );
            let output = Command::new("sh").args(["-c", &limited]).output().unwrap();
            assert_eq!(output.status.code(), Some(2));
            assert!(!written(root.path()).iter().any(|name| name.ends_with(".vibro.part")));
        };
        full();
        assert!(!path.exists());
        fs::write(&path, "# mine\n[[decay]]\nfile = \"DECAY.CSV\"\n").unwrap();
        full();
        assert_eq!(fs::read_to_string(&path).unwrap(), "# mine\n[[decay]]\nfile = \"DECAY.CSV\"\n");
        json(&["init", text(root.path())]);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("# mine\n[[decay]]\nfile = \"DECAY.CSV\"\n") && text.contains("PULSE.CSV"));
    }

    /// Two campaigns write into one folder in turn and are killed: half of the kills while files are renamed
    /// into place (`INCOMPLETE.txt` exists), half at a random time.
    fn kills(times: u64) {
        let root = tempfile::tempdir().unwrap();
        let records = records(root.path());
        let paths = ["a", "b"].map(|name| root.path().join(format!("{name}.toml")));
        let sets = [0, 1].map(|i| {
            let out = root.path().join(format!("clean{i}"));
            let campaign = records.replace("name = \"all\"", &format!("name = \"all {i}\""));
            fs::write(
                &paths[i],
                if i == 0 { &campaign[..] } else { campaign.rsplit_once("[[frf]]").unwrap().0 },
            )
            .unwrap();
            let ran = vibro(&["run", text(&paths[i]), "--out", text(&out)]);
            assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
            contents(&out)
        });
        assert!(sets[0] != sets[1]);
        let out = root.path().join("out");
        let run = |i: usize| {
            Command::new(env!("CARGO_BIN_EXE_vibro"))
                .args(["run", text(&paths[i]), "--out", text(&out)])
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap()
        };
        assert!(run(0).wait().unwrap().success());
        let whole = Instant::now();
        assert!(run(1).wait().unwrap().success());
        let whole = whole.elapsed().as_micros() as u64;
        let (mut noise, mut during) = (Noise::new(1), 0);
        for kill in 0..times {
            let part = noise.uniform();
            let (mut child, began) = (run((kill % 2) as usize), Instant::now());
            let mark = out.join("INCOMPLETE.txt");
            if kill / 2 % 2 == 0 {
                while !mark.exists() && child.try_wait().unwrap().is_none() {}
                let more = Duration::from_micros((2000.0 * part) as u64);
                let at = Instant::now();
                while at.elapsed() < more {}
            } else {
                std::thread::sleep(
                    Duration::from_micros((whole as f64 * part) as u64).saturating_sub(began.elapsed()),
                );
            }
            let _ = child.kill();
            child.wait().unwrap();
            let found: Vec<_> = contents(&out)
                .into_iter()
                .filter(|(name, _)| {
                    let name = text(name);
                    !name.starts_with(".vibro") && !name.ends_with(".vibro.part")
                })
                .collect();
            during += u64::from(mark.exists());
            let is = |set: &std::collections::BTreeMap<PathBuf, Vec<u8>>| {
                let set = set.iter().filter(|(name, _)| !text(name).starts_with(".vibro"));
                found.iter().map(|(name, bytes)| (name, bytes)).eq(set)
            };
            assert!(mark.exists() || sets.iter().any(is), "kill {kill}: an unmarked mixture");
        }
        assert!(run(0).wait().unwrap().success());
        assert!(contents(&out) == sets[0]);
        assert!(!written(&out).iter().any(|name| name.ends_with(".vibro.part") || name == ".vibro.lock"));
        assert!(during > times / 8, "{during} of {times} while files got their names");
    }

    #[test]
    fn a_killed_run_leaves_no_unmarked_mixture() {
        kills(8);
    }

    #[test]
    #[ignore = "200 kills: cargo test --release -- --ignored"]
    fn two_hundred_kills_leave_no_unmarked_mixture() {
        kills(200);
    }
}

/// Inputs made to attack the program, kept in `../shared/found`.
#[test]
fn found_inputs_of_an_attack_do_no_harm() {
    let Some(found) = crate::others_files::folder("../found") else { return };
    let root = tempfile::tempdir().unwrap();
    let archive = found.join("redteam.tar.gz");
    assert!(
        Command::new("tar")
            .args(["xzf", text(&archive), "-C", text(root.path())])
            .status()
            .unwrap()
            .success()
    );
    let at = |name: &str| root.path().join(name);
    let file = at("out_overwrites_recording/spectrum.csv");
    let before = fs::read(&file).unwrap();
    complaint(&["spectrum", text(&file), "--channel", "2", "--out", text(file.parent().unwrap())], 2);
    assert_eq!(fs::read(&file).unwrap(), before);
    // The results in this folder have no manifest, so they count as user files: one watch round, nothing
    // replaced.
    assert_eq!(watched(&at("watch_out_dot"), Duration::from_secs(3)), 1);
    let mark = at("incomplete_symlink/results/INCOMPLETE.txt");
    let target = fs::read_link(&mark).unwrap();
    fs::write(mark.parent().unwrap().join(&target), "precious").unwrap();
    complaint(&["run", text(&at("incomplete_symlink"))], 2);
    assert_eq!(fs::read(mark.parent().unwrap().join(&target)).unwrap(), b"precious");
}
