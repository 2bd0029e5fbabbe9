//! Makes a record from a data set 58: axis, kind, scaling, unit, and the findings on each.

use super::codes::{self, FunctionType};
use super::heading::Heading;
use super::layout::Layout;
use super::ordinate::{self, UnitSystem};
use crate::assemble::{self, Abscissa, Spectral, domain, to_si};
use crate::missing;
use crate::options::Options;
use num_complex::Complex64;
use vibro_record::units::{Quantity, Unit};
use vibro_record::{AxisKind, Finding, Meta, Record, Result, Scaling, Values, Window};

/// The record of a heading and the `numbers` after it; `more` are findings from reading the numbers.
///
/// # Errors
/// If values over time are complex, or a value overflows a double in SI units.
pub fn build(
    heading: &Heading,
    numbers: Vec<f64>,
    more: Vec<Finding>,
    system: &UnitSystem,
    options: &Options,
    file: &str,
) -> Result<Record> {
    let mut meta = Meta::new(heading.name(), Unit::none());
    for (i, line) in heading.id.iter().enumerate().filter(|(_, line)| !line.is_empty()) {
        meta.notes.push((format!("id line {}", i + 1), line.clone()));
    }
    meta.notes.push(("record 6".to_owned(), heading.record6.clone()));
    meta.notes.push(("point".to_owned(), heading.name()));
    meta.declared_n = Some(heading.n);
    meta.step("read", &[("file", &file), ("format", &"uff"), ("case", &heading.layout.case())]);
    let mut said = stated(&heading.id[4]);
    let coherence = codes::function(heading.function).2 == FunctionType::Scaled(Scaling::Coherence)
        || said.scaling == Some(Scaling::Coherence);
    let factor = unit(heading, system, options, coherence, &mut meta);
    let (kind, abscissa_factor) = abscissa(heading, options, &mut meta);
    if heading.layout.complex && kind == AxisKind::Time {
        return Err(assemble::complex_over_time().at(&heading.place));
    }
    function(heading, &kind, &mut said, &mut meta);
    let missing = numbers.iter().filter(|v| v.is_nan()).count();
    let (mut stored, mut values) = split(numbers, heading.layout);
    for x in &mut stored {
        *x *= abscissa_factor;
    }
    let n = values.len();
    if n < heading.n {
        meta.found(assemble::fewer(heading.n, n));
    } else if n == 0 {
        meta.found(Finding::caution("no-values-declared"));
    }
    meta.findings.extend(missing::kept(missing).into_iter().chain(more));
    let even =
        heading.layout.even.then_some((heading.start * abscissa_factor, heading.step * abscissa_factor));
    // Half a unit in the last of six digits, which exceeds the rounding of single precision.
    let largest = stored.iter().fold(0.0f64, |max, x| max.max(x.abs()));
    let resolution = 0.5e-5 * 10f64.powf(largest.max(f64::MIN_POSITIVE).log10().floor());
    let axis = Abscissa { kind, even, stored, resolution }.axis(n, options, &mut meta);
    to_si(&mut values, factor)?;
    assemble::record(meta, axis, values, said)
}

/// Abscissa values, if stored, and the values of complete points.
fn split(numbers: Vec<f64>, layout: Layout) -> (Vec<f64>, Values) {
    let width = layout.columns();
    let points = numbers.chunks_exact(width);
    let stored = points.clone().filter(|_| !layout.even).map(|point| point[0]).collect();
    let values = if layout.complex {
        Values::Complex(points.map(|point| Complex64::new(point[width - 2], point[width - 1])).collect())
    } else if layout.even {
        Values::Real(numbers)
    } else {
        Values::Real(points.map(|point| point[1]).collect())
    };
    (stored, values)
}

/// Scaling, window and noise bandwidth from the fifth identification line, in the form that this crate
/// writes: `scaling rms; window hann; enbw 1.5`.
fn stated(line: &str) -> Spectral {
    let mut stated = Spectral::default();
    let parts = line.split("; ").filter_map(|part| part.split_once(' '));
    for (key, value) in parts.filter(|_| line.starts_with("scaling ")) {
        match key {
            "scaling" => stated.scaling = Scaling::from_name(value).filter(|s| *s != Scaling::Unknown),
            "window" => stated.window = Window::from_name(value),
            "enbw" => stated.enbw = value.parse().ok(),
            _ => {}
        }
    }
    stated
}

