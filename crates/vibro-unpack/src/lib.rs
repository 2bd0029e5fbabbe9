//! Unpacks the module of the page `vibro.html`: LZMA is a quarter smaller than what browsers unpack by
//! themselves. The page asks for [`room`], writes what is packed there, and calls [`unpack`]; then it reads
//! so many bytes at the returned address.
#![allow(unsafe_code, reason = "a name by which a page calls a function is an unsafe attribute")]

use lzma_rust2::LzmaReader;
use std::io::Read as _;
use std::sync::Mutex;

static PACKED: Mutex<Vec<u8>> = Mutex::new(Vec::new());
static UNPACKED: Mutex<Vec<u8>> = Mutex::new(Vec::new());

/// Makes room for `len` packed bytes, and returns their address; null where memory does not suffice.
#[unsafe(no_mangle)]
pub extern "C" fn room(len: usize) -> *mut u8 {
    let Ok(mut packed) = PACKED.lock() else { return std::ptr::null_mut() };
    packed.clear();
    if packed.try_reserve_exact(len).is_err() {
        return std::ptr::null_mut();
    }
    packed.resize(len, 0);
    packed.as_mut_ptr()
}

/// Unpacks what was written, and returns the address of its `len` bytes; null where they are damaged.
#[unsafe(no_mangle)]
pub extern "C" fn unpack(len: usize) -> *const u8 {
    let (Ok(packed), Ok(mut unpacked)) = (PACKED.lock(), UNPACKED.lock()) else { return std::ptr::null() };
    unpacked.clear();
    unpacked.resize(len, 0);
    let reader = LzmaReader::new_mem_limit(packed.as_slice(), u32::MAX, None);
    match reader.and_then(|mut reader| reader.read_exact(&mut unpacked)) {
        Ok(()) => unpacked.as_ptr(),
        Err(_) => std::ptr::null(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `lzma.compress(b"impact " * 20, lzma.FORMAT_ALONE)` of Python 3.
    const IMPACTS: [u8; 33] = [
        93, 0, 0, 128, 0, 255, 255, 255, 255, 255, 255, 255, 255, 0, 52, 155, 74, 102, 154, 212, 135, 129,
        182, 39, 93, 217, 223, 255, 255, 221, 34, 0, 0,
    ];

    #[test]
    fn what_another_program_packed_is_unpacked_and_damage_is_seen() {
        let unpacked = |packed: &[u8]| {
            assert!(!room(packed.len()).is_null());
            PACKED.lock().unwrap().copy_from_slice(packed);
            (!unpack(140).is_null()).then(|| UNPACKED.lock().unwrap().clone())
        };
        assert_eq!(unpacked(&IMPACTS).unwrap(), "impact ".repeat(20).as_bytes());
        assert!(unpacked(&IMPACTS[..20]).is_none());
        assert!(unpacked(&[0xff; 40]).is_none());
    }
}
