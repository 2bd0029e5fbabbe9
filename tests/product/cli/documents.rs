//! The commands shown in the documents run, in their order, in a folder that has the repository's examples.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Section and command of each line in `sh` blocks that begins with `vibro` or a shell tool. A line that
/// ends in a backslash continues on the next.
fn commands(text: &str) -> Vec<(String, String)> {
    let (mut section, mut shell, mut found) = (String::new(), false, Vec::new());
    let joined = text.replace("\\\n", " ");
    for line in joined.lines() {
        if let Some(name) = line.strip_prefix("## ") {
            name.clone_into(&mut section);
        } else if line.starts_with("```") {
            shell = line == "```sh";
        } else if shell && ["vibro ", "mkdir ", "cp ", "sed "].iter().any(|tool| line.starts_with(tool)) {
            found.push((section.clone(), line.to_owned()));
        }
    }
    found
}

/// Sections whose commands are tested elsewhere. The record of `vibro drill` takes twenty seconds to make
/// (`tests/product/drill.rs`). `vibro precision` measures every method, which takes a minute in a debug
/// build (`tests/product/failure_map.rs`, `tests/product/cli/precision.rs`).
#[cfg(unix)]
const ELSEWHERE: [&str; 3] = ["vibro drill", "vibro precision", "vibro app"];

/// Runs a shell command in a folder, with `vibro` on its path.
#[cfg(unix)]
fn shell(line: &str, folder: &Path) -> std::process::Output {
    let program = Path::new(env!("CARGO_BIN_EXE_vibro")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let mut command = Command::new("sh");
    command.args(["-c", line]).current_dir(folder).env("PATH", path).output().expect("a shell")
}

/// Runs the commands of a document in their order, in a folder that has the repository's examples. Returns
/// the number of commands of each section.
#[cfg(unix)]
fn run(document: &str) -> BTreeMap<String, usize> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink(root.join("examples"), folder.path().join("examples")).unwrap();
    let text = std::fs::read_to_string(root.join(document)).unwrap();
    let mut ran: BTreeMap<String, usize> = BTreeMap::new();
    for (section, line) in commands(&text) {
        if ELSEWHERE.contains(&section.as_str()) {
            continue;
        }
        let output = shell(&line, folder.path());
        assert!(output.status.success(), "{line}\n{}", String::from_utf8_lossy(&output.stderr));
        if document == TUTORIAL {
            shown(&text, &line, &output);
        }
        *ran.entry(section).or_default() += 1;
    }
    ran
}

const TUTORIAL: &str = "docs/tutorial.md";

/// Checks that the run prints every line of output that the tutorial shows.
fn shown(text: &str, line: &str, output: &std::process::Output) {
    let printed = String::from_utf8_lossy(&output.stderr);
    let blocks = text.split("```text\n").skip(1).filter_map(|block| block.split("```").next());
    if line == "vibro run lab" {
        for block in blocks {
            for expected in block.lines() {
                assert!(printed.contains(expected), "{expected}\n{printed}");
            }
        }
    }
}

#[cfg(unix)]
#[test]
fn every_section_has_an_example_that_runs() {
    let ran = run("docs/commands.md");
    let text =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/commands.md")).unwrap();
    let sections = text.lines().filter_map(|l| l.strip_prefix("## ")).filter(|s| !ELSEWHERE.contains(s));
    for section in sections {
        assert!(ran.contains_key(section), "{section} has no example");
    }
}

#[cfg(unix)]
#[test]
fn the_tutorial_and_the_recipes_run() {
    assert_eq!(run(TUTORIAL).values().sum::<usize>(), 10);
    assert_eq!(run("docs/recipes.md").len(), 11);
}

