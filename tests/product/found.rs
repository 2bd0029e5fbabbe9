//! Recordings that were once analysed wrongly or not at all, with their true values. They are kept outside
//! the project, in `../shared/found`.

use crate::others_files::folder;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Unpacks a recording into a temporary folder; `None` where `../shared/found` is absent.
fn unpacked(name: &str) -> Option<(TempDir, PathBuf)> {
    let (from, root) = (folder("../found")?, tempfile::tempdir().unwrap());
    let (archive, packed) = (from.join(format!("{name}.tar.gz")), from.join(format!("{name}.gz")));
    let path = root.path().join(name);
    if archive.is_file() {
        let status = Command::new("tar").arg("xzf").arg(&archive).arg("-C").arg(root.path()).status();
        assert!(status.unwrap().success());
    } else {
        let bytes = Command::new("gunzip").arg("-c").arg(packed).output().unwrap().stdout;
        std::fs::write(&path, bytes).unwrap();
    }
    Some((root, path))
}

/// Exit code, JSON object and duration of `vibro … --json`.
fn vibro(arguments: &[&str]) -> (i32, Value, Duration) {
    let began = Instant::now();
    let output = Command::new(env!("CARGO_BIN_EXE_vibro")).args(arguments).arg("--json").output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(!stderr.contains("panicked"), "{stderr}");
    (
        output.status.code().unwrap(),
        serde_json::from_slice(&output.stdout).unwrap_or(Value::Null),
        began.elapsed(),
    )
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Distance of an estimate from the truth in standard uncertainties.
fn off(estimate: &Value, truth: f64) -> f64 {
    (estimate["value"].as_f64().unwrap() - truth).abs() / estimate["std"].as_f64().unwrap()
}

fn finding<'a>(answer: &'a Value, code: &str) -> Option<&'a Value> {
    answer["findings"].as_array().unwrap().iter().find(|found| found["code"] == code)
}

/// Frequency in Hz and damping ratio of each mode that `vibro decay` finds in a recording must lie within
/// four standard uncertainties of the truth, and there must be no other mode. `None` where only the
/// frequency is known, to 0.5 Hz.
fn check_decay(name: &str, truth: &[(f64, Option<f64>)]) {
    let Some((_root, path)) = unpacked(name) else { return };
    let (code, answer, _) = vibro(&["decay", text(&path)]);
    assert_eq!(code, 0);
    let modes = answer["modes"].as_array().unwrap();
    assert_eq!(modes.len(), truth.len(), "{modes:?}");
    for (mode, (frequency, zeta)) in modes.iter().zip(truth) {
        match zeta {
            Some(zeta) => {
                assert!(
                    off(&mode["frequency"], *frequency) < 4.0 && off(&mode["zeta"], *zeta) < 4.0,
                    "{mode}"
                );
            }
            None => assert!((mode["frequency"]["value"].as_f64().unwrap() - frequency).abs() < 0.5, "{mode}"),
        }
    }
}

#[test]
fn no_third_mode_stands_beside_one_of_two() {
    check_decay("decay_third_mode.csv", &[(3.21721, Some(0.063_01)), (5.02141, Some(0.017_693))]);
}

/// Hum at 50.020 Hz was listed as a third mode.
#[test]
fn steady_hum_is_no_mode() {
    check_decay("decay_hum_mode.csv", &[(54.2, None), (174.0, None)]);
}

#[test]
fn a_dead_step_loses_only_itself() {
    let Some((_root, path)) = unpacked("sweep_dead_step") else { return };
    let (code, answer, _) = vibro(&["run", text(&path)]);
    assert_eq!(code, 0);
    let results = &answer["results"];
    assert_eq!(results["responses"][0]["points"].as_array().unwrap().len(), 35);
    let left = finding(&results["responses"][0], "step-left-out").expect("the dead step is named");
    assert!(left["subject"].as_str().unwrap().contains("step004.csv"), "{left}");
    assert!(!results["decays"][0]["modes"].as_array().unwrap().is_empty());
    assert!(!results["frf"][0]["modes"].as_array().unwrap().is_empty());
}

