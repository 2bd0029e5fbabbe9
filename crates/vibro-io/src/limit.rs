//! How much memory a reader may fill: asked before anything is held whose size a file says.

use std::sync::OnceLock;
use vibro_record::units::notation::significant;
use vibro_record::{Error, Result};

/// Bytes in a GB.
const GB: f64 = 1e9;
/// Memory in bytes of a machine that does not say how much it has.
const UNKNOWN: f64 = 4.0 * GB;
/// Part of the machine's memory that a hint names at most: the system and other programs need theirs.
const MOST_OF_MACHINE: f64 = 0.8;

/// Stated for all readers of the program.
static STATED: OnceLock<f64> = OnceLock::new();

/// The most memory in bytes that the values of a file may take, with what is made of them.
///
/// ```
/// use vibro_io::Limit;
/// assert_eq!(Limit::parse("1.5GB"), Some(Limit(1.5e9)));
/// assert_eq!(Limit::parse("200 MB"), Some(Limit(2e8)));
/// assert_eq!(Limit::parse("much"), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit(pub f64);

impl Default for Limit {
    /// What [`Limit::state`] stated, else a quarter of the machine's memory.
    fn default() -> Limit {
        Limit(STATED.get().copied().unwrap_or_else(|| machine() / 4.0))
    }
}

impl Limit {
    /// Makes it the default of all readers; the first one stated holds.
    pub fn state(self) {
        let _ = STATED.set(self.0);
    }

    /// A size such as `2GB` or `500MB`, above 0.
    pub fn parse(text: &str) -> Option<Limit> {
        let text = text.trim().to_uppercase();
        let units = [("TB", 1e12), ("GB", GB), ("MB", 1e6), ("KB", 1e3), ("B", 1.0)];
        let (number, unit) = units.iter().find_map(|(unit, size)| Some((text.strip_suffix(unit)?, size)))?;
        let bytes = number.trim().parse::<f64>().ok()? * unit;
        (bytes.is_finite() && bytes > 0.0).then_some(Limit(bytes))
    }

    /// Whether so many bytes may be held.
    ///
    /// # Errors
    /// If they may not: with what they are, and the limit that they fit in where the machine has that memory.
    pub(crate) fn hold(self, bytes: f64) -> Result<()> {
        self.hold_or(bytes, |error| error.hint("of several channels, name one").setting("channel"))
    }

    /// As [`Limit::hold`], with what else to try where the machine has too little memory.
    pub(crate) fn hold_or(self, bytes: f64, advice: impl FnOnce(Error) -> Error) -> Result<()> {
        if bytes <= self.0 {
            return Ok(());
        }
        let size = |bytes: f64| {
            let (unit, size) =
                [("GB", GB), ("MB", 1e6)].into_iter().find(|u| bytes >= u.1).unwrap_or(("kB", 1e3));
            format!("{} {unit}", significant(bytes / size, 2))
        };
        let found = format!("it needs {} of memory, the limit is {}", size(bytes), size(self.0));
        let error = Error::usage(found, "");
        // A tenth more is for the program itself, and for rounding.
        let enough = (1.1 * bytes / GB).max(0.1);
        Err(if enough * GB <= MOST_OF_MACHINE * machine() {
            error.set("max_memory", format!("{}GB", (enough * 10.0).ceil() / 10.0))
        } else {
            advice(error)
        })
    }
}

/// Memory of the machine in bytes.
fn machine() -> f64 {
    let told = std::fs::read_to_string("/proc/meminfo").ok();
    let total = told.as_deref().and_then(|text| text.lines().find_map(|line| line.strip_prefix("MemTotal:")));
    let kib = total.and_then(|total| total.trim().strip_suffix("kB")?.trim().parse::<f64>().ok());
    kib.map_or(UNKNOWN, |kib| 1024.0 * kib)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Reader;
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
        // 2 channels × 1000 frames × 8 bytes, three times with what is made of them.
        let bytes = wave(1000);
        let reader = |limit: f64| Reader::new().max_memory(Limit(limit)).beside(2.0);
        let read = |reader: &Reader| reader.from_reader("x.wav", bytes.as_slice());
        assert!(read(&reader(48_000.0)).is_ok());
        let said = read(&reader(47_999.0)).unwrap_err();
        assert_eq!(said.exit_code(), 2);
        assert!(said.to_string().contains("x.wav: it needs 48 kB of memory"), "{said}");
        assert!(said.settings().eq(["max_memory"]), "{said}");
        // Of one channel it is half, and its record is the same.
        let one = read(&reader(24_000.0).only(["2".to_owned()])).unwrap();
        assert_eq!(
            one.trace(Some("2"), None).unwrap(),
            read(&reader(1e9)).unwrap().trace(Some("2"), None).unwrap()
        );
        assert!(read(&reader(23_999.0).only(["2".to_owned()])).is_err());
    }

    #[test]
    fn the_part_of_a_hint_is_read() {
        // 3.2e8 bytes a sample of two channels, more than any machine has: 3125 of 48 kHz are within the
        // limit.
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
        // 20 000 rows of two columns and 3/4 beside them take 560 kB, as the first 64 KiB tell within their
        // shorter rows: a quarter more.
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
}