/// Sets scaling and findings by the function type; if the type contradicts the abscissa, the abscissa
/// decides.
fn function(heading: &Heading, axis: &AxisKind, said: &mut Spectral, meta: &mut Meta) {
    let (name, usual, kind) = codes::function(heading.function);
    if *axis == AxisKind::Time || (*axis != AxisKind::Frequency && !heading.layout.complex) {
        let plain = matches!(heading.function, 0 | 1) && !matches!(axis, AxisKind::Other(_));
        if *axis == AxisKind::Time && usual == Some(AxisKind::Frequency) {
            meta.found(Finding::caution("function-over-time").name("function", name));
        } else if !plain {
            meta.found(Finding::caution("function-as-trace").name("function", name));
        }
    } else if said.scaling.is_none() {
        said.frf = kind == FunctionType::Ratio && heading.layout.complex;
        said.scaling = match kind {
            FunctionType::Scaled(scaling) => Some(scaling),
            _ => (!said.frf).then_some(Scaling::Unknown),
        };
        let doubt = match kind {
            FunctionType::Ratio if !said.frf => Some("function-real-only"),
            FunctionType::Squared => Some("scaling-unsaid-squared"),
            FunctionType::Other => Some("function-as-spectrum"),
            _ => None,
        };
        said.doubt = doubt.map(|code| Finding::caution(code).name("function", name));
    }
}

/// Kind of the abscissa and factor to s or Hz.
fn abscissa(heading: &Heading, options: &Options, meta: &mut Meta) -> (AxisKind, f64) {
    let axis = &heading.abscissa;
    let unit = Unit::parse_or_opaque(&axis.unit);
    let by_unit = match unit.quantity() {
        Quantity::Time => Some(AxisKind::Time),
        Quantity::Frequency | Quantity::AngularVelocity => Some(AxisKind::Frequency),
        _ => None,
    };
    let by_type = match axis.data_type {
        17 => Some(AxisKind::Time),
        18 => Some(AxisKind::Frequency),
        0 | 1 => None,
        _ => return (AxisKind::Other(axis.described()), 1.0),
    };
    match (by_unit, by_type) {
        (Some(kind), by_type) => {
            if let Some(other) = by_type.filter(|other| *other != kind) {
                let differs = Finding::caution("abscissa-type-against-unit").name("type", domain(&other).0);
                meta.found(differs.name("unit", axis.unit.as_str()).name("quantity", domain(&kind).0));
            }
            if unit.quantity() == Quantity::AngularVelocity {
                meta.found(Finding::note("axis-angular").name("column", "abscissa"));
            }
            (kind, unit.hertz().unwrap_or(unit.factor()))
        }
        (None, Some(kind)) => {
            if !axis.unit.is_empty() {
                let assumed = Finding::caution("axis-unit-unknown").name("column", "abscissa");
                meta.found(assumed.name("said", axis.unit.as_str()).name("unit", domain(&kind).1));
            }
            (kind, 1.0)
        }
        (None, None) => (untyped(heading, options, meta), 1.0),
    }
}

/// Kind of an abscissa without data type or known unit: by its label, else the usual one of the function
/// type.
fn untyped(heading: &Heading, options: &Options, meta: &mut Meta) -> AxisKind {
    let axis = &heading.abscissa;
    let label = axis.label.to_lowercase();
    let words = [("time", AxisKind::Time), ("freq", AxisKind::Frequency), ("index", AxisKind::Index)];
    let named = words.into_iter().find(|(word, _)| axis.unit.is_empty() && label.contains(word));
    if let Some((_, kind)) = named {
        return kind;
    } else if !label.is_empty() || !axis.unit.is_empty() {
        return AxisKind::Other(axis.described());
    }
    let (name, usual, _) = codes::function(heading.function);
    if let Some(kind) = usual {
        let (quantity, unit) = domain(&kind);
        let by_function = Finding::caution("abscissa-by-function").name("function", name);
        meta.found(by_function.name("quantity", format!("{quantity} in {unit}")));
        return kind;
    }
    if options.rate.is_some() {
        return AxisKind::Time;
    }
    meta.found(Finding::caution("axis-kind-unsaid").name("column", "abscissa"));
    AxisKind::Index
}

/// Sets unit and quantity; returns the factor to SI.
fn unit(heading: &Heading, system: &UnitSystem, options: &Options, coherence: bool, meta: &mut Meta) -> f64 {
    let (unit, factor, written, findings) = ordinate::unit(heading, system);
    // A coherence has no unit; a unit that the user states is meant for the function beside it.
    if let Some(said) = options.unit.as_ref().filter(|_| !coherence) {
        if unit.is_known() && (unit.dimension() != said.dimension() || factor != said.factor()) {
            let differs = Finding::caution("unit-overrides-file").name("file", written);
            meta.found(differs.name("used", said.symbol()));
        }
        return meta.adopt_unit(said.symbol());
    }
    for found in findings {
        meta.found(found);
    }
    if factor != 1.0 {
        let from = if written.is_empty() { "data set 164" } else { &written };
        meta.step("to_si", &[("from", &from), ("factor", &factor)]);
    }
    meta.quantity = unit.quantity();
    meta.unit = unit;
    factor
}
