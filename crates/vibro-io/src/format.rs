//! The formats that are read.

/// A readable format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Universal File Format with data set 58 or 58b.
    Uff,
    /// RIFF or RF64 wave.
    Wav,
    /// HDF5.
    Hdf5,
    /// MATLAB's MAT-file: level 4, level 5 and version 7.3.
    Mat,
    /// NI's TDMS.
    Tdms,
    /// LabVIEW measurement.
    Lvm,
    /// Text of columns with names above them.
    Csv,
    /// Columns of numbers, with or without header lines.
    Ascii,
    /// A sheet of a workbook, with named columns or columns of numbers.
    Workbook,
    /// Records that were made in memory.
    Memory,
}

impl Format {
    /// Name on the command line and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Format::Wav => "wav",
            Format::Hdf5 => "hdf5",
            Format::Mat => "mat",
            Format::Tdms => "tdms",
            Format::Lvm => "lvm",
            Format::Uff => "uff",
            Format::Csv => "csv",
            Format::Ascii => "ascii",
            Format::Workbook => "workbook",
            Format::Memory => "memory",
        }
    }
}
