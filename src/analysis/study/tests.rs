use super::*;
use crate::error::Error;
use serde_json::json;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// The squares of the numbers of its cells, in decimal digits: cells of different lengths.
#[derive(Default)]
struct Squares {
    cells: u64,
    computed: AtomicU64,
}

impl Squares {
    fn of(cells: u64) -> Squares {
        Squares { cells, ..Squares::default() }
    }

    fn head(&self, shard: Shard) -> PartHead {
        PartHead::of(json!({ "of": "squares", "rig": { "gap": 1e-3 } }), self.cells, shard).unwrap()
    }

    /// Computes the parts with these numbers into a folder.
    fn parts(&self, folder: &Path, numbers: impl IntoIterator<Item = u64>, of: u64) {
        for number in numbers {
            write_part(folder, self, &self.head(Shard { number, of }), &()).unwrap();
        }
    }

    fn merged(&self, folder: &Path) -> Result<Answer> {
        let parts = Parts::of_folders(&[folder.to_owned()], &())?;
        self.answer(&mut parts.cells()?)
    }
}

impl Study for Squares {
    fn what(&self) -> &'static str {
        "squares"
    }

    fn cells(&self) -> u64 {
        self.cells
    }

    fn cell(&self, number: u64) -> Result<Vec<u8>> {
        self.computed.fetch_add(1, Ordering::Relaxed);
        Ok((number * number).to_string().into_bytes())
    }

    fn answer(&self, cells: &mut Cells<'_>) -> Result<Answer> {
        let all = cells.collect::<Result<Vec<_>>>()?;
        Ok(Answer { files: vec![("squares".to_owned(), all.join(&b' '))], ..Answer::default() })
    }
}

fn said(error: &Error) -> String {
    error.to_string()
}

#[test]
fn every_cell_belongs_to_one_part() {
    for (all, of) in [(0, 3), (1, 1), (7, 10), (1000, 1), (1000, 7), (1024, 16), (90_000, 64)] {
        let mut seen = BTreeSet::new();
        for number in 1..=of {
            let shard = Shard { number, of };
            let cells: Vec<u64> = shard.cells(all).collect();
            assert!(cells.is_sorted() && cells.iter().all(|cell| Shard::number_of(*cell, of) == number));
            assert_eq!(cells.len() as u64, shard.count(all), "{shard} of {all}");
            assert!((all / of..=all.div_ceil(of)).contains(&shard.count(all)));
            seen.extend(cells);
        }
        assert_eq!(seen.len() as u64, all);
    }
}

/// With a fixed turn each part would have 4 of 64 columns. By chance a column of 64 cells is missing in a
/// part of 1/16 of them with (15/16)^64 = 0.016; a part with 64 columns lacks 1 on average, and 8 or more in
/// one of 10⁵.
#[test]
fn a_part_has_cells_of_most_columns_of_a_map() {
    for number in 1..=16 {
        let columns: BTreeSet<u64> = Shard { number, of: 16 }.cells(64 * 64).map(|cell| cell % 64).collect();
        assert!(columns.len() > 56, "{}", columns.len());
    }
}

#[test]
fn parts_of_any_number_give_what_one_run_gives() {
    let study = Squares::of(100);
    let whole = whole(&study, &()).unwrap().files;
    assert!(whole[0].1.starts_with(b"0 1 4 9") && whole[0].1.ends_with(b" 9801"));
    for of in [1, 2, 3, 16, 99, 130] {
        let folder = tempfile::tempdir().unwrap();
        study.parts(folder.path(), 1..=of, of);
        assert_eq!(study.merged(folder.path()).unwrap().files, whole, "{of}");
        let bytes = |number| part_in_memory(&study, &study.head(Shard { number, of }), &()).unwrap();
        let parts = Parts::of_bytes((1..=of).map(bytes).collect()).unwrap();
        assert_eq!(study.answer(&mut parts.cells().unwrap()).unwrap().files, whole);
    }
}

