//! The one writer: a folder whose files appear together or not at all, and in which nothing of a person's is replaced.

use super::Medium;
use crate::error::{Error, Place, Result};
use crate::read::{Digest, Folder, Lock, Manifest, Owner, Staged, Standing};
use crate::record::shown;
use sha2::{Digest as _, Sha256};
use std::path::{Component, Path};

/// Folder into which files are written.
///
/// Files are written beside their places under temporary names, and get their names together in [`Output::commit`]. A program that is
/// killed before leaves the old results as they were; one that is killed in between leaves the file [`Output::INCOMPLETE`]. Nothing is
/// forced to the disk: a power failure in the seconds after may still lose the new content.
///
/// A file that this run has opened as a measurement is never replaced. One that vibro did not write there, or that was changed since, is
/// replaced only where [`Output::replace`] says so. The folder's [`Manifest`] tells them apart.
#[derive(Debug)]
pub struct Output {
    /// What its figures are drawn for.
    pub medium: Medium,
    folder: Folder,
    owner: Owner,
    replace: bool,
    /// From the first file on.
    claim: Option<Claim>,
    written: Vec<String>,
    /// What a file held that is extended.
    extended: Option<String>,
    /// The content of each name; nothing to place where the name holds it already.
    staged: Vec<(Digest, Option<Staged>)>,
}

/// What a folder held before, and the right to write into it, which memory does not need.
type Claim = (Manifest, Option<Lock>);

impl Output {
    /// The file that marks a folder in which old and new results stand side by side.
    pub const INCOMPLETE: &str = "INCOMPLETE.txt";
    /// The file in which answers are kept for the next run.
    pub const KEPT: &str = ".vibro.kept";

