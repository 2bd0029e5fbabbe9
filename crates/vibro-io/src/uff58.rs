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
//! Source: Structural Dynamics Research Laboratory, University of Cincinnati, "Universal File Formats for Modal Analysis
//! Testing", data sets 58 and 58b.

mod abscissa;
pub mod codes;
mod heading;
mod kind;
mod layout;
mod ordinate;
mod plan;
mod sink;
mod spacing;
mod stated;
mod values;

use super::Options;
use super::uff::delimiter::closes;
use super::uff::stream::Stream;
use super::uff::system::System;
use heading::Heading;
use layout::Layout;
use spacing::Digits;
use values::Binary;
use vibro_record::{Error, Finding, Result};

pub use heading::LINES;
pub use plan::Plan;
pub use sink::{Counted, Kept, Sink};

/// One data set 58, read.
#[derive(Debug)]
pub struct Set<S> {
    /// All about the record but its values.
    pub plan: Plan,
    /// The values.
    pub sink: S,
}

/// Reads the data set whose number line was taken last, with its closing delimiter. Gives the number of header lines where
/// the header is cut short.
///
/// # Errors
/// If header or values cannot be read as what they should be.
pub fn read<S: Sink>(
    stream: &mut Stream,
    binary: bool,
    system: &System,
    options: &Options,
    file: &str,
) -> Result<std::result::Result<Set<S>, usize>> {
    let start = stream.line();
    let id = if binary { Some(IdLine::of(stream)?) } else { None };
    let heading = match Heading::read(stream)? {
        Ok(heading) => heading,
        Err(lines) => return Ok(Err(lines)),
    };
    let mut plan = Plan::new(&heading, system, options, file)?;
    let (layout, n) = (heading.layout, heading.n);
    let missing = options.allow_missing;
    let mut sink;
    let taken = if let Some(id) = id {
        let extent = Extent::find(stream, layout, n, id.bytes)?;
        extent.finding.into_iter().for_each(|found| plan.meta.found(found));
        let digits = if extent.wide_abscissa { Digits::Double } else { Digits::Single };
        let size = layout.point_size(extent.wide_abscissa) as u64;
        sink = S::new(layout, n.min((extent.bytes / size) as usize), digits);
        let storage = Binary { big_endian: id.big_endian, wide_abscissa: extent.wide_abscissa };
        values::binary(stream, layout, storage, (n, extent.bytes), missing, &mut sink)?
    } else {
        // No value takes fewer than two bytes, but most take thirteen or more: the vectors grow where they must.
        let room = n.min((stream.remaining() / 13) as usize + 1);
        sink = S::new(layout, room, Digits::Text);
        values::text(stream, layout, n, missing, &mut sink)?
    };
    plan.counted(n, taken);
    let end = stream.pass_set()?;
    if end.lines > 0 {
        let more = Finding::caution("more-lines").count("declared", n);
        plan.meta.found(more.count("lines", end.lines as usize));
    }
    if !end.closed {
        let open = Finding::caution("set-not-closed");
        plan.meta.found(start.into_iter().fold(open, |found, line| found.number("line", line as f64)));
    }
    Ok(Ok(Set { plan, sink }))
}

/// The number line of a 58b: `58b`, byte order, number format, header lines, bytes.
struct IdLine {
    big_endian: bool,
    /// Bytes of values, as the line has it: often wrong, so never more than a hint.
    bytes: Option<u64>,
}

impl IdLine {
    fn of(stream: &Stream) -> Result<IdLine> {
        let text = String::from_utf8_lossy(stream.text()).into_owned();
        let fields: Vec<&str> = text.split_whitespace().skip(1).collect();
        let refuse = |found: String, expected: &str| {
            Err(Error::input(stream.place(), found, expected)
                .hint("export the record as ASCII (data set 58), which has one spelling of numbers"))
        };
        let format = match fields.get(1) {
            Some(&"1") => Some("DEC VMS"),
            Some(&"2") => None,
            Some(&"3") => Some("IBM 5/370"),
            other => {
                return refuse(
                    format!("58b with number format {:?}", other.copied().unwrap_or("")),
                    "2 (IEEE 754)",
                );
            }
        };
        if let Some(name) = format {
            return refuse(format!("binary numbers of {name}"), "IEEE 754 numbers (number format 2)");
        }
        let big_endian = match fields.first() {
            Some(&"1") => false,
            Some(&"2") => true,
            other => {
                return refuse(
                    format!("58b with byte order {:?}", other.copied().unwrap_or("")),
                    "1 (little endian) or 2 (big endian)",
                );
            }
        };
        Ok(IdLine { big_endian, bytes: fields.get(3).and_then(|f| f.parse().ok()) })
    }
}

/// Where binary values end.
struct Extent {
    bytes: u64,
    wide_abscissa: bool,
    finding: Option<Finding>,
}

impl Extent {
    /// Record 7 says how many bytes there should be. Only where they cannot be all there, where the number line
    /// contradicts, or where writers differ (abscissa of double-precision values) does the closing `-1` decide.
    fn find(stream: &mut Stream, layout: Layout, n: usize, noted: Option<u64>) -> Result<Extent> {
        let size = |wide| (layout.point_size(wide) as u64).saturating_mul(n as u64);
        let declared = size(false);
        let mixed = layout.double && !layout.even;
        let sure = noted == Some(declared) && declared <= stream.remaining() && !mixed;
        let found = |bytes, wide_abscissa, finding| Ok(Extent { bytes, wide_abscissa, finding });
        if sure || closes(&stream.peek(declared)?) {
            return found(declared, false, None);
        }
        if mixed && closes(&stream.peek(size(true))?) {
            return found(size(true), true, Some(Finding::note("abscissa-double")));
        }
        let noted = noted.filter(|bytes| *bytes > 0);
        if let Some(bytes) = noted
            && closes(&stream.peek(bytes)?)
        {
            let other = Finding::caution("other-size").count("n", n).number("declared", declared as f64);
            return found(bytes, false, Some(other.number("bytes", bytes as f64)));
        }
        let wide = mixed && noted == Some(size(true));
        let expected = size(wide);
        if expected > stream.remaining() {
            // Cut short: the end of the file is the end of the values, unless a delimiter still follows them.
            let bytes = stream.remaining() - trailing_delimiter(stream)?;
            return found(bytes, wide, None);
        }
        found(expected, wide, Some(Finding::doubt("no-closing-line").number("bytes", expected as f64)))
    }
}

/// Length of a delimiter line, with the line ends around it, at the end of the file.
fn trailing_delimiter(stream: &mut Stream) -> Result<u64> {
    let tail = stream.remaining().min(100);
    let bytes = stream.peek(stream.remaining() - tail)?;
    let start = (0..bytes.len()).find(|i| closes(&bytes[*i..]) && bytes[*i..].trim_ascii() == b"-1");
    Ok(start.map_or(0, |i| (bytes.len() - i) as u64))
}
