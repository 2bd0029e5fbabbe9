//! JSON values as Python objects: lists of numbers as arrays, values with an uncertainty as `Estimate`.

use crate::refused::class;
use numpy::{PyArray1, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyList, PyType};
use serde_json::{Map, Value};

/// Keys of a value with its uncertainty.
const ESTIMATE: [&str; 5] = ["value", "std", "unit", "n", "method"];

/// The Python object of a value.
///
/// # Errors
/// If Python has no memory left.
pub fn object<'py>(py: Python<'py>, value: Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Null => py.None().into_bound(py),
        Value::Bool(yes) => yes.into_pyobject(py)?.to_owned().into_any(),
        Value::String(text) => text.into_pyobject(py)?.into_any(),
        Value::Number(number) => match number.as_i64() {
            Some(whole) => whole.into_pyobject(py)?.into_any(),
            None => number.as_f64().into_pyobject(py)?.into_any(),
        },
        Value::Array(items) => list(py, items)?,
        Value::Object(fields) => fields_of(py, fields)?,
    })
}

/// Named values as an object of the class `Fields`, or as an `Estimate`.
fn fields_of<'py>(py: Python<'py>, fields: Map<String, Value>) -> PyResult<Bound<'py, PyAny>> {
    static FIELDS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    static OF_ESTIMATE: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let estimate = fields.len() == ESTIMATE.len() && ESTIMATE.iter().all(|key| fields.contains_key(*key));
    if estimate {
        let fields = ESTIMATE.map(|key| object(py, fields[key].clone()));
        let [value, std, unit, n, method] = fields;
        let class = class(py, &OF_ESTIMATE, "vibroimpact._estimate", "Estimate")?;
        return class.call1((value?, std?, unit?, n?, method?));
    }
    let made = PyDict::new(py);
    for (key, value) in fields {
        made.set_item(key, object(py, value)?)?;
    }
    class(py, &FIELDS, "vibroimpact._fields", "Fields")?.call1((made,))
}

/// A list: of numbers as an array, NaN where one is missing; of equally long lists of numbers as a matrix.
fn list<'py>(py: Python<'py>, items: Vec<Value>) -> PyResult<Bound<'py, PyAny>> {
    if let Some(numbers) = numbers(&items) {
        return Ok(PyArray1::from_vec(py, numbers).into_any());
    }
    if let Some((width, numbers)) = matrix(&items) {
        let shape = [items.len(), width];
        return Ok(PyArray1::from_vec(py, numbers).reshape(shape)?.into_any());
    }
    let objects = items.into_iter().map(|item| object(py, item));
    Ok(PyList::new(py, objects.collect::<PyResult<Vec<_>>>()?)?.into_any())
}

/// The numbers of a list that has no others; `None` if it has, or no number at all.
fn numbers(items: &[Value]) -> Option<Vec<f64>> {
    let number = |item: &Value| if item.is_null() { Some(f64::NAN) } else { item.as_f64() };
    items.iter().any(Value::is_number).then_some(())?;
    items.iter().map(number).collect()
}

/// Width and numbers, row by row, of a list of equally long lists of numbers.
fn matrix(items: &[Value]) -> Option<(usize, Vec<f64>)> {
    let rows = items.iter().map(|item| numbers(item.as_array()?)).collect::<Option<Vec<_>>>()?;
    let width = rows.first().map(Vec::len)?;
    rows.iter().all(|row| row.len() == width).then(|| (width, rows.concat()))
}
