use super::*;
use crate::reader::Reader;
use std::fmt::Write as _;
use std::path::PathBuf;

/// A wave file of `n` 16-bit frames of two channels.
fn wave(n: u32) -> Vec<u8> {
    let mut bytes =
        b"RIFF\0\0\0\0WAVEfmt \x10\0\0\0\x01\0\x02\0\x80\xbb\0\0\0\xee\x02\0\x04\0\x10\0data".to_vec();
    bytes.extend((4 * n).to_le_bytes());
    bytes.extend((0..n).flat_map(|i| [(i as u16).to_le_bytes(), 7u16.to_le_bytes()].concat()));
    bytes
}

#[test]
fn a_wave_file_may_fill_the_limit_and_no_more() {
    // 2 channels × 1000 frames × 8 bytes, times three: the values, and twice their size for results.
    let bytes = wave(1000);
    let reader = |limit: f64| Reader::new().max_memory(Limit(limit)).beside(2.0);
    let read = |reader: &Reader| reader.from_reader("x.wav", bytes.as_slice());
    assert!(read(&reader(48_000.0)).is_ok());
    let said = read(&reader(47_999.0)).unwrap_err();
    assert_eq!(said.exit_code(), 2);
    assert!(said.to_string().contains("x.wav: it needs 48 kB of memory"), "{said}");
    assert!(said.settings().eq(["max_memory"]), "{said}");
    // One channel takes half of the memory, and its record is the same.
    let one = read(&reader(24_000.0).only(["2".to_owned()])).unwrap();
    assert_eq!(
        one.trace(Some("2"), None).unwrap(),
        read(&reader(1e9)).unwrap().trace(Some("2"), None).unwrap()
    );
    assert!(read(&reader(23_999.0).only(["2".to_owned()])).is_err());
}

#[test]
fn the_part_of_a_hint_is_read() {
    // Two channels take 3.2e8 bytes per frame, so all 4800 frames exceed any machine; 3125 frames at 48 kHz
    // (0.065 s) are within the limit of 1e12 bytes.
    let bytes = wave(4800);
    let reader = || Reader::new().max_memory(Limit(1e12)).beside(2e7 - 1.0);
    let said = reader().from_reader("x.wav", bytes.as_slice()).unwrap_err();
    let typed = said.to_string();
    assert!(typed.ends_with("\n  try: span = [0, 0.065]"), "{typed}");
    let part = reader().span(Some((0.0, 0.065))).from_reader("x.wav", bytes.as_slice()).unwrap();
    assert_eq!(part.records[0].len(), 3120);
}

#[test]
fn text_is_refused_before_it_is_read() {
    let mut text = "time [s],a [m]\n".to_owned();
    for i in 0..20_000 {
        let _ = writeln!(text, "{i},{}", 2 * i);
    }
    let read = |limit| Reader::new().max_memory(Limit(limit)).from_reader("x.csv", text.as_bytes());
    // 20 000 rows of two columns, times 1.75 for results, take 560 kB. The estimate from the first 64 KiB,
    // whose rows are shorter, is a quarter larger.
    assert!(read(420_000.0).is_err());
    assert_eq!(read(840_000.0).unwrap().records[0].len(), 20_000);
}

#[cfg(feature = "hdf5")]
#[test]
fn an_hdf5_file_is_refused_by_what_it_unpacks_to() {
    let path: PathBuf =
        [env!("CARGO_MANIFEST_DIR"), "../../fixtures/hdf5/storage_latest.h5"].iter().collect();
    let read = |limit| Reader::new().max_memory(Limit(limit)).from_path(&path);
    let whole = read(1e9).unwrap();
    let held: usize = whole.records.iter().map(|record| 8 * record.len()).sum();
    let said = read(held as f64 - 1.0).unwrap_err().to_string();
    assert!(said.contains("storage_latest.h5: it needs"), "{said}");
}
