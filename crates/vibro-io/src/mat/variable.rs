//! The variables of a MAT-file: elements of kind, size and content, padded to eight bytes.
//!
//! Source: The `MathWorks`, "MAT-File Format", chapter 1, "Level 5 MAT-File Format".

use flate2::read::ZlibDecoder;
use num_complex::Complex64;
use std::io::Read;
use vibro_record::{Error, Place, Result, Values};

/// Longest text that is kept.
const MOST_TEXT: u64 = 4096;

/// What a variable holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    Array(Array),
    Text(String),
    /// Of a class that is passed over, by its name.
    Other(&'static str),
}

/// Numbers, column by column.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    pub dimensions: Vec<u64>,
    pub values: Values,
    /// Whether values have the precision of 32-bit floats only.
    pub single: bool,
}

/// Elements one after the other.
struct Elements<'a> {
    rest: &'a [u8],
    big_endian: bool,
    /// Where the variable stands in the file.
    place: Place,
}

impl<'a> Elements<'a> {
    fn fault(&self, found: impl Into<String>, expected: &str) -> Error {
        Error::input(self.place.clone(), found, expected).hint("the file is damaged; copy or save it again")
    }

    /// An unsigned word in the file's order.
    fn word(&self, bytes: [u8; 4]) -> u32 {
        if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
    }

    fn words(&self, bytes: &[u8]) -> impl Iterator<Item = u32> {
        bytes.as_chunks().0.iter().map(|b| self.word(*b))
    }

    /// Kind and content of the next element; `None` behind the last.
    fn next(&mut self) -> Result<Option<(u32, &'a [u8])>> {
        if self.rest.is_empty() {
            return Ok(None);
        }
        let ends_early = |there: usize, declared: u32| {
            let found = format!("a variable that ends early: {there} of {declared} bytes are there");
            self.fault(found, "as many bytes as it declares")
        };
        let Some(([a, b, c, d, small @ ..], behind)) = self.rest.split_first_chunk::<8>() else {
            return Err(ends_early(self.rest.len(), 8));
        };
        let word = self.word([*a, *b, *c, *d]);
        if word >> 16 != 0 {
            // The content of a small element stands in its tag.
            let size = (word >> 16) as usize;
            let content = self.rest[4..8].get(..size).ok_or_else(|| ends_early(4, word >> 16))?;
            self.rest = behind;
            return Ok(Some((word & 0xffff, content)));
        }
        let size = self.word(*small);
        let content = behind.get(..size as usize).ok_or_else(|| ends_early(behind.len(), size))?;
        // What is packed is not padded.
        let padded = if word == 15 { content.len() } else { content.len().next_multiple_of(8) };
        self.rest = behind.get(padded..).unwrap_or_default();
        Ok(Some((word, content)))
    }

    /// The content of an element that a variable must have.
    fn part(&mut self, what: &str) -> Result<(u32, &'a [u8])> {
        self.next()?
            .ok_or_else(|| self.fault(format!("a variable that ends early, without its {what}"), what))
    }

    /// The next element as `count` numbers; integers beyond 2⁵³ are rounded.
    fn numbers(&mut self, count: u64) -> Result<Vec<f64>> {
        fn of<const N: usize>(bytes: &[u8], big_endian: bool, value: fn([u8; N]) -> f64) -> Vec<f64> {
            let little = |b: &[u8; N]| std::array::from_fn(|i| if big_endian { b[N - 1 - i] } else { b[i] });
            bytes.as_chunks().0.iter().map(|b| value(little(b))).collect()
        }
        let (kind, bytes) = self.part("values")?;
        let big = self.big_endian;
        let values = match kind {
            1 => of(bytes, big, |b| f64::from(i8::from_le_bytes(b))),
            2 => of(bytes, big, |b| f64::from(u8::from_le_bytes(b))),
            3 => of(bytes, big, |b| f64::from(i16::from_le_bytes(b))),
            4 => of(bytes, big, |b| f64::from(u16::from_le_bytes(b))),
            5 => of(bytes, big, |b| f64::from(i32::from_le_bytes(b))),
            6 => of(bytes, big, |b| f64::from(u32::from_le_bytes(b))),
            7 => of(bytes, big, |b| f64::from(f32::from_le_bytes(b))),
            9 => of(bytes, big, f64::from_le_bytes),
            12 => of(bytes, big, |b| i64::from_le_bytes(b) as f64),
            13 => of(bytes, big, |b| u64::from_le_bytes(b) as f64),
            kind => return Err(self.fault(format!("values of kind {kind}"), "integers or floats")),
        };
        if values.len() as u64 != count {
            let found = format!("a variable that declares {count} values and holds {}", values.len());
            return Err(self.fault(found, "as many values as its dimensions say"));
        }
        Ok(values)
    }
}

