//! The fastest path: one number a line, every line of the same length, every number like `1.234567e-01`.
//!
//! That is what analysers print most. Since the number of rows follows from the size of the file, every thread writes its
//! values where they belong. Anything else makes this path give up, and [`super::fast`] takes over.

use super::fast::{BLOCK, SMALLEST_PIECE};
use crate::Source;
use crate::number::{self, Exponential};
use std::io::{ErrorKind, Read, SeekFrom};
use vibro_record::{Error, Result};

/// A row of fixed length: blanks, a sign or blank, the number, the line end.
#[derive(Debug, Clone, Copy)]
pub struct Fixed {
    /// Bytes of a row with its line end.
    length: usize,
    /// Where the unsigned number begins and ends.
    number: (usize, usize),
    parse: Exponential,
}

impl Fixed {
    /// The shape of these rows (with their line ends cut off at LF), if all have it.
    pub fn of(rows: &[&[u8]]) -> Option<Fixed> {
        let first = rows.first().filter(|_| rows.len() > 1)?;
        let end = first.trim_ascii_end().len();
        let blanks = end - first[..end].trim_ascii_start().len();
        let from = blanks + usize::from(matches!(first.get(blanks), Some(b'-' | b'+')));
        let parse = number::exponential_of(end - from)?;
        let fixed = Fixed { length: first.len() + 1, number: (from, end), parse };
        let alike = |row: &&[u8]| {
            row.len() == first.len() && row.trim_ascii_end().len() == end && fixed.value(row).is_some()
        };
        rows.iter().all(alike).then_some(fixed)
    }

    /// Value of a row, without looking at its line end.
    #[inline]
    fn value(&self, row: &[u8]) -> Option<f64> {
        let (from, to) = self.number;
        let magnitude = (self.parse)(row.get(from..to)?)?;
        let Some(sign) = from.checked_sub(1) else { return Some(magnitude) };
        if row[..sign].iter().any(|b| *b != b' ') {
            return None;
        }
        match row[sign] {
            b' ' | b'+' => Some(magnitude),
            b'-' => Some(-magnitude),
            _ => None,
        }
    }

    /// Whether a row ends as it should: blanks or CR, then LF.
    #[inline]
    fn ends(&self, row: &[u8]) -> bool {
        match &row[self.number.1..] {
            [b'\n'] | [b'\r', b'\n'] => true,
            [blanks @ .., b'\n'] => blanks.iter().all(|b| matches!(b, b' ' | b'\r' | b'\t')),
            _ => false,
        }
    }
}

/// All values; `None` where a row is of another shape.
pub fn read(source: &Source, from: u64, fixed: Fixed) -> Result<Option<Vec<f64>>> {
    let length = fixed.length as u64;
    let bytes = source.len() - from;
    // The last line may lack its LF; other remainders are lines of another length.
    let rows = bytes.div_ceil(length);
    if rows * length - bytes > 1 {
        return Ok(None);
    }
    let mut values = vec![0.0; rows as usize];
    let pieces = (bytes / SMALLEST_PIECE).clamp(1, rayon::current_num_threads().max(1) as u64);
    let share = values.len().div_ceil(pieces as usize).max(1);
    let work = |i: usize, part: &mut [f64]| piece(source, &fixed, from + (i * share) as u64 * length, part);
    let done = if pieces == 1 {
        work(0, &mut values)?
    } else {
        let mut results: Vec<Result<bool>> = (0..pieces).map(|_| Ok(false)).collect();
        rayon::scope(|scope| {
            for ((i, part), result) in values.chunks_mut(share).enumerate().zip(&mut results) {
                scope.spawn(move |_| *result = work(i, part));
            }
        });
        let used = rows.div_ceil(share as u64) as usize;
        let mut all = true;
        for result in results.into_iter().take(used) {
            all &= result?;
        }
        all
    };
    Ok(done.then_some(values))
}

/// Reads the rows from `at` on into `values`; false where one is of another shape.
fn piece(source: &Source, fixed: &Fixed, at: u64, values: &mut [f64]) -> Result<bool> {
    let failed = |e| Error::io("read", source.path(), e);
    let mut file = source.open()?;
    file.seek(SeekFrom::Start(at)).map_err(failed)?;
    let rows = (BLOCK / fixed.length).clamp(1, values.len().max(1));
    let mut buffer = vec![0; rows * fixed.length];
    for part in values.chunks_mut(rows) {
        let wanted = part.len() * fixed.length;
        let block = &mut buffer[..wanted];
        let mut filled = 0;
        while filled < wanted {
            match file.read(&mut block[filled..]) {
                Ok(0) => break,
                Ok(n) => filled += n,
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) => return Err(failed(e)),
            }
        }
        if filled + 1 == wanted {
            block[filled] = b'\n'; // the last line of the file lacks it
        } else if filled < wanted {
            return Ok(false);
        }
        for (value, row) in part.iter_mut().zip(block.chunks_exact(fixed.length)) {
            match fixed.value(row) {
                Some(found) if fixed.ends(row) => *value = found,
                _ => return Ok(false),
            }
        }
    }
    Ok(true)
}
