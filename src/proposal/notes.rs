//! Notes beside the recordings: lines that state a height, a mass or a sensitivity. They are shown beside
//! the keys and never used as values.

use crate::read::Folder;
use crate::record::shown;

/// Beginnings of the names of note files, in lower case.
const NAME_BEGINNINGS: [&str; 5] = ["readme", "note", "notiz", "liesmich", "lisez"];
/// Largest size of a note file in bytes.
const MOST_BYTES: u64 = 1 << 16;
/// Characters shown of a line.
const SHOWN_CHARACTERS: usize = 60;
/// Keys that a line may state, with the words that indicate each.
const KEY_WORDS: [(&str, &[&str]); 3] =
    [("height", &["height"]), ("mass", &["mass", "kg"]), ("sensitivity", &["sensitivity", "mv/"])];

/// A line of notes that states a number.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(super) struct Note {
    /// File name and line number.
    pub place: String,
    /// Text of the line.
    pub text: String,
}

impl Note {
    /// Lines of the notes of a folder that may state the value of a key.
    pub fn all(folder: &Folder) -> Vec<Note> {
        let is_notes = |name: &String| {
            let name = name.to_lowercase();
            NAME_BEGINNINGS.iter().any(|begin| name.starts_with(begin))
                && [".txt", ".md"].iter().any(|end| name.ends_with(end))
        };
        let of_file = |name: String| {
            let path = folder.root().join(&name);
            let short =
                folder.is_file(&path) && folder.stamp(&path).is_some_and(|stamp| stamp.0 <= MOST_BYTES);
            let bytes = if short { folder.read(&path).unwrap_or_default() } else { Vec::new() };
            let text = String::from_utf8_lossy(&bytes).into_owned();
            let note = |(i, line): (usize, &str)| Note {
                place: format!("{}, line {}", shown(&name), i + 1),
                text: shown(line.trim().chars().take(SHOWN_CHARACTERS).collect::<String>()),
            };
            text.lines().enumerate().map(note).filter(Note::states_a_value).collect::<Vec<_>>()
        };
        folder.names().into_iter().filter(is_notes).flat_map(of_file).collect()
    }

    /// Whether the line has a number and a word for a key.
    fn states_a_value(&self) -> bool {
        self.text.contains(|c: char| c.is_ascii_digit()) && KEY_WORDS.iter().any(|(key, _)| self.is_of(key))
    }

    /// Whether the line is about this key.
    pub fn is_of(&self, key: &str) -> bool {
        let text = self.text.to_lowercase();
        KEY_WORDS.iter().any(|(name, words)| *name == key && words.iter().any(|word| text.contains(word)))
    }
}