/// All variables of a file behind its header, with their names.
pub fn all(bytes: &[u8], header: usize, big_endian: bool) -> Result<Vec<(String, Content)>> {
    let mut variables = Vec::new();
    let mut file = Elements { rest: &bytes[header..], big_endian, place: Place::default() };
    loop {
        file.place.byte = Some((bytes.len() - file.rest.len()) as u64);
        let Some((kind, content)) = file.next()? else { return Ok(variables) };
        let within = |rest| Elements { rest, big_endian, place: file.place.clone() };
        let mut inflated = Vec::new();
        let content = match kind {
            14 => content,
            15 => {
                // No element is larger than its size can say.
                let done = ZlibDecoder::new(content).take(u64::from(u32::MAX)).read_to_end(&mut inflated);
                done.map_err(|e| {
                    file.fault(format!("a variable that cannot be unpacked: {e}"), "intact data")
                })?;
                within(&inflated).part("variable")?.1
            }
            _ => continue,
        };
        variables.push(variable(&mut within(content))?);
    }
}

/// Name and content of a matrix element.
fn variable(elements: &mut Elements) -> Result<(String, Content)> {
    let (_, flags) = elements.part("flags")?;
    let flags = elements.words(flags).next().unwrap_or(0);
    let class = flags & 0xff;
    let (complex, logical) = (flags & 0x800 != 0, flags & 0x200 != 0);
    if class == 17 {
        // An object of the newer kind has no dimensions; what follows is not documented.
        return Ok((String::new(), Content::Other("object")));
    }
    let (_, dimensions) = elements.part("dimensions")?;
    let dimensions: Vec<u64> = elements.words(dimensions).map(u64::from).collect();
    let (_, name) = elements.part("name")?;
    let name = String::from_utf8_lossy(name).trim_end_matches('\0').to_owned();
    let product = dimensions.iter().try_fold(1u64, |n, d| n.checked_mul(*d));
    let Some(count) = product.filter(|_| dimensions.len() >= 2) else {
        return Err(elements.fault(format!("{name:?} with dimensions {dimensions:?}"), "a countable array"));
    };
    let content = match class {
        _ if logical => Content::Other("logical array"),
        4 if count == 0 => Content::Text(String::new()),
        4 if dimensions[0] != 1 || count > MOST_TEXT => {
            Content::Other("char array of several rows or more than 4096 characters")
        }
        4 => Content::Text(text(elements)?),
        6..=15 => {
            let real = elements.numbers(count)?;
            let values = if complex {
                let pairs = real.into_iter().zip(elements.numbers(count)?);
                Values::Complex(pairs.map(|(re, im)| Complex64::new(re, im)).collect())
            } else {
                Values::Real(real)
            };
            Content::Array(Array { dimensions, values, single: class == 7 })
        }
        1 => Content::Other("cell array"),
        2 => Content::Other("struct"),
        3 => Content::Other("object"),
        5 => Content::Other("sparse matrix"),
        16 => Content::Other("function"),
        other => return Err(elements.fault(format!("{name:?} of class {other}"), "a class from 1 to 17")),
    };
    Ok((name, content))
}

fn text(elements: &mut Elements) -> Result<String> {
    let (kind, bytes) = elements.part("text")?;
    if !matches!(kind, 4 | 17) {
        return Ok(String::from_utf8_lossy(bytes).into_owned());
    }
    let unit = if elements.big_endian { u16::from_be_bytes } else { u16::from_le_bytes };
    let units: Vec<u16> = bytes.as_chunks().0.iter().map(|b| unit(*b)).collect();
    Ok(String::from_utf16_lossy(&units))
}
