//! One variable of a MAT-file.

use super::element::{Elements, Storage};
use vibro_record::Result;

/// Longest text that is kept.
const MOST_TEXT: u64 = 4096;
/// Most dimensions that an array has here.
const MOST_DIMENSIONS: u64 = 32;
/// Longest name: MATLAB's own limit is 63.
const MOST_NAME: u64 = 4096;

/// A variable with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    pub name: String,
    pub content: Content,
}

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
    pub real: Vec<f64>,
    /// Of the same length, where the array is complex.
    pub imaginary: Option<Vec<f64>>,
    /// Whether values have the precision of 32-bit floats only.
    pub single: bool,
    /// Whether integers were rounded to fit a double.
    pub rounded: bool,
}

/// Reads the content of a matrix element; `budget` is the number of values that may still be taken.
pub fn read(elements: &mut Elements, budget: &mut u64) -> Result<Variable> {
    let (_, flags) = elements.content("flags", &[6], 8)?;
    let flags = flags.first_chunk::<4>().map_or(0, |b| elements.word(*b));
    let class = flags & 0xff;
    let (complex, logical) = (flags & 0x800 != 0, flags & 0x200 != 0);
    if class == 17 {
        // An object of the newer kind has no dimensions; what follows is not documented.
        return Ok(Variable { name: String::new(), content: Content::Other("object") });
    }
    let (_, dimensions) = elements.content("dimensions", &[5], 4 * MOST_DIMENSIONS)?;
    let dimensions: Vec<u64> =
        dimensions.chunks_exact(4).map(|b| u64::from(elements.word([b[0], b[1], b[2], b[3]]))).collect();
    let (_, name) = elements.content("name", &[1, 2, 16], MOST_NAME)?;
    let name = String::from_utf8_lossy(&name).trim_end_matches('\0').to_owned();
    let product = dimensions.iter().try_fold(1u64, |n, d| n.checked_mul(*d));
    let Some(count) = product.filter(|_| dimensions.len() >= 2) else {
        return Err(elements.fault(format!("{name:?} with dimensions {dimensions:?}"), "a countable array"));
    };
    let content = match class {
        _ if logical => Content::Other("logical array"),
        4 => text(elements, &dimensions, count)?,
        6..=15 => {
            let wanted = count.saturating_mul(1 + u64::from(complex));
            if wanted > *budget {
                let found = format!("{name:?} declares {wanted} values, and {budget} may still be inflated");
                return Err(elements
                    .fault(
                        found,
                        "packed variables that hold at most 64 times the size of the file, or 64 MiB",
                    )
                    .hint("save the file without compression: save('name.mat', '-v6')"));
            }
            *budget -= wanted;
            Content::Array(array(elements, dimensions, count, complex, class)?)
        }
        1 => Content::Other("cell array"),
        2 => Content::Other("struct"),
        3 => Content::Other("object"),
        5 => Content::Other("sparse matrix"),
        16 => Content::Other("function"),
        other => return Err(elements.fault(format!("{name:?} of class {other}"), "a class from 1 to 17")),
    };
    Ok(Variable { name, content })
}

fn array(
    elements: &mut Elements,
    dimensions: Vec<u64>,
    count: u64,
    complex: bool,
    class: u32,
) -> Result<Array> {
    let (storage, real) = elements.numbers(count)?;
    let imaginary = if complex { Some(elements.numbers(count)?.1) } else { None };
    // 2⁵³ itself may be the rounding of 2⁵³ + 1.
    let wide = matches!(storage, Storage::I64 | Storage::U64);
    let rounded = wide && real.iter().any(|v| v.abs() >= 9_007_199_254_740_992.0);
    Ok(Array { dimensions, real, imaginary, single: class == 7, rounded })
}

fn text(elements: &mut Elements, dimensions: &[u64], count: u64) -> Result<Content> {
    if count == 0 {
        return Ok(Content::Text(String::new()));
    }
    if dimensions[0] != 1 || count > MOST_TEXT {
        return Ok(Content::Other("char array of several rows or more than 4096 characters"));
    }
    let (tag, bytes) = elements.content("text", &[1, 2, 4, 16, 17, 18], 4 * MOST_TEXT)?;
    let text = match tag.kind {
        4 | 17 => {
            let units = bytes.chunks_exact(2).map(|b| {
                // Both bytes go into the lower half of a word, in the file's order.
                (elements.word([b[0], b[1], b[0], b[1]]) & 0xffff) as u16
            });
            char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
        }
        18 => {
            let points = bytes.chunks_exact(4).map(|b| elements.word([b[0], b[1], b[2], b[3]]));
            points.map(|p| char::from_u32(p).unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
        }
        _ => String::from_utf8_lossy(&bytes).into_owned(),
    };
    Ok(Content::Text(text))
}
