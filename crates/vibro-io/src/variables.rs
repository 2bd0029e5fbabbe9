//! Makes records from the named variables of a file, in the same way for all formats.
//!
//! A numeric vector is a record, and so is each column of a matrix. Scalars and texts are notes on the
//! records of their struct or group, and state abscissa and unit ([`names`], [`axes`]).

mod axes;
pub mod matlab;
pub mod names;

use super::missing;
use crate::assemble::Spectral;
use crate::held::{Contents, Held};
use crate::options::Options;
use crate::source::Source;
use axes::Axes;
use names::{Dialect, Scoped};
use rayon::prelude::*;
use vibro_record::units::Unit;
use vibro_record::{Error, Fact, Finding, Meta, Result, Values};

/// Largest number of rows of a matrix that is read by rows because a row has the length of an abscissa. A
/// matrix with more rows than this, and more rows than columns, is read by columns.
const MOST_ROWS: u64 = 1000;
/// Length of the longest text that is kept, in bytes or characters.
pub const MOST_TEXT: usize = 4096;
/// Largest number of notes of a record: many scalars beside many vectors would fill the memory.
const MOST_NOTES: usize = 200;

/// Hint for a file whose arrays cannot be read.
pub const EXPORT: &str = "write its arrays as MAT (v7), CSV or WAV";

/// What a variable holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    Array(Array),
    Text(String),
    /// A class that is skipped, by its name.
    Other(&'static str),
}

/// Numbers, by rows or by columns as the dialect stores them.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    pub dimensions: Vec<u64>,
    pub values: Held,
    /// Whether values have the precision of 32-bit floats only.
    pub single: bool,
}

/// Records of the vectors and matrices among `variables`, with axes, units and notes from the other
/// variables; `findings` are those of the file so far.
pub fn contents(
    source: &Source,
    dialect: &'static Dialect,
    variables: Vec<(String, Content)>,
    mut findings: Vec<Finding>,
    options: &Options,
) -> Result<Contents> {
    let (mut arrays, notes) = parted(variables, &mut findings);
    let mut axes = Axes::find(dialect, &mut arrays, &notes, options, &mut findings);
    let units = axes::units(dialect, &notes, &arrays);
    let mut vectors: Vec<&str> = arrays.iter().map(|(name, _)| name.as_str()).collect();
    vectors.sort_unstable();
    let beside = Scoped::of(dialect, notes.iter().map(|note| (dialect.scope(&note.0, &vectors), note)));
    let mut records = Vec::new();
    for (of, array) in arrays {
        let unit =
            units.get(of.as_str()).or_else(|| units.get(dialect.bare(dialect.container(&of)))).copied();
        let parts = split(&of, array, &axes, options, &mut findings).into_iter();
        records.extend(parts.map(|(name, values)| (of.clone(), name, values, unit)));
    }
    if records.is_empty() {
        let error = Error::usage("no numeric vector or matrix", "at least one to make a record of");
        return Err(match findings.iter().find_map(|found| found.fact("reason").or(found.fact("scale"))) {
            Some(Fact::Name(why)) => error.aside(why.clone()).hint(EXPORT),
            _ => error,
        });
    }
    if options.complex && !records.iter().any(|(.., values, _)| values.is_complex()) {
        return Err(Error::usage("no matrix of two columns", "one, for complex values were stated")
            .hint("leave out that values are complex")
            .setting("complex"));
    }
    let all = records.par_iter_mut();
    let all = all.filter_map(|(_, name, values, _)| Some((name.as_str(), values.values_mut()?)));
    findings.extend(missing::checked(all, options.allow_missing)?);
    if !dialect.attributes && options.unit.is_none() && records.iter().any(|(.., unit)| unit.is_none()) {
        findings.push(Finding::caution("format-without-units"));
    }
    axes.offer(records.iter().map(|(_, name, values, _)| (name, values)));
    let record = |(of, name, mut values, unit): (String, String, Held, Option<&str>)| {
        let mut meta = Meta::new(name, Unit::opaque(""));
        let axis = axes.of(&of, &values, &mut meta, &mut findings)?;
        for (scope, (name, text)) in beside.over(&of) {
            let inside = if dialect.attributes { &name[scope.len()..] } else { name };
            let inside = inside.trim_start_matches(dialect.separator);
            if !meta.notes.iter().any(|(nearer, _)| nearer == inside) {
                meta.notes.push((inside.to_owned(), text.clone()));
            }
            if meta.notes.len() == MOST_NOTES {
                break;
            }
        }
        meta.step("read", &[("file", &source.name()), ("format", &dialect.format.name())]);
        let stated = dialect.attributes || options.unit.is_some() || unit.is_some();
        let factor = if stated { options.adopt(&mut meta, unit) } else { 1.0 };
        values.scale(factor)?;
        values.record(meta, axis, Spectral::default())
    };
    let records = records.into_iter().map(record).collect::<Result<_>>()?;
    Ok(Contents { records, findings })
}

