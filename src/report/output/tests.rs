use super::*;
use std::fs;

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.retain(|name| name != Manifest::FILE);
    names.sort();
    names
}

fn results(folder: impl AsRef<Path>) -> Output {
    Output::new(folder.as_ref(), Owner::Results).unwrap()
}

/// Writes these files as one set; returns the error.
fn written(mut output: Output, files: &[(&str, &str)]) -> Result<()> {
    files.iter().try_for_each(|(name, text)| output.write(name, text))?;
    output.commit().map(drop)
}

#[test]
fn files_are_replaced_whole_and_remembered_once_in_order() {
    let dir = tempfile::tempdir().unwrap();
    let mut out = results(dir.path().join("a/b"));
    out.write("z.txt", "one").unwrap();
    out.write("x.svg", b"<svg/>").unwrap();
    out.write("z.txt", "two").unwrap();
    let folder = out.folder().to_owned();
    assert_eq!(out.commit().unwrap(), ["z.txt", "x.svg"]);
    assert_eq!(fs::read_to_string(folder.join("z.txt")).unwrap(), "two");
    assert_eq!(names(&folder), ["x.svg", "z.txt"]);
}

#[test]
fn names_that_lead_outside_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let mut out = results(dir.path().join("in"));
    for name in ["", ".", "..", "../x", "a/x", "/etc/x", "a\\b", "c:x", "a/", "./a", "a\0b"] {
        let error = out.write(name, "x").unwrap_err();
        assert_eq!(error.exit_code(), 2, "{name:?}");
    }
    // The folder is created with the first file only.
    assert!(names(dir.path()).is_empty() && out.written().next().is_none());
}

#[test]
fn a_failure_leaves_the_old_content_and_no_temporary() {
    let dir = tempfile::tempdir().unwrap();
    let mut out = results(dir.path());
    fs::create_dir(dir.path().join("x")).unwrap();
    fs::write(dir.path().join("x/old"), "old").unwrap();
    assert!(out.write("x", "new").is_err());
    assert!(out.written().next().is_none());
    // A name too long for any file: half of the set is written, and the marker says so.
    let long = "n".repeat(300);
    out.write("a", "new").unwrap();
    out.write(&long, "new").unwrap();
    let error = out.commit().unwrap_err().to_string();
    assert!(error.contains(&long) && !error.contains(".part"), "{error}");
    assert!(error.contains("so far it wrote only a"), "{error}");
    assert_eq!(names(dir.path()), [Output::INCOMPLETE, "a", "x"]);
    assert_eq!(fs::read_to_string(dir.path().join("x/old")).unwrap(), "old");
    written(results(dir.path()), &[("a", "newer"), ("b", "newer")]).unwrap();
    assert_eq!(names(dir.path()), ["a", "b", "x"]);
}

#[test]
fn a_set_appears_as_one_or_leaves_the_old_one() {
    let dir = tempfile::tempdir().unwrap();
    written(results(dir.path()), &[("a", "old")]).unwrap();
    let mut out = results(dir.path());
    out.write("a", "new").unwrap();
    assert_eq!(fs::read_to_string(dir.path().join("a")).unwrap(), "old");
    drop(out);
    assert_eq!(names(dir.path()), ["a"]);
    assert_eq!(fs::read_to_string(dir.path().join("a")).unwrap(), "old");
}

#[test]
fn leftovers_of_killed_programs_are_removed_by_who_holds_the_lock() {
    let dir = tempfile::tempdir().unwrap();
    for name in [".7.0.vibro.part", "9.0.vibro.part", ".vibro.lock"] {
        fs::write(dir.path().join(name), "1").unwrap();
    }
    let mut first = results(dir.path());
    first.write("a.csv", "x").unwrap();
    let parts = || names(dir.path()).iter().filter(|name| name.ends_with(".vibro.part")).count();
    // Two remain: the temporary file of `first`, and the file without a leading dot, which is not vibro's.
    assert_eq!(parts(), 2);
    // A second writer waits for the first and does not remove its files as leftovers.
    let path = dir.path().to_owned();
    let second = std::thread::spawn(move || written(results(path), &[("b.csv", "y")]));
    std::thread::sleep(std::time::Duration::from_millis(100));
    assert!(!second.is_finished() && parts() == 2);
    first.commit().unwrap();
    second.join().unwrap().unwrap();
    assert_eq!(names(dir.path()), ["9.0.vibro.part", "a.csv", "b.csv"]);
}

