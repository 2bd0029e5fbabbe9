//! Work in parts: what `vibro merge` gives is what one run gives, byte for byte.

use super::rig;
use serde_json::Value;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use vibroimpact::math::Noise;

const MAP: &str = "model map --force 0.5 --x frequency:4:14:13 --y restitution:0.3:0.95:11";
const DRAWS: &str = "model response --force 0.5 --from 5 --to 14 --points 20 --monte-carlo 100 \
                     --set uncertainty.gap=5e-5 --set uncertainty.restitution=0.02";

/// A command line of words, run in a folder.
fn command(folder: &Path, words: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibro"));
    command.current_dir(folder).args(words.split_whitespace());
    command
}

/// The standard output of a command line.
fn vibro(folder: &Path, words: &str) -> String {
    let out: Output = command(folder, words).output().unwrap();
    assert!(out.status.success(), "{words}: {}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).unwrap()
}

/// The error of a command line.
fn error(folder: &Path, words: &str) -> String {
    let out = command(folder, words).output().unwrap();
    assert!(matches!(out.status.code(), Some(1 | 2)), "{words}: {:?}", out.status);
    String::from_utf8(out.stderr).unwrap()
}

/// Files of a folder with their bytes.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    entries.map(|e| (e.file_name().into_string().unwrap(), fs::read(e.path()).unwrap())).collect()
}

#[test]
fn parts_give_the_bytes_of_one_run() {
    for (words, of) in [(MAP, 5), (DRAWS, 3)] {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        let whole = vibro(at, &format!("{words} --out whole --json"));
        for number in 1..=of {
            let said = vibro(at, &format!("{words} --shard {number}/{of} --out parts --json"));
            let said: Value = serde_json::from_str(&said).unwrap();
            assert_eq!(said["shard"], format!("{number}/{of}"));
            assert_eq!(said["fingerprint"].as_str().map(str::len), Some(64));
        }
        assert!(error(at, "merge parts --missing").contains("no part of"));
        assert_eq!(vibro(at, "merge parts --out merged --json"), whole);
        assert_eq!(files(&at.join("merged")), files(&at.join("whole")));
    }
}

/// A campaign of a sweep that the linear rig passes without impacts, with uncertainties.
fn campaign(folder: &Path) {
    rig::sweep(folder, &rig::frequencies());
    let text = "[rig]\nm1 = 0.125\nm2 = 0.094\nk1 = 154.8\nk2 = 128.0\nc1 = 0.44\nc2 = 0.1\ngap = 1.0\nrestitution = 0.7\n\
                [uncertainty]\nk1 = 1.5\nc1 = 0.01\nforce = 0.002\n\
                [excitation]\nforce = 0.1\n[model]\nsettle = 20\nmeasure = 8\n\
                [[sweep]]\nname = \"up\"\nlist = \"LIST.TXT\"\nmass = 1\ndirection = \"up\"\nscaling = \"peak\"\nunit = \"m/s\"\n";
    fs::write(folder.join("campaign.toml"), text).unwrap();
}

