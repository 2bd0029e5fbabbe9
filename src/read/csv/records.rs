//! Columns to records: abscissa, units, complex pairs.

use super::columns::Columns;
use super::layout::Layout;
use super::name::{Name, Part};
use crate::error::{Error, Place, Result};
use crate::read::abscissa::{from_values, short};
use crate::read::ascii::SCALING_UNSAID;
use crate::read::ascii::stated::{self, Stated};
use crate::read::reader::Options;
use crate::read::{Source, number};
use crate::record::{Axis, AxisKind, Frf, FrfKind, Meta, Record, Scaling, Spectrum, Trace, Values, Window};
use crate::units::Unit;
use num_complex::Complex64;

/// The column that the names make the abscissa: the first that is one.
pub fn axis_column(names: &[Name]) -> Option<(usize, AxisKind)> {
    names.iter().enumerate().find_map(|(i, name)| Some((i, name.axis(i == 0)?)))
}

/// Records of all columns but the abscissa, and doubts about the file as a whole.
pub fn build(
    source: &Source,
    layout: Layout,
    columns: Columns,
    axis: Option<(usize, AxisKind)>,
    options: &Options,
) -> Result<(Vec<Record>, Vec<String>)> {
    let mut lines = layout.preamble;
    lines.extend(columns.kept.iter().cloned());
    let stated = stated::read(&lines);
    let mut doubts = Vec::new();
    if columns.comments > columns.kept.len() {
        let kept = columns.kept.len();
        doubts.push(format!("Of {} remarks between the rows the first {kept} are kept.", columns.comments));
    }
    if columns.missing > 0 {
        doubts.push(format!("{} value(s) are missing and kept as such.", columns.missing));
    }
    if columns.comma && layout.names.len() == 1 {
        doubts.push("There is one column, so the comma is taken as the decimal mark.".to_owned());
    }
    let rows = columns.values.first().map_or(0, Vec::len);
    let mut table: Vec<Column> = layout
        .names
        .into_iter()
        .zip(columns.values)
        .enumerate()
        .map(|(i, (name, values))| Column { at: i + 1, name, values })
        .collect();
    let axis = axis.filter(|(at, _)| table[*at].is_abscissa());
    let printed = axis.map(|(at, kind)| (kind, table.remove(at)));
    // A column that only counts says nothing, unless there is no other.
    let counts = table.len() > 1 && table[0].counts();
    let first = if counts { table.remove(0).values.first().copied() } else { None };
    let axis = match printed {
        Some((kind, column)) => Some(printed_axis(source, kind, &column, columns.resolution)?),
        None => None,
    };
    let axis = choose(axis, rows, first, &stated, options, &mut doubts);
    if table.is_empty() {
        return Err(Error::input(
            Place::file(source.path()),
            "only an abscissa",
            "at least one column of values",
        ));
    }
    let made = Made { source, axis, stated, options };
    let mut records = Vec::new();
    for (column, imaginary) in pairs(source, table, &made.axis, options)? {
        records.push(made.record(column, imaginary));
    }
    Ok((records, doubts))
}

struct Column {
    /// Place in the row, counted from 1.
    at: usize,
    name: Name,
    values: Vec<f64>,
}

impl Column {
    /// A first column of times need not be the abscissa: it may hold intervals. By name, it is.
    fn is_abscissa(&self) -> bool {
        let nameless = Name { name: self.name.name.clone(), unit: None };
        nameless.axis(self.at == 1).is_some() || self.values.windows(2).all(|w| w[1] > w[0])
    }

    fn counts(&self) -> bool {
        let first = self.values.first().copied().unwrap_or(0.0);
        self.name.counts() && self.values.iter().enumerate().all(|(i, v)| *v == first + i as f64)
    }

    fn label(&self) -> String {
        if self.name.name.is_empty() { format!("column {}", self.at) } else { self.name.name.clone() }
    }
}

/// Axis from its column, and what is to be said of it.
fn printed_axis(
    source: &Source,
    kind: AxisKind,
    column: &Column,
    resolution: f64,
) -> Result<(Axis, String, Vec<String>)> {
    let label = format!("The column {:?}", column.label());
    let mut doubts = Vec::new();
    let factor = if let Some(text) = &column.name.unit {
        let unit = Unit::parse(text).ok_or_else(|| {
            let found = format!("the unit {text:?} of the abscissa {:?}", column.label());
            Error::input(Place::file(source.path()), found, "s, ms, Hz, kHz, …")
                .hint("rename the column, e.g. to time [s]")
        })?;
        unit.factor()
    } else {
        let unit = if kind == AxisKind::Time { "seconds" } else { "hertz" };
        doubts.push(format!("{label} has no unit: {unit} are assumed."));
        1.0
    };
    let values = column.values.iter().map(|v| v * factor).collect();
    let (axis, doubt) = from_values(kind, values, resolution * factor, &label);
    doubts.extend(doubt);
    Ok((axis, label, doubts))
}

