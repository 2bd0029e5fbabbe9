//! The two lines that open a data set: `-1` in columns 5 and 6, then the number of the set in columns 1 to 6.

/// Number of a data set, and whether its values are binary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Number {
    /// E.g. 58.
    pub number: u32,
    /// Whether a `b` follows the number.
    pub binary: bool,
}

/// Whether a line opens or closes a data set: `-1` within the first six columns, and nothing else.
///
/// A `-1` further to the right is a value: some writers print whole numbers without a decimal point.
pub(crate) fn is_delimiter(line: &[u8]) -> bool {
    let blanks = line.iter().take_while(|b| **b == b' ').count();
    blanks <= 4 && line.trim_ascii() == b"-1"
}

/// The number on the line behind an opening `-1`; `None` where the line is something else.
pub(crate) fn set_number(line: &[u8]) -> Option<Number> {
    let start = line.iter().position(|b| *b != b' ')?;
    let digits = line[start..].iter().take_while(|b| b.is_ascii_digit()).count();
    let end = start + digits;
    let rest = &line[end..];
    let binary = matches!(rest.first(), Some(b'b' | b'B'));
    let behind = if binary { rest.get(1).copied() } else { rest.first().copied() };
    let separate = behind.is_none_or(|b| b.is_ascii_whitespace());
    if digits == 0 || end > 6 || !separate || (!binary && !rest.trim_ascii().is_empty()) {
        return None;
    }
    let number = line[start..end].iter().fold(0, |n, d| n * 10 + u32::from(d - b'0'));
    Some(Number { number, binary })
}

/// Whether `bytes`, which stand behind binary values, begin with a closing `-1`, alone or behind one line end.
///
/// It must stand in its very columns: values are searched for it, and looser forms would be found in the wrong place.
pub fn closes(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\r").unwrap_or(bytes);
    let bytes = bytes.strip_prefix(b"\n").unwrap_or(bytes);
    let end = bytes.iter().position(|b| *b == b'\n').unwrap_or(bytes.len());
    bytes[..end].strip_prefix(b"    -1").is_some_and(|rest| rest.trim_ascii().is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_line_of_its_own_ends_a_set() {
        for line in ["    -1", "    -1   \r", "-1", "   -1 \t"] {
            assert!(is_delimiter(line.as_bytes()), "{line:?}");
        }
        for line in ["", "Test run -1", "    -1    0", "           -1", "    -1.0", "   -10", "    1"] {
            assert!(!is_delimiter(line.as_bytes()), "{line:?}");
        }
    }

    #[test]
    fn set_numbers() {
        let number = |text: &str| set_number(text.as_bytes()).map(|n| (n.number, n.binary));
        assert_eq!(number("    58"), Some((58, false)));
        assert_eq!(number("    58   \r"), Some((58, false)));
        assert_eq!(number("  2411"), Some((2411, false)));
        assert_eq!(number("58"), Some((58, false)));
        assert_eq!(number("    58b     1     2          11        6408"), Some((58, true)));
        for text in ["", "    -1", "        58", "    58  7", "    58bx", "  1.5", "    b", "1234567"] {
            assert_eq!(number(text), None, "{text:?}");
        }
    }

    #[test]
    fn a_closing_line_may_stand_behind_a_line_end_that_should_not_be_there() {
        assert!(closes(b"    -1\r\n    -1"));
        assert!(closes(b"\r\n    -1"));
        assert!(closes(b"\n    -1  \n"));
        assert!(!closes(b"\n\n    -1"));
        assert!(!closes(b"\x00    -1"));
        assert!(!closes(b"   -1\n"));
        assert!(!closes(b""));
    }
}
