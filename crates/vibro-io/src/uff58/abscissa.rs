//! What the abscissa of a data set 58 is: time, frequency or something else.

use super::codes::{self, Domain};
use super::heading::{self, Heading};
use crate::Options;
use vibro_record::units::{Quantity, Unit};
use vibro_record::{AxisKind, Finding, Meta};

/// Kind of the abscissa and factor to s or Hz.
pub(crate) fn kind_and_factor(heading: &Heading, options: &Options, meta: &mut Meta) -> (AxisKind, f64) {
    let axis = &heading.abscissa;
    let unit = Unit::parse_or_opaque(&axis.unit);
    let by_unit = match unit.quantity() {
        Quantity::Time => Some(AxisKind::Time),
        Quantity::Frequency | Quantity::AngularVelocity => Some(AxisKind::Frequency),
        _ => None,
    };
    let shown = |kind: &AxisKind| if *kind == AxisKind::Time { "time" } else { "frequency" };
    let by_type = match axis.data_type {
        17 => AxisKind::Time,
        18 => AxisKind::Frequency,
        0 | 1 => match by_unit {
            Some(kind) => return (kind, abscissa_factor(&unit, meta)),
            None if axis.label.is_empty() && axis.unit.is_empty() => {
                return (by_function(heading, options, meta), 1.0);
            }
            None => return (by_label(axis), 1.0),
        },
        _ => return (AxisKind::Other(axis.described()), 1.0),
    };
    if axis.unit.is_empty() {
        return (by_type, 1.0);
    }
    if let Some(kind) = by_unit {
        if kind != by_type {
            let differs = Finding::caution("abscissa-type-against-unit").name("type", shown(&by_type));
            meta.found(differs.name("unit", axis.unit.as_str()).name("quantity", shown(&kind)));
        }
        return (kind, abscissa_factor(&unit, meta));
    }
    let assumed = Finding::caution("axis-unit-unknown").name("column", "abscissa");
    let si = if by_type == AxisKind::Time { "s" } else { "Hz" };
    meta.found(assumed.name("said", axis.unit.as_str()).name("unit", si));
    (by_type, 1.0)
}

/// Factor of a unit of time to s, of frequency or angular frequency to Hz.
fn abscissa_factor(unit: &Unit, meta: &mut Meta) -> f64 {
    if unit.quantity() == Quantity::AngularVelocity {
        meta.found(Finding::note("axis-angular").name("column", "abscissa"));
    }
    unit.hertz().unwrap_or(unit.factor())
}

/// Kind of an abscissa without data type or unit.
fn by_label(axis: &heading::Axis) -> AxisKind {
    let label = axis.label.to_lowercase();
    [("time", AxisKind::Time), ("freq", AxisKind::Frequency), ("index", AxisKind::Index)]
        .into_iter()
        .find(|(word, _)| axis.unit.is_empty() && label.contains(word))
        .map_or_else(|| AxisKind::Other(axis.described()), |(_, kind)| kind)
}

/// Kind of an abscissa of which the file says nothing.
fn by_function(heading: &Heading, options: &Options, meta: &mut Meta) -> AxisKind {
    let (name, domain) = codes::function(heading.function);
    let (kind, shown) = match domain {
        Domain::Time => (AxisKind::Time, "time in s"),
        Domain::Frequency => (AxisKind::Frequency, "frequency in Hz"),
        Domain::Either if options.rate.is_some() => return AxisKind::Time,
        Domain::Either => {
            meta.found(Finding::caution("axis-kind-unsaid").name("column", "abscissa"));
            return AxisKind::Index;
        }
    };
    meta.found(Finding::caution("abscissa-by-function").name("function", name).name("quantity", shown));
    kind
}
