//! Columns of words beside columns of numbers: the name of a frame, the address of a sensor, a state.

use super::clock;
use super::decoded::{Text, in_line, shorten};
use super::encoding;
use super::lines::{Line, Lines, Separator, fields};
use crate::{Source, number};
use vibro_record::{Error, Finding, Result};

/// Rows that tell which columns hold words.
const ENOUGH: usize = 24;

/// The text without the columns that hold the same word in every row, and what is said of them; `None` where
/// columns of words are not what keeps it from being read.
///
/// # Errors
/// If the words of a column change: rows of several channels or sensors may stand below each other.
pub fn left_out(text: &Text) -> Result<Option<(Source, Finding)>> {
    let lines = |text| Lines::new(text, 0, 1, &["#", "%"]).filter(|line| !line.is_blank());
    let head: Vec<Line> = lines(&text.head).filter(|line| line.remark.is_none()).collect();
    let Some((separator, first, words)) = columns(&head) else {
        return Ok(None);
    };
    let bytes = text.source.all()?;
    let whole = encoding::decode(&bytes);
    let (mut names, mut said) = (Vec::new(), vec![None; words.len()]);
    let (mut kept, mut ended) = (String::with_capacity(whole.len()), 1);
    for line in lines(&whole) {
        let cells = fields(line.text, separator).unwrap_or_default();
        // Line numbers stay those of the file.
        kept.extend((ended..line.number).map(|_| '\n'));
        ended = line.number;
        if cells.len() != words.len() || line.remark.is_some() && line.number > first {
            kept += line.text;
            continue;
        }
        if line.number < first {
            names = cells.iter().map(|(_, name)| name.clone().into_owned()).collect();
        } else {
            for (i, (at, cell)) in cells.iter().enumerate().filter(|(i, _)| words[*i]) {
                let known: &mut Option<String> = &mut said[i];
                let before = known.get_or_insert_with(|| cell.clone().into_owned());
                if before != cell {
                    let found = format!("{:?} below {:?}", shorten(cell), shorten(before));
                    let place = in_line(line.number).column(line.column(*at));
                    return Err(Error::input(place, found, "numbers, or one word in all rows of a column")
                        .hint("write the rows of each word to a file of their own, or take out the column"));
                }
            }
        }
        let mark = if let Separator::Char(mark) = separator { char::from(mark) } else { ' ' };
        for (i, (at, _)) in cells.iter().enumerate().filter(|(i, _)| !words[*i]) {
            let end = cells.get(i + 1).map_or(line.text.len(), |(next, _)| *next);
            kept.push_str(line.text[*at..end].trim_end_matches([mark, ' ']));
            kept.push(mark);
        }
        kept.truncate(kept.len() - 1);
    }
    kept.push('\n');
    let named = |(i, word): (usize, Option<String>)| {
        let name = names.get(i).filter(|name: &&String| !name.is_empty()).cloned();
        word.filter(|word| word.contains(char::is_alphanumeric)).map(|word| {
            format!("{} ({})", name.unwrap_or_else(|| format!("column {}", i + 1)), shorten(&word))
        })
    };
    let listed: Vec<String> = said.into_iter().enumerate().filter_map(named).collect();
    let found = Finding::note("columns-of-words").name("columns", listed.join(", "));
    Ok(Some((Source::memory(text.source.path(), kept.into_bytes())?, found)))
}

/// Separator, line of the first row, and which columns hold words, where all rows at the end of the first
/// lines have as many cells, the same of them numbers.
fn columns(lines: &[Line]) -> Option<(Separator, u64, Vec<bool>)> {
    let cut = |line: &Line, separator| fields(line.text, separator).unwrap_or_default().len();
    let marks = [b'\t', b';', b','].map(Separator::Char).into_iter().chain([Separator::Blank]);
    let separator = marks.into_iter().find(|mark| lines.last().is_some_and(|last| cut(last, *mark) > 1))?;
    let of = |line: &Line| -> Option<Vec<bool>> {
        fields(line.text, separator).ok()?.iter().map(|(_, cell)| is_word(cell)).collect()
    };
    let words = of(lines.last()?)?;
    let rows = lines.iter().rev().take_while(|line| of(line).as_ref() == Some(&words)).count();
    let told = rows > 1 && rows >= ENOUGH.min(lines.len() / 2);
    (told && words.contains(&true) && words.contains(&false))
        .then(|| (separator, lines[lines.len() - rows].number, words))
}

/// Whether a cell is a word, and no number, no time and not blank; `None` where it is neither, such as `1.5
/// V`.
fn is_word(cell: &str) -> Option<bool> {
    let bytes = cell.as_bytes();
    let value = number::either(bytes).is_some() || number::is_missing(bytes) || clock::is_clock(cell);
    let inner = cell.trim_start_matches(['(', '[', '"']).as_bytes();
    let begins = number::prefix(inner, b'.').is_some() && !cell.starts_with("0x");
    if value { Some(false) } else { (!begins).then_some(true) }
}