/// The axis of all records: what a person states, then the printed one, then what the preamble states.
fn choose(
    printed: Option<(Axis, String, Vec<String>)>,
    n: usize,
    first_index: Option<f64>,
    stated: &Stated,
    options: &Options,
    doubts: &mut Vec<String>,
) -> Axis {
    let lines = stated.lines.unwrap_or(n.saturating_sub(1).max(1) as f64);
    let given = match (options.rate, options.base_band) {
        (Some(rate), _) => Some(Axis::time(0.0, 1.0 / rate, n)),
        (None, Some(band)) => Some(Axis::frequency(0.0, band / lines, n)),
        _ => None,
    };
    match (given, printed) {
        (Some(given), Some((axis, label, _))) if given.kind != axis.kind => {
            doubts.push(format!("{label} is no axis for what was stated, and is passed over."));
            given
        }
        (Some(mut given), Some((axis, label, _))) => {
            let step = given.step().unwrap_or(f64::NAN);
            if given.kind == AxisKind::Time {
                given = Axis::time(axis.start(), step, n);
            }
            // Six digits of a printed column are the least that a rate should agree with.
            if axis.step().is_none_or(|printed| (printed / step - 1.0).abs() > 1e-6) {
                let said =
                    axis.step().map_or("is uneven".to_owned(), |s| format!("has a step of {}", short(s)));
                doubts.push(format!("{label} {said}; a step of {} was stated and is used.", short(step)));
            }
            given
        }
        (Some(given), None) => given,
        (None, Some((axis, label, said))) => {
            doubts.extend(said);
            let step = match axis.kind {
                AxisKind::Time => stated.rate.map(|rate| 1.0 / rate),
                _ => stated.line_width,
            };
            if let (Some(stated), Some(step)) = (step, axis.step())
                && (step / stated - 1.0).abs() > 1e-3
            {
                doubts.push(format!(
                    "The preamble states a step of {}; {label} has {} and is used.",
                    short(stated),
                    short(step)
                ));
            }
            axis
        }
        (None, None) => {
            let band = stated.base_band.map(|band| band / lines);
            if let Some(df) = stated.line_width.or(band) {
                return Axis::frequency(0.0, df, n);
            }
            if let Some(rate) = stated.rate {
                return Axis::time(0.0, 1.0 / rate, n);
            }
            doubts.push(
                "The file says nothing of its abscissa: values are numbered (give --rate for a time trace, --base-band for a spectrum).".to_owned(),
            );
            let mut axis = Axis::index(n);
            if let (Some(first), crate::record::Grid::Even { start, .. }) = (first_index, &mut axis.grid) {
                *start = first;
            }
            axis
        }
    }
}

/// Joins real and imaginary parts that belong together; over time there are none.
fn pairs(
    source: &Source,
    table: Vec<Column>,
    axis: &Axis,
    options: &Options,
) -> Result<Vec<(Column, Option<Column>)>> {
    let mut out: Vec<(Column, Option<Column>)> = Vec::new();
    let stated = options.complex && table.len() == 2;
    for mut column in table {
        let partner = match column.name.part() {
            _ if axis.kind == AxisKind::Time => None,
            Some((Part::Imaginary, whole)) => out.iter_mut().find(|(real, imaginary)| {
                imaginary.is_none() && real.name.part() == Some((Part::Real, whole.clone()))
            }),
            None if stated => out.first_mut(),
            _ => None,
        };
        match partner {
            Some((real, imaginary)) => {
                // A unit that stands in one header holds for both.
                let unit = column.name.unit.take();
                if real.name.unit.is_some() && unit.is_some() && real.name.unit != unit {
                    return Err(Error::input(
                        Place::file(source.path()),
                        format!("{:?} and {:?} have different units", real.label(), column.label()),
                        "one unit for real and imaginary part",
                    ));
                }
                real.name.unit = real.name.unit.take().or(unit);
                *imaginary = Some(column);
            }
            None => out.push((column, None)),
        }
    }
    for (real, imaginary) in &mut out {
        if let (Some((_, whole)), Some(_)) = (real.name.part(), imaginary) {
            real.name.name = whole;
        }
    }
    Ok(out)
}

