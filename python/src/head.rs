//! Records between Rust and Python: the values are an array of `NumPy`, all else is a [`Head`].

use crate::refused::exception;
use crate::value::object;
use crate::watched::watched;
use num_complex::Complex64;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;
use std::sync::Arc;
use vibro_io::write::{Precision, Storage, Target};
use vibro_io::{Folder, Owner, Reader};
use vibroimpact::Error;
use vibroimpact::cli;
use vibroimpact::record::{
    Axis, AxisKind, Finding, Frf, Grid, Meta, Record, Scaling, Spectrum, Trace, Values,
};
use vibroimpact::report::Output;
use vibroimpact::report::words::{Voice, sentence};
use vibroimpact::units::Unit;

/// A record without its values, and the findings on its file.
#[pyclass(frozen, module = "vibroimpact._native")]
pub struct Head {
    record: Record,
    of_file: Arc<Vec<Finding>>,
}

/// A record as Python holds it: all but the values, and the values.
type Held<'py> = (Head, Bound<'py, PyAny>);

/// A record as Python passes it.
pub type Passed<'py> = (Bound<'py, Head>, Bound<'py, PyAny>);

/// A finding: severity, code, sentence.
pub type Told = (&'static str, String, String);

/// A finding in words.
pub fn told(finding: &Finding) -> Told {
    (finding.severity().name(), finding.code.to_string(), sentence(finding, Voice::Campaign))
}

impl Head {
    /// The record, with an empty list of values.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// The findings on the file that it is from.
    pub fn of_file(&self) -> &[Finding] {
        &self.of_file
    }

    /// Splits a record; the values are moved, not copied.
    fn split<'py>(py: Python<'py>, mut record: Record, of_file: &Arc<Vec<Finding>>) -> Held<'py> {
        let values = match &mut record {
            Record::Trace(Trace { values, .. })
            | Record::Spectrum(Spectrum { values: Values::Real(values), .. }) => {
                PyArray1::from_vec(py, std::mem::take(values)).into_any()
            }
            Record::Frf(Frf { values, .. })
            | Record::Spectrum(Spectrum { values: Values::Complex(values), .. }) => {
                PyArray1::from_vec(py, std::mem::take(values)).into_any()
            }
        };
        (Head { record, of_file: of_file.clone() }, values)
    }

    /// The record with these values.
    pub fn with(&self, values: &Bound<'_, PyAny>) -> PyResult<Record> {
        let real = || -> PyResult<Vec<f64>> {
            Ok(values.extract::<PyReadonlyArray1<'_, f64>>()?.as_array().to_vec())
        };
        let complex = || -> PyResult<Vec<Complex64>> {
            Ok(values.extract::<PyReadonlyArray1<'_, Complex64>>()?.as_array().to_vec())
        };
        let mut record = self.record.clone();
        let n = match &mut record {
            Record::Trace(trace) => {
                trace.values = real()?;
                trace.values.len()
            }
            Record::Frf(frf) => {
                frf.values = complex()?;
                frf.values.len()
            }
            Record::Spectrum(spectrum) => {
                spectrum.values = match &spectrum.values {
                    Values::Real(_) => Values::Real(real()?),
                    Values::Complex(_) => Values::Complex(complex()?),
                };
                spectrum.values.len()
            }
        };
        if n != record.axis().len() {
            let found = format!("{n} values over an axis of {}", record.axis().len());
            return Err(exception(values.py(), &Error::usage(found, "one value for each instant or line")));
        }
        Ok(record)
    }
}

#[pymethods]
impl Head {
    /// For pickle: how to make the head again.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let bytes = rmp_serde::to_vec(&(&self.record, &*self.of_file))
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok((py.get_type::<Head>().getattr("kept")?, (PyBytes::new(py, &bytes),)))
    }

    /// The head that these bytes keep.
    #[staticmethod]
    fn kept(bytes: &[u8]) -> PyResult<Head> {
        let (record, of_file): (Record, Vec<Finding>) =
            rmp_serde::from_slice(bytes).map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(Head { record, of_file: Arc::new(of_file) })
    }

    /// A head for `n` values: a trace over time, a spectrum of peak values or a response function over
    /// frequency, by `kind`. The axis is `even`, with its start and step, or has the values `at`; without both it
    /// counts. Values within twice `resolution` of an even axis are on it. Returned with the factor that takes
    /// values of `unit` to SI.
    #[staticmethod]
    #[pyo3(signature = (kind, n, name, unit, even, at))]
    fn made(
        py: Python<'_>,
        kind: &str,
        n: usize,
        name: String,
        unit: &str,
        even: Option<(f64, f64)>,
        at: Option<(Vec<f64>, f64)>,
    ) -> PyResult<(Head, f64)> {
        let unknown = || {
            let expected = "a unit such as m, mm/s, g, m/s², V, (m/s²)/N";
            exception(py, &Error::usage(format!("the unit {unit:?} is not known"), expected).setting("unit"))
        };
        if !unit.is_empty() && Unit::parse(unit).is_none() {
            return Err(unknown());
        }
        let mut meta = Meta::new(name, Unit::opaque(""));
        let factor = if unit.is_empty() { 1.0 } else { meta.adopt_unit(unit) };
        let of = if kind == "trace" { AxisKind::Time } else { AxisKind::Frequency };
        let axis = match (even, at) {
            (Some((start, step)), _) => Axis { kind: of, grid: Grid::Even { start, step, n } },
            (None, Some((at, resolution))) => Axis::from_values(of, at, resolution),
            (None, None) => Axis::index(n),
        };
        let record = match kind {
            "trace" => Record::Trace(Trace { meta, axis, values: Vec::new() }),
            "frf" => Record::Frf(Frf { meta, axis, values: Vec::new() }),
            complex => {
                let values = if complex == "complex spectrum" {
                    Values::Complex(Vec::new())
                } else {
                    Values::Real(Vec::new())
                };
                let scaling = Scaling::Peak;
                Record::Spectrum(Spectrum { meta, axis, values, scaling, window: None, enbw: None })
            }
        };
        Ok((Head { record, of_file: Arc::default() }, factor))
    }

    /// `trace`, `spectrum` or `frf`.
    #[getter]
    fn kind(&self) -> &'static str {
        self.record.kind()
    }

    /// Name of the channel.
    #[getter]
    fn name(&self) -> &str {
        &self.record.meta().name
    }

    /// Name of the quantity.
    #[getter]
    fn quantity(&self) -> &'static str {
        self.record.meta().quantity.name()
    }

    /// SI unit of the values.
    #[getter]
    fn unit(&self) -> &str {
        self.record.meta().unit.symbol()
    }

    /// Number of values.
    #[getter]
    fn n(&self) -> usize {
        self.record.axis().len()
    }

    /// Unit of the axis: `s`, `Hz`, or empty.
    #[getter]
    pub fn x_unit(&self) -> &'static str {
        match self.record.axis().kind {
            AxisKind::Time => "s",
            AxisKind::Frequency => "Hz",
            AxisKind::Index | AxisKind::Other(_) => "",
        }
    }

    /// First value of the axis.
    #[getter]
    fn start(&self) -> f64 {
        self.record.axis().start()
    }

    /// Step of the axis; `None` if it is uneven.
    #[getter]
    fn step(&self) -> Option<f64> {
        self.record.axis().step()
    }

    /// Values of the axis.
    fn axis<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.record.axis().values())
    }

    /// Whether the values are complex.
    #[getter]
    fn complex(&self) -> bool {
        self.record.is_complex()
    }

    /// Header lines and steps that made the record.
    fn meta<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let meta = self.record.meta();
        let notes: serde_json::Map<_, _> =
            meta.notes.iter().map(|(key, value)| (key.clone(), value.clone().into())).collect();
        let history = serde_json::to_value(&meta.history).unwrap_or_default();
        object(py, serde_json::json!({ "notes": notes, "history": history }))
    }

    /// Findings: severity, code, sentence.
    fn findings(&self) -> Vec<Told> {
        self.record.meta().findings.iter().map(told).collect()
    }
}

