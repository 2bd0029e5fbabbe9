//! Names of the contents of structs and cell arrays in MATLAB files of every version.

use super::names::Dialect;
use crate::format::Format;

/// MATLAB's dialect, with names such as `run(2).v` and `data{1}.x`.
pub static MATLAB: Dialect = Dialect {
    format: Format::Mat,
    separator: '.',
    brackets: ['(', ')'],
    first: 1,
    by_rows: false,
    wide: 64,
    attributes: false,
};
