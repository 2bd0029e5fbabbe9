//! The only writer of files: all files of a folder appear together or not at all. Files that a person wrote
//! are not replaced.

use super::Medium;
use crate::error::{Error, Place, Result};
use crate::read::{Digest, Folder, Lock, Manifest, Occupant, Owner, Staged};
use crate::record::shown;
use sha2::{Digest as _, Sha256};
use std::path::{Component, Path, PathBuf};

/// Folder into which files are written.
///
/// Files are written beside their places under temporary names and renamed together in [`Output::commit`]. A
/// program that is killed before leaves the old results; one that is killed while renaming leaves the file
/// [`Output::INCOMPLETE`]. There is no fsync: a power failure within seconds may lose the new content.
///
/// A file that this run read as a measurement is never replaced. A file that vibro did not write, or that
/// was changed since, is replaced only with [`Output::replace`]. The folder's [`Manifest`] records what
/// vibro wrote.
#[derive(Debug)]
pub struct Output {
    /// Medium of the figures.
    pub medium: Medium,
    /// Advice for the error about an existing file that must not be replaced: where to write instead.
    pub elsewhere: String,
    folder: Folder,
    owner: Owner,
    replace: bool,
    /// Files written so far, under temporary names.
    files: Vec<StagedFile>,
    /// Digest of the earlier content of a file that is extended.
    extended: Option<Digest>,
    /// Lock of the folder, taken with the first file.
    lock: Option<Lock>,
}

/// A file under its temporary name.
#[derive(Debug)]
struct StagedFile {
    name: String,
    digest: Digest,
    staged: Staged,
}

/// State of the place where a file is to be written.
#[derive(Debug, PartialEq, Eq)]
enum Present {
    /// A file with the same bytes.
    Same,
    /// Nothing, or a file that may be replaced.
    Replaceable,
}

impl Output {
    /// Marker of a folder with a mixture of old and new results.
    pub const INCOMPLETE: &str = "INCOMPLETE.txt";
    /// File with the answers that the next run reuses.
    pub const KEPT: &str = ".vibro.kept";

    /// A folder. It is created, with its parents, when the first file is written, so that a job that fails
    /// earlier leaves nothing behind.
    ///
    /// # Errors
    /// If there is a file of that name.
    pub fn new(folder: impl Into<Folder>, owner: Owner) -> Result<Output> {
        let folder: Folder = folder.into();
        let root = folder.root();
        if !root.as_os_str().is_empty() && folder.exists(root) && !folder.is_folder(root) {
            return Err(Error::input(Place::file(root), "this is a file", "a folder for results")
                .hint("name another folder"));
        }
        let (medium, elsewhere, files) = (Medium::default(), "another place".to_owned(), Vec::new());
        Ok(Output { medium, elsewhere, folder, owner, replace: false, files, extended: None, lock: None })
    }

    /// Whether files that vibro did not write are replaced. Default: no.
    pub fn replace(self, replace: bool) -> Output {
        Output { replace, ..self }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        self.folder.root()
    }

    /// The path of a file of this name.
    ///
    /// # Errors
    /// If it is no plain file name, or one that vibro reserves.
    pub fn path(&self, name: &str) -> Result<PathBuf> {
        let parts: Vec<Component<'_>> = Path::new(name).components().collect();
        // Backslash and colon separate parts of a path on Windows.
        if !matches!(parts[..], [Component::Normal(_)]) || name.contains(['/', '\\', ':', '\0']) {
            return Err(unusable(name, "is no plain name"));
        }
        if name.starts_with(".vibro.") && name != Output::KEPT {
            return Err(unusable(name, "is kept for vibro itself"));
        }
        Ok(self.at(name))
    }

    /// The path of a file of the folder, unchecked.
    fn at(&self, name: &str) -> PathBuf {
        self.folder.root().join(name)
    }