/// Reads a file with options of a command line: its format, findings on the file, and its records.
#[pyfunction]
pub fn read<'py>(
    py: Python<'py>,
    path: PathBuf,
    words: Vec<String>,
    show: Option<&Bound<'py, PyAny>>,
) -> PyResult<(&'static str, Vec<Told>, Vec<Held<'py>>)> {
    let reading = cli::reading(&words).map_err(|error| exception(py, &error))?;
    let recording = watched(py, show, move |_| {
        let reader: Reader = reading.reader()?;
        reader.from_path(path)
    })?;
    let findings = recording.findings.iter().map(told).collect();
    let of_file = Arc::new(recording.findings);
    let records = recording.records.into_iter().map(|record| Head::split(py, record, &of_file)).collect();
    Ok((recording.format.name(), findings, records))
}

/// Writes records into a file, in the format of its ending. A file that vibro did not write is replaced only
/// with `replace`.
#[pyfunction]
pub fn write(
    py: Python<'_>,
    path: PathBuf,
    records: Vec<Passed<'_>>,
    single: bool,
    binary: bool,
    replace: bool,
) -> PyResult<()> {
    let records =
        records.iter().map(|(head, values)| head.get().with(values)).collect::<PyResult<Vec<_>>>()?;
    watched(py, None, move |progress| {
        let target = Target::of(&path)?;
        let precision = if single { Precision::Single } else { Precision::Double };
        let mut bytes = Vec::new();
        target.write(&records, Storage { binary, precision }, &mut bytes)?;
        let name = path.file_name().and_then(|name| name.to_str()).map(str::to_owned);
        let name = name.ok_or_else(|| Error::usage("no file name of Unicode", "a file"))?;
        let parent = path.parent().unwrap_or(&path);
        let mut output = Output::new(Folder::from(parent), Owner::Recordings)?.replace(replace);
        output.expect(|known| known == name)?;
        output.write(&name, &bytes)?;
        // Ends here if it was interrupted.
        progress.at(1, 1);
        output.commit().map(drop)
    })
}
