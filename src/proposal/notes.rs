//! What a person wrote down beside the recordings: lines that state a height, a mass or a sensitivity. They
//! are shown, and never used.

use crate::read::Folder;
use crate::record::shown;

/// Beginnings of the names of files of notes, in small letters.
const NAMES: [&str; 5] = ["readme", "note", "notiz", "liesmich", "lisez"];
/// Bytes of such a file, at most.
const LONGEST: u64 = 1 << 16;
/// Characters of a line that are shown.
const SHOWN: usize = 60;
/// What a line is about, and the words that say so.
const WORDS: [(&str, &[&str]); 3] =
    [("height", &["height"]), ("mass", &["mass", "kg"]), ("sensitivity", &["sensitivity", "mv/"])];

/// A line of notes that states a number.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(super) struct Note {
    /// File and line.
    pub place: String,
    /// The line.
    pub text: String,
}

impl Note {
    /// Lines of the notes of a folder that state what a key of a table may be.
    pub fn all(folder: &Folder) -> Vec<Note> {
        let is_notes = |name: &String| {
            let name = name.to_lowercase();
            NAMES.iter().any(|begin| name.starts_with(begin))
                && [".txt", ".md"].iter().any(|end| name.ends_with(end))
        };
        let of_file = |name: String| {
            let path = folder.root().join(&name);
            let short = folder.is_file(&path) && folder.stamp(&path).is_some_and(|stamp| stamp.0 <= LONGEST);
            let bytes = if short { folder.read(&path).unwrap_or_default() } else { Vec::new() };
            let text = String::from_utf8_lossy(&bytes).into_owned();
            let note = |(i, line): (usize, &str)| Note {
                place: format!("{}, line {}", shown(&name), i + 1),
                text: shown(line.trim().chars().take(SHOWN).collect::<String>()),
            };
            text.lines().enumerate().map(note).filter(Note::states).collect::<Vec<_>>()
        };
        folder.names().into_iter().filter(is_notes).flat_map(of_file).collect()
    }

    fn states(&self) -> bool {
        self.text.contains(|c: char| c.is_ascii_digit()) && WORDS.iter().any(|(key, _)| self.is_of(key))
    }

    /// Whether it is about a key of a table.
    pub fn is_of(&self, key: &str) -> bool {
        let text = self.text.to_lowercase();
        WORDS.iter().any(|(of, words)| *of == key && words.iter().any(|word| text.contains(word)))
    }
}
