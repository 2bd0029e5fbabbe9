//! The variables of a MAT-file of level 4: each is five words, a name and numbers; the file has no header.
//!
//! Source: The `MathWorks`, "MAT-File Format", chapter 1, "Level 4 MAT-File Format".

use super::level5::{numbers, string};
use crate::variables::{Array, Content, MOST_TEXT};
use vibro_record::{Error, Place, Result, Values};

/// Kinds of numbers as in level 5, and their sizes in bytes: double, single, int32, int16, uint16, uint8.
const KINDS: [(u32, usize); 6] = [(9, 8), (7, 4), (5, 4), (3, 2), (4, 2), (2, 1)];

/// The words before a variable: the four digits of its type (machine; zero; kind of numbers; full, text or
/// sparse), then rows, columns, complex or not, and length of the name.
pub fn header(bytes: &[u8]) -> Option<([u32; 4], [u32; 4])> {
    let words: [[u8; 4]; 5] = bytes.as_chunks().0.get(..5)?.try_into().ok()?;
    let digits = |n: u32| [n / 1000, n / 100 % 10, n / 10 % 10, n % 10];
    let orders = [words.map(u32::from_le_bytes), words.map(u32::from_be_bytes)];
    let orders = orders.map(|[kind, rest @ ..]| (digits(kind), rest));
    orders.into_iter().find(|(kind, [_, _, complex, name])| {
        kind.iter().zip([4, 0, 5, 2]).all(|(digit, most)| *digit <= most)
            && *complex <= 1
            && (1..=64).contains(name)
    })
}

/// All variables with their names.
pub fn all(bytes: &[u8]) -> Result<Vec<(String, Content)>> {
    let (mut rest, mut variables) = (bytes, Vec::new());
    while !rest.is_empty() {
        let place = Place { byte: Some((bytes.len() - rest.len()) as u64), ..Place::default() };
        let damaged = || {
            let error =
                Error::input(place.clone(), "a variable that ends early", "a whole variable of level 4");
            error.hint("the file is damaged; copy or save it again")
        };
        let ([machine, _, kind, class], [rows, columns, parts, name]) = header(rest).ok_or_else(damaged)?;
        if machine > 1 {
            return Err(Error::input(place, "numbers of a VAX or a Cray", "those of IEEE 754")
                .hint("open it in MATLAB and save it again with -v7"));
        }
        let (kind, size) = KINDS[kind as usize];
        let (name, behind) = rest[20..].split_at_checked(name as usize).ok_or_else(damaged)?;
        let count = (rows as usize).checked_mul(columns as usize);
        let all = count.and_then(|n| n.checked_mul(size * (1 + parts as usize))).ok_or_else(damaged)?;
        let (values, behind) = behind.split_at_checked(all).ok_or_else(damaged)?;
        rest = behind;
        let content = match class {
            2 => Content::Other("sparse matrix"),
            1 if rows > 1 || values.len() > MOST_TEXT * size => {
                Content::Other("char array of several rows or more than 4096 characters")
            }
            _ => {
                let mut values = numbers(kind, values, machine == 1).unwrap_or_default();
                if class == 1 {
                    Content::Text(values.into_iter().map(|letter| char::from(letter as u8)).collect())
                } else {
                    let imaginary = (parts == 1).then(|| values.split_off(values.len() / 2));
                    let dimensions = vec![rows.into(), columns.into()];
                    let values = Values::of(values, imaginary).into();
                    Content::Array(Array { dimensions, values, single: kind == 7 })
                }
            }
        };
        variables.push((string(name), content));
    }
    Ok(variables)
}
