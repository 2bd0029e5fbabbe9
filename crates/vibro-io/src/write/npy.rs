//! numpy's array file, format version 1.0.
//!
//! One record gives a vector, several records of one length an array of shape (records, values). Values are
//! doubles, or complex doubles if any record is complex. Names, units and the abscissa are not stored.
//!
//! Source: numpy's own description of the format, `NEP 1`.

use super::listed::{failed, label, parts};
use std::io::Write;
use vibro_record::{Error, Record, Result};

/// Writes `records` as one array, values in SI units.
///
/// # Errors
/// If there are none, their lengths differ, or the output cannot be written.
pub fn write(records: &[Record], out: &mut impl Write) -> Result<()> {
    let Some(first) = records.first() else {
        return Err(Error::refused("there is no record to write"));
    };
    let n = first.len();
    if let Some(other) = records.iter().find(|r| r.len() != n) {
        let (one, two, m) = (label(first), label(other), other.len());
        let why = format!("{one} has {n} values and {two} has {m}: one array cannot hold both");
        return Err(Error::refused(why).hint("write them one by one, or cut them to one length"));
    }
    let complex = records.iter().any(Record::is_complex);
    let shape = if records.len() == 1 { format!("({n},)") } else { format!("({}, {n})", records.len()) };
    let kind = if complex { "<c16" } else { "<f8" };
    let mut bytes = header(&format!("'{kind}'"), &shape);
    out.write_all(&bytes).map_err(failed)?;
    for record in records {
        bytes.clear();
        for i in 0..n {
            let mut parts = parts(record, i);
            bytes.extend(parts.next().unwrap_or(f64::NAN).to_le_bytes());
            if complex {
                bytes.extend(parts.next().unwrap_or(0.0).to_le_bytes());
            }
        }
        out.write_all(&bytes).map_err(failed)?;
    }
    Ok(())
}

/// The bytes before the values of an array, by the literals of Python for its type and shape:
/// `[('regime', '|u1'), ('radius', '<f8')]` and `(3, 5)`.
pub fn header(descr: &str, shape: &str) -> Vec<u8> {
    let mut header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}");
    // A prefix of ten bytes and a line end; the values begin at a multiple of 64 bytes.
    let padding = (64 - (10 + header.len() + 1) % 64) % 64;
    header.extend(std::iter::repeat_n(' ', padding));
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex64;
    use vibro_record::units::Unit;
    use vibro_record::{Axis, Frf, Meta, Trace};

    fn trace(values: &[f64]) -> Record {
        let (meta, axis) = (Meta::new("v", Unit::none()), Axis::index(values.len()));
        Record::Trace(Trace { meta, axis, values: values.to_vec() })
    }

    fn bytes(records: &[Record]) -> Vec<u8> {
        let mut out = Vec::new();
        write(records, &mut out).unwrap();
        out
    }

    /// The files were written by numpy: see `fixtures/npy/make.py`.
    #[test]
    fn byte_for_byte_what_numpy_writes() {
        let values = [0.0, -1.5, 1e300, f64::from_bits(1)];
        assert_eq!(bytes(&[trace(&values)]), include_bytes!("../../../../fixtures/npy/vector.npy"));
        let rows: Vec<Record> = (0..3).map(|k| trace(&[f64::from(k), 0.1])).collect();
        assert_eq!(bytes(&rows), include_bytes!("../../../../fixtures/npy/matrix.npy"));
        let frf = Record::Frf(Frf {
            meta: Meta::new("H", Unit::none()),
            axis: Axis::frequency(0.0, 1.0, 2),
            values: vec![Complex64::new(1.0, -2.0), Complex64::new(0.0, 0.5)],
        });
        assert_eq!(bytes(&[frf, trace(&[3.0, 4.0])]), include_bytes!("../../../../fixtures/npy/complex.npy"));
    }

    #[test]
    fn what_one_array_cannot_hold_is_refused() {
        let mut out = Vec::new();
        let error = write(&[trace(&[1.0]), trace(&[1.0, 2.0])], &mut out).unwrap_err();
        assert_eq!(error.exit_code(), 1);
        assert!(error.to_string().contains("1 values and the trace \"v\" has 2"), "{error}");
        assert!(write(&[], &mut out).is_err() && out.is_empty());
    }
}
