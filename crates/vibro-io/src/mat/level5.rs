//! The variables of a MAT-file of level 5: elements of kind, size and content, padded to eight bytes.
//!
//! Source: The `MathWorks`, "MAT-File Format", chapter 1, "Level 5 MAT-File Format".

use crate::binary::NumberType;
use crate::options::Options;
use crate::variables::{Array, Content, MOST_TEXT};
use flate2::read::ZlibDecoder;
use std::io::Read;
use vibro_record::{Error, Place, Result, Values};

/// Bytes before the first variable; the last two are IM (little endian) or MI (big endian).
const HEADER: usize = 128;
/// Most bytes that zlib unpacks from one byte: it needs at least two bits for 258 bytes.
const MOST_UNPACKED: u64 = 1032;
/// Deepest nesting of structs and cell arrays, and longest name in bytes, that are read. Both limit the
/// memory that one byte of a file can take.
const MOST_DEPTH: usize = 32;
const MOST_NAME: usize = 512;

/// A sequence of elements.
struct Elements<'a> {
    rest: &'a [u8],
    big_endian: bool,
    /// Place of the variable in the file, for errors.
    place: Place,
}

impl<'a> Elements<'a> {
    fn fault(&self, found: impl Into<String>, expected: &str) -> Error {
        Error::input(self.place.clone(), found, expected).hint("the file is damaged; copy or save it again")
    }

    /// An unsigned word in the file's byte order.
    fn word(&self, bytes: [u8; 4]) -> u32 {
        if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
    }

    /// The elements inside the content of an element.
    fn within<'b>(&self, rest: &'b [u8]) -> Elements<'b> {
        Elements { rest, big_endian: self.big_endian, place: self.place.clone() }
    }

    fn words(&self, bytes: &[u8]) -> impl Iterator<Item = u32> {
        bytes.as_chunks().0.iter().map(|b| self.word(*b))
    }

    /// Kind and content of the next element; `None` after the last.
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
            // The content of a small element is stored in its tag.
            let size = (word >> 16) as usize;
            let content = self.rest[4..8].get(..size).ok_or_else(|| ends_early(4, word >> 16))?;
            self.rest = behind;
            return Ok(Some((word & 0xffff, content)));
        }
        let size = self.word(*small);
        let content = behind.get(..size as usize).ok_or_else(|| ends_early(behind.len(), size))?;
        // A compressed element is not padded.
        let padded = if word == 15 { content.len() } else { content.len().next_multiple_of(8) };
        self.rest = behind.get(padded..).unwrap_or_default();
        Ok(Some((word, content)))
    }

    /// The content of an element that is required in a variable.
    fn part(&mut self, what: &str) -> Result<(u32, &'a [u8])> {
        self.next()?
            .ok_or_else(|| self.fault(format!("a variable that ends early, without its {what}"), what))
    }

    /// The next element as `count` numbers; integers beyond 2⁵³ are rounded.
    fn numbers(&mut self, count: u64) -> Result<Vec<f64>> {
        let (kind, bytes) = self.part("values")?;
        let values = numbers(kind, bytes, self.big_endian)
            .ok_or_else(|| self.fault(format!("values of kind {kind}"), "integers or floats"))?;
        if values.len() as u64 != count {
            let found = format!("a variable that declares {count} values and holds {}", values.len());
            return Err(self.fault(found, "as many values as its dimensions say"));
        }
        Ok(values)
    }
}

/// Numbers of an element of this kind; `None` for a kind without numbers.
pub fn numbers(kind: u32, bytes: &[u8], big: bool) -> Option<Vec<f64>> {
    let kind = NumberType::coded(kind, [1, 3, 5, 12, 2, 4, 6, 13, 7, 9])?;
    let (width, mut values) = (kind.size() as usize, Vec::new());
    kind.take(bytes, 0, width, big, &mut values);
    Some(values)
}

/// All variables of a file after its header, with their names. Members of structs and cell arrays are named
/// as MATLAB writes them.
pub fn all(bytes: &[u8], options: &Options) -> Result<Vec<(String, Content)>> {
    let mut held = 0.0;
    let mut variables = Vec::new();
    let mut file =
        Elements { rest: &bytes[HEADER..], big_endian: bytes[HEADER - 2] == b'M', place: Place::default() };
    loop {
        file.place.byte = Some((bytes.len() - file.rest.len()) as u64);
        let Some((kind, content)) = file.next()? else { return Ok(variables) };
        match kind {
            14 => variable(&mut file.within(content), None, &mut variables)?,
            15 => variable(
                &mut file.within(&unpacked(&file, content, options, &mut held)?),
                None,
                &mut variables,
            )?,
            // Zeros that pad the file.
            0 if content.is_empty() => {}
            kind => return Err(file.fault(format!("an element of kind {kind}"), "a variable")),
        }
    }
}

