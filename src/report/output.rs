//! The one writer: a folder whose files appear together or not at all, and in which nothing of a person's is
//! replaced.

use super::Medium;
use crate::error::{Error, Place, Result};
use crate::read::{Digest, Folder, Lock, Manifest, Occupant, Owner, Staged};
use crate::record::shown;
use sha2::{Digest as _, Sha256};
use std::path::{Component, Path, PathBuf};

/// Folder into which files are written.
///
/// Files are written beside their places under temporary names, and get their names together in
/// [`Output::commit`]. A program that is killed before leaves the old results as they were; one that is
/// killed in between leaves the file [`Output::INCOMPLETE`]. Nothing is forced to the disk: a power failure
/// in the seconds after may still lose the new content.
///
/// A file that this run has opened as a measurement is never replaced. One that vibro did not write there, or
/// that was changed since, is replaced only where [`Output::replace`] says so. The folder's [`Manifest`]
/// tells them apart.
#[derive(Debug)]
pub struct Output {
    /// What its figures are drawn for.
    pub medium: Medium,
    /// What to try where something stands in the way.
    pub elsewhere: String,
    folder: Folder,
    owner: Owner,
    replace: bool,
    files: Vec<StagedFile>,
    /// What a file held that is extended.
    extended: Option<Digest>,
    /// The right to write into the folder, from the first file on.
    lock: Option<Lock>,
}

/// A file that has no name yet.
#[derive(Debug)]
struct StagedFile {
    name: String,
    digest: Digest,
    staged: Staged,
}

/// What has the name of a file that is to be written.
#[derive(Debug, PartialEq, Eq)]
enum Present {
    /// The same bytes.
    Same,
    /// Nothing, or what may be replaced.
    Replaceable,
}

impl Output {
    /// The file that marks a folder in which old and new results stand side by side.
    pub const INCOMPLETE: &str = "INCOMPLETE.txt";
    /// The file in which answers are kept for the next run.
    pub const KEPT: &str = ".vibro.kept";

    /// A folder, made with its parents when the first file is written, so that a job that fails before leaves
    /// nothing.
    ///
    /// # Errors
    /// If a file has its name.
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

    /// States whether files that are not vibro's are replaced, too. Default: they are not.
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
    /// If it is no plain name of a file, or one that vibro keeps for itself.
    pub fn path(&self, name: &str) -> Result<PathBuf> {
        let parts: Vec<Component<'_>> = Path::new(name).components().collect();
        // A backslash or a colon would mean something else on another system.
        if !matches!(parts[..], [Component::Normal(_)]) || name.contains(['/', '\\', ':', '\0']) {
            return Err(unusable(name, "is no plain name"));
        }
        if name.starts_with(".vibro.") && name != Output::KEPT {
            return Err(unusable(name, "is kept for vibro itself"));
        }
        Ok(self.at(name))
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.root().join(name)
    }

