//! Formats that are recognised but not read: the program that wrote the file, and what to export there.

use super::text::encoding;
use crate::format::Format;
use crate::source::Source;
use vibro_record::{Error, Place};

/// How a format is recognised: by bytes at an offset, by the ending of a binary file, or by ending and
/// first bytes.
enum Signature {
    /// Offset, and the bytes there.
    Bytes(usize, &'static [u8]),
    /// Endings of files that are not text.
    Ending(&'static [&'static str]),
    /// Endings, separated by blanks, and the first bytes of the file.
    Named(&'static str, &'static [u8]),
}

use Signature::{Bytes, Ending, Named};

// Hints: the export to choose in the program that wrote the file.
const UFF: &str = "choose File > Export > Universal File (UFF-58)";
const DEWESOFT: &str = "choose Export > UNV/UFF, MAT or CSV in Dewesoft";
const UNFINISHED: &str = "finish it in the program that wrote it, and export CSV or MAT";
const TEXT: &str = "choose the export as CSV or text";
const SHEET: &str = "choose File > Save As > CSV, one sheet a file";
const SHEETS: &str = "choose File > Save As > CSV, one sheet a file; in phyphox choose Export Data > CSV (Comma, decimal point)";
const OCTAVE: &[u8] = b"# Created by Octave";
const SEISMIC: &str = "write it as SLIST, TSPAIR or CSV, e.g. with ObsPy";
/// `C 1` in EBCDIC: start of the 40-line textual header of SEG-Y.
const EBCDIC: &[u8] = b"\xc3\x40\xf1";
const AUDIO: &str = "turn it into WAV, e.g. with Audacity; a lossy recording is no measurement";

/// Name of each format, its signature, and the export to choose.
const TABLE: &[(&str, Signature, &str)] = &[
    ("a Polytec vibrometer file", Ending(&["svd", "pvd"]), UFF),
    ("a Dewesoft recording", Ending(&["dxd", "d7d", "dxz"]), DEWESOFT),
    ("a text file of Octave", Bytes(0, OCTAVE), "save it with `save -v7 name.mat`"),
    ("a Siemens Testlab file", Ending(&["ldsf", "lms"]), UFF),
    ("an imc FAMOS file", Bytes(0, b"|CF,"), "choose Export > ASCII or TDMS in FAMOS"),
    ("an ASAM MDF 4 file", Bytes(0, b"MDF     4"), "export it as CSV or MAT, e.g. with asammdf"),
    ("an ASAM MDF 3 file", Bytes(0, b"MDF     "), "export it as CSV or MAT, e.g. with asammdf"),
    ("an unfinished ASAM MDF file", Bytes(0, b"UnFinMF "), UNFINISHED),
    ("a LeCroy waveform", Bytes(11, b"WAVEDESC"), TEXT),
    ("a LeCroy waveform", Bytes(0, b"WAVEDESC"), TEXT),
    ("a Tektronix waveform", Bytes(2, b":WFM#"), TEXT),
    ("a Tektronix waveform", Bytes(0, b":WFMP"), TEXT),
    ("a Keysight waveform", Bytes(0, b"AG10"), TEXT),
    ("a Keysight waveform", Bytes(0, b"AG01"), TEXT),
    ("a Parquet table", Bytes(0, b"PAR1"), TEXT),
    ("a NumPy array", Bytes(0, b"\x93NUMPY"), "write it as CSV or MAT, with its rate"),
    #[cfg(not(feature = "hdf5"))]
    ("an HDF5 file", Bytes(0, b"\x89HDF\r\n\x1a\n"), crate::variables::EXPORT),
    ("an Excel sheet", Named("xlsx xlsm ods", b"PK\x03\x04"), SHEET),
    (
        "a packed folder (zip)",
        Bytes(0, b"PK\x03\x04"),
        "unpack it and name the file with the samples: of phyphox Raw Data.csv",
    ),
    ("an Excel sheet, or another Office file", Bytes(0, b"\xd0\xcf\x11\xe0"), SHEETS),
    ("a FLAC recording", Bytes(0, b"fLaC"), "turn it into WAV, e.g. with `flac -d`"),
    ("an Ogg recording", Bytes(0, b"OggS"), AUDIO),
    ("an MP3 recording", Bytes(0, b"ID3"), AUDIO),
    (
        "an enDAQ or Slam Stick recording",
        Bytes(0, b"\x1a\x45\xdf\xa3"),
        "export it as CSV in enDAQ Lab, or with `ide2csv`",
    ),
    // The number 5012, with which each catman file begins.
    ("a catman recording", Bytes(0, b"\x94\x13"), "choose the export as ASCII or MAT in catman"),
    ("a SEG-Y file", Ending(&["sgy", "segy"]), SEISMIC),
    ("a SEG-Y file", Bytes(0, EBCDIC), SEISMIC),
    ("a SAC file", Ending(&["sac"]), SEISMIC),
    ("a miniSEED file", Ending(&["mseed", "miniseed", "msd"]), SEISMIC),
    ("a miniSEED file", Bytes(0, b"000001D "), SEISMIC),
    ("a miniSEED file", Bytes(0, b"MS\x03"), SEISMIC),
    ("a C3D file", Ending(&["c3d"]), "export its analogue channels as CSV in the program that wrote it"),
    ("a packed file", Bytes(0, b"\x1f\x8b"), "unpack it first"),
];

/// Error for a file of a recognised format that is not read.
pub fn complaint(source: &Source) -> Option<Error> {
    let (head, ending) = (source.head(), source.extension());
    let is = |(_, by, _): &&(&str, Signature, &str)| match by {
        Ending(endings) => endings.contains(&ending.as_str()) && !encoding::is_text(head),
        Named(endings, begins) => head.starts_with(begins) && endings.split(' ').any(|e| e == ending),
        Bytes(at, begins) => head.get(*at..).is_some_and(|head| head.starts_with(begins)),
    };
    // MAT-files of version 7.3 are HDF5 and have an error of their own. An Octave text file with a single
    // variable is read as text.
    let fine = |by: &Signature| match by {
        Bytes(_, OCTAVE) => encoding::decode(head).matches("# name:").count() < 2,
        _ => ending == "mat",
    };
    let (name, _, export) = TABLE.iter().find(is).filter(|(_, by, _)| !fine(by))?;
    let expected = format!("one of {}", Format::names().join(", "));
    Some(Error::input(Place::file(source.path()), *name, expected).hint(*export))
}

#[cfg(test)]
mod tests;
