//! MATLAB's MAT-file: level 5 (`save -v6` and `-v7`), which scipy writes too, and level 4 (`save -v4`), which
//! `PicoScope` writes.
//!
//! ```text
//! level 5   124 bytes of text, version 0x0100, IM (little endian) or MI (big endian)
//!           variable: kind 14, size, then elements: flags, dimensions, name, real part, imaginary part
//!           variable: kind 15, size, then the same packed by zlib
//! level 4   variable: type, rows, columns, complex or not, length of the name, name, real and imaginary part
//! ```
//! A numeric vector is a record, and so is each column of a matrix. Variables in structs and cell arrays
//! are named as MATLAB writes them: `bearing.gs`, `run(2).v`, `data{1}.x`. Scalars and texts are notes on
//! the records of their struct. The abscissa comes from a vector `t` or `time` (`f`, `freq` or `frequency`)
//! of the same length, or from scalars such as `fs`, `SampleRate`, `dt`, or `Tinterval` and `Tstart`
//! ([`variables`]). The format has no units, but a struct may state that of its vector (`Unit`).

mod level4;
mod level5;

use crate::held::Contents;
use crate::options::Options;
use crate::source::Source;
use crate::variables::matlab::MATLAB;
use crate::variables::{self, Content};
use vibro_record::{Error, Result};

/// First bytes of an HDF5 file.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Parser that returns the variables of a file by name.
type Parse = fn(&[u8], &Options) -> Result<Vec<(String, Content)>>;

/// Parser for the level of a MAT-file, or as an error the name of a version without a parser; `None` for
/// other files. Level 4 has no signature, so it is tried only if `named`, for files that end in `.mat`.
fn level(head: &[u8], named: bool) -> Option<std::result::Result<Parse, &'static str>> {
    const LEVEL_7: &str = "a MAT-file of version 7.3, which is HDF5";
    match head.get(124..128) {
        Some(b"\0\x01IM" | b"\x01\0MI") => Some(Ok(level5::all)),
        Some(b"\0\x02IM" | b"\x02\0MI") => Some(Err(LEVEL_7)),
        _ if !named => None,
        _ if head.starts_with(HDF5) || head.get(512..520) == Some(HDF5) => Some(Err(LEVEL_7)),
        _ => level4::header(head).map(|_| Ok((|bytes, _| level4::all(bytes)) as Parse)),
    }
}

pub(super) fn sniff(head: &[u8], source: &Source) -> bool {
    level(head, source.extension() == "mat").is_some()
}

pub(super) fn read(source: &Source, options: &Options, _: bool) -> Result<Contents> {
    #[cfg(feature = "hdf5")]
    if super::hdf5::sniff(source.head(), source) {
        return super::hdf5::read(source, options, false);
    }
    let parse = level(source.head(), true).unwrap_or(Err("no MAT-file header")).map_err(|found| {
        Error::usage(found, "a MAT-file of level 4 or 5")
            .hint("open it in MATLAB and save it again with -v7 or -v6, e.g. save('name.mat', '-v7')")
    })?;
    variables::contents(source, &MATLAB, parse(&source.all()?, options)?, Vec::new(), options)
}

#[cfg(test)]
mod tests;
