//! Data set 58 and 58b: a function at a degree of freedom.
//!
//! ```text
//!     58                                  or 58b with byte order, number format, header lines and bytes
//! Mic 01.0Scalar                          1 to 5: identification
//! NONE
//! 18-Apr-16 13:49:58
//! NONE
//! NONE
//!     1         0    0         0 Mic 01             0   1 NONE               0   0
//!          2     79292         1  0.00000E+00  1.52588E-05  0.00000E+00
//!         17    0    0    0 time                 s
//!         21    0    0    0 Pressure             Pa
//!          0    0    0    0 NONE                 NONE
//!          0    0    0    0 NONE                 NONE
//!  -1.47553E-02 -1.72957E-02 -1.66101E-02 …
//! ```
//! Source: Structural Dynamics Research Laboratory, University of Cincinnati, "Universal File Formats for
//! Modal Analysis Testing", data sets 58 and 58b.

pub mod codes;
mod heading;
mod layout;
mod ordinate;
mod record;
mod values;

use super::stream::Stream;
use crate::options::Options;
use heading::Heading;
use vibro_record::{Error, Finding, Record, Result};

pub use heading::LINES;
pub(crate) use layout::{KINDS, Layout};
pub use ordinate::UnitSystem;

/// Reads the data set whose number `line` was read last, up to and including its closing delimiter. If its
/// header is cut short, returns the number of header lines and an error.
///
/// # Errors
/// If header or values are not what the format requires.
pub fn read(
    stream: &mut Stream,
    (line, binary): (&[u8], bool),
    system: &UnitSystem,
    options: &Options,
    file: &str,
) -> Result<std::result::Result<Record, (usize, Error)>> {
    let place = stream.place();
    let storage = if binary { Some(values::storage(line, stream)?) } else { None };
    let start = place.line;
    let heading = match Heading::read(stream)? {
        Ok(heading) => heading,
        Err(lines) => {
            let found = format!("data set 58 ends after {lines} of its {LINES} header lines");
            let error = Error::input(place, found, "eleven header lines and values behind them")
                .hint("the file is cut short: copy or export it again");
            return Ok(Err((lines, error)));
        }
    };
    let (numbers, mut findings) = match storage {
        Some(storage) => values::binary(stream, &heading, storage, options.allow_missing)?,
        None => (values::text(stream, &heading, options.allow_missing)?, Vec::new()),
    };
    let (lines, closed) = stream.pass_set();
    if lines > 0 {
        let more = Finding::caution("more-lines").count("declared", heading.n);
        findings.push(more.count("lines", lines));
    }
    if !closed {
        let open = Finding::caution("set-not-closed");
        findings.push(start.into_iter().fold(open, |found, line| found.number("line", line as f64)));
    }
    record::build(&heading, numbers, findings, system, options, file).map(Ok)
}