/// Unpacks a compressed variable: no more bytes than it declares, and no more than the memory limit allows
/// with its numbers and the values `held` before.
fn unpacked(file: &Elements, packed: &[u8], options: &Options, held: &mut f64) -> Result<Vec<u8>> {
    let damaged = |e: std::io::Error| {
        let found = format!("a packed variable that is damaged: {e}");
        file.fault(found, "data that agree with their checksum")
    };
    let (mut zlib, mut tag, mut inflated) = (ZlibDecoder::new(packed), [0; 8], Vec::new());
    zlib.read_exact(&mut tag).map_err(damaged)?;
    let declared = u64::from(file.words(&tag[4..]).next().unwrap_or(0));
    // A wrong declared size is found below: the variable ends early or late.
    *held += declared.min(MOST_UNPACKED * packed.len() as u64) as f64 / 4.0;
    options.hold(*held)?;
    // zlib compares the checksum only at the end of the stream: eight more bytes are read, which exceeds
    // any padding.
    zlib.by_ref().take(declared + 8).read_to_end(&mut inflated).map_err(damaged)?;
    let behind = packed.get(zlib.total_in() as usize..).unwrap_or_default();
    let there = inflated.len() as u64;
    if !(declared..declared + 8).contains(&there) || behind.iter().any(|b| *b != 0) {
        let found =
            format!("a packed variable that ends early or late: {there} of {declared} bytes are there");
        return Err(file.fault(found, "as many bytes as it declares"));
    }
    inflated.truncate(declared as usize);
    Ok(inflated)
}

/// Adds the variable of a matrix element or, for a struct or cell array, its members. `inside` is the name
/// and depth of a member.
fn variable(
    elements: &mut Elements,
    inside: Option<(String, usize)>,
    variables: &mut Vec<(String, Content)>,
) -> Result<()> {
    let (_, flags) = elements.part("flags")?;
    let flags = elements.words(flags).next().unwrap_or(0);
    let class = flags & 0xff;
    let (has_two, logical) = (flags & 0x800 != 0, flags & 0x200 != 0);
    if class == 17 {
        // An object of the newer kind has no dimensions; its remaining layout is not documented.
        variables.push((inside.map_or_else(String::new, |(name, _)| name), Content::Other("object")));
        return Ok(());
    }
    let (_, dimensions) = elements.part("dimensions")?;
    let dimensions: Vec<u64> = elements.words(dimensions).map(u64::from).collect();
    let (_, own) = elements.part("name")?;
    let is_inside = inside.is_some();
    let (name, depth) = inside.unwrap_or_else(|| (string(own), 0));
    let product = dimensions.iter().try_fold(1u64, |n, d| n.checked_mul(*d));
    let Some(count) = product.filter(|_| dimensions.len() >= 2) else {
        return Err(elements.fault(format!("{name:?} with dimensions {dimensions:?}"), "a countable array"));
    };
    let content = match class {
        // An empty member is skipped without a finding.
        _ if count == 0 && is_inside => return Ok(()),
        _ if logical => Content::Other("logical array"),
        1 | 2 if depth >= MOST_DEPTH || name.len() > MOST_NAME => {
            Content::Other("struct or cell array too deep in others")
        }
        1 | 2 => {
            members(elements, (&name, depth), (class == 1, count), variables)?;
            return Ok(());
        }
        4 if count == 0 => Content::Text(String::new()),
        4 if dimensions[0] != 1 || count > MOST_TEXT as u64 => {
            Content::Other("char array of several rows or more than 4096 characters")
        }
        4 => Content::Text(text(elements)?),
        6..=15 => {
            let real = elements.numbers(count)?;
            let imaginary = if has_two { Some(elements.numbers(count)?) } else { None };
            let values = Values::of(real, imaginary).into();
            Content::Array(Array { dimensions, values, single: class == 7 })
        }
        3 => Content::Other("object"),
        5 => Content::Other("sparse matrix"),
        16 => Content::Other("function"),
        other => return Err(elements.fault(format!("{name:?} of class {other}"), "a class from 1 to 17")),
    };
    variables.push((name, content));
    Ok(())
}

/// Adds the members of a cell array (`cells`) or struct of `count` elements, `depth` deep in others.
fn members(
    elements: &mut Elements,
    (name, depth): (&str, usize),
    (cells, count): (bool, u64),
    variables: &mut Vec<(String, Content)>,
) -> Result<()> {
    let fields = if cells { vec![String::new()] } else { fields(elements)? };
    for i in 1..=if fields.is_empty() { 0 } else { count } {
        for field in &fields {
            let member = match (cells, count) {
                (true, _) => format!("{name}{{{i}}}"),
                (_, 1) => format!("{name}.{field}"),
                _ => format!("{name}({i}).{field}"),
            };
            let (kind, content) = elements.part(&member)?;
            if kind != 14 {
                return Err(elements.fault(format!("{member:?} of kind {kind}"), "an array"));
            } else if !content.is_empty() {
                variable(&mut elements.within(content), Some((member, depth + 1)), variables)?;
            }
        }
    }
    Ok(())
}

/// Names of the fields of a struct.
fn fields(elements: &mut Elements) -> Result<Vec<String>> {
    let (_, width) = elements.part("length of field names")?;
    let width = elements.words(width).next().unwrap_or(0) as usize;
    let (_, names) = elements.part("field names")?;
    if !(1..=MOST_NAME).contains(&width) {
        return Err(elements.fault(format!("field names of {width} bytes"), "1 to 512 bytes"));
    }
    Ok(names.chunks(width).map(string).collect())
}

/// A name up to its first zero.
pub fn string(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes.split(|b| *b == 0).next().unwrap_or_default()).into_owned()
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
