//! Names of columns in the last header line above the rows. Units are in a line of their own or after each
//! name.

use super::header;
use super::lines::Separator;
use super::names::Name;
use super::unit_words::is_unit_row;
use crate::number;

/// Names of the columns, if the last header line can be cut into as many cells. That line may also hold the
/// units of the names in the line above it.
pub fn above(header: &[String], columns: usize, separator: Separator) -> Option<Vec<Name>> {
    let mut spoken = header.iter().rev().map(|line| cut(line, columns, separator));
    let last = spoken.next()??;
    if is_unit_row(last.iter().map(String::as_str))
        && let Some(Some(upper)) = spoken.next()
    {
        return Some(upper.iter().zip(&last).map(|(name, unit)| Name::with_unit_row(name, unit)).collect());
    }
    let names: Vec<Name> = last.iter().map(|field| Name::parse(field)).collect();
    // A line above a single column is a title, not a name, unless it ends with a unit in brackets.
    let sure = columns > 1 || (names[0].unit.is_some() && last[0].ends_with([']', ')']));
    sure.then_some(names)
}

/// Cuts a header line into as many names as there are columns: at the separator of the rows, else at tabs,
/// at two blanks, or at single blanks. `None` if none of these gives that number.
fn cut(line: &str, columns: usize, separator: Separator) -> Option<Vec<String>> {
    if !header::split(line).0.is_empty() || !line.contains(char::is_alphabetic) {
        return None;
    }
    // A field with a decimal number or a time is not a name. A name may begin with a digit only if it ends
    // with a bracket.
    let decimal = |word: &str| word.contains('.') && number::parse(word.as_bytes()).is_some();
    let odd = |f: &String| {
        let begins = f.starts_with(|c: char| c.is_ascii_digit()) && !f.ends_with([']', ')']);
        f.contains(':') || begins || f.split(' ').any(decimal)
    };
    let fit = |fields: Vec<String>| (fields.len() == columns && !fields.iter().any(odd)).then_some(fields);
    let split = |at: &str| -> Vec<String> {
        line.split(at).map(|f| f.trim().to_owned()).filter(|f| !f.is_empty()).collect()
    };
    if columns == 1 {
        return Some(vec![line.trim().to_owned()]);
    }
    if let Separator::Char(mark) = separator
        && let Some(fields) = fit(split(char::from(mark).to_string().as_str()))
    {
        return Some(fields);
    }
    // A bracket belongs to the word before it. Words between single blanks are free text, unless the first
    // word names an abscissa or a word has a unit in brackets.
    let words = line.replace(" [", "[").replace(" (", "(");
    let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
    let units = words.iter().any(|w| w.ends_with([']', ')']));
    let sure = units || words.first().is_some_and(|w| Name::parse(w).axis(true).is_some());
    fit(split("\t")).or_else(|| fit(split("  "))).or_else(|| fit(words).filter(|_| sure))
}