/// A part that ends anywhere, as that of a killed program, is continued: no cell twice, the same file.
#[test]
fn a_part_cut_anywhere_is_continued() {
    let folder = tempfile::tempdir().unwrap();
    let study = Squares::of(30);
    study.parts(folder.path(), [2], 3);
    let path = folder.path().join("part_2_of_3.cells");
    let bytes = fs::read(&path).unwrap();
    let head = bytes.iter().position(|b| *b == b'\n').unwrap() + 1;
    for end in (0..head).step_by(17).chain(head..=bytes.len()) {
        fs::write(&path, &bytes[..end]).unwrap();
        let study = Squares::of(30);
        let part = write_part(folder.path(), &study, &study.head(Shard { number: 2, of: 3 }), &()).unwrap();
        assert_eq!(fs::read(&path).unwrap(), bytes, "cut at {end}");
        assert_eq!(part.kept + study.computed.load(Ordering::Relaxed), 10);
        assert!(end < bytes.len() || part.kept == 10);
    }
}

/// A byte that changed is never taken for a result: the part lacks cells, or is refused, until it is computed
/// anew.
#[test]
fn a_damaged_part_is_not_whole() {
    let folder = tempfile::tempdir().unwrap();
    let study = Squares::of(12);
    study.parts(folder.path(), [1], 1);
    let path = folder.path().join("part_1_of_1.cells");
    let bytes = fs::read(&path).unwrap();
    let head = bytes.iter().position(|b| *b == b'\n').unwrap() + 1;
    for at in head..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x10;
        fs::write(&path, &damaged).unwrap();
        let merged = study.merged(folder.path()).unwrap_err();
        assert!(said(&merged).contains("1 of 1 parts is missing: 1"), "{at}: {merged}");
        study.parts(folder.path(), [1], 1);
        assert_eq!(fs::read(&path).unwrap(), bytes);
    }
}

#[test]
fn missing_parts_are_listed_as_a_job_array_takes_them() {
    let folder = tempfile::tempdir().unwrap();
    let study = Squares::of(200);
    study.parts(folder.path(), [1, 2, 5, 9], 12);
    let path = folder.path().join("part_05_of_12.cells");
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() - 60]).unwrap();
    let parts = Parts::of_folders(&[folder.path().to_owned()], &()).unwrap();
    assert_eq!(Parts::listed(&parts.missing()), "3-8,10-12");
    let error = study.merged(folder.path()).unwrap_err();
    assert!(said(&error).contains("9 of 12 parts are missing: 3-8,10-12; "), "{error}");
    assert!(said(&error).contains("part_05_of_12.cells has 15 of 17 cells"), "{error}");
    assert!(said(&error).contains("with --shard 3/12"), "{error}");
    assert_eq!(Parts::listed(&[1, 3, 4]), "1,3,4");
}

#[test]
fn parts_of_another_study_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let study = Squares::of(20);
    study.parts(folder.path(), [1, 2], 2);
    let head = study.head(Shard { number: 1, of: 2 });
    let other = PartHead::of(json!({ "of": "squares", "rig": { "gap": 2e-3 } }), 20, head.shard).unwrap();
    let error = write_part(folder.path(), &study, &other, &()).unwrap_err();
    assert!(
        said(&error).contains("part_1_of_2.cells: another part or study: rig.gap is 0.001 and not 0.002")
    );

    let twice = at("part_3_of_2.cells");
    fs::copy(at("part_1_of_2.cells"), &twice).unwrap();
    let error = study.merged(folder.path()).unwrap_err();
    assert!(said(&error).contains("part_3_of_2.cells: this is part 1/2, as "), "{error}");

    fs::write(&twice, part_in_memory(&study, &other, &()).unwrap()).unwrap();
    let error = study.merged(folder.path()).unwrap_err();
    assert!(said(&error).contains("rig.gap is 0.002 and not 0.001"), "{error}");

    let of_three = study.head(Shard { number: 3, of: 3 });
    fs::write(&twice, part_in_memory(&study, &of_three, &()).unwrap()).unwrap();
    let error = study.merged(folder.path()).unwrap_err();
    assert!(said(&error).contains("this is one of 3 parts"), "{error}");

    let old = PartHead { vibro: "0.0.9".to_owned(), ..head.clone() };
    fs::write(&twice, part_in_memory(&study, &old, &()).unwrap()).unwrap();
    let error = study.merged(folder.path()).unwrap_err();
    assert!(said(&error).contains("vibro is 0.0.9 and not 0."), "{error}");
}