    /// A folder, made with its parents when the first file is written, so that a job that fails before leaves nothing.
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
        let (medium, written, staged) = (Medium::default(), Vec::new(), Vec::new());
        Ok(Output { medium, folder, owner, replace: false, claim: None, written, extended: None, staged })
    }

    /// States whether files that are not vibro's are replaced, too. Default: they are not.
    pub fn replace(self, replace: bool) -> Output {
        Output { replace, ..self }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        self.folder.root()
    }

    /// Names of the files written, in order and each once.
    pub fn written(&self) -> &[String] {
        &self.written
    }

    /// Looks, before anything is computed, whether a file stands in the way that has a name which may be written.
    ///
    /// # Errors
    /// As [`Output::write`] of that name.
    pub fn expect(&self, may: impl Fn(&str) -> bool) -> Result<()> {
        let manifest = Manifest::of(&self.folder);
        let mut names =
            self.folder.names().into_iter().filter(|name| OWN.contains(&name.as_str()) || may(name));
        names.try_for_each(|name| self.holds(&manifest, &name, None).map(drop))
    }

    /// Writes a file, or writes it anew.
    ///
    /// # Errors
    /// If `name` is no plain name of a file, has something that is not vibro's, or the system refuses.
    pub fn write(&mut self, name: &str, bytes: impl AsRef<[u8]>) -> Result<()> {
        let (path, bytes) = (self.folder.root().join(checked(name)?), bytes.as_ref());
        let digest: Digest = Sha256::digest(bytes).into();
        let claim = self.claimed()?;
        let there = self.holds(&claim.0, name, Some(&digest));
        self.claim = Some(claim);
        let there = there?;
        let staged = if there { None } else { Some(self.folder.stage(&path, bytes)?) };
        self.take(name, digest, staged);
        Ok(())
    }

    /// Adds text at the end of a file that a person keeps and that held `before` when it was read; nothing else is written with it.
    ///
    /// # Errors
    /// If it was changed meanwhile, is protected, or the system refuses.
    pub fn extend(&mut self, name: &str, before: &str, addition: &str) -> Result<()> {
        let path = self.folder.root().join(checked(name)?);
        self.claim = Some(self.claimed()?);
        self.still_holds(name, before)?;
        let text = before.to_owned() + addition;
        let staged = self.folder.stage(&path, text.as_bytes())?;
        self.take(name, Sha256::digest(text).into(), Some(staged));
        self.extended = Some(before.to_owned());
        Ok(())
    }

    fn still_holds(&self, name: &str, before: &str) -> Result<()> {
        let path = self.folder.root().join(name);
        let error = |found| Error::input(Place::file(&path), found, "a file that vibro may add to");
        if self.folder.is_protected(&path) {
            return Err(error("the file is protected").hint(format!("chmod u+w {}", shown(&path))));
        }
        if self.folder.read(&path)? != before.as_bytes() {
            return Err(error("the file changed meanwhile").hint("run the same command again"));
        }
        Ok(())
    }

    fn take(&mut self, name: &str, digest: Digest, staged: Option<Staged>) {
        if let Some(i) = self.written.iter().position(|written| written == name) {
            self.staged[i] = (digest, staged);
        } else {
            self.written.push(name.to_owned());
            self.staged.push((digest, staged));
        }
    }

    /// What is held of the folder; for the first time it is made, and this becomes its only writer.
    fn claimed(&mut self) -> Result<Claim> {
        if let Some(claim) = self.claim.take() {
            return Ok(claim);
        }
        self.folder.make(self.folder.root())?;
        let lock = self.folder.lock()?;
        self.folder.remove_leftovers();
        let manifest = Manifest::of(&self.folder);
        OWN.iter().try_for_each(|name| self.holds(&manifest, name, None).map(drop))?;
        Ok((manifest, lock))
    }

    /// Whether a name holds these bytes already; it may be written anew where not.
    ///
    /// # Errors
    /// If what has the name must not be replaced.
    fn holds(&self, manifest: &Manifest, name: &str, new: Option<&Digest>) -> Result<bool> {
        let path = self.folder.root().join(name);
        let in_the_way = |what: &str| {
            let found = format!("{} {what}, so vibro does not replace it", shown(&path));
            Error::usage(found, "").hint("another place").setting("out")
        };
        let standing = self.folder.standing(&path);
        if standing == Standing::Folder {
            return Err(unusable(name, "names a folder").hint("remove that folder or choose another name"));
        }
        if self.folder.opened(&path) {
            return Err(in_the_way("is what this command reads"));
        }
        if standing == Standing::Free || self.replace {
            return Ok(false);
        }
        if standing == Standing::Special {
            return Err(in_the_way("is a link or a device").setting("replace"));
        }
        let digest = self.folder.digest(&path)?;
        if new == Some(&digest) {
            return Ok(true);
        }
        let marked = |text: &&str| digest == Digest::from(Sha256::digest(text));
        let own = match name {
            Output::INCOMPLETE => MARKS.iter().any(marked),
            Manifest::FILE => Manifest::is_of(&self.folder),
            Output::KEPT => true,
            _ => false,
        };
        if own || manifest.knows(self.owner, name, &digest) {
            return Ok(false);
        }
        Err(in_the_way("was made by somebody else, or changed since vibro wrote it").setting("replace"))
    }

    /// Gives the files their names, which it returns in the order in which they were written. Of a campaign, what the last run wrote and this
    /// one did not goes.
    ///
    /// # Errors
    /// If the system refuses; the folder is then marked as incomplete.
    pub fn commit(mut self) -> Result<Vec<String>> {
        let Some((mut manifest, lock)) = self.claim.take() else { return Ok(self.written) };
        // Somebody may have made or changed a file since it was looked at.
        for (name, (digest, _)) in self.written.iter().zip(&self.staged) {
            match &self.extended {
                Some(before) => self.still_holds(name, before)?,
                None => drop(self.holds(&manifest, name, Some(digest))?),
            }
        }
        let stale = if self.owner == Owner::Run { self.stale(&manifest) } else { Vec::new() };
        let mut after = manifest.clone();
        let mut files = Vec::new();
        for (name, (digest, staged)) in self.written.iter().zip(std::mem::take(&mut self.staged)) {
            // What holds these bytes, but is not known, stays a person's.
            if staged.is_some() || manifest.knows(self.owner, name, &digest) {
                after.forget(name);
                after.add(self.owner, name, digest);
            }
            if let Some(staged) = staged {
                // A program that is killed leaves some of the old files and some of the new: all are vibro's.
                manifest.add(self.owner, name, digest);
                files.push((name, staged));
            }
        }
        let mark = self.folder.root().join(Self::INCOMPLETE);
        let (marks, marked) = (MARKS[usize::from(self.owner == Owner::Run)], self.folder.is_file(&mark));
        if files.len() + stale.len() > 0 {
            self.remember(&manifest)?;
        }
        if files.len() + stale.len() > 1 && !marked {
            self.folder.place(self.folder.stage(&mark, marks.as_bytes())?, &mark)?;
        }
        for (name, staged) in files {
            self.folder.place(staged, &self.folder.root().join(name))?;
        }
        for name in stale {
            self.folder.remove(&self.folder.root().join(&name))?;
            after.forget(&name);
        }
        if after != manifest {
            self.remember(&after)?;
        }
        // What another kind of command left half stays marked.
        if self.folder.is_file(&mark) && self.folder.read(&mark)? == marks.as_bytes() {
            self.folder.remove(&mark)?;
        }
        drop(lock);
        Ok(self.written)
    }

    /// What an earlier run of a campaign wrote and this one does not, as it was left.
    fn stale(&self, manifest: &Manifest) -> Vec<String> {
        let gone = |(name, known): &(&str, &[Digest])| {
            let path = self.folder.root().join(name);
            let left = self.folder.standing(&path) == Standing::File && !self.folder.opened(&path);
            left && !self.written.iter().any(|written| written == name)
                && self.folder.digest(&path).is_ok_and(|digest| known.contains(&digest))
        };
        manifest.owned(Owner::Run).filter(gone).map(|(name, _)| name.to_owned()).collect()
    }

    fn remember(&self, manifest: &Manifest) -> Result<()> {
        if manifest.is_empty() || self.owner == Owner::Person {
            return Ok(());
        }
        let path = self.folder.root().join(Manifest::FILE);
        self.folder.place(self.folder.stage(&path, manifest.text().as_bytes())?, &path)
    }
}

/// Files by which a folder of results is kept in order.
const OWN: [&str; 2] = [Output::INCOMPLETE, Manifest::FILE];

/// What the file says that marks a folder, of a command and of a campaign.
const MARKS: [&str; 2] = [
    "Old and new results stand side by side here: run the same command again.\n",
    "Old and new results of a campaign stand side by side here: run it again.\n",
];

/// The name as one plain part of a path. A backslash or a colon would mean something else on another system, so both are refused.
fn checked(name: &str) -> Result<&Path> {
    let path = Path::new(name);
    let parts: Vec<Component<'_>> = path.components().collect();
    if !matches!(parts[..], [Component::Normal(_)]) || name.contains(['/', '\\', ':', '\0']) {
        return Err(unusable(name, "is no plain name"));
    }
    if name.starts_with(".vibro.") && name != Output::KEPT {
        return Err(unusable(name, "is kept for vibro itself"));
    }
    Ok(path)
}

fn unusable(name: &str, why: &str) -> Error {
    Error::usage(format!("the output name \"{name}\" {why}"), "a name such as response.svg")
}

#[cfg(test)]
mod tests;
