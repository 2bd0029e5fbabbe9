//! The list of files that vibro wrote into a folder.

use super::{Digest, Folder};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Files that vibro wrote into a folder, with the SHA-256 of each as written. The list is stored in the
/// folder as [`Manifest::FILE`], in lines that `sha256sum -c` reads:
///
/// ```text
/// # Files that vibro wrote here, as it left them. A file changed since is never replaced.
/// # run
/// e3b0c44298fc1c14…  report.html
/// # results
/// 9f86d081884c7d65…  spectrum.csv
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Manifest(BTreeSet<(Owner, String, Digest)>);

/// The role in which a file was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Owner {
    /// The results of a campaign: the next run replaces them all, and removes what it does not write again.
    Run,
    /// Figures and tables of one command.
    Results,
    /// Recordings that were converted or generated: input of further commands.
    Recordings,
    /// A file for the user to change. It is not listed, so nothing replaces it.
    Person,
}

impl Owner {
    const ALL: [(Owner, &str); 3] =
        [(Owner::Run, "run"), (Owner::Results, "results"), (Owner::Recordings, "recordings")];
}

const HEAD: &str =
    "# Files that vibro wrote here, as it left them. A file changed since is never replaced.\n";

impl Manifest {
    /// Name of the file that holds the list.
    pub const FILE: &str = ".vibro.sha256";

    /// The list of a folder; empty if there is none, or if vibro did not write the file of that name.
    pub fn of(folder: &Folder) -> Manifest {
        let bytes = folder.own_file(Manifest::FILE).unwrap_or_default();
        Manifest::parse(&String::from_utf8(bytes).unwrap_or_default())
    }

    /// Whether the folder has a file of that name that vibro wrote.
    pub fn is_of(folder: &Folder) -> bool {
        folder.own_file(Manifest::FILE).is_some_and(|bytes| bytes.starts_with(HEAD.as_bytes()))
    }

    fn parse(text: &str) -> Manifest {
        let (mut manifest, mut owner) = (Manifest::default(), None);
        for line in text.strip_prefix(HEAD).unwrap_or_default().lines() {
            if let Some(heading) = line.strip_prefix("# ") {
                owner = Owner::ALL.iter().find(|(_, name)| *name == heading).map(|(owner, _)| *owner);
            } else if let Some((owner, (digest, name))) = owner.zip(unlisted(line)) {
                manifest.add(owner, name, digest);
            }
        }
        manifest
    }

    /// The list as the text that [`Manifest::FILE`] holds.
    pub fn text(&self) -> String {
        let (mut text, mut owner) = (HEAD.to_owned(), None);
        for (of, name, digest) in &self.0 {
            if owner.replace(of) != Some(of) {
                let heading =
                    Owner::ALL.iter().find(|(owner, _)| owner == of).map_or("", |(_, heading)| heading);
                let _ = writeln!(text, "# {heading}");
            }
            text += &listed(digest, name);
        }
        text
    }

    /// Known digests of a file of this name, written as a recording if `recording`, else as a result.
    fn held_by(&self, recording: bool, name: &str) -> impl Iterator<Item = &Digest> {
        let owners: &[Owner] = if recording { &[Owner::Recordings] } else { &[Owner::Run, Owner::Results] };
        let of = |owner: &Owner| {
            (*owner, name.to_owned(), Digest::default())..=(*owner, name.to_owned(), [255; 32])
        };
        owners.iter().flat_map(move |owner| self.0.range(of(owner))).map(|(.., digest)| digest)
    }

    /// Whether a file of this name was written as a result.
    pub fn is_result(&self, name: &str) -> bool {
        self.held_by(false, name).next().is_some()
    }

    /// Whether vibro wrote a file of this name and content: as a recording for [`Owner::Recordings`], else
    /// as a result.
    pub fn knows(&self, owner: Owner, name: &str, digest: &Digest) -> bool {
        self.held_by(owner == Owner::Recordings, name).any(|known| known == digest)
    }

    /// Adds a file. Digests already known for its name are kept.
    pub fn add(&mut self, owner: Owner, name: impl Into<String>, digest: Digest) {
        if owner != Owner::Person {
            self.0.insert((owner, name.into(), digest));
        }
    }

    /// Removes a name from the list.
    pub fn forget(&mut self, name: &str) {
        self.0.retain(|(_, known, _)| known != name);
    }

    /// Files of one owner with their digests; a file with several known digests comes several times.
    pub fn owned(&self, owner: Owner) -> impl Iterator<Item = (&str, &Digest)> {
        self.0.iter().filter(move |(of, ..)| *of == owner).map(|(_, name, digest)| (name.as_str(), digest))
    }
}

/// The line of a file as `sha256sum` writes it. Line breaks and backslashes in a name are escaped; a
/// backslash before the digest marks that.
pub fn listed(digest: &Digest, name: &str) -> String {
    let escaped = name.replace('\\', "\\\\").replace('\n', "\\n").replace('\r', "\\r");
    let mark = if escaped == name { "" } else { "\\" };
    format!("{mark}{}  {escaped}\n", hexadecimal(digest))
}

/// A digest as 64 hexadecimal digits.
pub fn hexadecimal(digest: &Digest) -> String {
    digest.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Digest and name of a line that [`listed`] made.
fn unlisted(line: &str) -> Option<(Digest, String)> {
    let (escaped, line) = line.strip_prefix('\\').map_or((false, line), |rest| (true, rest));
    let (hex, name) = line.split_once("  ")?;
    let byte = |i: usize| u8::from_str_radix(hex.get(2 * i..2 * i + 2)?, 16).ok();
    let mut digest = Digest::default();
    for (i, place) in digest.iter_mut().enumerate() {
        *place = byte(i)?;
    }
    let plain = |part: &str| part.replace("\\n", "\n").replace("\\r", "\r");
    let name =
        if escaped { name.split("\\\\").map(plain).collect::<Vec<_>>().join("\\") } else { name.to_owned() };
    (hex.len() == 64).then_some((digest, name))
}
