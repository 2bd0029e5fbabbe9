//! Hand-written universal files of one data set 58, and helpers that read them.

use super::sentences;
use vibroimpact::read::{Header, Reader, Recording};
use vibroimpact::record::Record;

pub const ENTITY: &str = "         1    0         0 Mic                7   3 NONE               0   0";
pub const NONE: &str = "         0    0    0    0 NONE                 NONE";
pub const TIME: &str = "        17    0    0    0 time                 s";
pub const FREQUENCY: &str = "        18    0    0    0 frequency            Hz";
pub const PASCAL: &str = "        15    0    0    0 pressure             Pa";

/// A data set 58 without its delimiters: function type, record 7, axes, values.
pub struct Set {
    pub number: String,
    pub function: u8,
    pub form: String,
    pub axes: [String; 3],
    pub values: Vec<u8>,
}

impl Set {
    /// A pressure over time, real, single precision.
    pub fn trace(n: usize, values: &str) -> Set {
        Set {
            number: "    58".into(),
            function: 1,
            form: form(2, n, 1),
            axes: [TIME, PASCAL, NONE].map(str::to_owned),
            values: values.into(),
        }
    }

    /// A frequency response of two lines, with these axis records of numerator and denominator.
    pub fn ratio(function: u8, above: &str, below: &str) -> Set {
        Set {
            function,
            form: form(5, 2, 1),
            axes: [FREQUENCY, above, below].map(str::to_owned),
            ..Set::trace(0, "  1.00000E+00  0.00000E+00  0.00000E+00  2.00000E+00\n")
        }
    }

    pub fn header(&self) -> String {
        let [abscissa, ordinate, denominator] = &self.axes;
        format!(
            "{}\nFirst\nNONE\nThird\nNONE\nNONE\n{:5}{ENTITY}\n{}\n{abscissa}\n{ordinate}\n{denominator}\n{NONE}\n",
            self.number, self.function, self.form
        )
    }

    pub fn body(&self) -> Vec<u8> {
        [self.header().as_bytes(), &self.values].concat()
    }

    /// The data set with both delimiters.
    pub fn file(&self) -> Vec<u8> {
        [b"    -1\n", &self.body()[..], b"    -1\n"].concat()
    }
}

pub fn form(kind: u8, n: usize, even: u8) -> String {
    format!("{kind:10}{n:10}{even:10}  0.00000E+00  2.50000E-01  0.00000E+00")
}

pub fn reader() -> Reader {
    Reader::new()
}

/// Reads, and checks that the survey agrees or also fails.
pub fn try_read(reader: &Reader, bytes: &[u8]) -> Result<Recording, String> {
    let read = reader.from_reader("odd.uff", bytes).map_err(|e| e.to_string());
    let file = tempfile::Builder::new().suffix(".uff").tempfile().expect("a temporary file");
    std::fs::write(file.path(), bytes).expect("room for a few kB");
    let survey = reader.survey(file.path()).map_err(|e| e.to_string());
    match (&read, survey) {
        (Ok(recording), Ok((_, headers, doubts))) => {
            assert_eq!(doubts, recording.findings);
            assert_eq!(headers.len(), recording.records.len());
            for (record, header) in recording.records.iter().zip(headers) {
                let full = Header::of(record);
                assert_eq!((full.n, full.dx, full.unit), (header.n, header.dx, header.unit));
                assert_eq!((full.x0, full.name, full.kind), (header.x0, header.name, header.kind));
                assert_eq!(full.findings, header.findings);
            }
        }
        (Err(_), Err(_)) => {}
        (read, survey) => panic!("read gives {read:?}, survey {survey:?}"),
    }
    read
}

pub fn read(bytes: &[u8]) -> Recording {
    try_read(&reader(), bytes).unwrap_or_else(|e| panic!("{e}"))
}

pub fn refused(bytes: &[u8]) -> String {
    try_read(&reader(), bytes).expect_err("this should be refused")
}

pub fn values(recording: &Recording) -> Vec<f64> {
    match &recording.records[0] {
        Record::Trace(trace) => trace.values.clone(),
        Record::Spectrum(spectrum) => spectrum.values.magnitudes(),
        Record::Frf(frf) => frf.values.iter().map(|v| v.norm()).collect(),
    }
}

pub fn doubts(recording: &Recording) -> String {
    sentences(&recording.all_findings()).join(" ")
}

/// Checks the values, and that there is no finding.
pub fn clean(bytes: &[u8], expected: &[f64]) {
    let recording = read(bytes);
    assert_eq!(values(&recording), expected);
    assert_eq!(sentences(&recording.all_findings()), Vec::<String>::new());
}

pub const SEVEN: &str =
    " -1.00000E+00  2.00000E+00  3.00000E+00  4.00000E+00  5.00000E+00  6.00000E+00\n  7.00000E+00\n";
pub const ONE_TO_SEVEN: [f64; 7] = [-1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

pub fn binary(kind: u8, n: usize, even: u8, noted: usize, values: &[u8]) -> Set {
    let big = 1 + u8::from(noted & 1 == 1); // an odd `noted` stands for big-endian values
    Set {
        number: format!(
            "    58b{big:6}     2          11{:12}     0     0           0           0",
            noted & !1
        ),
        function: if kind > 4 { 4 } else { 1 },
        form: form(kind, n, even),
        axes: [if kind > 4 { FREQUENCY } else { TIME }, PASCAL, NONE].map(str::to_owned),
        values: values.to_vec(),
    }
}

pub fn f32s(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}
