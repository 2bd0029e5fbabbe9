use super::entries::entries;
use super::kinds::faults;
use super::*;
use crate::campaign::Campaign;
use crate::error::Result;
use crate::read::Folder;
use crate::report::words::{Voice, sentences};
use crate::units::Quantity;
use std::path::{Path, PathBuf};

fn of(text: &str) -> Result<Campaign> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("campaign.toml");
    std::fs::write(&path, text).unwrap();
    let campaign = open(path)?;
    faults(&campaign)?.into_iter().next().map_or(Ok(campaign), |fault| Err(fault.error))
}

const SWEEP: &str = "[[sweep]]\nname = \"a\"\nlist = \"L.TXT\"\n";

#[test]
fn a_campaign_of_every_part() {
    let text = format!(
        "name = \"x\"\n[rig]\ngap = 2e-3\n[excitation]\nkind = \"sine\"\nforce = 0.1\n{SWEEP}\
         quantity = \"velocity\"\ndirection = \"down\"\nmass = 2\nwindow = \"hann\"\n\
         [[frf]]\nfile = \"a.uff\"\n[[drop]]\nfile = \"d.wav\"\n[compute]\noverlay = false\n"
    );
    let campaign = of(&text).unwrap();
    assert_eq!(campaign.rig.map(|r| r.gap), Some(2e-3));
    let sweeps = entries::<sweep::Keys>(&campaign).unwrap();
    assert_eq!(sweeps[0].keys.reader().unwrap().quantity, Some(Quantity::Velocity));
    assert!(campaign.out().ends_with("results") && !campaign.is_empty());
}

#[test]
fn mistakes_point_at_their_line() {
    for (text, line, word) in [
        ("nam = 1", "line 1, column 1", "`name`"),
        ("name = \"a\"\n[rig]\nm3 = 1", "line 3, column 1", "m3"),
        ("[[sweep]]\nname = \"a\"", "line 2", "neither a list"),
        (&format!("{SWEEP}{SWEEP}"), "line 5", "two sweeps"),
        (&format!("{SWEEP}mass = 3"), "line 4", "mass"),
        (&format!("{SWEEP}base_band = 50.0"), "line 3", "beside a list"),
        (&format!("{SWEEP}quantity = \"speed\""), "line 4", "speed"),
        (&format!("{SWEEP}unit = \"mm\"\nquantity = \"velocity\""), "line 4", "one of displacement"),
        (&format!("{SWEEP}window = \"kaiser\""), "line 4", "kaiser"),
        (&format!("{SWEEP}calibration = 0.0"), "line 4", "calibration"),
        ("out = \"../x\"", "line 1", "outside"),
        ("name = ", "line 1", ""),
        ("[sweep]\nname = \"a\"", "line 1", "write [[sweep]]"),
        ("[[rig]]\nm1 = 1.0", "line 1", "write [rig]"),
        ("[[sweep]\nname = \"a\"", "line 1", "write [[sweep]]"),
        ("sweep = \"a\"", "line 1", "double brackets"),
        (&format!("{SWEEP}direction = 3"), "line 4", "direction = 3; expected \"up\" or \"down\""),
        (&format!("{SWEEP}direction = \"left\""), "line 4", "expected \"up\" or \"down\""),
        (&format!("{SWEEP}scaling = 1 # ?"), "line 4", "scaling = 1; expected one of \"peak\", \"rms\""),
        (&format!("{SWEEP}mass = -1"), "line 4", "mass = -1; expected a whole number from 0"),
        ("[[sweep]]\nlist = \"L\"", "line 1", "add name = "),
        (
            "[[drop]]\nname = \"x\"\nfile = \"a.wav\"\n[[drop]]\nname = \"x\"\nfile = \"a.wav\"",
            "line 6",
            "in the series \"x\" twice",
        ),
        ("[rig]\nm1 = 0,5\nm2 = 1", "line 2", "write m1 = 0.5"),
        ("[rig]\nm2 = 1.0\nk1 = -1.0", "line 3, column 1", "k1 is -1 N/m"),
        (
            "[[sweep]]\nname = \"a\"\nforce = [\"f\"]\nresponse = [\"r\"]\nlines = 400",
            "line 2",
            "1 force and 1 response files, lines 400, base_band left out",
        ),
    ] {
        let error = of(text).unwrap_err().to_string();
        assert!(error.contains(line) && error.contains(word) && error.contains('^'), "{text}\n{error}");
    }
}

#[test]
fn a_sweep_is_chosen_by_name() {
    let campaign = of(&format!("{SWEEP}[[sweep]]\nname = \"b\"\nlist = \"M.TXT\"\n")).unwrap();
    let chosen = |name| named(&campaign, name).unwrap_err().to_string();
    assert!(chosen(None).contains("a, b") && chosen(Some("c")).contains("a, b"));
    assert!(chosen(Some("a")).contains("does not exist"));
}

