//! Writes names such that a terminal or a page shows them safely.

use std::path::Path;

/// Whether a character controls a terminal or a page instead of being shown: a control character, one that
/// changes the direction of writing (Unicode Standard Annex 9, section 2), or one that separates lines.
pub fn is_unprintable(c: char) -> bool {
    let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || turns
}

/// A path for people, on one line: control characters are shown as �.
pub fn shown(path: impl AsRef<Path>) -> String {
    let text = path.as_ref().to_string_lossy();
    text.chars().map(|c| if is_unprintable(c) { '\u{fffd}' } else { c }).collect()
}

/// A path as it is typed in a shell: between quotes where one of its characters needs them.
pub fn typed(path: impl AsRef<Path>) -> String {
    let text = shown(path);
    let splits = |c: char| c.is_whitespace() || "()[]{}<>;&|'`$!".contains(c);
    // Between double quotes a shell still interprets these.
    let read = ['$', '`', '!', '"', '\\'];
    if !text.contains(splits) && !text.contains('"') {
        text
    } else if text.contains(read) && !text.contains('\'') {
        format!("'{text}'")
    } else {
        format!("\"{text}\"")
    }
}

#[cfg(test)]
mod tests {
    use super::{shown, typed};

    #[test]
    fn a_name_stays_on_its_line_and_runs_one_way() {
        assert_eq!(shown("µ a\nb\u{202e}c.csv"), "µ a\u{fffd}b\u{fffd}c.csv");
    }

    /// For sh: single quotes protect everything between them, double quotes still leave `$` active.
    #[test]
    fn a_name_is_typed_so_that_a_shell_leaves_it_alone() {
        for (name, expected) in [
            ("a.csv", "a.csv"),
            ("Run 1.csv", "\"Run 1.csv\""),
            ("cost $5.csv", "'cost $5.csv'"),
            ("$HOME.csv", "'$HOME.csv'"),
            ("3\".csv", "'3\".csv'"),
            ("don't.csv", "\"don't.csv\""),
        ] {
            assert_eq!(typed(name), expected);
        }
    }
}