    /// Names of the files written, in order, each once. They have their names only after [`Output::commit`].
    pub fn written(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|file| file.name.as_str())
    }

    /// Checks, before anything is computed, that no existing file is in the way of the names that may be
    /// written.
    ///
    /// # Errors
    /// If a file must not be replaced.
    pub fn expect(&self, may: impl Fn(&str) -> bool) -> Result<()> {
        let manifest = Manifest::of(&self.folder);
        let mut names =
            self.folder.names().into_iter().filter(|name| BOOKKEEPING.contains(&&**name) || may(name));
        names.try_for_each(|name| self.check_writable(&manifest, &name, None).map(drop))
    }

    /// As [`Output::expect`], for one file with known bytes: an existing file with the same bytes is no
    /// obstacle.
    ///
    /// # Errors
    /// As for [`Output::expect`].
    pub fn expect_bytes(&self, name: &str, bytes: &[u8]) -> Result<()> {
        self.check_writable(&Manifest::of(&self.folder), name, Some(&Sha256::digest(bytes).into())).map(drop)
    }

    /// Writes a file; a second call with the same name replaces the first.
    ///
    /// # Errors
    /// If `name` is no plain name of a file, or that of a folder; if another program writes there, or the
    /// system refuses.
    pub fn write(&mut self, name: &str, bytes: impl AsRef<[u8]>) -> Result<()> {
        let (path, bytes) = (self.path(name)?, bytes.as_ref());
        self.occupant(name)?;
        if self.lock.is_none() {
            self.lock = self.folder.lock()?;
        }
        let (digest, staged) = (Sha256::digest(bytes).into(), self.folder.stage(&path, bytes)?);
        let file = StagedFile { name: name.to_owned(), digest, staged };
        match self.files.iter_mut().find(|file| file.name == name) {
            Some(before) => *before = file,
            None => self.files.push(file),
        }
        Ok(())
    }

    /// Appends text to a file of a person that held `before` when it was read. No other file is written with
    /// it.
    ///
    /// # Errors
    /// As [`Output::write`]; if the file changed meanwhile.
    pub fn extend(&mut self, name: &str, before: &str, addition: &str) -> Result<()> {
        self.extended = Some(Sha256::digest(before).into());
        self.check_writable(&Manifest::default(), name, None)?;
        self.write(name, before.to_owned() + addition)
    }

    /// Kind of entry under a name. A folder there is an error.
    fn occupant(&self, name: &str) -> Result<Occupant> {
        match self.folder.occupant(&self.at(name)) {
            Occupant::Folder => {
                Err(unusable(name, "names a folder").hint("remove that folder or choose another name"))
            }
            other => Ok(other),
        }
    }

    /// Checks that `name` may be written: `Same` if its bytes already have the digest `new`.
    ///
    /// # Errors
    /// If a file there is not vibro's, is an input, or is protected.
    fn check_writable(&self, manifest: &Manifest, name: &str, new: Option<&Digest>) -> Result<Present> {
        let path = self.at(name);
        let in_the_way = |what: &str| {
            let found = format!("{} {what}, so vibro does not replace it", shown(&path));
            Error::usage(found, "").hint(&*self.elsewhere)
        };
        let foreign = |what: &str| match self.owner {
            Owner::Person => in_the_way(what),
            _ => in_the_way(what)
                .hint(format!("{}, or replace it on purpose", self.elsewhere))
                .setting("replace"),
        };
        let occupant = self.occupant(name)?;
        if self.folder.opened(&path) {
            return Err(in_the_way("is the same file as one that this command reads"));
        }
        if occupant == Occupant::Nothing || self.replace {
            return Ok(Present::Replaceable);
        }
        if occupant == Occupant::Special {
            return Err(foreign("is a link or a device"));
        }
        let digest = self.folder.digest(&path)?;
        if new == Some(&digest) {
            return Ok(Present::Same);
        }
        let is_of_vibro = match name {
            Output::KEPT => true,
            Manifest::FILE => Manifest::is_of(&self.folder),
            Output::INCOMPLETE => MARKS.iter().any(|text| digest == Digest::from(Sha256::digest(text))),
            _ => self.extended == Some(digest) || manifest.knows(self.owner, name, &digest),
        };
        if !is_of_vibro {
            return Err(foreign("was made by somebody else, or changed since vibro wrote it"));
        }
        if self.folder.is_protected(&path) {
            return Err(in_the_way("is protected").hint(format!("chmod u+w {}", shown(&path))));
        }
        Ok(Present::Replaceable)
    }

    /// Renames the files to their names, which it returns in the order of writing. For a campaign, files of
    /// the last run that this one did not write are removed.
    ///
    /// # Errors
    /// If an existing file must not be replaced: then nothing is changed. If the system refuses: then the
    /// folder is marked as incomplete.
    pub fn commit(mut self) -> Result<Vec<String>> {
        let staged_names: Vec<String> = self.written().map(str::to_owned).collect();
        if staged_names.is_empty() {
            return Ok(staged_names);
        }
        self.expect(|_| false)?;
        let before = Manifest::of(&self.folder);
        let stale = self.stale(&before);
        // The manifest `meanwhile` lists old and new files as vibro's, so that a program killed while
        // renaming leaves no file that the next run takes for a person's.
        let (mut meanwhile, mut after, mut changed) = (before.clone(), before.clone(), Vec::new());
        for name in &stale {
            after.forget(name);
        }
        for StagedFile { name, digest, staged } in std::mem::take(&mut self.files) {
            if self.check_writable(&before, &name, Some(&digest))? == Present::Replaceable {
                meanwhile.add(self.owner, &name, digest);
                changed.push((name.clone(), staged));
            } else if !before.knows(self.owner, &name, &digest) {
                // The bytes are the same, but the file is a person's: it stays out of the manifest.
                continue;
            }
            after.forget(&name);
            after.add(self.owner, name, digest);
        }
        self.write_manifest(&before, &meanwhile)?;
        let (mark, path) = (MARKS[usize::from(self.owner == Owner::Run)], self.at(Output::INCOMPLETE));
        if changed.len() + stale.len() > 1 && !self.folder.is_file(&path) {
            self.folder.stage(&path, mark.as_bytes())?.place()?;
        }
        place(changed)?;
        stale.iter().try_for_each(|name| self.folder.remove(&self.at(name)))?;
        self.write_manifest(&meanwhile, &after)?;
        // A marker left by another kind of command stays.
        if self.folder.own_file(Output::INCOMPLETE).is_some_and(|held| held == mark.as_bytes()) {
            self.folder.remove(&path)?;
        }
        Ok(staged_names)
    }

    /// Unchanged files of an earlier run of a campaign that this run does not write.
    fn stale(&self, manifest: &Manifest) -> Vec<String> {
        let is_unchanged_leftover = |(name, recorded): &(&str, &Digest)| {
            let path = self.at(name);
            self.owner == Owner::Run
                && !self.written().any(|staged| staged == *name)
                && self.folder.occupant(&path) == Occupant::File
                && !self.folder.opened(&path)
                && self.folder.digest(&path).is_ok_and(|digest| digest == **recorded)
        };
        manifest.owned(Owner::Run).filter(is_unchanged_leftover).map(|(name, _)| name.to_owned()).collect()
    }

    /// Writes the manifest if it changed.
    fn write_manifest(&self, before: &Manifest, after: &Manifest) -> Result<()> {
        if before == after {
            return Ok(());
        }
        self.folder.stage(&self.at(Manifest::FILE), after.text().as_bytes())?.place()
    }
}

/// Renames files to their names, in order.
///
/// # Errors
/// If the system refuses one; the error names the files before it, which are new.
fn place(files: Vec<(String, Staged)>) -> Result<()> {
    let mut placed: Vec<String> = Vec::new();
    for (name, staged) in files {
        staged.place().map_err(|error| match placed.as_slice() {
            [] => error,
            new => error.hint(format!("the same command again; so far it wrote only {}", new.join(", "))),
        })?;
        placed.push(name);
    }
    Ok(())
}

/// Files that vibro keeps for itself in a folder of results.
const BOOKKEEPING: [&str; 2] = [Output::INCOMPLETE, Manifest::FILE];

/// Text of the marker file, for a command and for a campaign.
const MARKS: [&str; 2] = [
    "Old and new results stand side by side here: run the same command again.\n",
    "Old and new results of a campaign stand side by side here: run it again.\n",
];

/// Error for an output name that cannot be used.
fn unusable(name: &str, why: &str) -> Error {
    Error::usage(format!("the output name \"{name}\" {why}"), "a name such as response.svg")
}

#[cfg(test)]
mod tests;
