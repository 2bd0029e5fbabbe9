//! The filter LZF, which h5py writes for `compression="lzf"`.
//!
//! A byte n below 32 is followed by n + 1 literal bytes. Any other byte begins a copy of earlier output.
//! Its upper three bits are the length minus 2 (7: the next byte is added). Its lower five bits and the
//! next byte are the distance back minus 1.

use hdf5_reader::error::Error as Fault;
use hdf5_reader::messages::filter_pipeline::FilterDescription;

/// Number under which the filter is registered.
pub const ID: u16 = 32000;

/// Unpacks a chunk; the third parameter of the filter is its size.
pub fn unpack(filter: &FilterDescription, packed: &[u8]) -> Result<Vec<u8>, Fault> {
    let size = filter.client_data.get(2).map_or(usize::MAX, |size| *size as usize);
    inflated(packed, size).ok_or_else(|| Fault::InvalidData("damaged LZF".to_owned()))
}

/// Unpacks at most `size` bytes; `None` for damaged data.
fn inflated(packed: &[u8], size: usize) -> Option<Vec<u8>> {
    let (mut out, mut rest) = (Vec::new(), packed.iter().copied());
    while let Some(control) = rest.next().map(usize::from) {
        if control < 32 {
            for _ in 0..=control {
                out.push(rest.next()?);
            }
        } else {
            let more = if control >> 5 == 7 { usize::from(rest.next()?) } else { 0 };
            let distance = (control & 31) << 8 | usize::from(rest.next()?);
            let from = out.len().checked_sub(distance + 1)?;
            for i in from..from + (control >> 5) + more + 2 {
                out.push(out[i]);
            }
        }
        if out.len() > size {
            return None;
        }
    }
    Some(out)
}