#[test]
fn blows_of_a_few_samples_have_a_mode() {
    for (name, blows) in [("hammer_no_values.csv", 5), ("hammer_false_double.csv", 5)] {
        let Some((_root, path)) = unpacked(name) else { return };
        let (code, answer, _) =
            vibro(&["modal", text(&path), "--reference", "Force", "--channel", "Disp", "--hammer"]);
        assert_eq!(code, 0, "{name}");
        let mode = &answer["modes"][0];
        // One record of 10⁴ lies beyond four standard uncertainties.
        assert!(off(&mode["frequency"], 60.0) < 4.0, "{name}: {mode}");
        let said = answer["warnings"].to_string();
        assert!(!said.contains("double hit") && blows == 5, "{said}");
    }
}

/// Echoes of a room, 5 % after 4.1 ms and 3 % after 9.7 ms, are not taken for bounces: with four drops,
/// with three and with one.
#[test]
fn drops_with_echoes_have_their_restitution() {
    let Some((_root, path)) = unpacked("drops_echo") else { return };
    let files: Vec<PathBuf> = (0..4).map(|k| path.join(format!("d{k}.wav"))).collect();
    for drops in [4, 3, 1] {
        let mut arguments = vec!["restitution", "--height", "0.5", "--height-std", "0.001"];
        arguments.extend(files[..drops].iter().map(|file| text(file)));
        let (code, answer, _) = vibro(&arguments);
        assert_eq!((code, &answer["agree"]), (0, &true.into()), "{answer}");
        for way in answer["by"].as_array().unwrap() {
            let u = way["restitution"]["std"].as_f64().unwrap();
            assert!(off(&way["restitution"], 0.78) < 4.0 && u < 0.002, "{way}");
        }
    }
    let (code, _, _) = vibro(&["init", text(&path)]);
    let proposed = std::fs::read_to_string(path.join("campaign.toml")).unwrap();
    assert!(code == 0 && proposed.contains("[[drop]]") && proposed.matches("[[").count() == 1, "{proposed}");
}

#[test]
fn bursts_that_ring_for_a_quarter_of_their_period_are_all_found() {
    let Some((_root, path)) = unpacked("bursts_ring_quarter.csv") else { return };
    let (code, answer, _) = vibro(&["impacts", text(&path), "--band", "2100:3900", "--envelope"]);
    assert_eq!((code, &answer["n"]), (0, &80.into()));
    assert!(off(&answer["interval"], 12.3e-3) < 4.0, "{}", answer["interval"]);
}

#[test]
fn a_sine_of_few_counts_that_is_clipped_is_named() {
    let Some((_root, path)) = unpacked("sweep_clip_21") else { return };
    let steps = path.join("step*.csv");
    let (code, answer, _) = vibro(&["response", text(&steps)]);
    assert_eq!(code, 0);
    let clipped = finding(&answer, "step-clipped").expect("the clipped step is named");
    let frequency = clipped["numbers"]["frequencies"].as_array().map_or(&clipped["numbers"], |all| &all[0]);
    assert!(frequency.to_string().contains("27.6"), "{clipped}");
    // A sine clipped at 97 % of its amplitude reads low by less than 3 %.
    let amplitude = |p: &Value| p["amplitude"]["value"].as_f64().unwrap();
    let of_step = answer["points"].as_array().unwrap().iter().find(|p| p["amplitude"]["std"].is_null());
    let amplitude = amplitude(of_step.unwrap());
    assert!((amplitude / 1.604_35e-5 - 1.0).abs() < 0.03, "{amplitude}");
    let std: Vec<bool> =
        answer["points"].as_array().unwrap().iter().map(|p| p["amplitude"]["std"].is_null()).collect();
    assert_eq!(std.iter().filter(|none| **none).count(), 1, "{std:?}");
}

