//! Names of columns in the last header line, with their units.

use super::layout::{Layout, Separator};
use super::stated;
use crate::csv::name::{Name, is_unit_row};
use vibro_record::AxisKind;

/// One name a column, where the last header line can be cut into as many; a second line may hold the units.
pub fn of(layout: &Layout) -> Option<Vec<Name>> {
    let mut spoken = layout.header.iter().rev().map(|(_, line)| line.as_str());
    let last = fields(spoken.next()?, layout)?;
    if is_unit_row(last.iter().map(String::as_str))
        && let Some(upper) = spoken.next().and_then(|line| fields(line, layout))
    {
        return Some(upper.iter().zip(&last).map(|(name, unit)| Name::with_unit_row(name, unit)).collect());
    }
    let names: Vec<Name> = last.iter().map(|field| Name::parse(field)).collect();
    // A lone title is no name of a column, unless it states the unit.
    let sure = layout.columns > 1 || (names[0].unit.is_some() && last[0].ends_with([']', ')']));
    sure.then_some(names)
}

/// The fields of a line, as many as there are columns: cut as the rows are, else at tabs or wide gaps, else at single blanks.
fn fields(line: &str, layout: &Layout) -> Option<Vec<String>> {
    if !stated::split(line).0.is_empty() || !line.contains(char::is_alphabetic) {
        return None;
    }
    let fit = |fields: Vec<String>| (fields.len() == layout.columns && are_words(&fields)).then_some(fields);
    let cut = |at: &str| -> Vec<String> {
        line.split(at).map(|f| f.trim().to_owned()).filter(|f| !f.is_empty()).collect()
    };
    if layout.columns == 1 {
        return Some(vec![line.trim().to_owned()]);
    }
    if let Separator::Char(mark) = layout.separator
        && let Some(fields) = fit(cut(char::from(mark).to_string().as_str()))
    {
        return Some(fields);
    }
    fit(cut("\t")).or_else(|| fit(cut("  "))).or_else(|| fit(words(line)).filter(|f| are_names(f)))
}

/// Whether no field is a number, a date or a clock; one that ends with a unit may begin with a digit.
fn are_words(fields: &[String]) -> bool {
    let digit = |f: &String| f.starts_with(|c: char| c.is_ascii_digit()) && !f.ends_with([']', ')']);
    !fields.iter().any(|f| digit(f) || f.contains(':'))
}

/// Words between single blanks; a bracket belongs to the word before it.
fn words(line: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut open = false;
    for word in line.split_whitespace() {
        match out.last_mut() {
            Some(last) if open || word.starts_with(['[', '(']) => {
                last.push(' ');
                last.push_str(word);
            }
            _ => out.push(word.to_owned()),
        }
        let count = |marks: [char; 2]| word.matches(marks).count();
        open = if open { count([']', ')']) == 0 } else { count(['[', '(']) > count([']', ')']) };
    }
    out
}

/// Whether words between single blanks may name columns: the first is an abscissa, or one has a bracket.
fn are_names(words: &[String]) -> bool {
    let units = words.iter().any(|w| w.ends_with([']', ')']));
    let axis: Option<AxisKind> = words.first().and_then(|w| Name::parse(w).axis(true));
    units || axis.is_some()
}