/// The commands in the tables of the thesis have valid options and values, and their files exist. A final
/// `--help` keeps them from running, which would take half a minute.
#[cfg(unix)]
#[test]
fn the_commands_of_the_thesis_are_taken() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("docs/thesis.md")).unwrap();
    let spans = text.split('`').skip(1).step_by(2);
    let lines: Vec<&str> = spans.filter(|span| span.starts_with("vibro ") && span.contains(" --")).collect();
    assert!(lines.len() > 40, "{lines:?}");
    for line in lines {
        let output = shell(&format!("{line} --help"), root);
        assert!(output.status.success(), "{line}\n{}", String::from_utf8_lossy(&output.stderr));
        let files = line.split([' ', '#']).filter(|word| word.starts_with("examples/"));
        // `vibro demo hammer_drill` generates its recordings.
        for file in files.filter(|file| !file.starts_with("examples/hammer_drill")) {
            assert!(root.join(file).is_file(), "{line}: {file}");
        }
    }
}

/// The help of every command, as a page: `VIBRO_DOCS=1 cargo test --release --test product
/// options_of_every_command` writes it anew.
#[test]
fn the_options_of_every_command_are_those_of_its_help() {
    let help =
        |words: &[&str]| String::from_utf8(super::vibro(&[words, &["--help"]].concat()).stdout).unwrap();
    let named = |text: &str| -> Vec<String> {
        let lines = text.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
        let words = lines.filter_map(|line| line.split_whitespace().next());
        words.filter(|word| word.chars().all(char::is_lowercase)).map(str::to_owned).collect()
    };
    let mut page = "# Options of every command\nAs `vibro COMMAND --help` prints them. In a campaign, the options of an analysis are the keys of its section, with `_` for `-`.\n".to_owned();
    let mut add = |words: &[&str]| {
        let text = help(words).lines().map(str::trim_end).collect::<Vec<_>>().join("\n");
        page.extend(["\n## vibro ", &words.join(" "), "\n```text\n", text.trim_end(), "\n```\n"]);
        text
    };
    for command in named(&help(&[])) {
        let text = add(&[&command]);
        if command == "model" {
            for of_model in named(&text).iter().filter(|name| !["help", "vibro"].contains(&name.as_str())) {
                add(&["model", of_model]);
            }
        }
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/options.md");
    if std::env::var_os("VIBRO_DOCS").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    assert!(page.matches("\n## ").count() > 25, "{page}");
    assert!(
        std::fs::read_to_string(path).unwrap() == page,
        "a help text changed: VIBRO_DOCS=1 cargo test --release --test product options_of_every_command writes docs/options.md anew"
    );
}

#[test]
fn documents_for_reading_are_short_and_in_the_book() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = |name: &str| std::fs::read_to_string(root.join(name)).unwrap();
    assert!(text("README.md").lines().count() < 120);
    let summary = text("docs/SUMMARY.md");
    // Pages for reference and pages of measured results may be longer.
    let reference = [
        "campaign.md",
        "commands.md",
        "options.md",
        "findings.md",
        "formats.md",
        "coverage.md",
        "precision.md",
        "thesis.md",
        "errata.md",
    ];
    for entry in std::fs::read_dir(root.join("docs")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.extension().is_none_or(|ending| ending != "md") || name == "SUMMARY.md" {
            continue;
        }
        assert!(summary.contains(&format!("({name})")), "{name} is not in docs/SUMMARY.md");
        let words = text(&format!("docs/{name}")).split_whitespace().count();
        assert!(reference.contains(&name.as_str()) || words <= 1500, "{name}: {words} words, at most 1500");
    }
}