/// Two unlike blows per turn in the same direction, at phases of 0.25 and 0.75 turns; velocities in m/s.
#[test]
fn two_unlike_blows_of_a_turn_are_two_groups() {
    let Some((_root, path)) = unpacked("drill_two_blows.wav") else { return };
    let options = "--velocity 1 --reference 2 --sensitivity 10.9558963 --beam-angle 0 --beam-from axis \
                   --pulses-per-turn 1 --edge rising";
    let mut arguments = vec!["drill", text(&path)];
    arguments.extend(options.split_whitespace());
    let (code, answer, _) = vibro(&arguments);
    let groups = answer["groups"].as_array().unwrap();
    assert_eq!((code, groups.len()), (0, 2), "{groups:?}");
    assert!(off(&groups[0]["before"], 9.590) < 4.0 && off(&groups[0]["after"], -7.480) < 4.0, "{groups:?}");
    assert!((groups[1]["before"]["value"].as_f64().unwrap() - 5.4).abs() < 0.1, "{groups:?}");
}

/// The force grows or decays by up to 2 % within each step, at a rate ε in 1/s. The response is then H(iω +
/// ε), which would bias ζ by ε/ω.
#[test]
fn a_force_that_drifts_within_its_steps_moves_no_mode() {
    let Some((_root, path)) = unpacked("sweep_drift_46") else { return };
    let campaign = format!("{}#up", text(&path.join("campaign.toml")));
    let (code, answer, _) = vibro(&["modal", &campaign]);
    let zeta = &answer["modes"][0]["zeta"];
    assert!(code == 0 && off(zeta, 0.008_007_76) < 4.0, "{zeta}");
    assert!(zeta["std"].as_f64().unwrap() < 1e-6, "{zeta}");
}

/// 40, 600 and 1100 Hz on the axes of a handle, sampled at 5120 Hz. The true `a_hv` in m/s² follows from
/// the formula of ISO 5349-1.
#[test]
fn a_handle_sampled_slowly_is_weighted_without_warping() {
    let Some((_root, path)) = unpacked("handle_5120.wav") else { return };
    let options = "--velocity 1 --sensitivity 7 --beam-angle 0 --beam-from axis --handle-sensitivity 100 \
                   --handle 2 --handle 3 --handle 4 --exposure 2";
    let mut arguments = vec!["drill", text(&path)];
    arguments.extend(options.split_whitespace());
    let (code, answer, _) = vibro(&arguments);
    let a_hv = &answer["exposure"]["a_hv"];
    assert!(code == 0 && off(a_hv, 4.3272) < 4.0, "{a_hv}");
    assert!(a_hv["std"].as_f64().unwrap() < 0.005, "{a_hv}");
}

/// Inputs made to attack the program, on which it once hung, panicked or took too long.
#[test]
fn inputs_of_an_attack_are_answered_or_refused_soon() {
    let Some((root, _)) = unpacked("redteam") else { return };
    let at = |name: &str| root.path().join(name);
    // A debug build is slower, and other tests run at the same time.
    let soon = Duration::from_secs(if cfg!(debug_assertions) { 60 } else { 10 });
    let (code, _, took) = vibro(&["run", text(&at("decay_band"))]);
    assert!(code == 2 && took < soon, "{code} {took:?}");
    for name in ["1838_key.csv", "2548_wr.txt"] {
        let folder = at(&format!("{name}.d"));
        std::fs::create_dir(&folder).unwrap();
        std::fs::copy(at(name), folder.join(name)).unwrap();
        let (_, _, took) = vibro(&["run", text(&folder)]);
        assert!(took < soon, "{name}: {took:?}");
    }
    let (code, _, took) = vibro(&["init", text(&at("init_series_hang"))]);
    assert!(code == 0 && took < soon, "{code} {took:?}");
}