/// Without impacts the amplitude is F/|k − mω² + icω|: the quantiles of drawn rigs are those of the drawn k,
/// c and F.
#[test]
fn bands_of_a_linear_rig_are_those_of_its_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    campaign(at);
    let words = "compare campaign.toml --monte-carlo 400";
    let whole = vibro(at, &format!("{words} --out whole --json"));
    for number in [2, 1] {
        vibro(at, &format!("{words} --shard {number}/2 --out parts"));
    }
    assert_eq!(vibro(at, "merge parts --out merged --json"), whole);
    assert_eq!(files(&at.join("merged")), files(&at.join("whole")));

    let whole: Value = serde_json::from_str(&whole).unwrap();
    assert_eq!(whole["bands"].as_array().map(Vec::len), Some(rig::frequencies().len()));
    let mut noise = Noise::new(1);
    for band in whole["bands"].as_array().unwrap() {
        let omega = TAU * band["frequency"].as_f64().unwrap();
        let amplitude = |k: f64, c: f64, force: f64| force / (k - 0.125 * omega * omega).hypot(c * omega);
        let drawn: Vec<f64> = (0..20_000)
            .map(|_| {
                let [k, c, force] = [noise.normal(), noise.normal(), noise.normal()];
                amplitude(154.8 + 1.5 * k, 0.44 + 0.01 * c, 0.1 + 0.002 * force)
            })
            .collect();
        assert_eq!(band["share"], 1.0);
        // Of 400 draws the part below a quantile q scatters by √(q(1 − q)/400): 0.8 % at both ends and 2.5 %
        // in the middle. The limits are five of these.
        for (i, (q, wide)) in [(0.025, 0.039), (0.5, 0.125), (0.975, 0.039)].into_iter().enumerate() {
            let found = band["predicted"][i].as_f64().unwrap();
            let below = drawn.iter().filter(|a| **a < found).count() as f64 / 20_000.0;
            assert!((below - q).abs() < wide, "{q}: {below} at {band}");
        }
    }
    // Parts of recordings that changed since are not merged.
    fs::write(at.join("campaign.toml"), fs::read_to_string(at.join("campaign.toml")).unwrap() + "# new\n")
        .unwrap();
    let said = error(at, "merge parts");
    assert!(said.contains("changed since the parts were computed"), "{said}");
    let said = error(at, &format!("{words} --shard 1/2 --out parts"));
    assert!(said.contains("another part or study: measured is "), "{said}");
}

#[test]
fn several_campaigns_run_into_folders_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for name in ["a", "b", "empty"] {
        fs::create_dir(at.join(name)).unwrap();
    }
    campaign(&at.join("a"));
    campaign(&at.join("b"));
    let ran = command(at, "run a b/campaign.toml empty --out whole --json").output().unwrap();
    assert_eq!(ran.status.code(), Some(1), "one has no answer");
    let ran: Value = serde_json::from_slice(&ran.stdout).unwrap();
    let answered: Vec<&Value> = ran["campaigns"].as_array().unwrap().iter().map(|c| &c["answered"]).collect();
    assert_eq!(answered, [true, true, false]);
    assert!(ran["campaigns"][2]["error"].as_str().unwrap().contains("no recording"));
    let codes = |words: &str| command(at, words).output().unwrap().status.code().unwrap();
    let shard = |number: u32| format!("run a b/campaign.toml empty --shard {number}/2 --out parts");
    assert_eq!(codes(&shard(1)) + codes(&shard(2)), 1, "the part with the empty folder says so");
    assert_eq!(codes("merge parts --out parts"), 1);
    let list = |of: &str| fs::read(at.join(of).join("campaigns.csv")).unwrap();
    assert_eq!(list("parts"), list("whole"));
    assert_eq!(files(&at.join("parts/b")), files(&at.join("whole/b")));
    // A part looks at what lies there now: a campaign that failed is tried again.
    campaign(&at.join("empty"));
    assert_eq!((codes(&shard(1)), codes(&shard(2)), codes("merge parts --out parts")), (0, 0, 0));
    for (words, found) in [
        ("run a b", "campaigns without a folder for their results"),
        ("run a a/campaign.toml --out x", "a/campaign.toml stands twice"),
        ("run a b --out .", "is the folder of a campaign"),
    ] {
        let said = error(at, words);
        assert!(said.contains(found) && !said.contains("panicked"), "{said}");
    }
}

