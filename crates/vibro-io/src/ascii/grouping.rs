//! Numbers whose digits are grouped in threes: a mark in them may as well separate two numbers.

/// What to try where digits may be grouped; such numbers are not read.
pub const GROUPED: &str = "if a comma separates two numbers, give --decimal point; if digits are grouped in threes, export them without grouping";

/// Whether every row is one number with decimals, and some have their digits grouped in threes: `1.234,50` or `1,234.50`.
pub fn grouped(rows: &[(u64, usize, &[u8])]) -> bool {
    [(b'.', b','), (b',', b'.')].iter().any(|&(group, decimal)| {
        let groups: Option<Vec<usize>> = rows.iter().map(|row| groups(row.2, group, decimal)).collect();
        groups.is_some_and(|groups| groups.iter().any(|n| *n > 1))
    })
}

/// Number of groups of digits before the decimal mark; `None` where a line is no such number.
fn groups(line: &[u8], group: u8, decimal: u8) -> Option<usize> {
    let line = line.trim_ascii();
    let line = line.strip_prefix(b"-").or(line.strip_prefix(b"+")).unwrap_or(line);
    let at = line.iter().position(|b| *b == decimal)?;
    let digits = |text: &[u8]| !text.is_empty() && text.iter().all(u8::is_ascii_digit);
    let parts: Vec<&[u8]> = line[..at].split(|b| *b == group).collect();
    let first = parts[0];
    // Nobody groups `0.123`.
    let leads = (1..=3).contains(&first.len()) && digits(first) && (parts.len() == 1 || first[0] != b'0');
    let whole = leads && parts[1..].iter().all(|part| part.len() == 3 && digits(part));
    (whole && digits(&line[at + 1..])).then_some(parts.len())
}