/// Variables with their names.
type Named<T> = Vec<(String, T)>;

/// Separates vectors and matrices from scalars and texts. Skipped variables give findings.
fn parted(variables: Named<Content>, findings: &mut Vec<Finding>) -> (Named<Array>, Named<String>) {
    let (mut arrays, mut notes) = (Vec::new(), Vec::new());
    for (name, content) in variables {
        match content {
            Content::Text(text) => notes.push((name, text)),
            Content::Other(class) => {
                let passed = Finding::note("variable-passed-over");
                let passed = if name.is_empty() { passed } else { passed.name("variable", name) };
                findings.push(passed.name("class", class));
            }
            // MATLAB keeps the inside of objects and functions in a nameless array.
            Content::Array(_) if name.is_empty() => {}
            Content::Array(array) => match &array.values {
                values if values.len() == 0 => {
                    findings.push(Finding::note("variable-empty").name("variable", name));
                }
                Held::Values(Values::Real(values)) if values.len() == 1 => {
                    notes.push((name, values[0].to_string()));
                }
                _ if array.dimensions.iter().filter(|d| **d > 1).count() > 2 => {
                    let found = Finding::note("variable-many-dimensions").name("variable", name);
                    findings.push(found.count("dimensions", array.dimensions.len()));
                }
                _ => arrays.push((name, array)),
            },
        }
    }
    (arrays, notes)
}

/// Splits an array into records: one of a vector; one for each column of a matrix, or for each row if it is
/// wide or only its rows have the length of an abscissa. If the user states complex values, two columns are
/// one record.
fn split(
    name: &str,
    Array { dimensions, values, .. }: Array,
    axes: &Axes,
    options: &Options,
    findings: &mut Vec<Finding>,
) -> Vec<(String, Held)> {
    let mut long = dimensions.into_iter().filter(|d| *d > 1);
    let (Some(rows), Some(columns), Held::Values(values)) = (long.next(), long.next(), &values) else {
        return vec![(name.to_owned(), values)];
    };
    let dialect = axes.dialect;
    let has = |n: u64| axes.has(name, n);
    let wide = columns > rows.max(dialect.wide);
    let pair = options.complex && rows == 2 && columns > 2;
    let lying = !has(rows) && (wide || pair || (has(columns) && rows <= columns.max(MOST_ROWS)));
    if lying && !pair && !has(columns) {
        let found = Finding::caution("matrix-by-rows").name("variable", name);
        findings.push(found.number("rows", rows as f64).number("columns", columns as f64));
    }
    let (rows, columns) = (rows as usize, columns as usize);
    let (n, count) = if lying { (columns, rows) } else { (rows, columns) };
    let (first, step) = if lying == dialect.by_rows { (n, 1) } else { (1, count) };
    let part = |k: usize| match values {
        Values::Real(all) => Values::Real(every(all, k * first, step, n)),
        Values::Complex(all) => Values::Complex(every(all, k * first, step, n)),
    };
    if options.complex
        && count == 2
        && let (Values::Real(re), Values::Real(im)) = (part(0), part(1))
    {
        return vec![(name.to_owned(), Values::of(re, Some(im)).into())];
    }
    let [open, close] = dialect.brackets;
    let index = |k: usize| if lying { format!("{open}{k},:{close}") } else { format!("{open}:,{k}{close}") };
    (0..count).map(|k| (format!("{name}{}", index(dialect.first + k)), part(k).into())).collect()
}

fn every<T: Copy>(all: &[T], from: usize, step: usize, n: usize) -> Vec<T> {
    all.iter().skip(from).step_by(step).take(n).copied().collect()
}