#[test]
fn a_file_in_the_place_of_a_folder_is_an_error() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("f"), "x").unwrap();
    assert!(Output::new(dir.path().join("f"), Owner::Run).is_err());
    assert_eq!(fs::read_to_string(dir.path().join("f")).unwrap(), "x");
}

/// Runs a check on a folder on disk, and on one in memory.
fn each_side(check: impl Fn(&Folder)) {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("mine.csv"), "mine").unwrap();
    check(&Folder::from(dir.path()));
    check(&Folder::memory("", [("mine.csv", b"mine".to_vec())]));
}

#[test]
fn nothing_of_a_person_is_replaced() {
    each_side(|folder| {
        let out = |owner| Output::new(folder.clone(), owner).unwrap();
        let content =
            |name: &str| String::from_utf8(folder.read(&folder.root().join(name)).unwrap()).unwrap();
        let refused = |owner, name| {
            let error = written(out(owner), &[(name, "new")]).unwrap_err();
            assert!(error.exit_code() == 2 && error.to_string().contains(name), "{error}");
            assert!(out(owner).expect(|known| known == name).is_err());
        };
        refused(Owner::Results, "mine.csv");
        assert_eq!(content("mine.csv"), "mine");
        // An equal file is no obstacle, and still belongs to the person.
        written(out(Owner::Results), &[("mine.csv", "mine"), ("ours.csv", "1")]).unwrap();
        refused(Owner::Results, "mine.csv");
        // vibro may replace what it wrote; but results and converted recordings do not replace each other.
        written(out(Owner::Results), &[("ours.csv", "2")]).unwrap();
        written(out(Owner::Recordings), &[("drop.csv", "2")]).unwrap();
        refused(Owner::Results, "drop.csv");
        refused(Owner::Recordings, "ours.csv");
        written(out(Owner::Recordings), &[("drop.csv", "3")]).unwrap();
        // A result that was changed belongs to the person and is replaced only on purpose.
        written(out(Owner::Person).replace(true), &[("ours.csv", "changed")]).unwrap();
        refused(Owner::Results, "ours.csv");
        written(out(Owner::Results).replace(true), &[("ours.csv", "3")]).unwrap();
        written(out(Owner::Results), &[("ours.csv", "4")]).unwrap();
        assert_eq!([content("mine.csv"), content("ours.csv"), content("drop.csv")], ["mine", "4", "3"]);
    });
}

#[test]
fn what_is_read_is_not_replaced_even_on_purpose() {
    each_side(|folder| {
        written(
            Output::new(folder.clone(), Owner::Results).unwrap(),
            &[("a.csv", "time [s],v [m/s]\n0,1\n1,2\n")],
        )
        .unwrap();
        let path = folder.root().join("a.csv");
        crate::read::Reader::new().within(folder).survey(&path).unwrap();
        let out = Output::new(folder.clone(), Owner::Results).unwrap().replace(true);
        assert!(written(out, &[("a.csv", "5")]).unwrap_err().to_string().contains("reads"));
    });
}

#[test]
fn a_run_removes_what_it_does_not_write_again() {
    each_side(|folder| {
        let out = |owner| Output::new(folder.clone(), owner).unwrap();
        written(out(Owner::Results), &[("spectrum.csv", "1")]).unwrap();
        written(out(Owner::Run), &[("a.csv", "1"), ("b.csv", "1"), ("c.csv", "1")]).unwrap();
        written(out(Owner::Person).replace(true), &[("c.csv", "changed")]).unwrap();
        written(out(Owner::Run), &[("a.csv", "1")]).unwrap();
        let names: Vec<_> = folder.names().into_iter().filter(|name| !name.starts_with('.')).collect();
        // Files that a person changed or another command wrote stay.
        assert_eq!(names, ["a.csv", "c.csv", "mine.csv", "spectrum.csv"]);
    });
}