/// Studies open recordings through the folder that knows what is read: --replace does not reach them.
#[test]
fn results_of_draws_do_not_replace_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    campaign(at);
    // A recording under the name of a result.
    let list = fs::read_to_string(at.join("LIST.TXT")).unwrap().replace("VUP0003.DAT", "pairs.csv");
    fs::write(at.join("LIST.TXT"), list).unwrap();
    fs::rename(at.join("VUP0003.DAT"), at.join("pairs.csv")).unwrap();
    let recording = fs::read(at.join("pairs.csv")).unwrap();
    let words = "compare campaign.toml --monte-carlo 100";
    vibro(at, &format!("{words} --shard 1/1 --out parts"));
    for words in [format!("{words} --out . --replace"), "merge parts --out . --replace".to_owned()] {
        let said = error(at, &words);
        assert!(said.contains("pairs.csv is the same file as one that this command reads"), "{said}");
        assert_eq!(fs::read(at.join("pairs.csv")).unwrap(), recording);
    }
    // Where the campaign lies does not belong to the study.
    fs::create_dir(at.join("elsewhere")).unwrap();
    let said = vibro(
        &at.join("elsewhere"),
        "compare ../campaign.toml --monte-carlo 100 --shard 1/1 --out ../parts --json",
    );
    assert!(said.contains("\"kept\": 100"), "{said}");
}

#[test]
fn a_killed_part_is_continued_where_it_ended() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let words =
        "model map --force 0.5 --x frequency:4:14:90 --y restitution:0.3:0.95:80 --shard 2/2 --out parts";
    let part = at.join("parts/part_2_of_2.cells");
    let mut killed = command(at, words).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let began = Instant::now();
    // The head is 600 bytes, a cell 25.
    while fs::metadata(&part).map_or(0, |meta| meta.len()) < 1500 && began.elapsed() < Duration::from_secs(60)
    {
        std::thread::sleep(Duration::from_millis(2));
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    let list = vibro(at, "merge parts --missing");
    assert!(list == "--array=1,2\n" || list == "--array=1\n", "{list}");
    let before = fs::read(&part).unwrap();
    let said: Value = serde_json::from_str(&vibro(at, &format!("{words} --json"))).unwrap();
    assert_eq!(said["cells"], 3600);
    assert!(said["kept"].as_u64() > Some(0), "{said}");
    assert_eq!(vibro(at, "merge parts --missing"), "--array=1\n");
    // What was there is still there, up to half a cell at its end.
    assert!(fs::read(&part).unwrap().starts_with(&before[..before.len() - 25]));
}

#[test]
fn what_cannot_be_merged_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    vibro(at, &format!("{MAP} --shard 2/3 --out parts"));
    assert_eq!(vibro(at, "merge parts --missing"), "--array=1,3\n");
    let said = error(at, "merge parts");
    assert!(said.contains("2 of 3 parts are missing: 1,3") && said.contains("with --shard 1/3"), "{said}");
    let said = error(at, &format!("{MAP} --cycles 100 --shard 2/3 --out parts"));
    assert!(said.contains("another part or study: plan.cycles is 200 and not 100"), "{said}");
    for (words, found) in [
        ("--shard 1/3", "a part without a folder"),
        ("--shard 4/3 --out parts", "the part \"4/3\""),
        ("--shard 1 --out parts", "the part \"1\""),
    ] {
        let said = error(at, &format!("{MAP} {words}"));
        assert!(said.contains(found), "{said}");
    }
    let said = error(at, "model response --force 0.5 --from 5 --to 14 --shard 1/2 --out parts");
    assert!(said.contains("part 1/2 of one answer") && said.contains("--monte-carlo"), "{said}");
    let said = error(at, "merge .");
    assert!(said.contains("no parts in ."), "{said}");
}

/// A map of more cycles than one command computes is done in parts; its cells are an array, not a list.
#[test]
fn a_part_of_a_map_beyond_one_command() {
    let folder = tempfile::tempdir().unwrap();
    let large = "model map --force 0.5 --x frequency:4:14:4000 --y restitution:0.3:0.95:3000";
    let said = error(folder.path(), large);
    assert!(said.contains("more than 1e8") && said.contains("--shard 1/16"), "{said}");
    vibro(folder.path(), &format!("{large} --shard 7/100000 --out parts"));
    let said = error(folder.path(), "merge parts");
    assert!(said.contains("99999 of 100000 parts are missing: 1-6,8-100000"), "{said}");
}