/// What a part states of itself must be what its name and its study say: a copy under another name would
/// never become whole.
#[test]
fn a_part_under_the_name_of_another_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let study = Squares::of(20);
    study.parts(folder.path(), [2], 2);
    fs::copy(at("part_2_of_2.cells"), at("part_1_of_2.cells")).unwrap();
    let first = study.head(Shard { number: 1, of: 2 });
    let error = write_part(folder.path(), &study, &first, &()).unwrap_err();
    assert!(said(&error).contains("the part is 2/2 and not 1/2"), "{error}");
    let fewer = PartHead { all: 10, ..first.clone() };
    fs::write(at("part_1_of_2.cells"), part_in_memory(&study, &fewer, &()).unwrap()).unwrap();
    let error = write_part(folder.path(), &study, &first, &()).unwrap_err();
    assert!(said(&error).contains("the number of cells is 10 and not 20"), "{error}");
    let other = PartHead { arithmetic: "0".repeat(8), ..first.clone() };
    fs::write(at("part_1_of_2.cells"), part_in_memory(&study, &other, &()).unwrap()).unwrap();
    let error = study.merged(folder.path()).unwrap_err();
    assert!(said(&error).contains("another processor"), "{error}");
}

#[test]
fn what_a_person_adds_to_a_part_is_not_cut_off_in_silence() {
    let folder = tempfile::tempdir().unwrap();
    let study = Squares::of(20);
    study.parts(folder.path(), [1], 1);
    let path = folder.path().join("part_1_of_1.cells");
    let whole = fs::read(&path).unwrap();
    fs::write(&path, [&whole[..], b"notes"].concat()).unwrap();
    let error = write_part(folder.path(), &study, &study.head(Shard::WHOLE), &()).unwrap_err();
    assert!(said(&error).contains("something follows its end"), "{error}");
    assert!(study.merged(folder.path()).is_err());
    assert!(fs::read(&path).unwrap().ends_with(b"notes"));
    // Zeros are what a power failure leaves.
    fs::write(&path, vec![0; whole.len()]).unwrap();
    let part = write_part(folder.path(), &study, &study.head(Shard::WHOLE), &()).unwrap();
    assert_eq!((part.kept, fs::read(&path).unwrap()), (0, whole.clone()));
    // What is cut off is told.
    fs::write(&path, &whole[..whole.len() - 50]).unwrap();
    assert!(write_part(folder.path(), &study, &study.head(Shard::WHOLE), &()).unwrap().cut > 0);
}

#[cfg(unix)]
#[test]
fn a_whole_part_needs_no_right_to_write() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let study = Squares::of(20);
    study.parts(folder.path(), [1], 1);
    let path = folder.path().join("part_1_of_1.cells");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
    let part = write_part(folder.path(), &study, &study.head(Shard::WHOLE), &()).unwrap();
    assert_eq!(part.kept, 20);
    // The same folder by two names holds each part once.
    let twice = [folder.path().to_owned(), folder.path().join(".")];
    assert!(Parts::of_folders(&twice, &()).unwrap().missing().is_empty());
    fs::create_dir(folder.path().join("x.cells")).unwrap();
    assert!(said(&Parts::of_folders(&twice, &()).unwrap_err()).contains("x.cells: is no file"));
}

#[test]
fn a_file_that_is_no_part_is_left_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let study = Squares::of(20);
    let path = folder.path().join("part_1_of_2.cells");
    fs::write(&path, "mine\n").unwrap();
    let error = write_part(folder.path(), &study, &study.head(Shard { number: 1, of: 2 }), &()).unwrap_err();
    assert!(said(&error).contains("does not begin as a part does"), "{error}");
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine\n");
    assert!(Parts::of_folders(&[PathBuf::from(folder.path())], &()).is_err());
}

#[test]
fn a_part_is_named_by_its_number() {
    for (text, shard) in [("3/16", Some((3, 16))), ("1/1", Some((1, 1))), (" 2 / 4", Some((2, 4)))] {
        assert_eq!(text.parse::<Shard>().ok().map(|s| (s.number, s.of)), shard);
    }
    for wrong in ["0/4", "5/4", "1", "1/0", "a/b", "-1/4", "1/2/3", "1/100001", ""] {
        let error = wrong.parse::<Shard>().unwrap_err();
        assert!(said(&error).contains("I/N"), "{wrong}: {error}");
    }
}
