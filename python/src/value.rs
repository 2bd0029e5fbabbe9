//! JSON values as Python objects: lists of numbers as arrays, values with an uncertainty as `Estimate`.

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
pub fn object(py: Python<'_>, value: Value) -> PyResult<Bound<'_, PyAny>> {
    within(py, value, "")
}

/// As [`object`], inside an object that states `unit` for its amplitudes.
fn within<'py>(py: Python<'py>, value: Value, unit: &str) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Null => py.None().into_bound(py),
        Value::Bool(yes) => yes.into_pyobject(py)?.to_owned().into_any(),
        Value::String(text) => text.into_pyobject(py)?.into_any(),
        Value::Number(number) => match number.as_i64() {
            Some(whole) => whole.into_pyobject(py)?.into_any(),
            None => number.as_f64().into_pyobject(py)?.into_any(),
        },
        Value::Array(items) => list(py, items, unit)?,
        Value::Object(fields) => fields_of(py, fields, unit)?,
    })
}

/// Unit of a number with a standard uncertainty beside it, `frequency` with `frequency_std`, where its name or
/// the object around it tells. An amplitude is in the `unit` of the object.
fn unit_of<'a>(name: &str, unit: &'a str) -> Option<&'a str> {
    match name {
        "frequency" | "excitation" => Some("Hz"),
        name if name.starts_with("amplitude") && !unit.is_empty() => Some(unit),
        _ => None,
    }
}

/// Named values as an object of the class `Fields`, or as an `Estimate`. A number with its uncertainty beside
/// it, under the same name with `_std`, is an `Estimate`, too, where its unit is known.
fn fields_of<'py>(py: Python<'py>, fields: Map<String, Value>, unit: &str) -> PyResult<Bound<'py, PyAny>> {
    static FIELDS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    static OF_ESTIMATE: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let estimate = || OF_ESTIMATE.import(py, "vibroimpact._estimate", "Estimate");
    if fields.len() == ESTIMATE.len() && ESTIMATE.iter().all(|key| fields.contains_key(*key)) {
        let [value, std, unit, n, method] = ESTIMATE.map(|key| object(py, fields[key].clone()));
        return estimate()?.call1((value?, std?, unit?, n?, method?));
    }
    let unit = fields.get("unit").and_then(Value::as_str).unwrap_or(unit).to_owned();
    let made = PyDict::new(py);
    let is_std = |std: &&Value| std.is_number() || std.is_null();
    let beside = |name: &String| fields.get(&format!("{name}_std")).filter(is_std).map(Value::as_f64);
    let stds: Vec<Option<Option<f64>>> = fields.keys().map(beside).collect();
    for ((name, value), std) in fields.into_iter().zip(stds) {
        let of_value = match (value.as_f64(), std, unit_of(&name, &unit)) {
            (Some(value), Some(std), Some(unit)) => estimate()?.call1((value, std, unit))?,
            _ => within(py, value, &unit)?,
        };
        made.set_item(name, of_value)?;
    }
    FIELDS.import(py, "vibroimpact._fields", "Fields")?.call1((made,))
}

/// A list: of numbers as an array, NaN where one is missing; of equally long lists of numbers as a matrix.
fn list<'py>(py: Python<'py>, items: Vec<Value>, unit: &str) -> PyResult<Bound<'py, PyAny>> {
    if let Some(numbers) = numbers(&items) {
        return Ok(PyArray1::from_vec(py, numbers).into_any());
    }
    if let Some((width, numbers)) = matrix(&items) {
        let shape = [items.len(), width];
        return Ok(PyArray1::from_vec(py, numbers).reshape(shape)?.into_any());
    }
    let objects = items.into_iter().map(|item| within(py, item, unit));
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