    /// Names of the files written, in order and each once.
    pub fn written(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|file| file.name.as_str())
    }

    /// Looks, before anything is computed, whether a file stands in the way that has a name which may be
    /// written.
    ///
    /// # Errors
    /// If one must not be replaced.
    pub fn expect(&self, may: impl Fn(&str) -> bool) -> Result<()> {
        let manifest = Manifest::of(&self.folder);
        let mut names = self.folder.names().into_iter().filter(|name| OWN.contains(&&**name) || may(name));
        names.try_for_each(|name| self.present(&manifest, &name, None).map(drop))
    }

    /// As [`Output::expect`], of one file whose bytes are known: the same bytes are in nobody's way.
    ///
    /// # Errors
    /// As there.
    pub fn expect_bytes(&self, name: &str, bytes: &[u8]) -> Result<()> {
        self.present(&Manifest::of(&self.folder), name, Some(&Sha256::digest(bytes).into())).map(drop)
    }

    /// Writes a file, or writes it anew.
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

    /// Adds text at the end of a file that a person keeps and that held `before` when it was read. Nothing
    /// else is written with it.
    ///
    /// # Errors
    /// As [`Output::write`]; if the file changed meanwhile.
    pub fn extend(&mut self, name: &str, before: &str, addition: &str) -> Result<()> {
        self.extended = Some(Sha256::digest(before).into());
        self.present(&Manifest::default(), name, None)?;
        self.write(name, before.to_owned() + addition)
    }

    /// What has a name; a folder must not.
    fn occupant(&self, name: &str) -> Result<Occupant> {
        match self.folder.occupant(&self.at(name)) {
            Occupant::Folder => {
                Err(unusable(name, "names a folder").hint("remove that folder or choose another name"))
            }
            other => Ok(other),
        }
    }

    /// Whether what has a name may be replaced.
    ///
    /// # Errors
    /// If it must not be replaced by a file of the digest `new`, or by any.
    fn present(&self, manifest: &Manifest, name: &str, new: Option<&Digest>) -> Result<Present> {
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
        let own = match name {
            Output::KEPT => true,
            Manifest::FILE => Manifest::is_of(&self.folder),
            Output::INCOMPLETE => MARKS.iter().any(|text| digest == Digest::from(Sha256::digest(text))),
            _ => self.extended == Some(digest) || manifest.knows(self.owner, name, &digest),
        };
        if !own {
            return Err(foreign("was made by somebody else, or changed since vibro wrote it"));
        }
        if self.folder.is_protected(&path) {
            return Err(in_the_way("is protected").hint(format!("chmod u+w {}", shown(&path))));
        }
        Ok(Present::Replaceable)
    }

    /// Gives the files their names, which it returns in the order in which they were written. Of a campaign,
    /// what the last run wrote and this one did not goes.
    ///
    /// # Errors
    /// If what has a name must not be replaced; nothing is changed then. If the system refuses; the folder is
    /// then marked as incomplete.
    pub fn commit(mut self) -> Result<Vec<String>> {
        let names: Vec<String> = self.written().map(str::to_owned).collect();
        if names.is_empty() {
            return Ok(names);
        }
        self.expect(|_| false)?;
        let before = Manifest::of(&self.folder);
        let stale = self.stale(&before);
        // A program that is killed leaves some of the old files and some of the new: all are vibro's.
        let (mut meanwhile, mut after, mut changed) = (before.clone(), before.clone(), Vec::new());
        for name in &stale {
            after.forget(name);
        }
        for StagedFile { name, digest, staged } in std::mem::take(&mut self.files) {
            if self.present(&before, &name, Some(&digest))? == Present::Replaceable {
                meanwhile.add(self.owner, &name, digest);
                changed.push(staged);
            } else if !before.knows(self.owner, &name, &digest) {
                // The same bytes, but a person's.
                continue;
            }
            after.forget(&name);
            after.add(self.owner, name, digest);
        }
        self.remember(&before, &meanwhile)?;
        let (mark, path) = (MARKS[usize::from(self.owner == Owner::Run)], self.at(Output::INCOMPLETE));
        if changed.len() + stale.len() > 1 && !self.folder.is_file(&path) {
            self.folder.stage(&path, mark.as_bytes())?.place()?;
        }
        changed.into_iter().try_for_each(Staged::place)?;
        stale.iter().try_for_each(|name| self.folder.remove(&self.at(name)))?;
        self.remember(&meanwhile, &after)?;
        // What another kind of command left half stays marked.
        if self.folder.own_file(Output::INCOMPLETE).is_some_and(|held| held == mark.as_bytes()) {
            self.folder.remove(&path)?;
        }
        Ok(names)
    }

    /// What an earlier run of a campaign wrote and this one does not, as it was left.
    fn stale(&self, manifest: &Manifest) -> Vec<String> {
        let as_left = |(name, known): &(&str, &Digest)| {
            let path = self.at(name);
            self.owner == Owner::Run
                && !self.written().any(|written| written == *name)
                && self.folder.occupant(&path) == Occupant::File
                && !self.folder.opened(&path)
                && self.folder.digest(&path).is_ok_and(|digest| digest == **known)
        };
        manifest.owned(Owner::Run).filter(as_left).map(|(name, _)| name.to_owned()).collect()
    }

    fn remember(&self, before: &Manifest, after: &Manifest) -> Result<()> {
        if before == after {
            return Ok(());
        }
        self.folder.stage(&self.at(Manifest::FILE), after.text().as_bytes())?.place()
    }
}

/// Files by which a folder of results is kept in order.
const OWN: [&str; 2] = [Output::INCOMPLETE, Manifest::FILE];

/// What the file says that marks a folder, of a command and of a campaign.
const MARKS: [&str; 2] = [
    "Old and new results stand side by side here: run the same command again.\n",
    "Old and new results of a campaign stand side by side here: run it again.\n",
];

fn unusable(name: &str, why: &str) -> Error {
    Error::usage(format!("the output name \"{name}\" {why}"), "a name such as response.svg")
}

#[cfg(test)]
mod tests;
