//! A figure.

use crate::head::Head;
use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyType;
use vibroimpact::figure::{AxisSpec, Figure, Plot, Series};

/// Parts into which a long record is cut; of each, the smallest and the largest value are drawn.
const PARTS: usize = 2000;

/// A figure: its drawing, and the data in it.
#[pyclass(frozen, module = "vibroimpact._native")]
pub struct Drawing(pub Figure);

#[pymethods]
impl Drawing {
    /// The figure of its data as JSON.
    #[new]
    fn new(json: &str) -> PyResult<Drawing> {
        let figure = serde_json::from_str(json);
        figure.map(Drawing).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// What makes the same figure again, for pickle.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, (String,)) {
        (slf.get_type(), (slf.get().json(),))
    }

    /// The values of a record over its axis.
    #[staticmethod]
    fn of_record(head: &Head, values: PyReadonlyArray1<'_, f64>) -> PyResult<Drawing> {
        let (record, values) = (head.record(), values.as_slice()?);
        let (axis, meta) = (record.axis(), record.meta());
        let size = values.len().div_ceil(PARTS).max(1);
        let drawn = values.chunks(size).enumerate().flat_map(|(k, part)| {
            let at = |i: &usize, j: &usize| part[*i].total_cmp(&part[*j]);
            let ends = [(0..part.len()).min_by(at), (0..part.len()).max_by(at)];
            let [first, last] = ends.map(|i| k * size + i.unwrap_or(0));
            if first == last { vec![first] } else { vec![first.min(last), first.max(last)] }
        });
        let drawn: Vec<usize> = drawn.filter(|i| *i < axis.len()).collect();
        let x: Vec<f64> = drawn.iter().map(|i| axis.at(*i)).collect();
        let y: Vec<f64> = drawn.iter().map(|i| values[*i]).collect();
        let across = match head.x_unit() {
            "s" => AxisSpec::new("Time", "s"),
            "Hz" => AxisSpec::frequency(),
            _ => AxisSpec::new("Number", ""),
        };
        let quantity = meta.quantity.name();
        let up = AxisSpec::new(quantity[..1].to_uppercase() + &quantity[1..], meta.unit.symbol());
        let plot = Plot::new(across, up).with(Series::line("", x, y));
        Ok(Drawing(Figure::single(meta.name.clone()).panel(plot)))
    }

    /// What the figure shows, in a few words.
    #[getter]
    fn title(&self) -> &str {
        &self.0.title
    }

    /// The caption.
    #[getter]
    fn caption(&self) -> &str {
        &self.0.caption
    }

    /// The drawing as SVG.
    fn svg(&self, py: Python<'_>) -> String {
        py.detach(|| self.0.draw().svg())
    }

    /// The data as JSON: panels with axes and series.
    fn json(&self) -> String {
        serde_json::to_string(&self.0).unwrap_or_default()
    }
}
