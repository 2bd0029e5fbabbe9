//! Formats that are known and not read: which program wrote them, and what to export there.

use super::Source;
use super::text::encoding;
use vibro_record::{Error, Place};

/// A format with the bytes that it begins with at an offset, endings of its files where it has no such bytes, and the export to choose.
struct Foreign {
    name: &'static str,
    begins: (usize, &'static [u8]),
    endings: &'static [&'static str],
    export: &'static str,
}

const fn by_bytes(name: &'static str, at: usize, begins: &'static [u8], export: &'static str) -> Foreign {
    Foreign { name, begins: (at, begins), endings: &[], export }
}

const fn by_ending(name: &'static str, endings: &'static [&'static str], export: &'static str) -> Foreign {
    Foreign { name, begins: (0, b""), endings, export }
}

const UFF: &str = "choose File > Export > Universal File (UFF-58)";
const TEXT: &str = "choose the export as CSV or text";
const SHEET: &str = "choose File > Save As > CSV, one sheet a file";
const AUDIO: &str = "turn it into WAV, e.g. with Audacity; a lossy recording is no measurement";

const TABLE: &[Foreign] = &[
    by_ending("a Polytec vibrometer file", &["svd", "pvd"], UFF),
    by_ending(
        "a Dewesoft recording",
        &["dxd", "d7d", "dxz"],
        "choose Export > UNV/UFF, MAT or CSV in Dewesoft",
    ),
    by_bytes(
        "a text file of Octave",
        0,
        b"# Created by Octave",
        "save it with `save -v7 name.mat` and its names",
    ),
    by_ending("a Siemens Testlab file", &["ldsf", "lms"], UFF),
    by_bytes("an imc FAMOS file", 0, b"|CF,", "choose Export > ASCII or TDMS in FAMOS"),
    by_bytes("an ASAM MDF 4 file", 0, b"MDF     4", "export it as CSV or MAT, e.g. with asammdf"),
    by_bytes("an ASAM MDF 3 file", 0, b"MDF     ", "export it as CSV or MAT, e.g. with asammdf"),
    by_bytes(
        "an unfinished ASAM MDF file",
        0,
        b"UnFinMF ",
        "finish it in the program that wrote it, and export CSV or MAT",
    ),
    by_bytes("a LeCroy waveform", 11, b"WAVEDESC", TEXT),
    by_bytes("a LeCroy waveform", 0, b"WAVEDESC", TEXT),
    by_bytes("a Tektronix waveform", 2, b":WFM#", TEXT),
    by_bytes("a Tektronix waveform", 0, b":WFMP", TEXT),
    by_bytes("a Keysight waveform", 0, b"AG10", TEXT),
    by_bytes("a Keysight waveform", 0, b"AG01", TEXT),
    by_bytes("a Parquet table", 0, b"PAR1", TEXT),
    by_bytes("a NumPy array", 0, b"\x93NUMPY", "write it as CSV or MAT, with its rate"),
    #[cfg(not(feature = "hdf5"))]
    by_bytes("an HDF5 file", 0, b"\x89HDF\r\n\x1a\n", crate::variables::EXPORT),
    by_bytes("an Excel sheet", 0, b"PK\x03\x04", SHEET),
    by_bytes("an Excel sheet, or another Office file", 0, b"\xd0\xcf\x11\xe0", SHEET),
    by_bytes("a FLAC recording", 0, b"fLaC", "turn it into WAV, e.g. with `flac -d`"),
    by_bytes("an Ogg recording", 0, b"OggS", AUDIO),
    by_bytes("an MP3 recording", 0, b"ID3", AUDIO),
    by_bytes("a packed file", 0, b"\x1f\x8b", "unpack it first"),
];

/// What to say of a source of a format that is known and not read.
pub fn complaint(source: &Source) -> Option<Error> {
    let (head, ending) = (source.head(), source.extension());
    let is = |known: &&Foreign| match known.begins {
        (_, []) => known.endings.contains(&ending.as_str()) && !encoding::is_text(head),
        (at, begins) => head.get(at..).is_some_and(|head| head.starts_with(begins)),
    };
    // MAT-files of version 7.3 are HDF5 and have a complaint of their own.
    let known = TABLE.iter().find(is).filter(|_| ending != "mat")?;
    let expected = format!("one of {}", super::Format::names().join(", "));
    Some(Error::input(Place::file(source.path()), known.name, expected).hint(known.export))
}

#[cfg(test)]
mod tests {
    use crate::Reader;

    #[test]
    fn each_is_named_with_its_way_out() {
        for (name, head, words) in [
            ("x.svd", &b"\x01\x02\0\0"[..], ["Polytec", "Universal File"]),
            ("x.trc", b"#9000000346WAVEDESC\0\0\0", ["LeCroy", "CSV"]),
            ("x.mf4", b"MDF     4.10\0\0", ["MDF 4", "asammdf"]),
            ("x.xlsx", b"PK\x03\x04\x14\0", ["Excel", "Save As"]),
            #[cfg(not(feature = "hdf5"))]
            ("x.h5", b"\x89HDF\r\n\x1a\n\0", ["HDF5", "MAT"]),
            ("x.dat", b"|CF,2,1,1;|CK,1,3,1,1;", ["FAMOS", "ASCII"]),
        ] {
            let said = Reader::new().from_reader(name, head).unwrap_err();
            let said = said.to_string();
            assert!(words.iter().all(|word| said.contains(word)), "{name}: {said}");
        }
        // The ending alone names nothing that is text.
        assert!(Reader::new().from_reader("x.svd", &b"0.5\n1.5\n2.5\n"[..]).is_ok());
    }
}