#[test]
fn the_example_bench_gives_back_the_truth() {
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bench/campaign.toml");
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let answer = super::json(&["run", super::text(&campaign), "--out", super::text(&out)]);
    let results = &answer["results"];
    let value = |estimate: &serde_json::Value| {
        (estimate["value"].as_f64().unwrap(), estimate["std"].as_f64().unwrap_or(f64::NAN))
    };
    // True values of TRUTH.csv.
    let mode = &results["frf"][0]["modes"][0];
    let (f, f_std) = value(&mode["frequency"]);
    assert!((f - 60.0).abs() < 4.0 * f_std && f_std < 0.5, "{mode}");
    // The peak is 2.4 Hz wide, and lines are 1 Hz apart. Leakage, which would widen the peak by up to 23 %,
    // is part of the fit and is reported.
    let (zeta, zeta_std) = value(&mode["zeta"]);
    assert!((zeta - 0.02).abs() < 4.0 * zeta_std && zeta_std < 0.25 * 0.02, "{mode}");
    assert!(answer["results"].to_string().contains("modal-leakage-fitted"), "{}", answer["results"]["frf"]);
    let spring = |f: f64| 0.125 * (std::f64::consts::TAU * f).powi(2);
    let (k, k_std) = value(&mode["stiffness"]);
    assert!((k - spring(60.0)).abs() < 4.0 * k_std && k_std < 0.02 * k, "{mode}");
    // The modal constant of a single mass is A = 1/m.
    let (constant, constant_std) = value(&mode["modal_constant"]);
    assert!((0.125 * constant - 1.0).abs() < 4.0 * 0.125 * constant_std, "{mode}");
    // The contact recorded with both amplifiers; uniform noise of ±3 m/s² has a standard deviation of √3
    // m/s².
    for pulse in &results["pulses"].as_array().unwrap()[..2] {
        for (key, truth) in [("xi", 0.2), ("frequency", 500.0), ("stiffness", spring(500.0))] {
            let (found, std) = value(&pulse[key]);
            assert!((found - truth).abs() < 4.0 * std && std < 0.02 * truth, "{key}: {}", pulse[key]);
        }
    }
    assert_eq!(results["spectra"][0]["level_unit"], "dB re 1 nm/s");
    assert_eq!(results["drops"][0]["name"], "striker on piston");
    assert_eq!(results["pulses"][2]["name"], "screen");
    let mode = &results["decays"][0]["modes"][0];
    for (key, truth) in [("frequency", 60.0), ("zeta", 0.02)] {
        let (value, std) = (mode[key]["value"].as_f64().unwrap(), mode[key]["std"].as_f64().unwrap());
        assert!((value - truth).abs() < 4.0 * std && std < 0.01 * truth, "{key}: {value} ± {std}");
    }
}

#[test]
fn every_command_and_every_key_of_a_campaign_is_described() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = |name: &str| std::fs::read_to_string(root.join(name)).unwrap();
    let (readme, campaign, guide) = (text("README.md"), text("docs/campaign.md"), text("docs/commands.md"));
    let help = String::from_utf8(super::vibro(&["--help"]).stdout).unwrap();
    let listed = help.lines().take_while(|l| *l != "Options:").filter(|l| l.starts_with("  "));
    let commands: Vec<&str> = listed.filter_map(|l| l.split_whitespace().next()).collect();
    assert!(commands.len() > 10, "{help}");
    for command in commands {
        let typed = format!("vibro {command}");
        assert!(readme.contains(&typed), "the README says nothing of `{typed}`");
        assert!(guide.contains(&typed), "docs/commands.md says nothing of `{typed}`");
    }
    let of_rig = vibroimpact::model::Parameter::of_rig().map(|p| p.name().to_owned());
    for key in super::campaign::sections().into_iter().chain(of_rig) {
        let described = [format!("[{key}]"), format!("`{key}`")].iter().any(|k| campaign.contains(k));
        assert!(described, "docs/campaign.md says nothing of {key}");
    }
}

/// A command that was built with the page writes it and replaces nobody's file; any other says how to get it.
#[test]
fn the_page_is_written_where_the_command_has_it() {
    let folder = tempfile::tempdir().unwrap();
    let written = || super::vibro(&["app", "--out", folder.path().to_str().unwrap()]);
    let page = folder.path().join("vibro.html");
    std::fs::write(&page, "mine").unwrap();
    let first = written();
    assert!(!first.status.success());
    assert_eq!(std::fs::read_to_string(&page).unwrap(), "mine");
    if String::from_utf8_lossy(&first.stderr).contains("built without the page") {
        return;
    }
    std::fs::remove_file(&page).unwrap();
    assert!(written().status.success());
    assert!(std::fs::read_to_string(&page).unwrap().starts_with("<!DOCTYPE html>"));
}
