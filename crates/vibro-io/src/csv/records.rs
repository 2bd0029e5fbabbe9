//! Columns to records: abscissa, units, complex pairs.

use super::columns::Columns;
use super::layout::Layout;
use super::name::{Name, Part};
use crate::abscissa::{Printed, choose, from_values, short, to_si};
use crate::ascii::SCALING_UNSAID;
use crate::ascii::stated::{self, Stated};
use crate::footer::Footer;
use crate::reader::Options;
use crate::{Source, missing, number};
use num_complex::Complex64;
use vibro_record::units::Unit;
use vibro_record::{
    Axis, AxisKind, Error, Frf, FrfKind, Grid, Meta, Place, Record, Result, Scaling, Spectrum, Trace, Values,
    Window,
};

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
    let mut doubts = stated.doubts.clone();
    if columns.comments > columns.kept.len() {
        let kept = columns.kept.len();
        doubts.push(format!("Of {} remarks between the rows the first {kept} are kept.", columns.comments));
    }
    doubts.extend(columns.footer.iter().map(Footer::doubt));
    doubts.extend(missing::kept(columns.missing));
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
    if let Some((kind, column)) = &printed {
        one_clock(source, kind, column, &table, columns.resolution)?;
    }
    let axis = match printed {
        Some((kind, column)) => Some(printed_axis(source, kind, &column, columns.resolution)?),
        None => None,
    };
    let mut axis =
        choose(source.path(), axis, (rows, columns.footer.is_some()), &stated, options, &mut doubts)?;
    if let (AxisKind::Index, Some(first), Grid::Even { start, .. }) = (&axis.kind, first, &mut axis.grid) {
        *start = first;
    }
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
        records.push(made.record(column, imaginary)?);
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

/// Refuses a second column of the axis that runs at another pace: which columns are whose cannot be told.
fn one_clock(
    source: &Source,
    kind: &AxisKind,
    axis: &Column,
    table: &[Column],
    resolution: f64,
) -> Result<()> {
    let span = |column: &Column| {
        let factor = column.name.to_axis(kind, "").ok()?.0;
        let rises = column.values.windows(2).all(|w| w[1] > w[0]);
        let (first, last) = (column.values.first()?, column.values.last()?);
        rises.then_some((factor * (last - first), factor))
    };
    let Some((own, factor)) = span(axis) else { return Ok(()) };
    for other in table.iter().filter(|c| c.name.axis(true).as_ref() == Some(kind)) {
        if let Some((span, theirs)) = span(other)
            && (span - own).abs() > 4.0 * resolution * factor.max(theirs) + 1e-6 * own.abs()
        {
            return Err(Error::input(
                Place::file(source.path()),
                format!(
                    "{:?} and {:?} run over {} and {}",
                    axis.label(),
                    other.label(),
                    short(own),
                    short(span)
                ),
                "one clock for all columns",
            )
            .hint("write each of them with its channels to a file of its own"));
        }
    }
    Ok(())
}

/// Axis from its column, and what is to be said of it.
fn printed_axis(source: &Source, kind: AxisKind, column: &Column, resolution: f64) -> Result<Printed> {
    let label = format!("The column {:?}", column.label());
    let mut doubts = Vec::new();
    let (factor, doubt) = column.name.to_axis(&kind, &label).map_err(|found| {
        Error::input(Place::file(source.path()), format!("{found} {:?}", column.label()), "s, ms, Hz, kHz, …")
            .hint("rename the column, e.g. to time [s]")
    })?;
    doubts.extend(doubt);
    let values = column.values.iter().map(|v| v * factor).collect();
    let resolution = resolution * factor;
    let (axis, doubt) = from_values(kind, values, resolution, &label);
    doubts.extend(doubt);
    Ok(Printed { axis, label, resolution, assumed: false, doubts })
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
    if options.complex && !out.iter().any(|(_, imaginary)| imaginary.is_some()) {
        let found = if axis.kind == AxisKind::Time {
            "columns over time".to_owned()
        } else {
            format!("{} column(s) of values", out.len())
        };
        return Err(Error::input(
            Place::file(source.path()),
            format!("{found}, where complex values were stated"),
            "two columns over frequency, real and imaginary part",
        )
        .hint("leave out --complex, or give --base-band"));
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
    fn record(&self, column: Column, imaginary: Option<Column>) -> Result<Record> {
        let name = column.label();
        let mut meta = Meta::new(name.clone(), Unit::opaque(""));
        meta.notes.clone_from(&self.stated.notes);
        meta.step("read", &[("file", &self.source.name()), ("format", &"csv"), ("column", &column.at)]);
        let said = column.name.unit.as_deref().or(self.stated.unit.as_deref());
        let factor = self.options.adopt(&mut meta, said);
        let complex = imaginary.is_some();
        let mut values = match imaginary {
            Some(imaginary) => {
                let pairs = column.values.iter().zip(&imaginary.values);
                Values::Complex(pairs.map(|(re, im)| Complex64::new(*re, *im)).collect())
            }
            None => Values::Real(column.values),
        };
        to_si(self.source.path(), &mut values, factor)?;
        let axis = self.axis.clone();
        let trace = axis.kind == AxisKind::Time || (axis.kind == AxisKind::Index && !complex);
        let values = match values {
            Values::Real(values) if trace => return Ok(Record::Trace(Trace { meta, axis, values })),
            values => values,
        };
        let scaling = self.said("scaling", &name).and_then(|s| scaling(&s));
        let kind = FrfKind::of(meta.quantity);
        let frf = self.said("kind", &name).is_some_and(|k| k == "frf");
        let values = match values {
            Values::Complex(values) if frf || (kind != FrfKind::Other && scaling.is_none()) => {
                return Ok(Record::Frf(Frf { meta, axis, values, kind }));
            }
            values => values,
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
        Ok(Record::Spectrum(Spectrum { meta, axis, values, scaling, window, enbw }))
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