#[test]
fn a_folder_stays_marked_until_the_same_kind_of_command_completes_it() {
    each_side(|folder| {
        let out = |owner| Output::new(folder.clone(), owner).unwrap();
        let (mark, set) = (folder.root().join(Output::INCOMPLETE), [("a.csv", "1"), ("b.csv", "1")]);
        written(out(Owner::Run), &set).unwrap();
        // The state after a run that was killed after its last file.
        written(out(Owner::Person), &[(Output::INCOMPLETE, MARKS[1])]).unwrap();
        written(out(Owner::Results), &[("c.csv", "1"), ("d.csv", "1")]).unwrap();
        assert!(folder.is_file(&mark));
        written(out(Owner::Run), &set).unwrap();
        assert!(!folder.is_file(&mark));
    });
}

#[test]
fn a_text_is_extended_unless_it_changed_meanwhile() {
    each_side(|folder| {
        let out = || Output::new(folder.clone(), Owner::Person).unwrap();
        let mut both = [out(), out()];
        both[0].extend("mine.csv", "mine", " and more").unwrap();
        let [first, mut second] = both;
        first.commit().unwrap();
        assert!(second.extend("mine.csv", "mine", " or less").is_err());
        assert_eq!(folder.read(&folder.root().join("mine.csv")).unwrap(), b"mine and more");
    });
}

/// A link in place of each bookkeeping file, or of a result: its target stays unchanged.
#[cfg(unix)]
#[test]
fn links_are_not_written_through() {
    for name in [Output::INCOMPLETE, Manifest::FILE, Lock::FILE, "a.csv"] {
        let dir = tempfile::tempdir().unwrap();
        let (folder, target) = (dir.path().join("results"), dir.path().join("target"));
        fs::create_dir(&folder).unwrap();
        fs::write(&target, "precious").unwrap();
        std::os::unix::fs::symlink(&target, folder.join(name)).unwrap();
        let error = written(results(&folder), &[("a.csv", "1"), ("b.csv", "1")]).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
        assert_eq!(fs::read_to_string(&target).unwrap(), "precious");
        assert_eq!(names(&folder), Vec::from_iter((name != Manifest::FILE).then(|| name.to_owned())));
    }
}

#[test]
fn a_file_that_comes_or_changes_meanwhile_stays() {
    each_side(|folder| {
        let out = |owner| Output::new(folder.clone(), owner).unwrap();
        written(out(Owner::Results), &[("old.csv", "1")]).unwrap();
        for name in ["new.csv", "old.csv"] {
            let mut slow = out(Owner::Results);
            slow.write(name, "2").unwrap();
            let path = folder.root().join(name);
            folder.stage(&path, b"mine").unwrap().place().unwrap();
            assert!(slow.commit().unwrap_err().to_string().contains(name));
            assert_eq!(folder.read(&path).unwrap(), b"mine");
        }
    });
}

#[test]
fn names_of_vibros_own_files_are_not_written_and_not_taken_for_its_own() {
    let dir = tempfile::tempdir().unwrap();
    assert!(results(dir.path()).write(".vibro.mine.csv", "1").is_err());
    for name in [Manifest::FILE, Lock::FILE] {
        fs::write(dir.path().join(name), "a person's").unwrap();
        assert!(written(results(dir.path()), &[("a.csv", "1")]).unwrap_err().to_string().contains(name));
        assert_eq!(fs::read_to_string(dir.path().join(name)).unwrap(), "a person's");
        fs::remove_file(dir.path().join(name)).unwrap();
    }
}
