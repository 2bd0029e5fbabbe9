use super::*;
use crate::folder::manifest::listed;

#[test]
fn names_stay_in_their_folder() {
    let folder = Folder::from(Path::new("data"));
    let ok = |name: &str| folder.path(Path::new(name)).is_ok();
    assert!(ok("A.DAT") && ok("sub/A.DAT") && ok("sub/../A.DAT") && ok(r"sub\A.DAT"));
    assert!(
        !ok("../A.DAT") && !ok("/etc/passwd") && !ok(r"..\A.DAT") && !ok(r"C:\A.DAT") && !ok("a/../../b")
    );
    assert!(folder.allow_outside(true).path(Path::new("../A.DAT")).is_ok());
}

#[test]
fn a_manifest_is_read_as_it_was_written() {
    let mut manifest = Manifest::default();
    for (i, name) in ["a.csv", "two\nlines", "back\\slash\\n", "µ  m"].iter().enumerate() {
        manifest.add(Owner::Results, *name, [i as u8; 32]);
        manifest.add(Owner::Results, *name, [i as u8 + 9; 32]);
    }
    manifest.add(Owner::Run, "report.html", [7; 32]);
    manifest.add(Owner::Person, "campaign.toml", [7; 32]);
    let folder = Folder::memory("", [(Manifest::FILE, manifest.text().into_bytes())]);
    assert_eq!(Manifest::of(&folder), manifest);
    assert!(manifest.is_result("report.html") && !manifest.is_result("campaign.toml"));
    assert!(
        manifest.knows(Owner::Run, "a.csv", &[9; 32])
            && !manifest.knows(Owner::Recordings, "a.csv", &[9; 32])
    );
    // Printed by sha256sum (GNU coreutils 9.1) for an empty file of this name.
    let empty = "\\e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  a\\nb\n";
    assert_eq!(listed(&Sha256::digest([]).into(), "a\nb"), empty);
}

#[test]
fn a_foreign_file_of_its_name_is_no_manifest() {
    for text in
        ["", "notes\n", "# run\ne3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  a\n"]
    {
        let folder = Folder::memory("", [(Manifest::FILE, text.as_bytes().to_vec())]);
        assert_eq!(Manifest::of(&folder), Manifest::default(), "{text:?}");
    }
}

#[test]
fn memory_walks_as_a_disk_does() {
    let files =
        ["b.csv", "a/2.csv", "a/deep/er/3.csv", ".hidden", "a/.b/4.csv", "out/spectrum.csv", "out/mine.csv"];
    let mut manifest = Manifest::default();
    manifest.add(Owner::Results, "spectrum.csv", [0; 32]);
    let disk = tempfile::tempdir().unwrap();
    let mut held = vec![("out/.vibro.sha256", manifest.text().into_bytes())];
    held.extend(files.map(|name| (name, b"1".to_vec())));
    for (name, bytes) in &held {
        let path = disk.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    let (memory, disk) = (Folder::memory(disk.path(), held), Folder::from(disk.path()));
    for levels in 0..3 {
        let found = disk.walk(disk.root(), levels).unwrap();
        assert_eq!(found, memory.walk(memory.root(), levels).unwrap());
        // At level 0 `b`, from level 1 on also `a/2` and `out/mine`; `a/deep/er/3` needs three levels.
        assert_eq!((found.files.len(), found.skipped.len()), ([1, 3, 3][levels], 0));
    }
}

#[cfg(unix)]
mod on_unix {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn each_folder_is_visited_once_and_links_stay_inside() {
        let root = tempfile::tempdir().unwrap();
        let (here, other) = (root.path().join("here"), root.path().join("other"));
        fs::create_dir_all(here.join("sub")).unwrap();
        fs::create_dir_all(&other).unwrap();
        fs::write(here.join("sub/x.csv"), "1").unwrap();
        fs::write(other.join("y.csv"), "1").unwrap();
        for (to, link) in [
            (".", "a"),
            (".", "b"),
            ("..", "up"),
            ("sub", "again"),
            ("sub/x.csv", "x2.csv"),
            ("gone", "gone"),
        ] {
            symlink(to, here.join(link)).unwrap();
        }
        symlink(other.join("y.csv"), here.join("y.csv")).unwrap();
        symlink("/dev/zero", here.join("zero.csv")).unwrap();
        fs::write(here.join("two\nlines.csv"), "1").unwrap();
        let folder = Folder::from(here.as_path());
        let found = folder.walk(&here, 2).unwrap();
        assert_eq!(found.files, [here.join("sub/x.csv")]);
        let left: Vec<_> = found
            .skipped
            .iter()
            .map(|(path, _)| path.strip_prefix(&here).unwrap().to_str().unwrap())
            .collect();
        assert_eq!(left, ["two\nlines.csv", "gone", "up", "y.csv", "zero.csv"]);
        assert!(folder.path(Path::new("y.csv")).is_err() && folder.path(Path::new("up/new.csv")).is_err());
        assert!(folder.path(Path::new("a/new.csv")).is_ok());
        // If names outside are allowed, `up` leads to the other folder, too; its file is listed once.
        let all = folder.allow_outside(true).walk(&here, 2).unwrap();
        let names: Vec<_> =
            all.files.iter().map(|path| path.strip_prefix(&here).unwrap().to_str().unwrap()).collect();
        assert_eq!(names, ["sub/x.csv", "up/other/y.csv"]);
    }
}
