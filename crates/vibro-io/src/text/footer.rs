//! Words behind the values of a text.

use super::shorten;
use crate::missing::LISTED;
use crate::number;
use vibro_record::Finding;

/// Fewer rows may be the head of a list of files.
const FEW: usize = 4;
/// How many lines may stand behind the values.
const MOST: usize = 16;

/// The last lines of a file, where they cannot be rows of numbers.
#[derive(Debug, PartialEq)]
pub struct Footer {
    lines: Vec<String>,
}

impl Footer {
    /// The footer of a file with `rows` rows of so many `columns`, if `rest`, the lines behind them, each with its fields,
    /// are one; `None` where they may hold values.
    ///
    /// A word in the place of a value is a bad value: no line has as many fields as a row, and none comes twice.
    pub fn of<'a>(
        rows: usize,
        columns: usize,
        rest: impl Iterator<Item = (&'a str, Vec<String>)>,
    ) -> Option<Footer> {
        let mut lines: Vec<String> = Vec::new();
        for (line, fields) in rest {
            let line = line.trim();
            if line.is_empty() || line == "\u{1a}" {
                continue;
            }
            if lines.len() == MOST || !is_words(&fields, columns) || lines.iter().any(|l| l == line) {
                return None;
            }
            lines.push(line.to_owned());
        }
        (rows >= FEW && !lines.is_empty()).then_some(Footer { lines })
    }

    /// What is to be said of it.
    pub fn finding(&self) -> Finding {
        let quoted: Vec<String> = self.lines.iter().map(|line| format!("{:?}", shorten(line))).collect();
        Finding::caution("words-behind-values").count("n", quoted.len()).name("lines", quoted.join(", "))
    }

    /// Whether it names files behind numbers that begin as the list of a sweep does: points, lines, base band.
    pub(crate) fn ends_list(&self, numbers: impl Iterator<Item = f64>) -> bool {
        let head: Vec<f64> = numbers.take(3).collect();
        let whole = |v: f64| v >= 1.0 && v.fract() == 0.0;
        matches!(head[..], [points, lines, band] if whole(points) && whole(lines) && band > 0.0)
            && self.names_files()
    }

    /// Whether a word of it looks like the name of a file: `RUP0001.DAT`.
    fn names_files(&self) -> bool {
        let is_name = |word: &str| {
            word.match_indices('.').any(|(at, _)| {
                let ending = &word[at + 1..];
                word[..at].ends_with(char::is_alphanumeric)
                    && ending.starts_with(char::is_alphabetic)
                    && ending.bytes().take_while(u8::is_ascii_alphanumeric).count() >= 3
            })
        };
        self.lines.iter().flat_map(|line| line.split_whitespace()).any(is_name)
    }
}

/// Whether a line of these fields is no row of so many columns, and begins with a word: what begins like a number may be one
/// that is cut off. Numbers may stand among words, but fewer than those.
fn is_words(fields: &[String], columns: usize) -> bool {
    // One value a line: several words in it are no value.
    let mut fields: Vec<&str> = if columns == 1 {
        fields.iter().flat_map(|f| f.split_whitespace()).collect()
    } else {
        fields.iter().map(String::as_str).collect()
    };
    let full = fields.len() == columns;
    // A separator behind the last value makes no further field.
    if fields.len() > 1 && fields.last().is_some_and(|f| f.is_empty()) {
        fields.pop();
    }
    let letters = |text: &str| text.chars().filter(|c| c.is_alphabetic()).count();
    let is_value = |field: &&&str| {
        let field = field.as_bytes();
        number::is_missing(field) || [b'.', b','].iter().any(|d| number::parse_with(field, *d).is_some())
    };
    let begin = fields.iter().find_map(|f| f.chars().find(|c| !"+-.,(".contains(*c)));
    let values = fields.iter().filter(is_value).count();
    let alike = fields.len() > 1 && fields.iter().all(|f| f == &fields[0]);
    !full
        && fields.len() != columns
        && !alike
        && begin.is_some_and(|c| !c.is_ascii_digit())
        && fields.first().is_some_and(|first| !is_value(&first))
        && fields.iter().map(|f| letters(f)).sum::<usize>() > 2
        && values < fields.len() - values
}

/// Which of the `lines` behind a word that is no number hold it, too: for a complaint.
pub fn again<L: AsRef<str>>(word: &str, lines: impl Iterator<Item = (u64, L)>) -> Option<String> {
    let holds = |line: &L| line.as_ref().split([' ', '\t', '\r', ',', ';', '"']).any(|w| w == word);
    let mut others = lines.filter(|(_, line)| holds(line)).map(|(number, _)| number.to_string());
    let first: Vec<String> = others.by_ref().take(LISTED).collect();
    let more = if others.next().is_some() { ", …" } else { "" };
    (!first.is_empty()).then(|| format!("also in line(s) {}{more}", first.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rows: usize, columns: usize, text: &str) -> Option<Footer> {
        let cut = |line: &str| line.split([' ', ';']).map(str::to_owned).collect();
        Footer::of(rows, columns, text.lines().map(|line| (line, cut(line))))
    }

    #[test]
    fn a_footer_is_words_that_are_no_row() {
        let found = of(4, 1, "End of data\n\n-- SPS390 --\n\u{1a}").unwrap().finding();
        assert_eq!(found.get("n"), Some(2.0));
        let quoted = vibro_record::Fact::Name("\"End of data\", \"-- SPS390 --\"".into());
        assert_eq!(found.fact("lines"), Some(&quoted));
        assert!(of(4, 1, "End of data: 5 values").is_some());
        assert!(of(4, 2, "End").is_some());
        // Three numbers and a name are a list of files.
        assert_eq!(of(3, 2, "F1.DAT"), None);
        let many = (0..17).map(|i| format!("line number {i}")).collect::<Vec<_>>().join("\n");
        assert_eq!(of(99, 1, &many), None);
    }

    #[test]
    fn what_may_be_a_value_is_none() {
        for text in [
            "1.096639e",
            "-1.2x",
            ".5x",
            "(-1.5e-2+j",
            "x",
            "End of data\n1.5",
            "sum 12",
            "NaN x y",
            "---",
            "",
            "a;1,5;2",
            "Overload",
            "OVL OVL",
            "over load\nover load",
        ] {
            assert_eq!(of(9, 1, text), None, "{text:?}");
        }
        for text in ["End of", "over;", "over;load;", "OVL 2", "OVL 2;", "Overload\nOverload", "OVL OVL OVL"]
        {
            assert_eq!(of(9, 2, text), None, "{text:?}");
        }
    }

    #[test]
    fn names_of_files_are_known() {
        let named = |text: &str| of(9, 9, text).is_some_and(|footer| footer.names_files());
        assert!(named("RUP0001.DATRUP0002.DAT") && named("A.DAT B.DAT") && named("in RUN_1.txt"));
        assert!(!named("End of data. Bye") && !named("mean 1.5 of all") && !named("No. 7 of nine"));
    }

    #[test]
    fn other_places_of_a_word_are_listed() {
        let lines = [(5, "1"), (6, "OVL"), (9, " OVL ")];
        assert_eq!(again("OVL", lines.into_iter()).as_deref(), Some("also in line(s) 6, 9"));
        assert_eq!(again("x", lines.into_iter()), None);
        let many = (1..20).map(|n| (n, "OVL"));
        assert!(again("OVL", many).unwrap().ends_with("7, 8, …"));
    }
}
