//! Whatever number is typed, a command ends within seconds, with an answer or a reason.

use super::{complaint, text, vibro};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A decay at 40 Hz after a hammer blow, twice, at 1 kHz.
fn record(folder: &Path) -> String {
    let mut rows = "time [s],force [N],velocity [m/s]\n".to_owned();
    for i in 0..4000 {
        let t = f64::from(i % 2000) * 1e-3 - 0.1;
        let blow = if (0.0..0.003).contains(&t) { 10.0 } else { 0.0 };
        let rings = if t < 0.0 { 0.0 } else { (-4.0 * t).exp() * (251.3 * t).sin() };
        let _ = writeln!(rows, "{:.3},{blow},{rings:.9}", f64::from(i) * 1e-3);
    }
    let path = folder.join("record.csv");
    fs::write(&path, rows).unwrap();
    text(&path).to_owned()
}

#[test]
fn a_band_without_end_is_refused_by_the_command_and_by_a_campaign() {
    let folder = tempfile::tempdir().unwrap();
    let file = record(folder.path());
    let channel = ["--channel", "velocity"];
    for band in ["0:inf", "nan:5", "-5:20", "1e-300:20", "0:1e300"] {
        let band = format!("--band={band}");
        let typed = [&["decay", &file, &band][..], &channel].concat();
        let found = complaint(&typed, 2);
        assert!(found.contains("band is ") && found.contains("(--band)"), "{found}");
    }
    let campaign = folder.path().join("campaign.toml");
    let table = "[[decay]]\nfile = \"record.csv\"\nchannel = \"velocity\"\nband = [0, inf]\n";
    fs::write(&campaign, table).unwrap();
    let found = complaint(&["run", text(&campaign)], 2);
    assert!(found.contains("campaign.toml, line 4") && found.contains("band is inf"), "{found}");
    fs::write(&campaign, table.replace("inf", "1e3")).unwrap();
    assert_eq!(vibro(&["check", text(&campaign)]).status.code(), Some(0));
}

/// Options of a command that take numbers, with the placeholders of their values.
fn numbers(command: &[&str]) -> Vec<(String, String)> {
    let help = vibro(&[command, &["--help"]].concat());
    let help = String::from_utf8(help.stdout).unwrap();
    let options = help.lines().filter_map(|line| {
        let mut words = line.split_whitespace().skip_while(|word| !word.starts_with("--"));
        let (option, value) = (words.next()?, words.next()?.strip_prefix('<')?.strip_suffix('>')?);
        let numeric =
            ["NUMBER", "N", "HZ", "S", "LO:HI", "M1,M2", "V1,V2", "A,B,C", "X1,V1,X2,V2", "KEY=VALUE"];
        numeric.contains(&value).then(|| (option.to_owned(), value.to_owned()))
    });
    options.collect()
}

/// The ways to type `number` for a value of this kind.
fn typed(kind: &str, number: &str) -> Vec<String> {
    match kind {
        "LO:HI" => vec![format!("0:{number}"), format!("{number}:20")],
        "KEY=VALUE" => ["gap", "k2", "m1", "c1", "restitution", "contact.stiffness"]
            .map(|key| format!("{key}={number}"))
            .to_vec(),
        kind => vec![vec![number; kind.split(',').count()].join(",")],
    }
}

#[test]
#[ignore = "every number of every command: cargo test --release -- --ignored"]
fn every_number_of_every_command_ends_soon_with_an_answer_or_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (record(folder.path()), folder.path().join("out.csv"));
    let (file, out) = (file.as_str(), text(&out));
    let of = |command: &'static str| vec![command, file, "--channel", "velocity"];
    let drill = "--velocity velocity --beam-angle 0 --beam-from axis --sensitivity 1";
    let model = |typed: &'static str| [vec!["model"], typed.split(' ').collect()].concat();
    let commands = [
        (1, vec!["info", file]),
        (1, [of("convert"), vec![out, "--fmin", "1"]].concat()),
        (1, of("spectrum")),
        (1, [of("modal"), vec!["--reference", "force", "--hammer"]].concat()),
        (1, of("decay")),
        (1, of("impacts")),
        (1, of("pulse")),
        (1, [of("restitution"), vec!["--height", "0.5"]].concat()),
        (1, [vec!["drill", file], drill.split(' ').collect()].concat()),
        (1, vec!["response", file]),
        (1, vec!["waterfall", file]),
        (1, vec!["excitation", file]),
        (2, model("orbit --force 0.5 --frequency 11")),
        (2, model("simulate --force 0.5 --frequency 11")),
        (2, model("response --force 0.5 --from 5 --to 15 --points 50")),
        (2, model("backbone --force 5e-3 --set springs.cubic1=2e7 --from 4 --to 7 --points 20")),
        (2, model("continue --force 0.5 --from 9 --to 12")),
        (2, model("sweep --force 0.5 --from 5 --to 15 --steps 21")),
        (2, model("choose --force 0.5 --frequency 11")),
        (2, model("map --force 0.5 --x frequency:5:15:8 --y restitution:0.1:1:4")),
        (2, model("drill --turns 4 --settle 4 --speeds 10:40:3 --over striker.friction=0:10:3")),
    ];
    let values = ["nan", "inf", "-inf", "-1", "0", "1e-300", "1e300", "4294967295", "1e12"];
    let (mut runs, mut wrong) = (0, Vec::new());
    for (words, base) in commands {
        let options = numbers(&base[..words]);
        assert!(!options.is_empty(), "{base:?}");
        for (option, kind) in options {
            for value in values.iter().flat_map(|value| typed(&kind, value)) {
                // The option and its value are first removed from the base command.
                let said = base.iter().position(|word| *word == option);
                let kept =
                    base.iter().enumerate().filter(|(i, _)| said.is_none_or(|at| *i != at && *i != at + 1));
                let kept: Vec<&str> = kept.map(|(_, word)| *word).collect();
                let mut command = Command::new(env!("CARGO_BIN_EXE_vibro"));
                command.args(kept).arg(format!("{option}={value}"));
                let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
                let begun = Instant::now();
                let code = loop {
                    match child.try_wait().unwrap() {
                        Some(status) => break status.code(),
                        None if begun.elapsed() > Duration::from_secs(10) => {
                            child.kill().unwrap();
                            child.wait().unwrap();
                            break None;
                        }
                        None => std::thread::sleep(Duration::from_millis(2)),
                    }
                };
                runs += 1;
                if !matches!(code, Some(0..=2)) {
                    wrong.push(format!("{base:?} {option}={value}: {code:?} after {:?}", begun.elapsed()));
                }
            }
        }
    }
    assert!(runs > 500, "{runs}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