#[test]
fn a_missing_recording_is_made_by_the_command_that_is_named() {
    let campaign = of("made_by = \"make it\"\n[[impacts]]\nfile = \"x.wav\"\n").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut output = crate::report::Output::new(folder.path(), crate::read::Owner::Run).unwrap();
    let error = run(&campaign, &AnswerCache::default(), &mut output, &()).unwrap_err().to_string();
    assert!(error.contains("line 3") && error.contains("try: `make it` makes it"), "{error}");
}

#[test]
fn a_fit_without_a_rig_is_not_passed_over_in_silence() {
    let campaign = of("[fit]\nparameters = [\"gap\"]\n").unwrap();
    let mut output =
        crate::report::Output::new(tempfile::tempdir().unwrap().path(), crate::read::Owner::Run).unwrap();
    let CampaignOutcome { answer, .. } = run(&campaign, &AnswerCache::default(), &mut output, &()).unwrap();
    let said = sentences(&answer.findings, Voice::Campaign, true);
    assert!(said.iter().any(|s| s.contains("`fit` needs a table `rig`")), "{said:?}");
}

#[test]
fn numbers_in_names_are_in_order() {
    let names = [
        "f 9.csv",
        "f 10.csv",
        "f 11.csv",
        "f 11.05 Hz.csv",
        "f 11.15 Hz.csv",
        "f 11.2 Hz.csv",
        "f 11.2 Hz b.csv",
    ];
    let mut files: Vec<PathBuf> = names.iter().rev().map(Into::into).collect();
    in_order(&mut files);
    let found: Vec<&str> = files.iter().filter_map(|file| file.to_str()).collect();
    assert_eq!(found, names);
    for names in [
        ["R2.001", "R2.010", "R2.2"],
        ["2024.9.30.csv", "2024.10.1.csv", "v"],
        ["\u{e9}1.\u{fffd}", "\u{e9}2", "\u{e9}10.5"],
    ] {
        let mut files: Vec<PathBuf> = names.iter().rev().map(Into::into).collect();
        in_order(&mut files);
        assert!(files.iter().zip(names).all(|(file, name)| file.to_str() == Some(name)), "{files:?}");
    }
}

#[test]
fn a_pattern_means_files_of_its_folder_however_that_is_named() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("d [1]");
    std::fs::create_dir_all(folder.join("sub")).unwrap();
    for name in ["a2.csv", "a10.csv", "b1.csv", "sub/a1.csv"] {
        std::fs::write(folder.join(name), "").unwrap();
    }
    let found =
        |folder: &Path, name: &str| matching(&folder.into(), Path::new(name)).map_err(|e| e.to_string());
    let expected: Vec<PathBuf> = ["a2.csv", "a10.csv"].map(Into::into).into();
    for folder in
        [&folder, &root.path().join("./d [1]"), &folder.join("sub/.."), &root.path().join(".//d [1]/.")]
    {
        assert_eq!(found(folder, "a*.csv"), Ok(expected.clone()), "{}", folder.display());
    }
    assert_eq!(found(&folder, "./a*.csv"), Ok(expected));
    assert_eq!(found(&folder, "*/a*.csv"), Ok(vec!["sub/a1.csv".into()]));
    assert!(found(&folder, "c*.csv").unwrap_err().contains("no file matches"));
    let is_pattern = |folder: &Path, name: &str| is_pattern(&folder.into(), Path::new(name));
    assert!(is_pattern(&folder, "a*.csv") && !is_pattern(Path::new("st*r"), "a.csv"));
}

/// A campaign runs in memory as it does on a disk, and writes the same bytes.
#[test]
fn a_run_needs_no_disk() {
    let path = Path::new("examples/bench/campaign.toml");
    let held = std::fs::read_dir(path.parent().unwrap()).unwrap().map(|entry| entry.unwrap().path());
    let held = held.filter(|path| path.is_file()).map(|path| (path.clone(), std::fs::read(path).unwrap()));
    let memory = Folder::memory("", held);
    let out = tempfile::tempdir().unwrap();
    let run = |within: &Folder, out: &Path| {
        let (campaign, results) = (open_in(within, path).unwrap(), within.at(out));
        let mut output = crate::report::Output::new(results.clone(), crate::read::Owner::Run).unwrap();
        run(&campaign, &AnswerCache::none(within), &mut output, &()).unwrap();
        output.commit().unwrap();
        let names = results.names().into_iter();
        names.map(|name| (results.read(&out.join(&name)).unwrap(), name)).collect::<Vec<_>>()
    };
    let (disk, memory) = (run(&Folder::default(), out.path()), run(&memory, Path::new("results")));
    let names = |all: &[(Vec<u8>, String)]| all.iter().map(|file| file.1.clone()).collect::<Vec<_>>();
    assert!(names(&disk).contains(&"results.json".to_owned()), "{:?}", names(&disk));
    assert_eq!(names(&disk), names(&memory));
    let other: Vec<_> = disk.iter().zip(&memory).filter(|(a, b)| a != b).map(|(a, _)| &a.1).collect();
    assert!(other.is_empty(), "{other:?}");
}