/// What all records share.
struct Made<'a> {
    source: &'a Source,
    axis: Axis,
    stated: Stated,
    options: &'a Options,
}

impl Made<'_> {
    fn record(&self, column: Column, imaginary: Option<Column>) -> Record {
        let name = column.label();
        let mut meta = Meta::new(name.clone(), Unit::opaque(""));
        meta.notes.clone_from(&self.stated.notes);
        meta.step("read", &[("file", &self.source.name()), ("format", &"csv"), ("column", &column.at)]);
        let factor = self.unit(&mut meta, column.name.unit.as_deref());
        let axis = self.axis.clone();
        if axis.kind == AxisKind::Time || (axis.kind == AxisKind::Index && imaginary.is_none()) {
            let values = column.values.into_iter().map(|v| v * factor).collect();
            return Record::Trace(Trace { meta, axis, values });
        }
        let scaling = self.said("scaling", &name).and_then(|s| scaling(&s));
        let values = match imaginary {
            Some(imaginary) => {
                let pairs = column.values.iter().zip(&imaginary.values);
                let values: Vec<Complex64> =
                    pairs.map(|(re, im)| Complex64::new(*re, *im) * factor).collect();
                let kind = FrfKind::of(meta.quantity);
                let frf = self.said("kind", &name).is_some_and(|k| k == "frf");
                if frf || (kind != FrfKind::Other && scaling.is_none()) {
                    return Record::Frf(Frf { meta, axis, values, kind });
                }
                Values::Complex(values)
            }
            None => Values::Real(column.values.into_iter().map(|v| v * factor).collect()),
        };
        let density = column.name.unit.as_deref().is_some_and(is_density).then_some(Scaling::Psd);
        let scaling = scaling.or(density).unwrap_or(Scaling::Unknown);
        if scaling == Scaling::Unknown {
            meta.doubt(SCALING_UNSAID);
        }
        let window = match self.said("window", &name) {
            Some(window) => Window::from_name(&window),
            // A remark about another column says nothing of this one.
            None => self.stated.window.filter(|_| !self.remarks("window").any(|(_, v)| v.contains(" of "))),
        };
        let enbw = self.said("enbw", &name).and_then(|e| number::parse(e.as_bytes()));
        Record::Spectrum(Spectrum { meta, axis, values, scaling, window, enbw })
    }

    /// Adopts the unit of a column; returns its factor.
    fn unit(&self, meta: &mut Meta, unit: Option<&str>) -> f64 {
        if let Some(given) = &self.options.unit {
            if let Some(said) = unit.filter(|u| Unit::parse_or_opaque(u) != *given) {
                meta.doubt(format!("The file says the unit {said:?}; {given} was stated and is used."));
            }
            return meta.adopt_unit(given.symbol());
        }
        if let Some(unit) = unit.or(self.stated.unit.as_deref()) {
            return meta.adopt_unit(unit);
        }
        meta.doubt("The file says no unit: the values are kept as they are.");
        1.0
    }

    fn remarks(&self, key: &str) -> impl Iterator<Item = &(String, String)> {
        self.stated.notes.iter().filter(move |(k, _)| k.eq_ignore_ascii_case(key))
    }

    /// A remark about one column, `key: value of name`, or about all, `key: value`.
    fn said(&self, key: &str, name: &str) -> Option<String> {
        let own = self
            .remarks(key)
            .find_map(|(_, v)| v.split_once(" of ").filter(|(_, n)| *n == name).map(|(v, _)| v));
        let common = || self.remarks(key).find(|(_, v)| !v.contains(" of ")).map(|(_, v)| v.as_str());
        own.or_else(common).map(|v| v.trim().to_lowercase())
    }
}

fn scaling(text: &str) -> Option<Scaling> {
    use Scaling::{Coherence, Energy, Peak, Power, Psd, Rms, Unknown};
    [Peak, Rms, Power, Psd, Energy, Coherence, Unknown].into_iter().find(|s| s.name() == text)
}

/// `g²/Hz`, `(m/s^2)^2/Hz`: a square over hertz is a power spectral density.
fn is_density(unit: &str) -> bool {
    let power = unit.trim().strip_suffix("/Hz").map(str::trim_end);
    power.is_some_and(|p| p.ends_with('²') || p.ends_with("^2") || p.ends_with(")2"))
}
